#include "experiments/studies/verdict_storm/exact_judge.h"

#include "experiments/studies/verdict_storm/cone_judge.h"

#include <orthant/core/support/options.h>

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
      for (const Friction& f : p.friction)
        for (Index r = 0; r < f.rows; ++r) join(f.first + r, f.normal);
    }
  }
};

double near_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

template <class T> T least_of(const T& a, const T& b) { return a < b ? a : b; }
template <class T> T most_of(const T& a, const T& b) { return a < b ? b : a; }
Rational runaway(const Rational& beta) {
  return least_of<Rational>(Rational(1e-6) * (1 + beta), Rational(1e-4) * beta);
}

/// ‖x_T‖; of a disc to 100 digits, exact where it is a double.
Rational length(const std::vector<Rational>& x, const Friction& f) {
  if (f.rows == 1) return abs(x[at(f.first)]);
  using Float100 = mp::number<mp::gmp_float<100>, mp::et_off>;
  const Rational square = x[at(f.first)] * x[at(f.first)] + x[at(f.first + 1)] * x[at(f.first + 1)];
  const Float100 root = sqrt(Float100(square));
  const Rational rounded(static_cast<double>(root));
  return rounded * rounded == square ? rounded : Rational(root);
}

std::string row_says(Index i, const char* what, double value) {
  return "row " + std::to_string(i) + ": " + what + " = " + detail::text_of(value);
}

}  // namespace

Finding examine_solution(const Lcp& p, const Vector& z, double tolerance, Status claimed) {
  if (p.discs()) return examine_cones(p, z, tolerance, claimed);
  if (z.size() != p.size() || !z.allFinite()) return {.why = "z is not finite, or of another size"};
  if (claimed != Status::solved && claimed != Status::rounded) return {.why = "no answer is claimed"};
  const Copy<Rational> copy(p);
  const Index n = p.size();
  std::vector<const Friction*> friction(at(n), nullptr);
  for (const Friction& f : p.friction) friction[at(f.first)] = &f;
  std::vector<Rational> w(copy.b), size, data, entries(at(n));
  for (Index i = 0; i < n; ++i) {
    Rational sum = abs(copy.b[at(i)]), given = sum;
    for (const auto& [j, a, of_a] : copy.rows[at(i)]) {
      const double bound = (z[j] == p.lo[j] || z[j] == p.hi[j]) ? z[j] : near_zero(p.lo[j], p.hi[j]);
      w[at(i)] += a * Rational(z[j]);
      sum += of_a * abs(Rational(z[j]));
      given += of_a * abs(Rational(bound));
      entries[at(i)] += of_a;
    }
    size.push_back(sum), data.push_back(given);
  }
  for (bool changed = true; changed;) {  // few rows: the simplest way there is
    changed = false;
    const auto raise = [&](Index i, const Rational& by) {
      if (by > data[at(i)]) data[at(i)] = by, changed = true;
    };
    for (Index i = 0; i < n; ++i)
      for (const auto& [j, a, of_a] : copy.rows[at(i)])
        raise(i, least_of<Rational>(of_a * abs(Rational(z[j])), data[at(j)]));
    for (const Friction& f : p.friction) raise(f.first, data[at(f.normal)]);
  }
  std::vector<Rational> part_data(at(n));
  for (Index i = 0; i < n; ++i) {
    Rational& whole = part_data[at(copy.part[at(i)])];
    whole = most_of(whole, data[at(i)]);
  }
  Finding finding;
  finding.error = 0;
  for (Index i = 0; i < n; ++i) {
    double lo = p.lo[i], hi = p.hi[i];
    if (const Friction* f = friction[at(i)]) hi = f->mu * std::max(z[f->normal], 0.0), lo = -hi;
    if (z[i] < lo || z[i] > hi) {
      finding.why = row_says(i, "outside its bounds, z", z[i]);
      return finding;
    }
    const Rational& sum = w[at(i)];
    const Rational v = lo == hi     ? Rational(0)
                       : z[i] == lo ? most_of<Rational>(0, -sum)
                       : z[i] == hi ? most_of<Rational>(0, sum)
                                    : Rational(abs(sum));
    const Rational& beta = data[at(i)];
    if (beta > 0) finding.error = std::max(finding.error, static_cast<double>(v / beta));
    const Rational solved = Rational(tolerance) * least_of(size[at(i)], beta);
    const Rational rounded = least_of<Rational>(Rational(20 * kEpsilon) * size[at(i)],
                                                Rational(1e-4) * part_data[at(copy.part[at(i)])]),
                   least =
                       Rational(20 * kEpsilon) * Rational(std::numeric_limits<double>::min()) * (1 + entries[at(i)]);
    if (v <= solved || (claimed == Status::rounded && (v <= rounded || v <= least))) continue;
    finding.why = row_says(i, "violation", static_cast<double>(v)) + ", " +
                  row_says(i, "limit", static_cast<double>(claimed == Status::solved ? solved : rounded));
    return finding;
  }
  finding.holds = true;
  return finding;
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
  for (const Friction& f : p.friction)
    for (Index r = 0; r < f.rows; ++r) friction[at(f.first + r)] = 1;
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
    const Rational share = Rational(f.mu) * length(g, f), term = Rational(f.mu) * length(terms, f);
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
