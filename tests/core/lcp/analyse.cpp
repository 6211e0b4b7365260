// What kind of matrix: against brute force in rationals, and on matrices whose kind is known.
#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/definite.h>
#include <orthant/core/lcp/judge/exact.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/families.h>

#include <doctest/doctest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

#include "experiments/support/clock.h"

using namespace orthant;
using exact::Rational;

namespace {

constexpr auto yes = Verdict::yes, no = Verdict::no, open = Verdict::not_decided;

Matrix dense(std::initializer_list<double> rows) {
  const auto n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(rows.size()))));
  Eigen::MatrixXd M(n, n);
  std::copy(rows.begin(), rows.end(), M.reshaped<Eigen::RowMajor>().begin());
  return DenseMatrix(M);
}

/// Laplace's expansion: nothing in common with elimination.
Rational determinant(const exact::Table& A) {
  if (A.empty()) return 1;
  Rational sum = 0;
  for (std::size_t j = 0; j < A.size(); ++j) {
    exact::Table minor;
    for (std::size_t i = 1; i < A.size(); ++i) {
      minor.push_back(A[i]);
      minor.back().erase(minor.back().begin() + static_cast<long>(j));
    }
    sum += (j % 2 == 0 ? 1 : -1) * A[0][j] * determinant(minor);
  }
  return sum;
}

exact::Table principal(const exact::Table& A, unsigned subset) {
  exact::Table B;
  for (std::size_t i = 0; i < A.size(); ++i) {
    if ((subset >> i & 1U) == 0) continue;
    B.emplace_back();
    for (std::size_t j = 0; j < A.size(); ++j)
      if ((subset >> j & 1U) != 0) B.back().push_back(A[i][j]);
  }
  return B;
}

Eigen::MatrixXd random_integers(Index n, Random& random, int size) {
  Eigen::MatrixXd M(n, n);
  for (double& entry : M.reshaped()) entry = random.integer(-size, size);
  return M;
}

Eigen::SparseMatrix<double, Eigen::RowMajor> laplace(Index n, double diagonal) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, diagonal);
    if (i > 0) entries.emplace_back(i, i - 1, -1.0);
    if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

}  // namespace

TEST_CASE("small integer matrices: P, P0, definiteness, K, rank agree with the minors, one by one") {
  Random random(1);
  int p = 0, semidefinite = 0, k_matrices = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Index n = random.integer(1, 4);
    Eigen::MatrixXd M = random_integers(n, random, 2);
    if (trial % 3 == 0) M = M * M.transpose();
    if (trial % 3 == 1) M += Eigen::MatrixXd::Identity(n, n) * random.integer(0, 4);
    const Matrix A = DenseMatrix(M);
    const Analysis a = analyse(A);
    const exact::Table T = exact::table(A);
    const exact::Table S = exact::table(DenseMatrix(M + M.transpose()));
    bool all_positive = true, none_negative = true, pd = true, psd = true;
    for (unsigned subset = 1; subset >> n == 0; ++subset) {
      const Rational det = determinant(principal(T, subset)), sym = determinant(principal(S, subset));
      all_positive = all_positive && det > 0;
      none_negative = none_negative && det >= 0;
      pd = pd && sym > 0;
      psd = psd && sym >= 0;
    }
    bool z = true;
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) z = z && (i == j || M(i, j) <= 0);
    INFO("M =\n", M);
    CHECK(a.p == (all_positive ? yes : no));
    CHECK(a.p0 == (none_negative ? yes : no));
    CHECK(a.positive_definite == (pd ? yes : no));
    CHECK(a.positive_semidefinite == (psd ? yes : no));
    CHECK(a.z == (z ? yes : no));
    CHECK(a.k == (z && all_positive ? yes : no));
    CHECK((a.rank == n) == (determinant(T) != 0));
    CHECK(a.symmetric == (M == M.transpose() ? yes : no));
    if (a.p == no) {
      unsigned subset = 0;
      for (const Index i : a.not_p) subset |= 1U << i;
      CHECK(determinant(principal(T, subset)) <= 0);
    }
    p += all_positive, semidefinite += psd && !pd, k_matrices += z && all_positive;
  }
  CHECK(std::min({p, semidefinite, k_matrices}) > 30);
}

