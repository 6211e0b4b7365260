// solvers/active_set/newton_min.h — semismooth Newton method on the minimum map (primal-dual active set), globalized.
//
//   H_i(z) = z_i − clamp(z_i − w_i / d_i, lo_i, hi_i) = 0,  w = A z + b,  d_i = A_ii where positive, else 1.
//   An element of H's generalized Jacobian at z picks a side for each row; Newton's point is the one that this choice
//   defines (active_rows.h). The step towards it is shortened until ‖D H‖² falls below the largest of the last
//   `memory` ones (Grippo, Lampariello & Lucidi). No Newton point (singular block), or no step that helps: a
//   Levenberg–Marquardt step on the same element, its weight raised until it helps (dense and sparse).
//   Cycles of the pure method (circulant P-matrices) are so broken; a point where even that fails → stalled.
//   Friction rows through the pure form (pure_form.h), which is dense; where that fails, and at once in large problems
//   that are stored otherwise, as a fixed point of box problems (frozen_friction.h), on sparse factors. The start value
//   is used, and after failing from it 0; cold, without friction, it is that of coarse problems for sparse Z-matrices
//   (coarse_start.h), else the solution of A z = −b cut to the bounds.
//   Source: Pang, Math. of OR 15 (1990) 311-341; Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865-888;
//   Ben Gharbia & Gilbert, Math. Programming 134 (2012) on cycling.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/active_set/coarse_start.h>
#include <orthant/solvers/active_set/frozen_friction.h>
#include <orthant/solvers/active_set/polish.h>
#include <orthant/solvers/linear_algebra/dense_cholesky.h>
#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct NewtonMinOptions {
  double tolerance = 1e-10;  // accepted residual relative to the data, as certify() measures it; a tenth is aimed at
  int max_iterations = 500;
  int memory = 5;        // nonmonotone line search: 1 is monotone
  int coarse_start = 1;  // 0: cold, never from coarse problems
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000), v("memory", memory, 1, 100);
    v("coarse_start", coarse_start, 0, 1);
  }
};

class NewtonMin final : public Solver {
 public:
  using Options = NewtonMinOptions;
  explicit NewtonMin(const Options& options = {}) : options_(options) {}

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 0.1 * options_.tolerance; }
  std::unique_ptr<Solver> for_discs() const override;  // cones/disc_forms.cpp
  bool run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) override;
  const Lcp* by_rows(const Lcp& problem);
  Claim rounds(const Lcp& problem, const Lcp& given, Solution& s);
  Claim iterate(const Lcp& problem, Solution& s, Vector& z);
  double merit(const Lcp& problem, const Vector& z);  // ‖D H(z)‖², w_ and sides as a by-product
  bool marquardt(const Lcp& problem, Vector& z, double limit);

  Options options_;
  Pyramid pyramid_;
  FrozenFriction frozen_;
  ActiveRows rows_;
  CoarseStart coarse_;
  Polish polish_;
  bool warm_ = false;           // the last run's start
  const Lcp* large_ = nullptr;  // the last problem by rows, where that is how it is solved
  Lcp formed_;
  Vector start_, y_, w_, trial_, scratch_, H_, direction_, gradient_, from_;
  std::vector<double> recent_;
  DenseMatrix J_, normal_;
  DenseCholesky shifted_;
};

}  // namespace orthant
