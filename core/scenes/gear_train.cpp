#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/gear_train.h>

#include <string>

namespace orthant {

spatial::Scene gear_train(const GearTrain& p) {
  using spatial::Revolute;
  constexpr double kThick = 0.02, kDensity = 2700;  // [m, kg/m³]
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  s.duration = 1, s.step = 1e-4;
  double x = 0;
  spatial::Angle last;
  double last_radius = 0;
  for (int i = 0; i < p.wheels; ++i) {
    const double radius = i % 2 == 0 ? 0.04 : 0.06;  // ratios −2/3 and −3/2
    if (i > 0) x += last_radius + radius;
    const double thick = i + 1 == p.wheels ? 3 * kThick : kThick;
    const spatial::Solid disc = spatial::cylinder(radius, thick);
    const double mass = kDensity * disc.volume;
    const auto number = std::to_string(i + 1);
    const BodyId wheel = s.body({.name = "wheel" + number,
                                 .mass = mass,
                                 .inertia = mass * disc.inertia,
                                 .position = {x, 0, 0},
                                 .omega = {0, 0, i == 0 ? p.amplitude * p.omega : 0}});
    const Revolute bearing{"bearing" + number, kGround, wheel, {x, 0, 0}, {0, 0, 0}};
    s.joint(bearing);
    const spatial::Angle turn = bearing.angle();
    if (i == 0)
      s.joint(spatial::Drive{"motor", turn, {.amplitude = p.amplitude, .omega = p.omega, .table = {}}});
    else
      s.contact_set(spatial::meshing("teeth" + number, spatial::Gear({}, last, turn, i % 2 == 1 ? -2.0 / 3 : -1.5),
                                     p.play, {.e = p.e}));
    if (i + 1 == p.wheels && p.brake > 0)
      s.spring(spatial::JointSpring{.name = "brake", .of = turn, .damping = p.brake});
    last = turn, last_radius = radius;
  }
  return s;
}

}  // namespace orthant
