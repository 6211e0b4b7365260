// Differences by parameters of a run: times of load tables, fast loads and drives, tiny values, ends of a range;
// motions that are too unstable for derivatives.
#include <doctest/doctest.h>

#include "tests/integrators/derivatives/run_trials.h"

#include <cmath>

using namespace orthant;

namespace {

RunParameter parameter(const std::string& text, const std::string& key, const std::string& before, double value,
                       const std::string& after = "") {
  return {key, value, [=](double x) {
            char set[200];
            std::snprintf(set, sizeof set, "%s=%s%.17g%s", key.c_str(), before.c_str(), x, after.c_str());
            return from_text(text)({std::string(set)});
          }};
}

// x and vx of the first body at the end, by the parameter.
std::pair<double, double> by_run(const std::string& text, const RunParameter& p, const Clock& clock) {
  const auto solver = make_solver("auto");
  const RunTangent t = differentiate_run(System(from_text(text)({})), {p}, {}, *solver, clock);
  REQUIRE(t.run.status == Status::solved);
  return {t.q(0, 0), t.v(0, 0)};
}
std::pair<double, double> by_motion(const std::string& text, const RunParameter& p, double duration) {
  const auto solver = make_solver("auto");
  const MotionTangent t = differentiate_motion(System(from_text(text)({})), {p}, {}, *solver, duration, duration / 10);
  REQUIRE(t.status == Status::solved);
  CHECK(t.none == "");
  return {t.q(0, 0), t.v(0, 0)};
}

const std::string kPushed = R"(
[[body]]
name = "b"
mass = 1.0
inertia = 0.1
)";

}  // namespace

TEST_CASE("tangents by the time of a load table's point: those of the pieces on its two sides") {
  const std::string text = kPushed + R"(
[[load]]
name = "f"
body = "b"
force = [1, 0]
factor = {type = "table", times = [0, 0.5123, 1], values = [0, 1, 0]}
)";
  const RunParameter knot = parameter(text, "load.f.factor.times", "[0, ", 0.5123, ", 1]");
  const auto [x, v] = by_motion(text, knot, 1);  // a triangle: x(1) = ½ − (1 + t)/6, v(1) = ½
  CHECK(std::abs(x + 1. / 6) < 1e-9);
  CHECK(std::abs(v) < 1e-9);
  for (const double step : {1e-2, 1e-3}) {  // the sum of forces in the middles of steps
    double exact_v = 0, exact_x = 0;
    const auto steps = static_cast<int>(std::lround(1 / step));
    for (int k = 0; k < steps; ++k) {
      const double t = (k + 0.5) * step, T = 0.5123, by = t < T ? -t / (T * T) : (1 - t) / ((1 - T) * (1 - T));
      exact_x += step * (exact_v + 0.5 * step * by), exact_v += step * by;
    }
    const auto [at_x, at_v] = by_run(text, knot, {.step = step, .duration = 1});
    CHECK(std::abs(at_x - exact_x) < 1e-10);
    CHECK(std::abs(at_v - exact_v) < 1e-10);
  }
}

TEST_CASE("tangents by the frequency of a load that swings many times: to 1e-6, not to the fourth power of the phase") {
  const std::string text = kPushed + R"(
[[load]]
name = "f"
body = "b"
force = [50, 0]
factor = {type = "cosine", amplitude = 2, omega = 1000, phase = 0.5}
)";
  const double w = 1000, T = 4;  // v = 100 (sin(wT + φ) − sin φ) / w
  const double exact = 100 * (T * std::cos(w * T + 0.5) / w - (std::sin(w * T + 0.5) - std::sin(0.5)) / (w * w));
  const RunParameter omega = parameter(text, "load.f.factor.omega", "", w);
  const auto [x, v] = by_motion(text, omega, T);
  CHECK(std::abs(v - exact) < 1e-6 * std::abs(exact));
  const double h = 1e-3;  // of the discrete run: Σ h 100 cos(w t + φ)
  double sum = 0;
  for (int k = 0; k < 4000; ++k) sum -= h * 100 * (k + 0.5) * h * std::sin(w * (k + 0.5) * h + 0.5);
  const auto [at_x, at_v] = by_run(text, omega, {.step = h, .duration = T});
  CHECK(std::abs(at_v - sum) < 1e-6 * std::abs(sum));

  const std::string driven = kPushed + R"(
