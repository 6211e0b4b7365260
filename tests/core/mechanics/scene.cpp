// check(scene): every rule refuses, in one line that names element, field, value and rule.
#include <doctest/doctest.h>
#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/scenes/slider_crank.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kHuge = std::numeric_limits<double>::infinity();

/// A valid scene with one element of every kind.
Scene everything() {
  Scene s{.gravity = {0, -9.81}};
  s.body({.name = "rod"}), s.body({.name = "cart", .position = {3, 0}}), s.body({.name = "ball", .position = {6, 0}});
  s.joint(Revolute{"pin", kGround, 0});
  s.joint(Prismatic{"rail", kGround, 1});
  s.joint(Fixed{"weld", 0, 1});
  s.joint(Distance{"link", 1, 2});
  s.contact(CornerWall{"corner", 0, {1, 0}, kGround, {0, 0}, {0, 1}, {}});
  s.contact(DiscWall{"disc", 2, {0, 0}, 1, 1, {0, 0}, {0.6, 0.8}, {}});
  s.contact(DiscDisc{"discs", 2, {0, 0}, 1, 0, {0, 0}, 1, {}});
  s.contact(DiscPolygon{"cam", 2, {0, 0}, 1, 0, rectangle(1, 1), {}});
  s.contact_set(polygon_polygon({"boxes", 1, rectangle(1, 1), 2, rectangle(2, 1), 0, {}}));
  s.contact(Journal{"bearing", 1, {0, 0}, 1, 0, {3, 0}, 1.1, {}});
  s.contact(Limit{"stop", Angle{kGround, 0}, Limit::Side::upper, 1, {}});
  s.joint(Drive{"motor", Slide{kGround, 2}, {}});
  s.friction({"brake", Angle{kGround, 0}, 1});
  s.spring(JointSpring{"clock", Angle{kGround, 0}});
  s.spring(PointSpring{"coil", 0, 1});
  s.spring(TorsionSpring{"hinge", kGround, 2});
  s.load({.name = "push", .body = 1});
  return s;
}

struct Mistake {
  void (*make)(Scene&);
  std::string message;
};

template <class T, class List> T& at(List& list, std::size_t i) { return std::get<T>(list[i]); }

