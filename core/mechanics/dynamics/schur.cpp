#include <orthant/core/mechanics/dynamics/schur.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>
#include <utility>

namespace orthant {
namespace {

/// So many pairs of rows, known to the compiler; S does not couple the first `apart`.
template <int pairs, int apart = 0> struct Pairs : std::integral_constant<int, pairs> {
  static constexpr bool couple(int p, int q) { return p == q || std::max(p, q) >= apart; }
};
struct AnyPairs {
  int pairs;
  const int* first;  // per pair p, the first one that S or its factor couples it to: none before it is read
  operator int() const { return pairs; }
  static constexpr bool couple(int /*p*/, int /*q*/) { return true; }
};
/// first[p], or 0 where the compiler leaves uncoupled pairs out.
template <int pairs, int apart> std::integral_constant<int, 0> first_of(Pairs<pairs, apart>, int /*p*/) { return {}; }
int first_of(const AnyPairs& n, int p) { return n.first[p]; }
std::integral_constant<int, 0> larger(std::integral_constant<int, 0>, std::integral_constant<int, 0>) { return {}; }
int larger(int p, int q) { return std::max(p, q); }

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
/// f(first) … f(n − 1).
template <int N, class F> void each(std::integral_constant<int, 0>, std::integral_constant<int, N> n, F&& f) {
  each(n, f);
}
template <class F> void each(int first, int n, F&& f) {
  for (int i = first; i < n; ++i) f(i);
}

/// 2 n, known to the compiler if n is.
template <int N> std::integral_constant<int, 2 * N> twice(std::integral_constant<int, N>) { return {}; }
int twice(int n) { return 2 * n; }

constexpr double kLeast = 1e-280, kMost = 1e300;  // of a product of two pivots: its digits are all there

/// f(0), f(1) … f(n − 1), written out.
template <std::size_t n, class F> void each_number(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) { (f(k), ...); }
  (std::make_index_sequence<n>{});
}
/// f(0) + f(1) + … + f(n − 1), the first ones first, written out.
template <std::size_t n, class F> auto sum_of(F&& f) {
  return [&]<std::size_t... k>(std::index_sequence<k...>) { return (... + f(k)); }
  (std::make_index_sequence<n>{});
}

}  // namespace

template <class Space> template <class F> decltype(auto) SchurOf<Space>::with_pairs(F&& f) const {
  static_assert(kUnrolled == 8);
  if (pairs_ == 1) return f(Pairs<1>{});
  if (pairs_ == 2) return apart_ == 2 ? f(Pairs<2, 2>{}) : f(Pairs<2>{});
  if (pairs_ == 3) return apart_ >= 2 ? f(Pairs<3, 2>{}) : f(Pairs<3>{});
  if (pairs_ == 4) return apart_ >= 2 ? f(Pairs<4, 2>{}) : f(Pairs<4>{});
  if constexpr (!kPlanar<Space>) {  // a revolute joint has five rows
    if (pairs_ == 5) return f(Pairs<5>{});
    if (pairs_ == 6) return f(Pairs<6>{});
    if (pairs_ == 7) return f(Pairs<7>{});
    if (pairs_ == 8) return f(Pairs<8>{});
  }
  return f(AnyPairs{pairs_, first_.data()});
}

template <class Space> SchurOf<Space>::SchurOf(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows)
    : rows_(static_cast<int>(rows.size())),
      pairs_((rows_ + 1) / 2),
      order_(static_cast<std::size_t>(pairs_)),
      first_(static_cast<std::size_t>(pairs_)),
      inverse_mass_(inverse_mass),
      S_(static_cast<std::size_t>(2 * pairs_ * pairs_)),
      pivot_(static_cast<std::size_t>(2 * pairs_)),
      inverse_pivot_(pivot_.size()),
      lambda_(static_cast<std::size_t>(pairs_)) {
  put_apart_first(rows);
  const auto part_on = [&](int i, int first) -> Part {
    if (i >= rows_) return nullptr;
    const Row& row = rows[static_cast<std::size_t>(i)];
    return Space::kVelocities * row.a == first ? &Row::ja : Space::kVelocities * row.b == first ? &Row::jb : nullptr;
  };
  std::iota(first_.begin(), first_.end(), 0);
  for (int first = 0; first < inverse_mass.size(); first += Space::kVelocities) {
    const auto begin = static_cast<int>(on_bodies_.size());
    for (int p = 0; p < pairs_; ++p) {
      const int row = order_[static_cast<std::size_t>(p)];
      const std::array<Part, 2> parts{part_on(row, first), part_on(row + 1, first)};
      if (parts[0] == nullptr && parts[1] == nullptr) continue;
      if (static_cast<int>(on_bodies_.size()) > begin) {
        int& coupled = first_[static_cast<std::size_t>(p)];
        coupled = std::min(coupled, on_bodies_[static_cast<std::size_t>(begin)].pair);
      }
      on_bodies_.push_back({p, 2 * p * pairs_, row, parts, {}, {}});
    }
    if (const auto end = static_cast<int>(on_bodies_.size()); end > begin) bodies_.push_back({first, begin, end, {}});
  }
  set_inverse_mass(inverse_mass);
}

