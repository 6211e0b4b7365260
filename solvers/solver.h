// solvers/solver.h — solver interface: solve() of a problem, checked by the judge.
#pragma once

#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/solvers/at_bounds.h>
#include <orthant/solvers/budget.h>
#include <orthant/solvers/fine_rows.h>
#include <orthant/solvers/iteration_log.h>
#include <orthant/solvers/proof/cone_proof.h>
#include <orthant/solvers/proof/farkas.h>

#include <algorithm>
#include <memory>
#include <string>

namespace orthant {

enum class Start { cold, warm };  // warm: solution.z on entry is a guess, where it has the right size

class Solver {
 public:
  Solver();
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver();

  /// Runs the method, then lets the judge decide: `solved`, `rounded` and `infeasible` come from certify() alone.
  /// Data that are not finite give numerical_error; a malformed problem throws std::invalid_argument.
  const Solution& solve(const Lcp& problem, Solution& solution, Start start = Start::cold);

  /// Empty when the method can take the problem; else the reason in words (solve() then answers unsupported).
  virtual std::string why_not(const Lcp&) const { return {}; }
  /// The same of what really answers: with friction discs for_discs() or a pyramid.
  std::string refusal(const Lcp& problem);

  /// On problems with friction discs (Friction::rows > 1) for_discs() answers, or the method itself with the discs as
  /// pyramids (cones/facets.h): where it has neither, this is of how many sides.
  void set_facets(int sides) { facets_ = sides, discs_.reset(); }

  /// From now on each friction disc is a pyramid of so many sides that stands still (cones/facets.h): another law, and
  /// its answers are judged by it. 0: discs, as at first. Throws std::invalid_argument for less than 3 sides.
  void set_pyramids(int sides);
  int pyramid_sides() const { return pyramid_sides_; }

  /// Wall time of one solve [s]; past it the run ends with time_limit, the last z kept.
  void set_time_limit(double seconds) { time_limit_ = seconds; }
  double time_limit() const { return time_limit_; }
  /// The time of something that takes several solves: each of them ends when this one is over. Null: none. It must
  /// outlive solves.
  void set_outer_budget(const Budget* outer) { outer_ = outer; }
  const Budget* outer_budget() const { return outer_; }
  /// A flag another thread may raise at any time: the run then ends with `cancelled`. Null: none. It must outlive
  /// solves.
  void set_cancel(const std::atomic<bool>* cancel) { cancel_ = cancel; }
  const std::atomic<bool>* cancel() const { return cancel_; }
  /// Whether a run that ends on a ray, stalled or lost to rounding (small problems: or at its limit) is followed by one
  /// search for a proof that there is no solution (farkas.h: a linear program, which may cost more than the run did).
  /// On at first. Off, the miss is not explained either: for the caller who judges again.
  void set_proof_search(bool on) { proof_search_ = on; }
  /// Where each solve writes its iterations (cleared first); null: nowhere, at no cost.
  void set_log(IterationLog* log) { log_ = log; }

 protected:
  /// The method takes friction discs as they are.
  virtual bool takes_discs() const { return false; }
  /// The method's own form for friction discs; null: there is none.
  virtual std::unique_ptr<Solver> for_discs() const { return nullptr; }
  virtual double tolerance() const = 0;  // accepted residual, relative to ‖b‖∞ (certify.h: β)
  /// The clock starts and the log is emptied. solve() has done so before run().
  void begin() {
    budget_.start(outer_ != nullptr ? std::min(time_limit_, outer_->remaining()) : time_limit_, cancel_);
    if (log_ != nullptr) log_->clear();
  }
  const Budget& budget() const { return budget_; }  // run() asks it once an iteration
  bool logging() const { return log_ != nullptr; }
  /// The judge, before the end: true when s.z would be accepted (solved or rounded), if need be put at the bounds that
  /// it is near to. One product with A, or two; fills w, residual and rounding of s. accepted(): the residual up to
  /// which it would have been.
  bool passes(const Lcp& problem, Solution& s);
  double accepted() const { return accepted_; }
  /// One search a solve for a proof that there is no solution, where the caller wants one: true when the judge takes
  /// it; it is in s.certificate or s.cells. solve() makes it after a run that did not.
  bool proves_infeasible(const Lcp& problem, Solution& s);
  /// run() ends with the s that passes() has just accepted: the judge sees it again only where it was changed.
  void keep_passed() { kept_ = true; }
  /// The judge takes the proof that `inner` has just given for the same problem without a second check: an equal judge
  /// has checked it.
  void trust(const Solver& inner) { judge_.trust(inner.judge_); }
  void log(int iteration, double merit, double step = 0, const char* event = "") {
    if (log_ != nullptr) log_->push_back({iteration, merit, step, event});
  }

