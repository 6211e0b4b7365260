#include <orthant/solvers/fine_rows.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kOwn = 1e-13;   // of a row's terms: what it may violate by
constexpr double kFormed = 7e7;  // products up to which an operator's entries are formed
constexpr int kRounds = 20, kSweeps = 50;
constexpr std::size_t kFew = 200;  // rows swept

}  // namespace

void FineRows::reserve(Index n) {
  if (in_.capacity() >= at(n)) return;
  in_.reserve(at(n)), friction_of_.reserve(at(n)), swept_.reserve(kFew);
  diagonal_.resize(n);
}

void FineRows::bounds(const Lcp& problem, Index i, const Vector& z, double& lo, double& hi) const {
  lo = problem.lo[i], hi = problem.hi[i];
  if (const Index f = friction_of_[at(i)]; f >= 0) {
    const Friction& friction = problem.friction[at(f)];
    hi = friction.mu * std::max(z[friction.normal], 0.0), lo = -hi;
  }
}

/// Whether row i violates by more than a share of its own terms; w_ ← w_i.
bool FineRows::violated(const Lcp& problem, Index i, const Vector& z) {
  long double w = problem.b[i], size = std::abs(problem.b[i]);
  const auto add = [&](double a, double x) {
    const long double term = static_cast<long double>(a) * x;
    w += term, size += std::abs(term);
  };
  if (dense_ != nullptr) {
    for (Index j = 0; j < z.size(); ++j)
      if (z[j] != 0) add((*dense_)(i, j), z[j]);
  } else {
    for (std::size_t k = at(rows_->start[at(i)]); k < at(rows_->start[at(i) + 1]); ++k)
      add(rows_->value[k], z[rows_->column[k]]);
  }
  w_ = w;
  double lo = 0, hi = 0;
  bounds(problem, i, z, lo, hi);
  if (lo == hi) return false;
  const long double by = z[i] <= lo ? std::max(-w, 0.0L) : z[i] >= hi ? std::max(w, 0.0L) : std::abs(w);
  return by > kOwn * size;
}

bool FineRows::settle(const Lcp& problem, const Vector& z, Vector& to) {
  const Index n = problem.size();
  if (problem.discs()) return false;
  dense_ = std::get_if<DenseMatrix>(&problem.A), rows_ = std::get_if<RowSparse>(&problem.A);
  if (const auto* delassus = std::get_if<Delassus>(&problem.A)) {
    if (!to_rows(*delassus, entries_, kFormed)) return false;
    rows_ = &entries_;
  }
  diagonal(problem.A, diagonal_);
  friction_of_.assign(at(n), -1);
  for (std::size_t k = 0; k < problem.friction.size(); ++k)
    friction_of_[at(problem.friction[k].first)] = static_cast<Index>(k);
  in_.assign(at(n), 0);
  swept_.clear();
  to.resize(n);
  to = z;
  for (int round = 0; round < kRounds; ++round) {
    bool more = false;
    for (Index i = 0; i < n; ++i) {
      if (!violated(problem, i, to)) continue;
      more = true;
      if (in_[at(i)] != 0) continue;
      if (!(diagonal_[i] > 0) || swept_.size() == kFew) return false;
      in_[at(i)] = 1;
      swept_.push_back(i);
    }
    if (!more) return round > 0;
    std::sort(swept_.begin(), swept_.end());
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool moved = false;
      for (const Index i : swept_) {
        if (!violated(problem, i, to)) continue;
        double lo = 0, hi = 0;
        bounds(problem, i, to, lo, hi);
        const double next = std::clamp(static_cast<double>(to[i] - w_ / diagonal_[i]), lo, hi);
        moved = moved || next != to[i];
        to[i] = next;
      }
      if (!moved) break;
    }
  }
  return true;
}

}  // namespace orthant
