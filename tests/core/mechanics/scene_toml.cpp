// Scenes from files: the same data as from C++, what is left out, what is overridden; nothing crashes.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>

#include <cctype>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "tests/support/runs.h"
#include "tests/support/scene_texts.h"

namespace orthant {
namespace {

using namespace scene_texts;

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

std::string dump(const Scene& scene) { return Dump().of(scene); }

}  // namespace

TEST_CASE("slider_crank.toml is slider_crank(), bit for bit") {
  const Scene from_file = read_scene(kCore / "scenes" / "slider_crank.toml");
  CHECK(dump(from_file) == dump(slider_crank()));
  CHECK(dump(from_file) != dump(slider_crank({.mu = std::nextafter(0.01, 1)})));  // the dump sees the last bit
}

namespace {

struct Example {
  std::string text;
  Strings elements;  // "contact.foot", "contact.foot.wall"
};

/// The ```toml blocks of the description.
std::vector<Example> examples(const std::string& description) {
  std::vector<Example> found;
  std::istringstream in(description);
  std::string line;
  bool inside = false;
  std::map<std::string, int> count;
  std::string kind;
  std::size_t element = 0;
  while (std::getline(in, line)) {
    if (line == "```toml") {
      inside = true, count.clear(), kind.clear();
      found.emplace_back();
    } else if (line == "```") {
      inside = false;
    } else if (inside) {
      Example& example = found.back();
      example.text += line + "\n";
      if (line.starts_with("[[")) {
        kind = line.substr(2, line.find(']') - 2);
        element = example.elements.size();
        example.elements.push_back(kind + "." + kind + std::to_string(++count[kind]));
      } else if (line.starts_with("name = ")) {
        example.elements[element] = kind + "." + line.substr(8, line.size() - 9);
      } else if (const auto brace = line.find(" = {"); brace != std::string::npos) {
        example.elements.push_back(example.elements[element] + "." + line.substr(0, brace));
      }
    }
  }
  return found;
}

/// From "## `[[kind]]`" to the next such headline.
std::string section(const std::string& description, const std::string& kind) {
  const auto begin = description.find("## `[[" + kind + "]]`");
  REQUIRE(begin != std::string::npos);
  return description.substr(begin, description.find("\n## ", begin) - begin);
}

Strings words(std::string list) {
  Strings found;
  std::replace_if(
      list.begin(), list.end(),
      [](char c) { return c != '_' && c != '-' && !std::isalnum(static_cast<unsigned char>(c)); }, ' ');
  std::istringstream in(list);
  for (std::string word; in >> word;) found.push_back(word);
  return found;
}

}  // namespace

TEST_CASE("every example of the format's description is a scene that runs") {
  const auto all = examples(contents(kCore / "scenes" / "README.md"));
  CHECK(all.size() >= 14);
  for (const Example& example : all) {
    CAPTURE(example.text);
    Scene scene;
    REQUIRE_NOTHROW(scene = parse_scene(example.text));
    const System system(scene);
    const State x = system.initial_state();
    Terms start(system);
    set_poses(system, x.t, x.q, start.at);
    evaluate_joint_residual(system, start), evaluate_joint_rows(system, start);
    for (Index i = 0; i < start.phi.size(); ++i) {
      CHECK(std::abs(start.phi[i]) < 1e-12);
      CHECK(std::abs(start.missing_rate(i, x.v)) < 1e-12);
    }
    scene.duration = 5 * scene.step;
    CHECK(run(scene, "moreau-jean", scene.step, {}, "auto").status == Status::solved);
  }
}

TEST_CASE("the complete scenes of the folder run") {
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(kCore / "scenes")) {
    if (file.path().extension() != ".toml") continue;
    CAPTURE(file.path().filename().string());
    Scene scene = read_scene(file);
    scene.duration = std::min(scene.duration, 500 * scene.step);
    CHECK(run(scene, "moreau-jean", scene.step, {}, "auto").status == Status::solved);
    ++files;
    CHECK(contains(contents(kCore / "scenes" / "README.md"), file.path().filename().string()));
  }
  CHECK(files >= 5);
}

