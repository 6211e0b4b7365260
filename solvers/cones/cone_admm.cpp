#include <orthant/solvers/cones/cone_admm.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

Claim ConeAdmm::iterate(Vector& z, int& iterations) {
  constexpr double kEta = 1e-8;
  constexpr int kLook = 20;  // iterations between two looks at ρ
  const ConeForm& f = form();
  const Index n = f.size();
  system_.load(f);
  for (int c = 0; c < f.blocks(); ++c) {  // E = 0, H = I: the system is A + α I
    const int m = f.block(c).rows;
    std::fill_n(system_.E_of(c), m * m, 0.0), std::fill_n(system_.H_of(c), m * m, 0.0);
    for (int r = 0; r < m; ++r) system_.H_of(c)[r + m * r] = 1;
  }
  double rho = options_.rho;
  x_ = z, lambda_ = Eigen::VectorXd::Zero(n), s_.resize(n), before_.resize(n);
  system_.keep_factors(false);
  std::array<double, cones::kMostRows> corrected{};
  double primal = 0, dual = 0;
  while (iterations < options_.max_iterations) {
    ++iterations;
    for (int c = 0; c < f.blocks(); ++c) {
      const cones::Block& b = f.block(c);
      f.all().correct(b, lambda_.data() + b.start, corrected.data());
      s_.segment(b.start, b.rows).setZero();
      s_[b.start] = corrected[0] - lambda_[b.start];
    }
    // λ stands for û, whose first entry holds the correction: the slip is that of λ itself.
    system_.F = f.q + s_ - kEta * x_ - rho * z - lambda_;
    if (!system_.solve(kEta + rho)) return Claim::numerical_error;
    system_.keep_factors(true);
    x_ = system_.dz;
    before_ = z;
    for (int c = 0; c < f.blocks(); ++c) {
      const cones::Block& b = f.block(c);
      for (int r = 0; r < b.rows; ++r) corrected[at(r)] = x_[b.start + r] - lambda_[b.start + r] / rho;
      f.all().project(b, corrected.data(), z.data() + b.start);
    }
    lambda_ += rho * (z - x_);
    primal = std::max(primal, (x_ - z).norm()), dual = std::max(dual, rho * (z - before_).norm());
    if (!z.allFinite()) return Claim::numerical_error;
    const bool end = finished(z);
    log(iterations, residual(), rho);
    if (end) return Claim::time_limit;
    if (options_.adapt && iterations % kLook == 0) {
      const double ratio = primal * rho / dual;  // both in units of w
      if (ratio > 10 || ratio < 0.1) {
        rho = std::clamp(rho * std::clamp(std::sqrt(ratio), 0.2, 5.0), 1e-6, 1e6);
        system_.keep_factors(false);
      }
      primal = dual = 0;
    }
  }
  return Claim::iteration_limit;
}

}  // namespace orthant
