// Systems with principal blocks, dense and sparse, of every definiteness.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/support/factorization_cost.h>
#include <orthant/solvers/linear_algebra/principal_block.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>
#include <orthant/solvers/linear_algebra/sparse_lu.h>

#include <doctest/doctest.h>

#include <ctime>
#include <numeric>

using namespace orthant;

namespace {

RowSparse sparse(const Eigen::MatrixXd& A) {
  return RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(A.sparseView()));
}

/// About a third of the entries, symmetric with a heavy diagonal on request.
Eigen::MatrixXd random_matrix(Index n, bool symmetric, double diagonal, Random& random) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (double& entry : A.reshaped())
    if (random.integer(0, 5) == 0) entry = random.normal();
  if (symmetric) A = (A + A.transpose()).eval();
  A.diagonal().array() += diagonal;
  return A;
}

}  // namespace

TEST_CASE("principal blocks: sparse and dense storage agree, definite, indefinite and unsymmetric") {
  Random random(61);
  PrincipalBlock dense, packed;
  int solved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = random.integer(1, 40);
    const Eigen::MatrixXd A = random_matrix(n, trial % 3 > 0, trial % 3 == 1 ? 10 : 0, random);
    std::vector<Index> F;
    for (Index i = 0; i < n; ++i)
      if (random.integer(0, 2) > 0) F.push_back(i);
    const Matrix full = DenseMatrix(A), rows = sparse(A);
    dense.load(full);
    packed.load(rows);
    const bool regular = dense.factorize(F);
    INFO("trial ", trial, ", ", F.size(), " of ", n);
    if (!regular) continue;  // where rounding decides, UMFPACK may think otherwise
    REQUIRE(packed.factorize(F));
    ++solved;
    Vector r(Eigen::VectorXd::Zero(static_cast<Index>(F.size()))), x, y;
    for (double& entry : r) entry = random.normal();
    dense.solve(r, x);
    packed.solve(r, y);
    CHECK((x - y).norm() <= 1e-9 * x.norm());
    CHECK((A(F, F) * y - r).norm() <= 1e-9 * (r.norm() + y.norm()));
  }
  CHECK(solved > 150);
}

TEST_CASE("a sparse matrix is not ordered where the time left does not suffice for that") {
  constexpr Index n = 40000;
  Random random(7);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 10);
    for (int k = 0; k < 2; ++k) {  // at random, where minimum degree takes 0.1 s and a factorization minutes
      const Index j = random.integer(0, static_cast<int>(n) - 1);
      entries.emplace_back(i, j, 0.5), entries.emplace_back(j, i, 0.5);
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> S(n, n);
  S.setFromTriplets(entries.begin(), entries.end());
  RowSparse A = RowSparse::from(S);
  const auto cpu = [](const auto& run) {
    const std::clock_t begin = std::clock();
    run();
    return static_cast<double>(std::clock() - begin);
  };
  const double ordering = cpu([&] { factorization_cost(static_cast<int>(n), A.start.data(), A.column.data()); });
  Budget budget;
  const auto refuses = [&](const auto& factorize) {
    budget.start(0.02, nullptr);
    CHECK(cpu([&] { CHECK_FALSE(factorize()); }) < ordering / 2);
    CHECK(budget.exhausted());
  };
  refuses([&] { return SparseCholesky().factorize(A, 0, &budget); });
  refuses([&] { return SparseLu().factorize(A.start, A.column, A.value, 0, &budget); });
  std::vector<Index> all(at(n));
  std::iota(all.begin(), all.end(), Index{0});
  A.value[1] *= 2;  // unsymmetric
  const Matrix matrix = A;
  PrincipalBlock block;
  block.load(matrix, &budget);
  refuses([&] { return block.factorize(all); });
}

