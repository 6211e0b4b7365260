// Derivatives of runs against central differences of runs, between changes of the contact pattern; reverse mode against
// forward mode; derivatives of the motion itself against closed forms and differences of event-driven runs.
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/integrators/derivatives/run_trials.h"
#include "tests/support/scene_texts.h"

#include <cstdio>

using namespace orthant;

TEST_CASE("tangent of a run: the slider-crank with clearance, by friction and restitution, through its impacts") {
  const MakeScene make = [](const std::vector<std::string>& sets) { return make_scene("slider_crank", sets); };
  const RunTangent t =
      check_tangents(make, {{"mu", 0.01, 1e-5}, {"e", 0.4, 1e-6}}, {.step = 1e-4, .duration = 0.1}, 1e-6);
  CHECK(t.degenerate.empty());
  CHECK(t.inconsistent == 0);
}

TEST_CASE("tangent of a run: masses, inertias, lengths of the slider-crank, by its scene file") {
  const auto text = scene_texts::contents(scene_texts::kCore / "scenes/slider_crank.toml");
  check_tangents(from_text(text),
                 {{"body.rod.mass", 0.038},
                  {"body.crank.inertia", 7.4e-5},
                  {"body.crank.omega", 150},
                  {"contact.corner3.mu", 0.01, 1e-5}},
                 {.step = 1e-4, .duration = 0.03}, 1e-6);
}

TEST_CASE(
    "tangent of a run: springs, dampers, a drive, dry friction in a joint, tangential restitution, a moving belt") {
  const std::string& text = kArmAndBall;
  check_tangents(from_text(text),
                 {{"spring.coil.stiffness", 30},
                  {"spring.coil.damping", 0.6},
                  {"spring.coil.rest", 0.5},
                  {"friction.bearing.bound", 0.4},
                  {"contact.floor.e_n", 0.6},
                  {"contact.floor.mu", 0.1},
                  {"body.arm.mass", 1.3}},
                 {.step = 1e-3, .duration = 0.8}, 1e-6);
  const MakeScene rough = [text](std::vector<std::string> sets) {
    sets.emplace_back("contact.floor.mu=2");
    return parse_scene(text, sets, "scene");
  };
  check_tangents(rough, {{"contact.floor.belt", 1.5}, {"contact.floor.e_t", 0.2}, {"contact.floor.e_n", 0.6}},
                 {.step = 1e-3, .duration = 0.8}, 1e-6);
}

TEST_CASE("tangent of a run: a load beside the centre of a body that turns, its moment changes with the angle") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1.3
inertia = 0.05
position = [0.3, 0]
omega = 2
[[joint]]
type = "revolute"
name = "pin"
bodies = ["ground", "arm"]
point_b = [-0.3, 0]
[[load]]
name = "push"
body = "arm"
point = [0.2, 0.4]
force = [3, -5]
)";
  check_tangents(from_text(text), {{"body.arm.mass", 1.3}, {"body.arm.inertia", 0.05}}, {.step = 1e-3, .duration = 0.5},
                 1e-6);
}

TEST_CASE("tangent of a run: a driven crank on a pin with clearance, by its speed, clearance and the start") {
  const std::string& text = kDrivenCrank;
  const RunTangent t = check_tangents(from_text(text),
                                      {{"joint.motor.rate", 8, 1e-7},
                                       {"joint.motor.amplitude", 0.1, 1e-6},
                                       {"contact.pin.radius_b", 0.014, 1e-5},
                                       {"contact.pin.mu", 0.1, 1e-6},
                                       {"body.rod.mass", 0.5, 1e-6}},
                                      {.step = 2e-4, .duration = 0.1}, 1e-6);
  CHECK(t.degenerate.empty());
  const System system(from_text(text)({}));
  const auto solver = make_solver("auto");
  std::vector<RunParameter> start;  // entries of the start, each against a scene with it
  for (const Index entry : {3 + 0, 3 + 2, 6 + 4}) start.push_back({"start", 0, {}, entry});
  const RunTangent along = differentiate_run(system, start, {}, *solver, {.step = 2e-4, .duration = 0.1});
  std::vector<RunParameter> keys = {
      {"x", 0.45,
       [&](double x) {
         return from_text(text)(
             {override_text("body.rod.position", 0).substr(0, 18) + "[" + override_text("", x).substr(1) + ", 0.002]"});
       }},
      {"angle", 0, [&](double x) { return from_text(text)({override_text("body.rod.angle", x)}); }}};
  const RunTangent by_scene = differentiate_run(system, keys, {}, *solver, {.step = 2e-4, .duration = 0.1});
  CHECK((along.q.col(0) - by_scene.q.col(0)).norm() <= 1e-8 * by_scene.q.col(0).norm());
  CHECK((along.v.col(1) - by_scene.v.col(1)).norm() <= 1e-8 * by_scene.v.col(1).norm());
  CHECK(along.q.col(2).norm() > 0);
}