const Mistake kMistakes[] = {
    {[](Scene& s) { s.gravity.x() = kNan; }, "scene: gravity = (nan, -9.81): must be finite"},
    {[](Scene& s) { s.duration = 0; }, "scene: duration = 0: must be > 0"},
    {[](Scene& s) { s.duration = kHuge; }, "scene: duration = inf: must be finite"},
    {[](Scene& s) { s.step = -1e-3; }, "scene: step = -0.001: must be > 0"},
    {[](Scene& s) { s = Scene{}; }, "scene: has no bodies: must have at least one"},

    {[](Scene& s) { s.bodies[0].mass = -1; }, "body \"rod\": mass = -1: must be > 0"},
    {[](Scene& s) { s.bodies[0].mass = 0; }, "body \"rod\": mass = 0: must be > 0"},
    {[](Scene& s) { s.bodies[0].mass = kNan; }, "body \"rod\": mass = nan: must be finite"},
    {[](Scene& s) { s.bodies[0].mass = kHuge; }, "body \"rod\": mass = inf: must be finite"},
    {[](Scene& s) { s.bodies[0].mass = 1e-310; }, "body \"rod\": mass = 1e-310: must be >= 1e-300"},
    {[](Scene& s) { s.bodies[2].inertia = 0; }, "body \"ball\": inertia = 0: must be > 0"},
    {[](Scene& s) { s.bodies[2].position.y() = kHuge; }, "body \"ball\": position = (6, inf): must be finite"},
    {[](Scene& s) { s.bodies[2].angle = kNan; }, "body \"ball\": angle = nan: must be finite"},
    {[](Scene& s) { s.bodies[2].mass = 1e300; }, "body \"ball\": mass = 1e+300: must be <= 1e+150"},
    {[](Scene& s) { s.bodies[2].angle = 1e300; }, "body \"ball\": angle = 1e+300: must be between -1e+150 and 1e+150"},
    {[](Scene& s) { s.bodies[2].position.x() = -1e151; },
     "body \"ball\": position = (-1e+151, 0): must be between -1e+150 and 1e+150"},
    {[](Scene& s) { s.bodies[2].velocity.x() = -kHuge; }, "body \"ball\": velocity = (-inf, 0): must be finite"},
    {[](Scene& s) { s.bodies[2].omega = kNan; }, "body \"ball\": omega = nan: must be finite"},

    {[](Scene& s) { s.bodies[1].name = ""; }, "body \"\": name = \"\": must be of letters, digits, _ and -"},
    {[](Scene& s) { s.bodies[1].name = "a.b"; }, "body \"a.b\": name = \"a.b\": must be of letters, digits, _ and -"},
    {[](Scene& s) { s.bodies[1].name = "ground"; },
     "body \"ground\": name = \"ground\": must not be ground, which is always there"},
    {[](Scene& s) { s.bodies[1].name = "rod"; }, "body \"rod\": name = \"rod\": must be distinct, is taken"},
    {[](Scene& s) { at<Fixed>(s.joints, 2).name = "pin"; },
     "joint \"pin\": name = \"pin\": must be distinct, is taken"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).name = "disc"; },
     "contact \"disc\": name = \"disc\": must be distinct, is taken"},
    {[](Scene& s) { at<TorsionSpring>(s.springs, 2).name = "a b"; },
     "spring \"a b\": name = \"a b\": must be of letters, digits, _ and -"},
    {[](Scene& s) { s.loads.push_back(s.loads[0]); }, "load \"push\": name = \"push\": must be distinct, is taken"},

    {[](Scene& s) { at<Revolute>(s.joints, 0).b = 7; },
     "joint \"pin\": body 7 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) { at<Revolute>(s.joints, 0).a = -2; },
     "joint \"pin\": body -2 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) { at<Fixed>(s.joints, 2).a = 1; },
     "joint \"weld\": joins body \"cart\" to itself: must be two different bodies"},
    {[](Scene& s) { at<Revolute>(s.joints, 0).b = kGround; },
     "joint \"pin\": joins the ground to itself: must be two different bodies"},
    {[](Scene& s) { at<Revolute>(s.joints, 0).point_a.x() = kNan; },
     "joint \"pin\": point_a = (nan, 0): must be finite"},
    {[](Scene& s) { at<Distance>(s.joints, 3).point_b.y() = kNan; },
     "joint \"link\": point_b = (0, nan): must be finite"},
    {[](Scene& s) {
       at<Prismatic>(s.joints, 1).axis = {1, 1};
     },
     "joint \"rail\": axis = (1, 1): must be a unit vector"},
    {[](Scene& s) {
       at<Prismatic>(s.joints, 1).axis = {0, 0};
     },
     "joint \"rail\": axis = (0, 0): must be a unit vector"},
    {[](Scene& s) { at<Prismatic>(s.joints, 1).angle = kNan; }, "joint \"rail\": angle = nan: must be finite"},
    {[](Scene& s) { at<Fixed>(s.joints, 2).angle = kHuge; }, "joint \"weld\": angle = inf: must be finite"},
    {[](Scene& s) { at<Distance>(s.joints, 3).length = 0; }, "joint \"link\": length = 0: must be > 0"},
    {[](Scene& s) { at<Distance>(s.joints, 3).length = kHuge; }, "joint \"link\": length = inf: must be finite"},

    {[](Scene& s) { at<CornerWall>(s.contacts, 0).a = 7; },
     "contact \"corner\": body 7 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).b = 0; },
     "contact \"corner\": joins body \"rod\" to itself: must be two different bodies"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).point.x() = kNan; },
     "contact \"corner\": point = (nan, 0): must be finite"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).wall_point.x() = kNan; },
     "contact \"corner\": wall_point = (nan, 0): must be finite"},
    {[](Scene& s) {
       at<CornerWall>(s.contacts, 0).normal = {0, 2};
     },
     "contact \"corner\": normal = (0, 2): must be a unit vector"},
    {[](Scene& s) { at<DiscWall>(s.contacts, 1).normal.y() = kNan; },
     "contact \"disc\": normal = (0.6, nan): must be finite"},
    {[](Scene& s) { at<DiscWall>(s.contacts, 1).radius = 0; }, "contact \"disc\": radius = 0: must be > 0"},
    {[](Scene& s) { at<DiscWall>(s.contacts, 1).centre.x() = kHuge; },
     "contact \"disc\": centre = (inf, 0): must be finite"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).radius_a = -2; }, "contact \"discs\": radius_a = -2: must be > 0"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).radius_b = 0; }, "contact \"discs\": radius_b = 0: must be > 0"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).centre_b.x() = kNan; },
     "contact \"discs\": centre_b = (nan, 0): must be finite"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law.mu = -0.1; }, "contact \"corner\": mu = -0.1: must be >= 0"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law.mu = 1e300; },
     "contact \"corner\": mu = 1e+300: must be <= 1e+06"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law.mu = kHuge; }, "contact \"corner\": mu = inf: must be finite"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law.mu = kNan; }, "contact \"corner\": mu = nan: must be finite"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law = {.mu = 0.5, .mu_static = 0.4}; },
     "contact \"corner\": mu_static = 0.4: must be >= mu = 0.5"},
    {[](Scene& s) { at<CornerWall>(s.contacts, 0).law.mu_static = kNan; },
     "contact \"corner\": mu_static = nan: must be finite"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).law.belt = kHuge; }, "contact \"discs\": belt = inf: must be finite"},
    {[](Scene& s) { at<DiscWall>(s.contacts, 1).law.e = 1.5; }, "contact \"disc\": e_n = 1.5: must be in [0, 1]"},
    {[](Scene& s) { at<DiscWall>(s.contacts, 1).law.e = kNan; }, "contact \"disc\": e_n = nan: must be in [0, 1]"},
    {[](Scene& s) { at<DiscDisc>(s.contacts, 2).law.e_t = -2; }, "contact \"discs\": e_t = -2: must be in [-1, 1]"},

    {[](Scene& s) { at<DiscPolygon>(s.contacts, 3).radius = 0; }, "contact \"cam\": radius = 0: must be > 0"},
    {[](Scene& s) {
       at<DiscPolygon>(s.contacts, 3).corners.pop_back(), at<DiscPolygon>(s.contacts, 3).corners.pop_back();
     },
     "contact \"cam\": corners (2): must be the corners of a convex polygon, counter-clockwise, no three in a line"},
    {[](Scene& s) { at<PolygonPolygon>(s.contacts, 4).corners_a[1].x() = kNan; },
     "contact \"boxes_1\": corners_a = (nan, -0.5): must be finite"},
    {[](Scene& s) {
       std::reverse(at<PolygonPolygon>(s.contacts, 5).corners_b.begin(),
                    at<PolygonPolygon>(s.contacts, 5).corners_b.end());
     },
     "contact \"boxes_2\": corners_b (4): must be the corners of a convex polygon, counter-clockwise, no three in a "
     "line"},
    {[](Scene& s) {  // a pentagram: every corner a left turn
       Polygon star;
       for (int i = 0; i < 5; ++i) star.emplace_back(std::cos(i * 2.513274122871834), std::sin(i * 2.513274122871834));
       at<PolygonPolygon>(s.contacts, 5).corners_b = star;
     },
     "contact \"boxes_2\": corners_b (5): must be the corners of a convex polygon, counter-clockwise, no three in a "
     "line"},
    {[](Scene& s) { at<PolygonPolygon>(s.contacts, 5).point = 2; }, "contact \"boxes_2\": point = 2: must be 0 or 1"},
    {[](Scene& s) { at<Journal>(s.contacts, 6).radius_b = 1; },
     "contact \"bearing\": radius_b = 1: must be > radius_a = 1"},
    {[](Scene& s) { at<Journal>(s.contacts, 6).b = 1; },
     "contact \"bearing\": joins body \"cart\" to itself: must be two different bodies"},
    {[](Scene& s) { at<Limit>(s.contacts, 7).bound = kNan; }, "contact \"stop\": bound = nan: must be finite"},
    {[](Scene& s) { at<Limit>(s.contacts, 7).law.mu_static = 0.1; },
     "contact \"stop\": mu = 0.1: must be 0: a limit has no friction"},
    {[](Scene& s) { at<Drive>(s.joints, 4).law.rate_of_change = kHuge; },
     "joint \"motor\": rate = inf: must be finite"},
    {[](Scene& s) {
       at<Drive>(s.joints, 4).of = Slide{kGround, 2, {0, 0}, {0, 0}, {1, 1}};
     },
     "joint \"motor\": axis = (1, 1): must be a unit vector"},
    {[](Scene& s) {
       at<Drive>(s.joints, 4).of = Span{0, 9};
     },
     "joint \"motor\": body 9 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) { s.frictions[0].bound = -1; }, "friction \"brake\": bound = -1: must be >= 0"},
    {[](Scene& s) { at<JointSpring>(s.springs, 0).rest = kNan; }, "spring \"clock\": rest = nan: must be finite"},

    {[](Scene& s) { at<PointSpring>(s.springs, 1).b = 3; },
     "spring \"coil\": body 3 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) { at<PointSpring>(s.springs, 1).stiffness = -1; }, "spring \"coil\": stiffness = -1: must be >= 0"},
    {[](Scene& s) { at<PointSpring>(s.springs, 1).damping = kNan; }, "spring \"coil\": damping = nan: must be finite"},
    {[](Scene& s) { at<PointSpring>(s.springs, 1).rest = -1; }, "spring \"coil\": rest = -1: must be >= 0"},
    {[](Scene& s) { at<TorsionSpring>(s.springs, 2).damping = -1; }, "spring \"hinge\": damping = -1: must be >= 0"},
    {[](Scene& s) { at<TorsionSpring>(s.springs, 2).rest = kHuge; }, "spring \"hinge\": rest = inf: must be finite"},
    {[](Scene& s) { at<TorsionSpring>(s.springs, 2).b = kGround; },
     "spring \"hinge\": joins the ground to itself: must be two different bodies"},

    {[](Scene& s) { s.loads[0].body = 9; }, "load \"push\": body 9 does not exist (the scene has 3 bodies)"},
    {[](Scene& s) {
       s.loads[0].breakpoints = {1, 1};
     },
     "load \"push\": breakpoints = 1: must be ascending"},
    {[](Scene& s) { s.loads[0].body = kGround; }, "load \"push\": body = \"ground\": must be a body that moves"},
    {[](Scene& s) { s.loads[0].point.x() = kNan; }, "load \"push\": point = (nan, 0): must be finite"},
    {[](Scene& s) { s.loads[0].force.y() = kNan; }, "load \"push\": force = (0, nan): must be finite"},
    {[](Scene& s) { s.loads[0].torque = kHuge; }, "load \"push\": torque = inf: must be finite"},
};

}  // namespace

