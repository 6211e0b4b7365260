// The headline study's claims, against the exact motion of core/scenes/slider_crank_exact.h.
#include "experiments/support/fit_order.h"
#include "tests/support/runs.h"

#include <orthant/core/scenes/slider_crank_exact.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

template <class Claim>
void for_each_gentle_case(Claim&& claim) {  // e ≤ 0.4: the motion is well conditioned over all 0.2 s
  for (const SliderCrankExact& exact : slider_crank_exact())
    if (exact.e <= 0.4) {
      CAPTURE(exact.mu);
      CAPTURE(exact.e);
      claim(exact);
    }
}

}  // namespace

TEST_CASE("ideal mechanism: the symmetric joints converge with order 2, energy with it") {
  const IdealSliderCrankExact exact;
  const auto error = [&](double h) {
    const Run r = run(slider_crank_ideal(), kSymmetric, h);
    CHECK(r.max_joint_residual < 1e-9);
    CHECK(std::abs(r.energy_final - exact.energy) < 20 * h * h * 1e6 * exact.energy);
    return std::abs(r.final.q[kTheta1] - exact.theta1);
  };
  const Fit fit = fit_order({.coarsest = 6.4e-5, .octaves = 4, .steps_per_octave = 4, .duration = 0.2}, error);
  MESSAGE("order " << fit.order << ", error at h = " << fit.worst.back().h << ": " << fit.worst.back().error);
  CHECK(std::abs(fit.order - 2) < 0.15);
  CHECK(fit.scatter < 0.2);
  CHECK(error(1e-5) < 1e-5);
}

TEST_CASE("ideal mechanism: classical joints converge with order 1") {
  const double coarse =
      std::abs(run(slider_crank_ideal(), kPosition, 2e-5).final.q[kTheta1] - IdealSliderCrankExact{}.theta1);
  const double fine =
      std::abs(run(slider_crank_ideal(), kPosition, 1e-5).final.q[kTheta1] - IdealSliderCrankExact{}.theta1);
  CHECK(std::log2(coarse / fine) == doctest::Approx(1).epsilon(0.1));
}

TEST_CASE("classical joints with position projection: within 0.14 rad at h = 1e-5") {
  for_each_gentle_case([](const SliderCrankExact& exact) { CHECK(theta1_error(exact, kPosition, 1e-5) <= 0.14); });
}

TEST_CASE("symmetric joints: within 2e-3 rad at h = 1e-5") {
  for_each_gentle_case([](const SliderCrankExact& exact) {
    const double error = theta1_error(exact, kSymmetric, 1e-5);
    MESSAGE("mu = " << exact.mu << ", e = " << exact.e << ": " << error << " rad");
    CHECK(error <= 2e-3);
  });
}

TEST_CASE("classical joints: order 1 by the worst error of each octave" * doctest::test_suite("slow")) {
  for_each_gentle_case([](const SliderCrankExact& exact) {
    const Fit fit = fit_order({.coarsest = 1.6e-5, .octaves = 4, .steps_per_octave = 6, .duration = 0.2},
                              [&](double h) { return theta1_error(exact, kPosition, h); });
    MESSAGE("mu = " << exact.mu << ", e = " << exact.e << ": order " << fit.order << ", scatter " << fit.scatter);
    CHECK(std::abs(fit.order - 1) <= 0.1);
    CHECK(fit.scatter < 0.3);
  });
}

TEST_CASE("constraints hold over a run: joints to 1e-9, slider upright to 1e-12, every problem certified") {
  for (const std::string_view integrator : {kPosition, kSymmetric})
    for_each_gentle_case([&](const SliderCrankExact& exact) {
      double tilt = 0;
      const Run r = run(slider_crank({.mu = exact.mu, .e = exact.e}), integrator, 1e-5, [&](const RunSample& m) {
        tilt = std::max(tilt, std::abs(m.state.q[kTheta3]));
        CHECK(m.report.status == Status::solved);
      });
      CHECK(r.status == Status::solved);
      CHECK(tilt < 1e-12);
      CHECK(r.max_joint_residual <= 1e-9);
      CHECK(r.max_lcp_residual <= 1e-10);
      CHECK(r.lcp_solves > 100);
    });
}

