// core/scenes/table.h — table with more legs in a row than equilibrium determines: its forces are not unique.
//
//   Legs at x_i, equally spaced over [−1, 1], the centre of mass at x = d. At rest on the floor any λ ≥ 0 with
//     Σ λ_i = m g,  Σ λ_i x_i = m g d
//   is a solution; the acceleration is 0 in all of them. The λ of least norm, a + b x_i, is none of them when d is
//   large (four legs: d > 5/9): it pulls at a leg although the table does not tip.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

#include <span>

namespace orthant {

struct Table {
  int legs = 4;
  double offset = 0.6;  // [m] d in [−1, 1]
  double g = kGravity;  // [m/s²]

  template <class V> void visit(V&& v) { v("legs", legs, 2, 1000), v("offset", offset, -1.0, 1.0); }

  double leg(int i) const { return -1 + 2.0 * i / (legs - 1); }  // [m] x_i, i = 0 … legs − 1
  double weight() const { return g; }                            // [N] of 1 kg
  /// How far forces [N], one a leg, are from an answer: the largest of the two equations' errors and of −λ_i. [N, N m]
  double misfit(std::span<const double> forces) const;
};

Scene table(const Table& p = {});

}  // namespace orthant
