#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/spheres.h>

#include <cmath>
#include <numbers>
#include <string>

namespace orthant {

spatial::Scene spheres(const Spheres& p) {
  constexpr double kDensity = 1000;                                                          // [kg/m³]
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

}  // namespace orthant
