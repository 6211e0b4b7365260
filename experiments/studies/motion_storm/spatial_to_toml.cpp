// Scenes in space as TOML text: what scene_toml.h reads, written.
#include "experiments/studies/motion_storm/scenes.h"

#include <orthant/core/support/options.h>

#include <stdexcept>

namespace orthant::motion_storm {
namespace {

using detail::text_of;

template <class X> std::string list_of(const Eigen::MatrixBase<X>& x) {
  std::string all = "[";
  for (Eigen::Index i = 0; i < x.size(); ++i) all += (i > 0 ? ", " : "") + text_of(x(i));
  return all + "]";
}
std::string list_of(const std::vector<Vector3d>& points) {
  std::string all = "[";
  for (std::size_t i = 0; i < points.size(); ++i) all += (i > 0 ? ", " : "") + list_of(points[i]);
  return all + "]";
}

class SpatialText {
 public:
  explicit SpatialText(const spatial::Scene& scene) : scene_(scene) {}

  void begin(const char* kind) { out += std::string("\n[[") + kind + "]]\n"; }
  void line(const char* key, const std::string& value) { out += std::string(key) + " = " + value + '\n'; }
  void word(const char* key, const std::string& value) { line(key, '"' + value + '"'); }
  void number(const char* key, double value) { line(key, text_of(value)); }
  void maybe(const char* key, double value) {
    if (value != 0) number(key, value);
  }
  template <class X> void vector(const char* key, const Eigen::MatrixBase<X>& x) { line(key, list_of(x)); }
  std::string name(BodyId b) const { return b < 0 ? "ground" : scene_.bodies[static_cast<std::size_t>(b)].name; }
  void bodies(BodyId a, BodyId b) { line("bodies", "[\"" + name(a) + "\", \"" + name(b) + "\"]"); }
  void law(const ContactLaw& l) {
    maybe("mu", l.mu), maybe("e_n", l.e), maybe("e_t", l.e_t), maybe("mu_static", l.mu_static);
    const SurfaceLaw& s = l.surface;
    maybe("rolling", s.rolling), maybe("spinning", s.spinning);
    if (s.orthotropic()) number("mu_across", s.mu_across), vector("direction", s.direction);
    if (s.moves())
      line("surface", "{velocity = " + list_of(s.velocity) + ", omega = " + list_of(s.omega) +
                          ", centre = " + list_of(s.centre) + "}");
  }
  void wall(const auto& c) {
    word("body", name(c.a));
    line("wall",
         "{body = \"" + name(c.b) + "\", point = " + list_of(c.plane_point) + ", normal = " + list_of(c.normal) + "}");
    law(c.law);
  }
  void points(const auto& x) { bodies(x.a, x.b), vector("point_a", x.point_a), vector("point_b", x.point_b); }
  void coordinate(const spatial::Coordinate& c) {
    std::visit(
        [&](const auto& x) {
          using T = std::decay_t<decltype(x)>;
          word("of", c.angle() ? "angle" : std::is_same_v<T, spatial::Slide> ? "slide" : "distance");
          if constexpr (requires { x.point_a; })
            points(x);
          else
            bodies(x.a, x.b), vector("axis", x.axis_a), vector("axis_b", x.axis_b);
          if constexpr (requires { x.axis; }) vector("axis", x.axis);
        },
        c.kind());
  }

  void gear(const spatial::Gear& j) {  // of two wheels against the ground
    const auto &one = std::get<spatial::Angle>(j.first), &other = std::get<spatial::Angle>(j.second);
    bodies(one.b, other.b), vector("axis", one.axis_a), vector("axis_b", other.axis_a), number("ratio", j.ratio);
  }

  std::string out;

