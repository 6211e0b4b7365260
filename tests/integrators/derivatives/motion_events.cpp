// Derivatives of event-driven motions through events: static friction, impacts and closed contacts at the start, starts
// that break a joint, grazes; against central differences of runs.
#include <doctest/doctest.h>

#include <orthant/core/support/options.h>

#include "tests/integrators/derivatives/motion_trials.h"

using namespace orthant;

namespace {

// All of q and v at the end, relative to the largest; sides: differences to one side only where it is 1 or −1.
void check_motion(const std::string& text, const std::vector<MotionTrial>& trials, double duration, double tolerance,
                  int side = 0) {
  const System system(from_text(text)({}));
  const auto solver = make_solver("auto");
  const MotionTangent tangent = differentiate_motion(system, parameters_of(text, trials), {}, *solver, duration);
  REQUIRE(tangent.status == Status::solved);
  CHECK(tangent.none == "");
  const Clock clock{.step = duration, .duration = duration};
  for (std::size_t j = 0; j < trials.size(); ++j) {
    INFO(trials[j].key);
    const double step = trials[j].step;
    const double low = side > 0 ? 0 : -step, high = side < 0 ? 0 : step;
    const State a = end_of(from_text(text)({set_of(trials[j], trials[j].value + low)}), "event-driven", clock);
    const State b = end_of(from_text(text)({set_of(trials[j], trials[j].value + high)}), "event-driven", clock);
    const Eigen::VectorXd q = (b.q - a.q) / (high - low), v = (b.v - a.v) / (high - low);
    const auto column = static_cast<Index>(j);
    const double scale = std::max(q.lpNorm<Eigen::Infinity>(), v.lpNorm<Eigen::Infinity>());
    CHECK(scale > 0);
    CHECK((q - tangent.q.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * scale);
    CHECK((v - tangent.v.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * scale);
  }
}

const std::string kStickSlip = R"(
gravity = [0, -10]
[[body]]
name = "m"
mass = 1
inertia = 1
position = [0, 0.1]
velocity = [0.2, 0]
[[spring]]
name = "s"
type = "joint"
of = "slide"
bodies = ["ground", "m"]
stiffness = 40
rest = 0
[[contact]]
name = "f"
type = "corner-wall"
body = "m"
wall = {point = [0, 0.1], normal = [0, 1]}
mu = 0.3
mu_static = 0.5
belt = 0.2
)";

const std::string kStrikingBall = R"(
gravity = [0, -10]
[[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.1]
velocity = [1, -1.0]
[[contact]]
name = "f"
type = "disc-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 1]}
e_n = 0.5
mu = 0.05
)";

// A block that slides; it stays level.
const std::string kSlidingBlock = R"(
gravity = [0, -9.81]
[[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.1]
velocity = [2, 0]
[[contact]]
name = "f"
type = "corner-wall"
body = "b"
point = [0, -0.1]
wall = {normal = [0, 1]}
mu = 0.3
e_n = 0.0
[[joint]]
name = "keep"
type = "relation"
terms = [{of = "angle", bodies = ["ground", "b"]}]
)";

// The bodies' velocities break their joint.
const std::string kBrokenStart = R"(
[[body]]
name = "rod"
mass = 0.5
inertia = 0.01
position = [0.45, 0.002]
velocity = [0, 1.6]
[[body]]
name = "sl"
mass = 0.3
inertia = 0.002
position = [0.70, 0.001]
[[joint]]
name = "wrist"
type = "revolute"
bodies = ["rod", "sl"]
point_a = [0.25, 0]
point_b = [0, 0.001]
)";

// A disc in a hole of a driven arm, 0.1 mm of clearance; it starts in the middle.
const std::string kDiscInHole = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1
inertia = 0.02
omega = 8
[[joint]]
name = "shaft"
type = "revolute"
bodies = ["ground", "arm"]
[[joint]]
name = "motor"
type = "drive"
joint = "shaft"
rate = 8
[[body]]
name = "d"
mass = 1
inertia = 0.001
position = [0.1, 0]
velocity = [0, 0.8]
[[contact]]
name = "B"
type = "journal"
bodies = ["d", "arm"]
centre_b = [0.1, 0]
radius_a = 0.01
radius_b = 0.0101
mu = 0.1
e_n = 0.0
)";

