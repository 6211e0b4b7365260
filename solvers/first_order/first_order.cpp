#include <orthant/solvers/first_order/first_order.h>

#include <sstream>

namespace orthant {

constexpr int kPatience = 16384;  // slow modes may let the violation rise for thousands of iterations

Claim FirstOrder::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  load(problem, s.z);  // in any case: what a solver allocates, it allocates at the first problem of a size
  if (passes(problem, s) && start == Start::warm) return Claim::candidate;  // cold: 0 may pass where units differ
  double mark = accepted();
  double least = kInf, before = kInf;  // least violation, and what it was at the last look ahead
  int least_at = 0, look_at = first_look_ahead();
  while (s.iterations < max_iterations()) {
    ++s.iterations;
    last_ = s.z;
    const Step step = advance(problem, s.z);
    log(s.iterations, step.violation, step.length, step.event);
    if (step.end == Claim::ray) {
      s.ray = *step.ray;
      tidy_certificate(problem, s.ray);
    }
    if (step.end) return *step.end;
    if (!std::isfinite(step.violation)) {
      s.z = last_;
      return Claim::numerical_error;
    }
    if (step.violation <= mark || !step.moved) {
      if (passes(problem, s)) return Claim::candidate;
      if (!step.moved) return Claim::stalled;
      mark = step.violation * std::clamp(accepted() / s.residual, 1e-3, 0.5);
    }
    if (step.violation < (1 - 1e-9) * least) least = step.violation, least_at = s.iterations;
    if (s.iterations >= kPatience && s.iterations / 8 >= least_at) return Claim::stalled;
    if (s.iterations == look_at) {
      const double digits = std::log(least / mark), won = std::log(before / least);  // won in the last half
      if (digits > 0 && !(digits * s.iterations / 2 <= won * (max_iterations() - s.iterations)))
        return Claim::iteration_limit;
      before = least, look_at *= 2;
    }
    if (budget().exhausted()) return Claim::time_limit;
  }
  return Claim::iteration_limit;
}

namespace detail {
namespace {

std::string named(Index i, Index j, double value) {
  std::ostringstream text;
  text << "entry (" << i << ", " << j << ") = " << value;
  return text.str();
}

}  // namespace

std::string diagonal_why_not(const Matrix& A, bool zero_allowed) {
  for (Index i = 0; i < order(A); ++i)
    if (const double d = diagonal(A, i); !(d > 0 || (zero_allowed && d == 0)))
      return named(i, i, d) + ": must be " + (zero_allowed ? ">= 0" : "> 0");
  return {};
}

std::string quadratic_why_not(const Matrix& A) {
  std::string reason = diagonal_why_not(A, true);
  if (!reason.empty()) return reason;
  for_each_entry(A, [&](Index i, Index j, double value) {
    if (i == j || value == 0) return true;
    const double other = entry(A, j, i);
    const double size = std::sqrt(diagonal(A, i)) * std::sqrt(diagonal(A, j));
    if (!(std::abs(value - other) <= 1e-12 * size))
      reason =
          named(i, j, value) + ", " + named(j, i, other) + ": must be equal, the method minimizes a quadratic form";
    else if (!(std::abs(value) <= (1 + 1e-12) * size))
      reason = named(i, j, value) + ": larger than its diagonal entries allow, the matrix is not positive semidefinite";
    return reason.empty();
  });
  return reason;
}

namespace {

/// y ≥ |A| x for x ≥ 0; equal where A is stored by entries, else y = |W| M⁻¹ |W|ᵀ x + R x.
void absolute_product(const Matrix& A, const Vector& x, Vector& y, Vector& scratch) {
  y.resize(order(A));
  y.setZero();
  if (for_each_entry(A, [&](Index i, Index j, double value) { y[i] += std::abs(value) * x[j]; })) return;
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  const auto each = [&W = W](const auto& use) {
    for (Index i = 0; i < W.rows; ++i) W.for_each_in_row(i, [&](Index k, double w) { use(i, k, std::abs(w)); });
  };
  scratch.resize(W.cols);
  scratch.setZero();
  each([&](Index i, Index k, double value) { scratch[k] += value * x[i]; });
  scratch.array() *= inverse_mass.array();
  if (regularization.size() != 0) y = regularization.cwiseProduct(x);
  each([&](Index i, Index k, double value) { y[i] += value * scratch[k]; });
}

}  // namespace

void RowSums::evaluate(const Matrix& A, const Vector& d) {
  x_ = d.cwiseSqrt().cwiseInverse();
  absolute_product(A, x_, sums, inner_);
  sums.array() *= d.array().sqrt();
}

double largest_ratio(const Matrix& A, const Vector& d, const Vector& b, Vector& x, Vector& Ax, Vector& scratch) {
  double largest = 0;
  x = b.cwiseQuotient(d);
  if (!(x.squaredNorm() > 0)) x.setOnes();
  for (int k = 0; k < 10; ++k) {
    x /= std::sqrt(dot(d, x, x));
    multiply(A, x, Ax, scratch);
    largest = std::max(largest, x.dot(Ax));
    if (!(Ax.squaredNorm() > 0)) break;
    x = Ax.cwiseQuotient(d);
  }
  return largest;
}

void HeldBounds::load(const Lcp& problem, Vector& z) {
  lo = problem.lo, hi = problem.hi;
  diagonal(problem.A, d);
  // A zero diagonal entry takes the row's largest, negated.
  for_each_entry(problem.A, [&](Index i, Index j, double value) {
    if (i != j && d[i] <= 0) d[i] = std::min(d[i], -std::abs(value));
  });
  for (double& value : d) value = value == 0 ? 1 : std::abs(value);
  hold(problem, z);
}

void HeldBounds::hold(const Lcp& problem, Vector& z) {
  z = z.cwiseMax(problem.lo).cwiseMin(problem.hi);
  for (const Friction& f : problem.friction) {
    hi[f.first] = f.mu * z[f.normal], lo[f.first] = -hi[f.first];
    z[f.first] = std::clamp(z[f.first], lo[f.first], hi[f.first]);
  }
}

double HeldBounds::violation(const Lcp& problem, const Vector& z, const Vector& w) {
  held_ = 0;
  for (Index i = 0; i < z.size(); ++i) raise(held_, row(i, z[i], w[i], lo[i], hi[i]));
  true_ = held_;
  for (const Friction& f : problem.friction) {
    const double bound = f.mu * z[f.normal];
    raise(true_, row(f.first, z[f.first], w[f.first], -bound, bound));
  }
  return true_;
}

}  // namespace detail
}  // namespace orthant
