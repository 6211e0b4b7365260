// Access to the entries of a matrix: the same numbers in every storage.
#include <orthant/core/lcp/problem.h>

#include <doctest/doctest.h>

#include <array>

using namespace orthant;

namespace {

/// W M⁻¹ Wᵀ + R with small whole numbers, so that sums in any order are exact: as an operator, dense and by rows.
std::array<Matrix, 3> stored_in_all_ways() {
  Eigen::MatrixXd W(3, 4);
  W << 1, 0, -2, 0, 0, 3, 1, 0, 0, 0, 0, 5;
  const Eigen::Vector4d inverse_mass(2, 1, 4, 0.5);
  const Eigen::Vector3d regularization(0.25, 0, 1);
  const Eigen::MatrixXd A =
      W * inverse_mass.asDiagonal() * W.transpose() + Eigen::MatrixXd(regularization.asDiagonal());
  return {Delassus{RowSparse::from(W.sparseView()), inverse_mass, regularization}, DenseMatrix(A),
          RowSparse::from(A.sparseView())};
}

template <class Storage> bool in_room(const Lcp& problem, const Lcp& formed, const Lcp& room) {
  CHECK(std::holds_alternative<Storage>(formed.A));
  CHECK(formed.b == problem.b);
  CHECK(formed.hi == problem.hi);
  CHECK(formed.friction.size() == problem.friction.size());
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 3; ++j) CHECK(entry(formed.A, i, j) == entry(problem.A, i, j));
  CHECK((&formed == &room || &formed == &problem));
  return &formed == &room;
}

}  // namespace

TEST_CASE("an operator, a dense matrix and one by rows have the same entries and the same transposed product") {
  const auto all = stored_in_all_ways();
  const auto& dense = std::get<DenseMatrix>(all[1]);
  Matrix unsymmetric = dense, by_rows = RowSparse();
  std::get<DenseMatrix>(unsymmetric)(0, 2) = 7;
  by_rows = RowSparse::from(Eigen::MatrixXd(std::get<DenseMatrix>(unsymmetric)).sparseView());
  const Eigen::Vector3d x(1, -2, 3);
  for (const Matrix& A : all) {
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) CHECK(entry(A, i, j) == dense(i, j));
    CHECK(multiply_transposed(A, x) == Eigen::VectorXd(dense.transpose() * x));
  }
  for (const Matrix* A : {&unsymmetric, &by_rows})
    CHECK(multiply_transposed(*A, x)[2] == dense.col(2).dot(x) + 7 * x[0]);
}

TEST_CASE("a problem gets a dense matrix, or one by rows, only where it has another") {
  const auto all = stored_in_all_ways();
  for (std::size_t k = 0; k < all.size(); ++k) {
    CAPTURE(k);
    Lcp p = Lcp::standard(all[k], Vector(Eigen::Vector3d(1, 2, 3))), room;
    p.lo[1] = -kInf;
    p.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
    CHECK(in_room<DenseMatrix>(p, with_dense_matrix(p, room), room) == (k != 1));
    CHECK(in_room<RowSparse>(p, with_rows(p, room), room) == (k != 2));
  }
}
