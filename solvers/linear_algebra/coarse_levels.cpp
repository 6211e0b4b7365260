#include <orthant/solvers/linear_algebra/coarse_levels.h>

#include <algorithm>

namespace orthant {
namespace {

constexpr Index kCoarsest = 8;       // rows that sweeps alone solve
constexpr int kCoarsestSweeps = 16;  // of them, each forward and backward
constexpr std::size_t kMostLevels = 40;
constexpr double kStrong = 0.25;       // of the row's strongest coupling
constexpr double kHardlyFewer = 0.75;  // of the rows
constexpr int kOpen = -1, kFine = -2;

/// use(j, −a_ij) for the strong neighbours of row i.
template <class Use> void strong_neighbours(const RowSparse& A, Index i, const Use& use) {
  double most = 0;
  A.for_each_in_row(i, [&](Index j, double a) {
    if (j != i) most = std::max(most, -a);
  });
  if (!(most > 0)) return;
  A.for_each_in_row(i, [&](Index j, double a) {
    if (j != i && -a >= kStrong * most) use(j, -a);
  });
}

void transpose(const RowSparse& P, RowSparse& R) {
  R.rows = P.cols, R.cols = P.rows;
  R.start.assign(at(P.cols) + 1, 0);
  R.column.resize(P.column.size()), R.value.resize(P.value.size());
  for (const int j : P.column) ++R.start[at(j) + 1];
  for (std::size_t j = 0; j < at(P.cols); ++j) R.start[j + 1] += R.start[j];
  for (Index i = 0; i < P.rows; ++i)
    P.for_each_in_row(i, [&](Index j, double value) {
      const auto k = at(R.start[at(j)]++);
      R.column[k] = static_cast<int>(i), R.value[k] = value;
    });
  for (std::size_t j = at(P.cols); j > 0; --j) R.start[j] = R.start[j - 1];
  R.start[0] = 0;
}

/// x_i ← (r_i − Σ_j≠i T_ij x_j) / T_ii where T_ii > 0, T of the pattern of A.
void relax(const RowSparse& A, const std::vector<double>& T, const Vector& r, Vector& x, bool forward) {
  const Index n = A.rows;
  for (Index k = 0; k < n; ++k) {
    const Index i = forward ? k : n - 1 - k;
    double sum = r[i], d = 0;
    for (auto e = at(A.start[at(i)]); e < at(A.start[at(i) + 1]); ++e) {
      const Index j = A.column[e];
      if (j == i)
        d = T[e];
      else
        sum -= T[e] * x[j];
    }
    if (d > 0) x[i] = sum / d;
  }
}

}  // namespace

void product_with(const RowSparse& A, const Vector& x, Vector& y) {
  y.resize(A.rows);
  for (Index i = 0; i < A.rows; ++i) {
    double sum = 0;
    A.for_each_in_row(i, [&](Index j, double value) { sum += value * x[j]; });
    y[i] = sum;
  }
}

void CoarseLevels::restrict_to_coarse(std::size_t level, const Vector& fine, Vector& coarse) const {
  product_with(levels_[level].R, fine, coarse);
}

void CoarseLevels::interpolate(std::size_t level, const Vector& coarse, Vector& fine) const {
  product_with(levels_[level].P, coarse, fine);
}

std::size_t CoarseLevels::entries() const {
  std::size_t all = 0;
  for (std::size_t l = 0; l < count_; ++l) all += levels_[l].P.value.size() + (l > 0 ? levels_[l].A.value.size() : 0);
  return all;
}

void CoarseLevels::build(const RowSparse& A, const Budget& budget) {
  finest_ = &A, budget_ = &budget;
  fresh_ = true;
  count_ = 1;
  if (levels_.empty()) levels_.emplace_back();
  while (matrix(count_ - 1).rows > kCoarsest && count_ < kMostLevels && !budget.exhausted() && coarsen(count_ - 1)) {
    if (levels_.size() == count_) levels_.emplace_back();
    if (!product(count_ - 1, budget)) break;
    ++count_;
  }
  if (count_ == 1) levels_[0].P.value.clear();
}

/// False where the next level would hardly be smaller, or would be empty.
bool CoarseLevels::coarsen(std::size_t l) {
  const RowSparse& A = matrix(l);
  Level& level = levels_[l];
  std::vector<int>& place = level.place;
  place.assign(at(A.rows), kOpen);
  level.coarse.clear();
  for (Index i = 0; i < A.rows; ++i) {
    bool adjacent = place[at(i)] == kFine, alone = true;
    if (!adjacent)
      strong_neighbours(A, i, [&](Index j, double) {
        alone = false;
        adjacent = adjacent || place[at(j)] >= 0;
      });
    if (adjacent || alone) {
      place[at(i)] = kFine;
      continue;
    }
    place[at(i)] = static_cast<int>(level.coarse.size());
    level.coarse.push_back(static_cast<int>(i));
    strong_neighbours(A, i, [&](Index j, double) {
      if (place[at(j)] == kOpen) place[at(j)] = kFine;
    });
  }
  if (level.coarse.empty() || static_cast<double>(level.coarse.size()) > kHardlyFewer * static_cast<double>(A.rows))
    return false;
  interpolation(l);
  transpose(level.P, level.R);
  return true;
}

void CoarseLevels::interpolation(std::size_t l) {
  const RowSparse& A = matrix(l);
  Level& level = levels_[l];
  RowSparse& P = level.P;
  P.rows = A.rows, P.cols = static_cast<Index>(level.coarse.size());
  P.start.assign(1, 0), P.column.clear(), P.value.clear();
  for (Index i = 0; i < A.rows; ++i) {
    if (const int own = level.place[at(i)]; own >= 0) {
      P.column.push_back(own), P.value.push_back(1);
    } else {
      double all = 0, reached = 0, d = 0;
      A.for_each_in_row(i, [&](Index j, double a) { (j == i || a > 0 ? d : all) += j == i || a > 0 ? a : -a; });
      strong_neighbours(A, i, [&](Index j, double a) { reached += level.place[at(j)] >= 0 ? a : 0; });
      if (reached > 0 && d > 0)
        strong_neighbours(A, i, [&](Index j, double a) {
          if (const int c = level.place[at(j)]; c >= 0)
            P.column.push_back(c), P.value.push_back(a * all / (reached * d));
        });
    }
    P.start.push_back(static_cast<int>(P.column.size()));
  }
}

/// False where the budget is over, or where a random pattern fills in.
bool CoarseLevels::product(std::size_t l, const Budget& budget) {
  constexpr Index kPolled = 256;        // rows
  constexpr std::size_t kFilledIn = 4;  // times the entries of the finest level; on a grid each level has fewer
  const RowSparse& A = matrix(l);
  const RowSparse &P = levels_[l].P, &R = levels_[l].R;
  Level& next = levels_[l + 1];
  RowSparse& C = next.A;
  C.rows = C.cols = P.cols;
  C.start.assign(1, 0), C.column.clear(), C.value.clear();
  next.place.assign(at(C.rows), -1);
  for (Index row = 0; row < C.rows; ++row) {
    if (row % kPolled == 0 && (budget.exhausted() || C.value.size() > kFilledIn * finest_->value.size())) return false;
    const auto begin = C.column.size();
    R.for_each_in_row(row, [&](Index i, double) {
      A.for_each_in_row(i, [&](Index j, double) {
        P.for_each_in_row(j, [&](Index column, double) {
          int& place = next.place[at(column)];
          if (place < static_cast<int>(begin)) {
            place = static_cast<int>(C.column.size());
            C.column.push_back(static_cast<int>(column));
          }
        });
      });
    });
    std::sort(C.column.begin() + static_cast<std::ptrdiff_t>(begin), C.column.end());
    C.value.resize(C.column.size(), 0);
    for (std::size_t k = begin; k < C.column.size(); ++k) next.place[at(C.column[k])] = static_cast<int>(k);
    R.for_each_in_row(row, [&](Index i, double w) {
      A.for_each_in_row(i, [&](Index j, double a) {
        P.for_each_in_row(j, [&](Index column, double p) { C.value[at(next.place[at(column)])] += w * a * p; });
      });
    });
    C.start.push_back(static_cast<int>(C.column.size()));
  }
  return true;
}

void CoarseLevels::truncate(std::size_t level, const std::vector<char>& held) {
  if (level + 1 >= count_) return;
  const RowSparse& A = matrix(level);
  const bool all = fresh_ || truncated_ != level;
  std::vector<char>& dirty = levels_[level].dirty;
  dirty.assign(at(A.rows), all ? 1 : 0);
  bool any = all;
  if (!all) {
    for (Index i = 0; i < A.rows; ++i) {
      char& row = dirty[at(i)];
      A.for_each_in_row(i, [&](Index j, double) { row = static_cast<char>(row | (held[at(j)] ^ held_[at(j)])); });
      any = any || row != 0;
    }
  }
  fresh_ = false, truncated_ = level;
  held_ = held;
  for (std::size_t l = level; any && l + 1 < count_ && !budget_->exhausted(); ++l) truncated_product(l, l == level);
}

void CoarseLevels::truncated_product(std::size_t l, bool top) {
  const RowSparse& A = matrix(l);
  const Level& level = levels_[l];
  Level& next = levels_[l + 1];
  const RowSparse& C = next.A;
  next.T.resize(C.value.size());
  next.dirty.assign(at(C.rows), 0);
  next.place.resize(at(C.rows));
  for (Index row = 0; row < C.rows; ++row) {
    char& changed = next.dirty[at(row)];
    level.R.for_each_in_row(row, [&](Index i, double) { changed = static_cast<char>(changed | level.dirty[at(i)]); });
    if (changed == 0) continue;
    for (auto k = at(C.start[at(row)]); k < at(C.start[at(row) + 1]); ++k)
      next.T[k] = 0, next.place[at(C.column[k])] = static_cast<int>(k);
    level.R.for_each_in_row(row, [&](Index i, double w) {
      if (top && held_[at(i)] != 0) return;
      for (auto e = at(A.start[at(i)]); e < at(A.start[at(i) + 1]); ++e) {
        const Index j = A.column[e];
        if (top && held_[at(j)] != 0) continue;
        const double wa = w * (top ? A.value[e] : level.T[e]);
        level.P.for_each_in_row(j, [&](Index column, double p) { next.T[at(next.place[at(column)])] += wa * p; });
      }
    });
  }
}

void CoarseLevels::cycle(std::size_t l) {
  Level& level = levels_[l];
  const RowSparse& A = level.A;
  level.x.resize(A.rows);
  level.x.setZero();
  if (budget_->exhausted()) return;
  if (l + 1 == count_) {
    for (int k = 0; k < kCoarsestSweeps && !budget_->exhausted(); ++k)
      relax(A, level.T, level.r, level.x, true), relax(A, level.T, level.r, level.x, false);
    return;
  }
  relax(A, level.T, level.r, level.x, true);
  Level& next = levels_[l + 1];
  next.r.resize(next.A.rows);
  next.r.setZero();
  for (Index i = 0; i < A.rows; ++i) {
    double rest = level.r[i];
    for (auto e = at(A.start[at(i)]); e < at(A.start[at(i) + 1]); ++e) rest -= level.T[e] * level.x[A.column[e]];
    level.P.for_each_in_row(i, [&](Index j, double p) { next.r[j] += p * rest; });
  }
  cycle(l + 1);
  for (Index i = 0; i < A.rows; ++i)
    level.P.for_each_in_row(i, [&](Index j, double p) { level.x[i] += p * next.x[j]; });
  relax(A, level.T, level.r, level.x, false);
}

void CoarseLevels::correct(std::size_t level, const Vector& w, Vector& c) {
  const Index n = matrix(level).rows;
  c.resize(n);
  c.setZero();
  if (level + 1 >= count_) return;
  const Level& top = levels_[level];
  Level& next = levels_[level + 1];
  next.r.resize(next.A.rows);
  next.r.setZero();
  for (Index i = 0; i < n; ++i)
    if (held_[at(i)] == 0) top.P.for_each_in_row(i, [&](Index j, double p) { next.r[j] -= p * w[i]; });
  cycle(level + 1);
  for (Index i = 0; i < n; ++i)
    if (held_[at(i)] == 0) top.P.for_each_in_row(i, [&](Index j, double p) { c[i] += p * next.x[j]; });
}

}  // namespace orthant
