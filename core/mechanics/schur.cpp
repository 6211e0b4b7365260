#include <orthant/core/mechanics/schur.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace orthant {
namespace {

/// f(n), with n known to the compiler where it is small.
template <class F> decltype(auto) with_size(int n, F&& f) {
  static_assert(Schur::kUnrolled == 8);
  switch (n) {
    case 1:
      return f(std::integral_constant<int, 1>{});
    case 2:
      return f(std::integral_constant<int, 2>{});
    case 3:
      return f(std::integral_constant<int, 3>{});
    case 4:
      return f(std::integral_constant<int, 4>{});
    case 5:
      return f(std::integral_constant<int, 5>{});
    case 6:
      return f(std::integral_constant<int, 6>{});
    case 7:
      return f(std::integral_constant<int, 7>{});
    case 8:
      return f(std::integral_constant<int, 8>{});
    default:
      return f(n);
  }
}

/// f(0), f(1) … f(n − 1), or the other way round: written out where n is known.
template <int N, class F> void each(std::integral_constant<int, N>, F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) { (f(std::integral_constant<int, i>{}), ...); }
  (std::make_integer_sequence<int, N>{});
}
template <int N, class F> void each_down(std::integral_constant<int, N>, F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) { (f(std::integral_constant<int, N - 1 - i>{}), ...); }
  (std::make_integer_sequence<int, N>{});
}
template <class F> void each(int n, F&& f) {
  for (int i = 0; i < n; ++i) f(i);
}
template <class F> void each_down(int n, F&& f) {
  for (int i = n - 1; i >= 0; --i) f(i);
}

/// Numbers to work on: a copy where their count is known, which the compiler keeps in registers; else where they are.
template <int Count> struct Local {
  double value[static_cast<std::size_t>(Count)];
  explicit Local(const double* from) { std::copy_n(from, Count, value); }
  void store(double* to) const { std::copy_n(value, Count, to); }
  double& operator[](int i) { return value[i]; }
};
struct InPlace {
  double* value;
  void store(double*) const {}
  double& operator[](int i) const { return value[i]; }
};
template <int N> Local<N * N> square(std::integral_constant<int, N>, double* from) { return Local<N * N>(from); }
InPlace square(int, double* from) { return {from}; }
template <int N> Local<N> line(std::integral_constant<int, N>, double* from) { return Local<N>(from); }
InPlace line(int, double* from) { return {from}; }

}  // namespace

Schur::Schur(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows)
    : n_(static_cast<int>(rows.size())),
      inverse_mass_(inverse_mass),
      g_(6 * rows.size()),
      h_(6 * rows.size()),
      weight_(6 * rows.size()),
      S_(rows.size() * rows.size()),
      pivot_(rows.size()),
      inverse_pivot_(rows.size()) {
  for (int i = 0; i < n_; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    for (int side = 0; side < 2; ++side)
      if (const BodyId body = side == 0 ? row.a : row.b; body >= 0) {
        const int at = 6 * i + 3 * side;
        for (int k = 0; k < 3; ++k) weight_[static_cast<std::size_t>(at + k)] = inverse_mass[3 * body + k];
        sides_.push_back({i, at, 3 * body});
      }
  }
  for (const Side& u : sides_)
    for (const Side& v : sides_)
      if (u.first == v.first && v.row <= u.row) shared_.push_back({u.row * n_ + v.row, u.at, v.at});
}

bool Schur::factorize(std::span<const Row> G, double dependent) {
  double *g = g_.data(), *h = h_.data();
  for (const Row& row : G) {
    std::copy_n(row.ja.data(), 3, g), std::copy_n(row.jb.data(), 3, g + 3);
    const double* weight = weight_.data() + (g - g_.data());
    for (int k = 0; k < 6; ++k) h[k] = weight[k] * g[k];
    g += 6, h += 6;
  }
  g = g_.data(), h = h_.data();
  double* S = S_.data();
  std::fill(S_.begin(), S_.end(), 0.0);
  for (const Shared& s : shared_) {
    const double *u = g + s.g, *v = h + s.h;
    S[s.at] += u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  }
  return with_size(n_, [&](auto n) { return factorize_rows(n, dependent); });
}

/// Row by row: y_j = S_ij − Σ_k y_k L_jk, L_ij = y_j / D_j, D_i = S_ii − Σ_j y_j L_ij.
template <class N> bool Schur::factorize_rows(N n, double dependent) {
  auto S = square(n, S_.data());
  auto inverse = line(n, inverse_pivot_.data());
  auto pivot = line(n, pivot_.data());
  bool independent = true;
  each(n, [&](auto i) {
    const double whole = S[i * n + i];
    double left = whole;
    each(i, [&](auto j) { each(j, [&](auto k) { S[i * n + j] -= S[i * n + k] * S[j * n + k]; }); });
    each(i, [&](auto j) {
      const double y = S[i * n + j];
      S[i * n + j] = y * inverse[j];
      left -= y * S[i * n + j];
    });
    const bool holds = left > dependent * whole && left < std::numeric_limits<double>::infinity();  // false of NaN
    independent &= holds;
    pivot[i] = left, inverse[i] = holds ? 1 / left : 0;  // 0: what follows stays finite, for finite()
  });
  if (!independent) return false;
  S.store(S_.data()), inverse.store(inverse_pivot_.data()), pivot.store(pivot_.data());
  return true;
}

bool Schur::finite() const {
  return std::all_of(S_.begin(), S_.end(), [](double s) { return std::isfinite(s); });
}

double Schur::independence() const {
  double least = 1;
  for (std::size_t i = 0; i < pivot_.size(); ++i) least = std::min(least, pivot_[i] / S_[i * (pivot_.size() + 1)]);
  return least;
}

void Schur::solve(const double* f, const double* c, double* x, double* lambda) const {
  for (Eigen::Index k = 0; k < inverse_mass_.size(); ++k) x[k] = inverse_mass_[k] * f[k];
  if (lambda != c) std::copy_n(c, n_, lambda);
  for (const Side& side : sides_) {
    const double *row = g_.data() + side.at, *v = x + side.first;
    lambda[side.row] -= row[0] * v[0] + row[1] * v[1] + row[2] * v[2];
  }
  with_size(n_, [&](auto n) { solve_rows(n, x, lambda); });
}

void Schur::solve_rates(const double* c, double* x, double* lambda) const {
  std::fill_n(x, inverse_mass_.size(), 0.0);
  if (lambda != c) std::copy_n(c, n_, lambda);
  with_size(n_, [&](auto n) { solve_rows(n, x, lambda); });
}

/// S λ = λ, x += M⁻¹ Gᵀ λ.
template <class N> void Schur::solve_rows(N n, double* x, double* lambda) const {
  const double *L = S_.data(), *inverse = inverse_pivot_.data();
  auto y = line(n, lambda);
  each(n, [&](auto i) { each(i, [&](auto k) { y[i] -= L[i * n + k] * y[k]; }); });
  each(n, [&](auto i) { y[i] *= inverse[i]; });
  each_down(n, [&](auto i) { each(i, [&](auto k) { y[k] -= L[i * n + k] * y[i]; }); });
  y.store(lambda);
  for (const Side& side : sides_) {
    const double* row = h_.data() + side.at;
    double* v = x + side.first;
    for (int k = 0; k < 3; ++k) v[k] += row[k] * lambda[side.row];
  }
}

}  // namespace orthant
