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

/// American put option on a basket of two assets, in x = ln S₁, y = ln S₂ (constant coefficients):
///   V ≥ ψ = max(K − a S₁ − (1 − a) S₂, 0),  L V ≥ 0,
///   L V = −V_t − ½ σ₁² V_xx − ½ σ₂² V_yy − ρ σ₁ σ₂ V_xy − (r − ½ σ₁²) V_x − (r − ½ σ₂²) V_y + r V.
/// Implicit steps on a square grid of nodes × nodes around the spot (K, K) of half-width `reach` standard deviations;
/// seven points: V_xy from the two neighbours on the diagonal that ρ's sign chooses, first derivatives central (upwind
/// where that would break the signs): an unsymmetric K-matrix for |ρ| ≤ min(σ₁/σ₂, σ₂/σ₁). V = ψ at the boundary.
/// Source: Villeneuve & Zanette, Math. Oper. Res. 27 (2002) 121-149.
struct AmericanBasket {
  double strike = 100, rate = 0.05, maturity = 1;                                  // K, r [1/a], T [a]
  double volatility_1 = 0.2, volatility_2 = 0.2, correlation = 0.3, weight = 0.5;  // σ₁, σ₂ [1/√a], ρ, a
  double reach = 4;                                                                // standard deviations at T
  Index nodes = 99;                                                                // of a side; odd: one at the spot

  double price(Index i) const;  // of either asset at node i of its side, −1 … nodes
  double payoff(Index i, Index j) const;
  Vector payoff() const;  // at the nodes, S₁ fastest
  double at_spot(const Vector& V) const;
};

/// The implicit step of h [a] before which the value was V: z = V − ψ after it.
Lcp american_basket_step(const AmericanBasket& basket, const Vector& V, double h);

}  // namespace orthant
