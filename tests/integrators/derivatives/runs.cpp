// Derivatives of runs against central differences of runs, between changes of the contact pattern; reverse mode against
// forward mode; derivatives of the motion itself against closed forms and differences of event-driven runs.
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/scene_texts.h"

#include <algorithm>
#include <cstdio>

using namespace orthant;

namespace {

using MakeScene = std::function<Scene(const std::vector<std::string>&)>;

std::string override_text(const std::string& key, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return key + "=" + text;
}

struct TangentTrial {
  std::string key;
  double value;
  double step = 1e-6;  // of the value, or by itself: small enough for the pattern, large enough for rounding
};

// The tangents of all keys, and central differences of runs.
RunTangent check_tangents(const MakeScene& make, const std::vector<TangentTrial>& trials, const Clock& clock,
                          double tolerance, const MoreauJeanOptions& options = {}) {
  std::vector<RunParameter> parameters;
  for (const TangentTrial& trial : trials)
    parameters.push_back({trial.key, trial.value, [&](double x) { return make({override_text(trial.key, x)}); }});
  const System system(make({}));
  const auto solver = make_solver("auto");
  RunTangent tangent = differentiate_run(system, parameters, options, *solver, clock);
  REQUIRE(tangent.run.status == Status::solved);
  for (std::size_t j = 0; j < trials.size(); ++j) {
    INFO(trials[j].key);
    const double step = trials[j].step * (trials[j].value != 0 ? std::abs(trials[j].value) : 1);
    State end[2];
    for (int k = 0; k < 2; ++k) {
      const System other(make({override_text(trials[j].key, trials[j].value + (k == 0 ? -step : step))}));
      MoreauJean integrator(other, options);
      const Run run = simulate(integrator, *solver, clock);
      REQUIRE(run.status == Status::solved);
      end[k] = run.final;
    }
    const Eigen::VectorXd q = (end[1].q - end[0].q) / (2 * step), v = (end[1].v - end[0].v) / (2 * step);
    const auto column = static_cast<Index>(j);
    CHECK((q - tangent.q.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * q.lpNorm<Eigen::Infinity>());
    CHECK((v - tangent.v.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * v.lpNorm<Eigen::Infinity>());
    CHECK(v.lpNorm<Eigen::Infinity>() > 0);
  }
  return tangent;
}

MakeScene from_text(const std::string& text) {
  return [text](const std::vector<std::string>& sets) { return parse_scene(text, sets, "scene"); };
}

using Kind = RunColumn::Kind;

Scene with_value(const std::string& text, const std::string& key, double value) {
  char set[100];
  std::snprintf(set, sizeof set, "%s=%.17g", key.c_str(), value);
  return parse_scene(text, std::vector<std::string>{set}, "scene");
}

std::vector<RunParameter> parameters_by_keys(const std::string& text,
                                             const std::vector<std::pair<std::string, double>>& keys) {
  std::vector<RunParameter> parameters;
  for (const auto& [key, value] : keys)
    parameters.push_back({key, value, [text, key = key](double x) { return with_value(text, key, x); }, -1});
  return parameters;
}

// Scalars with weights that differ from record to record, by both modes.
RunAdjoint check_reverse(const std::string& text, const std::vector<RunParameter>& parameters, const Clock& clock,
                         const std::vector<RunColumn>& columns, double tolerance) {
  const System system(parse_scene(text, {}, "scene"));
  const auto solver = make_solver("auto");
  const auto weights = [](long record, bool last, Eigen::MatrixXd& W) {
    for (Index c = 0; c < W.rows(); ++c) {
      W(c, 0) = std::cos(static_cast<double>(1 + record * (c + 1)));
      W(c, 1) = last ? 1 : 0;
    }
  };
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(2, static_cast<Index>(parameters.size()));
  Eigen::VectorXd value = Eigen::VectorXd::Zero(2);
  long record = 0;
  const RunSteps steps(clock);
  const RunTangent forward = differentiate_run(system, parameters, {}, *solver, clock, columns,
                                               [&](double, const Eigen::VectorXd& x, const Eigen::MatrixXd& by) {
                                                 Eigen::MatrixXd W(by.rows(), 2);
                                                 weights(record, record == steps.records() - 1, W);
                                                 value += W.transpose() * x, gradient += W.transpose() * by;
                                                 ++record;
                                               });
  REQUIRE(forward.run.status == Status::solved);
  CHECK(record == steps.records());
  const RunAdjoint reverse = differentiate_run_reverse(system, parameters, {}, *solver, clock, columns, 2, weights);
  REQUIRE(reverse.run.status == Status::solved);
  CHECK((reverse.value - value).lpNorm<Eigen::Infinity>() <= 1e-12 * value.lpNorm<Eigen::Infinity>());
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    INFO(parameters[j].name);
    const auto column = static_cast<Index>(j);
    CHECK((reverse.gradient.col(column) - gradient.col(column)).lpNorm<Eigen::Infinity>() <=
          tolerance * gradient.col(column).lpNorm<Eigen::Infinity>());
    CHECK(gradient.col(column).lpNorm<Eigen::Infinity>() > 0);
  }
  CHECK(reverse.degenerate.size() == forward.degenerate.size());
  const double root = std::sqrt(static_cast<double>(steps.total));
  CHECK(reverse.checkpoints <= root + 1);
  CHECK(reverse.checkpoints >= root / 2);
  return reverse;
}

std::string slider_crank_text() { return scene_texts::contents(scene_texts::kCore / "scenes/slider_crank.toml"); }

std::vector<RunParameter> slider_crank_parameters() {
  auto parameters = parameters_by_keys(slider_crank_text(), {{"body.rod.mass", 0.038},
                                                             {"body.crank.inertia", 7.4e-5},
                                                             {"contact.corner1.mu", 0.01},
                                                             {"contact.corner4.e_n", 0.4},
                                                             {"body.crank.omega", 150}});
  parameters.push_back({"start", 0, {}, 11});
  // places, by hand: entries of arrays
  parameters.push_back({"corner1.point.y", 0.025,
                        [](double y) {
                          Scene s = parse_scene(slider_crank_text(), {}, "scene");
                          std::get<CornerWall>(s.contacts[0]).point.y() = y;
                          return s;
                        },
                        -1});
  parameters.push_back({"crank_pin.point_b.x", -0.0765,
                        [](double x) {
                          Scene s = parse_scene(slider_crank_text(), {}, "scene");
                          std::get<Revolute>(s.joints[0]).point_b.x() = x;
                          return s;
                        },
                        -1});
  return parameters;
}

const char* const kSpringsAndDrives = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1.3
inertia = 0.2
position = [0.5, 0]
[[body]]
name = "ball"
mass = 0.7
inertia = 0.03
position = [1.3, 0.4]
velocity = [0.4, -1]
omega = 2
[[body]]
name = "flap"
mass = 0.4
inertia = 0.02
position = [0, 1]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "arm"]
point_b = [-0.5, 0]
[[joint]]
name = "shaft"
type = "revolute"
bodies = ["ground", "flap"]
point_a = [0, 1]
[[joint]]
name = "motor"
type = "drive"
joint = "shaft"
offset = 0
rate = 0
amplitude = 0.1
omega = 20
[[spring]]
name = "coil"
type = "point"
bodies = ["arm", "ball"]
point_a = [0.4, 0]
stiffness = 30
damping = 0.6
rest = 0.5
[[spring]]
name = "link"
type = "point"
bodies = ["flap", "arm"]
point_a = [0.3, 0]
stiffness = 10
rest = 0.3
[[friction]]
name = "bearing"
joint = "pin"
bound = 0.4
[[load]]
name = "pull"
body = "arm"
point = [0.2, 0]
force = [0.5, 1]
torque = 0.1
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.2
wall = {point = [0, -0.1], normal = [0, 1]}
mu = 0.1
e_n = 0.6
e_t = 0.2
belt = 1.5
)";

