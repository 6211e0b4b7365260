// tests/core/mechanics/scene_dump.h — a scene as text, bit by bit.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>

#include <cctype>

#include "tests/core/mechanics/scene_examples.h"
#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {

/// Every number of a scene, bit for bit, with its name.
class Dump {
 public:
  std::string of(const Scene& s) {
    put(s.gravity, s.duration, s.step, static_cast<int>(s.restitution), static_cast<int>(s.impacts));
    for (const Body& b : s.bodies) put("body", b.name, b.mass, b.inertia, b.position, b.angle, b.velocity, b.omega);
    for (const Joint& j : s.joints) std::visit([&](const auto& x) { joint(x); }, j);
    for (const Contact& c : s.contacts) std::visit([&](const auto& x) { contact(x); }, c);
    for (const JointFriction& f : s.frictions) put("friction", f.name, f.bound), coordinate(f.of);
    for (const Spring& p : s.springs) std::visit([&](const auto& x) { spring(x); }, p);
    for (const Load& l : s.loads) {
      put("load", l.name, l.body, l.point, l.force, l.torque);
      for (const double t : {-1.0, 0.0, 0.3, 1.0, 7.0}) put(l.factor ? l.factor(t) : 1.0);
    }
    return out_.str();
  }

 private:
  void joint(const Revolute& j) { put("revolute", j.name, j.a, j.b, j.point_a, j.point_b); }
  void joint(const Prismatic& j) { put("prismatic", j.name, j.a, j.b, j.point_a, j.point_b, j.axis, j.angle); }
  void joint(const Fixed& j) { put("fixed", j.name, j.a, j.b, j.point_a, j.point_b, j.angle); }
  void joint(const Distance& j) { put("distance", j.name, j.a, j.b, j.point_a, j.point_b, j.length); }
  void joint(const Drive& j) {
    put("drive", j.name), coordinate(j.of);
    put(j.law.offset, j.law.rate_of_change, j.law.amplitude, j.law.omega, j.law.phase);
    for (const double t : {-1.0, 0.0, 0.3, 1.0, 7.0}) put(j.law.table.value(t));
  }
  void coordinate(const Coordinate& of) {
    if (const auto* angle = std::get_if<Angle>(&of.kind())) put("angle", angle->a, angle->b);
    if (const auto* c = std::get_if<Slide>(&of.kind())) put("slide", c->a, c->b, c->point_a, c->point_b, c->axis);
    if (const auto* c = std::get_if<Span>(&of.kind())) put("span", c->a, c->b, c->point_a, c->point_b);
  }
  void contact(const DiscPolygon& c) {
    put("disc-polygon", c.name, c.a, c.centre, c.radius, c.b, c.law);
    for (const Vector2d& corner : c.corners) put(corner);
  }
  void contact(const PolygonPolygon& c) {
    put("polygon-polygon", c.name, c.a, c.b, c.point, c.law);
    for (const Polygon* corners : {&c.corners_a, &c.corners_b})
      for (const Vector2d& corner : *corners) put(corner);
  }
  void joint(const CustomJoint&) { FAIL("a file has none"); }
  void contact(const CustomContact&) { FAIL("a file has none"); }
  void contact(const Journal& c) {
    put("journal", c.name, c.a, c.centre_a, c.radius_a, c.b, c.centre_b, c.radius_b, c.law);
  }
  void contact(const Limit& c) { put("limit", c.name, static_cast<int>(c.side), c.bound, c.law), coordinate(c.of); }
  void contact(const CornerWall& c) { put("corner-wall", c.name, c.a, c.point, c.b, c.wall_point, c.normal, c.law); }
  void contact(const DiscWall& c) {
    put("disc-wall", c.name, c.a, c.centre, c.radius, c.b, c.wall_point, c.normal, c.law);
  }
  void contact(const DiscDisc& c) {
    put("disc-disc", c.name, c.a, c.centre_a, c.radius_a, c.b, c.centre_b, c.radius_b, c.law);
  }
  void spring(const PointSpring& s) {
    put("point", s.name, s.a, s.b, s.point_a, s.point_b, s.stiffness, s.damping, s.rest);
  }
  void spring(const JointSpring& s) { put("joint", s.name, s.stiffness, s.damping, s.rest), coordinate(s.of); }
  void spring(const TorsionSpring& s) { put("torsion", s.name, s.a, s.b, s.stiffness, s.damping, s.rest); }

  template <class... Ts> void put(const Ts&... values) {
    (one(values), ...);
    out_ << '\n';
  }
  void one(double x) { out_ << std::hexfloat << (x == 0 ? 0.0 : x) << ' '; }  // −0 is 0
  void one(int x) { out_ << x << ' '; }
  void one(const Vector2d& v) { one(v.x()), one(v.y()); }
  void one(const std::string& s) { out_ << s << ' '; }
  void one(const char* s) { out_ << s << ' '; }
  void one(const ContactLaw& law) { one(law.mu), one(law.e), one(law.e_t), one(law.mu_static), one(law.belt); }

  std::ostringstream out_;
};

inline std::string dump(const Scene& scene) { return Dump().of(scene); }

}  // namespace orthant
