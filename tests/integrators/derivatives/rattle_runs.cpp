// Derivatives of runs of rattle against central differences of runs, through impacts, stick and slip; reverse mode
// against forward mode.
#include "tests/integrators/derivatives/run_trials.h"

using namespace orthant;

namespace {

using Kind = RunColumn::Kind;
const StepScheme kByRattle = RattleOptions{};

}  // namespace

TEST_CASE("tangent of a run of rattle: the slider-crank by mu, e and clearance, through impacts") {
  const MakeScene make = [](const std::vector<std::string>& sets) { return make_scene("slider_crank", sets); };
  const RunTangent t = check_tangents(make, {{"mu", 0.01, 1e-5}, {"e", 0.4, 1e-5}, {"clearance", 0.001, 1e-5}},
                                      {.step = 1e-4, .duration = 0.03}, 1e-6, kByRattle);
  CHECK(t.degenerate.empty());
  CHECK(t.inconsistent == 0);
}

TEST_CASE("tangent of a run of rattle: masses, inertias, lengths of the slider-crank, by its scene file") {
  check_tangents(from_text(slider_crank_text()),
                 {{"body.rod.mass", 0.038},
                  {"body.crank.inertia", 7.4e-5},
                  {"body.crank.omega", 150},
                  {"contact.corner1.mu", 0.01, 1e-5}},
                 {.step = 1e-4, .duration = 0.02}, 1e-6, kByRattle);
}

TEST_CASE("tangent of a run of rattle: springs, dampers, joint friction, tangential restitution, a belt") {
  const std::string& text = kArmAndBall;
  check_tangents(from_text(text),
                 {{"spring.coil.stiffness", 30},
                  {"spring.coil.damping", 0.6},
                  {"spring.coil.rest", 0.5},
                  {"friction.bearing.bound", 0.4},
                  {"contact.floor.e_n", 0.6},
                  {"contact.floor.mu", 0.1},
                  {"contact.floor.radius", 0.2},
                  {"body.arm.mass", 1.3}},
                 {.step = 1e-3, .duration = 0.8}, 1e-6, kByRattle);
  const MakeScene rough = [text](std::vector<std::string> sets) {
    sets.emplace_back("contact.floor.mu=2");
    return parse_scene(text, sets, "scene");
  };
  check_tangents(rough, {{"contact.floor.belt", 1.5}, {"contact.floor.e_t", 0.2}, {"contact.floor.e_n", 0.6}},
                 {.step = 1e-3, .duration = 0.8}, 1e-6, kByRattle);
}

TEST_CASE("adjoint of a run of rattle: the slider-crank through impacts; states, gaps and impulses") {
  check_reverse(slider_crank_text(), slider_crank_parameters(), {.step = 1e-4, .duration = 0.0301, .every = 7},
                {{Kind::state, 2}, {Kind::state, 14}, {Kind::gap, 2}, {Kind::normal, 0}, {Kind::tangent, 3}}, 1e-7,
                kByRattle);
}

TEST_CASE("adjoint of a run of rattle: springs, dampers, a drive, joint friction, loads, a belt") {
  check_reverse(kArmBallAndFlap, arm_ball_and_flap_parameters(), {.step = 1e-3, .duration = 0.8},
                {{Kind::state, 5}, {Kind::normal, 0}, {Kind::gap, 0}, {Kind::energy, 0}, {Kind::friction, 0}}, 1e-7,
                kByRattle);
}

TEST_CASE("tangent of a run of rattle: a driven crank on a pin with clearance, by its speed, clearance and friction") {
  const RunTangent t = check_tangents(from_text(kDrivenCrank),
                                      {{"joint.motor.rate", 8, 1e-6},
                                       {"joint.motor.amplitude", 0.1, 1e-5},
                                       {"contact.pin.radius_b", 0.014, 1e-5},
                                       {"contact.pin.mu", 0.1, 1e-5},
                                       {"body.rod.mass", 0.5, 1e-5}},
                                      {.step = 2e-4, .duration = 0.05}, 1e-6, kByRattle);
  CHECK(t.degenerate.empty());
}

