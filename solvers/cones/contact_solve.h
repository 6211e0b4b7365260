// solvers/cones/contact_solve.h — exact local solve of one contact with a disc: solution of the law for a block of
// rows.
//
//   Given w = A z + q of one block (its rows alone), find z with −û(w) in the normal cone of K at z (cones/contact.h).
//   1. A normal row with one disc: open or stick in closed form, else Newton on (1) for the angle θ alone, from the
//      direction of the z given, then from others; a tenth of the time of what follows.
//   2. From the z given: Newton on the Alart-Curnier equations, a few steps; accepted where the residual is at
//      rounding.
//   3. A normal row with one disc: the cases one by one.
//        open   z = 0                       where q_n ≥ 0
//        stick  z = −A⁻¹q                   where that lies in K
//        slide  z_T = μ z_n d(θ), w_n = 0, w_T = −κ d, κ ≥ 0:   z_n = −q_n / (A_nn + μ A_nT d), and with e = d⊥
//               e · [q_T (A_nn + μ A_nT d) − q_n (A_Tn + μ A_TT d)] = 0,
//               P cos θ + Q sin θ + U cos²θ + V sin²θ + X sin θ cos θ = 0,  a quartic in tan(θ/2).            (1)
//   4. Else: projected fixed-point steps z ← P_K(z − ρ û), damped until the residual falls.
//   Of 2 to 4 the best z is kept, so the result is never worse than the given z.
//   Source: Bonnefon & Daviet, Quartic formulation of Coulomb 3D frictional contact, INRIA RT-0400 (2011); Alart &
//   Curnier, Comput. Methods Appl. Mech. Engrg. 92 (1991).
#pragma once

#include <orthant/core/lcp/cones/contact.h>

namespace orthant {

/// Case 1, for many q with the same A: a normal row [0, ∞) with one disc.
class DiscContact {
 public:
  /// A: 3 × 3 by columns, it must outlive the solves.
  void prepare(const cones::Blocks& blocks, const cones::Block& block, const double* A);
  /// The same of one q, nothing kept: what only a contact that is not open needs is computed then.
  static bool solve_once(const cones::Blocks& blocks, const cones::Block& block, const double* A, const double* q,
                         double* z);
  /// False where the block is another one, or Newton from nine directions ends nowhere: z is as it was.
  bool solve(const double* q, double* z) const {
    if (!disc_) return false;
    if (q[0] < 0) return load(q, z);
    z[0] = z[1] = z[2] = 0;
    return true;
  }

 private:
  bool load(const double* q, double* z) const;
  bool slide(const double* q, double c, double s, double* z) const;
  const double* A_ = nullptr;
  double mu_ = 0;
  bool disc_ = false, regular_ = false;
  std::array<double, 9> inverse_{};  // by rows
};

/// A: m × m by columns, m = block.rows ≤ cones::kMostRows; q, z: m numbers. Returns ‖z − P_K(z − û)‖.
double solve_contact(const cones::Blocks& blocks, const cones::Block& block, const double* A, const double* q,
                     double* z);

}  // namespace orthant
