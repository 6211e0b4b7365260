// integrators/step/island_solve.h — island solver: a step's problem by islands, warm started, in parallel in a pool.
//
// Rows of different islands do not couple (islands.h). Each island's problem is cut out and solved by itself. The
// answer is that of the whole problem to rounding, and the same to the last bit for any number of threads.
#pragma once

#include <orthant/integrators/step/islands.h>
#include <orthant/integrators/step/step_problem.h>
#include <orthant/solvers/refinement.h>

namespace orthant {

template <class Space> class IslandSolveOf {
 public:
  using StepProblem = StepProblemOf<Space>;
  using ClosedContacts = typename StepProblem::ClosedContacts;

  IslandSolveOf(const SystemOf<Space>& system, const StepProblem& problem);

  /// From now on answers are brought to rounding (solvers/refinement.h).
  void refine() { refines_ = true; }

  /// From the rows of the problem, each time they change.
  void sort(const StepProblem& problem) { islands_.sort(problem.rows()); }

  /// Solves from s.z as the first guess. True: every island has an answer; s is rounded where one of them is. Else s
  /// has the status, miss, certificate and ray of the first island that has none, and z and w up to there.
  /// closed: the terms', whose rows a large problem may free meanwhile (lent_rows.h); null: they stay.
  bool solve(StepProblem& problem, Solver& solver, StepReport& report, SolverPool* pool, Solution& s,
             ClosedContacts* closed = nullptr);

 private:
  struct Bench {  // of one worker
    typename StepProblem::Block block;
    Refinement refinement;
    Solution part;
  };
  struct Outcome {  // of an island's solve; its z and w are in found_
    Status status = Status::not_run;
    double residual = 0;
    Miss miss;
    int iterations = 0;
    Vector certificate, ray;
  };
  bool one_holds_most(const StepProblem& problem) const;
  Index largest() const;  // rows of the largest island
  bool worth_sharing(const StepProblem& problem, const SolverPool* pool) const;
  void add_bench(const StepProblem& problem) { problem.prepare(benches_.emplace_back().block); }
  void solve_island(const StepProblem& problem, int island, Solver& solver, const Vector& guess, Bench& bench);
  bool take(int island, StepReport& report, Solution& s);

  bool refines_ = false;
  Islands islands_;
  double unit_;  // [m] length_unit()
  std::vector<Bench> benches_;
  std::vector<Outcome> outcomes_;
  Solution found_;  // z and w by islands, so far
};
extern template class IslandSolveOf<Planar>;
extern template class IslandSolveOf<Spatial>;
using IslandSolve = IslandSolveOf<Planar>;

}  // namespace orthant