TEST_CASE("copositive and sufficient: no counterexample on a grid where yes, the theory's implications hold") {
  Random random(2);
  int copositive = 0, not_copositive = 0, sufficient = 0, one_sided = 0, found_copositive = 0, found_sufficient = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Index n = random.integer(1, 3);
    const Eigen::MatrixXd M = random_integers(n, random, 2);
    const Analysis a = analyse(DenseMatrix(M)), t = analyse(DenseMatrix(M.transpose()));
    INFO("M =\n", M);
    bool negative = false, violated = false;
    Eigen::VectorXd x(n);
    const int points = static_cast<int>(std::lround(std::pow(9, n)));
    for (int k = 0; k < points; ++k) {
      int rest = k;
      for (double& value : x) value = rest % 9 - 4, rest /= 9;
      const Eigen::VectorXd product = x.cwiseProduct(M * x);
      if (x.minCoeff() >= 0 && product.sum() < 0) negative = true;
      if (product.maxCoeff() <= 0 && product.minCoeff() < 0) violated = true;
    }
    if (a.copositive == yes) CHECK_FALSE(negative);
    if (a.column_sufficient == yes) CHECK_FALSE(violated);
    CHECK(a.copositive != open);
    CHECK(a.column_sufficient != open);
    CHECK(a.row_sufficient == t.column_sufficient);
    if (a.column_sufficient == yes) CHECK(a.p0 == yes);
    if (a.p == yes || a.positive_semidefinite == yes) CHECK(a.column_sufficient == yes);
    if (a.positive_semidefinite == yes) CHECK(a.copositive == yes);
    copositive += a.copositive == yes, not_copositive += a.copositive == no;
    found_copositive += negative, found_sufficient += violated;
    sufficient += a.column_sufficient == yes;
    one_sided += a.column_sufficient != a.row_sufficient;
  }
  // The grid finds nearly every counterexample there is: an answer `no` too many would show here.
  CHECK(found_copositive > 0.97 * not_copositive);
  CHECK(found_sufficient > 0.97 * (1500 - sufficient));
  CHECK(std::min({copositive, not_copositive, sufficient}) > 100);
  CHECK(one_sided > 5);
}

TEST_CASE("decisions near rounding are exact") {
  CHECK(analyse(dense({1, 1e-200, 0, 1})).symmetric == no);
  CHECK(analyse(dense({1, 1e-200, 1e-200, 1})).symmetric == yes);
  const double e = std::numeric_limits<double>::epsilon();
  CHECK(analyse(dense({1, 1, 1, 1})).p == no);
  CHECK(analyse(dense({1, 1, 1, 1 + e})).p == yes);
  CHECK(analyse(dense({1, 1, 1, 1 + e})).positive_definite == yes);
  CHECK(analyse(dense({1, 1, 1, 1 - e / 2})).positive_semidefinite == no);
  CHECK(analyse(dense({1, 1 - e / 2, 1 - e / 2, 1})).diagonally_dominant == yes);
  CHECK(analyse(dense({1, 1, 1, 1})).diagonally_dominant == no);
  CHECK(analyse(dense({0, 1, 1, 0})).copositive == yes);
  CHECK(analyse(dense({0, -1e-300, -1e-300, 0})).copositive == no);
  CHECK(analyse(dense({1e-200, 0, 0, 1e200})).positive_definite == yes);
}

TEST_CASE("large matrices: K, definite, indefinite, and what is not decided") {
  const Analysis k = analyse(RowSparse::from(laplace(5000, 2)));
  CHECK(k.k == yes);
  CHECK(k.p == yes);
  CHECK(k.symmetric == yes);
  CHECK(k.positive_definite == yes);
  CHECK(k.diagonally_dominant == no);
  CHECK(k.rank == 5000);
  CHECK(k.condition == doctest::Approx(4 * 2501.0 * 2500 / 2).epsilon(0.01));  // ‖A⁻¹‖₁ = (n + 1)²/8
  const Analysis indefinite = analyse(RowSparse::from(laplace(5000, 1.9)));
  CHECK(indefinite.k != yes);
  CHECK(indefinite.positive_definite != yes);
  CHECK(indefinite.p0 != yes);
  CHECK(analyse(RowSparse::from(laplace(300, 1.9))).positive_semidefinite == no);

  Random random(5);
  const Lcp contact = random_contact_problem(30, 12, 0.5, random);  // 60 rows, rank 12
  const Analysis d = analyse(contact.A);
  CHECK(d.symmetric == yes);
  CHECK(d.positive_semidefinite == yes);
  CHECK(d.positive_definite != yes);
  CHECK(d.p0 == yes);
  CHECK(d.column_sufficient == yes);
  CHECK(analyse(random_spd_problem(200, random).A).p == yes);
}

TEST_CASE("Cholesky with a margin: proves what holds, never what does not") {
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = random.integer(1, 8), rank = random.integer(0, static_cast<int>(n));
    Eigen::MatrixXd B(n, rank);
    for (double& entry : B.reshaped()) entry = random.integer(-9, 9);
    const Eigen::MatrixXd M = B * B.transpose();
    const Formed S = symmetric_part(formed(DenseMatrix(M)));
    const bool definite = determinant(exact::table(DenseMatrix(M))) != 0;
    CHECK(surely_definite(S) == definite);  // integers: λ_min is 0 or far from it
    if (definite) {
      const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues()[0];
      CHECK(surely_definite(S, 0.9 * least));
      CHECK_FALSE(surely_definite(S, 1.1 * least));
    }
  }
}

