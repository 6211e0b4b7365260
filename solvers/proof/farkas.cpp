#include <orthant/solvers/proof/farkas.h>

#include <orthant/solvers/proof/farkas_simplex.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

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
  q_.resize(2 * n);
  scale_.resize(2 * n);
  free_.resize(static_cast<std::size_t>(2 * n));
  for (Index i = 0; i < n; ++i) {
    const bool free = pure.lo[i] == -kInf;
    q_[i] = free ? 0.0 : 1.0 / scaling_.col[i];
    q_[n + i] = pure.b[i];
    scale_[i] = scaling_.col[i];
    scale_[n + i] = scaling_.row[i];
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
