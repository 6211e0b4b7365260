// solvers/cones/cone_system.h — the linear system of one Newton step over contacts.
//
//   Each block gives equations with dF = E dz + H dw, and dw = (A + α I) dz; the step solves
//     (E + H (A + α I)) dz = −F.                                                                                 (1)
//   Blocks that are `open` have dF = dz: dz = −F at once, and only the others are factorized, as a dense matrix where
//   they are few or nearly all coupled, else by KLU, or from 2e7 operations on by UMFPACK. The analysis and KLU's
//   pivots are kept while the pattern stays; where x then misses by more than 1e-6, pivots are chosen again.
//   Source: Davis & Palamadai Natarajan, ACM Trans. Math. Softw. 37 (2010), Algorithm 907: KLU.
#pragma once

#include <orthant/solvers/budget.h>
#include <orthant/solvers/cones/cone_form.h>

#include <memory>

namespace orthant {

class ConeSystem {
 public:
  ConeSystem();
  ~ConeSystem();
  ConeSystem(const ConeSystem&) = delete;
  ConeSystem& operator=(const ConeSystem&) = delete;

  /// Sizes what follows; the form and the budget (null: none) must outlive the solves.
  void load(const ConeForm& form, const Budget* budget);

  /// rows × rows of a block, by columns.
  double* E_of(int block) { return E_.data() + place_[at(block)]; }
  double* H_of(int block) { return H_.data() + place_[at(block)]; }

  /// Fills dz; false when (1) is singular, or the budget cannot afford its factorization.
  bool solve(double alpha);
  /// True: the next solves have the matrix of the last, only F is another; no block is open.
  void keep_factors(bool on) { keep_ = on; }

  Vector F, dz;            // per row of the form
  std::vector<char> open;  // per block

 private:
  const ConeForm* form_ = nullptr;
  bool keep_ = false;
  std::vector<double> E_, H_;
  std::vector<std::size_t> place_;
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace orthant
