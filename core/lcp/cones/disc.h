// core/lcp/cones/disc.h — Coulomb's cone in space: projection, residual, support function of its disc.
//
//   K_μ = {(n, t): ‖t‖ ≤ μ n}, t in the tangent plane. At a given n ≥ 0 the friction t lies in the disc of radius μ n,
//   and opposes the slip u:
//     t = P(t − ρ u) for any ρ > 0,   P(x) = x min(1, μ n / ‖x‖).                                               (1)
//   Support function of the disc: sup gᵀt = μ n ‖g‖.                                                            (2)
//   Derivative of P outside the disc, with x̂ = x / ‖x‖:
//     dP = x̂ d(μ n) + (μ n / ‖x‖) (I − x̂ x̂ᵀ) dx.                                                              (3)
#pragma once

#include <Eigen/Core>

namespace orthant::disc {

/// (1): the point of the disc next to t.
inline Eigen::Vector2d project(double radius, const Eigen::Vector2d& t) {
  const double length = t.stableNorm();
  return length <= radius ? t : Eigen::Vector2d(t * (radius / length));
}

/// ‖t − P(t − u)‖: zero where t opposes the slip u within the disc.
inline double residual(double radius, const Eigen::Vector2d& t, const Eigen::Vector2d& u) {
  return (t - project(radius, t - u)).stableNorm();
}

/// (2): sup gᵀt over ‖t‖ ≤ radius.
inline double support(double radius, const Eigen::Vector2d& g) { return radius * g.stableNorm(); }

}  // namespace orthant::disc
