#include <orthant/solvers/cones/cone_apgd.h>
#include <orthant/solvers/first_order/first_order.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

std::string ConeApgd::why_not(const Lcp& problem) const {
  const std::string reason = detail::quadratic_why_not(problem.A);
  return reason.empty() ? ConeSolver::why_not(problem) : reason;
}

/// x ← P_K(y − gradient/L); ‖x − y‖.
double ConeApgd::project(const Vector& y, const Vector& gradient, double L, Vector& x) const {
  const ConeForm& f = form();
  std::array<double, cones::kMostRows> point{};
  for (int c = 0; c < f.blocks(); ++c) {
    const cones::Block& b = f.block(c);
    for (int r = 0; r < b.rows; ++r) point[at(r)] = y[b.start + r] - gradient[b.start + r] / L;
    f.all().project(b, point.data(), x.data() + b.start);
  }
  return (x - y).norm();
}

Claim ConeApgd::iterate(Vector& z, int& iterations) {
  const ConeForm& f = form();
  const Index n = f.size();
  s_ = Eigen::VectorXd::Zero(n), next_.resize(n), before_ = z, y_ = z;
  std::array<double, cones::kMostRows> corrected{};
  double L = 1, theta = 1, change = kInf;
  const auto update = [&](const Vector& w) {
    double sum = 0;
    for (int c = 0; c < f.blocks(); ++c) {
      const cones::Block& b = f.block(c);
      f.all().correct(b, w.data() + b.start, corrected.data());
      const double value = corrected[0] - w[b.start];
      sum += (value - s_[b.start]) * (value - s_[b.start]);
      s_[b.start] = value;
    }
    change = std::max(std::sqrt(sum), 1e-18 * f.norm_q);
  };
  while (iterations < options_.max_iterations) {
    ++iterations;
    f.apply(y_, w_);
    gradient_ = w_ + s_;
    double moved = 0;
    for (;;) {
      moved = project(y_, gradient_, L, next_);
      f.apply(next_, w_next_);
      const double curvature = (next_ - y_).dot(w_next_ - w_);
      if (curvature <= L * moved * moved || !(moved > 0) || L > 1e12) break;
      L *= 2;
    }
    const bool end = finished(next_);
    log(iterations, residual(), 1 / L);
    if (end) {
      z = next_;
      return Claim::time_limit;
    }
    if (!next_.allFinite()) return Claim::numerical_error;
    if ((y_ - next_).dot(next_ - before_) > 0) theta = 1;
    const double theta_next = 0.5 * (theta * std::sqrt(theta * theta + 4) - theta * theta);
    const double beta = theta * (1 - theta) / (theta * theta + theta_next);
    y_ = next_ + beta * (next_ - before_);
    before_ = next_, theta = theta_next, L *= 0.9;
    if (L * moved <= 0.1 * change || iterations % 500 == 0) update(w_next_), theta = 1;
  }
  z = before_;
  return Claim::iteration_limit;
}

}  // namespace orthant
