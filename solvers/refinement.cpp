#include <orthant/solvers/refinement.h>

#include <orthant/solvers/registry.h>

namespace orthant {

namespace {

constexpr double kReached = 1e-13;  // of the data: what pivoting reaches
constexpr double kAsked = 1e-10;    // of the judge

}  // namespace

void Refinement::improve(const Lcp& problem, Solution& s) {
  if (s.status != Status::solved || s.residual <= kReached ||
      s.residual <= kReached * problem.b.lpNorm<Eigen::Infinity>())
    return;
  if (!newton_) {
    newton_ = make_solver("newton-min:tolerance=1e-14");
    newton_->set_proof_search(false);
  }
  trial_.z = s.z;
  newton_->solve(problem, trial_, Start::warm);
  judge_.certify(problem, kAsked, Claim::candidate, trial_);
  if (trial_.status != Status::solved || !(trial_.residual < s.residual)) return;
  s.z = trial_.z, s.w = trial_.w, s.residual = trial_.residual;
}

}  // namespace orthant
