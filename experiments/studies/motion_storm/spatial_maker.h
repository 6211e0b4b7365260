// experiments/studies/motion_storm/spatial_maker.h — random bodies, joints and contacts for mechanisms in space.
#pragma once

#include "experiments/studies/motion_storm/drawing.h"

#include <orthant/core/mechanics/spatial/scene.h>

namespace orthant::motion_storm {

/// Shape of a body about its centre of mass; the axis of cylinders and capsules is z.
struct Solid3 {
  enum Kind { sphere, box, cylinder, ellipsoid, capsule, polytope };
  Kind kind = sphere;
  Vector3d size{0, 0, 0};         // [m] radius; edges; radius, height; semi-axes; radius, length
  std::vector<Vector3d> corners;  // [m] of a polytope
  double reach = 0;               // [m] of its farthest point
};

/// A scene in space in the making; `random` gives what a function is not given. Joints are made about a point and a
/// direction of the world, in the poses of the moment.
class SpatialMaker : public Drawing {
 public:
  explicit SpatialMaker(Random& random);

  Vector3d point(double lo, double hi);
  Vector3d direction();
  Eigen::Vector4d orientation();

  Solid3 ball() { return ball(random.uniform(0.05, 0.2)); }
  static Solid3 ball(double radius) { return {Solid3::sphere, {radius, 0, 0}, {}, radius}; }
  static Solid3 brick(const Vector3d& size) { return {Solid3::box, size, {}, size.norm() / 2}; }
  static Solid3 can(double radius, double height);
  Solid3 wedge();                     // a polytope of 4 to 6 corners
  Solid3 any(bool searched = false);  // searched: one that a search of pairs takes

  /// A body of this form; its inertia follows from it.
  BodyId add(const Solid3& form, const Vector3d& position, const Eigen::Vector4d& orientation = {1, 0, 0, 0},
             double mass_of_it = 0);
  /// A thin cylinder from one point of the world to the other, along its z axis.
  BodyId rod(const Vector3d& from, const Vector3d& to, double mass_of_it = 0);

  /// Contacts of a body with a half-space of another one, or of the ground; of two spheres.
  void wall(BodyId a, const Vector3d& at, const Vector3d& normal, const ContactLaw& law, BodyId b = kGround);
  void wall(BodyId a, const Vector3d& at, const Vector3d& normal) { wall(a, at, normal, law()); }
  void meet(BodyId a, BodyId b);
  /// All bodies of these forms against each other, searched.
  void search_all();

  /// Elements between two bodies at a point of the world, about or along a direction of the world.
  void spherical(BodyId a, BodyId b, const Vector3d& at);
  void revolute(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void cylindrical(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void universal(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void prismatic(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void fixed(BodyId a, BodyId b, const Vector3d& at);
  void screw(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis, double pitch);
  void planar(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void in_plane(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void on_line(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis);
  void distance(BodyId a, BodyId b, const Vector3d& at_a, const Vector3d& at_b);
  void socket(BodyId a, BodyId b, const Vector3d& at, double clearance);
  void pin_bush(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis, double clearance);
  spatial::Angle angle(BodyId a, BodyId b, const Vector3d& axis) const;  // 0 in the poses of the moment
  spatial::Slide slide(BodyId a, BodyId b, const Vector3d& at, const Vector3d& axis) const;
  spatial::Span span(BodyId a, BodyId b, const Vector3d& at_a, const Vector3d& at_b) const;
  void limit(const spatial::Coordinate& of, spatial::Limit::Side side, double bound);
  void drive(const spatial::Coordinate& of, double offset, double rate, double amplitude = 0, double omega = 0);
  /// All bodies turn about this point like one.
  void turn_about(const Vector3d& centre, const Vector3d& omega);

  Vector3d in_body(BodyId b, const Vector3d& world) const;
  Vector3d in_frame(BodyId b, const Vector3d& direction) const;
  spatial::Body& body(BodyId b) { return scene.bodies[static_cast<std::size_t>(b)]; }
  const spatial::Body& body(BodyId b) const { return scene.bodies[static_cast<std::size_t>(b)]; }
  const Solid3& form(BodyId b) const { return forms[static_cast<std::size_t>(b)]; }
  BodyId bodies() const { return static_cast<BodyId>(scene.bodies.size()); }

  spatial::Scene scene;
  std::vector<Solid3> forms;  // one a body

 private:
  Eigen::Vector4d relative(BodyId a, BodyId b) const;  // of b in a
};

// The kinds: spatial_scenes_loose.cpp and spatial_scenes_linked.cpp.
void dropped(SpatialMaker& m);
void sliding(SpatialMaker& m);
void spinning(SpatialMaker& m);
void spheres(SpatialMaker& m);
void wedge(SpatialMaker& m);
void billiards(SpatialMaker& m);
void belt(SpatialMaker& m);
void shaken(SpatialMaker& m);
void searched(SpatialMaker& m);
void chain(SpatialMaker& m);
void one_joint(SpatialMaker& m);
void loop(SpatialMaker& m);
void slider(SpatialMaker& m);
void clearances(SpatialMaker& m);
void rail(SpatialMaker& m);
void ropes(SpatialMaker& m);
void jammed(SpatialMaker& m);
void gears(SpatialMaker& m);
void redundant(SpatialMaker& m);
void tumbling(SpatialMaker& m);
void mixed(SpatialMaker& m);

}  // namespace orthant::motion_storm