TEST_CASE("tangent of a run of rattle: redundant joints beside a damper; a chain of 60 joint rows; a ball that rolls") {
  const std::string bars = R"(
gravity = [0, -9.81]
[[body]]
name = "crank"
position = [0, 0.5]
omega = 2
velocity = [-1, 0]
mass = 1
inertia = 0.02
[[body]]
name = "coupler"
position = [0.5, 1]
velocity = [-2, 0]
mass = 1
inertia = 0.02
[[body]]
name = "rocker"
position = [1, 0.5]
velocity = [-1, 0]
omega = 2
mass = 1
inertia = 0.02
[[body]]
name = "third"
position = [0.5, 0.5]
velocity = [-1, 0]
omega = 2
mass = 1
inertia = 0.02
[[joint]]
type = "revolute"
bodies = ["ground", "crank"]
point_b = [0, -0.5]
[[joint]]
type = "revolute"
bodies = ["crank", "coupler"]
point_a = [0, 0.5]
point_b = [-0.5, 0]
[[joint]]
type = "revolute"
bodies = ["coupler", "rocker"]
point_a = [0.5, 0]
point_b = [0, 0.5]
[[joint]]
type = "revolute"
bodies = ["rocker", "ground"]
point_a = [0, -0.5]
point_b = [1, 0]
[[joint]]
type = "revolute"
bodies = ["ground", "third"]
point_a = [0.5, 0]
point_b = [0, -0.5]
[[joint]]
type = "revolute"
bodies = ["third", "coupler"]
point_a = [0, 0.5]
[[spring]]
name = "s"
type = "point"
bodies = ["ground", "crank"]
point_a = [1, 2]
stiffness = 20
damping = 1.5
rest = 0.5
)";
  check_tangents(from_text(bars),
                 {{"body.third.mass", 1, 1e-5}, {"spring.s.damping", 1.5, 1e-5}, {"spring.s.stiffness", 20, 1e-5}},
                 {.step = 1e-3, .duration = 0.5}, 1e-7, kByRattle);
  const MakeScene chain = [](std::vector<std::string> sets) {
    sets.emplace_back("links=30");
    return make_scene("chain", sets);
  };
  check_tangents(chain, {{"angle", 1.5707963267948966, 1e-5}}, {.step = 1e-3, .duration = 0.2}, 1e-6, kByRattle);
  const MakeScene roll = [](const std::vector<std::string>& sets) { return make_scene("roll", sets); };
  check_tangents(roll, {{"mu", 0.2, 1e-5}}, {.step = 1e-2, .duration = 0.5}, 1e-7, kByRattle);
  check_tangents(roll, {{"speed", 5, 1e-5}}, {.step = 1e-2, .duration = 1}, 1e-7, kByRattle);
}

TEST_CASE("tangent of a run of rattle: steps whose rows were frozen at an iterate are named") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "a"
mass = 1
inertia = 0.03
position = [0.25, 0]
[[body]]
name = "b"
mass = 1.2
inertia = 0.04
position = [0.75, 0]
[[joint]]
name = "p"
type = "revolute"
bodies = ["ground", "a"]
point_b = [-0.25, 0]
[[joint]]
name = "q"
type = "revolute"
bodies = ["a", "b"]
point_a = [0.25, 0]
point_b = [-0.25, 0]
[[friction]]
name = "f"
joint = "q"
bound = 30
[[load]]
body = "b"
torque = 2
)";
  const auto solver = make_solver("auto");
  const auto parameters = parameters_by_keys(text, {{"body.a.mass", 1}});
  const System system(from_text(text)({}));
  const RunTangent t = differentiate_run(system, parameters, kByRattle, *solver, {.step = 1e-3, .duration = 0.01});
  REQUIRE(t.warnings.size() == 1);
  CHECK(t.warnings[0].find("the position stage of rattle froze its rows at an iterate") != std::string::npos);
}
