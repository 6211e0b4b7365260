#include <orthant/core/mechanics/scene/derivatives.h>
#include <orthant/core/mechanics/scene/element_check.h>
#include <orthant/core/mechanics/scene/scene.h>

#include <cmath>

namespace orthant {
namespace {

/// One element of a planar scene.
class Element : public ElementCheck<Scene> {
 public:
  Element(const Scene& scene, const Kinematics& start, std::string_view kind, std::size_t index,
          const std::string& name)
      : ElementCheck(scene, kind, index, name), start_(start) {}

  void loads(int joint) const {
    const auto* one = joint >= 0 && joint < static_cast<int>(scene_.joints.size())
                          ? &scene_.joints[static_cast<std::size_t>(joint)]
                          : nullptr;
    if (one != nullptr && (std::holds_alternative<Revolute>(*one) || std::holds_alternative<Prismatic>(*one))) return;
    const auto named = [](const auto& j) { return "joint \"" + j.name + "\" has no load for mu"; };
    fail("mu", (joint < 0        ? "no joint is named that mu could multiply the load of"
                : one == nullptr ? "joint " + std::to_string(joint) + " has no load for mu"
                                 : std::visit(named, *one)) +
                   ": must name a revolute or prismatic joint");
  }
  void law(const ContactLaw& law) const {
    friction("mu", law.mu), within("e_n", law.e, 0, 1), within("e_t", law.e_t, -1, 1);
    friction("mu_static", law.mu_static), finite("belt", law.belt);
    require(law.mu_static == 0 || law.mu_static >= law.mu, "mu_static", law.mu_static, ">= mu = " + text(law.mu));
  }

  /// The initial poses.
  const Kinematics& start() const { return start_; }
  /// Whether bodies are moved into their joints and journals before anything else.
  bool assembles() const { return scene_.assemble; }