[[joint]]
name = "rail"
type = "prismatic"
bodies = ["ground", "b"]
[[joint]]
name = "m"
type = "drive"
joint = "rail"
amplitude = 0.1
omega = 200
)";
  const RunParameter fast = parameter(driven, "joint.m.omega", "", 200);
  const double by = 0.1 * 3 * std::cos(600.0);  // of 0.1 sin(ω t) at 3 s
  CHECK(std::abs(by_run(driven, fast, {.step = 1e-2, .duration = 3}).first - by) < 1e-7 * std::abs(by));
  CHECK(std::abs(by_motion(driven, fast, 3).first - by) < 1e-7 * std::abs(by));
}

TEST_CASE("tangents by values below rounding are those by zero") {
  const auto with = [](const std::string& value) {
    return "gravity = [0, -9.81]" + kPushed + R"(
position = [0, 1.0]
velocity = [1, 0]
[[spring]]
name = "s"
type = "point"
bodies = ["ground", "b"]
point_a = [)" +
           value + R"(, 2.0]
stiffness = 40
rest = 0.5
)";
  };
  const std::string zero = with("0");
  const Clock clock{.step = 1e-3, .duration = 0.5};
  const auto exact = by_run(zero, parameter(zero, "spring.s.point_a", "[", 0, ", 2.0]"), clock);
  const auto motion = by_motion(zero, parameter(zero, "spring.s.point_a", "[", 0, ", 2.0]"), 0.5);
  REQUIRE(std::abs(exact.first) > 1e-3);
  for (const char* tiny : {"6.123e-17", "1e-12", "1e-9", "1e-300"}) {
    INFO(tiny);
    const std::string text = with(tiny);
    const RunParameter p = parameter(text, "spring.s.point_a", "[", std::strtod(tiny, nullptr), ", 2.0]");
    CHECK(std::abs(by_run(text, p, clock).first - exact.first) < 1e-7 * std::abs(exact.first));
    CHECK(std::abs(by_motion(text, p, 0.5).first - motion.first) < 1e-7 * std::abs(motion.first));
  }
}

TEST_CASE("tangents by a parameter at the end of its range are those of one side, and say so") {
  const std::string text = R"(
gravity = [0, -10]
[[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.6]
velocity = [1, -1]
[[contact]]
name = "f"
type = "disc-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 1]}
e_n = 1
mu = 0.2
)";
  const auto solver = make_solver("auto");
  for (const bool elastic : {true, false}) {
    const std::string at = elastic ? text : text + "e_t = 0\n";
    const RunParameter p = parameter(at, "contact.f.e_n", "", elastic ? 1 : 0);
    const System system(from_text(at)({elastic ? "contact.f.e_n=1" : "contact.f.e_n=0"}));
    const double step = elastic ? -1e-6 : 1e-6;
    const MotionTangent t = differentiate_motion(system, {p}, {}, *solver, 0.4);
    REQUIRE(t.warnings.size() == 1);
    CHECK(t.warnings[0].find("the derivative is one-sided") != std::string::npos);
    const RunTangent run = differentiate_run(system, {p}, {}, *solver, {.step = 1e-3, .duration = 0.4});
    CHECK(run.warnings.size() == 1);
    State end[2];
    for (int k = 0; k < 2; ++k) {
      const System other(p.scene(p.value + k * step));
      EventDriven method(other);
      end[k] = simulate(method, *solver, {.step = 0.4, .duration = 0.4}).final;
    }
    const Eigen::VectorXd v = (end[1].v - end[0].v) / step;
    CHECK((v - t.v.col(0)).lpNorm<Eigen::Infinity>() < 2e-5);
    if (elastic) CHECK(v.lpNorm<Eigen::Infinity>() > 1);
  }
}