TEST_CASE("the description shows every type and names every key that the reader knows") {
  const std::string description = contents(kCore / "scenes" / "README.md");
  const auto all = examples(description);
  const auto known = [](const std::string& error) { return words(error.substr(error.rfind("must be ") + 8)); };
  for (const std::string kind : {"joint", "contact", "spring"})
    for (const std::string& type : known(error_of(kBodies + "[[" + kind + "]]\ntype = \"?\""))) {
      if (type == "or") continue;
      CAPTURE(type);
      const bool shown = std::any_of(all.begin(), all.end(), [&](const Example& example) {
        return contains(example.text, "type = \"" + type + "\"");
      });
      CHECK(shown);
    }
  std::set<std::string> seen;
  for (const Example& example : all)
    for (const std::string& element : example.elements) {
      const std::string error = error_of(example.text, {element + ".no_such_key=1"});
      INFO("said: " << error);
      REQUIRE(contains(error, "no_such_key\": must be one of "));
      const std::string kind = element.substr(0, element.find('.'));
      const bool inner = std::count(element.begin(), element.end(), '.') == 2;
      const std::string prefix = inner ? element.substr(element.rfind('.') + 1) + "." : "";
      Strings keys = known(error);
      for (const std::string& key : Strings(keys.begin() + 2, keys.end())) {  // after "one of"
        CAPTURE(element);
        CAPTURE(key);
        seen.insert(kind);
        const auto named = [&](const std::string& text) {
          return contains(text, "`" + prefix + key + "`") || (inner && contains(text, "`" + key + "`")) ||
                 contains(text, key + " = ");
        };
        // The coordinates' keys are described with the joints.
        CHECK((named(section(description, kind)) || named(section(description, "joint"))));
      }
    }
  CHECK(seen.size() == 7);
  const std::string top = error_of("no_such_key = 1\n" + kBodies);
  for (const std::string& key : known(top)) {
    CAPTURE(key);
    if (key != "one" && key != "of")
      CHECK((contains(description, "`" + key + "`") || contains(description, "`[[" + key + "]]`")));
  }
}

TEST_CASE("a guide is the slider-crank's four corners, bit for bit") {
  Scene expected = slider_crank();
  for (std::size_t i = 0; i < 4; ++i)
    std::get<CornerWall>(expected.contacts[i]).name = "guide_" + std::to_string(i + 1);
  CHECK(dump(read_scene(kCore / "scenes" / "slider_crank_guide.toml")) == dump(expected));
}

