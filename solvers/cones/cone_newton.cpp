#include <orthant/solvers/cones/cone_newton.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

constexpr std::size_t kSearchMemory = 5;  // of the nonmonotone search
constexpr int kSearchTrials = 3;

}  // namespace

void ConeNewton::load(const ConeForm& form, const Budget* budget) {
  form_ = &form, budget_ = budget;
  system_.load(form, budget);
  rho_n_.resize(form.blocks()), rho_t_.resize(form.blocks());
  for (int c = 0; c < form.blocks(); ++c) {
    const int m = form.block(c).rows, i = form.begin(c);
    double largest = 0;
    for (int r = 1; r < m; ++r) largest = std::max(largest, form.diagonal[i + r]);
    rho_n_[c] = form.diagonal[i] > 0 ? 1 / form.diagonal[i] : 1;
    rho_t_[c] = largest > 0 ? 1 / largest : 1;
  }
}

double ConeNewton::evaluate(const Task& task, const Vector& centre, const Vector& z) {
  form_->apply(z, w_);
  if (task.alpha > 0) w_ += task.alpha * (z - centre);
  const bool natural = task.map == ContactMap::natural;
  for (int c = 0; c < form_->blocks(); ++c) {
    const cones::Block& b = form_->block(c);
    system_.open[at(c)] =
        evaluate_map(task.map, form_->all(), b, z.data() + b.start, w_.data() + b.start, natural ? 1 : rho_n_[c],
                     natural ? 1 : rho_t_[c], system_.F.data() + b.start, system_.E_of(c), system_.H_of(c));
  }
  return system_.F.norm();
}

ConeNewton::Outcome ConeNewton::solve(const Task& task, const Vector& centre, Vector& z) {
  Outcome out;
  double norm = evaluate(task, centre, z);
  std::array<double, kSearchMemory> memory{};
  memory.fill(norm);
  best_ = z, out.norm = norm;
  for (; out.steps < task.max_steps && !(norm <= task.tolerance); ++out.steps) {
    if (budget_ != nullptr && budget_->exhausted()) break;
    if (!system_.solve(task.alpha)) break;
    const double most = *std::max_element(memory.begin(), memory.end());
    double t = 1, trial_norm = kInf;
    const Vector& dz = system_.dz;
    for (int k = 0; k < kSearchTrials; ++k, t /= 2) {
      trial_ = z + t * dz;
      trial_norm = evaluate(task, centre, trial_);
      if (trial_norm <= (1 - 1e-4 * t) * most) break;
    }
    if (!std::isfinite(trial_norm)) break;
    z = trial_, norm = trial_norm;
    memory[at(out.steps) % kSearchMemory] = norm;
    if (norm < out.norm) out.norm = norm, best_ = z;
  }
  z = best_;
  out.converged = out.norm <= task.tolerance;
  return out;
}

}  // namespace orthant
