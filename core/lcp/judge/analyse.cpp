#include <orthant/core/lcp/judge/analyse.h>

#include <orthant/core/lcp/judge/definite.h>
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/support/factorization_cost.h>

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
constexpr Index kSubsets = 12;      // rows of which all subsets are looked at
constexpr Index kSignPatterns = 5;  // rows of which all supports with all signs are looked at
constexpr Index kDense = 1000;      // rows for dense eigenvalues and factorizations

Verdict verdict(bool yes) { return yes ? Verdict::yes : Verdict::no; }

exact::Table symmetric_part(const exact::Table& A) {
  exact::Table S = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) S[i][j] = (A[i][j] + A[j][i]) / 2;
  return S;
}

exact::Table transposed(const exact::Table& A) {
  exact::Table T = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) T[i][j] = A[j][i];
  return T;
}

exact::Table comparison(const exact::Table& A) {
  exact::Table C = A;
  for (std::size_t i = 0; i < A.size(); ++i)
    for (std::size_t j = 0; j < A.size(); ++j) C[i][j] = i == j ? Rational(abs(A[i][i])) : Rational(-abs(A[i][j]));
  return C;
}

// All pivots on the diagonal, in the given order, are positive: all leading principal minors are.
bool leading_minors_positive(exact::Table A) {
  for (std::size_t k = 0; k < A.size(); ++k) {
    if (A[k][k] <= 0) return false;
    for (std::size_t i = k + 1; i < A.size(); ++i) {
      const Rational factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < A.size(); ++j) exact::subtract_product(A[i][j], factor, A[k][j]);
    }
  }
  return true;
}

// S symmetric. Diagonal pivots where positive; the rest must then be zero.
bool semidefinite(exact::Table S) {
  std::vector<char> done(S.size(), 0);
  for (;;) {
    std::size_t p = 0;
    while (p < S.size() && (done[p] != 0 || S[p][p].is_zero())) ++p;
    if (p == S.size()) break;
    if (S[p][p] < 0) return false;
    done[p] = 1;
    for (std::size_t i = 0; i < S.size(); ++i) {
      if (done[i] != 0) continue;
      const Rational factor = S[i][p] / S[p][p];
      for (std::size_t j = 0; j < S.size(); ++j)
        if (done[j] == 0) exact::subtract_product(S[i][j], factor, S[p][j]);
    }
  }
  for (std::size_t i = 0; i < S.size(); ++i)
    for (std::size_t j = 0; j < S.size(); ++j)
      if (done[i] == 0 && done[j] == 0 && !S[i][j].is_zero()) return false;
  return true;
}

// Solves B x = rhs (last column) for a principal block; the sign of det B, zero or unknown: x is not to be used.
template <class T> Sign eliminate(std::vector<std::vector<T>>& B) {
  const std::size_t m = B.size();
  int det = 1;
  for (std::size_t k = 0; k < m; ++k) {
    std::size_t r = k;
    bool open = false;
    for (std::size_t i = k; i < m; ++i) {
      open = open || exact::sign(B[i][k]) == Sign::unknown;
      if (exact::weight(B[i][k]) > exact::weight(B[r][k])) r = i;
    }
    if (exact::weight(B[r][k]) == 0) return open ? Sign::unknown : Sign::zero;
    if (r != k) std::swap(B[r], B[k]), det = -det;
    if (exact::sign(B[k][k]) == Sign::negative) det = -det;
    for (std::size_t i = 0; i < m; ++i) {
      if (i == k) continue;
      const T factor = exact::quotient(B[i][k], B[k][k]);
      for (std::size_t j = k + 1; j < B[i].size(); ++j) exact::subtract_product(B[i][j], factor, B[k][j]);
    }
  }
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t j = m; j < B[k].size(); ++j) B[k][j] = exact::quotient(B[k][j], B[k][k]);
  return static_cast<Sign>(det);
}

template <class T> std::vector<std::vector<T>> block(const exact::Table& A, const std::vector<std::size_t>& rows) {
  std::vector<std::vector<T>> B(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const std::size_t j : rows) B[i].push_back(T(A[rows[i]][j]));
    B[i].push_back(T(1.0));
  }
  return B;
}

struct Late {};  // thrown where the caller has waited long enough

void ask(const std::function<bool()>& stop) {
  if (stop && stop()) throw Late{};
}

class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  bool affords(double operations) const {
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin_;
    return operations <= kOperationsPerSecond * (seconds_ - gone.count());
  }
  /// A sparse LU factorization, or a Cholesky factorization.
  bool affords(const Sparse& A) const {
    return seconds_ == kInf ||
           affords(factorization_cost(static_cast<int>(A.rows()), A.outerIndexPtr(), A.innerIndexPtr()));
  }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

template <class Visit>  // not ∅; visit returns false to end
void for_each_subset(std::size_t n, const std::function<bool()>& stop, Visit&& visit) {
  std::vector<std::size_t> rows;
  for (unsigned long subset = 1; subset >> n == 0; ++subset) {
    ask(stop);
    rows.clear();
    for (std::size_t i = 0; i < n; ++i)
      if ((subset >> i & 1UL) != 0) rows.push_back(i);
    if (!visit(rows)) return;
  }
}