// ω₁ = ω₀, ω₂ = −ω₀/2: the slider starts at rest.
Scene crank_with(int place, double value) {
  double p[] = {0.01, 0.4, 0.001, 150};
  p[place] = value;
  SliderCrank s;
  s.mu = p[0], s.e = p[1], s.clearance = p[2], s.omega1 = p[3], s.omega2 = -p[3] / 2;
  return slider_crank(s);
}

}  // namespace

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
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1.3
inertia = 0.2
position = [0.5, 0]
[[body]]
name = "ball"
mass = 0.7
inertia = 0.03
position = [1.3, 0.4]
velocity = [0.4, -1]
omega = 2
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "arm"]
point_b = [-0.5, 0]
[[spring]]
name = "coil"
type = "point"
bodies = ["arm", "ball"]
point_a = [0.4, 0]
stiffness = 30
damping = 0.6
rest = 0.5
[[friction]]
name = "bearing"
joint = "pin"
bound = 0.4
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.2
wall = {point = [0, -0.1], normal = [0, 1]}
mu = 0.1
e_n = 0.6
e_t = 0.2
belt = 1.5
)";
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

TEST_CASE("tangent of a run: a driven crank on a pin with clearance, by its speed, clearance and the start") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "crank"
mass = 1
inertia = 0.02
omega = 8
[[body]]
name = "rod"
mass = 0.5
inertia = 0.01
position = [0.45, 0.002]
velocity = [0, 1.6]
[[joint]]
name = "shaft"
type = "revolute"
bodies = ["ground", "crank"]
[[joint]]
name = "motor"
type = "drive"
joint = "shaft"
offset = 0
rate = 8
amplitude = 0.1
omega = 20
[[contact]]
name = "pin"
type = "journal"
bodies = ["crank", "rod"]
centre_a = [0.2, 0]
centre_b = [-0.25, 0]
radius_a = 0.01
radius_b = 0.014
mu = 0.1
e_n = 0.3
)";
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
  CHECK_THROWS_AS(differentiate_run(other, {}, {}, *solver, clock), std::runtime_error);
  MoreauJeanOptions full;
  full.form = Form::full;
  CHECK_THROWS_AS(differentiate_run(resting, {}, full, *solver, clock), std::invalid_argument);
  const std::vector<RunParameter> at_its_end = {
      {"e", 1, [&](double x) { return from_text(text)({override_text("contact.floor.e_n", x)}); }}};
  CHECK_THROWS_AS(differentiate_run(resting, at_its_end, {}, *solver, clock), std::invalid_argument);
}

