// Derivatives of event-driven motions through events: static friction, impacts and closed contacts at the start,
// grazes; against central differences of runs.
#include <doctest/doctest.h>

#include <orthant/core/support/options.h>

#include "tests/integrators/derivatives/motion_trials.h"

using namespace orthant;

namespace {

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