 private:
  /// Leaves z (and a certificate) in the solution. On entry z has n finite entries: the guess, or zeros.
  virtual Claim run(const Lcp& problem, Solution& solution, Start start) = 0;
  /// Frees scratch, after a problem of many rows.
  virtual void release() {}
  /// After any other verdict than solved, rounded or infeasible (it stands in solution.status): false, or another
  /// attempt, made harder, whose claim is judged in turn. `attempt` counts 1, 2, …
  virtual bool run_again(const Lcp&, Solution&, int /*attempt*/, Claim& /*claim*/) { return false; }
  /// Not where a proof would answer another question than the caller's: the plain form of a method, say.
  virtual bool seeks_proof() const { return true; }
  /// No answer and no proof, or an answer that another attempt may better.
  static bool unsettled(const Solution& s);
  void judge(const Lcp& problem, double tolerance, Claim claim, Solution& s);
  void judge_at_bounds(const Lcp& problem, double tolerance, Claim claim, Solution& s);
  void judge_fine_rows(const Lcp& problem, double tolerance, Solution& s);
  void take_put(Solution& s);
  void seek_proof(const Lcp& problem, Solution& s);
  bool proves_over_cones(const Lcp& problem, const Budget& share, Solution& s);
  bool takes_proof(const Lcp& problem, const Vector& u, Solution& s);
  void take_ray_in_whole_numbers(const Lcp& problem, Solution& s);
  void put_proof_in_doubles(const Lcp& problem, Solution& s);
  bool finds_room(const Lcp& problem, const Vector& u, const Budget& budget);
  void search_cells(const Lcp& problem, Solution& s, const Budget& share);
  const Solution& solve_checked(const Lcp& problem, Solution& solution, Start start);
  const Solution& solve_discs(const Lcp& problem, Solution& solution, Start start);
  const Solution& solve_pyramids(const Lcp& problem, Solution& solution);
  Solver& with_discs();
  /// Residual below which no further attempt is made. A method that must reach more than is required says so here:
  /// an answer between the two is taken only when its further attempts do no better.
  virtual double goal() const { return tolerance(); }

  Judge judge_;
  Solution best_;  // over the attempts of one solve
  Solution put_;   // at its bounds
  AtBounds at_bounds_;
  FineRows fine_rows_;
  double accepted_ = 0;
  bool kept_ = false;
  Status passed_ = Status::not_run;  // that passes() accepted last, with before_
  Vector scratch_, proof_, before_;
  Farkas farkas_;
  std::unique_ptr<ConeProof> cone_proof_;  // made when first needed
  bool proof_search_ = true, proof_sought_ = false;
  Budget budget_;
  double time_limit_ = kInf;  // [s]
  const Budget* outer_ = nullptr;
  const std::atomic<bool>* cancel_ = nullptr;
  IterationLog* log_ = nullptr;
  std::unique_ptr<Solver> discs_;  // what answers for friction discs
  int facets_ = 16;
  struct FixedPyramids;
  std::unique_ptr<FixedPyramids> fixed_pyramids_;  // made when first needed
  int pyramid_sides_ = 0;                          // 0: discs
};

/// For solvers that hand a problem to another one: its result as a claim, and its proof or ray into s.
Claim handed_on(const Solution& inner, Solution& s);

}  // namespace orthant
