#include <orthant/solvers/linear_algebra/basis.h>

#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include <memory>

#include "tests/support/allocations.h"

using namespace orthant;

namespace {

template <class T> using Storage = typename Basis<T>::Storage;

/// Random columns: a share of them unit vectors, the others with about `filled` entries of n.
Eigen::MatrixXd random_columns(Index n, Index count, double units, double filled, Random& random) {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(n, count);
  for (Index k = 0; k < count; ++k) {
    if (random.uniform() < units) {
      B(k % n, k) = random.uniform() < 0.5 ? -1 : 1;
      continue;
    }
    B(k % n, k) = 4 + random.uniform();
    for (Index i = 0; i < n; ++i)
      if (random.uniform() < filled) B(i, k) += random.normal();
  }
  return B;
}

auto columns_of(const Eigen::MatrixXd& B) {
  return [&B](Index k, const auto& add) {
    for (Index i = 0; i < B.rows(); ++i)
      if (B(i, k) != 0) add(i, B(i, k));
  };
}

template <class T> using VectorOf = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// ‖B x − v‖∞ and ‖Bᵀ y − v‖∞, whichever is larger, relative to the terms.
template <class T> double error(Basis<T>& basis, const Eigen::MatrixXd& B, Random& random) {
  const auto exact = B.cast<T>().eval();
  VectorOf<T> v(B.rows());
  for (T& e : v) e = static_cast<T>(random.normal());
  VectorOf<T> x = v, y = v;
  basis.solve(x);
  basis.solve_transposed(y);
  const T scale = v.cwiseAbs().maxCoeff() + (exact.cwiseAbs() * x.cwiseAbs()).maxCoeff() +
                  (exact.cwiseAbs().transpose() * y.cwiseAbs()).maxCoeff();
  const T worst = std::max((exact * x - v).cwiseAbs().maxCoeff(), (exact.transpose() * y - v).cwiseAbs().maxCoeff());
  return static_cast<double>(worst / scale);
}

template <class T> void updates_agree_with_fresh_factors(Storage<T> storage, double accuracy) {
  Random random(40);
  Basis<T> basis;
  int refused = 0, updated = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const Index n = random.integer(1, 90);
    Eigen::MatrixXd B = random_columns(n, n, 0.5, trial % 2 == 0 ? 0.1 : 1, random);
    const Eigen::MatrixXd others = random_columns(n, 100, 0.3, 0.3, random);
    basis.reset(n, storage, 40);
    REQUIRE(basis.factorize(columns_of(B)));
    CHECK(error(basis, B, random) < accuracy);
    for (Index j = 0; j < others.cols(); ++j) {
      const Index k = random.integer(0, static_cast<int>(n) - 1);
      VectorOf<T> x = others.col(j).cast<T>();
      basis.solve(x);
      if (std::abs(x[k]) < 1e-3 * x.cwiseAbs().maxCoeff()) continue;  // would make B ill conditioned
      B.col(k) = others.col(j);
      if (basis.replace(k, x)) {
        ++updated;
      } else {
        ++refused;
        CHECK(basis.updates() == 40);
        REQUIRE(basis.factorize(columns_of(B)));
        CHECK(basis.updates() == 0);
      }
      if (j % 10 == 0) CHECK(error(basis, B, random) < accuracy);
    }
  }
  CHECK(updated > 1000);
  CHECK(refused > 10);
}

}  // namespace

TEST_CASE("basis: after any number of updates a solve is as good as a fresh one") {
  updates_agree_with_fresh_factors<double>(Storage<double>::dense, 1e-11);
  updates_agree_with_fresh_factors<double>(Storage<double>::sparse, 1e-11);
  updates_agree_with_fresh_factors<long double>(Storage<long double>::dense, 1e-14);
}

TEST_CASE("basis: factors of large dense cores are right, whatever the panels and tiles") {
  Random random(41);
  Basis<double> basis;
  for (const Index n : {31, 32, 33, 64, 100, 129, 300}) {
    Eigen::MatrixXd B(n, n);
    for (double& e : B.reshaped()) e = random.normal();
    basis.reset(n, Storage<double>::dense);
    REQUIRE(basis.factorize(columns_of(B)));
    CHECK(error(basis, B, random) < 1e-13);
    CHECK(basis.pivot_ratio() > 1e-6);
  }
}

