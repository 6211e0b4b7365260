// experiments/studies/exact_cases/reference_motion.h — reference motions by a second method: extrapolation in long
// double of equations in minimal coordinates, without multipliers; and quadratures.
//
//   Gragg's modified midpoint rule in 2, 4, … 16 parts of each step, extrapolated in h² (Aitken–Neville): order 16.
//   Gauss–Legendre, 20 points a panel.
//   Source: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.9; Abramowitz & Stegun
//   (1964), 25.4.
#pragma once

#include <Eigen/Dense>

#include <functional>

namespace orthant {

using Real = long double;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Real3 = Eigen::Matrix<Real, 3, 1>;

/// y(duration) of y' = f(y), in so many equal steps.
RealVector extrapolate(const std::function<RealVector(const RealVector&)>& f, RealVector y, Real duration, int steps);

/// ∫ f from a to b, in so many panels.
Real integrate(const std::function<Real(Real)>& f, Real a, Real b, int panels);

/// The angle at time t of a motion that starts at `from` with the rate rate(θ) > 0: ∫ dθ / rate(θ) = t, by Newton's
/// method.
Real angle_after(const std::function<Real(Real)>& rate, Real from, Real t);

}  // namespace orthant