TEST_CASE("adjoint of a run: the slider-crank through its impacts, states, gaps and impulses of many records") {
  check_reverse(slider_crank_text(), slider_crank_parameters(), {.step = 1e-4, .duration = 0.0301, .every = 7},
                {{Kind::state, 2}, {Kind::state, 14}, {Kind::gap, 2}, {Kind::normal, 0}, {Kind::tangent, 3}}, 1e-7);
}

TEST_CASE("adjoint of a run: springs, dampers, a drive, dry friction, loads, a belt, tangential restitution") {
  const std::string text = kSpringsAndDrives;
  check_reverse(text,
                parameters_by_keys(text, {{"spring.coil.stiffness", 30},
                                          {"spring.coil.damping", 0.6},
                                          {"spring.coil.rest", 0.5},
                                          {"joint.motor.amplitude", 0.1},
                                          {"friction.bearing.bound", 0.4},
                                          {"load.pull.torque", 0.1},
                                          {"contact.floor.e_n", 0.6},
                                          {"contact.floor.radius", 0.2},
                                          {"contact.floor.mu", 0.1},
                                          {"body.arm.mass", 1.3}}),
                {.step = 1e-3, .duration = 0.8}, {{Kind::state, 5}, {Kind::normal, 0}, {Kind::gap, 0}}, 1e-7);
}

