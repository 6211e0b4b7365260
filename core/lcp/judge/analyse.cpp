#include <orthant/core/lcp/judge/analyse.h>

#include <orthant/core/lcp/judge/definite.h>
#include <orthant/core/lcp/judge/exact_classes.h>
#include <orthant/core/support/factorization_cost.h>
#include <orthant/core/support/ordering_cost.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SparseLU>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

using exact::Filtered;
using exact::Rational;
using exact::Sign;
using Sparse = Formed::Sparse;

constexpr Index kElimination = 40;  // rows that are eliminated in rationals
constexpr Index kSubsets = 12;      // rows of which all subsets are examined
constexpr Index kSignPatterns = 5;  // rows of which all supports with all signs are examined
constexpr Index kDense = 1000;      // rows for dense eigenvalues and factorizations

Verdict verdict(bool yes) { return yes ? Verdict::yes : Verdict::no; }

class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  bool affords(double operations) const {
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin_;
    return operations <= kOperationsPerSecond * (seconds_ - gone.count());
  }
  /// A sparse LU factorization, or a Cholesky factorization.
  bool affords(const Sparse& A) const {
    const auto n = static_cast<int>(A.rows());
    return seconds_ == kInf || (affords(ordering_cost(n, A.outerIndexPtr(), A.innerIndexPtr())) &&
                                affords(factorization_cost(n, A.outerIndexPtr(), A.innerIndexPtr())));
  }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Sign of xᵀS x with all errors counted.
Sign quadratic(const Formed& S, const Eigen::VectorXd& x) {
  Filtered sum;
  for_each_entry(S, [&](Index i, Index j, const Filtered& a) {
    Filtered product;
    exact::add_product(product, a, Filtered(x[i]));
    exact::add_product(sum, product, Filtered(x[j]));
  });
  return exact::sign(sum);
}

// A direction with xᵀS x < 0 that has been checked.
bool surely_not_semidefinite(const Formed& S, const Deadline& deadline) {
  const Index n = S.value.rows();
  Eigen::VectorXd x = Eigen::VectorXd::Unit(n, 0);
  const Eigen::VectorXd diagonal = S.value.diagonal();
  for (Index i = 0; i < n; ++i)
    if (diagonal[i] <= 0 && quadratic(S, Eigen::VectorXd::Unit(n, i)) == Sign::negative) return true;
  for (Index j = 0; j < n; ++j)
    for (Sparse::InnerIterator it(S.value, j); it && it.row() < j; ++it) {
      const double a = diagonal[it.row()], b = diagonal[j], c = it.value();
      if (c * c <= a * b) continue;
      x.setZero();
      x[it.row()] = a > 0 ? -c / a : -std::copysign(1.0, c) * (1 + std::abs(b / c));
      x[j] = 1;
      if (quadratic(S, x) == Sign::negative) return true;
    }
  const auto size = static_cast<double>(n);
  if (n <= kDense && deadline.affords(10 * size * size * size)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen{Eigen::MatrixXd(S.value)};
    return eigen.info() == Eigen::Success && quadratic(S, eigen.eigenvectors().col(0)) == Sign::negative;
  }
  // The power method on ‖S‖ − S: enough where S is clearly indefinite.
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(n);
  for (Index j = 0; j < n; ++j)
    for (Sparse::InnerIterator it(S.value, j); it; ++it) sums[j] += std::abs(it.value());
  for (Index i = 0; i < n; ++i) x[i] = 1 + 0.5 * std::sin(static_cast<double>(7 * i));
  for (int k = 0; k < 300; ++k) x = (sums.maxCoeff() * x - S.value * x).normalized();
  return quadratic(S, x) == Sign::negative;
}

bool surely_h_matrix(const Formed& A) {
  Eigen::SparseLU<Sparse> lu(comparison(A));
  return lu.info() == Eigen::Success && surely_m_matrix(A, lu.solve(Eigen::VectorXd::Ones(A.value.rows())));
}

