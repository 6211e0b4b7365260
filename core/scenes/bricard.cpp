#include <orthant/core/scenes/bricard.h>

#include <array>

namespace orthant {

spatial::Scene bricard(const Bricard& p) {
  const std::array<Vector3d, 6> hinge{Vector3d(0, 0, 0),  Vector3d(1, 0, 0),  Vector3d(1, -1, 0),
                                      Vector3d(1, -1, 1), Vector3d(0, -1, 1), Vector3d(0, 0, 1)};
  spatial::Scene s;
  s.gravity = {0, -p.g, 0};
  s.duration = 10, s.step = 1e-3;
  for (std::size_t i = 0; i < 5; ++i) {
    const double across = (1 + 0.01) / 12, along = 0.02 / 12;  // [kg m²]
    const Vector3d d = (hinge[i + 1] - hinge[i]).cwiseAbs();
    s.body({.name = "rod" + std::to_string(i + 1),
            .mass = 1,
            .inertia = Vector3d(Vector3d::Constant(across) + (along - across) * d).asDiagonal(),
            .position = (hinge[i] + hinge[i + 1]) / 2});
  }
  for (std::size_t i = 0; i < 6; ++i) {
    const Vector3d axis = Vector3d::Unit((static_cast<Eigen::Index>(i) + 1) % 3);
    const BodyId a = static_cast<BodyId>(i) - 1, b = i < 5 ? static_cast<BodyId>(i) : kGround;
    const auto seen_from = [&](BodyId body) -> Vector3d {
      return body < 0 ? hinge[i] : Vector3d(hinge[i] - s.bodies[static_cast<std::size_t>(body)].position);
    };
    s.joint(spatial::Revolute{"hinge" + std::to_string(i + 1), a, b, seen_from(a), seen_from(b), axis, axis});
  }
  return s;
}

}  // namespace orthant