/// A largest set of pairs that have no body in common. A row without another stays the last.
template <class Space> void SchurOf<Space>::put_apart_first(std::span<const Row> rows) {
  for (int p = 0; p < pairs_; ++p) order_[static_cast<std::size_t>(p)] = 2 * p;
  if (rows_ > kUnrolled) return;
  const auto meet = [](const Row& r, const Row& s) {
    return (r.a >= 0 && (r.a == s.a || r.a == s.b)) || (r.b >= 0 && (r.b == s.a || r.b == s.b));
  };
  const auto couple = [&](int p, int q) {
    for (const int i : {2 * p, 2 * p + 1})
      for (const int j : {2 * q, 2 * q + 1})
        if (meet(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)])) return true;
    return false;
  };
  const auto whole = static_cast<unsigned>(rows_ / 2);
  unsigned best = 0;
  for (unsigned set = 0; set < 1U << whole; ++set) {
    const auto has = [&](int p) { return (set >> p & 1U) != 0; };
    bool apart = std::popcount(set) > std::max(1, std::popcount(best));
    for (int p = 0; p < rows_ / 2; ++p)
      for (int q = 0; q < p; ++q) apart = apart && !(has(p) && has(q) && couple(p, q));
    if (apart) best = set;
  }
  apart_ = std::popcount(best);
  std::stable_partition(order_.begin(), order_.end(), [&](int row) { return (best >> (row / 2) & 1U) != 0; });
}

template <class Space> bool SchurOf<Space>::factorize(std::span<const Row> G, double dependent) {
  with_pairs([&](auto n) {  // number by number: a call of memset twice a step took 3 % of it
    each(n, [&](auto p) {
      each(twice(first_of(n, p)), twice(p), [&](auto j) { S_[static_cast<std::size_t>(2 * p * n + j)] = Simd2(0); });
      S_[static_cast<std::size_t>(2 * p * (n + 1))] = S_[static_cast<std::size_t>(2 * p * (n + 1) + 1)] = Simd2(0);
    });
  });
  if (rows_ % 2 == 1) S_.back() = Simd2(0, 1);  // the row of nothing
  static constexpr Entries kNothing{};
  const auto part = [&](const PairOnBody& u, std::size_t k) -> const Entries& {
    return u.parts[k] == nullptr ? kNothing : G[static_cast<std::size_t>(u.row) + k].*u.parts[k];
  };
  for (const OnBody& body : bodies_) {
    const Entries m = body.inverse_mass;
    const PairOnBody* const first = on_bodies_.data() + body.begin;
    for (PairOnBody* u = on_bodies_.data() + body.begin; u != on_bodies_.data() + body.end; ++u) {
      const Entries &of_first = part(*u, 0), &of_second = part(*u, 1);
      std::array<Simd2, kN> g, x;
      each_number<kN>([&](std::size_t k) { g[k] = Simd2(of_first[k], of_second[k]), x[k] = m[k] * g[k]; });
      each_number<kN>([&](std::size_t k) { u->g[k] = g[k]; });
      each_number<kN>([&](std::size_t k) { u->x[k] = x[k]; });
      Simd2* to = S_.data() + u->at;
      for (const PairOnBody* v = first; v < u; ++v) {
        to[2 * v->pair] += sum_of<kN>([&](std::size_t k) { return v->g[k][0] * x[k]; });
        to[2 * v->pair + 1] += sum_of<kN>([&](std::size_t k) { return v->g[k][1] * x[k]; });
      }
      to += 2 * u->pair;  // its own: [1][0] is not read
      to[0] += sum_of<kN>([&](std::size_t k) { return g[k][0] * x[k]; });
      to[1] += sum_of<kN>([&](std::size_t k) { return g[k] * x[k]; });
    }
  }
  return with_pairs([&](auto n) { return factorize_pairs(n, dependent); });
}