// Row by row |A_ii| > Σ |A_ij|; entries without errors are settled exactly.
Verdict dominant(const Formed& A) {
  const Index n = A.value.rows();
  const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = A.value, errors = A.error;
  const bool stored = errors.nonZeros() == 0;
  Verdict result = Verdict::yes;
  for (Index i = 0; i < n; ++i) {
    Filtered sum;
    Rational settled = 0;
    const auto add = [&](double value) { exact::add_product(sum, Filtered(value), Filtered(1.0)); };
    for (decltype(rows)::InnerIterator it(rows, i); it; ++it)
      add(it.col() == i ? std::abs(it.value()) : -std::abs(it.value()));
    for (decltype(rows)::InnerIterator it(errors, i); it; ++it) sum.error += it.value() * (1 + 0x1p-40);
    Sign s = exact::sign(sum);
    if (s == Sign::unknown && stored) {
      for (decltype(rows)::InnerIterator it(rows, i); it; ++it)
        settled += it.col() == i ? std::abs(it.value()) : -std::abs(it.value());
      s = exact::sign(settled);
    }
    if (s == Sign::negative || s == Sign::zero) return Verdict::no;
    if (s == Sign::unknown) result = Verdict::not_decided;
  }
  return result;
}

double as_condition(double value, bool regular) {
  return regular || value * std::numeric_limits<double>::epsilon() < 1 ? value : kInf;
}

// The same of a regular matrix that is singular to working precision.
double exact_condition(const exact::Table& A) {
  const std::size_t n = A.size();
  exact::Table B = A;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) B[i].push_back(i == j ? 1 : 0);
  exact::eliminate(B);
  const auto norm = [n](const exact::Table& table, std::size_t first) {
    Rational largest = 0;
    for (std::size_t j = first; j < first + n; ++j) {
      Rational sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += abs(table[i][j]);
      if (sum > largest) largest = sum;
    }
    return largest;
  };
  return static_cast<double>(Rational(norm(A, 0) * norm(B, n)));
}

// ‖A⁻¹‖₁ from below by Hager's method, a few solves.
double condition(const Sparse& A, bool regular) {
  const Index n = A.rows();
  double norm = 0;
  for (Index j = 0; j < n; ++j) {
    double sum = 0;
    for (Sparse::InnerIterator it(A, j); it; ++it) sum += std::abs(it.value());
    norm = std::max(norm, sum);
  }
  Eigen::SparseLU<Sparse> lu(A);
  if (lu.info() != Eigen::Success) return kInf;
  Eigen::SparseLU<Sparse> lu_transposed(Sparse(A.transpose()));
  if (lu_transposed.info() != Eigen::Success) return kInf;
  Eigen::VectorXd x = Eigen::VectorXd::Constant(n, 1 / static_cast<double>(n));
  double estimate = 0;
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd y = lu.solve(x);
    if (!y.allFinite()) return kInf;
    if (y.lpNorm<1>() <= estimate) break;
    estimate = y.lpNorm<1>();
    const Eigen::VectorXd z = lu_transposed.solve(y.unaryExpr([](double v) { return v < 0 ? -1.0 : 1.0; }));
    Index j = 0;
    z.cwiseAbs().maxCoeff(&j);
    x = Eigen::VectorXd::Unit(n, j);
  }
  return as_condition(norm * estimate, regular);
}

// Diagonal entries, then blocks of two: the cheap witnesses.
void small_minors(const Formed& A, Analysis& result) {
  const auto refute = [&](std::vector<Index> rows, Sign det) {
    if (det == Sign::positive || det == Sign::unknown) return;
    if (result.p != Verdict::no) result.not_p = std::move(rows);
    result.p = Verdict::no;
    if (det == Sign::negative) result.p0 = Verdict::no;
  };
  for (Index i = 0; i < A.value.rows(); ++i) refute({i}, exact::sign(entry(A, i, i)));
  for (Index j = 0; j < A.value.outerSize(); ++j)
    for (Sparse::InnerIterator it(A.value, j); it && it.row() < j; ++it) {
      const Index i = it.row();
      if (!(it.value() * A.value.coeff(j, i) > 0)) continue;
      Filtered minor;
      exact::add_product(minor, entry(A, i, i), entry(A, j, j));
      exact::subtract_product(minor, entry(A, i, j), entry(A, j, i));
      refute({i, j}, exact::sign(minor));
    }
}