TEST_CASE("strict diagonal dominance with a positive diagonal decides H+, P and, symmetric, definiteness") {
  Random random(3);
  const Analysis a = analyse(random_sparse_problem(3000, random).A, {}, 0);  // no time: no factorization
  CHECK(a.diagonally_dominant == yes);
  CHECK(a.h_plus == yes);
  CHECK(a.p == yes);
  CHECK(a.p0 == yes);
  CHECK(a.rank == 3000);
  CHECK(a.positive_definite == open);
  CHECK(std::isnan(a.condition));
  const Matrix string = find_family("string")->make(100, 0, 1).problem.A;
  DenseMatrix A;
  to_dense(string, A);
  A.diagonal().array() *= 1.01;
  CHECK(analyse(A, {}, 0).positive_definite == yes);
  A(0, 0) *= -1;
  CHECK(analyse(A).h_plus == no);
}

TEST_CASE("a symmetric H+ matrix is positive definite, also where Cholesky's margin does not tell") {
  constexpr Index n = 45;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    A(i, i) = i == 0 ? 1 : i + 1 == n ? 1 + 0x1p-40 : 2;
    if (i > 0) A(i, i - 1) = A(i - 1, i) = -1;
  }
  const Analysis a = analyse(DenseMatrix(A));
  CHECK(a.h_plus == yes);
  CHECK(a.positive_definite == yes);
  CHECK(a.positive_semidefinite == yes);
}

TEST_CASE("a time limit is kept where one factorization would take minutes") {
  Random random(3);
  const Matrix A = random_sparse_problem(30000, random).A;
  const double begin = rival::processor_time();
  const Analysis a = analyse(A, {}, 0.5);
  CHECK(rival::processor_time() - begin < 5);
  CHECK(a.p == yes);
  CHECK(std::isnan(a.condition));
}

TEST_CASE("condition: of a regular matrix a number, however large") {
  const Analysis scaled = analyse(dense({1, 0, 0, 0, 0x1p-80, 0, 0, 0, 1}));
  CHECK(scaled.positive_definite == yes);
  CHECK(scaled.rank == 3);
  CHECK(scaled.condition == 0x1p80);
  const double e = 0x1p-52;  // floating-point elimination finds a singular matrix
  const Analysis close = analyse(dense({1, 1, 0, 1, 1 + e, e / 3, 0, e / 3, 1}));
  CHECK(close.rank == 3);
  CHECK(close.condition == doctest::Approx(4 / e).epsilon(1e-6));
  CHECK(analyse(dense({1, 1, 1, 1})).condition == kInf);
}

TEST_CASE("analyse refuses unsuitable matrices with a reason") {
  CHECK_THROWS_WITH_AS(analyse(dense({std::nan("")})), doctest::Contains("finite"), std::invalid_argument);
  CHECK_THROWS_AS(analyse(DenseMatrix(Eigen::MatrixXd(2, 3))), std::invalid_argument);
  CHECK(analyse(DenseMatrix(Eigen::MatrixXd(0, 0))).p == yes);
}

TEST_CASE("stopped at any time: what is decided by then is right, the rest is open") {
  const Matrix matrices[] = {dense({2, -1, 0, -1, 2, -1, 0, -1, 2}), dense({1, 2, 3, 1, 0, -1, 1, 1, 0}),
                             dense({0, 1, -1, -1, 0, 1, 1, -1, 0})};
  for (const Matrix& M : matrices) {
    const Analysis whole = analyse(M);
    int asked = 0, undecided = 0;
    for (int patience = 0; asked >= patience; ++patience) {
      asked = 0;
      const Analysis a = analyse(M, [&] { return ++asked > patience; });
      const auto same = [&](Verdict part, Verdict all) {
        CHECK((part == all || part == open));
        undecided += part != all;
      };
      same(a.symmetric, whole.symmetric), same(a.positive_definite, whole.positive_definite);
      same(a.positive_semidefinite, whole.positive_semidefinite), same(a.z, whole.z), same(a.k, whole.k);
      same(a.h_plus, whole.h_plus), same(a.p, whole.p), same(a.p0, whole.p0), same(a.copositive, whole.copositive);
      same(a.column_sufficient, whole.column_sufficient), same(a.row_sufficient, whole.row_sufficient);
      CHECK((std::isnan(a.condition) || a.condition == whole.condition));
    }
    CHECK(undecided > 0);
  }
}