const std::vector<MotionTrial> kBreaks = {{"body.rod.position", "[", ", 0.002]", 0.45},
                                          {"body.sl.velocity", "[0, ", "]", 0},
                                          {"body.sl.angle", "", "", 0},
                                          {"joint.wrist.point_a", "[", ", 0]", 0.25},
                                          {"body.sl.mass", "", "", 0.3}};

}  // namespace

TEST_CASE("tangent of a motion: static friction above kinetic friction, where the force jumps as slip begins") {
  // Slip begins where k x = mu_static N, a time and a place that both depend on mu_static, k, the belt and the start.
  const std::vector<MotionTrial> trials = {{"contact.f.mu_static", "", "", 0.5},
                                           {"spring.s.stiffness", "", "", 40, 1e-4},
                                           {"contact.f.mu", "", "", 0.3},
                                           {"contact.f.belt", "", "", 0.2},
                                           {"body.m.mass", "", "", 1}};
  check_motion(kStickSlip, trials, 0.8, 1e-6);
  check_motion(kStickSlip, trials, 2.5, 1e-6);  // sticks, slips, sticks, slips again
  // two blocks on the belt, coupled: the other one sticks on, or follows
  std::string two = kStickSlip;
  two += R"(
[[body]]
name = "n"
mass = 2
inertia = 1
position = [1, 0.1]
velocity = [0.2, 0]
[[contact]]
name = "g"
type = "corner-wall"
body = "n"
wall = {point = [0, 0.1], normal = [0, 1]}
mu = 0.1
mu_static = 0.2
belt = 0.2
[[spring]]
name = "t"
type = "point"
bodies = ["m", "n"]
stiffness = 30
rest = 1
damping = 0.5
)";
  std::vector<MotionTrial> more = trials;
  more.push_back({"contact.g.mu_static", "", "", 0.2});
  check_motion(two, more, 1.9, 2e-6);
}

TEST_CASE("tangent of a motion: an impact at the start itself") {
  check_motion(kStrikingBall,
               {{"body.b.velocity", "[1, ", "]", -1},
                {"contact.f.e_n", "", "", 0.5},
                {"contact.f.mu", "", "", 0.05},
                {"body.b.mass", "", "", 1},
                {"body.b.velocity", "[", ", -1]", 1}},
               0.05, 1e-7);
}

TEST_CASE("tangent of a motion: a contact closed at the start, opened or struck by the change") {
  for (const int side : {-1, 1}) check_motion(kSlidingBlock, {{"body.b.velocity", "[2, ", "]", 0}}, 0.3, 1e-5, side);
  check_motion(kSlidingBlock, {{"body.b.position", "[0, ", "]", 0.1, 1e-7}}, 0.3, 1e-5, 1);
  check_motion(kSlidingBlock, {{"contact.f.mu", "", "", 0.3}, {"body.b.velocity", "[", ", 0]", 2}}, 0.3, 1e-7);
}

