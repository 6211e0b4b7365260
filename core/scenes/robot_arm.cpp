#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/robot_arm.h>

#include "robot_arm_urdf.h"

#include <cmath>
#include <numbers>

namespace orthant {

spatial::Scene robot_arm(const RobotArm& p) {
  constexpr double kLift = 1.2, kElbow = 1.6;      // [rad]
  constexpr double kReach = 0.594, kAhead = 0.45;  // [m, rad] where the box is
  const std::vector<std::string> start = {"at.lift=1.2", "at.elbow=1.6"};
  const ImportedModel arm = import_model(kRobotArmUrdf, "robot_arm.urdf", start);
  auto s = std::get<spatial::Scene>(parse_any_scene(arm.toml, {}, "robot_arm.urdf"));
  s.duration = 2 * p.time, s.step = 1e-3;
  const auto held = [&](const char* joint, const TimeLaw& law) {
    for (std::size_t i = 0; i < s.joints.size(); ++i)
      if (const auto* pin = std::get_if<spatial::Revolute>(&s.joints[i]); pin != nullptr && pin->name == joint)
        s.joint(spatial::Drive{std::string(joint) + "_motor", pin->angle(), law});
  };
  held("turn", {.offset = p.sweep / 2,
                .amplitude = p.sweep / 2,
                .omega = std::numbers::pi / p.time,
                .phase = -std::numbers::pi / 2});
  held("lift", {.offset = kLift}), held("elbow", {.offset = kElbow});

  const Vector3d size(p.edge, p.edge, p.edge);
  const auto box = s.body({.name = "box",
                           .mass = p.mass,
                           .inertia = p.mass * spatial::box(size).inertia,
                           .position = {kReach * std::cos(kAhead), kReach * std::sin(kAhead), p.edge / 2},
                           .orientation = {std::cos(kAhead / 2), 0, 0, std::sin(kAhead / 2)}});
  spatial::Collision& meet = s.collisions.at(0);
  meet.law.mu = p.mu;
  meet.shapes.push_back({box, spatial::box_corners(size / 2)});
  s.contact_set(spatial::shape_plane({.name = "box_floor", .a = box, .law = {.mu = p.mu}}, meet.shapes.back()));
  return s;
}

}  // namespace orthant
