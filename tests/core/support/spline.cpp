// The clamped cubic spline: through its points, smooth, and exact where the function is such a spline.
#include <doctest/doctest.h>
#include <orthant/core/support/spline.h>

#include <limits>
#include <stdexcept>

namespace orthant {

TEST_CASE("a spline goes through its points with slope 0 at both ends, and is constant outside") {
  const Spline s({0, 1, 1.5, 4}, {2, 3, -1, 5});
  const double times[] = {0, 1, 1.5, 4}, values[] = {2, 3, -1, 5};
  for (int i = 0; i < 4; ++i) CHECK(s.value(times[i]) == doctest::Approx(values[i]).epsilon(1e-14));
  CHECK(s.rate(0) == 0);
  CHECK(s.rate(4 - 1e-12) == doctest::Approx(0).epsilon(1e-9));
  CHECK(s.value(-1) == 2);
  CHECK(s.value(9) == 5);
  CHECK(s.rate(9) == 0);
  CHECK(Spline().value(1) == 0);
  CHECK(Spline({1}, {7}).value(3) == 7);
}

TEST_CASE("value, rate and acceleration of a spline are continuous, and each the derivative of the one before") {
  const Spline s({0, 1, 1.5, 4}, {2, 3, -1, 5});
  for (const double knot : {1.0, 1.5}) {
    CHECK(s.rate(knot - 1e-9) == doctest::Approx(s.rate(knot)).epsilon(1e-6));
    CHECK(s.acceleration(knot - 1e-9) == doctest::Approx(s.acceleration(knot)).epsilon(1e-6));
  }
  for (const double t : {0.3, 1.2, 2.7, 3.9}) {
    constexpr double h = 1e-5;
    CHECK((s.value(t + h) - s.value(t - h)) / (2 * h) == doctest::Approx(s.rate(t)).epsilon(1e-8));
    CHECK((s.rate(t + h) - s.rate(t - h)) / (2 * h) == doctest::Approx(s.acceleration(t)).epsilon(1e-8));
  }
}

TEST_CASE("a cubic with slope 0 at both ends is its own spline") {
  const auto f = [](double t) { return t * t * (3 - 2 * t); };
  const Spline s({0, 0.3, 0.45, 1}, {f(0), f(0.3), f(0.45), f(1)});
  for (double t = 0; t <= 1; t += 0.05) CHECK(s.value(t) == doctest::Approx(f(t)).epsilon(1e-13));
}

TEST_CASE("a spline's points are refused in words") {
  CHECK_THROWS_WITH_AS(Spline({}, {}), "times = []: must be at least one time", std::invalid_argument);
  CHECK_THROWS_WITH_AS(Spline({0, 1}, {1}), "times: must be as many as values", std::invalid_argument);
  CHECK_THROWS_WITH_AS(Spline({0, 0}, {1, 2}), "times: must be ascending", std::invalid_argument);
  CHECK_THROWS_WITH_AS(Spline({0, 1}, {1, std::numeric_limits<double>::quiet_NaN()}), "values: must be finite",
                       std::invalid_argument);
  CHECK_THROWS_WITH_AS(Spline({-1e308, 1e308}, {0, 1}), "times: must span a finite time", std::invalid_argument);
  for (const double apart : {1e-300, 1e-160})
    CHECK_THROWS_WITH_AS(Spline({0, apart, 1}, {0, 1, 2}),
                         "times: must be so far apart that the values' slopes and curvatures are finite",
                         std::invalid_argument);
  CHECK_NOTHROW(Spline({0, 1e-100, 1}, {0, 1, 2}));
}

}  // namespace orthant