TEST_CASE(
    "tangent of a run: a contact without force or velocity is named in each step; what is no plain step is refused") {
  const std::string text = R"(
gravity = [0, 0]
[[body]]
name = "ball"
mass = 1
inertia = 1
position = [0, 1]
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 1
wall = {point = [0, 0], normal = [0, 1]}
)";
  const auto solver = make_solver("auto");
  const Clock clock{.step = 0.01, .duration = 0.1};
  const auto parameters = [](const std::string& of) {
    return std::vector<RunParameter>{
        {"mass", 1, [of](double x) { return from_text(of)({override_text("body.ball.mass", x)}); }}};
  };
  const System resting(from_text(text)({}));
  const RunTangent t = differentiate_run(resting, parameters(text), {}, *solver, clock);
  REQUIRE(t.degenerate.size() == 10);
  CHECK(t.degenerate[3].contacts == std::vector<int>{0});
  CHECK(t.degenerate[3].t == doctest::Approx(0.03));

  const std::string poisson = "restitution = \"poisson\"\n" + text;
  const System other(from_text(poisson)({"gravity=[0, -9]", "body.ball.velocity=[0, -1]", "contact.floor.e_n=0.5"}));
  CHECK_THROWS_AS(differentiate_run(other, {}, {}, *solver, clock), std::invalid_argument);
  MoreauJeanOptions full;
  full.form = Form::full;
  CHECK_THROWS_AS(differentiate_run(resting, {}, full, *solver, clock), std::invalid_argument);
  const std::vector<RunParameter> at_its_end = {
      {"e", 1, [&](double x) { return from_text(text)({override_text("contact.floor.e_n", x)}); }}};
  CHECK(differentiate_run(resting, at_its_end, {}, *solver, clock).warnings.size() == 1);
}

TEST_CASE("tangent of a run: impacts whose restitution friction drops are differentiated without it") {
  Scene s{.gravity = {0, -9.81}, .duration = 0.5};  // a corner falls into a wedge, one wall rough and elastic
  const BodyId b = s.body({.mass = 1, .inertia = 0.008, .position = {0, 0.7736}, .angle = -1.1});
  const Vector2d corner{0.137973661224488, -0.06311559442128316}, left{0.9805806756909202, 0.19611613513818404};
  s.contact(CornerWall{{}, b, corner, kGround, {0, 0}, left, {}});
  s.contact(CornerWall{{}, b, corner, kGround, {0, 0}, {-left.x(), left.y()}, {.mu = 0.5, .e = 0.5}});
  const auto solver = make_solver("auto");
  const auto with_e = [&](double e) {
    Scene other = s;
    std::get<CornerWall>(other.contacts[1]).law.e = e;
    return other;
  };
  const auto spins = [&](double omega) {
    Scene other = s;
    other.bodies[0].omega = omega;
    return other;
  };
  int dropped = 0;
  for (const double h : {5e-3, 2e-3, 1e-3}) {
    // To the end of the first step that drops restitution
    const System system(s);
    double end = 0;
    MoreauJean method(system);
    simulate(method, *solver, {.step = h, .duration = 0.5}, [&](const RunSample& m) {
      if (end == 0 && m.report.plastic > 0) end = m.state.t;
    });
    if (end == 0) continue;
    ++dropped;
    const Clock clock{.step = h, .duration = end};
    const RunTangent t =
        differentiate_run(system, {{"e", 0.5, with_e}, {"omega", 0, spins}}, MoreauJeanOptions{}, *solver, clock);
    const double step = 1e-6;
    const auto difference = [&](const std::function<Scene(double)>& at, double x) -> Eigen::VectorXd {
      return (run_by(System(at(x + step)), MoreauJeanOptions{}, *solver, clock).final.v -
              run_by(System(at(x - step)), MoreauJeanOptions{}, *solver, clock).final.v) /
             (2 * step);
    };
    CAPTURE(h);
    const Eigen::VectorXd by_e = difference(with_e, 0.5), by_omega = difference(spins, 0);
    CHECK((t.v.col(0) - by_e).lpNorm<Eigen::Infinity>() <= 1e-5 * (1 + by_e.lpNorm<Eigen::Infinity>()));
    CHECK((t.v.col(1) - by_omega).lpNorm<Eigen::Infinity>() <= 1e-5 * (1 + by_omega.lpNorm<Eigen::Infinity>()));
  }
  CHECK(dropped > 0);
}