TEST_CASE("the first five impacts converge to the exact times with order 1") {
  Scene scene = slider_crank();
  scene.duration = 9.2e-3;
  for (const double h : {1e-5, 1e-6, 1e-7}) {
    std::vector<double> times;  // end of a step in which the top corners were hit from a distance
    bool open = true;
    run(scene, kSymmetric, h, [&](const RunSample& m) {
      const bool hit = m.impulses[0].normal > 0;
      if (hit && open) times.push_back(m.state.t);
      open = !hit;
    });
    const auto exact = slider_crank_impact_times();
    REQUIRE(times.size() >= exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double off = (times[i] - exact[i]) / h;  // a grid sees an impact up to a step late, and delays add up
      MESSAGE("h = " << h << ", impact " << i + 1 << ": " << off << " h off");
      CHECK(std::abs(off) <= 2.0 * static_cast<double>(i + 1));
    }
  }
}

TEST_CASE("energy never rises at an impact") {
  for_each_gentle_case([](const SliderCrankExact& exact) {
    const Scene scene = slider_crank({.mu = exact.mu, .e = exact.e});
    const System system(scene);
    double before = 0, worst = -kInf, flight = 0, rise = 0;  // rise: the slider's ẏ before the step
    int impacts = 0;
    run(scene, kSymmetric, 1e-5, [&](const RunSample& m) {
      const double now = energy(system, m.state);
      const bool top = m.impulses[0].normal > 0, hit = top || m.impulses[2].normal > 0;
      if (hit && (top ? rise : -rise) > 1e-3) {  // it approached the wall; else it is a contact that lasts
        ++impacts;
        worst = std::max(worst, now - before);
      } else if (!hit && m.state.t > 0) {
        flight = std::max(flight, std::abs(now - before));
      }
      before = now, rise = m.state.v[7];
    });
    CHECK(impacts >= 5);
    CHECK(flight < 1e-8);  // what a step without contact does to the energy: the flow's own error, not an impact's
    MESSAGE("mu = " << exact.mu << ", e = " << exact.e << ": largest change at an impact " << worst
                    << " J, in a step of free flight " << flight << " J");
    CHECK(worst < 0);
  });
}

TEST_CASE("a tilted start loses the face's restitution: the comparable results agree") {
  double first_touch = -1;
  int corner = -1;
  const Run r = run(slider_crank({.omega3 = -0.01}), kSymmetric, 1e-6, [&](const RunSample& m) {
    for (int i = 0; i < 4 && first_touch < 0; ++i)
      if (m.impulses[static_cast<std::size_t>(i)].normal > 0) first_touch = m.state.t, corner = i;
  });
  CHECK(r.status == Status::solved);
  CHECK(corner == 0);
  CHECK(first_touch == doctest::Approx(2.69090364840784e-3).epsilon(2e-6 / 2.69e-3));
  CHECK(r.final.q[kTheta1] > 18.078);
  CHECK(r.final.q[kTheta1] < 18.084);
}

TEST_CASE("Lemke and enumeration give the same trajectory") {
  for (const double mu : {0.0, 0.01, 0.1}) {
    std::vector<Eigen::VectorXd> path;
    run(slider_crank({.mu = mu}), kSymmetric, 1e-5, [&](const RunSample& m) { path.push_back(m.state.q); });
    double apart = 0;
    std::size_t i = 0;
    const Run r = run(
        slider_crank({.mu = mu}), kSymmetric, 1e-5,
        [&](const RunSample& m) { apart = std::max(apart, (m.state.q - path[i++]).lpNorm<Eigen::Infinity>()); },
        "enumerate");
    CHECK(r.status == Status::solved);
    CHECK(i == path.size());
    CHECK(apart <= 1e-10);
  }
}

TEST_CASE("same input, same bits") {
  const Run a = run(slider_crank({.mu = 0.1}), kSymmetric, 1e-4), b = run(slider_crank({.mu = 0.1}), kSymmetric, 1e-4);
  CHECK(a.final.q == b.final.q);
  CHECK(a.final.v == b.final.v);
}

TEST_CASE(
    "the motion does not depend on the solver's tolerance: adaptive and event-driven with sweeps meet the exact "
    "angle") {
  const SliderCrankExact exact = *slider_crank_exact(0.01, 0.4);
  const System system(slider_crank({.mu = exact.mu, .e = exact.e}));
  for (const std::string_view integrator : {"adaptive:rtol=1e-11", "event-driven:rtol=1e-11"})
    for (const std::string_view by : {"pgs", "psor", "lemke"}) {
      CAPTURE(integrator);
      CAPTURE(by);
      const Run run = simulate(*make_integrator(integrator, system), *make_solver(by), {.step = 2e-3, .duration = 0.2});
      CHECK(run.status == Status::solved);
      CHECK(std::abs(run.final.q[kTheta1] - exact.theta1) < 1e-9);
    }
}
