#include <orthant/solvers/solver.h>

namespace orthant {

const Solution& Solver::solve(const Lcp& problem, Solution& s, Start start) {
  check(problem);
  const Index n = problem.size();
  s.status = Status::not_run;
  s.residual = kInf;
  s.rounding = 0;
  s.iterations = 0;
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
    s.w.setZero();
    s.status = Status::unsupported;
    return s;
  }
  Status claim = run(problem, s, start);
  judge_.certify(problem, tolerance(), claim, s);
  for (int attempt = 1; s.status != Status::solved && s.status != Status::infeasible; ++attempt) {
    if (!run_again(problem, s, attempt, claim)) break;
    judge_.certify(problem, tolerance(), claim, s);
  }
  return s;
}

}  // namespace orthant
