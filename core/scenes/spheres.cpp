#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/spheres.h>

#include <cmath>
#include <numbers>
#include <string>

namespace orthant {
namespace {

constexpr double kDensity = 1000;                  // [kg/m³]
const Vector3d kBox(0.66, 0.58, 0.46);             // half sizes, in units of the radius: the corners lie on the sphere
constexpr double kCapsule = 0.6, kStraight = 0.8;  // radius, length between the half-balls' centres, likewise

std::vector<Vector3d> ground_box(const Vector3d& low, const Vector3d& high) {
  std::vector<Vector3d> corners = spatial::box_corners((high - low) / 2);
  for (Vector3d& corner : corners) corner += (low + high) / 2;
  return corners;
}

}  // namespace

spatial::Scene spheres(const Spheres& p) {
  const auto pattern = [](int i, double ratio) { return std::fmod(ratio * i, 1.0) - 0.5; };  // in [−½, ½)
  const int side = std::max(1, static_cast<int>(std::cbrt(p.count)));
  const double apart = 2.2 * p.radius, width = side * apart;
  const ContactLaw law{.mu = p.mu, .e = p.e};
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.duration = 0.5, s.step = 1e-3;
  spatial::Collision all{.name = "spheres", .shapes = {}, .law = law};
  for (int i = 0; i < p.count; ++i) {
    const double radius = p.radius * (1 - 0.1 * (pattern(i, std::numbers::phi) + 0.5));
    const spatial::Solid solid = spatial::sphere(radius);
    const double shift = 0.15 * p.radius;
    const Vector3d place{(i % side + 0.5) * apart + shift * pattern(i, std::numbers::sqrt2),
                         (i / side % side + 0.5) * apart + shift * pattern(i, std::numbers::sqrt3),
                         (i / (side * side) + 0.5) * apart};  // NOLINT(bugprone-integer-division): a layer
    const BodyId sphere = s.body({.name = "sphere" + std::to_string(i + 1),
                                  .mass = kDensity * solid.volume,
                                  .inertia = kDensity * solid.volume * solid.inertia,
                                  .position = place});
    all.shapes.push_back({sphere, {Vector3d::Zero()}, radius});
    const auto wall = [&](const Vector3d& point, const Vector3d& normal) {
      spatial::SpherePlane plane{.name = "", .a = sphere, .law = law};
      plane.radius = radius, plane.plane_point = point, plane.normal = normal;
      s.contact(plane);
    };
    wall({0, 0, 0}, {0, 0, 1});
    wall({0, 0, 0}, {1, 0, 0});
    wall({width, 0, 0}, {-1, 0, 0});
    wall({0, 0, 0}, {0, 1, 0});
    wall({0, width, 0}, {0, -1, 0});
  }
  s.collision(std::move(all));
  return s;
}

spatial::Scene pour(const Pour& p) {
  using Bodies = Pour::Bodies;
  const auto pattern = [](int i, double ratio) { return std::fmod(ratio * i, 1.0); };  // in [0, 1)
  const int side = std::max(1, static_cast<int>(std::cbrt(p.count)));
  const double apart = 2 * p.radius * p.apart, width = (side + 0.5) * apart, thick = 2 * p.radius;
  const double height = 2 * apart * (p.count / (side * side) + 2);  // NOLINT(bugprone-integer-division): layers
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  s.duration = 0.5, s.step = 1e-3;
  // A pair takes as many places as its shapes can have points, room is by the most that any two can have: four.
  const double neighbours = p.bodies == Bodies::spheres ? 2 : p.bodies == Bodies::capsules ? 6 : 10;
  spatial::Collision all{.name = "pour", .shapes = {}, .law = {.mu = p.mu}, .neighbours = neighbours};
  const auto wall = [&](const Vector3d& low, const Vector3d& high) {
    all.shapes.push_back({kGround, ground_box(low, high), 0});
  };
  wall({-thick, -thick, -thick}, {width + thick, width + thick, 0});
  wall({-thick, -thick, 0}, {0, width + thick, height});
  wall({width, -thick, 0}, {width + thick, width + thick, height});
  wall({0, -thick, 0}, {width, 0, height});
  wall({0, width, 0}, {width, width + thick, height});
  for (int i = 0; i < p.count; ++i) {
    const double radius = p.radius * (1 - p.spread * pattern(i, std::numbers::phi));
    const int layer = i / (side * side);
    const double shift = layer % 2 == 0 ? 0.5 : 1;
    const Vector3d place{(i % side + shift) * apart,
                         (i / side % side + shift) * apart,  // NOLINT(bugprone-integer-division): a row
                         p.radius + layer * apart / std::numbers::sqrt2};
    const Bodies kind = p.bodies == Bodies::mixed ? static_cast<Bodies>(i % 3) : p.bodies;
    const spatial::Solid solid = kind == Bodies::spheres ? spatial::sphere(radius)
                                 : kind == Bodies::boxes ? spatial::box(2 * radius * kBox.normalized())
                                                         : spatial::capsule(kCapsule * radius, kStraight * radius);
    const double turn = std::numbers::pi * pattern(i, std::numbers::sqrt2), tilt = pattern(i, std::numbers::sqrt3);
    const Eigen::Vector4d orientation =
        kind == Bodies::spheres ? Eigen::Vector4d(1, 0, 0, 0)
                                : Eigen::Vector4d(std::cos(turn) * std::cos(tilt), std::cos(turn) * std::sin(tilt),
                                                  std::sin(turn) * std::sin(tilt), std::sin(turn) * std::cos(tilt));
    const BodyId body = s.body({.name = "body" + std::to_string(i + 1),
                                .mass = kDensity * solid.volume,
                                .inertia = kDensity * solid.volume * solid.inertia,
                                .position = place,
                                .orientation = orientation});
    if (kind == Bodies::spheres)
      all.shapes.push_back({body, {Vector3d::Zero()}, radius});
    else if (kind == Bodies::boxes)
      all.shapes.push_back({body, spatial::box_corners(radius * kBox.normalized()), 0});
    else
      all.shapes.push_back(
          {body, {{0, 0, -kStraight / 2 * radius}, {0, 0, kStraight / 2 * radius}}, kCapsule * radius});
  }
  s.collision(std::move(all));
  return s;
}

}  // namespace orthant
