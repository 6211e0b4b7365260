// Writer of scenes as TOML text that scene_toml.h reads.
#include "experiments/studies/motion_storm/scenes.h"

#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/core/support/options.h>

#include <stdexcept>

namespace orthant::motion_storm {
namespace {

using detail::text_of;

/// Lines of one file; every key on a line of its own.
class Text {
 public:
  explicit Text(const Scene& scene) : scene_(scene) {}

  void begin(const char* kind) { out += std::string("\n[[") + kind + "]]\n"; }
  void word(const char* key, const std::string& value) { out += std::string(key) + " = \"" + value + "\"\n"; }
  void line(const char* key, const std::string& value) { out += std::string(key) + " = " + value + '\n'; }
  void number(const char* key, double value) { line(key, text_of(value)); }
  void maybe(const char* key, double value) {
    if (value != 0) number(key, value);
  }
  void point(const char* key, const Vector2d& p) { line(key, of(p)); }
  void corners(const char* key, const Polygon& corners_) {
    std::string list;
    for (const Vector2d& c : corners_) list += (list.empty() ? "" : ", ") + of(c);
    line(key, "[" + list + "]");
  }
  void bodies(BodyId a, BodyId b) { line("bodies", "[\"" + name(a) + "\", \"" + name(b) + "\"]"); }
  void law(const ContactLaw& l) {
    maybe("mu", l.mu), maybe("e_n", l.e), maybe("e_t", l.e_t), maybe("mu_static", l.mu_static), maybe("belt", l.belt);
  }
  void wall(BodyId b, const Vector2d& at, const Vector2d& normal) {
    line("wall", "{body = \"" + name(b) + "\", point = " + of(at) + ", normal = " + of(normal) + "}");
  }
  void coordinate(const Coordinate& c) {
    for (const auto& [key, value] : entries(c)) line(key.c_str(), value);
  }
  void terms(const CoordinateSum& sum) {
    std::string list;
    for (const CoordinateTerm& term : sum.terms()) {
      std::string table = "factor = " + text_of(term.factor);
      for (const auto& [key, value] : entries(term.of)) table += ", " + key + " = " + value;
      list += (list.empty() ? "{" : ", {") + table + "}";
    }
    line("terms", "[" + list + "]");
  }
  std::string name(BodyId b) const { return b < 0 ? "ground" : scene_.bodies[static_cast<std::size_t>(b)].name; }
  static std::string of(const Vector2d& p) { return "[" + text_of(p.x()) + ", " + text_of(p.y()) + "]"; }

  std::string out;

 private:
  std::vector<std::pair<std::string, std::string>> entries(const Coordinate& c) const {
    std::vector<std::pair<std::string, std::string>> all;
    std::visit(
        [&](const auto& x) {
          using T = std::decay_t<decltype(x)>;
          const char* kind = std::is_same_v<T, Angle> ? "angle" : std::is_same_v<T, Slide> ? "slide" : "distance";
          all.emplace_back("of", "\"" + std::string(kind) + "\"");
          all.emplace_back("bodies", "[\"" + name(x.a) + "\", \"" + name(x.b) + "\"]");
          if constexpr (requires { x.point_a; })
            all.emplace_back("point_a", of(x.point_a)), all.emplace_back("point_b", of(x.point_b));
          if constexpr (requires { x.axis; }) all.emplace_back("axis", of(x.axis));
        },
        c.kind());
    return all;
  }