TEST_CASE("tangents by mu = 0: friction that begins acts at its bound against the slip, at impacts and in contacts") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "ball"
mass = 0.7
inertia = 0.03
position = [0, 0.5]
velocity = [1, 0]
omega = -2
[[body]]
name = "block"
mass = 2
inertia = 1
position = [3, 0.1]
velocity = [1, 0]
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 0.2
wall = {normal = [0, 1]}
mu = 0
e_n = 0.6
e_t = 0.2
[[contact]]
name = "heel"
type = "corner-wall"
body = "block"
point = [-0.5, -0.1]
wall = {normal = [0, 1]}
mu = 0
[[contact]]
name = "toe"
type = "corner-wall"
body = "block"
point = [0.5, -0.1]
wall = {normal = [0, 1]}
mu = 0
)";
  const auto solver = make_solver("auto");
  const auto with = [&](double mu) {
    Scene s = parse_scene(text, {}, "scene");
    for (Contact& c : s.contacts)
      std::visit(
          [mu](auto& one) {
            if constexpr (requires { one.law.mu; }) one.law.mu = mu;
          },
          c);
    return s;
  };
  const Clock clock{.step = 1e-3, .duration = 0.8};
  const std::vector<RunColumn> columns = {{RunColumn::Kind::tangent, 1}, {RunColumn::Kind::state, 8}};
  for (const StepScheme& scheme : {StepScheme(MoreauJeanOptions{}), StepScheme(RattleOptions{})}) {
    const System system(with(0));
    double push = 0;
    const RunTangent t =
        differentiate_run(system, {{"mu", 0, with, -1}}, scheme, *solver, clock, columns,
                          [&](double, const Eigen::VectorXd&, const Eigen::MatrixXd& by) { push += by(0, 0); });
    REQUIRE(t.run.status == Status::solved);
    CHECK(t.warnings.size() == 1);  // one-sided
    CHECK(t.degenerate.empty());
    State end[3];  // 0, ε, 2ε
    for (int k = 0; k < 3; ++k) end[k] = run_by(System(with(k * 1e-5)), scheme, *solver, clock).final;
    const Eigen::VectorXd v = (-1.5 * end[0].v + 2 * end[1].v - 0.5 * end[2].v) / 1e-5;
    const Eigen::VectorXd q = (-1.5 * end[0].q + 2 * end[1].q - 0.5 * end[2].q) / 1e-5;
    CHECK((v - t.v.col(0)).lpNorm<Eigen::Infinity>() <= 1e-5 * v.lpNorm<Eigen::Infinity>());
    CHECK((q - t.q.col(0)).lpNorm<Eigen::Infinity>() <= 1e-5 * q.lpNorm<Eigen::Infinity>());
    CHECK(std::abs(t.v(3, 0) + 9.81 * 0.8) < 1e-2);  // the block: −g t
    CHECK(push < -1);
    const RunAdjoint back =
        differentiate_run_reverse(system, {{"mu", 0, with, -1}}, scheme, *solver, clock, columns, 2, weigh_last());
    CHECK(std::abs(back.gradient(1, 0) - t.v(2, 0)) <= 1e-9 * std::abs(t.v(2, 0)));
  }
  const auto at_rest = [&](double mu) {
    Scene s = with(mu);
    s.bodies[1].velocity = {0, 0};
    return s;
  };
  const RunTangent rest = differentiate_run(System(at_rest(0)), {{"mu", 0, at_rest, -1}}, {}, *solver, clock);
  CHECK(rest.degenerate.size() == 800);  // contacts without slip
  CHECK(rest.v(3, 0) == 0);
}

TEST_CASE("tangents that exceed the range of numbers end with the reason") {
  const auto solver = make_solver("auto");
  const System tower(make_scene("tower", std::vector<std::string>{}));  // a heavy disc balanced on a light one
  CHECK_THROWS_WITH_AS(differentiate_run(tower, {{"start", 0, {}, 6}}, {}, *solver, {.step = 1e-3, .duration = 1}),
                       doctest::Contains("exceed the range of numbers"), std::runtime_error);
}
