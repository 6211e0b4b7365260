#include "exact_judge.h"

#include <orthant/core/support/options.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/gmp.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace orthant {
namespace {

namespace mp = boost::multiprecision;
using Rational = mp::number<mp::gmp_rational, mp::et_off>;
using Wide = mp::number<mp::cpp_bin_float_quad::backend_type, mp::et_off>;

constexpr Index kRational = 4;
constexpr double kEpsilon = 0x1p-52;

/// The problem in numbers T, A as rows without its zeros; the operator is formed, with the size that its terms have.
template <class T> struct Copy {
  struct Entry {
    Index column;
    T value, size;
  };
  std::vector<std::vector<Entry>> rows;
  std::vector<T> b;
  std::vector<Index> part;  // the first row of what row i is coupled with

  explicit Copy(const Lcp& p) : rows(at(p.size())), part(at(p.size())) {
    for (const double value : p.b) b.emplace_back(value);
    const auto put = [&](Index i, Index j, const T& value, const T& size) {
      if (size != 0) rows[at(i)].push_back({j, value, size});
    };
    const auto put_entry = [&](Index i, Index j, double value) { put(i, j, T(value), T(std::abs(value))); };
    if (const auto* dense = std::get_if<DenseMatrix>(&p.A)) {
      for (Index i = 0; i < p.size(); ++i)
        for (Index j = 0; j < p.size(); ++j) put_entry(i, j, (*dense)(i, j));
    } else if (const auto* sparse = std::get_if<RowSparse>(&p.A)) {
      for (Index i = 0; i < p.size(); ++i)
        for (auto k = at(sparse->start[at(i)]); k < at(sparse->start[at(i) + 1]); ++k)
          put_entry(i, sparse->column[k], sparse->value[k]);
    } else {
      const auto& [W, inverse_mass, regularization] = std::get<Delassus>(p.A);
      std::vector<std::vector<T>> factor(at(W.rows), std::vector<T>(at(W.cols), T(0)));
      for (Index i = 0; i < W.rows; ++i)
        for (auto k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k)
          factor[at(i)][at(W.column[k])] += T(W.value[k]);
      for (Index i = 0; i < W.rows; ++i)
        for (Index j = 0; j < W.rows; ++j) {
          T sum(i == j && regularization.size() != 0 ? regularization[i] : 0.0), size = sum;
          for (Index k = 0; k < W.cols; ++k)
            if (factor[at(i)][at(k)] != 0 && factor[at(j)][at(k)] != 0) {
              const T term = factor[at(i)][at(k)] * factor[at(j)][at(k)] * T(inverse_mass[k]);
              sum += term;
              size += abs(term);
            }
          put(i, j, sum, size);
        }
    }
    std::iota(part.begin(), part.end(), Index{0});
    for (bool changed = true; changed;) {  // few rows: the simplest way there is
      changed = false;
      const auto join = [&](Index i, Index j) {
        const Index least = std::min(part[at(i)], part[at(j)]);
        changed = changed || part[at(i)] != least || part[at(j)] != least;
        part[at(i)] = part[at(j)] = least;
      };
      for (Index i = 0; i < p.size(); ++i)
        for (const Entry& entry : rows[at(i)]) join(i, entry.column);
      for (const Friction& f : p.friction) join(f.first, f.normal);
    }
  }
};

double near_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

template <class T> T least_of(const T& a, const T& b) { return a < b ? a : b; }
template <class T> T most_of(const T& a, const T& b) { return a < b ? b : a; }
template <class T> T runaway(const T& beta) { return least_of<T>(T(1e-6) * (1 + beta), T(1e-4) * beta); }

std::string row_says(Index i, const char* what, double value) {
  return "row " + std::to_string(i) + ": " + what + " = " + detail::text_of(value);
}

template <class T> Finding solution(const Lcp& p, const Vector& z, double tolerance) {
  const Copy<T> copy(p);
  const Index n = p.size();
  const auto each = [&](Index i, auto&& use) {
    for (const auto& entry : copy.rows[at(i)]) use(entry.column, entry.value);
  };
  std::vector<T> x, w(copy.b), data(at(n), T(0)), size(at(n), T(0));
  for (const double value : z) x.emplace_back(value);

  std::vector<T> cost(at(n), T(1));  // of moving z_i by 1: the largest change of a w, 1 at the least
  std::vector<T> most(at(n), T(0));  // a_i
  for (Index i = 0; i < n; ++i)
    for (const auto& [j, a, of_a] : copy.rows[at(i)]) {
      cost[at(j)] = most_of<T>(cost[at(j)], abs(a));
      most[at(j)] = most_of<T>(most[at(j)], of_a);
    }
  if (std::holds_alternative<Delassus>(p.A)) {  // what an operator's diagonal says of its columns, √(A_jj max A_kk)
    std::vector<double> root(at(n));
    for (Index i = 0; i < n; ++i)
      each(i, [&](Index j, const T& a) { root[at(j)] = i == j ? std::sqrt(static_cast<double>(a)) : root[at(j)]; });
    const double largest = *std::max_element(root.begin(), root.end());
    for (Index j = 0; j < n; ++j)
      if (root[at(j)] > 0) most[at(j)] = T(root[at(j)] * largest);
  }
  std::vector<char> held_at_bound(at(n));
  for (Index j = 0; j < n; ++j) held_at_bound[at(j)] = z[j] == p.lo[j] || z[j] == p.hi[j];
  for (const Friction& f : p.friction)
    held_at_bound[at(f.first)] = held_at_bound[at(f.normal)] != 0 && std::abs(z[f.first]) == f.mu * z[f.normal];
  const auto at_bound = [&](Index j) { return held_at_bound[at(j)] != 0; };
  std::vector<T> far(at(n)), push(at(n));  // the largest |z_k|, and a_k |z_k|, that z_j may have been computed from
  for (Index j = 0; j < n; ++j) far[at(j)] = abs(x[at(j)]), push[at(j)] = most[at(j)] * abs(x[at(j)]);
  for (bool changed = true; changed;) {
    changed = false;
    const auto raise = [&](Index i, Index j) {
      if (far[at(j)] > far[at(i)]) far[at(i)] = far[at(j)], changed = true;
      if (push[at(j)] > push[at(i)]) push[at(i)] = push[at(j)], changed = true;
    };
    for (Index i = 0; i < n; ++i)
      for (const auto& entry : copy.rows[at(i)])
        if (!at_bound(entry.column)) raise(i, entry.column);
    for (const Friction& f : p.friction) raise(f.first, f.normal);
  }

  const T lost = T(n + 1) * T(std::numeric_limits<double>::denorm_min());  // products too small for any double
  T whole(0);
  std::vector<T> own(at(n)), digits(at(n)), entries(at(n)), reach(at(n));  // s_i, t_i, s_i of the entries, β_i
  for (Index i = 0; i < n; ++i) {
    const auto root = at(copy.part[at(i)]);
    T terms = abs(copy.b[at(i)]), summed = terms, given = terms, by_z = terms, by_push = terms;
    for (const auto& [j, a, of_a] : copy.rows[at(i)]) {
      by_z += of_a * (at_bound(j) ? abs(x[at(j)]) : far[at(j)]);
      by_push += of_a * (at_bound(j) ? abs(x[at(j)]) : T(push[at(j)] / most[at(j)]));
      const double bound = z[j] == p.lo[j] || z[j] == p.hi[j] ? z[j] : near_zero(p.lo[j], p.hi[j]);
      if (bound != 0) given += of_a * T(std::abs(bound));
      w[at(i)] += a * x[at(j)];
      terms += of_a * abs(x[at(j)]);
      summed += abs(a * x[at(j)]);
    }
    if (given <= lost) given = T(0);
    own[at(i)] = terms, digits[at(i)] = least_of(by_z, by_push);
    entries[at(i)] = summed, reach[at(i)] = given;
    data[root] = most_of(data[root], given);
    size[root] = most_of(size[root], summed);
    whole = most_of(whole, given);
  }

  T least(whole);  // of the data that are not 0
  for (const T& given : reach)
    if (given > 0) least = least_of<T>(least, given);
  for (bool changed = true; changed;) {
    changed = false;
    const auto raise = [&](Index i, const T& by) {
      if (by > reach[at(i)] && by > lost) reach[at(i)] = by, changed = true;
    };
    for (Index i = 0; i < n; ++i)
      each(i, [&](Index j, const T& a) { raise(i, least_of<T>(abs(a * x[at(j)]), reach[at(j)])); });
    for (const Friction& f : p.friction) raise(f.first, reach[at(f.normal)]);
  }

  // z̄, normals before their frictions.
  enum class Side { stays, lower, upper };
  std::vector<Side> side(at(n), Side::stays);
  std::vector<T> moved(x);
  std::vector<const Friction*> friction(at(n), nullptr);
  for (const Friction& f : p.friction) friction[at(f.first)] = &f;
  std::vector<T> r(at(n)), allowed(at(n));
  Finding finding;
  for (const bool second : {false, true})
    for (Index i = 0; i < n; ++i) {
      if ((friction[at(i)] != nullptr) != second) continue;
      const auto root = at(copy.part[at(i)]);
      const T beta = data[root] > 0 ? data[root] : whole;
      if (T(kEpsilon) * (size[root] - lost) > T(1.001) * runaway<T>(beta + lost)) {
        finding.why = row_says(i, "z has run away, rounding over scale",
                               static_cast<double>(T(kEpsilon) * size[root] / (beta > 0 ? beta : T(1))));
        return finding;
      }
      const T mine = reach[at(i)] > 0 ? most_of<T>(reach[at(i)], least) : beta;
      if (T(kEpsilon) * (entries[at(i)] - lost) > T(1.001) * runaway<T>(mine + lost)) {
        finding.why = row_says(i, "z has run away beside what the data bring into the row",
                               static_cast<double>(entries[at(i)] / mine));
        return finding;
      }
      const T summed = T(0.5 * kEpsilon * static_cast<double>(n + 1)) * own[at(i)] + lost;  // w, in doubles
      const T unit = reach[at(i)] > 0 ? mine : most_of<T>(least_of(entries[at(i)], beta), least);
      r[at(i)] = summed + T(1.001) * most_of<T>(T(tolerance) * least_of(mine, own[at(i)]),
                                                least_of<T>(T(20 * kEpsilon) * digits[at(i)],
                                                            most_of<T>(T(4e-5) * unit, T(20 * kEpsilon) * beta)));
      allowed[at(i)] = r[at(i)];
      T lo(0), hi(0);
      bool below = true, above = true;  // bounds there are
      if (second) {
        hi = T(friction[at(i)]->mu) * moved[at(friction[at(i)]->normal)];
        lo = -hi;
      } else {
        below = p.lo[i] > -kInf, above = p.hi[i] < kInf;
        if (below) lo = T(p.lo[i]);
        if (above) hi = T(p.hi[i]);
      }
      const bool under = below && x[at(i)] < lo, over = above && x[at(i)] > hi;
      if (!under && !over && abs(w[at(i)]) <= r[at(i)]) continue;
      // By w first: where both bounds are within reach, a z past the one may belong to the other.
      const bool to_lower = abs(w[at(i)]) > r[at(i)] ? w[at(i)] > 0 : under;
      if (to_lower ? !below : !above) {
        finding.why = row_says(i, "w", static_cast<double>(w[at(i)])) + " with no bound to rest on";
        return finding;
      }
      side[at(i)] = below && above && lo == hi ? Side::stays : to_lower ? Side::lower : Side::upper;
      if (side[at(i)] == Side::stays) r[at(i)] = -1;  // a fixed row: any w
      moved[at(i)] = to_lower ? lo : hi;
      if (second) {  // its bound has moved along with its normal
        const Index normal = friction[at(i)]->normal;
        allowed[at(i)] += T(friction[at(i)]->mu) * cost[at(i)] * abs(moved[at(normal)] - x[at(normal)]);
      }
      const bool wide = below && above && !second && lo < hi && !under && !over;
      if (wide &&
          abs(moved[at(i)] - x[at(i)]) > T(1.001) * most_of<T>(T(1e-6) * (hi - lo), T(20 * kEpsilon) * abs(x[at(i)]))) {
        finding.why = row_says(i, "distance of z from its bound, beside the width of the box",
                               static_cast<double>(abs(moved[at(i)] - x[at(i)]) / (hi - lo)));
        return finding;
      }
      if (cost[at(i)] * abs(moved[at(i)] - x[at(i)]) > allowed[at(i)]) {
        finding.why = row_says(i, "distance of z from the bound that the sign of w asks for",
                               static_cast<double>(abs(moved[at(i)] - x[at(i)])));
        return finding;
      }
    }

  finding.error = 0;
  for (Index i = 0; i < n; ++i) {
    if (r[at(i)] < 0) continue;
    const auto root = at(copy.part[at(i)]);
    T value = w[at(i)], bearable = r[at(i)];
    each(i, [&](Index j, const T& a) {
      if (moved[at(j)] == x[at(j)]) return;
      value += a * (moved[at(j)] - x[at(j)]);
      bearable += r[at(i)];  // a move costs a row no more than what is excused in it, whatever its own row is excused
    });
    const T violation = side[at(i)] == Side::stays ? abs(value) : side[at(i)] == Side::lower ? -value : value;
    if (violation > 0 && data[root] > 0)
      finding.error = std::max(finding.error, static_cast<double>(violation / data[root]));
    if (violation <= bearable) continue;
    finding.why = row_says(i, "violation over scale", static_cast<double>(violation / (whole > 0 ? whole : T(1))));
    return finding;
  }
  finding.holds = true;
  return finding;
}

}  // namespace

