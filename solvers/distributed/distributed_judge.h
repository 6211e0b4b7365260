// solvers/distributed/distributed_judge.h — the judge over distributed rows: the rule of core/lcp/judge/certify.h.
//
//   solved    v_i ≤ tol min(s_i, β_i) in every row of every rank.      rounded    each row so, or v_i ≤ 20 ε s_i.
//   v, s, β are those of certify.h, sums in the order of the whole problem's columns, rationals where rounding leaves a
//   row open: for z and A the verdict is that of the judge of one process, for any number of ranks. It proves no
//   infeasibility, and does not tell coarse answers.
//   β is the least x with x_i ≥ the data of row i and x_i ≥ min(|A_ij z_j|, x_j): the widest paths first within a rank,
//   then the halo's x is fetched, until no rank changes. Each round only raises x, so that a row which passes with the
//   present x passes: the rounds end once all rows do. At most one round for each time that a widest path
//   goes from one rank to another.
//   Cost: one product and two reductions for most z; each round one exchange and one reduction.
#pragma once

#include <orthant/core/lcp/judge/row_rule.h>
#include <orthant/solvers/distributed/distributed_lcp.h>

#include <utility>
#include <vector>

namespace orthant::distributed {

struct Verdict {
  Status status = Status::not_run;  // solved, rounded, stalled; numerical_error where z or A z is not finite
  double residual = kInf;           // max_i v_i over all ranks  [units of w]
  Miss miss;                        // the row, of the whole problem, that is furthest from its limit
  int rounds = 0;                   // of exchanges of β
};

class DistributedJudge {
 public:
  /// The problem must outlive the judge. Collective.
  explicit DistributedJudge(const DistributedLcp& problem);

  /// Collective. z of m + h entries, own ones filled; the halo is fetched. `tolerance` as in certify().
  Verdict judge(Vector& z, double tolerance);
  /// w = A z + b of the last z, m entries.
  const Vector& w() const { return w_; }

 private:
  struct Row {
    long double wrong, off;  // v_i, and how far the sum may be off
    double size;             // s_i
  };
  bool within(Index i, double limit, const Vector& z);
  bool surely_solved(const Vector& z, double tolerance, double& residual);
  void weigh(const Vector& z);
  double find_data(const Vector& z);
  bool surely_missed(double tolerance, double data) const;
  bool all_pass(const Vector& z, double tolerance);
  bool spreads_to_solved(const Vector& z, double tolerance, int& rounds);
  void couple(const Vector& z);
  void spread_within_rank();
  void finish(const Vector& z, double tolerance, bool solved, double data, Verdict& verdict);
  double limit_of_underflow(Index i) const;

  const DistributedLcp& problem_;
  double least_b_ = kInf;   // |b_i| > 0 of all ranks
  double terms_ = 0;        // entries of the longest row of all ranks
  std::vector<int> start_;  // m + h + 1: where the entries of a column begin in couplings_
  std::vector<std::pair<double, int>> couplings_, heap_;  // |A_ij z_j| and row i; β and its row
  std::vector<Row> rows_;                                 // m
  Vector w_, beta_, bounds_;                              // m; m + h: β, the largest known so far; β'
};

}  // namespace orthant::distributed
