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
  double& operator[](int i) { return value[i]; }
};
struct InPlace {
  double* value;
  double& operator[](int i) const { return value[i]; }
};
/// `lower` of a square: on and below the diagonal, by rows.
template <int N> Local<N * N> triangle(std::integral_constant<int, N> n, double* from) {
  Local<N * N> to;
  each(n,
       [&](auto i) { each(std::integral_constant<int, i + 1>{}, [&](auto j) { to[i * N + j] = from[i * N + j]; }); });
  return to;
}
InPlace triangle(int, double* from) { return {from}; }
template <int N> void store_lower(std::integral_constant<int, N> n, Local<N * N>& from, double* to) {
  each(n,
       [&](auto i) { each(std::integral_constant<int, i + 1>{}, [&](auto j) { to[i * N + j] = from[i * N + j]; }); });
}
void store_lower(int, InPlace, double*) {}
template <int N> Local<N> line(std::integral_constant<int, N> n, double* from) {
  Local<N> to;
  each(n, [&](auto i) { to[i] = from[i]; });
  return to;
}
InPlace line(int, double* from) { return {from}; }
template <int N> void store(std::integral_constant<int, N> n, Local<N>& from, double* to) {
  each(n, [&](auto i) { to[i] = from[i]; });
}
void store(int, InPlace, double*) {}

}  // namespace

Schur::Schur(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows)
    : n_(static_cast<int>(rows.size())),
      inverse_mass_(inverse_mass),
      S_(rows.size() * rows.size()),
      pivot_(rows.size()),
      inverse_pivot_(rows.size()) {
  for (int first = 0; first < inverse_mass.size(); first += 3) {
    const auto begin = sides_.size();
    for (int i = 0; i < n_; ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      if (3 * row.a == first) sides_.push_back({i, 0, {}});
      if (3 * row.b == first) sides_.push_back({i, 1, {}});
    }
    if (sides_.size() == begin) continue;
    bodies_.push_back(
        {first, static_cast<int>(begin), {inverse_mass[first], inverse_mass[first + 1], inverse_mass[first + 2]}});
    for (std::size_t u = begin; u < sides_.size(); ++u)
      for (std::size_t v = begin; v <= u; ++v) place_.push_back(sides_[u].row * n_ + sides_[v].row);
  }
}

template <class Sides, class Use> void Schur::each_body(Sides& sides, Use&& use) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto begin = static_cast<std::size_t>(bodies_[b].begin);
    const auto end = b + 1 < bodies_.size() ? static_cast<std::size_t>(bodies_[b + 1].begin) : sides.size();
    use(bodies_[b], std::span(sides.data() + begin, end - begin));
  }
}

bool Schur::factorize(std::span<const Row> G, double dependent) {
  std::fill(S_.begin(), S_.end(), 0.0);
  double* const S = S_.data();
  const int* place = place_.data();
  each_body(sides_, [&](const OnBody& body, std::span<Side> sides) {
    const auto [m, n, j] = body.inverse_mass;
    for (std::size_t u = 0; u < sides.size(); ++u) {
      const double *const g = sides[u].part(G), x = g[0], y = g[1], z = g[2];
      sides[u].h[0] = m * x, sides[u].h[1] = n * y, sides[u].h[2] = j * z;
      for (std::size_t v = 0; v <= u; ++v) {
        const auto& h = sides[v].h;
        S[*place++] += x * h[0] + y * h[1] + z * h[2];
      }
    }
  });
  return with_size(n_, [&](auto n) { return factorize_rows(n, dependent); });
}

/// Row by row: y_j = S_ij − Σ_k y_k L_jk, L_ij = y_j / D_j, D_i = S_ii − Σ_j y_j L_ij.
template <class N> bool Schur::factorize_rows(N n, double dependent) {
  auto S = triangle(n, S_.data());
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
  store_lower(n, S, S_.data()), store(n, inverse, inverse_pivot_.data()), store(n, pivot, pivot_.data());
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
  if (lambda != c)
    for (int i = 0; i < n_; ++i) lambda[i] = c[i];
  each_body(sides_, [&](const OnBody& body, std::span<const Side> sides) {
    const double f0 = f[body.first], f1 = f[body.first + 1], f2 = f[body.first + 2];
    for (const Side& side : sides) lambda[side.row] -= side.h[0] * f0 + side.h[1] * f1 + side.h[2] * f2;
  });
  with_size(n_, [&](auto n) { solve_rows(n, lambda); });
  add_rows(lambda, x);
}

void Schur::solve_rates(const double* c, double* x, double* lambda) const {
  for (Eigen::Index k = 0; k < inverse_mass_.size(); ++k) x[k] = 0;
  if (lambda != c)
    for (int i = 0; i < n_; ++i) lambda[i] = c[i];
  with_size(n_, [&](auto n) { solve_rows(n, lambda); });
  add_rows(lambda, x);
}

/// x += M⁻¹ Gᵀ λ.
void Schur::add_rows(const double* lambda, double* x) const {
  each_body(sides_, [&](const OnBody& body, std::span<const Side> sides) {
    double *const v = x + body.first, v0 = v[0], v1 = v[1], v2 = v[2];
    for (const Side& side : sides) {
      const double by = lambda[side.row];
      v0 += side.h[0] * by, v1 += side.h[1] * by, v2 += side.h[2] * by;
    }
    v[0] = v0, v[1] = v1, v[2] = v2;
  });
}

/// S λ = λ.
template <class N> void Schur::solve_rows(N n, double* lambda) const {
  const double *L = S_.data(), *inverse = inverse_pivot_.data();
  auto y = line(n, lambda);
  each(n, [&](auto i) { each(i, [&](auto k) { y[i] -= L[i * n + k] * y[k]; }); });
  each(n, [&](auto i) { y[i] *= inverse[i]; });
  each_down(n, [&](auto i) { each(i, [&](auto k) { y[k] -= L[i * n + k] * y[i]; }); });
  store(n, y, lambda);
}

}  // namespace orthant
