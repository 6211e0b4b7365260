// Observed order of every scheme on smooth motion, with impacts, with stick-slip and on the slider-crank: by the worst
// error of each octave of h, two-sided, and with a bound on the scatter about the straight line.
#include "experiments/support/fit_order.h"
#include "tests/support/runs.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/stick_slip.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

/// What theory says of each scheme's order on smooth motion; with impacts and with stick-slip it is 1 for all.
struct Scheme {
  std::string_view spec;
  int smooth;
};
constexpr Scheme kSchemes[] = {
    {"moreau-jean", 2},     {"stewart-trinkle", 1},   {"anitescu-potra", 1},
    {"paoli-schatzman", 1}, {"generalized-alpha", 2}, {"rattle", 2},
};
constexpr Scheme kVariants[] = {
    {"moreau-jean:theta=0.75", 1},      {"moreau-jean:joints=position", 1},   {"stewart-trinkle:joints=position", 1},
    {"generalized-alpha:rho_inf=0", 2}, {"generalized-alpha:rho_inf=0.5", 2}, {"generalized-alpha:rho_inf=1", 2},
};

/// Time average of |x(t) − exact|: a single moment would see an impact's time, not the motion.
template <class Exact, class Coordinate>
double mean_error(Scene scene, double duration, std::string_view spec, double h, Exact&& exact, Coordinate&& x) {
  scene.duration = h * std::round(duration / h);  // no shorter step at the end
  double sum = 0;
  const Run r = run(scene, spec, h, [&](const RunSample& m) { sum += std::abs(x(m.state) - exact(m.state.t)); });
  INFO(r.why);
  REQUIRE(r.status == Status::solved);
  return sum / static_cast<double>(r.steps + 1);
}

template <class Error>
void expect_order(std::string_view spec, double order, const Ladder& ladder, Error&& error, double within = 0.15) {
  const Fit fit = fit_order(ladder, [&](double h) { return error(h); });
  CAPTURE(spec);
  MESSAGE(spec << ": order " << fit.order << ", scatter " << fit.scatter << ", error " << fit.worst.back().error
               << " at h = " << fit.worst.back().h);
  CHECK(std::abs(fit.order - order) < within);
  CHECK(fit.scatter < 0.3);
}

}  // namespace

TEST_CASE("pendulum: each scheme has its order on smooth motion, whatever its options") {
  const Pendulum p{.angle = 1.5};
  const auto check = [&](const Scheme& scheme) {
    const Ladder ladder{.coarsest = 8e-3, .octaves = 4, .steps_per_octave = 3, .duration = 1.5};
    expect_order(scheme.spec, scheme.smooth, ladder, [&](double h) {
      return mean_error(
          pendulum(p), 1.5, scheme.spec, h, [&](double t) { return std::sin(p.at(t).x); },
          [](const State& x) { return x.q[0]; });
    });
  };
  for (const Scheme& scheme : kSchemes) check(scheme);
  for (const Scheme& scheme : kVariants) check(scheme);
}

TEST_CASE("ideal slider-crank: order 2") {
  const Scene scene = slider_crank_ideal();
  for (const Scheme& scheme : kSchemes)
    if (scheme.smooth == 2)
      expect_order(scheme.spec, 2, {.coarsest = 6.4e-5, .octaves = 3, .steps_per_octave = 2, .duration = 0.2},
                   [&](double h) {
                     return std::abs(run(scene, scheme.spec, h).final.q[kTheta1] - IdealSliderCrankExact{}.theta1);
                   });
}

TEST_CASE("bouncing ball: order 1 past the accumulation of impacts" * doctest::test_suite("slow")) {
  const BouncingBall ball;
  for (const Scheme& scheme : kSchemes)
    expect_order(scheme.spec, 1, {.coarsest = 1e-2, .octaves = 5, .steps_per_octave = 12}, [&](double h) {
      return mean_error(
          bouncing_ball(ball), 1.5, scheme.spec, h, [&](double t) { return ball.at(t).x; },
          [](const State& x) { return x.q[1]; });
    });
}

// With the speed of impact taken at the surface, the part of the error that falls with h is three times smaller.
TEST_CASE("impact oscillator: order 1" * doctest::test_suite("slow")) {
  const ImpactOscillator p;
  for (const Scheme& scheme : kSchemes) {
    const std::string_view spec = scheme.spec;
    const bool at_surface = spec == "generalized-alpha" || spec == "rattle";
    expect_order(
        spec, at_surface ? 1.25 : 1, {.coarsest = 2e-2, .octaves = 4, .steps_per_octave = 8},
        [&](double h) {
          return mean_error(
              impact_oscillator(p), 3 * p.period(), spec, h, [&](double t) { return p.at(t).x; },
              [](const State& x) { return x.q[0]; });
        },
        at_surface ? 0.25 : 0.15);
  }
}

TEST_CASE("stick-slip: order 1") {
  const StickSlip p;
  for (const Scheme& scheme : kSchemes)
    expect_order(scheme.spec, 1, {.coarsest = 1e-2, .octaves = 4, .steps_per_octave = 8}, [&](double h) {
      return mean_error(
          stick_slip(p), 2 * p.period(), scheme.spec, h, [&](double t) { return p.at(t).x; },
          [](const State& x) { return x.q[0]; });
    });
}

// RATTLE's position stage gives an inelastic impact the very impulse that its place within the step asks for: order 2.
TEST_CASE("slider-crank with clearance, e = 0: order 1, RATTLE 2" * doctest::test_suite("slow")) {
  for (const Scheme& scheme : kSchemes)
    for (const SliderCrankExact& exact : slider_crank_exact()) {
      if (exact.e > 0) continue;
      CAPTURE(exact.mu);
      const Ladder ladder{.coarsest = 3.2e-5, .octaves = 4, .steps_per_octave = 4, .duration = 0.2};
      expect_order(
          scheme.spec, scheme.spec == "rattle" ? 2 : 1, ladder,
          [&](double h) { return theta1_error(exact, scheme.spec, h); }, 0.3);
    }
}
