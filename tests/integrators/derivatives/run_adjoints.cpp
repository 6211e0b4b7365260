// Adjoints of runs, derivatives of recorded columns, derivatives of the motion itself.
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

namespace {

using Kind = RunColumn::Kind;

// ω₁ = ω₀, ω₂ = −ω₀/2: the slider starts at rest.
Scene crank_with(int place, double value) {
  double p[] = {0.01, 0.4, 0.001, 150};
  p[place] = value;
  SliderCrank s;
  s.mu = p[0], s.e = p[1], s.clearance = p[2], s.omega1 = p[3], s.omega2 = -p[3] / 2;
  return slider_crank(s);
}

}  // namespace

TEST_CASE("adjoint of a run: the slider-crank through its impacts, states, gaps and impulses of many records") {
  check_reverse(slider_crank_text(), slider_crank_parameters(), {.step = 1e-4, .duration = 0.0301, .every = 7},
                {{Kind::state, 2}, {Kind::state, 14}, {Kind::gap, 2}, {Kind::normal, 0}, {Kind::tangent, 3}}, 1e-7);
}

TEST_CASE("adjoint of a run: springs, dampers, a drive, dry friction, loads, a belt, tangential restitution") {
  check_reverse(kArmBallAndFlap, arm_ball_and_flap_parameters(), {.step = 1e-3, .duration = 0.8},
                {{Kind::state, 5}, {Kind::normal, 0}, {Kind::gap, 0}, {Kind::energy, 0}, {Kind::friction, 0}}, 1e-7);
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