/// Fills in one answer after the other. Answers given before a stop hold. One function, because each answer rests on
/// those before it.
void decide(const Matrix& A, const std::function<bool()>& stop, const Deadline& deadline, Analysis& result) {
  const Index n = result.n;
  const auto is_yes = [](Verdict v) { return v == Verdict::yes; };
  const auto settle = [](Verdict& v, Verdict to) {
    if (v == Verdict::not_decided) v = to;
  };
  if (n == 0) {  // every condition on nothing holds
    for (Verdict* v : {&result.symmetric, &result.z, &result.k, &result.diagonally_dominant, &result.h_plus,
                       &result.positive_definite, &result.positive_semidefinite, &result.p, &result.p0,
                       &result.copositive, &result.column_sufficient, &result.row_sufficient})
      *v = Verdict::yes;
    result.rank = 0;
    result.condition = 1;
    return;
  }
  const bool delassus = std::holds_alternative<Delassus>(A);
  const Formed f = formed(A);
  const Formed S = symmetric_part(f);
  exact::Table exactly;
  if (n <= kElimination) exactly = exact::table(A);

  // Signs of entries.
  const Sparse skew = f.value - Sparse(f.value.transpose());
  result.symmetric = verdict(delassus || skew.nonZeros() == 0 || skew.coeffs().abs().maxCoeff() == 0);
  result.z = Verdict::yes;
  bool nonnegative = true, diagonal_positive = true;
  result.smallest = kInf;
  for (Index j = 0; j < n; ++j)
    for (Sparse::InnerIterator it(f.value, j); it; ++it) {
      const double a = it.value(), e = delassus ? f.error.coeff(it.row(), j) : 0;
      if (a != 0) {
        result.smallest = std::min(result.smallest, std::abs(a));
        result.largest = std::max(result.largest, std::abs(a));
      }
      nonnegative = nonnegative && a - e >= 0;
      if (it.row() == j || a + e <= 0) continue;
      if (a - e > 0)
        result.z = Verdict::no;
      else if (is_yes(result.z))
        result.z = Verdict::not_decided;
    }
  if (result.largest == 0) result.smallest = 0;
  if (result.z == Verdict::not_decided && !exactly.empty()) {
    result.z = Verdict::yes;
    for (std::size_t i = 0; i < at(n); ++i)
      for (std::size_t j = 0; j < at(n); ++j)
        if (i != j && exactly[i][j] > 0) result.z = Verdict::no;
  }
  for (Index i = 0; i < n; ++i) diagonal_positive = diagonal_positive && f.value.coeff(i, i) > f.error.coeff(i, i);
  result.diagonally_dominant = dominant(f);
  const bool dominates = is_yes(result.diagonally_dominant) && diagonal_positive;
  if (dominates) result.h_plus = result.p = Verdict::yes;  // known even where the time limit ends the rest

  // Definiteness, H₊ and K, rank.
  exact::ask(stop);
  if (!exactly.empty()) {
    const exact::Table symmetric = exact::symmetric_part(exactly);
    result.positive_definite = verdict(exact::leading_minors_positive(symmetric));
    result.positive_semidefinite = verdict(exact::semidefinite(symmetric));
    result.h_plus = Verdict::yes;
    for (std::size_t i = 0; i < at(n); ++i)
      if (exactly[i][i] <= 0) result.h_plus = Verdict::no;
    if (is_yes(result.h_plus)) result.h_plus = verdict(exact::leading_minors_positive(exact::comparison(exactly)));
    exact::Table copy = exactly;
    result.rank = static_cast<Index>(exact::reduce(copy, at(n)).size());
  } else {
    if ((dominates && is_yes(result.symmetric)) || (deadline.affords(S.value) && surely_definite(S)))
      result.positive_definite = result.positive_semidefinite = Verdict::yes;
    else if (delassus)
      result.positive_semidefinite = Verdict::yes;  // W M⁻¹ Wᵀ + R with M⁻¹, R ≥ 0
    else if (surely_not_semidefinite(S, deadline))
      result.positive_definite = result.positive_semidefinite = Verdict::no;
    exact::ask(stop);
    if (dominates || (diagonal_positive && deadline.affords(f.value) && surely_h_matrix(f)))
      result.h_plus = Verdict::yes;
    else if (!delassus && !diagonal_positive)
      result.h_plus = Verdict::no;
    if (is_yes(result.symmetric) && is_yes(result.h_plus))  // then all eigenvalues are positive
      result.positive_definite = result.positive_semidefinite = Verdict::yes;
  }
  // A Z-matrix is its own comparison matrix where the diagonal is positive, and K asks for that: K ⟺ Z and H₊.
  result.k = result.z == Verdict::no || result.h_plus == Verdict::no ? Verdict::no
             : is_yes(result.z) && is_yes(result.h_plus)             ? Verdict::yes
                                                                     : Verdict::not_decided;

  // Minors.
  if (n <= kSubsets) {
    exact::principal_minors(exactly, stop, result);
    result.copositive = verdict(exact::copositive(exact::symmetric_part(exactly), stop));
  } else {
    if (is_yes(result.positive_definite) || is_yes(result.h_plus))
      result.p = Verdict::yes;
    else
      small_minors(f, result);
    if (is_yes(result.positive_semidefinite) || is_yes(result.p)) settle(result.p0, Verdict::yes);
    if (is_yes(result.positive_semidefinite) || nonnegative)
      result.copositive = Verdict::yes;
    else
      for (Index i = 0; i < n; ++i)
        if (f.value.coeff(i, i) < -f.error.coeff(i, i)) result.copositive = Verdict::no;
  }
  if (result.p0 == Verdict::no) {
    result.column_sufficient = result.row_sufficient = Verdict::no;
  } else if (is_yes(result.p) || is_yes(result.positive_semidefinite)) {
    result.column_sufficient = result.row_sufficient = Verdict::yes;
  } else if (n <= kSignPatterns) {
    result.column_sufficient = verdict(exact::column_sufficient(exactly, stop));
    result.row_sufficient = verdict(exact::column_sufficient(exact::transposed(exactly), stop));
  }
  if (result.rank < 0 && (is_yes(result.p) || is_yes(result.positive_definite))) result.rank = n;
  exact::ask(stop);
  const bool regular = result.rank == n;
  if (!deadline.affords(f.value)) return;
  result.condition = condition(f.value, regular && exactly.empty());
  if (result.condition == kInf && regular && !exactly.empty()) result.condition = exact_condition(exactly);
}

}  // namespace

std::string_view name(Verdict verdict) {
  return verdict == Verdict::yes ? "yes" : verdict == Verdict::no ? "no" : "not decided";
}

Analysis analyse(const Matrix& A, const std::function<bool()>& stop, double time_limit) {
  const Deadline deadline(time_limit);
  Lcp whole;
  whole.A = A;
  whole.b.resize(order(A));
  whole.b.setZero();
  whole.lo = whole.hi = whole.b;
  check(whole);
  if (!finite(whole)) throw std::invalid_argument("analyse: every entry must be finite");
  Analysis result;
  result.n = order(A);
  result.condition = std::numeric_limits<double>::quiet_NaN();
  try {
    decide(A, stop, deadline, result);
  } catch (const exact::Late&) {
  }
  return result;
}

}  // namespace orthant
