#include <orthant/solvers/first_order/apgd.h>

#include <algorithm>
#include <cmath>

namespace orthant {

void Apgd::begin_at(const Lcp& problem, const Vector& z) {
  multiply(problem.A, z, w_x_, scratch_);
  w_x_ += problem.b;
  x_ = z, y_ = z, w_y_ = w_x_;
  theta_ = 1;
}

void Apgd::load(const Lcp& problem, Vector& z) {
  bounds_.load(problem, z);
  sums_.evaluate(problem.A, bounds_.d);
  largest_ = std::max((sums_.sums.array() / bounds_.d.array()).maxCoeff(), 1e-300);
  curvature_ = std::min(1.0, largest_);  // of a single row
  begin_at(problem, z);
}

Apgd::Step Apgd::advance(const Lcp& problem, Vector& z) {
  const Vector& d = bounds_.d;
  for (;;) {
    next_ = (y_.array() - w_y_.array() / (curvature_ * d.array())).max(bounds_.lo.array()).min(bounds_.hi.array());
    multiply(problem.A, next_, w_next_, scratch_);
    w_next_ += problem.b;
    if (curvature_ >= largest_) break;
    const double met = (next_ - y_).dot(w_next_ - w_y_), length = (d.array() * (next_ - y_).array().square()).sum();
    if (!(met > (1 + 1e-9) * curvature_ * length)) break;  // once met, a curvature is met again up to rounding
    curvature_ = std::min(std::max(met / length, 1.5 * curvature_), largest_);
  }
  Step step{.violation = bounds_.violation(problem, next_, w_next_), .length = 1 / curvature_};
  const bool still = next_ == x_;
  step.moved = !still || y_ != x_;
  const double uphill = (d.array() * (y_ - next_).array() * (next_ - x_).array()).sum();
  if (still || (options_.restart && uphill > 0)) {
    theta_ = 1;
    y_ = next_, w_y_ = w_next_;
    step.event = "restart";
  } else {
    const double squared = theta_ * theta_, theta = 0.5 * (std::sqrt(squared * squared + 4 * squared) - squared);
    const double beta = theta_ * (1 - theta_) / (squared + theta);
    y_ = next_ + beta * (next_ - x_), w_y_ = w_next_ + beta * (w_next_ - w_x_);
    theta_ = theta;
  }
  x_.swap(next_), w_x_.swap(w_next_);
  curvature_ *= options_.shrink;
  z = x_;
  if (bounds_.outdated()) {
    bounds_.hold(problem, z);
    begin_at(problem, z);
    step.event = "friction bounds";
  }
  return step;
}

}  // namespace orthant
