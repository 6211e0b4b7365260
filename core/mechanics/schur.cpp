#include <orthant/core/mechanics/schur.h>

#include <algorithm>
#include <cmath>
#include <cstring>
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
template <int N> Local<N> line(std::integral_constant<int, N> n, const double* from, double*) {
  Local<N> to;
  each(n, [&](auto i) { to[i] = from[i]; });
  return to;
}
InPlace line(int n, const double* from, double* to) {
  if (from != to) std::copy_n(from, n, to);
  return {to};
}
/// In twos, as who comes next reads them: a processor waits where it reads at once what was stored number by number.
using TwoDoubles [[gnu::vector_size(16)]] = double;  // Eigen's would be put together in memory, and so wait itself
template <int N> void store(std::integral_constant<int, N>, Local<N>& from, double* to) {
  each(std::integral_constant<int, N / 2>{}, [&](auto i) {
    const TwoDoubles two{from[2 * i], from[2 * i + 1]};
    std::memcpy(to + 2 * i, &two, sizeof two);
  });
  if constexpr (N % 2 == 1) to[N - 1] = from[N - 1];
}
void store(int, InPlace, double*) {}

constexpr std::array<double, 3> kNothing{};
constexpr double kLeast = 1e-280, kMost = 1e300;  // of a product of two pivots: its digits are all there

}  // namespace

Schur::Schur(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows)
    : n_(static_cast<int>(rows.size())),
      inverse_mass_(inverse_mass),
      S_(rows.size() * rows.size() + 1),
      pivot_(rows.size()),
      inverse_pivot_(rows.size()),
      lambda_(rows.size() + 1) {
  const auto side_on = [&](int i, int first) {  // −1: row i does not act there
    if (i >= n_) return -1;
    const Row& row = rows[static_cast<std::size_t>(i)];
    return 3 * row.a == first ? 0 : 3 * row.b == first ? 1 : -1;
  };
  for (int first = 0; first < inverse_mass.size(); first += 3) {
    const auto begin = static_cast<int>(twos_.size());
    for (int i = 0; i < n_; ++i) {
      const int which = side_on(i, first);
      if (which < 0) continue;
      const bool both = side_on(i + 1, first) == which;
      twos_.push_back({i, which, both, {}, {}, {}});
      i += both;
    }
    if (const auto end = static_cast<int>(twos_.size()); end > begin)
      bodies_.push_back({first, begin, end, {inverse_mass[first], inverse_mass[first + 1], inverse_mass[first + 2]}});
  }
}

bool Schur::factorize(std::span<const Row> G, double dependent) {
  std::fill(S_.begin(), S_.end(), 0.0);
  const auto add = [](double* to, const Eigen::Array2d& what) { Eigen::Map<Eigen::Array2d>(to, 2) += what; };
  for (const OnBody& body : bodies_) {
    const auto [m, n, j] = body.inverse_mass;
    const std::span<Two> twos = on(body);
    for (Two& u : twos) {
      const std::array<double, 3>&g = u.part(G, 0), &h = u.both ? u.part(G, 1) : kNothing;
      u.x = m * Eigen::Array2d(g[0], h[0]), u.y = n * Eigen::Array2d(g[1], h[1]), u.z = j * Eigen::Array2d(g[2], h[2]);
      double *const first = S_.data() + u.row * n_, *const second = first + n_;
      for (const Two* v = twos.data(); v <= &u; ++v) {  // a number more at the end of a row's is 0, or overwritten
        add(first + v->row, g[0] * v->x + g[1] * v->y + g[2] * v->z);
        if (u.both) add(second + v->row, h[0] * v->x + h[1] * v->y + h[2] * v->z);
      }
    }
  }
  return with_size(n_, [&](auto n) { return factorize_rows(n, dependent); });
}

