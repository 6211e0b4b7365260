#include <orthant/core/lcp/judge/error_bound.h>

#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/definite.h>
#include <orthant/core/lcp/judge/exact.h>

#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

using exact::Filtered;
using exact::Sign;
using Sparse = Formed::Sparse;
using Errors = std::vector<Filtered>;

constexpr Index kEnumerated = 12;
constexpr double kUp = 1 + 0x1p-40;  // covers the few roundings of what it multiplies

double at_most(const Filtered& x) { return (std::abs(x.value) + x.error) * kUp; }
double least(const Filtered& x) { return x.value - x.error; }

Errors slack(const Formed& A, const Lcp& problem, const Vector& z) {
  Errors w(at(z.size()));
  for (Index i = 0; i < z.size(); ++i) w[at(i)] = problem.b[i];
  for_each_entry(A, [&](Index i, Index j, const Filtered& a) { exact::add_product(w[at(i)], a, Filtered(z[j])); });
  return w;
}

// z − clamp(z − w/d, lo, hi) = clamp(w/d, z − hi, z − lo): as uncertain as w/d, but where that is cut off for certain.
Filtered residual(double z, double lo, double hi, const Filtered& w, const Filtered& d) {
  const Filtered step = exact::quotient(w, d);
  const double most = z - lo, least_step = z - hi;
  Filtered r(std::clamp(step.value, least_step, most));
  const bool cut = step.value - step.error > most || step.value + step.error < least_step;
  if (!cut) r.error = step.error;
  if (r.value != 0 || r.error != 0) r.error = (r.error + (std::abs(r.value) + r.error) * 0x1p-51) * kUp + 0x1p-1000;
  return r;
}

double bound_h_plus(const Formed& A, const Lcp& problem, const Vector& z, const Errors& w) {
  const Index n = z.size();
  Eigen::VectorXd right(n);
  for (Index i = 0; i < n; ++i) {
    const Filtered d = entry(A, i, i);
    if (exact::sign(d) != Sign::positive) return kInf;
    right[i] = at_most(residual(z[i], problem.lo[i], problem.hi[i], w[at(i)], d)) * (d.value + d.error) * kUp;
  }
  if (!right.allFinite()) return kInf;
  Eigen::SparseLU<Sparse> lu(comparison(A));
  if (lu.info() != Eigen::Success) return kInf;
  const Eigen::VectorXd d = lu.solve(Eigen::VectorXd::Ones(n)), start = lu.solve(right);
  if (!start.allFinite() || !surely_m_matrix(A, d)) return kInf;
  double extra = right.maxCoeff() * 0x1p-40 + 0x1p-1000;
  for (int k = 0; k < 30; ++k, extra *= 4) {  // ⟨A⟩ d = e: the multiple of d makes every row of ⟨A⟩ v larger
    const Eigen::VectorXd v = start + extra * d;
    const Errors sums = comparison_times(A, v);
    bool enough = v.minCoeff() >= 0;
    for (Index i = 0; enough && i < n; ++i) enough = least(sums[at(i)]) >= right[i];
    if (enough) return v.maxCoeff();
  }
  return kInf;
}

double bound_definite(const Formed& A, const Lcp& problem, const Vector& z, const Errors& w,
                      const std::function<bool()>& stop) {
  const Index n = z.size();
  const Formed S = symmetric_part(A);
  double modulus = 0.99 * Eigen::VectorXd(S.value.diagonal()).minCoeff();
  if (!surely_definite(S)) return kInf;
  for (int k = 0; !surely_definite(S, modulus); ++k) {
    if (k == 150 || stop()) return kInf;
    modulus /= k < 20 ? std::sqrt(2.0) : 2.0;
  }
  const Filtered d(Eigen::VectorXd(A.value.diagonal()).maxCoeff());  // w/d: any d > 0 will do, this one keeps r small
  Errors r(at(n)), sum(at(n));
  for (Index i = 0; i < n; ++i) {
    r[at(i)] = residual(z[i], problem.lo[i], problem.hi[i], w[at(i)], d);
    exact::add_product(sum[at(i)], d, r[at(i)]);
  }
  for_each_entry(A, [&](Index i, Index j, const Filtered& a) { exact::add_product(sum[at(j)], a, r[at(i)]); });
  double most = 0, square = 0;  // of what is over the largest: a square of 1e-170 is no number
  for (const Filtered& x : sum) most = std::max(most, at_most(x));
  if (most == 0) return 0;
  for (const Filtered& x : sum) square += at_most(x) / most * (at_most(x) / most);
  return most / modulus * std::sqrt(square) * (1 + static_cast<double>(n + 9) * 0x1p-52);
}