TEST_CASE("tangent of a motion: mu = 0, of friction that begins against the slip, as it strikes and as it turns") {
  const auto without = [](std::string text, const std::string& words, const std::string& others) {
    const auto at = text.find(words);
    REQUIRE(at != std::string::npos);
    return text.replace(at, words.size(), others);
  };
  const std::string ball = without(kStrikingBall, "mu = 0.05", "mu = 0");
  check_motion(ball, {{"contact.f.mu", "", "", 0}}, 0.5, 1e-5, 1);  // three impacts
  const std::string block = without(kSlidingBlock, "mu = 0.3", "mu = 0");
  check_motion(block, {{"contact.f.mu", "", "", 0}}, 0.3, 1e-5, 1);
  // A spring on a belt: the slip turns six times in 3 s; at 0.9 s it has turned once.
  const std::string spring = without(kStickSlip, "mu = 0.3\nmu_static = 0.5", "mu = 0");
  const std::string swings = without(spring, "velocity = [0.2, 0]", "velocity = [1.2, 0]");
  for (const double duration : {0.1, 0.9, 3.0})
    check_motion(swings, {{"contact.f.mu", "", "", 0}, {"spring.s.stiffness", "", "", 40}}, duration, 1e-5, 1);

  // The slider-crank: two corners, which slide on the wall together, turn at one time.
  const auto crank = [](double mu) { return slider_crank({.mu = mu, .e = 0.4}); };
  const System system(crank(0));
  const auto solver = make_solver("auto");
  const MotionTangent tangent = differentiate_motion(system, {{"mu", 0, crank}}, {}, *solver, 0.05);
  CHECK(tangent.none == "");
  const auto end = [&](double mu) { return end_of(crank(mu), "event-driven", {.step = 0.05, .duration = 0.05}).q[2]; };
  const double step = 1e-5, difference = (4 * end(step) - 3 * end(0) - end(2 * step)) / (2 * step);
  CHECK(tangent.q(2, 0) == doctest::Approx(difference).epsilon(1e-7));

  const std::string still =
      without(without(kSlidingBlock, "mu = 0.3", "mu = 0"), "velocity = [2, 0]", "velocity = [0, 0]");
  const MotionTangent none = differentiate_motion(
      System(from_text(still)({})), parameters_of(still, {{"contact.f.mu", "", "", 0}}), {}, *solver, 0.1);
  CHECK(none.none.find("rests without a slip") != std::string::npos);
}

TEST_CASE("tangent of a motion: differences are short beside a clearance, also of a disc that starts in the middle") {
  const std::vector<MotionTrial> trials = {{"body.d.velocity", "[", ", 0.8]", 0, 1e-5},
                                           {"contact.B.radius_b", "", "", 0.0101, 1e-7},
                                           {"contact.B.centre_b", "[", ", 0]", 0.1, 1e-7},
                                           {"contact.B.centre_b", "[0.1, ", "]", 0, 1e-7}};
  check_motion(kDiscInHole, trials, 0.04, 2e-5);
}

TEST_CASE("tangents of a start that breaks a joint: by its velocities, and by 0.2 mm") {
  check_motion(kBrokenStart, kBreaks, 0.02, 1e-7);
  std::string apart = kBrokenStart;
  apart.replace(apart.find("[0.70, 0.001]"), 13, "[0.7002, 0.001]");
  check_motion(apart, kBreaks, 0.02, 1e-7);
  const Clock clock{.step = 1e-3, .duration = 0.02};
  const auto solver = make_solver("auto");
  for (const std::string& text : {kBrokenStart, apart}) {
    const System system(from_text(text)({}));
    const std::vector<RunParameter> parameters = parameters_of(text, kBreaks);
    const RunTangent tangent = differentiate_run(system, parameters, {}, *solver, clock);
    std::vector<RunColumn> columns;
    for (Index i = 0; i < 2 * system.dof(); ++i) columns.push_back({RunColumn::Kind::state, i});
    const RunAdjoint adjoint =
        differentiate_run_reverse(system, parameters, {}, *solver, clock, columns, 2 * system.dof(), weigh_last());
    for (std::size_t j = 0; j < kBreaks.size(); ++j) {
      INFO(kBreaks[j].key);
      const State a = end_of(from_text(text)({set_of(kBreaks[j], kBreaks[j].value - 1e-5)}), "moreau-jean", clock);
      const State b = end_of(from_text(text)({set_of(kBreaks[j], kBreaks[j].value + 1e-5)}), "moreau-jean", clock);
      const auto column = static_cast<Index>(j);
      Eigen::VectorXd difference(2 * system.dof()), exact(2 * system.dof());
      difference << (b.q - a.q) / 2e-5, (b.v - a.v) / 2e-5;
      exact << tangent.q.col(column), tangent.v.col(column);
      CHECK((exact - difference).lpNorm<Eigen::Infinity>() <= 1e-7 * difference.lpNorm<Eigen::Infinity>());
      CHECK((adjoint.gradient.col(column) - exact).lpNorm<Eigen::Infinity>() <= 1e-9 * exact.lpNorm<Eigen::Infinity>());
    }
  }
}