/// Row by row: y_j = S_ij − Σ_k y_k L_jk, L_ij = y_j / D_j, D_i = S_ii − Σ_j y_j L_ij. The second D_i of a pair comes
/// from D_i−1 D_i = D_i−1 (S_ii − Σ_j<i−1 y_j L_ij) − y_i−1², so that 1 / D_i does not wait for the division before it.
template <class Space> template <class N> bool SchurOf<Space>::factorize_pairs(N n, double dependent) {
  const auto S = [&](int p, int j) -> Simd2& { return S_[static_cast<std::size_t>(2 * p * n + j)]; };
  double *const inverse = inverse_pivot_.data(), *const pivot = pivot_.data();
  bool independent = true;
  const auto check = [&](int i, double whole) {
    const bool holds =
        pivot[i] > dependent * whole && pivot[i] < std::numeric_limits<double>::infinity();  // false of NaN
    independent &= holds;
    if (!holds) inverse[i] = 0;  // what follows stays finite, for finite()
  };
  each(n, [&](auto p) {
    Simd2 whole(S(p, 2 * p)[0], S(p, 2 * p + 1)[1]), left = whole;
    double last = S(p, 2 * p)[1];
    const auto first = first_of(n, p);
    each(first, p, [&](auto q) {
      if (!n.couple(p, q)) return;
      Simd2 y = S(p, 2 * q), z = S(p, 2 * q + 1);
      each(twice(larger(first, first_of(n, q))), twice(q), [&](auto k) {
        if (!n.couple(p, k / 2) || !n.couple(q, k / 2)) return;
        const Simd2 s = S(p, k), l = S(q, k);
        y -= s * Simd2(l[0]), z -= s * Simd2(l[1]);
      });
      z -= y * Simd2(S(q, 2 * q)[1]);
      S(p, 2 * q) = y, S(p, 2 * q + 1) = z;
    });
    each(twice(first), twice(p), [&](auto j) {
      if (!n.couple(p, j / 2)) return;
      const Simd2 y = S(p, j), l = y * Simd2(inverse[j]);
      S(p, j) = l, left -= y * l, last -= y[1] * l[0];
    });
    const int i = 2 * p;
    pivot[i] = left[0], inverse[i] = 1 / left[0];
    check(i, whole[0]);
    const double product = left[0] * left[1];
    if (product > kLeast && product < kMost) {
      const double both = product - last * last;
      pivot[i + 1] = both * inverse[i], inverse[i + 1] = left[0] / both;
    } else {
      pivot[i + 1] = left[1] - last * (last * inverse[i]), inverse[i + 1] = 1 / pivot[i + 1];
    }
    check(i + 1, whole[1]);
    S(p, i) = Simd2(whole[0], last * inverse[i]);
  });
  each(n, [&](auto p) {  // L with that of each pair taken out of its columns: 0.97 of a step (bare_loop)
    each(first_of(n, p), p, [&](auto q) {
      if (n.couple(p, q)) S(p, 2 * q) -= S(p, 2 * q + 1) * Simd2(S(q, 2 * q)[1]);
    });
  });
  return independent;
}

template <class Space> void SchurOf<Space>::set_inverse_mass(const Eigen::VectorXd& inverse_mass) {
  inverse_mass_ = inverse_mass;
  for (OnBody& body : bodies_) std::copy_n(inverse_mass.data() + body.first, kN, body.inverse_mass.begin());
}

template <class Space> bool SchurOf<Space>::finite() const {
  return std::all_of(S_.begin(), S_.end(), [](Simd2 s) { return std::isfinite(s[0]) && std::isfinite(s[1]); });
}

template <class Space> double SchurOf<Space>::independence() const {
  double least = 1;
  for (int i = 0; i < rows_; ++i) {
    const double whole = S_[static_cast<std::size_t>((i / 2) * 2 * pairs_ + i)][i % 2];
    least = std::min(least, pivot_[static_cast<std::size_t>(i)] / whole);
  }
  return least;
}

template <class Space> void SchurOf<Space>::solve(const double* f, const double* c, double* x, double* lambda) const {
  for (Eigen::Index k = 0; k < inverse_mass_.size(); ++k) x[k] = inverse_mass_[k] * f[k];
  set_rates(c);
  for (const OnBody& body : bodies_) {
    Entries by;
    std::copy_n(x + body.first, kN, by.begin());
    subtract_rates(body, by);
  }
  add_solution(x);
  store_forces(lambda);
}