/// Row by row: y_j = S_ij − Σ_k y_k L_jk, L_ij = y_j / D_j, D_i = S_ii − Σ_j y_j L_ij. Every second D_i comes from
/// D_i−1 D_i = D_i−1 (S_ii − Σ_j<i−1 y_j L_ij) − y_i−1², so that 1 / D_i does not wait for the division before it.
template <class N> bool Schur::factorize_rows(N n, double dependent) {
  auto S = triangle(n, S_.data());
  auto inverse = line(n, inverse_pivot_.data(), inverse_pivot_.data());
  auto pivot = line(n, pivot_.data(), pivot_.data());
  bool independent = true;
  each(n, [&](auto i) {
    const double whole = S[i * n + i];
    double left = whole, last = 0;  // y_i−1
    each(i, [&](auto j) { each(j, [&](auto k) { S[i * n + j] -= S[i * n + k] * S[j * n + k]; }); });
    each(i, [&](auto j) {
      const double y = S[i * n + j];
      S[i * n + j] = y * inverse[j];
      if (i % 2 == 1 && j == i - 1)
        last = y;
      else
        left -= y * S[i * n + j];
    });
    if (i % 2 == 0) {
      pivot[i] = left, inverse[i] = 1 / left;
    } else {
      const double product = pivot[i - 1] * left;
      if (product > kLeast && product < kMost) {
        const double both = product - last * last;
        pivot[i] = both * inverse[i - 1], inverse[i] = pivot[i - 1] / both;
      } else {
        pivot[i] = left - last * S[i * n + i - 1], inverse[i] = 1 / pivot[i];
      }
    }
    const bool holds =
        pivot[i] > dependent * whole && pivot[i] < std::numeric_limits<double>::infinity();  // false of NaN
    independent &= holds;
    if (!holds) inverse[i] = 0;  // what follows stays finite, for finite()
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
  std::copy_n(c, n_, lambda_.data());
  for (const OnBody& body : bodies_) subtract_rates(body, f + body.first);
  add_rates(lambda_.data(), x);
  std::copy_n(lambda_.data(), n_, lambda);
  lambda_.back() = 0;  // a force that was not finite leaves its mark there, too
}

void Schur::add_rates(const double* c, double* x) const {
  with_size(n_, [&](auto n) { solve_rows(n, c, lambda_.data()); });
  add_rows(lambda_.data(), x);
}

void Schur::solve_row(const Row& row, double* x) const {
  std::fill_n(x, inverse_mass_.size(), 0.0);
  std::fill(lambda_.begin(), lambda_.end(), 0.0);
  const auto load = [&](BodyId b, const std::array<double, 3>& j) {
    const auto body = std::find_if(bodies_.begin(), bodies_.end(), [b](const OnBody& o) { return o.first == 3 * b; });
    for (int k = 0; b >= 0 && k < 3; ++k) x[3 * b + k] += inverse_mass_[3 * b + k] * j[static_cast<std::size_t>(k)];
    if (b >= 0 && body != bodies_.end()) subtract_rates(*body, j.data());
  };
  load(row.a, row.ja), load(row.b, row.jb);
  add_rates(lambda_.data(), x);
  lambda_.back() = 0;
}

/// λ −= G M⁻¹ f, the part of one body with its three f.
void Schur::subtract_rates(const OnBody& body, const double* f) const {
  for (const Two& two : on(body)) {
    Eigen::Map<Eigen::Array2d> both(lambda_.data() + two.row);
    both -= f[0] * two.x + f[1] * two.y + f[2] * two.z;
  }
}

/// x += M⁻¹ Gᵀ λ.
void Schur::add_rows(const double* lambda, double* x) const {
  for (const OnBody& body : bodies_) {
    Eigen::Array2d x0(0, 0), x1(0, 0), x2(0, 0);
    for (const Two& two : on(body)) {
      const Eigen::Map<const Eigen::Array2d> by(lambda + two.row);
      x0 += two.x * by, x1 += two.y * by, x2 += two.z * by;
    }
    double* const v = x + body.first;
    v[0] += x0.sum(), v[1] += x1.sum(), v[2] += x2.sum();
  }
}

/// S λ = c.
template <class N> void Schur::solve_rows(N n, const double* c, double* lambda) const {
  const double *L = S_.data(), *inverse = inverse_pivot_.data();
  auto y = line(n, c, lambda);
  each(n, [&](auto i) { each(i, [&](auto k) { y[i] -= L[i * n + k] * y[k]; }); });
  each(n, [&](auto i) { y[i] *= inverse[i]; });
  each_down(n, [&](auto i) { each(i, [&](auto k) { y[k] -= L[i * n + k] * y[i]; }); });
  store(n, y, lambda);
}

}  // namespace orthant
