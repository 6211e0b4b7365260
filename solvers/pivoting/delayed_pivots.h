// solvers/pivoting/delayed_pivots.h — delayed pivots: the last pivots of a tableau, carried out together.
//
//   A pivot adds f pᵀ to the tableau T (rows × columns, by rows): all of T passes through memory for two operations an
//   entry. The pairs (f_q, p_q), q < count(), are stored instead; the method requests one column and one row of
//     T + Σ_q f_q p_qᵀ
//   a pivot, O((rows + columns) count()). After kMost pivots T is brought up to date in one pass, each entry with all
//   of its terms while it is in a register, in the order of the pivots. Entries that cancel to noise on the way become
//   0, in a column, a row and the whole alike, so that all three have the same numbers.
//   At n = 1024 a pivot takes a fourth of the time that it takes at once (experiments/time_per_pivot).
//   Source: the product form of the inverse, as in Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch.
//   4.
#pragma once

#include <orthant/solvers/linear_algebra/kernels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace orthant::detail {

class DelayedPivots {  // reuse it: the second tableau of a size allocates nothing
 public:
  static constexpr int kMost = 32;

  /// For a tableau whose row i begins at t + i stride.
  void reset(int rows, int columns, double* t, std::ptrdiff_t stride, double snap) {
    rows_ = rows, columns_ = columns, t_ = t, stride_ = stride, snap_ = snap, count_ = 0;
    const auto grow = [](std::vector<double>& v, std::ptrdiff_t size) {
      if (static_cast<std::ptrdiff_t>(v.size()) < size) v.resize(static_cast<std::size_t>(size));
    };
    grow(f_, std::ptrdiff_t{kMost} * rows), grow(p_, std::ptrdiff_t{kMost} * columns), grow(idle_, 3 * columns);
  }

  int count() const { return count_; }

  /// out ← column s, `rows` entries.
  void column(int s, double* out) const {
    std::array<double, kMost> factor;
    std::array<const double*, kMost> term;
    for (int q = 0; q < count_; ++q) factor[u(q)] = p(q)[s], term[u(q)] = f(q);
    for (int i = 0; i < rows_; ++i) out[i] = t_[i * stride_ + s];
    add_multiples(out, factor.data(), term.data(), count_, rows_, snap_);
  }

  /// Brings row i of the tableau up to date for later reads.
  void finish_row(int i) {
    std::array<double, kMost> factor;
    std::array<const double*, kMost> term;
    int some = 0;
    for (int q = 0; q < count_; ++q) {
      double& each = f(q)[i];
      if (each == 0) continue;
      factor[u(some)] = each, term[u(some++)] = p(q);
      each = 0;
    }
    if (some > 0) add_multiples(t_ + i * stride_, factor.data(), term.data(), some, columns_, snap_);
  }

  /// One more pivot: f (`rows` entries) and p (`columns` entries). Data kept aside for column s is dropped: the
  /// caller has written that column again, this pivot included.
  void keep(const double* factors, const double* row, int s) {
    std::copy_n(factors, rows_, f(count_));
    std::copy_n(row, columns_, p(count_));
    largest_[u(count_)] = largest(row, columns_);
    ++count_;
    for (int q = 0; q < count_; ++q) p(q)[s] = 0;
    if (count_ == kMost) finish();
  }

  /// Brings the whole tableau up to date.
  void finish() {
    if (count_ == 0) return;
    std::array<double, 4 * kMost> factor;
    std::array<const double*, kMost> term;
    for (int i = 0; i < rows_; i += 4) {
      const int rows = std::min(4, rows_ - i);
      std::array<double*, 4> line;
      std::array<double, 4> reach{};
      for (int r = 0; r < 4; ++r) line[u(r)] = r < rows ? t_ + (i + r) * stride_ : idle_.data() + (r - 1) * columns_;
      int some = 0;
      for (int q = 0; q < count_; ++q) {
        bool any = false;
        for (int r = 0; r < 4; ++r) {
          const double each = r < rows ? f(q)[i + r] : 0;
          factor[u(4 * some + r)] = each;
          reach[u(r)] += std::abs(each) * largest_[u(q)];
          any = any || each != 0;
        }
        if (any) term[u(some++)] = p(q);
      }
      if (some > 0) add_multiples_to_four(line.data(), factor.data(), term.data(), some, columns_, snap_, reach.data());
    }
    count_ = 0;
  }

 private:
  static std::size_t u(int i) { return static_cast<std::size_t>(i); }
  double* f(int q) { return f_.data() + std::ptrdiff_t{q} * rows_; }
  double* p(int q) { return p_.data() + std::ptrdiff_t{q} * columns_; }
  const double* f(int q) const { return f_.data() + std::ptrdiff_t{q} * rows_; }
  const double* p(int q) const { return p_.data() + std::ptrdiff_t{q} * columns_; }

  int rows_ = 0, columns_ = 0, count_ = 0;
  double* t_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  double snap_ = 0;
  std::vector<double> f_, p_, idle_;   // by pivots; three rows of zeros
  std::array<double, kMost> largest_;  // max |p_q|
};

}  // namespace orthant::detail
