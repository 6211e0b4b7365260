#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/island_solve.h>
#include <orthant/integrators/step/rate_targets.h>

#include <algorithm>

namespace orthant {
namespace {

constexpr Index kShared = 100;  // rows beyond the largest island's, from which on threads gain
constexpr Index kWhole = 3000;  // rows of an island from which on its copy costs memory that counts

/// Rows of closed contacts, lent as long as this lives: also where a solver throws.
template <class StepProblem> class Loan {
 public:
  using ClosedContacts = typename StepProblem::ClosedContacts;
  Loan(StepProblem& problem, ClosedContacts* closed)
      : problem_(problem), closed_(closed != nullptr && problem.lend(*closed) ? closed : nullptr) {}
  ~Loan() {
    if (closed_ != nullptr) problem_.take_back(*closed_);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;

 private:
  StepProblem& problem_;
  ClosedContacts* closed_;
};

/// A coarse answer is no motion, unless its error is as slow as a contact at rest.
void leave_coarse(Solution& s, double unit) {
  if (s.status == Status::rounded && s.coarse && s.miss.by > kRestSpeed * unit) s.status = Status::stalled;
}

}  // namespace

template <class Space> IslandSolveOf<Space>::IslandSolveOf(const SystemOf<Space>& system, const StepProblem& problem)
    : islands_(system), unit_(system.length_unit()) {
  const Index most = problem.most_rows();
  add_bench(problem);
  if (most > kKeptRows) return;
  outcomes_.reserve(static_cast<std::size_t>(most));
  for (Vector* each : {&found_.z, &found_.w}) each->resize(most);
}

template <class Space> bool IslandSolveOf<Space>::solve(StepProblem& problem, Solver& solver, StepReport& report,
                                                        SolverPool* pool, Solution& s, ClosedContacts* closed) {
  const int count = islands_.count();
  if (count == 1 || one_holds_most(problem)) {
    const Lcp& whole = problem.whole();
    {
      const Loan<StepProblem> loan(problem, closed);
      solver.solve(whole, s, Start::warm);
    }
    if (refines_) benches_[0].refinement.improve(whole, s);
    leave_coarse(s, unit_);
    return report.note(whole, s);
  }
  const Index n = problem.size();
  if (s.z.size() != n) s.z.resize(n), s.z.setZero();
  s.w.resize(n), found_.z.resize(n), found_.w.resize(n);
  s.status = Status::not_run, s.residual = 0;
  if (outcomes_.size() < static_cast<std::size_t>(count)) outcomes_.resize(static_cast<std::size_t>(count));
  const bool together = worth_sharing(problem, pool);
  if (together) {
    while (benches_.size() < static_cast<std::size_t>(pool->size())) add_bench(problem);
    pool->run(count, solver, [&](int island, Solver& by, int worker) {
      solve_island(problem, island, by, s.z, benches_[static_cast<std::size_t>(worker)]);
    });
  }
  for (int island = 0; island < count; ++island) {  // as if one after the other
    if (!together) solve_island(problem, island, solver, s.z, benches_[0]);
    if (!take(island, report, s)) return false;
  }
  return true;
}

/// One more island into s. Its status is the judge's: rounded where that of an island is.
template <class Space> bool IslandSolveOf<Space>::take(int island, StepReport& report, Solution& s) {
  const auto rows = islands_.rows(island);
  const Outcome& outcome = outcomes_[static_cast<std::size_t>(island)];
  if (!report.note(static_cast<int>(rows.size()), outcome.status, outcome.residual, outcome.iterations, outcome.miss)) {
    s.status = outcome.status, s.residual = outcome.residual, s.miss = outcome.miss;
    if (s.miss.row >= 0) s.miss.row = rows[static_cast<std::size_t>(s.miss.row)];
    const auto spread = [&](const Vector& part, Vector& whole) {
      whole.resize(part.size() > 0 ? s.z.size() : 0);
      whole.setZero();
      for (Index i = 0; i < part.size(); ++i) whole[rows[static_cast<std::size_t>(i)]] = part[i];
    };
    spread(outcome.certificate, s.certificate), spread(outcome.ray, s.ray);
    return false;
  }
  if (s.status != Status::rounded) s.status = outcome.status;
  s.residual = std::max(s.residual, outcome.residual);
  for (const int row : rows) s.z[row] = found_.z[row], s.w[row] = found_.w[row];
  return true;
}

/// In space a pile with some loose bodies is solved as a whole: a copy of it would take as much memory as the problem.
template <class Space> bool IslandSolveOf<Space>::one_holds_most(const StepProblem& problem) const {
  if (kPlanar<Space> || problem.dense() || problem.size() < kWhole) return false;
  return 2 * largest() >= problem.size();
}

template <class Space> Index IslandSolveOf<Space>::largest() const {
  Index most = 0;
  for (int island = 0; island < islands_.count(); ++island) most = std::max(most, std::ssize(islands_.rows(island)));
  return most;
}

template <class Space>
bool IslandSolveOf<Space>::worth_sharing(const StepProblem& problem, const SolverPool* pool) const {
  if (pool == nullptr || pool->size() == 1) return false;
  return problem.size() - largest() >= kShared;
}

/// Writes only what belongs to this island.
template <class Space> void IslandSolveOf<Space>::solve_island(const StepProblem& problem, int island, Solver& solver,
                                                               const Vector& guess, Bench& bench) {
  const auto rows = islands_.rows(island);
  const Lcp& block = problem.cut(rows, bench.block);
  bench.part.z.resize(block.size());
  for (Index i = 0; i < block.size(); ++i) bench.part.z[i] = guess[rows[static_cast<std::size_t>(i)]];
  const Solution& part = solver.solve(block, bench.part, Start::warm);
  if (refines_) bench.refinement.improve(block, bench.part);
  leave_coarse(bench.part, unit_);
  Outcome& outcome = outcomes_[static_cast<std::size_t>(island)];
  outcome.status = part.status, outcome.residual = part.residual, outcome.iterations = part.iterations;
  outcome.miss = part.miss;
  outcome.certificate.resize(part.certificate.size());
  outcome.certificate = part.certificate;
  outcome.ray.resize(part.ray.size());
  outcome.ray = part.ray;
  for (Index i = 0; i < block.size(); ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    found_.z[row] = part.z[i], found_.w[row] = part.w[i];
  }
}

template class IslandSolveOf<Planar>;
template class IslandSolveOf<Spatial>;

}  // namespace orthant
