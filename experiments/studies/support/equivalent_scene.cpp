#include "experiments/studies/support/equivalent_scene.h"

#include <algorithm>
#include <cmath>

namespace orthant {

Scene moved(Scene s, double angle, const Vector2d& shift) {
  const Pose pose{shift, angle, std::cos(angle), std::sin(angle)};
  const auto point = [&](BodyId body, Vector2d& p) {
    if (body == kGround) p = pose.turn(p) + shift;
  };
  s.gravity = pose.turn(s.gravity);
  for (Body& b : s.bodies)
    b.position = pose.turn(b.position) + shift, b.velocity = pose.turn(b.velocity), b.angle += angle;
  for (Joint& j : s.joints) {
    auto& pin = std::get<Revolute>(j);
    point(pin.a, pin.point_a), point(pin.b, pin.point_b);
  }
  for (Contact& c : s.contacts) {
    auto& wall = std::get<CornerWall>(c);
    point(wall.b, wall.wall_point);
    wall.normal = pose.turn(wall.normal).normalized();
  }
  return s;
}

Scene mirrored(Scene s) {
  const auto flip = [](auto&... v) { ((v.x() = -v.x()), ...); };
  flip(s.gravity);
  for (Body& b : s.bodies) flip(b.position, b.velocity), b.angle = -b.angle, b.omega = -b.omega;
  for (Joint& j : s.joints) flip(std::get<Revolute>(j).point_a, std::get<Revolute>(j).point_b);
  for (Contact& c : s.contacts) {
    auto& wall = std::get<CornerWall>(c);
    flip(wall.point, wall.wall_point, wall.normal);
  }
  return s;
}

Scene in_units(Scene s, double length, double mass) {
  s.gravity *= length;
  for (Body& b : s.bodies)
    b.position *= length, b.velocity *= length, b.mass *= mass, b.inertia *= mass * length * length;
  for (Joint& j : s.joints) std::get<Revolute>(j).point_a *= length, std::get<Revolute>(j).point_b *= length;
  for (Contact& c : s.contacts) std::get<CornerWall>(c).point *= length, std::get<CornerWall>(c).wall_point *= length;
  return s;
}

Scene reversed(Scene s) {
  const auto n = static_cast<BodyId>(s.bodies.size());
  const auto renumber = [&](BodyId& body) { body = body == kGround ? kGround : n - 1 - body; };
  for (Joint& j : s.joints) renumber(std::get<Revolute>(j).a), renumber(std::get<Revolute>(j).b);
  for (Contact& c : s.contacts) renumber(std::get<CornerWall>(c).a), renumber(std::get<CornerWall>(c).b);
  std::reverse(s.bodies.begin(), s.bodies.end());
  std::reverse(s.joints.begin(), s.joints.end());
  std::reverse(s.contacts.begin(), s.contacts.end());
  return s;
}

Scene furnished(Scene s) {
  s.body({.name = "far", .inertia = 1, .position = {50, 0}, .velocity = {0, 1}});
  for (int i = 0; i < 4; ++i)
    s.contact(CornerWall{"", 2, {0, 0}, kGround, {0, -10.0 - i}, {0, 1}, {.mu = 0.3, .e = 0.5}});
  return s;
}

Scene renamed(Scene s) {
  const auto rename = [](auto& x) { x.name = "the-" + x.name; };
  for (Body& b : s.bodies) rename(b);
  for (Joint& j : s.joints) std::visit(rename, j);
  for (Contact& c : s.contacts) std::visit(rename, c);
  return s;
}

Scene doubled(Scene s) {
  const auto twin = [](auto element) {
    std::visit([](auto& x) { x.name += "-twin"; }, element);
    return element;
  };
  s.joint(twin(s.joints.front())), s.contact(twin(s.contacts.front()));
  return s;
}

}  // namespace orthant
