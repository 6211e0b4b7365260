// tests/integrators/derivatives/run_trials.h — scenes for derivatives of runs, from text and by a parameter.
#pragma once

#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/scene_texts.h"

namespace orthant {

using MakeScene = std::function<Scene(const std::vector<std::string>&)>;

inline MakeScene from_text(const std::string& text) {
  return [text](const std::vector<std::string>& sets) { return parse_scene(text, sets, "scene"); };
}

inline std::string override_text(const std::string& key, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return key + "=" + text;
}

struct TangentTrial {
  std::string key;
  double value;
  double step = 1e-6;  // of the value, or by itself: small enough for the pattern, large enough for rounding
};

inline Run run_by(const System& system, const StepScheme& scheme, Solver& solver, const Clock& clock,
                  const RecorderOf<Planar>& record = {}) {
  return std::visit(
      [&]<class Options>(const Options& options) {
        typename StepSchemeOf<Options>::Integrator integrator(system, options);
        return simulate(integrator, solver, clock, record);
      },
      scheme);
}

/// The energy, and the impulses of dry friction in joints.
template <class Space> std::vector<RunColumn> energy_and_frictions(const SystemOf<Space>& system) {
  std::vector<RunColumn> columns = {{RunColumn::Kind::energy, 0}};
  for (Index i = 0; i < std::ssize(system.scene().frictions); ++i) columns.push_back({RunColumn::Kind::friction, i});
  return columns;
}

/// Their values at the end of a run with one record, which are those since the start.
template <class Space> class EnergyAndFrictions {
 public:
  explicit EnergyAndFrictions(const SystemOf<Space>& system) : system_(system) {}
  void take(const RunSampleOf<Space>& moment) {
    values.resize(1 + std::ssize(moment.frictions));
    values[0] = energy(system_, moment.state);
    for (std::size_t i = 0; i < moment.frictions.size(); ++i) values[1 + static_cast<Index>(i)] = moment.frictions[i];
  }
  Eigen::VectorXd values;

 private:
  const SystemOf<Space>& system_;
};

/// The derivatives `by` of energy_and_frictions against their differences; dv: of the velocities at the end.
template <class Space> void check_energy_and_frictions(const SystemOf<Space>& system, const State& end,
                                                       const Eigen::VectorXd& dv, const Eigen::VectorXd& by,
                                                       const Eigen::VectorXd& difference, double tolerance) {
  // Parts of the energy's change cancel: their size is that of the kinetic energy's. Rounding: of its difference.
  const double parts = system.mass().cwiseProduct(end.v).cwiseProduct(dv).template lpNorm<1>();
  CHECK(std::abs(by[0] - difference[0]) <=
        tolerance * (std::abs(difference[0]) + parts) + 1e-9 * std::abs(energy(system, end)));
  for (Index i = 1; i < by.size(); ++i)
    CHECK(std::abs(by[i] - difference[i]) <= tolerance * (1 + std::abs(difference[i])));
}

/// The tangents of all keys, of state, energy and dry friction, and central differences of runs.
inline RunTangent check_tangents(const MakeScene& make, const std::vector<TangentTrial>& trials, const Clock& clock,
                                 double tolerance, const StepScheme& scheme = {}) {
  Clock ends = clock;
  ends.every = 1000000;
  std::vector<RunParameter> parameters;
  for (const TangentTrial& trial : trials)
    parameters.push_back({trial.key, trial.value, [&](double x) { return make({override_text(trial.key, x)}); }});
  const System system(make({}));
  const auto solver = make_solver("auto");
  Eigen::MatrixXd by;
  RunTangent tangent =
      differentiate_run(system, parameters, scheme, *solver, ends, energy_and_frictions(system),
                        [&](double, const Eigen::VectorXd&, const Eigen::MatrixXd& derivatives) { by = derivatives; });
  REQUIRE(tangent.run.status == Status::solved);
  for (std::size_t j = 0; j < trials.size(); ++j) {
    INFO(trials[j].key);
    const double step = trials[j].step * (trials[j].value != 0 ? std::abs(trials[j].value) : 1);
    State end[2];
    Eigen::VectorXd values[2];
    for (int k = 0; k < 2; ++k) {
      const System other(make({override_text(trials[j].key, trials[j].value + (k == 0 ? -step : step))}));
      EnergyAndFrictions<Planar> last(other);
      const Run run = run_by(other, scheme, *solver, ends, [&](const RunSample& moment) { last.take(moment); });
      REQUIRE(run.status == Status::solved);
      end[k] = run.final, values[k] = last.values;
    }
    const Eigen::VectorXd q = (end[1].q - end[0].q) / (2 * step), v = (end[1].v - end[0].v) / (2 * step);
    const auto column = static_cast<Index>(j);
    CHECK((q - tangent.q.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * q.lpNorm<Eigen::Infinity>());
    CHECK((v - tangent.v.col(column)).lpNorm<Eigen::Infinity>() <= tolerance * v.lpNorm<Eigen::Infinity>());
    CHECK(v.lpNorm<Eigen::Infinity>() > 0);
    check_energy_and_frictions(system, end[0], v, by.col(column), (values[1] - values[0]) / (2 * step), tolerance);
  }
  return tangent;
}

inline Scene with_value(const std::string& text, const std::string& key, double value) {
  char set[100];
  std::snprintf(set, sizeof set, "%s=%.17g", key.c_str(), value);
  return parse_scene(text, std::vector<std::string>{set}, "scene");
}

inline std::vector<RunParameter> parameters_by_keys(const std::string& text,
                                                    const std::vector<std::pair<std::string, double>>& keys) {
  std::vector<RunParameter> parameters;
  for (const auto& [key, value] : keys)
    parameters.push_back({key, value, [text, key = key](double x) { return with_value(text, key, x); }, -1});
  return parameters;
}

/// Scalars with weights that differ from record to record, by both modes.
inline RunAdjoint check_reverse(const std::string& text, const std::vector<RunParameter>& parameters,
                                const Clock& clock, const std::vector<RunColumn>& columns, double tolerance,
                                const StepScheme& scheme = {}) {
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
  const RunTangent forward = differentiate_run(system, parameters, scheme, *solver, clock, columns,
                                               [&](double, const Eigen::VectorXd& x, const Eigen::MatrixXd& by) {
                                                 Eigen::MatrixXd W(by.rows(), 2);
                                                 weights(record, record == steps.records() - 1, W);
                                                 value += W.transpose() * x, gradient += W.transpose() * by;
                                                 ++record;
                                               });
  REQUIRE(forward.run.status == Status::solved);
  CHECK(record == steps.records());
  const RunAdjoint reverse = differentiate_run_reverse(system, parameters, scheme, *solver, clock, columns, 2, weights);
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

/// An arm on a pin with dry friction, on a spring to a ball that strikes a moving belt.
inline const std::string kArmAndBall = R"(
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

inline std::string slider_crank_text() {
  return scene_texts::contents(scene_texts::kCore / "scenes/slider_crank.toml");
}

inline std::vector<RunParameter> slider_crank_parameters() {
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

/// kArmAndBall with a driven flap, a spring between it and the arm, and a load.
inline const std::string kArmBallAndFlap = kArmAndBall + R"([[body]]
name = "flap"
mass = 0.4
inertia = 0.02
position = [0, 1]
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
name = "link"
type = "point"
bodies = ["flap", "arm"]
point_a = [0.3, 0]
stiffness = 10
rest = 0.3
[[load]]
name = "pull"
body = "arm"
point = [0.2, 0]
force = [0.5, 1]
torque = 0.1
)";

inline std::vector<RunParameter> arm_ball_and_flap_parameters() {
  return parameters_by_keys(kArmBallAndFlap, {{"spring.coil.stiffness", 30},
                                              {"spring.coil.damping", 0.6},
                                              {"spring.coil.rest", 0.5},
                                              {"joint.motor.amplitude", 0.1},
                                              {"friction.bearing.bound", 0.4},
                                              {"load.pull.torque", 0.1},
                                              {"contact.floor.e_n", 0.6},
                                              {"contact.floor.radius", 0.2},
                                              {"contact.floor.mu", 0.1},
                                              {"body.arm.mass", 1.3}});
}

/// A driven crank on a pin with clearance.
inline const std::string kDrivenCrank = R"(
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

/// Without a warning a derivative must be that of both sides, with one that of the side which it names.
inline void check_side(const std::vector<std::string>& warnings, bool larger, bool smaller) {
  std::string words;
  for (const std::string& warning : warnings) words += warning + '\n';
  CAPTURE(words);
  if (words.find("of larger values") != std::string::npos)
    CHECK(larger);
  else if (words.find("of smaller values") != std::string::npos)
    CHECK(smaller);
  else if (words.find("one-sided") != std::string::npos)
    CHECK((larger || smaller));
  else
    CHECK((larger && smaller));
}

}  // namespace orthant