TEST_CASE("every element and key arrives where it belongs") {
  const Scene scene = parse_scene(R"(
    gravity = [0.5, -2]
    duration = 3
    step = 0.25
    restitution = "poisson"
    impacts = "sequential"
    [[contact]]            # before the bodies: the order of the kinds is free
    type = "disc-wall"
    body = "ball"
    centre = [1, 2]
    radius = 3
    wall = {body = "rod", point = [4, 5], normal = [3, 4]}
    mu = 0.1
    e_n = 0.2
    e_t = 0.3
    [[body]]
    name = "rod"
    mass = 1
    inertia = 2
    [[body]]
    name = "ball"
    mass = 3
    inertia = 4
    position = [5, 6]
    angle = 7
    velocity = [8, 9]
    omega = 10
    [[contact]]
    name = "two"
    type = "disc-disc"
    bodies = ["rod", "ball"]
    centre_a = [1, 2]
    centre_b = [3, 4]
    radius_a = 5
    radius_b = 6
    [[contact]]
    type = "corner-wall"
    body = "rod"
    point = [1, 2]
    wall = {normal = [0, -7]}
    [[joint]]
    type = "prismatic"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    axis = [0, 2]
    angle = 5
    [[spring]]
    type = "point"
    bodies = ["ground", "rod"]
    point_a = [1, 2]
    point_b = [3, 4]
    stiffness = 5
    damping = 6
    rest = 7
    [[spring]]
    type = "torsion"
    bodies = ["ball", "ground"]
    stiffness = 5
    damping = 6
    rest = -7
    [[joint]]
    name = "pin"
    type = "revolute"
    bodies = ["ground", "rod"]
    [[joint]]
    type = "drive"
    joint = "pin"
    offset = 1
    rate = 2
    amplitude = 3
    omega = 4
    phase = 5
    table = {times = [0, 1], values = [6, 7]}
    [[joint]]
    type = "drive"
    of = "distance"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    rate = 0.5
    offset = 0
    [[contact]]
    name = "stop"
    type = "limit"
    joint = "joint1"
    lower = -1
    upper = 2
    e_n = 0.5
    [[contact]]
    type = "rope"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    length = 5
    [[contact]]
    name = "box"
    type = "polygon-wall"
    body = "rod"
    corners = [[0, 0], [1, 0], [0, 1]]
    wall = {body = "ball", point = [1, 2], normal = [0, 1]}
    mu = 0.5
    [[contact]]
    name = "two_boxes"
    type = "polygon-polygon"
    bodies = ["rod", "ball"]
    corners_a = [[0, 0], [1, 0], [0, 1]]
    corners_b = [[0, 0], [2, 0], [0, 2]]
    [[contact]]
    type = "disc-polygon"
    bodies = ["rod", "ball"]
    centre = [1, 2]
    radius = 3
    corners = [[0, 0], [2, 0], [0, 2]]
    [[contact]]
    type = "journal"
    bodies = ["rod", "ball"]
    centre_a = [1, 2]
    centre_b = [3, 4]
    radius_a = 5
    radius_b = 16
    mu_static = 0.7
    [[friction]]
    of = "slide"
    bodies = ["rod", "ball"]
    point_a = [1, 2]
    point_b = [3, 4]
    axis = [0, 3]
    bound = 5
    [[spring]]
    type = "joint"
    joint = "pin"
    stiffness = 5
    damping = 6
    rest = 7
    [[load]]
    body = "ball"
    point = [1, 2]
    force = [3, 4]
    torque = 5
    factor = {type = "cosine", amplitude = 2, omega = 3, phase = 4}
    [[load]]
    body = "rod"
    factor = {type = "table", times = [0, 1, 3], values = [2, 4, 0]}
  )");
  Scene expected{.gravity = {0.5, -2},
                 .restitution = Restitution::poisson,
                 .impacts = Impacts::sequential,
                 .duration = 3,
                 .step = 0.25};
  expected.body({"rod", 1, 2});
  expected.body({"ball", 3, 4, {5, 6}, 7, {8, 9}, 10});
  expected.contact(DiscWall{"", 1, {1, 2}, 3, 0, {4, 5}, {0.6, 0.8}, {0.1, 0.2, 0.3}});
  expected.contact(DiscDisc{"two", 0, {1, 2}, 5, 1, {3, 4}, 6, {}});
  expected.contact(CornerWall{"", 0, {1, 2}, kGround, {0, 0}, {0, -1}, {}});
  expected.joint(Prismatic{"", 0, 1, {1, 2}, {3, 4}, {0, 1}, 5});
  expected.spring(PointSpring{"", kGround, 0, {1, 2}, {3, 4}, 5, 6, 7});
  expected.spring(TorsionSpring{"", 1, kGround, 5, 6, -7});
  expected.joint(Revolute{"pin", kGround, 0});
  expected.joint(Drive{"", Angle{kGround, 0}, {1, 2, 3, 4, 5, Spline({0, 1}, {6, 7})}});
  expected.joint(Drive{"", Span{0, 1, {1, 2}, {3, 4}}, {.rate_of_change = 0.5}});
  const Slide rail{0, 1, {1, 2}, {3, 4}, {0, 1}};
  expected.contact(Limit{"stop_lower", rail, Limit::Side::lower, -1, {.e = 0.5}});
  expected.contact(Limit{"stop_upper", rail, Limit::Side::upper, 2, {.e = 0.5}});
  expected.contact(Limit{"contact5", Span{0, 1, {1, 2}, {3, 4}}, Limit::Side::upper, 5, {}});
  const Polygon small{{0, 0}, {1, 0}, {0, 1}}, large{{0, 0}, {2, 0}, {0, 2}};
  for (int i = 0; i < 3; ++i)
    expected.contact(CornerWall{
        "box_" + std::to_string(i + 1), 0, small[static_cast<std::size_t>(i)], 1, {1, 2}, {0, 1}, {.mu = 0.5}});
  expected.contact(PolygonPolygon{"two_boxes_1", 0, small, 1, large, 0, {}});
  expected.contact(PolygonPolygon{"two_boxes_2", 0, small, 1, large, 1, {}});
  expected.contact(DiscPolygon{"contact8", 0, {1, 2}, 3, 1, large, {}});
  expected.contact(Journal{"contact9", 0, {1, 2}, 5, 1, {3, 4}, 16, {.mu_static = 0.7}});
  expected.friction({"", rail, 5});
  expected.spring(JointSpring{"", Angle{kGround, 0}, 5, 6, 7});
  expected.load({"", 1, {1, 2}, {3, 4}, 5, [](double t) { return 2 * std::cos(3 * t + 4); }});
  expected.load({"", 0, {0, 0}, {0, 0}, 0, [](double t) {
                   return t < 0 ? 2.0 : t < 1 ? 2 + 2 * t : t < 3 ? 6 - 2 * t : 0;
                 }});
  // The table's values are compared to rounding, everything else by its bits.
  for (const double t : {-1.0, 0.0, 0.3, 1.0, 2.5, 3.0, 9.0})
    CHECK(scene.loads[1].factor(t) == doctest::Approx(expected.loads[1].factor(t)).epsilon(1e-15));
  expected.loads[1].factor = scene.loads[1].factor;
  CHECK(dump(scene) == dump(expected));
}

