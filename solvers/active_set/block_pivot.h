// solvers/active_set/block_pivot.h — block principal pivoting: all wrong rows change sides at once.
//
//   Find z in [lo, hi], w = A z + b, by a choice of side for each row (active_rows.h). Each iteration solves for the
//   present choice and moves every row with a wrong sign. That can cycle; so after `patience` iterations in which the
//   number of wrong rows did not fall below its least, only the last wrong row moves (Murty's rule), until it does.
//   Finite for P-matrices from any start: for them usually 3 to 10 factorizations.
//   Dense and sparse (principal_block.h): one factorization of a principal block an iteration.
//   Free rows are always inside. Friction rows make no P-matrix → unsupported.  A singular block → stalled.
//   The start value is used; cold, sparse Z-matrices (obstacle problems) start from coarse problems (coarse_start.h:
//   the string A18 of 4095 rows in 1 iteration and not 1490), else all rows inside. Coarse iterations are not counted.
//   Source: Kostreva (1978); Júdice & Pires, Computers & Operations Research 21 (1994) 587-596.
#pragma once

#include <orthant/solvers/active_set/active_rows.h>
#include <orthant/solvers/active_set/coarse_start.h>
#include <orthant/solvers/solver.h>

namespace orthant {

struct BlockPivotOptions {
  double tolerance = 1e-10;  // accepted residual relative to the data, as certify() measures it; a tenth is aimed at
  int max_iterations = 10000;
  int patience = 10;
  int coarse_start = 1;  // 0: cold, all rows start inside
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000000);
    v("patience", patience, 0, 1000), v("coarse_start", coarse_start, 0, 1);
  }
};

class BlockPivot final : public Solver {
 public:
  using Options = BlockPivotOptions;
  explicit BlockPivot(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override;
  double tolerance() const override { return options_.tolerance; }
  double goal() const override { return 0.1 * options_.tolerance; }
  Options options_;
  ActiveRows rows_;
  CoarseStart coarse_;
};

}  // namespace orthant
