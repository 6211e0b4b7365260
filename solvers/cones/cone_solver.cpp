#include <orthant/core/support/kept_memory.h>
#include <orthant/solvers/cones/cone_solver.h>

#include <algorithm>
#include <cmath>

namespace orthant {

std::string ConeSolver::why_not(const Lcp& p) const {
  static thread_local std::vector<int> kept;
  std::vector<int> own;
  std::vector<int>& rows = p.size() > kKeptRows ? own : kept;
  rows.assign(at(p.size()), 1);
  for (const Friction& f : p.friction)
    if ((rows[at(f.normal)] += static_cast<int>(f.rows)) > cones::kMostRows)
      return "row " + std::to_string(f.normal) + " bears more than " + std::to_string(cones::kMostRows - 1) +
             " friction rows";
  if (const auto* delassus = std::get_if<Delassus>(&p.A); delassus != nullptr && !takes_operators()) {
    std::vector<double> uses(at(delassus->W.cols), 0);
    for (const int column : delassus->W.column) ++uses[at(column)];
    double products = 0;
    for (const double count : uses) products += count * count;
    if (products > ConeForm::kFormed) return "the operator has too many entries to be formed";
  }
  return {};
}

bool ConeSolver::finished(const Vector& z) {
  form_.apply(z, w_);
  return finished(z, form_.residual(z, w_));
}

bool ConeSolver::finished(const Vector& z, double residual) {
  sf_ = residual;
  if (sf_ < least_) least_ = sf_, best_ = z;
  if (sf_ <= target_) {
    form_.from_scaled(z, solution_->z);
    if (passes(*problem_, *solution_)) return solved_ = true;
    target_ = 0.5 * sf_;
  }
  return budget().exhausted();
}

void ConeSolver::release() {
  form_ = {};
  free_memory(z_, w_, best_);
}

Claim ConeSolver::run(const Lcp& problem, Solution& s, Start start) {
  problem_ = &problem, solution_ = &s;
  solved_ = false, least_ = kInf;
  if (problem.size() == 0) return Claim::candidate;
  const bool unformed = takes_operators() && problem.size() >= kUnformed && std::holds_alternative<Delassus>(problem.A);
  if (unformed)
    form_.load_unformed(problem);
  else if (!form_.load(problem))
    return Claim::unsupported;
  form_.to_scaled(s.z, z_);
  if (start == Start::cold) z_.setZero();
  best_ = z_;
  target_ = 0.5 * tolerance();
  Claim status = !unformed && finished(z_) && solved_ ? Claim::candidate : iterate(z_, s.iterations);
  if (!solved_) form_.from_scaled(best_, s.z);
  if (solved_) keep_passed(), status = Claim::candidate;
  return status;
}

}  // namespace orthant
