#include <orthant/solvers/distributed/distributed_newton.h>

#include <algorithm>
#include <cmath>

namespace orthant::distributed {
namespace {

// Rows up to which LU is tried where iterations fail: minutes, and seconds where there is a time limit.
constexpr PetscInt kDirect = 200000, kTimedDirect = 20000;

}  // namespace

DistributedNewton::DistributedNewton(const DistributedLcp& problem, const NewtonOptions& options)
    : problem_(problem),
      options_(options),
      judge_(problem),
      krylov_(problem.comm(), options.ksp, options.pc, problem.symmetric(), [this] { return stop(); }),
      krylov_of_v_(problem.comm(),
                   options.ksp == KspName::cg || options.ksp == KspName::minres ? KspName::gmres : options.ksp,
                   options.pc, false, [this] { return stop(); }),
      block_(problem, krylov_) {}

bool DistributedNewton::stop() const {
  if (cancel_ == nullptr && !budget_.timed()) return false;
  return any_of_all(problem_.comm(), budget_.exhausted());
}

Claim DistributedNewton::interrupted() const {
  const bool cancelled = cancel_ != nullptr && any_of_all(problem_.comm(), budget_.cancelled());
  return cancelled ? Claim::cancelled : Claim::time_limit;
}

bool DistributedNewton::accepted(const Vector& z, NewtonSolution& s) {
  const Index m = problem_.rows();
  cut_.resize(m + problem_.halo());
  for (Index i = 0; i < m; ++i) cut_[i] = std::clamp(z[i], problem_.lo()[i], problem_.hi()[i]);
  const Verdict verdict = judge_.judge(cut_, options_.tolerance);
  s.rounds = verdict.rounds;
  const bool answer = has_answer(verdict.status);
  if (!answer && best_.status != Status::not_run && !(verdict.residual < best_.residual)) return false;
  best_ = verdict;
  s.residual = verdict.residual, s.miss = verdict.miss;
  s.z = cut_.head(m), s.w = judge_.w();
  return answer;
}

// z and w of the block: the guess, or A z = −b; where that cannot be solved, the point of the bounds nearest to 0.
void DistributedNewton::start(NewtonSolution& s, bool warm) {
  const Index m = problem_.rows();
  block_.z.resize(m + problem_.halo());
  block_.side.resize(at(m));
  for (Index i = 0; i < m; ++i) {
    block_.z[i] = std::clamp(warm ? s.z[i] : 0, problem_.lo()[i], problem_.hi()[i]);
    block_.side[at(i)] = problem_.lo()[i] == problem_.hi()[i] ? Side::lower : Side::inside;
  }
  cut_ = block_.z;
  constexpr double kFirstStep = 1e-4;
  if (!warm && block_.step(kFirstStep)) {
    for (Index i = 0; i < m; ++i) block_.side[at(i)] = block_.better(i);
    return;
  }
  block_.z = cut_;
  problem_.residual(block_.z, block_.w);
  block_.choose();
}

void DistributedNewton::solve(NewtonSolution& s, bool warm) {
  const Index m = problem_.rows();
  require_everywhere(problem_.comm(), warm && s.z.size() != m
                                          ? "z: a start must have as many entries as the rank's rows"
                                      : warm && !s.z.allFinite() ? "z: a start must be finite"
                                                                 : "");
  budget_.start(time_limit_, cancel_);
  for (Krylov* each : {&krylov_, &krylov_of_v_}) each->set_most_direct(budget_.timed() ? kTimedDirect : kDirect);
  if (log_ != nullptr) log_->clear();
  Vector guess;
  if (warm) guess = s.z;
  s = NewtonSolution();
  if (warm) s.z = guess;
  best_ = {};
  const long before = krylov_.iterations() + krylov_of_v_.iterations();
  const long set_up = krylov_.preconditioners() + krylov_of_v_.preconditioners();
  Claim claim = Claim::candidate;
  if (problem_.size() > 0) {
    start(s, warm);
    const bool reduced = options_.method == NewtonOptions::Method::reduced_space;
    if (reduced) claim = reduced_space(s);
    if (!reduced || (claim == Claim::stalled && !has_answer(best_.status))) claim = semismooth(s);
  }
  if (best_.status == Status::not_run) accepted(block_.z, s);
  s.status = has_answer(best_.status) || claim == Claim::candidate ? best_.status : status_of(claim);
  if (has_answer(s.status)) s.reason.clear();
  s.krylov_iterations = krylov_.iterations() + krylov_of_v_.iterations() - before;
  s.preconditioners = krylov_.preconditioners() + krylov_of_v_.preconditioners() - set_up;
}

}  // namespace orthant::distributed
