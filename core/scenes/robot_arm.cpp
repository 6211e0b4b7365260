#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/robot_arm.h>

#include "robot_arm_urdf.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace orthant {

spatial::Scene robot_arm(const RobotArm& p) {
  constexpr double kLift = 1.2, kElbow = 1.6;         // [rad]
  constexpr double kStiffness = 3000, kDamping = 60;  // [N m/rad, N m s/rad]
  constexpr double kReach = 0.594, kAhead = 0.45;     // [m, rad] where the box is
  const std::vector<std::string> start = {"at.lift=1.2", "at.elbow=1.6"};
  const ImportedModel arm = import_model(kRobotArmUrdf, "robot_arm.urdf", start);
  auto s = std::get<spatial::Scene>(parse_any_scene(arm.toml, {}, "robot_arm.urdf"));
  s.duration = 2 * p.time, s.step = 1e-3;
  const auto angle_of = [&](const char* name) {
    for (const spatial::Joint& j : s.joints)
      if (const auto* pin = std::get_if<spatial::Revolute>(&j); pin != nullptr && pin->name == name)
        return pin->angle();
    throw std::logic_error(std::string("robot_arm has no joint ") + name);
  };
  s.joint(spatial::Drive{"motor",
                         angle_of("turn"),
                         {.offset = p.sweep / 2,
                          .amplitude = p.sweep / 2,
                          .omega = std::numbers::pi / p.time,
                          .phase = -std::numbers::pi / 2}});
  s.spring(spatial::JointSpring{"lift_hold", angle_of("lift"), kStiffness, kDamping, kLift});
  s.spring(spatial::JointSpring{"elbow_hold", angle_of("elbow"), kStiffness, kDamping, kElbow});

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