TEST_CASE("basis: rows and columns in any units factorize alike") {
  Random random(42);
  Basis<double> basis;
  for (const auto storage : {Storage<double>::dense, Storage<double>::sparse}) {
    Eigen::MatrixXd B = random_columns(50, 50, 0.2, 0.4, random);
    Eigen::VectorXd row(50), col(50), v(50);
    for (double& d : row) d = std::ldexp(1.0, random.integer(-200, 200));
    for (double& d : col) d = std::ldexp(1.0, random.integer(-200, 200));
    for (double& e : v) e = random.normal();
    basis.reset(50, storage);
    REQUIRE(basis.factorize(columns_of(B)));
    Eigen::VectorXd x = v;
    basis.solve(x);
    const Eigen::MatrixXd scaled = row.asDiagonal() * B * col.asDiagonal();
    REQUIRE(basis.factorize(columns_of(scaled)));
    Eigen::VectorXd y = row.cwiseProduct(v);
    basis.solve(y);
    CHECK((y.cwiseProduct(col) - x).cwiseAbs().maxCoeff() <= 1e-13 * x.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("basis: a singular one is refused, and the missing unit columns make it regular") {
  Random random(43);
  Basis<double> basis;
  Basis<long double> longer;
  for (int trial = 0; trial < 300; ++trial) {
    const Index n = random.integer(1, 80), defect = random.integer(1, static_cast<int>(std::min<Index>(n, 4)));
    Eigen::MatrixXd B = random_columns(n, n, 0.3, 0.5, random);
    // Dependent columns: sums of others, zeros, and doubled unit vectors; integers, so that dependence is exact.
    B = B.array().round().matrix().eval();
    for (Index d = 0; d < defect; ++d) {
      const Index k = random.integer(0, static_cast<int>(n) - 1), j = random.integer(0, static_cast<int>(n) - 1);
      if (d % 2 == 0 || j == k)
        B.col(k).setZero();
      else
        B.col(k) = 2 * B.col(j);
    }
    const Index rank = Eigen::FullPivLU<Eigen::MatrixXd>(B).rank();
    const auto repaired = [&B](const auto& missing) {
      Eigen::MatrixXd repair = B;
      for (const auto& [position, row] : missing) {
        repair.col(position).setZero();
        repair(row, position) = 1;
      }
      return repair;
    };
    for (const auto storage : {Storage<double>::dense, Storage<double>::sparse}) {
      basis.reset(n, storage);
      REQUIRE(!basis.factorize(columns_of(B)));
      CHECK(static_cast<Index>(basis.missing().size()) == n - rank);
      const Eigen::MatrixXd repair = repaired(basis.missing());
      REQUIRE(basis.factorize(columns_of(repair)));
      CHECK(basis.missing().empty());
      CHECK(error(basis, repair, random) < 1e-9);
    }
    longer.reset(n, Storage<long double>::dense);
    CHECK(!longer.factorize(columns_of(B)));
    CHECK(static_cast<Index>(longer.missing().size()) == n - rank);
  }
}

TEST_CASE("basis: entries that are not finite and pivots of rounding are refused") {
  Basis<double> basis;
  Eigen::MatrixXd B = Eigen::MatrixXd::Identity(3, 3);
  basis.reset(3, Storage<double>::dense);
  B(0, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!basis.factorize(columns_of(B)));
  CHECK(basis.missing().empty());
  B(0, 1) = kInf;
  CHECK(!basis.factorize(columns_of(B)));
  B(0, 1) = 2;
  REQUIRE(basis.factorize(columns_of(B)));
  CHECK(!basis.replace(0, Eigen::Vector3d(1e-14, 1, 0)));
  CHECK(!basis.replace(0, Eigen::Vector3d(0, 1, 0)));
  CHECK(basis.replace(0, Eigen::Vector3d(0.5, 1, 0)));
  CHECK(basis.pivot_ratio() <= 0.5);
  basis.reset(0, Storage<double>::sparse);
  CHECK(basis.factorize(columns_of(Eigen::MatrixXd(0, 0))));
}

TEST_CASE("basis: nothing is allocated from the second time on") {
  Random random(44);
  std::vector<Eigen::MatrixXd> all;
  for (const Index n : {40, 7, 150}) all.push_back(random_columns(n, n, 0.3, 0.6, random));
  Basis<double> dense, sparse;
  Eigen::VectorXd x(150);
  const auto use = [&](Basis<double>& basis, Storage<double> storage) {
    for (const Eigen::MatrixXd& B : all) {
      basis.reset(B.rows(), storage);
      basis.factorize(columns_of(B));
      for (Index k = 0; k < B.rows(); ++k) {
        x.setOnes();
        basis.solve(x.head(B.rows()));
        basis.solve_transposed(x.head(B.rows()));
        x[k] = 3 * x.cwiseAbs().maxCoeff();
        basis.replace(k, x.head(B.rows()));
      }
    }
  };
  use(dense, Storage<double>::dense);
  use(sparse, Storage<double>::sparse);
  const std::size_t before = AllocationCount::now();
  use(dense, Storage<double>::dense);
  use(sparse, Storage<double>::sparse);
  CHECK(AllocationCount::now() == before);
  const auto reminder = std::make_unique<int>(1);
  CHECK(AllocationCount::now() > before);
}