TEST_CASE("columns of a run: gaps and impulses of contacts, by central differences of runs") {
  const std::vector<RunColumn> columns = {{Kind::gap, 0}, {Kind::normal, 1}, {Kind::tangent, 1}};
  const Clock clock{.step = 1e-4, .duration = 0.01, .every = 10};
  const auto solver = make_solver("auto");
  for (const RunParameter& p : slider_crank_parameters()) {
    if (!p.scene || p.name == "contact.corner4.e_n") continue;  // that one has not struck
    INFO(p.name);
    const auto values = [&](double x, Eigen::MatrixXd* by) {
      const System system(p.scene(x));
      std::vector<Eigen::VectorXd> rows;
      std::vector<RunParameter> all;
      if (by != nullptr) all.push_back(p);
      differentiate_run(system, all, {}, *solver, clock, columns,
                        [&](double, const Eigen::VectorXd& value, const Eigen::MatrixXd& by_p) {
                          rows.push_back(value);
                          if (by == nullptr) return;
                          by->conservativeResize(3, static_cast<Index>(rows.size()));
                          by->rightCols(1) = by_p;
                        });
      return rows;
    };
    Eigen::MatrixXd by(3, 0);
    values(p.value, &by);
    const double step = 1e-6 * std::abs(p.value);
    const auto high = values(p.value + step, nullptr), low = values(p.value - step, nullptr);
    REQUIRE(high.size() == 11);
    Eigen::MatrixXd difference(3, 11);
    for (std::size_t r = 0; r < 11; ++r) difference.col(static_cast<Index>(r)) = (high[r] - low[r]) / (2 * step);
    const bool parts = p.name == "corner1.point.y";  // it parts the face's corners, which strike together
    const Index smooth = parts ? 3 : 11;             // records before the first impact, or all
    for (Index c = 0; c < 3; ++c)
      CHECK((by.row(c) - difference.row(c)).head(smooth).lpNorm<Eigen::Infinity>() <=
            1e-5 * difference.row(c).head(smooth).lpNorm<Eigen::Infinity>() + 1e-9);
    CHECK(difference.row(parts ? 0 : 1).head(smooth).lpNorm<Eigen::Infinity>() > 0);
  }
  const System system(parse_scene(slider_crank_text(), {}, "scene"));
  CHECK_THROWS_AS(differentiate_run(system, {}, {}, *solver, clock, {{Kind::gap, 4}}), std::invalid_argument);
}

TEST_CASE(
    "derivatives of the motion: the crank's angle after 0.2 s by mu, e, clearance, speed, by differences of runs") {
  const double value[] = {0.01, 0.4, 0.001, 150}, step[] = {1e-3, 1e-5, 1e-5, 1e-5};
  std::vector<RunParameter> parameters;
  for (int i = 0; i < 4; ++i)
    parameters.push_back({std::to_string(i), value[i], [i](double x) { return crank_with(i, x); }, -1});
  const System system(crank_with(0, value[0]));
  const auto solver = make_solver("auto");
  const MotionTangent t = differentiate_motion(system, parameters, {}, *solver, 0.2);
  REQUIRE(t.status == Status::solved);
  CHECK(t.none.empty());
  CHECK(std::abs(t.final.q[2] - 18.0836786523406) < 1e-9);
  CHECK(t.guards.size() > 50);
  for (int i = 0; i < 4; ++i) {
    INFO(i);
    const double h = step[i] * value[i];
    double end[4];
    for (int k = 0; k < 4; ++k) {
      const System other(crank_with(i, value[i] + (k < 2 ? k - 2 : k - 1) * h));
      EventDriven integrator(other);
      end[k] = simulate(integrator, *solver, {.step = 0.2, .duration = 0.2}).final.q[2];
    }
    const double difference = (end[0] - 8 * end[1] + 8 * end[2] - end[3]) / (12 * h);
    CHECK(std::abs(t.q(2, i) - difference) <= 1e-6 * std::abs(difference));
  }
}

