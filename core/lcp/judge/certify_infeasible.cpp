// Farkas' proof of infeasibility, checked: sums with bounds of their rounding; rationals where these do not decide.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_sums.h>
#include <orthant/core/lcp/judge/exact_proof.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace orthant {
namespace {

using detail::kRounding;

constexpr long double kFarOff = 0x1p-29;  // of its terms: a sum of the wrong sign that no last digits mend

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
  const long double unit = transposed ? static_cast<long double>(terms(A) + 4) * kRounding : 0;
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
    g_error_[at(i)] = unit * g_abs_[at(i)];
  }
}

bool Judge::proves_infeasible(const Lcp& problem, const Vector& u) {
  const Index n = problem.size();
  proved_ = nullptr;
  if (trusted_ == &problem && u.size() == n && trusted_proof_.size() == n && trusted_proof_ == u)
    return proof_ = u, in_doubles_ = trusted_in_doubles_, proved_ = &problem, true;
  if (n == 0 || u.size() != n) return false;
  const double* const lo = problem.lo.data();
  const double* const hi = problem.hi.data();
  for (Index i = 0; i < n; ++i) {
    const bool below = lo[i] != -kInf, above = hi[i] != kInf;
    const bool allowed = below == above ? (below ? u[i] == 0 : true) : (below ? u[i] >= 0 : u[i] <= 0);
    if (!allowed || !std::isfinite(u[i])) return false;
  }
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t)
      if (u[t] != 0) return false;

  proof_ = u;
  const Weighed weighed = weigh_proof(problem, u);
  Proved proved = weighed == Weighed::proves ? Proved::by_doubles : Proved::no;
  if (weighed == Weighed::open && finite(problem)) proved = prove_exactly(problem, proof_, stop_);
  if (proved == Proved::no) return false;
  in_doubles_ = proved == Proved::by_doubles;
  proved_ = &problem;
  return true;
}

// With doubles and bounds of their rounding; open: rationals may decide.
Judge::Weighed Judge::weigh_proof(const Lcp& problem, const Vector& u) {
  constexpr long double kNone = -std::numeric_limits<long double>::infinity();
  const Index n = problem.size();
  product(problem.A, u, true);
  const auto error = [&](Index j) { return 1.01L * g_error_[at(j)]; };  // 1.01: its own sum was rounded, too

  // Friction rows take part through their normal: sup over ‖z_t‖ ≤ μ z_n of g_n z_n + g_tᵀz_t = (g_n + μ ‖g_t‖) z_n.
  for (const Friction& f : problem.friction) {
    const Index last = f.first + f.rows - 1;  // of an interval the same row
    if (f.mu == 0 || (g_abs_[at(f.first)] == 0 && g_abs_[at(last)] == 0)) continue;
    long double length = std::abs(g_[at(f.first)]) + error(f.first);
    if (last > f.first) length = std::hypot(length, std::abs(g_[at(last)]) + error(last)) * (1 + 4 * kRounding);
    const long double push = f.mu * length;
    g_[at(f.normal)] += push;
    g_abs_[at(f.normal)] += push;
    g_error_[at(f.normal)] += 4 * kRounding * std::max(std::abs(g_[at(f.normal)]), push);
  }
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t) g_[at(t)] = g_abs_[at(t)] = 0;

  long double sum = 0, sum_abs = 0;
  int terms = 0;
  bool open = false;
  const auto add = [&](long double product) {
    sum += product;
    sum_abs += std::abs(product);
    terms += product != 0;
  };
  for (Index i = 0; i < n; ++i) add(static_cast<long double>(problem.b[i]) * u[i]);
  for (Index j = 0; j < n; ++j) {
    if (g_abs_[at(j)] == 0) continue;
    const long double g = g_[at(j)], e = error(j), far = kFarOff * g_abs_[at(j)];
    if ((problem.hi[j] == kInf && g - e > far) || (problem.lo[j] == -kInf && g + e < -far)) return Weighed::no;
    open = open || (problem.hi[j] == kInf && g + e > 0) || (problem.lo[j] == -kInf && g - e < 0);
    // The supremum lies at a finite bound; where the sign of g is not certain, both candidates count.
    long double best = kNone;
    if (problem.lo[j] != -kInf) best = std::max({best, (g - e) * problem.lo[j], (g + e) * problem.lo[j]});
    if (problem.hi[j] != kInf && (problem.lo[j] == -kInf || g + e > 0))
      best = std::max({best, (g - e) * problem.hi[j], (g + e) * problem.hi[j]});
    if (best > kNone) add(best);
  }
  if (open) return Weighed::open;
  const long double threshold = terms <= 1 ? 0 : static_cast<long double>(n + 4) * 2 * kRounding * sum_abs;
  return sum + threshold < 0 ? Weighed::proves : sum - threshold < 0 ? Weighed::open : Weighed::no;
}

}  // namespace orthant