TEST_CASE("tangent of a motion: an exact graze has none; one that is near is reported with its growth") {
  const std::string graze = R"(
[[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.6]
velocity = [1, -1]
[[load]]
name = "l"
body = "b"
force = [0, 1]
[[contact]]
name = "f"
type = "disc-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 1]}
e_n = 0.4
)";
  const auto solver = make_solver("auto");
  const auto of = [&](const std::string& text, double speed) {
    const MotionTrial trial{"body.b.velocity", "[1, ", "]", speed};
    return differentiate_motion(System(from_text(text)({set_of(trial, speed)})), parameters_of(text, {trial}), {},
                                *solver, 4, 0.5);
  };
  for (const char* height : {"0.6", "1.3", "5.1"}) {  // v² = 2 a h
    std::string at = graze;
    at.replace(at.find("0.6]"), 3, height);
    const double fall = std::strtod(height, nullptr) - 0.1;
    INFO(height);
    CHECK(of(at, -std::sqrt(2 * fall)).none.find("graze") != std::string::npos);
  }
  CHECK(of(graze, -1).none.find("graze") != std::string::npos);
  const MotionTangent clear = of(graze, -1.01), close = of(graze, -1 - 1e-11);
  CHECK(clear.none == "");
  CHECK(clear.warnings.empty());
  CHECK(clear.guards.size() == 1);
  CHECK(close.none == "");
  REQUIRE(close.warnings.size() == 1);
  CHECK(close.warnings[0].find("nearly a graze") != std::string::npos);
}

TEST_CASE("tangent of a motion: friction of a flat landing, at opposite bounds at two corners that both stick") {
  const MakeScene make = [](const std::vector<std::string>& sets) {
    return parse_scene(scene_texts::contents(scene_texts::kCore / "scenes/shaken_table.toml"), sets, "scene");
  };
  const auto axis = [&](double x) { return make({"joint.column.axis=[" + override_text("", x).substr(1) + ", 1]"}); };
  const System system(make({}));
  const auto solver = make_solver("auto");
  const double step = 1e-6;
  const MotionTangent motion = differentiate_motion(system, {{"axis", 0, axis}}, {}, *solver, 0.6);
  CHECK(motion.none == "");
  CHECK(motion.warnings.empty());
  const Clock whole{.step = 0.6, .duration = 0.6}, steps{.step = 1e-3, .duration = 0.6};
  const double by = (end_of(axis(step), "event-driven", whole).q[3] - end_of(axis(-step), "event-driven", whole).q[3]);
  CHECK(motion.q(3, 0) == doctest::Approx(by / (2 * step)).epsilon(1e-6));
  const RunTangent run = differentiate_run(system, {{"axis", 0, axis}}, RattleOptions{}, *solver, steps);
  const auto end = [&](double x) { return run_by(System(axis(x)), RattleOptions{}, *solver, steps).final.q[3]; };
  CHECK(run.q(3, 0) == doctest::Approx((end(step) - end(-step)) / (2 * step)).epsilon(1e-6));
  CHECK(run.degenerate.empty());
}

TEST_CASE("tangent of a motion: e_t = 0 of contacts that stop in impacts and slide from there has none") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "b"
mass = 2
inertia = 0.05
position = [0, 0.15]
angle = 0.3
velocity = [0.5, 0]
omega = 0.3
[[contact]]
type = "polygon-wall"
name = "f"
body = "b"
corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]]
wall = {normal = [-0.29552020666133955, 0.955336489125606]}
mu = 0.2
e_n = 0.3
)";
  const auto solver = make_solver("auto");
  const System system(from_text(text)({}));
  const auto by = [&](const std::string& key, double value) {
    return differentiate_motion(system, parameters_by_keys(text, {{key, value}}), {}, *solver, 0.2);
  };
  CHECK(by("contact.f.e_t", 0).none.find("restitution e_t of either sign") != std::string::npos);
  CHECK(by("contact.f.mu", 0.2).none == "");
}

