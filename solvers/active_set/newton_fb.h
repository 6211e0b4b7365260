// solvers/active_set/newton_fb.h — semismooth Newton method on the Fischer-Burmeister function, globalized.
//
//   φ(a, b) = √(a² + b²) − a − b vanishes exactly where a ≥ 0, b ≥ 0, ab = 0. With scaled rows a_i = d_i (z_i − lo_i):
//     one bound  Φ_i = φ(d_i (z_i − lo_i), w_i), mirrored for an upper one;   free row  Φ_i = −w_i;
//     box        Φ_i = φ(d_i (z_i − lo_i), φ(d_i (hi_i − z_i), −w_i))   (Billups).
//   Newton: V d = −Φ with V = D_a diag(d) + D_b A from the generalized Jacobian. ½‖Φ‖² is smooth, its gradient VᵀΦ: a
//   step that is no descent (or a singular V) is replaced by a Levenberg–Marquardt step; Armijo line search,
//   nonmonotone over `memory` iterations. Near the end the active rows are identified and solved exactly
//   (active_rows.h), which gives the last digits; the judge decides.
//   d_i is A's largest entry in the row. Where z is much larger than w/d (mass ratios of 1e10), w alone counts in Φ and
//   the iteration converges very slowly. A run that does so or fails is repeated with d 1e-3, 1e-6, 1e-9 times that, at
//   last with d and more iterations; without friction from 0 after a warm start, and with d itself first.
//   Friction rows through the pure form (pure_form.h), then as a fixed point of box problems (frozen_friction.h); rows
//   and columns scaled by powers of 2 where the entries span many
//   orders (scaling.h). The start value is used.  A stationary point of the merit that is
//   no solution → stalled (for P0-matrices there is none).
//   Source: Fischer, Optimization 24 (1992); De Luca, Facchinei & Kanzow, Math. Programming 75 (1996) 407-439;
//   Billups, PhD thesis, Univ. of Wisconsin (1995).
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/active_set/frozen_friction.h>
#include <orthant/solvers/active_set/polish.h>
#include <orthant/solvers/linear_algebra/dense_cholesky.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct NewtonFbOptions {
  double tolerance = 1e-10;  // accepted residual relative to the data, as certify() measures it; a tenth is aimed at
  int max_iterations = 500;
  int memory = 5;  // nonmonotone line search: 1 is monotone
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000), v("memory", memory, 1, 100);
  }
};

class NewtonFb final : public Solver {
 public:
  using Options = NewtonFbOptions;
  explicit NewtonFb(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 0.1 * options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  Claim attempt(const Lcp& problem, Solution& s);
  void light_rows(const Lcp& problem, Solution& s);
  void proximal(const Lcp& box, Solution& s, Vector& z);
  Claim in_good_units(const Lcp& problem, Solution& s);  // y_ is the start and the answer
  Claim iterate(const Lcp& problem, Solution& s, Vector& z);
  double merit(const Lcp& problem, const Vector& z);  // ½‖Φ‖²; fills w_, phi_
  void element(const Lcp& problem, const Vector& z);  // da_, db_ at z
  bool direction(const Lcp& problem, double weight);  // d with (VᵀV + weight I) d = −VᵀΦ, or Newton's at 0
  bool polish(const Lcp& problem, Vector& z);

  Options options_;
  Pyramid pyramid_;
  FrozenFriction frozen_;
  Polish polish_;
  Lcp proximal_;
  Vector shift_;
  bool near_ = false;  // the last merit was small
  int refinements_ = 0;
  detail::Scaling scaling_;
  Lcp scaled_;
  ActiveRows rows_;
  double weight_of_z_ = 1;  // relative to w in φ
  bool patient_ = false;    // also where the merit creeps
  Vector start_, y_, w_, phi_, da_, db_, trial_, scratch_, d_, gradient_, scale_;
  DenseMatrix dense_;
  std::vector<double> recent_;
  DenseLu<double> lu_;
  DenseCholesky normal_;
};

}  // namespace orthant