TEST_CASE("angles, lengths and rests that are left out are those of the initial pose") {
  const Scene scene = parse_scene(kBodies + R"(
    [[joint]]
    type = "prismatic"
    bodies = ["ball", "cart"]
    [[joint]]
    type = "fixed"
    bodies = ["ball", "cart"]
    [[joint]]
    type = "distance"
    bodies = ["ground", "cart"]
    [[spring]]
    type = "point"
    bodies = ["ground", "cart"]
    point_a = [3, 0]
    [[spring]]
    type = "torsion"
    bodies = ["cart", "rod"]
    [[spring]]
    type = "joint"
    joint = "joint1"
    [[joint]]
    type = "drive"
    joint = "joint1"
    amplitude = 2
    phase = 1
  )");
  CHECK(std::get<JointSpring>(scene.springs[2]).rest == 3);
  CHECK(std::get<Drive>(scene.joints[3]).law.value(0) == 3);
  CHECK(std::get<Prismatic>(scene.joints[0]).angle == 0.5);
  CHECK(std::get<Fixed>(scene.joints[1]).angle == -0.5);
  CHECK(std::get<Distance>(scene.joints[2]).length == 5);
  CHECK(std::get<PointSpring>(scene.springs[0]).rest == 4);
  CHECK(std::get<TorsionSpring>(scene.springs[1]).rest == 0.5);
}

TEST_CASE("a contact without a name is known by its place in the file, however many it stands for") {
  const std::string wall =
      "[[contact]]\ntype = \"polygon-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1]}\n"
      "corners = [[0, 0], [1, 0], [0, 1]]\n";
  const Scene scene = parse_scene(kBodies + wall + wall, Strings{"contact.contact2.mu=0.5"});
  REQUIRE(scene.contacts.size() == 6);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& corner = std::get<CornerWall>(scene.contacts[i]);
    CHECK(corner.name == (i < 3 ? "contact1_" : "contact2_") + std::to_string(i % 3 + 1));
    CHECK(corner.law.mu == (i < 3 ? 0 : 0.5));
  }
}