void principal_minors(const exact::Table& A, const std::function<bool()>& stop, Analysis& result) {
  Verdict p = Verdict::yes, p0 = Verdict::yes;
  for_each_subset(A.size(), stop, [&](const std::vector<std::size_t>& rows) {
    auto fast = block<Filtered>(A, rows);
    Sign det = eliminate(fast);
    if (det == Sign::unknown) {
      auto slow = block<Rational>(A, rows);
      det = eliminate(slow);
    }
    if (det != Sign::positive && p == Verdict::yes) {
      p = result.p = Verdict::no;
      result.not_p.assign(rows.begin(), rows.end());
    }
    if (det == Sign::negative) p0 = Verdict::no;
    return p0 == Verdict::yes;
  });
  result.p = p, result.p0 = p0;
}

// A minimizer of xᵀS x on the simplex with the fewest entries has a regular block S_αα, and S_αα x_α = λ e: λ < 0 ⟺
// S_αα⁻¹ e < 0.
bool copositive(const exact::Table& S, const std::function<bool()>& stop) {
  bool yes = true;
  const auto negative = [](const auto& B) {
    bool all = true;
    for (const auto& row : B) {
      const Sign s = exact::sign(row.back());
      if (s == Sign::positive || s == Sign::zero) return Sign::positive;
      all = all && s == Sign::negative;
    }
    return all ? Sign::negative : Sign::unknown;
  };
  for_each_subset(S.size(), stop, [&](const std::vector<std::size_t>& rows) {
    auto fast = block<Filtered>(S, rows);
    Sign outcome = eliminate(fast);
    if (outcome != Sign::unknown && outcome != Sign::zero) outcome = negative(fast);
    if (outcome == Sign::unknown) {
      auto slow = block<Rational>(S, rows);
      outcome = eliminate(slow);
      if (outcome != Sign::zero) outcome = negative(slow);
    }
    return yes = outcome != Sign::negative;
  });
  return yes;
}

// For each support α and signs σ: some x_α > 0 with B x ≤ 0, B x ≠ 0, B = σ A_αα σ, is a counterexample. The sum of all
// generators of { x ≥ 0, B x ≤ 0 } has every x_i > 0 and every (B x)_i < 0 that any member has.
bool column_sufficient(const exact::Table& A, const std::function<bool()>& stop) {
  bool yes = true;
  for_each_subset(A.size(), stop, [&](const std::vector<std::size_t>& rows) {
    const std::size_t m = rows.size();
    for (unsigned long signs = 0; yes && signs >> (m - 1) == 0; ++signs) {
      exact::Table G(2 * m, exact::Row(m));
      for (std::size_t i = 0; i < m; ++i) {
        G[i][i] = 1;
        for (std::size_t j = 0; j < m; ++j)
          G[m + i][j] = ((signs >> i ^ signs >> j) & 1UL) != 0 ? A[rows[i]][rows[j]] : Rational(-A[rows[i]][rows[j]]);
      }
      exact::Row sum(m);
      for (const exact::Row& ray : exact::cone(G, m).rays)
        for (std::size_t i = 0; i < m; ++i) sum[i] += ray[i];
      bool positive = true, strict = false;
      for (std::size_t i = 0; i < m; ++i) {
        positive = positive && sum[i] > 0;
        Rational value = 0;
        for (std::size_t j = 0; j < m; ++j) value += G[m + i][j] * sum[j];
        strict = strict || value > 0;
      }
      yes = !(positive && strict);
    }
    return yes;
  });
  return yes;
}

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
  eliminate(B);
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

  // Definiteness, H₊ and K, rank.
  ask(stop);
  if (!exactly.empty()) {
    const exact::Table symmetric = symmetric_part(exactly);
    result.positive_definite = verdict(leading_minors_positive(symmetric));
    result.positive_semidefinite = verdict(semidefinite(symmetric));
    result.h_plus = Verdict::yes;
    for (std::size_t i = 0; i < at(n); ++i)
      if (exactly[i][i] <= 0) result.h_plus = Verdict::no;
    if (is_yes(result.h_plus)) result.h_plus = verdict(leading_minors_positive(comparison(exactly)));
    exact::Table copy = exactly;
    result.rank = static_cast<Index>(exact::reduce(copy, at(n)).size());
  } else {
    const bool dominates = is_yes(result.diagonally_dominant) && diagonal_positive;
    if ((dominates && is_yes(result.symmetric)) || (deadline.affords(S.value) && surely_definite(S)))
      result.positive_definite = result.positive_semidefinite = Verdict::yes;
    else if (delassus)
      result.positive_semidefinite = Verdict::yes;  // W M⁻¹ Wᵀ + R with M⁻¹, R ≥ 0
    else if (surely_not_semidefinite(S, deadline))
      result.positive_definite = result.positive_semidefinite = Verdict::no;
    ask(stop);
    if (dominates || (diagonal_positive && deadline.affords(f.value) && surely_h_matrix(f)))
      result.h_plus = Verdict::yes;
    else if (!delassus && !diagonal_positive)
      result.h_plus = Verdict::no;
  }
  // A Z-matrix is its own comparison matrix where the diagonal is positive, and K asks for that: K ⟺ Z and H₊.
  result.k = result.z == Verdict::no || result.h_plus == Verdict::no ? Verdict::no
             : is_yes(result.z) && is_yes(result.h_plus)             ? Verdict::yes
                                                                     : Verdict::not_decided;

  // Minors.
  if (n <= kSubsets) {
    principal_minors(exactly, stop, result);
    result.copositive = verdict(copositive(symmetric_part(exactly), stop));
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
    result.column_sufficient = verdict(column_sufficient(exactly, stop));
    result.row_sufficient = verdict(column_sufficient(transposed(exactly), stop));
  }
  if (result.rank < 0 && (is_yes(result.p) || is_yes(result.positive_definite))) result.rank = n;
  ask(stop);
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
  } catch (const Late&) {
  }
  return result;
}

}  // namespace orthant
