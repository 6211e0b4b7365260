// solvers/pivoting/principal_tableau.h — condensed tableau of principal pivoting, in any scalar type.
//
//   w = A z + b as a dictionary whose row i and column i belong to pair i: one of (z_i, w_i) is basic, the other is
//   not, Δ basic_i = Σ_j T_ij Δ nonbasic_j. At the start every z_i is nonbasic, on its bound nearest to 0 or at 0.
//     pivot(i)        z_i and w_i change places:                          needs T_ii ≠ 0.  O(n²)
//     exchange(i, k)  two pairs do, where the diagonal is zero:           needs T_ik T_ki ≠ 0.  O(n²)
//     move(k, t)      nonbasic k moves by t and every basic one with it.  O(n)
//   so that F = { i : in[i] } has a nonsingular A_FF, whose inverse is T_FF: refined_basis.h makes z of it.
//   An entry or a value that cancels to a few roundings of what it was is set to 0.
//   Source: Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 2.3, 4.1.
#pragma once

#include <orthant/solvers/linear_algebra/scalars.h>

#include <utility>
#include <vector>

namespace orthant::detail {

template <class T> class PrincipalTableau {  // reuse it: the second problem of a size allocates nothing
 public:
  std::vector<char> in;            // z_i is basic
  std::vector<T> z, w, low, high;  // values and bounds, scaled
  int iterations = 0;              // pivots, an exchange counted as one

  /// Loads diag(row) A diag(col), diag(row) b and the bounds of z / col; rows without friction.
  void load(const DenseMatrix& A, const Lcp& p, const Vector& row, const Vector& col) {
    n_ = static_cast<int>(p.size());
    const auto n = static_cast<std::size_t>(n_);
    in.assign(n, 0);
    for (auto* v : {&z, &w, &low, &high, &size_, &reach_}) v->resize(n);
    t_.resize(n * n);
    iterations = 0;
    noise_floor_ = 0;
    for (int i = 0; i < n_; ++i) {
      low[u(i)] = static_cast<T>(p.lo[i] / col[i]), high[u(i)] = static_cast<T>(p.hi[i] / col[i]);
      z[u(i)] = std::min(std::max(T(0), low[u(i)]), high[u(i)]);
      if (low[u(i)] < z[u(i)] && z[u(i)] < high[u(i)] && !free(i))
        z[u(i)] = p.lo[i] == -kInf || (p.hi[i] < -p.lo[i]) ? high[u(i)] : low[u(i)];
      w[u(i)] = static_cast<T>(p.b[i] * row[i]);
      size_[u(i)] = abs(w[u(i)]);
      reach_[u(i)] = abs(z[u(i)]);
    }
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i) {
        at(i, j) = static_cast<T>(A(i, j) * row[i] * col[j]);
        noise_floor_ = std::max(noise_floor_, Roundings<T>::pivot * abs(at(i, j)));
        const T term = at(i, j) * z[u(j)];
        w[u(i)] += term;
        size_[u(i)] = std::max(size_[u(i)], abs(term));
      }
  }

  int size() const { return n_; }
  T& at(int i, int j) { return t_[u(i) * u(n_) + u(j)]; }
  const T& at(int i, int j) const { return t_[u(i) * u(n_) + u(j)]; }
  bool free(int i) const { return low[u(i)] == T(-kInf) && high[u(i)] == T(kInf); }
  /// Nonbasic z_i that is on neither bound (free rows; a driving variable on its way): w_i = 0 is then required.
  bool loose(int i) const { return low[u(i)] < z[u(i)] && z[u(i)] < high[u(i)]; }
  /// Bound of the rounding error of w_i.
  T noise(int i) const { return 8 * Roundings<T>::snap * size_[u(i)]; }

  /// w_i has a sign that z_i does not allow.
  bool wrong(int i) const {
    const T value = w[u(i)], blur = noise(i);
    if (in[u(i)]) return value != 0;
    if (loose(i)) return abs(value) > blur;
    return (value < -blur && z[u(i)] < high[u(i)]) || (value > blur && z[u(i)] > low[u(i)]);
  }