TEST_CASE("overrides change the named values and nothing else") {
  const auto foot = [](const Strings& sets) { return std::get<CornerWall>(parse_scene(kCorner, sets).contacts[0]); };
  CHECK(foot({"contact.foot.mu=0.1"}).law.mu == 0.1);
  CHECK(foot({"contact.foot.wall.normal=[1, 0]"}).normal == Vector2d(1, 0));
  CHECK(foot({"contact.foot.wall.point=[1, 0]"}).normal == Vector2d(0, 1));         // a key path adds
  CHECK(foot({"contact.foot.wall={normal = [-3, 0]}"}).normal == Vector2d(-1, 0));  // an inline table replaces
  CHECK(foot({"contact.foot.wall.body=\"ball\""}).b == 2);
  CHECK(parse_scene(kCorner, Strings{"gravity=[0, 0]", "step = 0.5", "contact = []"}).contacts.empty());
  CHECK(parse_scene(kCorner, Strings{"body.cart.omega=-0.01"}).bodies[1].omega == -0.01);
  CHECK(parse_scene(kCorner + "[[load]]\nbody = \"rod\"", Strings{"load.load1.torque=3"}).loads[0].torque == 3);

  const Strings sets{"contact.corner3.mu=0.5", "body.slider.omega=-0.01"};
  Scene expected = slider_crank({.omega3 = -0.01});
  std::get<CornerWall>(expected.contacts[2]).law.mu = 0.5;
  CHECK(dump(read_scene(kCore / "scenes" / "slider_crank.toml", sets)) == dump(expected));
}

TEST_CASE("a factor can be given and replaced by overrides") {
  const std::string text = kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [0], values = [3]}";
  CHECK(parse_scene(text).loads[0].factor(5) == 3);
  const Strings replaced{"load.load1.factor={type = \"cosine\", omega = 0}"};
  CHECK(parse_scene(text, replaced).loads[0].factor(5) == 1);
  const Strings built{"load.load1.factor.type=\"cosine\"", "load.load1.factor.omega=0",
                      "load.load1.factor.amplitude=2"};
  CHECK(parse_scene(kBodies + "[[load]]\nbody = \"rod\"", built).loads[0].factor(5) == 2);
}

TEST_CASE("built-in scenes take options, files take overrides, anything else lists what there is") {
  CHECK(dump(make_scene("slider_crank")) == dump(slider_crank()));
  CHECK(dump(make_scene("slider_crank_ideal")) == dump(slider_crank_ideal()));
  const Strings options{"mu=0.1", "e=0.9,e_t=0.2", "clearance=0.002", "theta3=0.001", "omega3=-0.01"};
  CHECK(dump(make_scene("slider_crank", options)) ==
        dump(slider_crank({.mu = 0.1, .e = 0.9, .e_t = 0.2, .clearance = 0.002, .theta3 = 0.001, .omega3 = -0.01})));
  CHECK(dump(make_scene((kCore / "scenes" / "slider_crank.toml").string(), Strings{"contact.corner1.mu=0.5"})) !=
        dump(slider_crank()));
  for (const SceneEntry& entry : scenes()) CHECK_NOTHROW(check(entry.make({})));

  const auto error = [](const std::string& name, const Strings& sets) -> std::string {
    try {
      make_scene(name, sets);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return {};
  };
  const std::string unknown = error("slidercrank", {});
  CHECK(contains(unknown, "unknown scene 'slidercrank': must be a TOML file that exists or one of bouncing_ball, "));
  for (const SceneEntry& entry : scenes()) CHECK(contains(unknown, std::string(entry.name)));
  CHECK(contains(error("slider_crank", {"muu=1"}), "unknown option 'muu': must be one of mu, e, e_t, clearance"));
  CHECK(contains(error("slider_crank", {"mu=0.1", "mu=0.2"}), "option 'mu=0.2': is given twice"));
  CHECK(contains(error("slider_crank", {"e=2"}), "option e = 2: must be in [0, 1]"));
  CHECK(contains(error("slider_crank", {"mu=nan"}), "option mu = nan: must be in"));
  CHECK(contains(error("slider_crank_ideal", {"mu=1"}), "unknown option 'mu'"));
  CHECK(contains(error(kCore.string(), {}), "must be a file that exists"));  // a folder
  CHECK(contains(error("", {}), "unknown scene ''"));
}

TEST_CASE("files with random damage are scenes or errors, never anything else") {
  const auto all = examples(contents(kCore / "scenes" / "README.md"));
  std::mt19937 random(1);
  const std::string alphabet = "[]{}=.,\"'#\n\\ -e0\xc3\x01";
  for (std::size_t i = 0; i < 200 * all.size(); ++i) {
    std::string text = all[i % all.size()].text;
    for (unsigned k = 0; k <= random() % 3; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        default:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
      }
    }
    try {
      check(parse_scene(text));
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace orthant