  const Scene& scene_;
};

[[noreturn]] void unknown(const std::string& name) {
  throw std::invalid_argument("\"" + name + "\": this kind of element has no form in TOML");
}

struct WriteJoint {
  Text& t;
  template <class J> void points(const J& j, const char* type) {
    t.word("type", type), t.bodies(j.a, j.b), t.point("point_a", j.point_a), t.point("point_b", j.point_b);
  }
  void operator()(const Revolute& j) { points(j, "revolute"); }
  void operator()(const Prismatic& j) { points(j, "prismatic"), t.point("axis", j.axis), t.number("angle", j.angle); }
  void operator()(const Fixed& j) { points(j, "fixed"), t.number("angle", j.angle); }
  void operator()(const Distance& j) { points(j, "distance"), t.number("length", j.length); }
  void operator()(const Drive& j) {
    t.word("type", "drive"), t.coordinate(j.of), t.number("offset", j.law.offset);
    t.maybe("rate", j.law.rate_of_change), t.maybe("amplitude", j.law.amplitude), t.maybe("omega", j.law.omega);
    t.maybe("phase", j.law.phase);
  }
  void operator()(const CustomJoint& j) {
    const auto* relation = j.target<Relation>();
    if (relation == nullptr) unknown(j.name);
    t.word("type", "relation"), t.terms(relation->sum), t.number("offset", relation->offset);
  }
};

struct WriteContact {
  Text& t;
  void operator()(const CornerWall& c) {
    t.word("type", "corner-wall"), t.word("body", t.name(c.a)), t.point("point", c.point);
    t.wall(c.b, c.wall_point, c.normal), t.law(c.law);
  }
  void operator()(const DiscWall& c) {
    t.word("type", "disc-wall"), t.word("body", t.name(c.a)), t.point("centre", c.centre);
    t.number("radius", c.radius), t.wall(c.b, c.wall_point, c.normal), t.law(c.law);
  }
  void discs(const auto& c, const char* type) {
    t.word("type", type), t.bodies(c.a, c.b), t.point("centre_a", c.centre_a), t.point("centre_b", c.centre_b);
    t.number("radius_a", c.radius_a), t.number("radius_b", c.radius_b), t.law(c.law);
  }
  void operator()(const DiscDisc& c) { discs(c, "disc-disc"); }
  void operator()(const Journal& c) { discs(c, "journal"); }
  void operator()(const DiscPolygon& c) {
    t.word("type", "disc-polygon"), t.bodies(c.a, c.b), t.point("centre", c.centre), t.number("radius", c.radius);
    t.corners("corners", c.corners), t.law(c.law);
  }
  void operator()(const PolygonPolygon& c) {  // point 0 stands for both
    t.word("type", "polygon-polygon"), t.bodies(c.a, c.b), t.corners("corners_a", c.corners_a);
    t.corners("corners_b", c.corners_b), t.law(c.law);
  }
  void operator()(const Limit& c) {
    t.word("type", "limit"), t.coordinate(c.of);
    t.number(c.side == Limit::Side::lower ? "lower" : "upper", c.bound), t.maybe("e_n", c.law.e);
  }
  void operator()(const CustomContact& c) {
    const auto* limit = c.target<RelationLimit>();
    if (limit == nullptr) unknown(c.name);
    t.word("type", "relation"), t.terms(limit->sum), t.maybe("e_n", limit->law.e);
    t.number(limit->side == Limit::Side::lower ? "lower" : "upper", limit->bound);
  }
};

struct WriteSpring {
  Text& t;
  void operator()(const PointSpring& s) {
    t.word("type", "point"), t.bodies(s.a, s.b), t.point("point_a", s.point_a), t.point("point_b", s.point_b);
    values(s);
  }
  void operator()(const TorsionSpring& s) { t.word("type", "torsion"), t.bodies(s.a, s.b), values(s); }
  void operator()(const JointSpring& s) { t.word("type", "joint"), t.coordinate(s.of), values(s); }
  void values(const auto& s) {
    t.number("stiffness", s.stiffness), t.number("damping", s.damping), t.number("rest", s.rest);
  }
};

}  // namespace

std::string to_toml(const Scene& scene, const std::string& comment) {
  Text t(scene);
  for (std::size_t from = 0; from < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', from), comment.size());
    t.out += "# " + comment.substr(from, end - from) + '\n';
    from = end + 1;
  }
  t.point("gravity", scene.gravity), t.number("duration", scene.duration), t.number("step", scene.step);
  for (const Body& b : scene.bodies) {
    t.begin("body"), t.word("name", b.name), t.number("mass", b.mass), t.number("inertia", b.inertia);
    t.point("position", b.position), t.maybe("angle", b.angle);
    if (!b.velocity.isZero(0)) t.point("velocity", b.velocity);
    t.maybe("omega", b.omega);
  }
  for (const Joint& j : scene.joints) t.begin("joint"), std::visit(WriteJoint{t}, j);
  for (const Contact& c : scene.contacts) {
    if (const auto* pair = std::get_if<PolygonPolygon>(&c); pair != nullptr && pair->point != 0) continue;
    t.begin("contact"), std::visit(WriteContact{t}, c);
  }
  for (const Spring& s : scene.springs) t.begin("spring"), std::visit(WriteSpring{t}, s);
  for (const Load& l : scene.loads) {
    if (l.factor) unknown(l.name);
    t.begin("load"), t.word("body", t.name(l.body)), t.point("point", l.point), t.point("force", l.force);
    t.maybe("torque", l.torque);
  }
  return t.out;
}

}  // namespace orthant::motion_storm