TEST_CASE("sparse Cholesky takes positive definite matrices only, and says so") {
  SparseCholesky cholesky;
  const auto taken = [&](const Eigen::MatrixXd& A) { return cholesky.factorize(sparse(A), 1e-14); };
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(4, 4);
  A(0, 3) = A(3, 0) = 0.5;
  CHECK(taken(A));
  Vector x{1, 2, 3, 4};
  REQUIRE(cholesky.solve(x));
  CHECK((A * x - Eigen::Vector4d(1, 2, 3, 4)).norm() < 1e-15);
  CHECK(!taken(-A));
  A(0, 3) = A(3, 0) = 2;  // indefinite
  CHECK(!taken(A));
  A(0, 3) = A(3, 0) = 1;  // semidefinite
  CHECK(!taken(A));
  A(0, 3) = A(3, 0) = kInf - kInf;
  CHECK(!taken(A));
  CHECK(!taken(Eigen::MatrixXd::Zero(4, 4)));
}

TEST_CASE("principal blocks that are singular or not finite are reported, in both storages") {
  PrincipalBlock block;
  const auto regular = [&](const Matrix& A, const std::vector<Index>& F) {
    block.load(A);
    return block.factorize(F);
  };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.topRightCorner(3, 3).setIdentity();
  A.bottomLeftCorner(3, 3).setIdentity();
  const std::vector<Index> all{0, 1, 2, 3, 4, 5}, zero{0, 1, 2}, none;
  for (const Matrix& M : {Matrix(DenseMatrix(A)), Matrix(sparse(A))}) {
    CHECK(regular(M, none));
    CHECK(!regular(M, zero));
    REQUIRE(regular(M, all));  // indefinite, and after a failure
    const Vector r{1, 2, 3, 4, 5, 6};
    Vector x;
    block.solve(r, x);
    CHECK((A * x - r).norm() == 0);
  }
  A(4, 1) = A(1, 4) = kInf - kInf;
  CHECK(!regular(DenseMatrix(A), all));
  CHECK(!regular(sparse(A), all));
}

TEST_CASE("dense principal blocks: units change nothing, near-singular ones are refused") {
  PrincipalBlock block;
  const std::vector<Index> F{0, 2};
  for (const double unit : {1.0, 0x1p-200, 0x1p200})
    for (const double lower : {1.0, 1.5}) {  // Cholesky, LU
      INFO("unit ", unit, ", lower ", lower);
      Eigen::Matrix3d A;
      A << 2, 0, 1, 0, 1, 0, lower, 0, 3;
      A *= unit;
      const Matrix good = DenseMatrix(A);
      block.load(good);
      REQUIRE(block.factorize(F));
      Vector x;
      block.solve(Vector{unit, unit}, x);
      CHECK((x - Eigen::Vector2d(2, 2 - lower) / (6 - lower)).norm() < 1e-15);
      A(2, 2) = A(0, 2) * A(2, 0) / A(0, 0) * (1 + 1e-16);
      const Matrix bad = DenseMatrix(A);
      block.load(bad);
      CHECK(!block.factorize(F));
    }
}

TEST_CASE("principal blocks with a diagonal added: both storages solve the shifted system, pattern reused or not") {
  Random random(62);
  PrincipalBlock dense, packed;
  Vector x, y;
  for (int trial = 0; trial < 60; ++trial) {
    const Index n = random.integer(1, 30);
    Eigen::MatrixXd A = random_matrix(n, trial % 2 == 0, 0, random);
    A = (trial % 2 == 0 ? (A * A.transpose()).eval() : (A - A.transpose()).eval());  // semidefinite or skew
    const Matrix full = DenseMatrix(A), rows = sparse(A);
    dense.load(full);
    packed.load(rows);
    std::vector<Index> F;
    for (Index i = 0; i < n; ++i)
      if (random.integer(0, 2) > 0) F.push_back(i);
    const auto m = static_cast<Index>(F.size());
    for (const double size : {1.0, 1e-3, 1e6}) {  // entries far apart are no sign of a singular block
      Vector shift(Eigen::VectorXd::Zero(n)), r(Eigen::VectorXd::Zero(m));
      for (double& entry : shift) entry = random.integer(0, 1) == 0 ? size : 1 / size;
      for (double& entry : r) entry = random.normal();
      const Eigen::VectorXd D = shift;
      const Eigen::MatrixXd block = A(F, F) + Eigen::MatrixXd(D(F).asDiagonal());
      for (PrincipalBlock* each : {&dense, &packed}) {
        REQUIRE(each->factorize(F, &shift));
        each->solve(r, x);
        CHECK((block * x - r).norm() <= 1e-9 * (r.norm() + x.norm()));
      }
    }
  }
}
