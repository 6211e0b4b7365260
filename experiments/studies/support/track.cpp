#include "experiments/studies/support/track.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace orthant {

Scene track(const Track& t) {
  if (t.links < 24 || t.links % 6 != 0)
    throw std::invalid_argument("links: " + std::to_string(t.links) + ", must be a multiple of 6, at least 24");
  constexpr double kPi = std::numbers::pi;
  const int round = t.links / 6, straight = t.links / 2 - round;    // links on a wheel, and from wheel to wheel
  const double ring = t.pitch / (2 * std::sin(kPi / (2 * round)));  // [m] of the pins on a wheel
  const double base = straight * t.pitch, up = ring + t.pin, wheel_radius = ring - t.pin;

  std::vector<Vector2d> pins;
  for (int i = 0; i < straight; ++i) pins.push_back({i * t.pitch, t.pin});
  for (int i = 0; i < round; ++i) {
    const double angle = kPi * (static_cast<double>(i) / round - 0.5);
    pins.push_back({base + ring * std::cos(angle), up + ring * std::sin(angle)});
  }
  for (int i = 0; i < t.links / 2; ++i) pins.push_back(Vector2d(base, 2 * up) - pins[static_cast<std::size_t>(i)]);

  Scene s{.gravity = {0, -9.81}};
  s.duration = t.ramp, s.step = 1e-3;
  const BodyId hull = s.body({.name = "hull", .mass = 200, .inertia = 200, .position = {base / 2, up}});
  const double spin = 10 * wheel_radius * wheel_radius;
  const BodyId rear = s.body({.name = "rear", .mass = 20, .inertia = spin, .position = {0, up}});
  const BodyId axle = s.body({.name = "axle", .mass = 2, .inertia = 0.01, .position = {base, up}});
  const BodyId front = s.body({.name = "front", .mass = 20, .inertia = spin, .position = {base, up}});
  s.joint(Revolute{"rear_bearing", hull, rear, {-base / 2, 0}, {0, 0}});
  s.joint(Prismatic{.name = "guide", .a = hull, .b = axle, .point_a = {base / 2, 0}});
  s.joint(Revolute{"front_bearing", axle, front, {0, 0}, {0, 0}});
  const Slide out{hull, axle, {base / 2, 0}, {0, 0}, {1, 0}};
  constexpr double kStiffness = 1e5, kDamping = 2e3;  // [N/m, N s/m]
  s.spring(JointSpring{"tightener", out, kStiffness, kDamping, t.tension / kStiffness});
  // Pins that do not slip on the wheel: each of its turns moves the vehicle by 2 round pitches.
  const double rate = t.speed * kPi / (round * t.pitch), swing = kPi / t.ramp;
  s.joint(Drive{"motor",
                Angle{hull, rear},
                {.rate_of_change = -rate / 2, .amplitude = rate / (2 * swing), .omega = swing, .table = {}}});

  const ContactLaw law{.mu = t.mu};
  const BodyId first = rear + 3;
  for (int i = 0; i < t.links; ++i) {
    const Vector2d from = pins[static_cast<std::size_t>(i)], to = pins[static_cast<std::size_t>((i + 1) % t.links)];
    const Vector2d along = to - from;
    const auto number = std::to_string(i + 1);
    const BodyId link = s.body({.name = "link" + number,
                                .mass = 1,
                                .inertia = t.pitch * t.pitch / 12,
                                .position = (from + to) / 2,
                                .angle = std::atan2(along.y(), along.x())});
    const BodyId last = i == 0 ? first + t.links - 1 : link - 1;
    const Vector2d end{-t.pitch / 2, 0};
    s.joint(Revolute{"pin" + number, last, link, -end, end});
    s.contact(DiscDisc{"rear" + number, link, end, t.pin, rear, {0, 0}, wheel_radius, law});
    s.contact(DiscDisc{"front" + number, link, end, t.pin, front, {0, 0}, wheel_radius, law});
    s.contact(DiscWall{"ground" + number, link, end, t.pin, kGround, {0, 0}, {0, 1}, law});
  }
  return s;
}

}  // namespace orthant
