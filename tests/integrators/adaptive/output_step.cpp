// Dense output of the adaptive scheme: the output step changes neither the motion nor its cost, and each state between
// inner steps is as good as the tolerance.
#include "tests/support/runs.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/integrators/adaptive/adaptive.h>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace orthant;

namespace {

Scene of_file(const char* name) { return read_scene(std::string(ORTHANT_ROOT "/tests/data/") + name); }

struct Looked {  // what a run hands out
  Run run;
  std::vector<double> t, q;  // q: all coordinates at t
  std::vector<Event> events;
  std::vector<Impulse> sum;
  std::vector<double> friction;  // until t, of all contacts
};

Looked look(const Scene& scene, double duration, std::string_view integrator, double step) {
  Looked seen;
  seen.sum.resize(scene.contacts.size());
  seen.run = run_for(scene, duration, integrator, step, [&](const RunSample& m) {
    seen.t.push_back(m.state.t);
    seen.q.insert(seen.q.end(), m.state.q.data(), m.state.q.data() + m.state.q.size());
    for (const Event& event : m.events) {
      seen.events.push_back(event);
      if (event.kind != EventKind::accumulation && seen.t.size() > 1) {
        CHECK(event.t <= m.state.t + 1e-12);
        CHECK(event.t > seen.t[seen.t.size() - 2] - 1e-12);
      }
    }
    for (std::size_t c = 0; c < seen.sum.size(); ++c)
      seen.sum[c].normal += m.impulses[c].normal, seen.sum[c].tangent += m.impulses[c].tangent;
    seen.friction.push_back(0);
    for (const Impulse& sum : seen.sum) seen.friction.back() += sum.tangent;
  });
  REQUIRE_MESSAGE(seen.run.status == Status::solved, seen.run.why);
  return seen;
}

/// Largest difference, of the entries' size or 1.
double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return ((a - b).array() / b.array().abs().max(1)).abs().maxCoeff();
}

}  // namespace

TEST_CASE("adaptive: the output step changes no event, no inner step, and the motion by rounding of the time alone") {
  const std::pair<Scene, double> cases[] = {{slider_crank({.mu = 0.1}), 0.05},
                                            {of_file("four_bar_clearance.toml"), 0.3},
                                            {coulomb_decay(), 20},
                                            {bouncing_ball({.e = 0.9}), 7},
                                            {of_file("belt_block.toml"), 20}};
  for (const auto& [scene, duration] : cases) {
    const Looked once = look(scene, duration, "adaptive:rtol=1e-6", duration);
    for (const double parts : {7.0, 100.0, 5000.0}) {
      CAPTURE(duration);
      CAPTURE(parts);
      const Looked often = look(scene, duration, "adaptive:rtol=1e-6", duration / parts);
      CHECK(distance(often.run.final.q, once.run.final.q) <= 1e-13);  // the end's time is a sum of other steps
      CHECK(distance(often.run.final.v, once.run.final.v) <= 1e-11);
      CHECK(often.run.accepted == once.run.accepted);
      CHECK(often.run.rejected == once.run.rejected);
      REQUIRE(often.events.size() == once.events.size());
      for (std::size_t k = 0; k < once.events.size(); ++k) {
        CHECK(often.events[k].t == once.events[k].t);
        CHECK(often.events[k].normal == once.events[k].normal);
      }
      for (std::size_t c = 0; c < once.sum.size(); ++c) {
        const double size = std::abs(once.sum[c].normal) + 1e-6;
        CHECK(std::abs(often.sum[c].normal - once.sum[c].normal) <= 1e-9 * size);
        CHECK(std::abs(often.sum[c].tangent - once.sum[c].tangent) <= 1e-9 * size);
      }
      CHECK(often.run.max_joint_residual <= 1e-11);
      CHECK(often.run.max_penetration <= 1e-7);
    }
  }
}

TEST_CASE("adaptive: states between inner steps keep the tolerance") {
  for (const auto& [adaptive, tolerance] : {std::pair<std::string, double>{"adaptive:rtol=1e-3", 1e-3},
                                            {"adaptive:rtol=1e-6", 1e-6},
                                            {"adaptive:rtol=1e-9", 1e-9}}) {
    CAPTURE(adaptive);
    const std::pair<Scene, double> cases[] = {
        {slider_crank({.mu = 0.1}), 0.05}, {pendulum(), 4}, {coulomb_decay(), 20}};
    for (const auto& [scene, duration] : cases) {
      const Looked exact = look(scene, duration, "event-driven", duration / 500);
      const Looked seen = look(scene, duration, adaptive, duration / 500);
      REQUIRE(seen.q.size() == exact.q.size());
      double worst = 0, size = 1;
      for (std::size_t i = 0; i < seen.q.size(); ++i)
        worst = std::max(worst, std::abs(seen.q[i] - exact.q[i])), size = std::max(size, std::abs(exact.q[i]));
      MESSAGE(adaptive << ", " << duration << " s: off by " << worst);
      CHECK(worst <= tolerance * size);
    }
  }
}

TEST_CASE("four-bar with clearance in a pin: the crank's angle at any output step, better at a tighter tolerance") {
  const Scene scene = of_file("four_bar_clearance.toml");
  constexpr double kTheta = 5.9599491;  // event-driven at 1e-13, 1e-14: 5.95994905
  const auto error = [&](const char* spec, double step) {
    return std::abs(run_for(scene, 1, spec, step).final.q[2] - kTheta);
  };
  CHECK(error("adaptive:rtol=1e-6", 1e-3) <= 2e-4);
  CHECK(error("adaptive:rtol=1e-9", 1e-2) <= 1e-6);
  CHECK(error("adaptive:rtol=1e-9", 1e-4) <= 1e-6);
  CHECK(error("adaptive:rtol=1e-12", 1e-2) <= 1e-6);
}

