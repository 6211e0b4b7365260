#include <orthant/solvers/cones/facets.h>
#include <orthant/solvers/effort.h>
#include <orthant/solvers/solver.h>

#include <algorithm>
#include <utility>

namespace orthant {

void Solver::seek_proof(const Lcp& problem, Solution& s) {
  // Cheap: then worth it after a run that was only too short, and where only rounding excuses what a z misses.
  const bool cheap = problem.size() <= Farkas::kTableau;
  const bool contested = s.status == Status::solved && judge_.doubtful(s);
  if (s.status != Status::ray && s.status != Status::stalled && s.status != Status::numerical_error &&
      !(cheap && (s.status == Status::iteration_limit || contested)))
    return;
  if (!proof_search_ || !(seeks_proof() || contested) || budget_.exhausted()) return;
  Budget share;  // a quarter of what is left
  share.start(budget_.remaining() / 4, budget_.cancel());
  if (problem.discs()) {
    FacetForm form;
    if (!farkas_.propose(form.linear(problem, 32, {}, true), scratch_, share)) return;
    form.restore_certificate(problem, scratch_, proof_);
  } else if (!farkas_.propose(problem, proof_, share)) {
    return;
  }
  if (!judge_.proves_infeasible(problem, proof_) &&
      !(in_whole_numbers(proof_) && judge_.proves_infeasible(problem, proof_)))
    return;  // a ray's direction stays what it was
  s.certificate = proof_;
  judge_.certify(problem, tolerance(), Status::ray, s);
}

bool Solver::passes(const Lcp& problem, Solution& s) {
  judge_.certify(problem, std::min(goal(), tolerance()), Status::not_run, s);
  return s.status == Status::solved;
}

Solver& Solver::with_discs() {
  constexpr int kTurns = 20;
  if (!discs_) discs_ = for_discs();
  if (!discs_) discs_ = std::make_unique<Facets>(*this, facets_, kTurns);
  return *discs_;
}

std::string Solver::refusal(const Lcp& problem) {
  return problem.discs() && !takes_discs() ? with_discs().why_not(problem) : why_not(problem);
}

const Solution& Solver::solve_discs(const Lcp& problem, Solution& s, Start start) {
  with_discs();
  discs_->set_time_limit(time_limit_), discs_->set_cancel(cancel_), discs_->set_log(log_);
  discs_->set_proof_search(proof_search_);
  const double limit = time_limit_;
  IterationLog* const log = std::exchange(log_, nullptr);  // a pyramid's own iterations are another matter
  discs_->solve(problem, s, start);
  time_limit_ = limit, log_ = log;
  return s;
}

const Solution& Solver::solve(const Lcp& problem, Solution& s, Start start) {
  check(problem);
  if (problem.discs() && !takes_discs()) return solve_discs(problem, s, start);
  const Index n = problem.size();
  s.status = Status::not_run;
  s.residual = kInf;
  s.rounding = 0;
  s.iterations = 0;
  s.factorizations = 0;
  s.factorized_rows = 0;
  s.certificate.resize(0);
  if (start == Start::cold || s.z.size() != n || !s.z.allFinite()) {
    start = Start::cold;
    s.z.resize(n);
    s.z.setZero();
  }
  s.w.resize(n);
  if (!finite(problem)) {
    s.w.setConstant(std::numeric_limits<double>::quiet_NaN());
    s.status = Status::numerical_error;
    return s;
  }
  if (!why_not(problem).empty()) {
    multiply(problem.A, s.z, s.w, scratch_);
    s.w += problem.b;
    s.status = Status::unsupported;
    return s;
  }
  begin();
  const Effort before = effort();
  Status claim = run(problem, s, start);
  const double goal_residual = std::min(goal(), tolerance());
  judge_.certify(problem, goal_residual, claim, s);
  const auto open = [&s] { return s.status != Status::solved && s.status != Status::infeasible; };
  if (open()) seek_proof(problem, s);
  best_.residual = kInf;
  for (int attempt = 1; open() && !budget_.exhausted(); ++attempt) {
    if (!(s.residual >= best_.residual)) best_ = s;
    if (!run_again(problem, s, attempt, claim)) break;
    judge_.certify(problem, goal_residual, claim, s);
  }
  if (open() && best_.residual < s.residual) {  // a harder attempt may do worse: the best z is what is reported
    best_.iterations = s.iterations;
    s = best_;
  }
  if (open() && goal_residual < tolerance()) judge_.certify(problem, tolerance(), s.status, s);
  if (s.status == Status::solved) seek_proof(problem, s);
  if (s.status == Status::solved) s.certificate.resize(0);
  if (open() && budget_.exhausted()) s.status = budget_.cancelled() ? Status::cancelled : Status::time_limit;
  s.factorizations = effort().factorizations - before.factorizations;
  s.factorized_rows = effort().rows - before.rows;
  return s;
}

}  // namespace orthant
