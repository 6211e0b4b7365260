// Check of a proof of infeasibility (Farkas' lemma): sums with bounds of their rounding, on the safe side.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_sums.h>
#include <orthant/core/lcp/judge/exact.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace orthant {
namespace {

using detail::kEpsilon, detail::kProducts, detail::kRounding;
// s above this: no z is worth looking for. Between the two nothing is claimed: a z may hold that no double can show.
double unknowable(double beta) { return 1e-2 / kEpsilon * beta; }

constexpr Index kExactRows = 12;
constexpr double kExactCells = 4096;

/// The proof in rationals; of u the signs are known to be right.
bool proves_exactly(const Lcp& p, const Vector& u) {
  const exact::Table A = exact::table(p.A);
  exact::Rational most = 0;  // of uᵀ(A z + b)
  exact::Row g(A.size());
  for (Index i = 0; i < p.size(); ++i) {
    const exact::Rational weight = u[i];
    exact::add_product(most, weight, exact::Rational(p.b[i]));
    for (std::size_t j = 0; j < g.size(); ++j) exact::add_product(g[j], weight, A[at(i)][j]);
  }
  for (const Friction& f : p.friction) {
    g[at(f.normal)] += exact::Rational(f.mu) * abs(g[at(f.first)]);
    g[at(f.first)] = 0;
  }
  for (Index j = 0; j < p.size(); ++j) {
    if (g[at(j)].is_zero()) continue;
    const double bound = g[at(j)] > 0 ? p.hi[j] : p.lo[j];
    if (std::isinf(bound)) return false;
    exact::add_product(most, g[at(j)], exact::Rational(bound));
  }
  return most < 0;
}

// Its first 26 bits.
double head(double value) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) & ~std::uint64_t{0x7ffffff});
}

}  // namespace

// g_ ← Aᵀu or A u in long double, and its g_abs_; of Aᵀu also what rounding has taken from each sum.
void Judge::product(const Matrix& A, const Vector& u, bool transposed) {
  const Index n = u.size();
  g_.assign(at(n), 0);
  g_abs_.assign(at(n), 0);
  g_error_.assign(at(n), 0);
  const auto add = [&](Index j, double a, double x) {
    if (!transposed) {
      const long double product = static_cast<long double>(a) * x;
      g_[at(j)] += product;
      g_abs_[at(j)] += std::abs(product);
      return;
    }
    const double halves[2] = {head(a), a - head(a)}, others[2] = {head(x), x - head(x)};
    for (const double half : halves)
      for (const double other : others) {  // exact, in 54 bits
        const long double term = static_cast<long double>(half) * other, before = g_[at(j)], after = before + term;
        const long double taken = after - before;  // Knuth's exact error of a sum
        g_error_[at(j)] += std::abs((before - (after - taken)) + (term - taken));
        g_[at(j)] = after;
        g_abs_[at(j)] += std::abs(term);
      }
  };
  if (for_each_entry(A, [&](Index i, Index j, double a) { add(transposed ? j : i, a, u[transposed ? i : j]); })) return;
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);  // symmetric: Aᵀu = A u
  inner_ld_.assign(at(W.cols), 0);
  inner_abs_ld_.assign(at(W.cols), 0);
  for (Index i = 0; i < n; ++i)
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      const long double product = static_cast<long double>(W.value[k]) * u[i] * inverse_mass[W.column[k]];
      inner_ld_[at(W.column[k])] += product;
      inner_abs_ld_[at(W.column[k])] += std::abs(product);
    }
  for (Index i = 0; i < n; ++i) {
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      g_[at(i)] += W.value[k] * inner_ld_[at(W.column[k])];
      g_abs_[at(i)] += std::abs(W.value[k]) * inner_abs_ld_[at(W.column[k])];
    }
    if (regularization.size() != 0) {
      const long double product = static_cast<long double>(regularization[i]) * u[i];
      g_[at(i)] += product;
      g_abs_[at(i)] += std::abs(product);
    }
    g_error_[at(i)] = static_cast<long double>(n + 4) * kRounding * g_abs_[at(i)];
  }
}

bool Judge::wants_exact_proof(const Lcp& problem) {
  return problem.size() <= kExactRows && !problem.discs() && count_cells(problem) <= kExactCells;
}

