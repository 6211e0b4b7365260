// solvers/pivoting/lemke_tableau.h — Lemke's tableau: lexicographic ratio test (no cycles), pivots; any scalar type.
//
//   w = M z + q + d z₀ (d = e) as a dictionary: each basic variable = constant + Σ coefficient · nonbasic variable.
//   One row per basic variable: [constant | n + 1 coefficients], row-major. A pivot costs O(n²) and touches rows only;
//   in double from kDelayed rows on it is delayed (delayed_pivots.h), and only the constants, the entering column and
//   the leaving row are kept up to date.
//   Free rows go first: their z enters (complete pivoting) and their w leaves permanently. The rest of a singular free
//   block is split, z = z⁺ − z⁻ against ±w ≥ 0, which is an ordinary pair of complementary rows.
//   Ratio test: z₀ leaves first on ties; else the lexicographic rule (rows of the basis inverse, read off the tableau),
//   which cannot cycle. An entry that cancels to a few roundings of what it was is set to 0: in the degenerate problems
//   of contact mechanics such entries are zeros, and a pivot on one would amplify rounding errors.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.4, 4.9.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/linear_algebra/roundings.h>
#include <orthant/solvers/pivoting/delayed_pivots.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace orthant::detail {

template <class T> class Tableau {  // reuse it: the second problem of a size allocates nothing
 public:
  enum class End { solved, ray, limit, stopped, circle };  // circle: a basis came back, as rounding has broken ties

  /// Another covering vector than e for the loads that follow: d > 0 by row of the problem; empty: e again.
  void cover(const Vector& d) { cover_ = d; }

  /// Loads diag(row) M diag(col), diag(row) q; a row i with free[i] ≠ 0 has w_i = 0 and any z_i. stop() is polled
  /// at each pivot on free rows: once true, all that run() says is `stopped`.
  template <class Entries, class Stop> void load(const Entries& M, const Vector& q, const std::vector<char>& free,
                                                 const Vector& row, const Vector& col, const Stop& stop) {
    fill(M, q, free, row, col);
    if (pairs_ == n_ || eliminate(M, q, row, col, stop)) return;
    fill(M, q, free, row, col);
    for (int i = 0; i < n_; ++i)
      if (free_[u(i)]) split(i);
  }

  /// Lemke's method from the loaded tableau, at most `limit` pivots. After each, stop(z₀) is polled: true ends the run.
  template <class Stop> End run(int limit, const Stop& stop) {
    if (stopped_) return End::stopped;
    const int r = most_negative();
    if (r < 0) return End::solved;
    begin_delays();
    const End end = follow(r, limit, stop);
    end_delays();
    return end;
  }

  int iterations() const { return iterations_; }  // pivots of Lemke's method, z₀'s entry counted

  /// Basic z variables, after `solved`: for each, calls f(row of the problem, sign, value, row of the tableau).
  template <class F> void for_each_basic_z(F&& f) const {
    for (int r = 0; r < rows_; ++r)
      if (is_z(basic_[u(r)])) {
        const int pair = basic_[u(r)] - pairs_;
        f(origin_[u(pair)], sign(pair), row_at(r)[0], r);
      }
  }
  /// Nonbasic w variables: for each, calls f(row of the problem, sign, column of the tableau).
  template <class F> void for_each_nonbasic_w(F&& f) const {
    for (int s = 1; s < columns_; ++s)
      if (nonbasic_[u(s)] < pairs_) f(origin_[u(nonbasic_[u(s)])], sign(nonbasic_[u(s)]), s);
  }
  const T& entry(int r, int s) const { return row_at(r)[s]; }

  /// The direction of the ray, added into z (n entries, zero on entry).
  template <class Out> void ray(Out& z) const {
    const auto add = [&](int variable, const T& value) {
      if (!is_z(variable)) return;
      const int pair = variable - pairs_;
      z[origin_[u(pair)]] += static_cast<double>(sign(pair)) * static_cast<double>(value);
    };
    add(nonbasic_[u(entering_)], T(1));
    for (int r = 0; r < rows_; ++r) add(basic_[u(r)], row_at(r)[entering_]);
  }

 private:
  static std::size_t u(int i) { return static_cast<std::size_t>(i); }
  static T abs(T x) { return magnitude(x); }
  template <class V> static void grow(V& v, std::size_t size) {
    if (v.size() < size) v.resize(size);
  }
  // Variables: w of pair i is i, z of pair i is pairs_ + i, and z₀ comes last.
  int w_of(int pair) const { return pair; }
  int z_of(int pair) const { return pairs_ + pair; }
  int z0() const { return 2 * pairs_; }
  bool is_z(int variable) const { return variable >= pairs_ && variable != z0(); }
  int complement(int variable) const { return variable < pairs_ ? variable + pairs_ : variable - pairs_; }
  int sign(int pair) const { return pair >= n_ ? -1 : 1; }
  T* row_at(int r) { return t_.data() + static_cast<std::ptrdiff_t>(r) * stride_; }
  const T* row_at(int r) const { return t_.data() + static_cast<std::ptrdiff_t>(r) * stride_; }
  // place_: row of a basic variable as −1 − row, column of a nonbasic one as column ≥ 1.
  void set_basic(int r, int variable) { basic_[u(r)] = variable, place_[u(variable)] = -1 - r; }
  void set_nonbasic(int s, int variable) { nonbasic_[u(s)] = variable, place_[u(variable)] = s; }

  /// 64 random-looking bits of a variable (splitmix64).
  static std::uint64_t key_of(int variable) {
    std::uint64_t x = static_cast<std::uint64_t>(variable + 1) * 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
  }

  /// From z₀'s entry in row r on.
  template <class Stop> End follow(int r, int limit, const Stop& stop) {
    enter(covering_);
    std::uint64_t basis = 0,
                  met = 0;  // sums of keys of the variables; met: Brent's, of twice as late a pivot each time
    for (int next = 64;;) {
      if (iterations_ >= limit) return End::limit;
      const int leaving = basic_[u(r)];
      basis ^= key_of(leaving) ^ key_of(nonbasic_[u(entering_)]);
      exchange(r);
      ++iterations_;
      if (leaving == z0()) return End::solved;
      if (basis == met) return End::circle;
      if (iterations_ == next) met = basis, next *= 2;
      if (stop(constant(-1 - place_[u(z0())]))) return End::stopped;
      enter(place_[u(complement(leaving))]);
      r = ratio_test();
      if (r < 0) return End::ray;
    }
  }

  /// In double what does not fit is infinite, and the run ends nowhere; a rational could not even hold it.
  static T scaled(double value, double row, double col) {
    if constexpr (std::is_same_v<T, double>)
      return value * row * col;
    else
      return T(value) * T(row) * T(col);
  }

  template <class Entries>
  void fill(const Entries& M, const Vector& q, const std::vector<char>& free, const Vector& row, const Vector& col) {
    n_ = static_cast<int>(q.size());
    free_.assign(free.begin(), free.end());
    const int free_rows = static_cast<int>(std::count(free.begin(), free.end(), char{1}));
    pairs_ = n_ + free_rows;  // room for splitting every free row
    rows_ = split_end_ = n_;
    columns_ = n_ + 2;
    stride_ = pairs_ + 2;
    iterations_ = entering_ = 0;
    top_ = 0;
    stopped_ = false;
    const auto size = static_cast<std::size_t>(stride_);
    for (auto* v : {&basic_, &nonbasic_, &origin_, &list_}) grow(*v, size);
    grow(place_, 2 * size), grow(frozen_, size), grow(paired_, size), grow(ratio_, size), grow(given_, size),
        grow(error_, size), grow(t_, size * size);
    for (int i = 0; i < n_; ++i) {
      row_at(i)[0] = scaled(q[i], row[i], 1);
      given_[u(i)] = abs(row_at(i)[0]);
      error_[u(i)] = 0;
      top_ = std::max(top_, given_[u(i)]);
      row_at(i)[covering_] = free_[u(i)] ? T(0) : cover_of(i);  // z₀ covers complementary rows only
      set_basic(i, w_of(i));
      set_nonbasic(i + 2, z_of(i));
      origin_[u(i)] = i;
      frozen_[u(i)] = 0;
      paired_[u(i)] = !free_[u(i)];
    }
    set_nonbasic(covering_, z0());
    nonbasic_[0] = -1;  // the constant
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i) row_at(i)[j + 2] = scaled(M(i, j), row[i], col[j]);
  }

  void pivot(int r, int s) {
    T* const p = row_at(r);
    const T divisor = p[s];
    for (int c = 0; c < columns_; ++c) p[c] = -p[c] / divisor;
    p[s] = T(1) / divisor;
    const T error = error_[u(r)] = error_[u(r)] / abs(divisor) + Roundings<T>::unit * abs(p[0]);
    for (int i = 0; i < rows_; ++i) {
      if (i == r) continue;
      T* const line = row_at(i);
      const T f = line[s];
      if (f == 0) continue;
      error_[u(i)] += abs(f) * error + Roundings<T>::unit * (abs(line[0]) + abs(f * p[0]));
      add_multiple(line, f, p, columns_);
      line[s] = f / divisor;
    }
    swap(r, s);
  }
  // Delayed pivots: row_at(i) is what it was some pivots ago, until finish_row(i); the constants are in
  // delays_.constant.
  static constexpr bool kDelays = std::is_same_v<T, double>;
  struct Delays {
    bool on = false;
    std::vector<double> column, constant;  // the entering column; constants
    DelayedPivots pivots;
  };
  void begin_delays() {
    if constexpr (kDelays) {
      grow(delays_.column, u(stride_)), grow(delays_.constant, u(stride_));
      delays_.on = rows_ >= kDelayed;
      if (!delays_.on) return;
      for (int i = 0; i < rows_; ++i) delays_.constant[u(i)] = row_at(i)[0];
      delays_.pivots.reset(rows_, columns_, t_.data(), stride_, Roundings<T>::snap);
    }
  }
  void end_delays() {
    if constexpr (kDelays) {
      if (!delays_.on) return;
      delays_.pivots.finish();
      for (int i = 0; i < rows_; ++i) row_at(i)[0] = delays_.constant[u(i)];
      delays_.on = false;
    }
  }
  const T& constant(int i) const {
    if constexpr (kDelays)
      if (delays_.on) return delays_.constant[u(i)];
    return row_at(i)[0];
  }
  void finish_row(int i) {
    if constexpr (kDelays)
      if (delays_.on) delays_.pivots.finish_row(i);
  }
  void enter(int s) {
    entering_ = s;
    if constexpr (kDelays) {
      if (delays_.on) return delays_.pivots.column(s, delays_.column.data());
      for (int i = 0; i < rows_; ++i) delays_.column[u(i)] = row_at(i)[s];
    }
  }
  /// Of the entering column.
  const T& slope(int i) const {
    if constexpr (kDelays)
      return delays_.column[u(i)];
    else
      return row_at(i)[entering_];
  }

  /// The entering variable for that of row r.
  void exchange(int r) {
    if constexpr (kDelays)
      if (delays_.on) return exchange_later(r);
    pivot(r, entering_);
  }
  void exchange_later(int r) {
    const int s = entering_;
    double* const column = delays_.column.data();
    double* const constants = delays_.constant.data();
    delays_.pivots.finish_row(r);
    T* const p = row_at(r);
    const T divisor = p[s];
    for (int c = 1; c < columns_; ++c) p[c] = -p[c] / divisor;
    p[0] = 0;  // the constants are kept apart
    const T moved = constants[r] = -constants[r] / divisor;
    const T error = error_[u(r)] = error_[u(r)] / abs(divisor) + Roundings<T>::unit * abs(moved);
    column[r] = 0;
    for (int i = 0; i < rows_; ++i) {
      const T f = column[i];
      row_at(i)[s] = f / divisor;
      if (f == 0) continue;
      error_[u(i)] += abs(f) * error + Roundings<T>::unit * (abs(constants[i]) + abs(f * moved));
      const T before = constants[i], after = before + f * moved;
      constants[i] = abs(after) <= Roundings<T>::snap * abs(before) ? T(0) : after;
    }
    delays_.pivots.keep(column, p, s);
    p[s] = T(1) / divisor;
    swap(r, s);
  }
  /// The variables of row r and column s change places.
  void swap(int r, int s) {
    const int leaving = basic_[u(r)];
    set_basic(r, nonbasic_[u(s)]);
    set_nonbasic(s, leaving);
  }
  T cover_of(int i) const { return cover_.size() > i ? static_cast<T>(cover_[i]) : T(1); }

  // The row that z₀ replaces: the lexicographically least (q_i, e_i) / d_i, that is the last among equals; −1: q ≥ 0.
  int most_negative() const {
    int r = -1;
    T least = 0;
    for (int i = 0; i < rows_; ++i) {
      if (frozen_[u(i)] || !(row_at(i)[0] < 0)) continue;
      const T ratio = row_at(i)[0] / row_at(i)[covering_];
      if (ratio <= least) least = ratio, r = i;  // given data: equal means equal
    }
    return r;
  }

  int ratio_test() {
    T largest = 0;
    for (int i = 0; i < rows_; ++i)
      if (!frozen_[u(i)]) largest = std::max(largest, abs(slope(i)));
    const T tiny = largest * Roundings<T>::pivot;
    const int z0_row = -1 - place_[u(z0())];
    int count = 0;
    T least = 0;
    for (int i = 0; i < rows_; ++i) {
      const T fall = -slope(i);
      if (!(fall > tiny) || frozen_[u(i)]) continue;
      const T q = constant(i), ratio = q > 0 ? q / fall : T(0);
      ratio_[u(count)] = ratio;
      list_[u(count)] = i;
      least = count == 0 ? ratio : std::min(least, ratio);
      ++count;
    }
    if (count == 0) return -1;
    const auto blur = [&](int i) { return 8 * error_of_constant(i) / -slope(i); };  // of the ratio; overlap: a tie
    const T near = least * (T(1) + T(0x1p-12)), small = top_ * T(0x1p-20);
    T limit = least;
    int ties = 0;
    for (int k = 0; k < count; ++k)  // few are near: only those are looked at closely
      if (ratio_[u(k)] <= near || constant(list_[u(k)]) <= small) {
        list_[u(ties)] = list_[u(k)];
        ratio_[u(ties++)] = ratio_[u(k)];
      }
    if (ties == 1) return list_[0];
    for (int k = 0; k < ties; ++k)
      if (ratio_[u(k)] == least) limit = std::max(limit, least + blur(list_[u(k)]));
    count = ties;
    ties = 0;
    for (int k = 0; k < count; ++k) {
      if (ratio_[u(k)] > limit && ratio_[u(k)] - blur(list_[u(k)]) > limit) continue;
      if (list_[u(k)] == z0_row) return z0_row;
      list_[u(ties++)] = list_[u(k)];
    }
    for (int k = 0; k < ties && ties > 1; ++k) finish_row(list_[u(k)]);
    for (int pair = 0; pair < split_end_ && ties > 1; ++pair) {  // columns of the basis inverse, one after the other
      if (!paired_[u(pair)]) continue;
      const int place = place_[u(w_of(pair))];
      T lowest = 0;
      for (int k = 0; k < ties; ++k) {
        const T entry = slope(list_[u(k)]);
        const T value = place > 0                   ? row_at(list_[u(k)])[place] / entry
                        : list_[u(k)] == -1 - place ? T(-1) / entry
                                                    : T(0);
        ratio_[u(k)] = value;
        lowest = k == 0 ? value : std::min(lowest, value);
      }
      int kept = 0;
      for (int k = 0; k < ties; ++k)
        if (ratio_[u(k)] - lowest <= Roundings<T>::tie * std::max(abs(ratio_[u(k)]), abs(lowest)))
          list_[u(kept++)] = list_[u(k)];
      ties = kept;
    }
    return list_[0];
  }
  // Bound of the rounding error of row i's constant: the running bound, which compounds over many pivots and is then
  // cut at a share of Σ_j |B⁻¹_ij q_j|, the terms that the constant is the sum of.
  T error_of_constant(int i) {
    const T bound = error_[u(i)];
    if (bound <= Roundings<T>::tie * abs(constant(i))) return bound;
    finish_row(i);
    const T* const line = row_at(i);
    T size = basic_[u(i)] < pairs_ ? given_[u(basic_[u(i)])] : T(0);
    for (int c = 1; c < columns_; ++c)
      if (nonbasic_[u(c)] < pairs_) size += abs(line[c]) * given_[u(nonbasic_[u(c)])];
    return std::min(bound, Roundings<T>::tie * size);
  }

  // Free rows, in tableau_free_rows.h.
  template <class Entries, class Stop>
  bool eliminate(const Entries& M, const Vector& q, const Vector& row, const Vector& col, const Stop& stop);
  template <class Entries> void clean(int i, const Entries& M, const Vector& q, const Vector& row, const Vector& col);
  void split(int i);

  static constexpr int covering_ = 1;  // the column of z₀ at the start
  static constexpr int kDelayed = 48;  // rows; below, a pivot at once is as fast
  int n_ = 0, pairs_ = 0, split_end_ = 0, rows_ = 0, columns_ = 0, stride_ = 0, iterations_ = 0, entering_ = 0;
  bool stopped_ = false;
  Vector cover_;
  T top_ = 0;                                  // max |q|
  std::vector<T> t_, ratio_, given_, error_;   // given_: |q| of a pair; error_: rounding of a row's constant
  std::vector<int> basic_, nonbasic_, place_;  // variable of a row, of a column; place of a variable
  std::vector<int> origin_, list_;             // row of the problem that a pair belongs to; candidates of a ratio test
  std::vector<char> free_, frozen_, paired_;   // row of the problem is free; row of the tableau takes no part in ratio
                                               // tests; pair is complementary
  struct None {};
  [[no_unique_address]] std::conditional_t<kDelays, Delays, None> delays_;
};

}  // namespace orthant::detail

#include <orthant/solvers/pivoting/tableau_free_rows.h>