Finding examine_solution(const Lcp& problem, const Vector& z, double tolerance) {
  if (z.size() != problem.size() || !z.allFinite()) return {.why = "z is not finite, or of another size"};
  return problem.size() <= kRational ? solution<Rational>(problem, z, tolerance)
                                     : solution<Wide>(problem, z, tolerance);
}

Finding examine_proof(const Lcp& p, const Vector& u) {
  const Index n = p.size();
  Finding finding;
  const auto refuse = [&](std::string why) {
    finding.why = std::move(why);
    return finding;
  };
  if (u.size() != n || !u.allFinite()) return refuse("u is not finite, or of another size");
  std::vector<char> friction(at(n));
  for (const Friction& f : p.friction) friction[at(f.first)] = 1;
  const Copy<Rational> copy(p);
  std::vector<Rational> g(at(n)), terms(at(n)),
      sizes(at(n));  // sizes: of an operator's terms, at least those of its sums
  Rational value(0), norm(0), data(0);
  std::vector<char> spoken(at(n));
  for (Index i = 0; i < n; ++i) {
    if (u[i] == 0) continue;
    const bool below = p.lo[i] > -kInf, above = p.hi[i] < kInf;
    if (friction[at(i)] != 0 || (below && above)) return refuse(row_says(i, "w has either sign, but u", u[i]));
    if ((below && u[i] < 0) || (above && u[i] > 0)) return refuse(row_says(i, "wrong sign of u", u[i]));
    spoken[at(copy.part[at(i)])] = 1;
    const Rational weight(u[i]);
    norm += abs(weight);
    value += weight * copy.b[at(i)];
    for (const auto& [j, a, of_a] : copy.rows[at(i)]) {
      const Rational term = weight * a;
      g[at(j)] += term;
      terms[at(j)] += abs(term);
      sizes[at(j)] += abs(weight) * of_a;
    }
  }
  for (Index i = 0; i < n; ++i) {
    if (spoken[at(copy.part[at(i)])] == 0) continue;
    Rational given = abs(copy.b[at(i)]);
    for (const auto& [j, a, of_a] : copy.rows[at(i)])
      for (const double bound : {p.lo[j], p.hi[j]})
        if (std::abs(bound) < kInf) given += abs(a) * Rational(std::abs(bound));
    data = most_of(data, given);
  }
  // Where friction alone can make g positive, a z that uses that has friction: then its least term counts as well,
  // since Σ_t |g_t z_t| > −g_n z_n needs a z_t off its bound, as large as the gain compared with g_n + Σ μ |g_t|.
  std::vector<Rational> least(at(n), Rational(-1)), push(at(n));
  for (const Friction& f : p.friction) {
    const Rational share = Rational(f.mu) * abs(g[at(f.first)]), term = Rational(f.mu) * terms[at(f.first)];
    if (share == 0) continue;
    push[at(f.normal)] += share;
    if (least[at(f.normal)] < 0 || term < least[at(f.normal)]) least[at(f.normal)] = term;
  }
  for (Index j = 0; j < n; ++j) {
    if (push[at(j)] == 0) continue;
    if (g[at(j)] <= 0) terms[at(j)] += least[at(j)], sizes[at(j)] += least[at(j)];
    g[at(j)] += push[at(j)];
  }
  Rational kappa(0), rounding(0);  // the slack beside what a z multiplies, and beside what was summed
  for (Index j = 0; j < n; ++j) {
    if (friction[at(j)] != 0 || g[at(j)] == 0) continue;
    const double bound = g[at(j)] > 0 ? p.hi[j] : p.lo[j];
    if (std::abs(bound) < kInf) {
      value += g[at(j)] * Rational(bound);
      continue;
    }
    if (terms[at(j)] == 0) return refuse(row_says(j, "friction alone pushes, g", static_cast<double>(g[at(j)])));
    kappa = most_of<Rational>(kappa, abs(g[at(j)]) / terms[at(j)]);
    rounding = most_of<Rational>(rounding, abs(g[at(j)]) / sizes[at(j)]);
    const double finite = g[at(j)] > 0 ? p.lo[j] : p.hi[j];  // the slack counts from there
    if (std::abs(finite) < kInf) value += g[at(j)] * Rational(finite);
  }
  finding.error = static_cast<double>(kappa);
  if (value >= 0) return refuse("the largest u'w is " + detail::text_of(static_cast<double>(value)) + ", not below 0");
  if (rounding > Rational(32.5 * kEpsilon)) return refuse("g misses its sign by " + detail::text_of(finding.error));
  // A z that lifts u'w to 0 has Σ_j |A_ij z_j| ≥ −value / (κ ‖u‖₁) for some i. None that is accepted may; certify()
  // asks for more.
  if (kappa > 0 && -value * Rational(kEpsilon) < runaway(data) * kappa * norm)
    return refuse("a z within reach may use the slack of g");
  finding.holds = true;
  return finding;
}

}  // namespace orthant