TEST_CASE("scenes that keep the rules pass, on their borders too") {
  CHECK_NOTHROW(check(everything()));
  CHECK_NOTHROW(check(slider_crank()));
  CHECK_NOTHROW(check(slider_crank_ideal()));
  Scene s = everything();
  at<PointSpring>(s.springs, 1).rest = 0;
  at<DiscWall>(s.contacts, 1).law = {.mu = 0, .e = 1, .e_t = -1, .mu_static = 1, .belt = -1};
  at<TorsionSpring>(s.springs, 2).rest = -3;
  s.bodies[0].name = "A-Z_09";
  at<Revolute>(s.joints, 0).name = "rod";  // names are distinct within a kind, not between kinds
  CHECK_NOTHROW(check(s));
}

TEST_CASE("every broken rule is refused in words, by check() and by System") {
  for (const Mistake& mistake : kMistakes) {
    Scene scene = everything();
    mistake.make(scene);
    CHECK_THROWS_WITH_AS(check(scene), mistake.message.c_str(), SceneError);
    CHECK_THROWS_WITH_AS(System{scene}, mistake.message.c_str(), std::invalid_argument);
  }
}

TEST_CASE("the error tells a program where it is") {
  Scene scene = everything();
  at<DiscWall>(scene.contacts, 1).law.e = 2;
  try {
    check(scene);
    FAIL("not refused");
  } catch (const SceneError& error) {
    CHECK(error.kind == "contact");
    CHECK(error.index == 1);
    CHECK(error.field == "e_n");
  }
}

TEST_CASE("elements added without a name are named by kind and place") {
  Scene s;
  s.body({}), s.body({.name = "second"}), s.body({});
  s.joint(Revolute{.a = 0, .b = 1}), s.joint(Fixed{.a = 1, .b = 2});
  s.contact(CornerWall{.a = 0}), s.spring(TorsionSpring{.a = 0, .b = 1}), s.load({});
  CHECK(s.bodies[0].name == "body1");
  CHECK(s.bodies[1].name == "second");
  CHECK(s.bodies[2].name == "body3");
  CHECK(at<Fixed>(s.joints, 1).name == "joint2");
  CHECK(at<CornerWall>(s.contacts, 0).name == "contact1");
  CHECK(at<TorsionSpring>(s.springs, 0).name == "spring1");
  CHECK(s.loads[0].name == "load1");
  CHECK_NOTHROW(check(s));
}

}  // namespace orthant
