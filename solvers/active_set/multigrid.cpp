#include <orthant/solvers/active_set/multigrid.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {

namespace {

// An unsymmetric problem has no form to decrease: a correction after which the violations are this often as large is
// not made.
constexpr double kWorse = 2;

/// `next` is scratch: of each row, the first entry that no row before has been compared with.
bool symmetric(const RowSparse& A, std::vector<int>& next) {
  next.assign(A.start.begin(), A.start.end());
  for (Index i = 0; i < A.rows; ++i) {
    bool equal = true;
    A.for_each_in_row(i, [&](Index j, double value) {
      int& k = next[at(j)];
      const int end = A.start[at(j) + 1];
      for (; k < end && A.column[at(k)] < i; ++k) equal = equal && A.value[at(k)] == 0;
      const double other = k < end && A.column[at(k)] == i ? A.value[at(k++)] : 0;
      equal = equal && std::abs(value - other) <= 1e-12 * std::max(std::abs(value), std::abs(other));
    });
    if (!equal) return false;
  }
  return true;
}

}  // namespace

std::string Multigrid::why_not(const Lcp& problem) const {
  if (!problem.friction.empty()) return "friction rows: the method needs bounds that do not depend on z";
  return detail::diagonal_why_not(problem.A, false);
}

void Multigrid::load(const Lcp& problem, Vector& z) {
  A_ = rows_of(problem.A, rows_);
  still_ = 0;
  symmetric_ = symmetric(*A_, next_);
  levels_.build(*A_, budget());
  const bool cold = z.lpNorm<Eigen::Infinity>() == 0;
  z = z.cwiseMax(problem.lo).cwiseMin(problem.hi);
  if (cold && options_.nested_cycles > 0 && levels_.count() > 1) nested(problem, z);
}

void Multigrid::nested(const Lcp& problem, Vector& z) {
  const std::size_t count = levels_.count();
  while (b_.size() < count) b_.emplace_back(), lo_.emplace_back(), hi_.emplace_back(), z_.emplace_back();
  const auto level = [&](std::size_t l) {
    return l == 0 ? Bounded{A_, &problem.b, &problem.lo, &problem.hi}
                  : Bounded{&levels_.matrix(l), &b_[l], &lo_[l], &hi_[l]};
  };
  for (std::size_t l = 1; l < count; ++l) {
    const Bounded fine = level(l - 1);
    const std::vector<int>& coarse = levels_.coarse(l - 1);
    levels_.restrict_to_coarse(l - 1, *fine.b, b_[l]);
    lo_[l].resize(b_[l].size()), hi_[l].resize(b_[l].size());
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const auto i = static_cast<Index>(k);
      lo_[l][i] = (*fine.lo)[coarse[k]], hi_[l][i] = (*fine.hi)[coarse[k]];
    }
  }
  z_[count - 1].resize(b_[count - 1].size());
  z_[count - 1].setZero();
  for (std::size_t l = count; l-- > 0;) {
    const Bounded p = level(l);
    Vector& here = l == 0 ? z : z_[l];
    if (l + 1 < count) levels_.interpolate(l, z_[l + 1], here);
    here = here.cwiseMax(*p.lo).cwiseMin(*p.hi);
    if (l == 0) break;
    for (int k = 0; k < options_.nested_cycles && !budget().exhausted(); ++k) cycle(l, p, here);
  }
  if (!z.allFinite()) {
    z.setZero();
    z = z.cwiseMax(problem.lo).cwiseMin(problem.hi);
  }
}

/// z_i ← clamp(z_i − w_i / A_ii, lo_i, hi_i) with the newest z. Returns the largest A_ii |change|.
double Multigrid::sweep(const Bounded& p, Vector& z, bool forward, bool& moved) const {
  const RowSparse& A = *p.A;
  const Index n = A.rows;
  double largest = 0;
  for (Index k = 0; k < n; ++k) {
    const Index i = forward ? k : n - 1 - k;
    double w = (*p.b)[i], d = 0;
    for (auto e = at(A.start[at(i)]); e < at(A.start[at(i) + 1]); ++e) {
      const Index j = A.column[e];
      w += A.value[e] * z[j];
      if (j == i) d = A.value[e];
    }
    if (!(d > 0)) continue;
    const double next = std::min(std::max(z[i] - w / d, (*p.lo)[i]), (*p.hi)[i]);
    const double change = std::abs(next - z[i]);
    moved = moved || change > 0;
    detail::raise(largest, d * change);
    z[i] = next;
  }
  return largest;
}

double Multigrid::correct(std::size_t level, const Bounded& p, Vector& z) {
  if (level + 1 >= levels_.count()) return 0;
  const RowSparse& A = *p.A;
  const Vector &lo = *p.lo, &hi = *p.hi;
  const Index n = A.rows;
  held_.resize(at(n));
  product_with(A, z, w_);
  w_ += *p.b;
  double before = 0;
  const auto miss = [&](Index i, double zi, double wi) {  // of natural residuals, in units of w
    return zi <= lo[i] ? std::min(wi, 0.0) : zi >= hi[i] ? std::max(wi, 0.0) : wi;
  };
  for (Index i = 0; i < n; ++i) {
    const bool held = (z[i] <= lo[i] && w_[i] >= 0) || (z[i] >= hi[i] && w_[i] <= 0);
    held_[at(i)] = held ? 1 : 0;
    if (const double v = miss(i, z[i], w_[i]); !symmetric_) before += v * v;
  }
  levels_.truncate(level, held_);
  levels_.correct(level, w_, c_);
  c_ = (z + c_).cwiseMax(lo).cwiseMin(hi) - z;
  product_with(A, c_, Ac_);
  double step = 1;
  if (symmetric_) {
    const double curvature = c_.dot(Ac_), slope = -w_.dot(c_);
    if (!(curvature > 0 && slope > 0)) return 0;
    step = slope / curvature;
    if (step > 1)
      for (Index i = 0; i < n; ++i)
        if (c_[i] != 0) step = std::max(1.0, std::min(step, ((c_[i] > 0 ? hi : lo)[i] - z[i]) / c_[i]));
    z = (z + step * c_).cwiseMax(lo).cwiseMin(hi);
  } else {
    double after = 0;
    for (Index i = 0; i < n; ++i) {
      const double v = miss(i, z[i] + c_[i], w_[i] + Ac_[i]);
      after += v * v;
    }
    if (!(after <= kWorse * kWorse * before)) return 0;
    z = (z + c_).cwiseMax(lo).cwiseMin(hi);
  }
  return step;
}

Multigrid::Step Multigrid::cycle(std::size_t level, const Bounded& p, Vector& z) {
  Step step;
  step.moved = false;
  sweep(p, z, true, step.moved);
  step.length = correct(level, p, z);
  step.violation = sweep(p, z, false, step.moved);
  step.moved = step.moved || step.length > 0;
  return step;
}

/// Ends where changes are those of rounding: a tolerance below that would take the cycles that are left.
Multigrid::Step Multigrid::advance(const Lcp& problem, Vector& z) {
  constexpr int kCycles = 4;
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();  // of the largest A_ii |z_i|
  Step step = cycle(0, {A_, &problem.b, &problem.lo, &problem.hi}, z);
  double size = 0;
  for (Index i = 0; i < z.size(); ++i) size = std::max(size, A_->entry(i, i) * std::abs(z[i]));
  still_ = step.violation <= kRounding * size ? still_ + 1 : 0;
  step.moved = step.moved && still_ < kCycles;
  return step;
}

}  // namespace orthant