TEST_CASE("derivatives of the motion: a bounce and a stop by friction have closed forms; what parts has none") {
  const auto solver = make_solver("auto");
  const std::string ball = R"(
gravity = [0, -10]
[[body]]
name = "ball"
mass = 1
inertia = 1
position = [0, 1.25]
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.45
wall = {point = [0, 0], normal = [0, 1]}
e_n = 0.5
)";
  const System dropped(from_text(ball)({}));  // falls 0.8 m in 0.4 s, rebounds with 2 m/s
  std::vector<RunParameter> parameters = parameters_by_keys(ball, {{"contact.floor.e_n", 0.5}});
  parameters.push_back({"height", 0, {}, 1});
  const MotionTangent b = differentiate_motion(dropped, parameters, {}, *solver, 0.5);
  REQUIRE(b.guards.size() == 1);
  CHECK(std::abs(b.guards[0].t - 0.4) < 1e-12);
  CHECK(std::abs(b.guards[0].rate + 4) < 1e-9);
  CHECK(std::abs(b.guards[0].moves[1] - 0.25) < 1e-8);  // 1 / |γ⁻|
  CHECK(std::abs(b.v(1, 0) - 4) < 1e-8);
  CHECK(std::abs(b.q(1, 0) - 0.4) < 1e-8);
  CHECK(std::abs(b.v(1, 1) - 3.75) < 1e-8);   // (1 + e) g dT/dh, dT/dh = 0.25
  CHECK(std::abs(b.q(1, 1) + 0.125) < 1e-8);  // after 0.1 s: 0.1 · 3.75 − 2 · 0.25

  const std::string block = R"(
gravity = [0, -10]
[[body]]
name = "block"
mass = 2
inertia = 1
position = [0, 0.1]
velocity = [3, 0]
[[contact]]
name = "heel"
type = "corner-wall"
body = "block"
point = [-0.5, -0.1]
wall = {point = [0, 0], normal = [0, 1]}
mu = 0.3
[[contact]]
name = "toe"
type = "corner-wall"
body = "block"
point = [0.5, -0.1]
wall = {point = [0, 0], normal = [0, 1]}
mu = 0.3
)";
  const auto with_mu = [block](double mu) {
    Scene s = parse_scene(block, {}, "scene");
    for (Contact& c : s.contacts) std::get<CornerWall>(c).law.mu = mu;
    return s;
  };
  const System sliding(with_mu(0.3));  // stops after 1 s and 1.5 m
  const MotionTangent s = differentiate_motion(sliding, {{"mu", 0.3, with_mu, -1}, {"vx", 0, {}, 3}}, {}, *solver, 1.3);
  REQUIRE(s.status == Status::solved);
  CHECK(s.none.empty());
  CHECK(std::abs(s.final.q[0] - 1.5) < 1e-9);
  CHECK(std::abs(s.q(0, 0) + 5) < 1e-7);  // −v² / (2 μ² g)
  CHECK(std::abs(s.q(0, 1) - 1) < 1e-7);  // v / (μ g)
  CHECK(s.v.lpNorm<Eigen::Infinity>() < 1e-7);

  SliderCrank crank;
  const System face(slider_crank(crank));
  const auto tilted = [](double tilt) {
    SliderCrank other;
    other.theta3 = tilt;
    return slider_crank(other);
  };
  const MotionTangent parted = differentiate_motion(face, {{"tilt", 0, tilted, -1}}, {}, *solver, 0.003);
  CHECK(parted.none.find("parts") != std::string::npos);
}
