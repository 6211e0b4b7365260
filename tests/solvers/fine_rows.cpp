// Rows whose terms are small beside those of others: settled to their own scale.
#include <orthant/solvers/fine_rows.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

/// A pair of rows with data of 1e-20 beside a pair with data of 1; rows 0 and 2 couple by `coupling`.
Lcp small_beside_large(double coupling) {
  DenseMatrix A(Eigen::Matrix4d::Zero());
  A.topLeftCorner(2, 2) << 4, 1, 1, 4;
  A.bottomRightCorner(2, 2) << 4, 1, 1, 4;
  A(0, 2) = A(2, 0) = coupling;
  return Lcp::standard(A, Vector{-1, -1, -1e-20, 2e-20});
}

/// Right to 1e-15, and to nothing more: as a method that ends at the rounding of the largest row.
class Coarse final : public Solver {
  Claim run(const Lcp& problem, Solution& s, Start) override {
    Solution exact;
    make_solver("lemke")->solve(problem, exact);
    s.z = exact.z;
    s.z[2] += 1e-21;
    return Claim::candidate;
  }
  double tolerance() const override { return 1e-10; }
};

}  // namespace

TEST_CASE("fine rows: a small row is settled to its own scale, and those that it disturbs") {
  for (const double coupling : {0.0, 1e-25}) {
    CAPTURE(coupling);
    const Lcp p = small_beside_large(coupling);
    FineRows fine;
    Vector z{0.2, 0.2, 0, 0}, settled;
    REQUIRE(fine.settle(p, z, settled));
    CHECK(settled[2] == doctest::Approx(0.25e-20 - 0.25 * coupling * 0.2).epsilon(1e-12));
    CHECK(settled[3] == 0);
    CHECK(!fine.settle(p, settled, z));  // nothing is left to settle
    Solution s;
    CHECK(Coarse().solve(p, s).status == Status::solved);
  }
}

TEST_CASE("fine rows: friction keeps to its bound, and rows without a diagonal are left alone") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 0}, {0, 1}}), Vector{-1e-20, -1});
  p.lo[1] = -kInf;
  p.friction = {{.normal = 0, .first = 1, .mu = 0.5}};
  FineRows fine;
  Vector settled;
  REQUIRE(fine.settle(p, Vector{0, 0}, settled));
  CHECK(settled[0] == doctest::Approx(1e-20));
  CHECK(settled[1] == 0.5 * settled[0]);
  CHECK(!fine.settle(Lcp::standard(DenseMatrix(Eigen::MatrixXd::Zero(1, 1)), Vector{-1}), Vector{0}, settled));
}