TEST_CASE("tangent of a run: laws of impacts and sleep are refused before it begins, also without an impact") {
  const std::string ball = R"(
[[body]]
name = "b"
mass = 1
inertia = 1
position = [0, 9]
[[contact]]
name = "floor"
type = "disc-wall"
body = "b"
radius = 1
wall = {normal = [0, 1]}
)";
  const auto solver = make_solver("auto");
  const Clock clock{.step = 0.01, .duration = 0.1};
  for (const std::string law : {"restitution = \"poisson\"\n", "impacts = \"sequential\"\n"})
    for (const StepScheme& scheme : {StepScheme(MoreauJeanOptions{}), StepScheme(RattleOptions{})})
      CHECK_THROWS_AS(differentiate_run(System(from_text(law + ball)({})), {}, scheme, *solver, clock),
                      std::invalid_argument);
  MoreauJeanOptions sleeps;
  sleeps.sleep.after = 1;
  CHECK_THROWS_WITH(differentiate_run(System(from_text(ball)({})), {}, sleeps, *solver, clock),
                    "derivatives of a run: option sleep_after = 1: must be 0, as bodies that sleep have none");
}

TEST_CASE("tangent of a run: contacts that hold a body at rest twice are not said to part by rounding") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "a"
mass = 1
inertia = 0.1
position = [0.5, 0]
[[joint]]
name = "j"
type = "revolute"
bodies = ["ground", "a"]
point_a = [0, 0]
point_b = [-0.5, 0]
[[contact]]
name = "s"
type = "limit"
joint = "j"
lower = -0.7
upper = 1.2
e_n = 0.3
[[friction]]
name = "dry"
joint = "j"
bound = 0.4
)";
  const auto solver = make_solver("auto");
  for (const std::string key : {"contact.s.lower", "body.a.mass"}) {
    const RunTangent t =
        differentiate_run(System(from_text(text)({})), parameters_by_keys(text, {{key, key[0] == 'c' ? -0.7 : 1}}), {},
                          *solver, {.step = 1e-3, .duration = 0.7});
    CHECK(t.run.status == Status::solved);
    CHECK(t.inconsistent == 0);
  }
}

TEST_CASE("tangent of a run: a table's time that a step evaluates has one-sided derivatives, and is named") {
  const std::string text = R"(
[[body]]
name = "b"
mass = 1
inertia = 1
[[load]]
name = "push"
body = "b"
force = [1, 0]
factor = {type = "table", times = [0, 0.5, 1], values = [0, 1, 0]}
)";
  const auto solver = make_solver("auto");
  const std::vector<RunParameter> parameters = {
      {"time", 0.5, [&](double x) {
         return from_text(text)({"load.push.factor.times=[0, " + override_text("", x).substr(1) + ", 1]"});
       }}};
  const System system(from_text(text)({}));
  // theta = 1/2: 0.1 / 2 + 4 * 0.1 < 0.5 < 0.1 / 2 + 5 * 0.1, and 0.5 = 0.2 / 2 + 2 * 0.2
  CHECK(differentiate_run(system, parameters, {}, *solver, {.step = 0.1, .duration = 1}).warnings.empty());
  const RunTangent t = differentiate_run(system, parameters, {}, *solver, {.step = 0.2, .duration = 1});
  REQUIRE(t.warnings.size() == 1);
  CHECK(t.warnings[0].find("time moves the time 0.5 s of a table, which is evaluated there") == 0);
}

TEST_CASE("tangent of a run: a time of a drive's table next to an evaluation, by differences nearer than that") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "crank"
mass = 0.3
inertia = 0.001
position = [0.05, 0]
[[body]]
name = "rod"
mass = 0.4
inertia = 0.004
position = [0.25, 0]
[[joint]]
type = "revolute"
name = "pin"
bodies = ["ground", "crank"]
point_b = [-0.05, 0]
[[joint]]
type = "drive"
name = "motor"
joint = "pin"
table = {times = [0, TIME, 0.25, 1], values = [0, 1.5, 1.7, 4]}
[[contact]]
type = "journal"
name = "hole"
bodies = ["rod", "crank"]
centre_a = [-0.15, 0]
centre_b = [0.05, 0]
radius_a = 0.01
radius_b = 0.0105
mu = 0.1
)";
  const MakeScene make = [&](const std::vector<std::string>& sets) {
    std::string one = text;
    one.replace(one.find("TIME"), 4, sets.empty() ? "0.10037" : sets[0].substr(sets[0].find('=') + 1));
    return parse_scene(one, {}, "scene");
  };
  check_tangents(make, {{"time", 0.10037, 1e-6}}, {.step = 1e-3, .duration = 0.12}, 1e-6);
}