TEST_CASE("slider-crank with a tilted start: a tighter tolerance is no worse") {
  for (const double omega3 : {-0.01, 0.02, -0.3}) {
    CAPTURE(omega3);
    const Scene scene = slider_crank({.omega3 = omega3});
    const double exact = run_for(scene, 0.2, "event-driven", 0.2).final.q[kTheta1];
    for (const auto& [spec, most] :
         {std::pair{"adaptive:rtol=1e-6", 1e-5}, {"adaptive:rtol=1e-9", 1e-7}, {"adaptive:rtol=1e-12", 1e-8}})
      CHECK(std::abs(run_for(scene, 0.2, spec, 1e-3).final.q[kTheta1] - exact) <= most);
  }
}

TEST_CASE("a block on a belt, at the tightest tolerance: ends in a few hundred steps") {
  const Scene scene = of_file("belt_block.toml");
  for (const double step : {0.1, 1e-3}) {
    const Run r = run_for(scene, 20, "adaptive:rtol=1e-12", step);
    CHECK(r.status == Status::solved);
    CHECK(r.final.q[0] == doctest::Approx(0.300033986584012).epsilon(1e-10));
    CHECK(r.accepted + r.rejected <= 1000);
  }
}

TEST_CASE("adaptive: states within a crossing lie on the joints, and their residual is reported") {
  const Scene scene = of_file("parallelogram_redundant.toml");
  const System system(scene);
  Terms terms(system);
  double worst = 0;
  const Run run = run_for(scene, scene.duration, "adaptive", scene.duration / 140, [&](const RunSample& m) {
    set_poses(system, m.state.t, m.state.q, terms.at);
    evaluate_joint_residual(system, terms);
    worst = std::max(worst, terms.phi.lpNorm<Eigen::Infinity>());
  });
  REQUIRE_MESSAGE(run.status == Status::solved, run.why);
  REQUIRE(run.crossings > 0);
  CHECK(worst <= 1e-12);
  CHECK(run.max_joint_residual <= 1e-12);
}

TEST_CASE("adaptive: the impulses of contacts that last are those of the forces, however long the inner steps are") {
  // A block rides on a belt under the point that a spring pulls it to: its friction is the spring's force along x.
  const double speed = -1.9, stiffness = 20, rest = 0.2, duration = 0.35;
  Scene s{.gravity = {0, -9.81}, .duration = duration};
  const BodyId b = s.body({.mass = 1, .inertia = 0.004, .position = {0.1, 0.05}, .velocity = {speed, 0}});
  for (const double x : {-0.1, 0.1})
    s.contact(CornerWall{{}, b, {x, -0.05}, kGround, {0, 0}, {0, 1}, {.mu = 2, .belt = speed}});
  s.spring(PointSpring{.a = kGround, .b = b, .point_a = {-0.2, 0.3}, .stiffness = stiffness, .rest = rest});
  const auto expected = [&](double t) {  // [N s]
    const int n = 50000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double x = 0.1 + speed * (i + 0.5) * t / n + 0.2, length = std::hypot(x, 0.25);
      sum += stiffness * (length - rest) * x / length * t / n;
    }
    return sum;
  };
  for (const double step : {duration / 140, duration / 4, duration}) {
    CAPTURE(step);
    const Looked seen = look(s, duration, "adaptive:rtol=1e-8", step);
    CHECK(std::abs(seen.run.final.v[0] - speed) < 1e-12);
    double off = 0;
    for (std::size_t k = 0; k < seen.t.size(); ++k)
      off = std::max(off, std::abs(std::abs(seen.friction[k]) - std::abs(expected(seen.t[k]))));
    CHECK(off < 2e-8);
  }
}

TEST_CASE("impacts between two looks: the tip of a spinning bar, a disc that flies past a peg, at any output step") {
  Scene bar;
  bar.body({.mass = 1, .inertia = 0.3, .position = {0, 1.01}, .velocity = {0, -0.05}, .omega = 200});
  bar.contact(CornerWall{.a = 0, .point = {1, 0}, .law = {.e = 0.5}});
  Scene peg;
  peg.body({.mass = 1, .inertia = 1, .position = {-1000, 0.199}, .velocity = {1000, 0}});
  peg.contact(DiscDisc{.a = 0, .radius_a = 0.1, .b = kGround, .radius_b = 0.1, .law = {.e = 1}});
  for (const double step : {1.0, 0.25, 1e-2}) {
    CAPTURE(step);
    const Run struck = run_for(bar, 0.21388512155672565, "adaptive", 0.2139 * step);
    CHECK(struck.final.q[1] == doctest::Approx(1.02005537).epsilon(1e-6));  // event-driven
    const Run passed = run_for(peg, 2, "adaptive", 2 * step);
    CHECK(passed.final.v[1] == doctest::Approx(198.75109).epsilon(1e-5));  // 2 · 1000 · 0.199/0.2 · √(1 − 0.995²)
  }
}

TEST_CASE("output times that fall on impacts: the shortest step is one that can be done") {
  const double omega = 1.8, period = 2 * std::numbers::pi / omega;
  const ImpactOscillator scene{.omega = omega, .disturbance = 0.05};
  for (const double part : {1, 2, 7}) {
    const Run r = run_for(impact_oscillator(scene), 160 * period, "adaptive:rtol=1e-10", period / part);
    CHECK(r.status == Status::solved);
    CHECK(std::abs(r.final.q[0]) <= 1e-6);
  }
}
