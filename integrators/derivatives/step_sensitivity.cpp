#include <orthant/integrators/derivatives/step_sensitivity.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr Index kSmallProblem = 16;  // rows
constexpr double kWellConditioned = 1e10;
constexpr double kRestNoise = 1e-12;  // of the largest so far: a body at rest leaves nothing but this

}  // namespace

void StepSensitivity::set_up(const Lcp& problem, const Solution& solution) {
  problem_ = &problem;
  weak_.clear();
  full_.reset();
  if (problem.size() <= kSmallProblem && std::holds_alternative<DenseMatrix>(problem.A) && set_up_small(solution))
    return;
  full_.emplace(problem, solution);
  weak_ = full_->report().weakly_active;
}

bool StepSensitivity::set_up_small(const Solution& s) {
  const auto n = static_cast<std::size_t>(rows());
  at_.assign(n, At::free), weight_.assign(n, 1.0);
  for (Index j = 0; j < rows(); ++j)
    for (Index i = 0; i < rows(); ++i) weight_[at(i)] = std::max(weight_[at(i)], std::abs(A(i, j)));
  return place(s) && invert();
}

// As ActivePattern does it. False: a row is weakly active, or of a kind that has no place here.
bool StepSensitivity::place(const Solution& s) {
  const Lcp& problem = *problem_;
  const double threshold = std::max(s.residual, 20 * s.rounding);
  for (const Friction& f : problem.friction) {
    if (f.rows != 1) return false;
    at_[at(f.first)] = At::lower;
  }
  for (Index i = 0; i < rows(); ++i) {
    if (at_[at(i)] == At::lower) continue;  // of a friction
    const double below = s.z[i] - problem.lo[i], above = problem.hi[i] - s.z[i];
    const bool low = weight_[at(i)] * below <= threshold, high = weight_[at(i)] * above <= threshold;
    if (problem.lo[i] == problem.hi[i]) return false;
    if (low && s.w[i] > threshold)
      at_[at(i)] = At::lower;
    else if (high && s.w[i] < -threshold)
      at_[at(i)] = At::upper;
    else if (low || high)
      return false;
  }
  drags_.clear(), normal_force_.clear();
  for (const Friction& f : problem.friction) {
    const double radius = f.mu * s.z[f.normal], force = std::abs(s.z[f.first]), slip = std::abs(s.w[f.first]);
    const double inside = weight_[at(f.first)] * (radius - force);
    const bool open = at_[at(f.normal)] == At::lower && problem.lo[f.normal] == 0;
    const bool none = f.mu == 0 || open || !(radius > 0) || !(force > 0 || weight_[at(f.first)] * radius > threshold);
    normal_force_.push_back(s.z[f.normal]);
    drags_.push_back(0);
    if (slip > threshold && (none || inside <= threshold))
      drags_.back() = s.w[f.first] > 0 ? -1 : 1;
    else if (!none && inside > threshold)
      at_[at(f.first)] = At::free;
    else if (!none)
      return false;
  }
  return true;
}

// B⁻¹ by Gauss and Jordan, with partial pivoting. False: B is not well conditioned.
bool StepSensitivity::invert() {
  free_.clear();
  for (Index i = 0; i < rows(); ++i)
    if (at_[at(i)] == At::free) free_.push_back(i);
  const auto m = free_.size();
  block_.assign(m * m, 0.0), inverse_.assign(m * m, 0.0);
  for (std::size_t i = 0; i < m; ++i) {
    inverse_[i * m + i] = 1;
    for (std::size_t j = 0; j < m; ++j) block_[i * m + j] = A(free_[i], free_[j]);
  }
  for (std::size_t k = 0; k < drags_.size(); ++k) {
    const Friction& f = problem_->friction[k];
    const auto normal = std::find(free_.begin(), free_.end(), f.normal);
    if (drags_[k] == 0 || normal == free_.end()) continue;
    const auto j = static_cast<std::size_t>(normal - free_.begin());
    for (std::size_t i = 0; i < m; ++i) block_[i * m + j] += drags_[k] * f.mu * A(free_[i], f.first);
  }
  const auto norm = [m](const std::vector<double>& x) {
    double most = 0;
    for (std::size_t j = 0; j < m; ++j) {
      double sum = 0;
      for (std::size_t i = 0; i < m; ++i) sum += std::abs(x[i * m + j]);
      most = std::max(most, sum);
    }
    return most;
  };
  const double size = norm(block_);
  for (std::size_t k = 0; k < m; ++k) {
    std::size_t p = k;
    for (std::size_t i = k + 1; i < m; ++i)
      if (std::abs(block_[i * m + k]) > std::abs(block_[p * m + k])) p = i;
    if (!(std::abs(block_[p * m + k]) > 0)) return false;
    for (std::size_t j = 0; j < m && p != k; ++j) {
      std::swap(block_[p * m + j], block_[k * m + j]);
      std::swap(inverse_[p * m + j], inverse_[k * m + j]);
    }
    const double by = 1 / block_[k * m + k];
    for (std::size_t j = 0; j < m; ++j) block_[k * m + j] *= by, inverse_[k * m + j] *= by;
    for (std::size_t i = 0; i < m; ++i) {
      const double factor = block_[i * m + k];
      if (i == k || factor == 0) continue;
      for (std::size_t j = 0; j < m; ++j) {
        block_[i * m + j] -= factor * block_[k * m + j];
        inverse_[i * m + j] -= factor * inverse_[k * m + j];
      }
    }
  }
  return m == 0 || size * norm(inverse_) < kWellConditioned;
}