// Solves B x = last column, rows pivoted; false: a pivot's sign is open.
bool solve(std::vector<Errors>& B) {
  const std::size_t m = B.size();
  for (std::size_t k = 0; k < m; ++k) {
    std::size_t r = k;
    for (std::size_t i = k; i < m; ++i)
      if (exact::weight(B[i][k]) > exact::weight(B[r][k])) r = i;
    if (exact::weight(B[r][k]) == 0) return false;
    std::swap(B[r], B[k]);
    for (std::size_t i = 0; i < m; ++i) {
      if (i == k) continue;
      const Filtered factor = exact::quotient(B[i][k], B[k][k]);
      for (std::size_t j = k + 1; j <= m; ++j) exact::subtract_product(B[i][j], factor, B[k][j]);
    }
  }
  return true;
}

double bound_p(const Formed& A, const Lcp& problem, const Vector& z, const Errors& w) {
  const Index n = z.size();
  if (n > kEnumerated || analyse(problem.A).p != Verdict::yes) return kInf;
  Errors r(at(n));
  for (Index i = 0; i < n; ++i)  // rows divided by A_ii > 0, as for H₊
    r[at(i)] = residual(z[i], problem.lo[i], problem.hi[i], w[at(i)], entry(A, i, i));
  double bound = 0;
  std::vector<Index> rows;
  for (unsigned long subset = 0; subset >> n == 0; ++subset) {
    rows.clear();
    for (Index i = 0; i < n; ++i) {
      if ((subset >> i & 1UL) != 0)
        rows.push_back(i);
      else
        bound = std::max(bound, at_most(r[at(i)]));
    }
    std::vector<Errors> B(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (const Index j : rows) B[i].push_back(entry(A, rows[i], j));
      Filtered right;
      exact::add_product(right, entry(A, rows[i], rows[i]), r[at(rows[i])]);
      for (Index j = 0; j < n; ++j)
        if ((subset >> j & 1UL) == 0) exact::subtract_product(right, entry(A, rows[i], j), r[at(j)]);
      B[i].push_back(right);
    }
    if (!solve(B)) return kInf;
    for (std::size_t i = 0; i < B.size(); ++i) bound = std::max(bound, at_most(exact::quotient(B[i].back(), B[i][i])));
  }
  return bound;
}

}  // namespace

double error_bound(const Lcp& problem, const Vector& z, const std::function<bool()>& asked) {
  check(problem);
  const Index n = problem.size();
  if (z.size() != n) throw std::invalid_argument("error_bound: z must have " + std::to_string(n) + " entries");
  if (n == 0) return 0;
  if (!problem.friction.empty() || !finite(problem) || !z.allFinite()) return kInf;
  const Formed A = formed(problem.A);
  const Errors w = slack(A, problem, z);
  double bound = bound_h_plus(A, problem, z, w);
  const auto stop = [&] { return asked && asked(); };
  if (!stop()) bound = std::min(bound, bound_definite(A, problem, z, w, stop));
  if (bound == kInf) bound = bound_p(A, problem, z, w);
  return bound >= 0 ? bound : kInf;  // NaN: no bound
}

}  // namespace orthant