 private:
  const spatial::Scene& scene_;
};

struct WriteSpatialJoint {
  SpatialText& t;
  void axes(const auto& j) { t.points(j), t.vector("axis", j.axis_a), t.vector("axis_b", j.axis_b); }
  void operator()(const spatial::Spherical& j) { t.word("type", "spherical"), t.points(j); }
  void operator()(const spatial::Revolute& j) { t.word("type", "revolute"), axes(j); }
  void operator()(const spatial::Cylindrical& j) { t.word("type", "cylindrical"), axes(j); }
  void operator()(const spatial::Universal& j) { t.word("type", "universal"), axes(j); }
  void operator()(const spatial::PlaneJoint& j) { t.word("type", "planar"), axes(j); }
  void operator()(const spatial::Screw& j) { t.word("type", "screw"), axes(j), t.number("pitch", j.pitch); }
  void operator()(const spatial::Prismatic& j) {
    t.word("type", "prismatic"), t.points(j), t.vector("axis", j.axis), t.vector("orientation", j.orientation);
  }
  void operator()(const spatial::Fixed& j) {
    t.word("type", "fixed"), t.points(j), t.vector("orientation", j.orientation);
  }
  void operator()(const spatial::PointInPlane& j) {
    t.word("type", "point-in-plane"), t.points(j), t.vector("axis", j.axis);
  }
  void operator()(const spatial::PointOnLine& j) {
    t.word("type", "point-on-line"), t.points(j), t.vector("axis", j.axis);
  }
  void operator()(const spatial::Distance& j) { t.word("type", "distance"), t.points(j), t.number("length", j.length); }
  void operator()(const spatial::Gear& j) { t.word("type", "gear"), t.gear(j); }
  void operator()(const spatial::Drive& j) {
    t.word("type", "drive"), t.coordinate(j.of), t.number("offset", j.law.offset);
    t.maybe("rate", j.law.rate_of_change), t.maybe("amplitude", j.law.amplitude), t.maybe("omega", j.law.omega);
    t.maybe("phase", j.law.phase);
  }
};

/// Of contacts that a file writes as one the first one writes all: six of a cylinder's rims, two of a pin.
struct WriteSpatialContact {
  SpatialText& t;
  void operator()(const spatial::SpherePlane& c) {
    t.word("type", c.radius > 0 ? "sphere-wall" : "corner-wall"), t.wall(c);
    t.vector(c.radius > 0 ? "centre" : "point", c.centre), t.maybe("radius", c.radius);
  }
  void operator()(const spatial::EllipsoidPlane& c) {
    t.word("type", "ellipsoid-wall"), t.wall(c), t.vector("centre", c.centre), t.vector("semi_axes", c.semi_axes);
    t.vector("orientation", c.orientation);
  }
  void operator()(const spatial::RimPlane& c) {
    t.word("type", "cylinder-wall"), t.wall(c), t.number("radius", c.radius), t.number("height", -2 * c.centre.z());
  }
  void centres(const auto& c, const char* type) {
    t.word("type", type), t.bodies(c.a, c.b), t.vector("centre_a", c.centre_a), t.vector("centre_b", c.centre_b);
    t.number("radius_a", c.radius_a), t.number("radius_b", c.radius_b), t.law(c.law);
  }
  void operator()(const spatial::SphereSphere& c) { centres(c, "sphere-sphere"); }
  void operator()(const spatial::Socket& c) { centres(c, "socket"); }
  void operator()(const spatial::SphereBush& c) { centres(c, "sphere-bush"), t.vector("axis_b", c.axis_b); }
  void operator()(const spatial::PinBush& c) {
    centres(c, "pin-bush"), t.vector("axis", c.axis_a), t.vector("axis_b", c.axis_b);
    t.number(c.rim_of_pin ? "length_a" : "length_b", -2 * c.along);
  }
  void operator()(const spatial::Limit& c) {
    t.word("type", "limit"), t.coordinate(c.of);
    t.number(c.side == spatial::Limit::Side::lower ? "lower" : "upper", c.bound), t.maybe("e_n", c.law.e);
  }
  void operator()(const spatial::Backlash& c) {
    t.word("type", "backlash"), t.gear(c.gear), t.number("play", c.play), t.maybe("e_n", c.law.e);
  }
};

}  // namespace

bool follows_in_set(const spatial::Contact& contact) {
  const std::string& name = std::visit([](const auto& c) -> const std::string& { return c.name; }, contact);
  const bool set =
      std::holds_alternative<spatial::RimPlane>(contact) || std::holds_alternative<spatial::PinBush>(contact);
  return (set && !name.ends_with("_1")) ||
         (std::holds_alternative<spatial::Backlash>(contact) && !name.ends_with("_lower"));
}

std::string to_toml(const spatial::Scene& scene, const std::string& comment) {
  SpatialText t(scene);
  for (std::size_t from = 0; from < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', from), comment.size());
    t.out += "# " + comment.substr(from, end - from) + '\n';
    from = end + 1;
  }
  t.line("dimension", "3"), t.vector("gravity", scene.gravity);
  t.number("duration", scene.duration), t.number("step", scene.step);
  for (const spatial::Body& b : scene.bodies) {
    t.begin("body"), t.word("name", b.name), t.number("mass", b.mass);
    t.line("inertia",
           "[" + list_of(b.inertia.row(0)) + ", " + list_of(b.inertia.row(1)) + ", " + list_of(b.inertia.row(2)) + "]");
    t.vector("position", b.position), t.vector("orientation", b.orientation);
    t.vector("velocity", b.velocity), t.vector("omega", b.omega);
  }
  for (const spatial::Joint& j : scene.joints) t.begin("joint"), std::visit(WriteSpatialJoint{t}, j);
  for (const spatial::Contact& c : scene.contacts)
    if (!follows_in_set(c)) t.begin("contact"), std::visit(WriteSpatialContact{t}, c);
  for (const spatial::Collision& c : scene.collisions) {
    t.begin("collision"), t.word("name", c.name), t.law(c.law), t.number("neighbours", c.neighbours);
    std::string shapes;
    for (const spatial::Shape& s : c.shapes) {
      shapes += std::string(shapes.empty() ? "" : ", ") + "{body = \"" + t.name(s.body) + "\", ";
      if (s.sphere()) shapes += "centre = " + list_of(s.corners[0]) + ", ";
      if (!s.sphere())
        shapes += (s.capsule() ? "ends = " : "corners = ") + list_of(s.corners) + (s.capsule() ? ", " : "");
      shapes += s.polytope() ? "}" : "radius = " + text_of(s.radius) + "}";
    }
    t.line("shapes", "[" + shapes + "]");
  }
  for (const spatial::JointFriction& f : scene.frictions)
    t.begin("friction"), t.coordinate(f.of), t.number("bound", f.bound);
  for (const spatial::Spring& spring : scene.springs) {
    if (const auto* s = std::get_if<spatial::Drag>(&spring)) {
      if (s->component != 0) continue;
      t.begin("spring"), t.word("type", "drag"), t.word("body", t.name(s->a)), t.vector("point", s->point);
      t.maybe(s->turning ? "angular" : "linear", s->damping);
      t.maybe(s->turning ? "angular_quadratic" : "quadratic", s->quadratic);
      continue;
    }
    t.begin("spring");
    std::visit(
        [&](const auto& s) {
          if constexpr (requires { s.of; })
            t.word("type", "joint"), t.coordinate(s.of);
          else if constexpr (requires { s.point_a; })
            t.word("type", "point"), t.points(s);
          t.number("stiffness", s.stiffness), t.number("damping", s.damping), t.number("rest", s.rest);
        },
        spring);
  }
  for (const spatial::Load& l : scene.loads) {
    if (l.factor) throw std::invalid_argument("\"" + l.name + "\": this kind of element has no form in TOML");
    t.begin("load"), t.word("body", t.name(l.body)), t.vector("point", l.point), t.vector("force", l.force);
    t.vector("torque", l.moment), t.word("frame", l.frame == spatial::Frame::body ? "body" : "world");
  }
  return t.out;
}

}  // namespace orthant::motion_storm