bool StepSensitivity::tangent(const double* w, const double* hi, const double* mu, Index count, double* z) {
  const Index n = rows();
  const auto frictions = static_cast<Index>(problem_->friction.size());
  for (Index i = 0; i < n * count; ++i) largest_rate_ = std::max(largest_rate_, std::abs(w[i]));
  if (full_) {
    bool consistent = true;
    Perturbation change;
    change.b = Eigen::VectorXd::Zero(n), change.mu = Eigen::VectorXd::Zero(frictions);
    if (hi != nullptr) change.hi = change.lo = change.b;
    for (Index j = 0; j < count; ++j) {
      for (Index i = 0; i < n; ++i) change.b[i] = w[i * count + j];
      for (Index i = 0; i < n && hi != nullptr; ++i) change.hi[i] = hi[i * count + j], change.lo[i] = -change.hi[i];
      for (Index i = 0; i < frictions; ++i) change.mu[i] = mu[i * count + j];
      const SolutionTangent t = full_->jvp(change);
      const double parted = t.parted * change.b.lpNorm<Eigen::Infinity>();
      consistent = consistent && (t.consistent || parted <= kRestNoise * largest_rate_);
      for (Index i = 0; i < n; ++i) z[i * count + j] = t.z[i];
    }
    return consistent;
  }
  std::fill(z, z + n * count, 0.0);
  sum_.assign(w, w + n * count);  // ẇ₀ + A p
  for (Index i = 0; i < n && hi != nullptr; ++i)
    if (at_[at(i)] != At::free) add_scaled(count, at_[at(i)] == At::lower ? -1 : 1, hi + i * count, z + i * count);
  for (Index k = 0; k < frictions; ++k) {
    const Friction& f = problem_->friction[at(k)];
    double* const row = z + f.first * count;
    if (at_[at(f.first)] != At::free) std::fill(row, row + count, 0.0);
    if (drags_[at(k)] == 0) continue;
    add_scaled(count, drags_[at(k)] * normal_force_[at(k)], mu + k * count, row);
    if (at_[at(f.normal)] != At::free) add_scaled(count, drags_[at(k)] * f.mu, z + f.normal * count, row);
  }
  for (Index j = 0; j < n; ++j) {
    const double* const held = z + j * count;
    if (at_[at(j)] == At::free || std::all_of(held, held + count, [](double x) { return x == 0; })) continue;
    for (const Index i : free_) add_scaled(count, A(i, j), held, sum_.data() + i * count);
  }
  const auto m = free_.size();
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      add_scaled(count, -inverse_[i * m + j], sum_.data() + free_[j] * count, z + free_[i] * count);
  for (Index k = 0; k < frictions; ++k) {
    const Friction& f = problem_->friction[at(k)];
    if (drags_[at(k)] != 0 && at_[at(f.normal)] == At::free)
      add_scaled(count, drags_[at(k)] * f.mu, z + f.normal * count, z + f.first * count);
  }
  return true;
}

bool StepSensitivity::adjoint(const Vector& of_z, double* w, double* hi, double* mu) {
  const Index n = rows();
  const auto frictions = static_cast<Index>(problem_->friction.size());
  const double weight = of_z.lpNorm<Eigen::Infinity>();
  largest_weight_ = std::max(largest_weight_, weight);
  if (full_) {
    const DataGradient by = full_->vjp(of_z);
    for (Index i = 0; i < n; ++i) w[i] = by.b[i], hi[i] = by.hi[i] - by.lo[i];
    for (Index k = 0; k < frictions; ++k) mu[k] = by.mu[k];
    return by.consistent || by.parted * weight <= kRestNoise * largest_weight_;
  }
  const auto m = free_.size();
  sum_.assign(of_z.data(), of_z.data() + n);
  held_ = sum_;
  for (Index k = 0; k < frictions; ++k) {
    const Friction& f = problem_->friction[at(k)];
    if (drags_[at(k)] != 0) sum_[at(f.normal)] += drags_[at(k)] * f.mu * of_z[f.first];
  }
  std::fill(w, w + n, 0.0), std::fill(hi, hi + n, 0.0);
  for (std::size_t j = 0; j < m; ++j)
    for (std::size_t i = 0; i < m; ++i) w[free_[j]] -= inverse_[i * m + j] * sum_[at(free_[i])];
  for (Index j = 0; j < n; ++j)
    for (const Index i : free_) held_[at(j)] += A(i, j) * w[i];  // π
  for (Index k = 0; k < frictions; ++k) {
    const Friction& f = problem_->friction[at(k)];
    const double along = drags_[at(k)] * held_[at(f.first)];
    mu[k] = normal_force_[at(k)] * along;
    held_[at(f.normal)] += f.mu * along;
  }
  for (Index i = 0; i < n; ++i)
    if (at_[at(i)] != At::free) hi[i] = at_[at(i)] == At::lower ? -held_[at(i)] : held_[at(i)];
  for (const Friction& f : problem_->friction) hi[f.first] = 0;
  return true;
}

}  // namespace orthant
