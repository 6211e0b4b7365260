#include <orthant/solvers/small_active_set.h>

#include <orthant/solvers/effort.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon();
constexpr int kMost = 12;   // factorizations
constexpr int kPasses = 3;  // of them that make nothing better
constexpr double kMissed = 1e-9;
constexpr double kRoundings = 16;  // roundings of its terms by which a w_i = 0 may look wrong

}  // namespace

void SmallActiveSet::load(const Lcp& problem) {
  problem_ = &problem;
  A_ = &std::get<DenseMatrix>(problem.A);
  const Index n = problem.size();
  for (Vector* each : {&mu_, &w_, &size_, &rhs_, &lo_, &hi_}) each->resize(n);
  side_.resize(at(n)), normal_.resize(at(n)), place_.resize(at(n));
  for (Index i = 0; i < n; ++i) lo_[i] = problem.lo[i], hi_[i] = problem.hi[i], normal_[at(i)] = -1;
  for (const Friction& f : problem.friction) normal_[at(f.row)] = f.normal, mu_[f.row] = f.mu;
}

void SmallActiveSet::bounds(const Vector& z) {
  for (const Friction& f : problem_->friction) hi_[f.row] = f.mu * std::max(z[f.normal], 0.0), lo_[f.row] = -hi_[f.row];
}

/// No positive entry beside a positive diagonal.
bool SmallActiveSet::z_matrix() const {
  const Index n = problem_->size();
  for (Index j = 0; j < n; ++j) {
    const double* const column = A_->data() + j * n;
    bool fits = column[j] > 0;
    for (Index i = 0; i < n; ++i) fits &= (i == j) | (column[i] <= 0);
    if (!fits) return false;
  }
  return problem_->friction.empty();
}

/// Two Gauss-Seidel sweeps, w = A z + b kept up to date column by column; then each row on the side where that leaves it.
void SmallActiveSet::guess(Vector& z) {
  const Index n = z.size();
  const double* const A = A_->data();
  double* const w = w_.data();
  for (Index i = 0; i < n; ++i) w[i] = problem_->b[i];
  const auto move = [&](Index j, double change) { detail::subtract(w, -change, A + j * n, n); };
  for (Index j = 0; j < n; ++j)
    if (z[j] != 0) move(j, z[j]);
  for (int sweep = 0; sweep < 2; ++sweep)
    for (Index i = 0; i < n; ++i) {
      const double d = A[i * n + i];
      if (normal_[at(i)] >= 0) hi_[i] = mu_[i] * std::max(z[normal_[at(i)]], 0.0), lo_[i] = -hi_[i];
      const double to = std::clamp(d > 0 ? z[i] - w[i] / d : z[i], lo_[i], hi_[i]);
      if (to != z[i]) move(i, to - z[i]);
      z[i] = to;
    }
  for (Index i = 0; i < n; ++i) {
    const double d = A[i * n + i], to = z[i] - (d > 0 ? w[i] / d : w[i]);
    side_[at(i)] = to <= lo_[i] ? Side::lower : to >= hi_[i] ? Side::upper : Side::inside;
  }
}

/// size ← |b| + |A| |z|, w ← A z + b.
void SmallActiveSet::product(const Vector& z) {
  const Index n = z.size();
  double* const w = w_.data();
  double* const size = size_.data();
  for (Index i = 0; i < n; ++i) w[i] = problem_->b[i], size[i] = std::abs(w[i]);
  for (Index j = 0; j < n; ++j)
    if (z[j] != 0) detail::add_with_size(w, size, z[j], A_->data() + j * n, n);
}

/// z of the present sides; false where they do not determine it.
bool SmallActiveSet::newton(Vector& z) {
  const Index n = z.size();
  inside_.clear();
  for (Index i = 0; i < n; ++i) {
    place_[at(i)] = side_[at(i)] == Side::inside ? static_cast<Index>(inside_.size()) : -1;
    if (place_[at(i)] >= 0) inside_.push_back(i);
  }
  const auto m = static_cast<Index>(inside_.size());
  rank_ = m;
  for (Index i = 0; i < n; ++i)
    z[i] = side_[at(i)] == Side::inside || normal_[at(i)] >= 0 ? 0 : side_[at(i)] == Side::lower ? lo_[i] : hi_[i];
  sliding_.clear();
  for (const Friction& f : problem_->friction) {  // those of an open contact stay at ±μ z_n too
    if (side_[at(f.row)] == Side::inside) continue;
    const double slope = side_[at(f.row)] == Side::lower ? -f.mu : f.mu;
    if (place_[at(f.normal)] < 0)
      z[f.row] = slope * z[f.normal];
    else
      sliding_.push_back({f.row, f.normal, slope});
  }
  product(z);
  if (m == 0) return true;
  ++*iterations_;
  count_factorization(m);
  auto block = lu_.reset(m);
  for (Index c = 0; c < m; ++c) {
    const double* const from = A_->data() + inside_[at(c)] * n;
    double* const to = block.data() + c * m;
    for (Index r = 0; r < m; ++r) to[r] = from[inside_[at(r)]];
  }
  for (const Friction& f : sliding_)
    for (Index r = 0; r < m; ++r) block(r, place_[at(f.normal)]) += f.mu * (*A_)(inside_[at(r)], f.row);
  const double largest = detail::largest(block.data(), m * m);
  if (!(largest < kInf)) return false;
  rank_ = lu_.factorize(static_cast<double>(2 * m) * kRoundoff * largest);
  correct(z);
  return true;
}