 private:
  const Kinematics& start_;
};

void examine(const Element& e, const Body& b) {
  if (b.name == "ground") e.fail("name", "name = \"ground\": must not be ground, which is always there");
  e.invertible("mass", b.mass), e.invertible("inertia", b.inertia);
  e.finite("position", b.position), e.finite("angle", b.angle);
  e.finite("velocity", b.velocity), e.finite("omega", b.omega);
}

template <class T> void examine_points(const Element& e, const T& x) {
  e.pair(x.a, x.b), e.finite("point_a", x.point_a), e.finite("point_b", x.point_b);
}
void examine(const Element& e, const Revolute& j) { examine_points(e, j); }
void examine(const Element& e, const Prismatic& j) {
  examine_points(e, j), e.unit("axis", j.axis), e.finite("angle", j.angle);
}
void examine(const Element& e, const Fixed& j) { examine_points(e, j), e.finite("angle", j.angle); }
/// A distance of 0 has no direction along which something could act.
void apart(const Element& e, const Coordinate& c) {
  if (std::holds_alternative<Span>(c.kind()) && c.value(e.start()) == 0)
    e.fail("bodies", "its points start in one place: must be apart, their distance has no direction there");
}
void examine(const Element& e, const Distance& j) {
  examine_points(e, j), e.positive("length", j.length), apart(e, Span{j.a, j.b, j.point_a, j.point_b});
}

void examine(const Element& e, const Coordinate& c) {
  const auto one = [&](const auto& of) {
    e.pair(of.a, of.b);
    if constexpr (requires { of.point_a; }) e.finite("point_a", of.point_a), e.finite("point_b", of.point_b);
    if constexpr (requires { of.axis; }) e.unit("axis", of.axis);
  };
  std::visit(one, c.kind());
}
void examine(const Element& e, const Drive& j) {
  examine(e, j.of), apart(e, j.of), e.finite("offset", j.law.offset), e.finite("rate", j.law.rate_of_change);
  e.finite("amplitude", j.law.amplitude), e.finite("omega", j.law.omega), e.finite("phase", j.law.phase);
  if (const double start = j.law.value(0); std::holds_alternative<Span>(j.of.kind()) && start < 0)
    e.fail("offset", "starts at a distance of " + detail::text_of(start) + " m: must be ≥ 0");
}

void examine(const Element& e, const CustomJoint& j) {
  e.pair(j.a, j.b);
  if (j.row_count() < 1 || j.row_count() > 3)
    e.fail("kRows", "kRows = " + std::to_string(j.row_count()) + ": must be 1, 2 or 3");
  const std::optional<std::string> own = j.own_check(e.start());
  const std::string wrong = own ? *own : wrong_derivative(j, e.start());
  if (!wrong.empty()) e.fail("rows", wrong);
}

void examine(const Element& e, const CornerWall& c) {
  e.pair(c.a, c.b), e.finite("point", c.point);
  e.finite("wall_point", c.wall_point), e.unit("normal", c.normal), e.law(c.law);
}
void examine(const Element& e, const DiscWall& c) {
  e.pair(c.a, c.b), e.finite("centre", c.centre), e.positive("radius", c.radius);
  e.finite("wall_point", c.wall_point), e.unit("normal", c.normal), e.law(c.law);
}
void examine(const Element& e, const DiscDisc& c) {
  e.pair(c.a, c.b), e.finite("centre_a", c.centre_a), e.finite("centre_b", c.centre_b);
  e.positive("radius_a", c.radius_a), e.positive("radius_b", c.radius_b), e.law(c.law);
}
void examine(const Element& e, const std::string& field, const Polygon& corners) {
  for (const Vector2d& corner : corners) e.finite(field, corner);
  if (!convex(corners))
    e.fail(field, field + " (" + std::to_string(corners.size()) +
                      "): must be the corners of a convex polygon, counter-clockwise, no three in a line");
}
void examine(const Element& e, const DiscPolygon& c) {
  e.pair(c.a, c.b), e.finite("centre", c.centre), e.positive("radius", c.radius);
  examine(e, "corners", c.corners), e.law(c.law);
}
void examine(const Element& e, const PolygonPolygon& c) {
  e.pair(c.a, c.b), examine(e, "corners_a", c.corners_a), examine(e, "corners_b", c.corners_b), e.law(c.law);
  if (c.point != 0 && c.point != 1) e.fail("point", "point = " + std::to_string(c.point) + ": must be 0 or 1");
}
void examine(const Element& e, const Journal& c) {
  e.pair(c.a, c.b), e.finite("centre_a", c.centre_a), e.finite("centre_b", c.centre_b);
  e.positive("radius_a", c.radius_a), e.positive("radius_b", c.radius_b), e.law(c.law);
  e.require(c.radius_b > c.radius_a, "radius_b", c.radius_b, "> radius_a = " + e.text(c.radius_a));
  const double off = Span{c.a, c.b, c.centre_a, c.centre_b}.value(e.start());
  if (!(off <= c.radius_b) && !e.assembles())
    e.fail("bodies", "its centres start " + e.text(off) + " m apart: must be at most radius_b = " + e.text(c.radius_b) +
                         ", the pin is out of its hole");
}
void examine(const Element& e, const Limit& c) {
  examine(e, c.of), e.finite("bound", c.bound), e.law(c.law);
  if (c.side == Limit::Side::lower) apart(e, c.of);
  e.require(!c.law.frictional(), "mu", std::max(c.law.mu, c.law.mu_static), "0: a limit has no friction");
}

void examine(const Element& e, const CustomContact& c) {
  e.pair(c.a, c.b), e.law(c.law);
  const std::optional<std::string> own = c.own_check(e.start());
  const std::string wrong = own ? *own : wrong_derivative(c, e.start());
  if (!wrong.empty()) e.fail("rows", wrong);
}

void examine(const Element& e, const Collision& c) {
  for (std::size_t i = 0; i < c.shapes.size(); ++i) {
    const Shape& s = c.shapes[i];
    const std::string field = "shapes[" + std::to_string(i) + "].";
    e.exists(s.body);
    if (s.corners.empty())
      e.finite(field + "centre", s.centre), e.positive(field + "radius", s.radius);
    else
      examine(e, field + "corners", s.corners);
  }
  e.law(c.law), e.positive("neighbours", c.neighbours);
  e.require(c.neighbours <= 1e6, "neighbours", c.neighbours, "<= 1e6");
}

void examine(const Element& e, const JointFriction& f) {
  examine(e, f.of), apart(e, f.of), e.not_negative("bound", f.bound), e.friction("mu", f.mu),
      e.positive("radius", f.radius);
  if (f.loaded()) e.loads(f.joint);
}

void examine(const Element& e, const PointSpring& s) {
  examine_points(e, s), e.not_negative("stiffness", s.stiffness), e.not_negative("damping", s.damping);
  e.not_negative("rest", s.rest);
}
void examine(const Element& e, const TorsionSpring& s) {
  e.pair(s.a, s.b), e.not_negative("stiffness", s.stiffness), e.not_negative("damping", s.damping);
  e.finite("rest", s.rest);
}
void examine(const Element& e, const JointSpring& s) {
  examine(e, s.of), e.not_negative("stiffness", s.stiffness), e.not_negative("damping", s.damping);
  e.finite("rest", s.rest);
  if (s.rest != 0) apart(e, s.of);
}

void examine(const Element& e, const Load& l) {
  e.exists(l.body);
  if (l.body == kGround) e.fail("body", "body = \"ground\": must be a body that moves");
  e.finite("point", l.point), e.finite("force", l.force), e.finite("torque", l.torque);
  e.not_negative("omega", l.omega);
  for (std::size_t i = 0; i < l.breakpoints.size(); ++i) {
    e.finite("breakpoints", l.breakpoints[i]);
    e.require(i == 0 || l.breakpoints[i - 1] < l.breakpoints[i], "breakpoints", l.breakpoints[i], "ascending");
  }
}

template <class T> void examine_all(const Scene& scene, const Kinematics& start, std::string_view kind,
                                    const std::vector<T>& elements, std::size_t first = 0) {
  ElementNames names;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto one = [&](const auto& x) {
      const Element element(scene, start, kind, i, x.name);
      names.add(element, x.name);
      if (i >= first) examine(element, x);
    };
    if constexpr (requires { elements[i].index(); })
      std::visit(one, elements[i]);
    else
      one(elements[i]);
  }
}

Kinematics start_of(const Scene& scene) {
  Kinematics start;
  for (const Body& b : scene.bodies) start.pose.push_back({b.position, b.angle, std::cos(b.angle), std::sin(b.angle)});
  start.pose.emplace_back();
  return start;
}

}  // namespace

