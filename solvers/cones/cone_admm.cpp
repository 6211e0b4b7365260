#include <orthant/solvers/cones/cone_admm.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

constexpr double kSplittingEta = 1e-8;
constexpr int kSplittingLook = 20;            // iterations between two looks at ρ
constexpr double kSplittingSkew = 0.02;       // ‖N‖_∞ up to which N x may lag: ρ starts at 0.1
constexpr double kSplittingRounding = 1e-10;  // up to which it may lag by kSplittingLook iterations

}  // namespace

void ConeSplitting::load(const ConeForm& form, const Budget* budget) {
  form_ = &form, budget_ = budget, factorized_ = false;
  const Delassus* const source = form.source();
  if (source != nullptr && source->regularization.size() == 0 &&
      operator_.load(*source, form.rows_of_problem(), form.scale()))
    factors_ = Factors::coordinates;
  else
    load_symmetric();
}

void ConeSplitting::load_symmetric() {
  bool symmetric = true;
  shift_ = 0;
  const RowSparse& A = form_->A;
  const Index n = form_->size();
  S_.rows = S_.cols = n;
  S_.start.assign(1, 0), S_.column.clear(), S_.value.clear();
  N_.clear(), diagonal_.clear(), skew_ = 0;
  for (int i = 0; i < n && symmetric; ++i) {
    const auto begin = A.column.begin() + A.start[at(i)], end = A.column.begin() + A.start[at(i) + 1];
    double skew = 0;
    if (std::lower_bound(begin, end, i) == end || *std::lower_bound(begin, end, i) != i) symmetric = false;
    for (auto j = begin; j != end && symmetric; ++j) {
      const double value = A.value[at(j - A.column.begin())];
      double mean = value;
      if (*j == i) {
        diagonal_.push_back(static_cast<int>(S_.value.size()));
      } else {
        const auto other = A.column.begin() + A.start[at(*j)], last = A.column.begin() + A.start[at(*j) + 1];
        const auto place = std::lower_bound(other, last, i);
        symmetric = place != last && *place == i;
        if (!symmetric) break;
        mean = 0.5 * (value + A.value[at(place - A.column.begin())]);
        if (value != mean) skew += std::abs(value - mean);
        if (value != mean && *j > i) N_.push_back({i, *j, value - mean});
      }
      S_.column.push_back(*j), S_.value.push_back(mean);
    }
    S_.start.push_back(static_cast<int>(S_.value.size()));
    symmetric = symmetric && skew <= kSplittingSkew;
    skew_ = std::max(skew_, skew);
  }
  factors_ = Factors::rows;
  if (!symmetric) load_system();
}

/// E = 0, H = I: the system is A + α I.
void ConeSplitting::load_system() {
  factors_ = Factors::unsymmetric;
  system_.load(*form_, budget_);
  for (int c = 0; c < form_->blocks(); ++c) {
    const int m = form_->block(c).rows;
    std::fill_n(system_.E_of(c), m * m, 0.0), std::fill_n(system_.H_of(c), m * m, 0.0);
    for (int r = 0; r < m; ++r) system_.H_of(c)[r + m * r] = 1;
  }
}

void ConeSplitting::start(const Vector& z, double rho) {
  const Index n = form_->size();
  if (rho != rho_) factorized_ = false;
  rho_ = rho, steps_ = 0, primal_ = dual_ = 0;
  x_ = z, y_ = z, lambda_.resize(n), before_.resize(n), rhs_.resize(n);
  if (z.isZero(0)) return lambda_.setZero(), void();
  form_->apply(z, before_);
  for (int c = 0; c < form_->blocks(); ++c)
    form_->all().correct(form_->block(c), before_.data() + form_->begin(c), lambda_.data() + form_->begin(c));
}

bool ConeSplitting::factorize() {
  const double shift = kSplittingEta + rho_;
  if (factors_ == Factors::coordinates) return factorized_ = operator_.factorize(shift, budget_);
  if (factors_ == Factors::rows) {
    for (const int place : diagonal_) S_.value[at(place)] += shift - shift_;
    shift_ = shift;
    if (factorized_ = cholesky_.factorize(S_, 0, budget_); factorized_) return true;
    if (budget_ != nullptr && budget_->exhausted()) return false;
    load_system();  // not positive definite
  }
  system_.keep_factors(false);
  return factorized_ = true;
}

bool ConeSplitting::solve() {
  if (!factorized_ && !factorize()) return false;
  if (factors_ == Factors::coordinates) {
    x_ = rhs_;
    return operator_.solve(x_);
  }
  if (factors_ == Factors::rows) {
    if (!N_.empty()) {
      if (skew_ > kSplittingRounding || steps_ % kSplittingLook == 0) {
        Nx_.resize(x_.size()), Nx_.setZero();
        for (const auto& [i, j, value] : N_) Nx_[i] += value * x_[j], Nx_[j] -= value * x_[i];
      }
      rhs_ -= Nx_;
    }
    x_ = rhs_;
    return cholesky_.solve(x_);
  }
  system_.F = -rhs_;
  if (!system_.solve(kSplittingEta + rho_)) return false;
  system_.keep_factors(true);
  x_ = system_.dz;
  return true;
}

bool ConeSplitting::step(bool adapt) {
  const ConeForm& f = *form_;
  std::array<double, cones::kMostRows> block{};
  // λ stands for û, whose first entry holds the correction: the slip is that of λ itself.
  rhs_ = kSplittingEta * x_ + rho_ * y_ + lambda_ - f.q;
  for (int c = 0; c < f.blocks(); ++c) {
    const cones::Block& b = f.block(c);
    f.all().correct(b, lambda_.data() + b.start, block.data());
    rhs_[b.start] -= block[0] - lambda_[b.start];
  }
  if (!solve()) return false;
  before_ = y_;
  for (int c = 0; c < f.blocks(); ++c) {
    const cones::Block& b = f.block(c);
    for (int r = 0; r < b.rows; ++r) block[at(r)] = x_[b.start + r] - lambda_[b.start + r] / rho_;
    f.all().project(b, block.data(), y_.data() + b.start);
  }
  lambda_ += rho_ * (y_ - x_);
  primal_ = std::max(primal_, (x_ - y_).norm()), dual_ = std::max(dual_, rho_ * (y_ - before_).norm());
  if (!std::isfinite(primal_ + dual_)) return false;
  if (++steps_ % kSplittingLook == 0 && adapt) {
    const double ratio = primal_ * rho_ / dual_;  // both in units of w
    if (ratio > 10 || ratio < 0.1) {
      rho_ = std::clamp(rho_ * std::clamp(std::sqrt(ratio), 0.2, 5.0), 1e-6, 1e6);
      factorized_ = false;
    }
    primal_ = dual_ = 0;
  }
  return true;
}

Claim ConeAdmm::iterate(Vector& z, int& iterations) {
  splitting_.load(form(), &budget());
  splitting_.start(z, options_.rho);
  while (iterations < options_.max_iterations) {
    ++iterations;
    if (!splitting_.step(options_.adapt)) return Claim::numerical_error;
    z = splitting_.z();
    const bool end = finished(z);
    log(iterations, residual(), splitting_.rho());
    if (end) return Claim::time_limit;
  }
  return Claim::iteration_limit;
}

}  // namespace orthant
