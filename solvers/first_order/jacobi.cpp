#include <orthant/solvers/first_order/jacobi.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void Jacobi::load(const Lcp& problem, Vector&) {
  diagonal(problem.A, d_);
  if (options_.scaling == JacobiOptions::Scaling::l1) {
    sums_.evaluate(problem.A, d_);
    d_.swap(sums_.sums);
  } else if (options_.scaling == JacobiOptions::Scaling::spectral) {
    d_ *= detail::largest_ratio(problem.A, d_, problem.b, x_, w_, scratch_);
  }
}

Jacobi::Step Jacobi::advance(const Lcp& problem, Vector& z) {
  multiply(problem.A, z, w_, scratch_);
  w_ += problem.b;
  w_.array() *= -options_.omega / d_.array();  // the step, then what is left of it
  for (Index i = 0; i < z.size(); ++i) w_[i] = std::clamp(z[i] + w_[i], problem.lo[i], problem.hi[i]);
  for (const Friction& f : problem.friction) {
    const double bound = f.mu * std::max(w_[f.normal], 0.0);
    w_[f.first] = std::clamp(w_[f.first], -bound, bound);
  }
  Step step{.moved = false};
  for (Index i = 0; i < z.size(); ++i) {
    const double change = std::abs(w_[i] - z[i]);
    step.moved = step.moved || change > 4 * std::numeric_limits<double>::epsilon() * std::abs(w_[i]);
    detail::raise(step.violation, change * d_[i]);
  }
  z.swap(w_);
  return step;
}

}  // namespace orthant
