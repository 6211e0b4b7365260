// core/mechanics/spatial/scene.h — mechanism in space as plain data: bodies, joints, contacts, collisions, springs,
// loads. SI units.
//
//   spatial::Scene s;
//   const auto top = s.body({.name = "top", .mass = .5, .inertia = Vector3d(2e-3, 2e-3, 8e-4).asDiagonal()});
//   s.joint(spatial::Spherical{"tip", kGround, top, {0, 0, 0}, {0, 0, -.04}});
// Orientation: the unit quaternion (w, x, y, z) that turns the body's frame into the world's. The inertia tensor is
// given in the body's frame about the centre of mass; its principal axes are found once, by System.
#pragma once

#include <orthant/core/mechanics/scene/add_named.h>
#include <orthant/core/mechanics/scene/impact_law.h>
#include <orthant/core/mechanics/spatial/backlash.h>
#include <orthant/core/mechanics/spatial/block_channel.h>
#include <orthant/core/mechanics/spatial/collision.h>
#include <orthant/core/mechanics/spatial/cylindrical.h>
#include <orthant/core/mechanics/spatial/distance.h>
#include <orthant/core/mechanics/spatial/drag.h>
#include <orthant/core/mechanics/spatial/drive.h>
#include <orthant/core/mechanics/spatial/ellipsoid_plane.h>
#include <orthant/core/mechanics/spatial/fixed.h>
#include <orthant/core/mechanics/spatial/gear.h>
#include <orthant/core/mechanics/spatial/inertia.h>
#include <orthant/core/mechanics/spatial/joint_friction.h>
#include <orthant/core/mechanics/spatial/limit.h>
#include <orthant/core/mechanics/spatial/load.h>
#include <orthant/core/mechanics/spatial/pin_bush.h>
#include <orthant/core/mechanics/spatial/plane_joint.h>
#include <orthant/core/mechanics/spatial/point_in_plane.h>
#include <orthant/core/mechanics/spatial/point_on_line.h>
#include <orthant/core/mechanics/spatial/prismatic.h>
#include <orthant/core/mechanics/spatial/revolute.h>
#include <orthant/core/mechanics/spatial/rim_plane.h>
#include <orthant/core/mechanics/spatial/screw.h>
#include <orthant/core/mechanics/spatial/socket.h>
#include <orthant/core/mechanics/spatial/sphere_bush.h>
#include <orthant/core/mechanics/spatial/sphere_plane.h>
#include <orthant/core/mechanics/spatial/sphere_sphere.h>
#include <orthant/core/mechanics/spatial/spherical.h>
#include <orthant/core/mechanics/spatial/spring.h>
#include <orthant/core/mechanics/spatial/universal.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace orthant {
namespace spatial {

struct Body {
  std::string name;
  double mass = 1;                          // [kg] > 0
  Matrix3d inertia = Matrix3d::Identity();  // [kg m²] about the centre of mass, in the body's frame
  Vector3d position{0, 0, 0};               // [m] of the centre of mass
  Eigen::Vector4d orientation{1, 0, 0, 0};  // (w, x, y, z)
  Vector3d velocity{0, 0, 0};               // [m/s] in the world
  Vector3d omega{0, 0, 0};                  // [rad/s] in the world
  Eigen::Vector4d axes{1, 0, 0, 0};         // quaternion, principal axes → body's frame; set by System
  Matrix3d to_axes = Matrix3d::Identity();  // body's frame → principal axes; set by System
  bool principal = false;                   // whether that is the identity; set by System
};

using Joint = std::variant<Revolute, Prismatic, Fixed, Distance, Drive, Spherical, Cylindrical, Universal, PlaneJoint,
                           PointInPlane, PointOnLine, Screw, Gear>;
using Contact =
    std::variant<SpherePlane, SphereSphere, Socket, Limit, EllipsoidPlane, RimPlane, PinBush, Backlash, SphereBush>;
using Spring = std::variant<PointSpring, JointSpring, Drag>;

struct Scene {
  Vector3d gravity{0, 0, 0};  // [m/s²]
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Contact> contacts;
  std::vector<Collision> collisions;
  std::vector<JointFriction> frictions;
  std::vector<Spring> springs;
  std::vector<Load> loads;
  Restitution restitution = Restitution::newton;
  Impacts impacts = Impacts::simultaneous;
  double duration = 1, step = 1e-3;  // [s] defaults of `simulate`
  bool assemble = false;             // bodies are moved into their joints at the start (dynamics/assemble.h)
  std::vector<std::string> notes;    // of an imported model: how it was taken, and what was not

  /// Each adds one element; without a name it becomes body1, body2, … joint1, … by its place.
  BodyId body(Body b) {
    add_named(bodies, std::move(b), "body");
    return static_cast<BodyId>(bodies.size()) - 1;
  }
  void joint(Joint j) { add_named(joints, std::move(j), "joint"); }
  void contact(Contact c) { add_named(contacts, std::move(c), "contact"); }
  template <class Set> void contact_set(const Set& contacts_of_it) {
    for (const auto& c : contacts_of_it) contact(c);
  }
  void collision(Collision c) { add_named(collisions, std::move(c), "collision"); }
  void friction(JointFriction f) { add_named(frictions, std::move(f), "friction"); }
  void spring(Spring s) { add_named(springs, std::move(s), "spring"); }
  template <class Set> void spring_set(const Set& springs_of_it) {
    for (const auto& s : springs_of_it) spring(s);
  }
  void load(Load l) { add_named(loads, std::move(l), "load"); }
};

/// Throws SceneError (scene/scene.h) naming element, field, value and rule: masses > 0, inertia tensors symmetric with
/// positive moments that a body can have (no one larger than the sum of the others), unit quaternions and directions,
/// finite numbers, two different bodies that exist, radii > 0 (of a sphere against a plane ≥ 0), a socket wider than
/// its ball, a bush than its pin or ball, a pitch ≠ 0, shapes that are a sphere, a capsule of some length or a polytope
/// of some volume without a radius, laws as in the plane but without a belt, stiffness, damping and dry friction ≥ 0,
/// at least one body, names distinct within a kind and made of A–Z a–z 0–9 _ -.
void check(const Scene& scene);

}  // namespace spatial

/// Whether the joint is given in time.
inline bool driven(const spatial::Joint& joint) { return std::holds_alternative<spatial::Drive>(joint); }

template <class Space> struct ElementsOf;
template <> struct ElementsOf<Spatial> {
  using Scene = spatial::Scene;
  using Body = spatial::Body;
  using Joint = spatial::Joint;
  using Contact = spatial::Contact;
  struct ContactBias {};
  using Spring = spatial::Spring;
  using Friction = spatial::JointFriction;
  using Drive = spatial::Drive;
};

}  // namespace orthant