bool Judge::proves_infeasible(const Lcp& problem, const Vector& u) {
  const Index n = problem.size();
  if (n == 0 || u.size() != n) return false;
  const double* const lo = problem.lo.data();
  const double* const hi = problem.hi.data();
  double norm1 = 0;
  for (Index i = 0; i < n; ++i) {
    const bool below = lo[i] != -kInf, above = hi[i] != kInf;
    const bool allowed = below == above ? (below ? u[i] == 0 : true) : (below ? u[i] >= 0 : u[i] <= 0);
    if (!allowed || !std::isfinite(u[i])) return false;
    norm1 += std::abs(u[i]);
  }
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t)
      if (u[t] != 0) return false;

  product(problem.A, u, true);
  const auto error = [&](Index j) { return 1.01L * g_error_[at(j)]; };  // 1.01: its own sum was rounded, too

  // Friction rows take part through their normal: sup over ‖z_t‖ ≤ μ z_n of g_n z_n + g_tᵀz_t = (g_n + μ ‖g_t‖) z_n.
  // A z that uses the slack of the sum has at least one of its terms: the least of them is what κ is relative to.
  least_ = g_abs_;
  for (const Friction& f : problem.friction)
    if (g_[at(f.normal)] + error(f.normal) <= 0) least_[at(f.normal)] = std::numeric_limits<long double>::infinity();
  for (const Friction& f : problem.friction) {
    const Index last = f.first + f.rows - 1;  // of an interval the same row
    if (f.mu == 0 || (g_abs_[at(f.first)] == 0 && g_abs_[at(last)] == 0)) continue;
    for (const Index t : {f.first, last})
      if (g_abs_[at(t)] > 0) least_[at(f.normal)] = std::min(least_[at(f.normal)], f.mu * g_abs_[at(t)]);
    long double length = std::abs(g_[at(f.first)]) + error(f.first);
    if (last > f.first) length = std::hypot(length, std::abs(g_[at(last)]) + error(last)) * (1 + 4 * kRounding);
    const long double push = f.mu * length;
    g_[at(f.normal)] += push;
    g_abs_[at(f.normal)] += push;
    g_error_[at(f.normal)] += 4 * kRounding * std::max(std::abs(g_[at(f.normal)]), push);
    g_[at(f.first)] = g_abs_[at(f.first)] = 0;
  }
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t) g_[at(t)] = g_abs_[at(t)] = 0;

  long double sum = 0, sum_abs = 0, kappa = 0;
  int terms = 0;
  const auto add = [&](long double product) {
    sum += product;
    sum_abs += std::abs(product);
    terms += product != 0;
  };
  for (Index i = 0; i < n; ++i) add(static_cast<long double>(problem.b[i]) * u[i]);
  for (Index j = 0; j < n; ++j) {
    if (g_abs_[at(j)] == 0) continue;
    const long double g = g_[at(j)], e = error(j);
    if (hi[j] == kInf && g + e > 0) kappa = std::max(kappa, (g + e) / least_[at(j)]);
    if (lo[j] == -kInf && g - e < 0) kappa = std::max(kappa, (e - g) / least_[at(j)]);
    // The supremum lies at a finite bound; where the sign of g is not certain, both candidates count.
    long double best = -std::numeric_limits<long double>::infinity();
    if (lo[j] != -kInf) best = std::max({best, (g - e) * lo[j], (g + e) * lo[j]});
    if (hi[j] != kInf && (lo[j] == -kInf || g + e > 0)) best = std::max({best, (g - e) * hi[j], (g + e) * hi[j]});
    if (best > -std::numeric_limits<long double>::infinity()) add(best);
  }
  if (!(kappa <= 32 * static_cast<long double>(kEpsilon))) return false;
  if (kappa > 0 && wants_exact_proof(problem)) return finite(problem) && proves_exactly(problem, u);

  long double threshold = terms <= 1 ? 0 : static_cast<long double>(n + 4) * 2 * kRounding * sum_abs;
  if (kappa > 0) {
    double scale = 0;  // of the rows that the proof speaks of, and of those they are coupled with
    bool bounded = false;
    beta_.resize(n);
    label_parts(problem);
    spoken_.assign(at(n), 0);
    for (Index i = 0; i < n; ++i)
      if (u[i] != 0) spoken_[at(part_[at(i)])] = 1;
    const auto spoken = [this](Index i) { return spoken_[at(part_[at(i)])] != 0; };
    for (Index i = 0; i < n; ++i) {
      const double low = std::abs(lo[i]), high = std::abs(hi[i]);
      beta_[i] = std::max(low < kInf ? low : 0, high < kInf ? high : 0);
      bounded = bounded || beta_[i] != 0;
      if (spoken(i)) scale = std::max(scale, std::abs(problem.b[i]));
    }
    if (bounded) {
      detail::sum_rows(problem.A, problem.b, beta_, zero_w_, floor_, inner_, inner_abs_);
      for (Index i = 0; i < n; ++i)
        if (spoken(i)) scale = std::max(scale, floor_[i]);
    }
    if (scale < kProducts) return false;
    threshold += 2 * kappa * unknowable(scale) * norm1;
  }
  return sum + threshold < 0;
}

}  // namespace orthant
