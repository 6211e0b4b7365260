// core/lcp/problems/american_put.h — American put option: one complementarity problem a time step.
//
//   V(S, t) ≥ ψ(S) = max(K − S, 0) and  L V ≥ 0,  L V = −V_t − ½ σ² S² V_SS − r S V_S + r V,  one of the two equal
//   (Black-Scholes). Backwards in time by θ-steps on nodes S_i = i S_max / (nodes + 1):
//     0 ≤ V − ψ ⊥ (I + θ h B) V − (I − (1 − θ) h B) V⁺ ≥ 0,   V = K at S = 0, V = 0 at S_max,
//   central differences, upwind where they would break the signs: I + θ h B is a nonsymmetric, strictly diagonally
//   dominant K-matrix.
//   Source: Wilmott, Dewynne & Howison, Option Pricing (1993), ch. 9, 22.
#pragma once

#include <orthant/core/lcp/problem.h>

namespace orthant {

struct AmericanPut {
  double strike = 100, rate = 0.05, volatility = 0.2, maturity = 1;  // K, r [1/a], σ [1/√a], T [a]
  double largest = 300;                                              // S_max
  Index nodes = 199;

  double price(Index i) const { return largest * static_cast<double>(i + 1) / static_cast<double>(nodes + 1); }
  Vector payoff() const;                          // ψ at the nodes
  double value(const Vector& V, double S) const;  // at a price S, between nodes by a cubic
};

/// The problem of a step of h [a] before which the value was V (nodes): z = V − ψ after it. θ = 1: implicit, ½: second
/// order, after four steps of h/4 with θ = 1 at the kink of ψ.
Lcp american_put_step(const AmericanPut& put, const Vector& V, double h, double theta);

}  // namespace orthant