/// z ← z − J⁻¹ w on the inside rows, the sliding ones with their normals; then w of it.
void SmallActiveSet::correct(Vector& z) {
  const auto m = static_cast<Index>(inside_.size());
  for (Index r = 0; r < m; ++r) rhs_[r] = w_[inside_[at(r)]];
  if (m > 0) lu_.solve(rhs_.data(), rank_);
  for (Index r = 0; r < m; ++r) z[inside_[at(r)]] -= rhs_[r];
  for (const Friction& f : sliding_) z[f.row] = f.mu * z[f.normal];
  product(z);
}

/// Rows whose sign is wrong by more than rounding, put on the side where it would be right.
Index SmallActiveSet::mend(const Vector& z) {
  const Index n = z.size();
  double reach = 0;
  for (Index i = 0; i < n; ++i) reach = std::max(reach, std::abs(z[i]));
  const double z_noise = kRoundings * kRoundoff * reach;
  Index wrong = 0;
  for (Index i = 0; i < n; ++i) {
    const double noise = kRoundings * kRoundoff * size_[i];
    const bool friction = normal_[at(i)] >= 0;
    const double normal = friction ? z[normal_[at(i)]] : 0;
    const double hi = friction ? mu_[i] * std::max(normal, 0.0) : hi_[i], lo = friction ? -hi : lo_[i];
    Side& side = side_[at(i)];
    const Side before = side;
    if (side == Side::inside) {
      if (z[i] < lo - z_noise) side = Side::lower;
      if (z[i] > hi + z_noise) side = Side::upper;
      const bool missed = rank_ < static_cast<Index>(inside_.size()) && std::abs(w_[i]) > kMissed * size_[i];
      if (side == before && missed && std::abs(w_[i] > 0 ? lo : hi) < kInf)
        side = w_[i] > 0 ? Side::lower : Side::upper;  // its equation depends on others and contradicts them
    } else if (lo < hi && (side == Side::lower ? w_[i] < -noise : w_[i] > noise)) {
      side = Side::inside;
    }
    wrong += side != before;
  }
  for (const Friction& f : problem_->friction)  // a contact that closes sticks at first
    if (side_[at(f.normal)] == Side::inside && place_[at(f.normal)] < 0) side_[at(f.row)] = Side::inside;
  return wrong;
}

bool SmallActiveSet::solve(const Lcp& problem, Vector& z, int& iterations) {
  load(problem);
  iterations_ = &iterations;
  const Index n = z.size();
  for (Index i = 0; i < n; ++i) z[i] = std::clamp(z[i], lo_[i], hi_[i]);
  const bool monotone = n >= 20 && z_matrix();
  if (monotone)  // rows then leave in large blocks, while from the bounds they enter one layer an iteration
    std::fill(side_.begin(), side_.end(), Side::inside);
  else
    guess(z);
  Index least = n + 1;
  for (int k = 0, patience = kPasses; k < (monotone ? n : kMost); ++k) {
    if (!newton(z)) return false;
    const Index wrong = mend(z);
    if (wrong == 0) {
      const auto settled = [&] {
        for (const Index i : inside_)
          if (!(std::abs(w_[i]) <= kRoundings * kRoundoff * size_[i])) return false;
        return true;
      };
      if (!settled()) correct(z);
      if (!settled()) return false;
      for (const Index i : inside_)
        if (normal_[at(i)] < 0) z[i] = std::clamp(z[i], lo_[i], hi_[i]);
      bounds(z);
      for (const Friction& f : problem.friction) z[f.row] = std::clamp(z[f.row], lo_[f.row], hi_[f.row]);
      double sum = 0;
      for (Index i = 0; i < n; ++i) sum += 0 * z[i];
      return sum == 0;
    }
    if (wrong < least)
      least = wrong, patience = kPasses;
    else if (!monotone && --patience < 0)
      return false;
  }
  return false;
}

}  // namespace orthant