void check_contacts(const Scene& scene, std::size_t first) {
  examine_all(scene, start_of(scene), "contact", scene.contacts, first);
}

void check(const Scene& scene) {
  const Kinematics start = start_of(scene);
  const Element whole(scene, start, "", 0, "");
  whole.finite("gravity", scene.gravity);
  whole.positive("duration", scene.duration), whole.positive("step", scene.step);
  if (scene.bodies.empty()) whole.fail("body", "has no bodies: must have at least one");
  examine_all(scene, start, "body", scene.bodies);
  examine_all(scene, start, "joint", scene.joints);
  examine_all(scene, start, "contact", scene.contacts);
  examine_all(scene, start, "collision", scene.collisions);
  examine_all(scene, start, "friction", scene.frictions);
  examine_all(scene, start, "spring", scene.springs);
  examine_all(scene, start, "load", scene.loads);
}

Scene with_pairs_listed(const Scene& scene) {
  Scene listed = scene;
  listed.collisions.clear();
  for (const Collision& c : scene.collisions) {
    int count = 0;
    const auto add = [&](auto contact) {
      contact.name = c.name + "_" + std::to_string(++count), contact.law = c.law;
      listed.contact(std::move(contact));
    };
    each_pair(c, [&](const Pair& pair) {
      const Shape *x = &c.shapes[static_cast<std::size_t>(pair.a)], *y = &c.shapes[static_cast<std::size_t>(pair.b)];
      if (x->corners.empty() && y->corners.empty())
        return add(DiscDisc{{}, x->body, x->centre, x->radius, y->body, y->centre, y->radius, {}});
      if (!x->corners.empty() && !y->corners.empty())
        return add(PolygonPolygon{{}, x->body, x->corners, y->body, y->corners, pair.point, {}});
      if (!x->corners.empty()) std::swap(x, y);
      add(DiscPolygon{{}, x->body, x->centre, x->radius, y->body, y->corners, {}});
    });
  }
  return listed;
}

}  // namespace orthant