TEST_CASE("tangent of a motion: a point of a joint, through a series of impacts in a pin whose clearance is small") {
  const std::string text = scene_texts::contents(scene_texts::kCore / "scenes/slider_crank_pin.toml");
  const MotionTrial point{"joint.crank_pin.point_b", "[", ", 0]", -0.0765};
  const auto solver = make_solver("auto");
  const System system(from_text(text)({}));
  const double end = 0.00105, step = 3e-8;
  const auto omega = [&](double by) {
    return end_of(from_text(text)({set_of(point, point.value + by)}), "event-driven", {.step = end, .duration = end})
        .v[2];
  };
  const double expected = (omega(step) - omega(-step)) / (2 * step);
  for (const double every : {end, end / 10}) {
    CAPTURE(every);
    const MotionTangent t = differentiate_motion(system, parameters_of(text, {point}), {}, *solver, end, every);
    CHECK(t.none == "");
    CHECK(t.v(2, 0) == doctest::Approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("tangent of a motion: links on pins that land, also far from the origin") {
  const auto links = [](double y) {
    char text[1200];
    std::snprintf(text, sizeof text, R"(
gravity = [0, -9.81]
[[body]]
name = "one"
mass = 1
inertia = 0.03
position = [0.3, %.17g]
omega = -1
velocity = [0, -0.3]
[[body]]
name = "two"
mass = 1
inertia = 0.03
position = [0.9, %.17g]
velocity = [0, -0.6]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "one"]
point_a = [0, %.17g]
point_b = [-0.3, 0]
[[joint]]
name = "knee"
type = "revolute"
bodies = ["one", "two"]
point_a = [0.3, 0]
point_b = [-0.3, 0]
[[contact]]
name = "c"
type = "corner-wall"
body = "two"
point = [0.3, 0]
wall = {point = [0, %.17g], normal = [0.2, 1]}
mu = 0.05
)",
                  y, y, y, y - 0.15);
    return std::string(text);
  };
  const auto solver = make_solver("auto");
  const auto tangent = [&](double y) {
    const std::string text = links(y);
    const RunParameter plane{"wall.point.y", y - 0.15,
                             [text](double x) {
                               Scene s = from_text(text)({});
                               std::get<CornerWall>(s.contacts[0]).wall_point.y() = x;
                               return s;
                             },
                             -1};
    const MotionTangent t = differentiate_motion(System(from_text(text)({})), {plane}, {}, *solver, 0.3);
    REQUIRE(t.none.empty());
    return t.v;
  };
  const Eigen::VectorXd near = tangent(0);
  for (const double y : {-1.27, -5.0, -30.0, 300.0}) {
    CAPTURE(y);
    CHECK((tangent(y) - near).lpNorm<Eigen::Infinity>() <= 1e-6 * near.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("tangent of a motion: a link on a pin that lands and stays is not parted by its one contact") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "link"
mass = 1
inertia = 0.03
position = [0.3, 0]
omega = -1
velocity = [0, -0.3]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "link"]
point_b = [-0.3, 0]
[[contact]]
name = "c"
type = "corner-wall"
body = "link"
point = [0.3, 0]
mu = 0.2
wall = {point = [0, -0.15], normal = [0.2, 1]}
)";
  const auto solver = make_solver("auto");
  const Clock clock{.step = 0.05, .duration = 0.6};
  const MotionTrial drop{"contact.c.wall.point", "[0, ", "]", -0.15};
  const MotionTrial weight{"gravity", "[0, ", "]", -9.81};
  const MotionTangent t =
      differentiate_motion(System(from_text(text)({})), parameters_of(text, {drop, weight}), {}, *solver, 0.6);
  CHECK(t.none == "");
  REQUIRE(t.q.cols() == 2);
  State end[2];
  for (int k = 0; k < 2; ++k)
    end[k] = end_of(from_text(text)({set_of(drop, drop.value + (k == 0 ? -1e-6 : 1e-6))}), "event-driven", clock);
  const Eigen::VectorXd difference = (end[1].q - end[0].q) / 2e-6;
  CHECK((t.q.col(0) - difference).lpNorm<Eigen::Infinity>() <= 1e-6 * difference.lpNorm<Eigen::Infinity>());
  CHECK(t.q.col(1).lpNorm<Eigen::Infinity>() <= 1e-9);  // it rests
}