template <class Space>
void SchurOf<Space>::solve_change(const double* f, const double* v, const double* c, double* x, double* lambda) const {
  for (Eigen::Index k = 0; k < inverse_mass_.size(); ++k) x[k] = inverse_mass_[k] * f[k];
  set_rates(c);
  for (const OnBody& body : bodies_) {
    const double *const from = v + body.first, *const by = x + body.first;
    Entries sum;
    each_number<kN>([&](std::size_t k) { sum[k] = from[k] + by[k]; });
    subtract_rates(body, sum);
  }
  add_solution(x);
  store_forces(lambda);
}

template <class Space> void SchurOf<Space>::add_rates(const double* c, double* x) const {
  set_rates(c);
  add_solution(x);
}

template <class Space> void SchurOf<Space>::solve_row(const Row& row, double* x) const {
  std::fill_n(x, inverse_mass_.size(), 0.0);
  std::fill(lambda_.begin(), lambda_.end(), Simd2(0));
  const auto load = [&](BodyId b, const Entries& j) {
    if (b < 0) return;
    const int place = Space::kVelocities * b;
    const double* const m = inverse_mass_.data() + place;
    double* const xb = x + place;
    Entries v;
    each_number<kN>([&](std::size_t k) { v[k] = m[k] * j[k]; });
    each_number<kN>([&](std::size_t k) { xb[k] += v[k]; });
    const auto body =
        std::find_if(bodies_.begin(), bodies_.end(), [place](const OnBody& o) { return o.first == place; });
    if (body != bodies_.end()) subtract_rates(*body, v);
  };
  load(row.a, row.ja), load(row.b, row.jb);
  add_solution(x);
}

/// λ = c.
template <class Space> void SchurOf<Space>::set_rates(const double* c) const {
  for (std::size_t p = 0; p < static_cast<std::size_t>(rows_ / 2); ++p) lambda_[p] = Simd2::load(c + order_[p]);
  if (rows_ % 2 == 1) lambda_.back() = Simd2(c[rows_ - 1], 0);
}

template <class Space> void SchurOf<Space>::store_forces(double* lambda) const {
  for (std::size_t p = 0; p < static_cast<std::size_t>(rows_ / 2); ++p) lambda_[p].store(lambda + order_[p]);
  if (rows_ % 2 == 1) lambda[rows_ - 1] = lambda_.back()[0];
}

/// λ −= G v, the part of one body with its three v.
template <class Space> void SchurOf<Space>::subtract_rates(const OnBody& body, const Entries& v) const {
  for (const PairOnBody& u : on(body))
    lambda_[static_cast<std::size_t>(u.pair)] -= sum_of<kN>([&](std::size_t k) { return v[k] * u.g[k]; });
}

/// S λ' = λ,  x += M⁻¹ Gᵀ λ'.
template <class Space> void SchurOf<Space>::add_solution(double* x) const {
  with_pairs([&](auto n) { solve_pairs(n); });
  for (const OnBody& body : bodies_) {
    std::array<Simd2, kN> sum;
    sum.fill(Simd2(0));
    for (const PairOnBody& u : on(body)) {
      const Simd2 by = lambda_[static_cast<std::size_t>(u.pair)];
      each_number<kN>([&](std::size_t k) { sum[k] += u.x[k] * by; });
    }
    double* const v = x + body.first;
    each_number<kN>([&](std::size_t k) { v[k] += sum[k].sum(); });
  }
}

/// S λ' = λ. The inside of a pair is no step of its own on the way there and back: no other pair waits for it.
template <class Space> template <class N> void SchurOf<Space>::solve_pairs(N n) const {
  const auto S = [&](int p, int j) { return S_[static_cast<std::size_t>(2 * p * n + j)]; };
  Simd2* const y = lambda_.data();
  each(n, [&](auto p) {
    Simd2 left = y[p];
    each(first_of(n, p), p, [&](auto q) {
      if (n.couple(p, q)) left -= S(p, 2 * q) * Simd2(y[q][0]) + S(p, 2 * q + 1) * Simd2(y[q][1]);
    });
    y[p] = left;
  });
  each(n, [&](auto p) {
    const double l = S(p, 2 * p)[1];
    const Simd2 left = Simd2(y[p][0], y[p][1] - l * y[p][0]) * Simd2::load(inverse_pivot_.data() + 2 * p);
    y[p] = Simd2(left[0] - l * left[1], left[1]);
  });
  each_down(n, [&](auto p) {
    const Simd2 two = y[p];
    each(first_of(n, p), p, [&](auto q) {
      if (!n.couple(p, q)) return;
      const Simd2 first = S(p, 2 * q) * two, second = S(p, 2 * q + 1) * two;
      y[q] -= Simd2(first.sum(), second.sum());
    });
  });
}

template class SchurOf<Planar>;
template class SchurOf<Spatial>;

}  // namespace orthant
