#include <orthant/solvers/proof/farkas.h>

#include <orthant/solvers/proof/farkas_simplex.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {

namespace {

/// Brings the largest entry of A and of q to 1 where it is far from there: the tableau compares them with c = 1.
class Units {
 public:
  Units(const DenseMatrix& A, const Vector& b, const detail::Scaling& scaling) {
    for (Index i = 0; i < A.rows(); ++i) {
      for (Index j = 0; j < A.cols(); ++j) grow(A_, A(i, j), scaling.row[i], scaling.col[j]);
      grow(b_, b[i], scaling.row[i], 1);
    }
  }
  double row(double scale) const { return std::ldexp(scale, -near(A_)); }
  double constant(double b) const { return std::ldexp(b, near(A_) - near(b_)); }  // is multiplied by row()

 private:
  static constexpr int kNear = 100, kNone = -10000;  // exponents of 2
  static void grow(int& most, double value, double row, double col) {
    if (value != 0) most = std::max(most, std::ilogb(value) + std::ilogb(row) + std::ilogb(col));
  }
  static int near(int exponent) { return std::abs(exponent) <= kNear || exponent == kNone ? 0 : exponent; }

  int A_ = kNone, b_ = kNone;
};

struct Skew {
  const DenseMatrix& M;
  double operator()(Index i, Index j) const {
    const Index n = M.rows();
    if (i < n && j >= n) return -M(j - n, i);
    return i >= n && j < n ? M(i - n, j) : 0.0;
  }
};

}  // namespace

bool Farkas::propose(const Lcp& problem, Vector& u, const Budget& budget) {
  if (problem.size() == 0) return false;
  if (problem.size() > (has_simplex() ? kTableau : kTableauAlone)) return propose_by_simplex(problem, budget, u);
  const Lcp& pure = pyramid_.pure(problem);
  const Index n = pure.size();
  const auto& M = std::get<DenseMatrix>(pure.A);
  scaling_.fit(M);
  const Units units(M, pure.b, scaling_);
  q_.resize(2 * n);
  scale_.resize(2 * n);
  free_.resize(static_cast<std::size_t>(2 * n));
  for (Index i = 0; i < n; ++i) {
    const bool free = pure.lo[i] == -kInf;
    q_[i] = free ? 0.0 : 1.0 / scaling_.col[i];
    q_[n + i] = units.constant(pure.b[i]);
    scale_[i] = scaling_.col[i];
    scale_[n + i] = units.row(scaling_.row[i]);
    free_[static_cast<std::size_t>(i)] = free_[static_cast<std::size_t>(n + i)] = free;
  }
  const auto late = [&budget](auto...) { return budget.exhausted(); };
  tableau_.load(Skew{M}, q_, free_, scale_, scale_, late);
  using End = detail::Tableau<long double>::End;
  const End end = tableau_.run(2000 + 20 * static_cast<int>(n), late);
  if (end == End::circle || end == End::limit) return propose_by_simplex(problem, budget, u);
  if (end != End::ray) return false;
  ray_.resize(2 * n);
  ray_.setZero();
  tableau_.ray(ray_);
  pure_u_ = ray_.tail(n).cwiseProduct(scaling_.row);
  tidy_certificate(pure, pure_u_);
  pyramid_.restore_certificate(problem, pure_u_, u);
  return true;
}

Lcp with_margin(const Lcp& problem, double margin, const Vector& u, bool same_rows,
                const std::function<bool(Index)>& in_column) {
  constexpr double kLarge = 0x1p960, kSmaller = 0x1p-96;  // sums of entries overflow; a proof needs no unit
  const Index n = problem.size();
  Lcp result = problem;
  std::vector<Friction> of_normal(at(n));  // mu = 0: none
  for (const Friction& f : problem.friction) of_normal[at(f.normal)] = f;
  DenseMatrix size, A;
  const auto* const contacts = std::get_if<Delassus>(&problem.A);
  to_dense(problem.A, A);
  size = A.cwiseAbs();
  if (contacts != nullptr) {  // |W| M⁻¹ |W|ᵀ: what its entries cancel from
    Delassus without_signs = *contacts;
    for (double& value : without_signs.W.value) value = std::abs(value);
    to_dense(Matrix(without_signs), size);
  }
  if (size.size() > 0 && size.maxCoeff() > kLarge) A *= kSmaller, size *= kSmaller, result.b *= kSmaller;
  for (Index i = 0; i < n; ++i) {
    const double sign = problem.lo[i] != -kInf ? 1 : problem.hi[i] != kInf ? -1 : (u[i] > 0) - (u[i] < 0);
    size.row(i) *= sign;
    if (!same_rows || u[i] != 0) continue;
    A.row(i).setZero(), size.row(i).setZero();
    result.b[i] = sign;
  }
  for (Index j = 0; j < n; ++j) {
    const bool below = problem.lo[j] != -kInf, above = problem.hi[j] != kInf;
    if (below == above || !in_column(j)) continue;
    Vector terms = size.col(j);
    const Friction& f = of_normal[at(j)];
    for (Index t = f.first; f.mu > 0 && t < f.first + f.rows; ++t) terms += f.mu * size.col(t);
    A.col(j) += (below ? margin : -margin) * terms;
  }
  result.A = std::move(A);
  return result;
}

bool in_whole_numbers(Vector& u) {
  constexpr double kMost = 4096, kOff = 1e-10;  // of u: its digits, from a tableau
  const auto whole = [](double x) { return std::abs(x - std::round(x)); };
  for (double k = 1; k <= kMost; ++k)
    if (std::all_of(u.begin(), u.end(), [&](double x) { return whole(k * x) <= k * kOff; })) {
      for (double& x : u) x = std::round(k * x);
      return true;
    }
  return false;
}

void tidy_certificate(const Lcp& p, Vector& u) {
  const double size = u.cwiseAbs().maxCoeff();
  for (Index i = 0; i < u.size(); ++i) {
    u[i] /= size;
    if (!(std::abs(u[i]) >= 1e-14) || (u[i] < 0 && p.lo[i] != -kInf) || (u[i] > 0 && p.hi[i] != kInf)) u[i] = 0;
  }
}

}  // namespace orthant
