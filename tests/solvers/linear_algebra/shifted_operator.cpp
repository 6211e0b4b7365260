// A shifted operator's solves in the space of its columns: those of the dense matrix, rows in another order.
#include <orthant/solvers/linear_algebra/shifted_operator.h>

#include <doctest/doctest.h>
#include <Eigen/LU>

#include "tests/support/scene_draws.h"

using namespace orthant;

namespace {

/// `rows` random rows of three entries each.
Delassus random_operator(Index rows, Index columns, SceneDraws& dice) {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (int k = 0; k < 3; ++k) W(i, (7 * i + 5 * k) % columns) = dice.between(-1, 1);
  Delassus A;
  A.W = RowSparse::from(W.sparseView());
  A.inverse_mass.resize(columns);
  for (double& x : A.inverse_mass) x = dice.zero_or(0.1, 10);
  return A;
}

}  // namespace

TEST_CASE("shifted operator: solves in the columns' space are those of the dense matrix") {
  SceneDraws dice(5);
  ShiftedOperator solver;
  for (const auto& [rows, columns] : {std::pair<Index, Index>{12, 4}, {60, 24}, {30, 24}, {8, 20}}) {
    CAPTURE(rows);
    CAPTURE(columns);
    const Delassus A = random_operator(rows, columns, dice);
    std::vector<int> order;
    for (int i = 0; i < rows; ++i) order.push_back(static_cast<int>(rows - 1 - i));
    Vector scale = Eigen::VectorXd::Zero(rows), b = scale;
    for (double& x : scale) x = dice.between(0.5, 2);
    for (double& x : b) x = dice.between(-1, 1);
    Index used = 0;
    const Eigen::MatrixXd W = A.W.view().toDense();
    for (Index j = 0; j < columns; ++j) used += A.inverse_mass[j] > 0 && !W.col(j).isZero(0);
    const bool better = static_cast<double>(used) <= 0.75 * static_cast<double>(rows);
    REQUIRE(solver.load(A, order, scale) == better);
    if (!better) continue;
    Eigen::MatrixXd L(rows, columns);
    for (Index i = 0; i < rows; ++i) {
      const int row = order[static_cast<std::size_t>(i)];
      L.row(i) = scale[row] * W.row(row).cwiseProduct(A.inverse_mass.cwiseSqrt().transpose());
    }
    for (const double s : {0.1, 2.0, 1e-3}) {  // another shift keeps what is loaded
      CAPTURE(s);
      REQUIRE(solver.factorize(s, nullptr));
      Vector x = b;
      REQUIRE(solver.solve(x));
      const Eigen::MatrixXd all = L * L.transpose() + s * Eigen::MatrixXd::Identity(rows, rows);
      CHECK((all * x - b).lpNorm<Eigen::Infinity>() < 1e-12 / s);
    }
  }
}
