// solvers/enumerate.h — the 2ⁿ oracle: every choice of basis, slow and obviously right; it judges the rest.
//
//   Pure form (pyramid.h): 0 ≤ y_i ⊥ w_i ≥ 0, free rows w_i = 0. For each subset α of the complementary rows, in binary
//   counting order (bit i = row i, ∅ first):  y outside α is 0, and M_ββ y_β = −q_β for β = α ∪ free, by elimination
//   with complete pivoting in long double, rows and columns scaled. A singular block that is consistent
//   counts too: the unknowns without a pivot are 0.
//   solve() returns the first y ≥ 0, w ≥ 0 that the judge accepts. None accepted → a proof of infeasibility is looked
//   for (farkas.h); without one the status is `ray`: no basis solves, which proves nothing about segments of solutions.
//   n ≤ 16 complementary rows in the pure form (why_not says so beyond).  Cost 2ⁿ n³.  A start value is not used.
#pragma once

#include <orthant/core/lcp/pyramid.h>
#include <orthant/solvers/farkas.h>
#include <orthant/solvers/solver.h>

#include <vector>

namespace orthant {

struct EnumerateOptions {
  double tolerance = 1e-12;  // accepted residual relative to the problem's scale, as certify() measures it
  template <class V> void visit(V&& v) { v("tolerance", tolerance, 0.0, 1.0); }
};

class Enumerate final : public Solver {
 public:
  using Options = EnumerateOptions;
  static constexpr int kMost = 16;
  explicit Enumerate(const Options& options = {}) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

  /// All different z that some regular basis gives and the judge accepts: every isolated solution with regular basis,
  /// and basic points of solution faces. None when why_not() has something to say.
  std::vector<Vector> all(const Lcp& problem);

 private:
  Status run(const Lcp& problem, Solution& s, Start start) override;
  bool run_again(const Lcp& problem, Solution& s, int attempt, Status& claim) override;
  double tolerance() const override { return options_.tolerance; }

  void form(const Lcp& problem);
  bool next_candidate(const Lcp& problem, Vector& z);  // false: no subset is left
  bool solve_basis(unsigned long subset);              // y_ for one subset; false: inconsistent or wrong signs

  Options options_;
  Pyramid pyramid_;
  Farkas farkas_;
  detail::Scaling scaling_;
  const Lcp* pure_ = nullptr;
  std::vector<Index> complementary_, free_, basis_, order_;
  std::vector<long double> block_;
  std::vector<char> inside_;
  Vector y_;
  unsigned long subset_ = 0;
  bool regular_ = false;  // the last basis was
};

}  // namespace orthant