  /// z_i breaks a bound.
  bool outside(int i) const {
    const T value = z[u(i)], blur = 8 * Roundings<T>::snap * reach_[u(i)];
    return value < low[u(i)] - blur || value > high[u(i)] + blur;
  }

  void move(int k, T step) {
    if (step == 0) return;
    (in[u(k)] ? w : z)[u(k)] += step;
    for (int i = 0; i < n_; ++i) {
      const T change = at(i, k) * step;
      T& value = (in[u(i)] ? z : w)[u(i)];
      const T before = value;
      value += change;
      if (abs(value) <= Roundings<T>::snap * abs(before)) value = 0;
      T& largest = (in[u(i)] ? reach_ : size_)[u(i)];
      largest = std::max({largest, abs(change), abs(value)});
    }
  }

  /// z_i and w_i change places; the one that becomes nonbasic is first put at `value` (0, or a bound of z_i).
  void pivot(int i, T value) {
    settle(i, value);
    swap_roles(i, i);
    in[u(i)] ^= 1;
    ++iterations;
  }
  /// Pairs i and k change places together; i's basic variable ends at `value`, k's where it is.
  void exchange(int i, int k, T value) {
    settle(i, value);
    swap_roles(i, k);
    swap_roles(k, i);
    for (int c = 0; c < n_; ++c) std::swap(at(i, c), at(k, c));
    for (int c = 0; c < n_; ++c) std::swap(at(c, i), at(c, k));
    in[u(i)] ^= 1, in[u(k)] ^= 1;
    ++iterations;
  }

  /// w = 0 on all free rows, by principal and exchange pivots, largest first. False when their block is singular, or
  /// stop(), polled at each pivot, is true.
  template <class Stop> bool release_free(const Stop& stop) {
    for (;;) {
      int i = -1, k = -1;
      T best = 0;
      bool open = false;
      for (int r = 0; r < n_; ++r)
        for (int c = r; c < n_ && free(r) && !in[u(r)]; ++c) {
          if (!free(c) || in[u(c)]) continue;
          open = true;
          const T size = r == c ? abs(at(r, r)) : std::min(abs(at(r, c)), abs(at(c, r))) / 2;  // 2: rather a single one
          if (size > best && size > noise_floor_) best = size, i = r, k = c;
        }
      if (!open) return true;
      if (i < 0 || stop()) return false;
      if (i == k) {
        move(i, -w[u(i)] / at(i, i));
        pivot(i, T(0));
      } else {
        const T det = at(i, i) * at(k, k) - at(i, k) * at(k, i);
        if (det == 0) return false;
        const T wi = w[u(i)], wk = w[u(k)];
        move(i, (at(i, k) * wk - at(k, k) * wi) / det);
        move(k, (at(k, i) * wi - at(i, i) * wk) / det);
        exchange(i, k, T(0));
        w[u(k)] = 0;
      }
    }
  }

  static T abs(T x) { return magnitude(x); }

 private:
  static std::size_t u(int i) { return static_cast<std::size_t>(i); }
  void settle(int i, T value) { (in[u(i)] ? z : w)[u(i)] = value; }

  // The basic variable of row r and the nonbasic one of column s change places.
  void swap_roles(int r, int s) {
    T* const p = &at(r, 0);
    const T divisor = p[s];
    for (int c = 0; c < n_; ++c) p[c] = -p[c] / divisor;
    p[s] = T(1) / divisor;
    for (int i = 0; i < n_; ++i) {
      T* const line = &at(i, 0);
      const T f = line[s];
      if (i == r || f == 0) continue;
      add_multiple(line, f, p, n_);
      line[s] = f / divisor;
    }
  }

  int n_ = 0;
  T noise_floor_ = 0;                // what lies below is no pivot
  std::vector<T> t_, size_, reach_;  // the largest terms that w_i and z_i were sums of
};

/// The same problem in three precisions, each loaded only when it is needed.
struct PrincipalTableaus {
  PrincipalTableau<double> first;
  PrincipalTableau<long double> second;
  PrincipalTableau<Float256> third;
  /// f(tableau) of attempt 0, 1, 2.
  template <class F> auto visit(int attempt, F&& f) {
    return attempt == 0 ? f(first) : attempt == 1 ? f(second) : f(third);
  }
};

}  // namespace orthant::detail
