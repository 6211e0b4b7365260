// experiments/studies/motion_storm/maker.h — random bodies, joints and contacts for random mechanisms.
#pragma once

#include "experiments/studies/motion_storm/drawing.h"

#include <orthant/core/mechanics/scene/scene.h>

namespace orthant::motion_storm {

/// Shape of a body, about its centre of mass; without corners a disc.
struct Form {
  double radius = 0;  // [m] of the disc, or of the polygon's farthest corner
  Polygon corners;
};

/// A scene in the making. Each function draws from `random` what it is not given.
class Maker : public Drawing {
 public:
  explicit Maker(Random& random);

  Vector2d point(double lo, double hi) { return {random.uniform(lo, hi), random.uniform(lo, hi)}; }

  Form disc() { return {random.uniform(0.05, 0.25), {}}; }
  Form box(double width, double height) { return {Vector2d(width, height).norm() / 2, rectangle(width, height)}; }
  Form polygon();  // convex, 3 to 6 corners on a circle, the centre of mass at the origin
  Form any();

  /// A body of this form; its inertia follows from it.
  BodyId add(const Form& form, const Vector2d& position, double angle = 0, double mass_of_it = 0);
  /// A slender rod from one point to the other, its inertia that of a rod. Its ends are at (∓length/2, 0).
  BodyId rod(const Vector2d& from, const Vector2d& to, double mass_of_it = 0);
  double length_of(BodyId rod_) const { return 2 * forms[static_cast<std::size_t>(rod_)].radius; }

  /// Contacts between the forms of two bodies, of one body with a half-plane, of one with a fixed shape of the ground.
  void meet(BodyId a, BodyId b);
  void meet_all();
  void wall(BodyId a, const Vector2d& at, const Vector2d& normal);
  void peg(BodyId a, const Vector2d& at, double radius);
  void tile(BodyId a, const Polygon& corners);
  void pin(BodyId a, const Vector2d& point_a, BodyId b, const Vector2d& point_b);
  void journal(BodyId a, const Vector2d& point_a, BodyId b, const Vector2d& point_b, double clearance);
  void limit(const Coordinate& of, Limit::Side side, double bound, double e);
  void drive(const Coordinate& of, double offset, double rate, double amplitude = 0, double omega = 0);
  /// All bodies turn about this point like one.
  void turn_about(const Vector2d& centre, double omega);
  Vector2d in_body(BodyId b, const Vector2d& world) const;
  Body& body(BodyId b) { return scene.bodies[static_cast<std::size_t>(b)]; }
  const Body& body(BodyId b) const { return scene.bodies[static_cast<std::size_t>(b)]; }
  const Form& form(BodyId b) const { return forms[static_cast<std::size_t>(b)]; }

  Scene scene;
  std::vector<Form> forms;  // one a body
};

inline Angle angle_of(BodyId b) { return {kGround, b}; }

// The kinds: scenes_loose.cpp, scenes_linked.cpp and scenes_geared.cpp.
void dropped(Maker& m);
void stack(Maker& m);
void seams(Maker& m);
void side_by_side(Maker& m);
void spinning(Maker& m);
void wedge(Maker& m);
void ladder_of_masses(Maker& m);
void billiards(Maker& m);
void belt(Maker& m);
void shaken(Maker& m);
void linked_chain(Maker& m);
void pin_contact(Maker& m);
void hinged_plank(Maker& m);
void four_bar(Maker& m);
void slider(Maker& m);
void redundant(Maker& m);
void rail(Maker& m);
void ropes(Maker& m);
void jammed(Maker& m);
void rotor(Maker& m);
void mixed(Maker& m);
void gears(Maker& m);
void terrain(Maker& m);

}  // namespace orthant::motion_storm
