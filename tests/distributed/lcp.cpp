// Distributed problems: rows, halo and products; bad input in words on all ranks, whichever has it.
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/distributed/distributed_lcp.h>

#include <doctest/doctest.h>

#include "experiments/studies/distributed/grids.h"

#include "tests/distributed/parts.h"

#include <string>

using namespace orthant;
using namespace orthant::distributed;

namespace {

LocalRows diagonal_rows(Index first, Index m, Index n) {
  LocalRows rows;
  rows.first = first;
  rows.A.rows = m, rows.A.cols = n;
  for (Index i = 0; i < m; ++i) {
    rows.A.column.push_back(static_cast<int>(first + i)), rows.A.value.push_back(1);
    rows.A.start.push_back(static_cast<int>(i + 1));
  }
  rows.b.resize(m), rows.lo.resize(m), rows.hi.resize(m);
  rows.b.setConstant(-1), rows.lo.setConstant(0), rows.hi.setConstant(kInf);
  return rows;
}

/// What the last rank's fault makes all ranks throw.
template <class Spoil> std::string words_after(const Spoil& spoil) {
  const Index m = 4, rank = rank_of_this(), n = m * ranks_of_all();
  LocalRows rows = diagonal_rows(rank * m, m, n);
  if (rank == ranks_of_all() - 1) spoil(rows);
  try {
    const DistributedLcp problem(MPI_COMM_WORLD, rows);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("distributed rows: products as of the whole matrix, bit by bit; halo of grids") {
  const Lcp problem = space_obstacle(7).problem;
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  CHECK(rows.symmetric());
  Random random(5);
  Vector z;
  z.resize(problem.size());
  for (double& each : z) each = random.uniform();
  Vector part = part_of(rows, z), w;
  rows.residual(part, w);
  const auto& A = std::get<RowSparse>(problem.A);
  for (Index i = 0; i < rows.rows(); ++i) {
    double sum = problem.b[rows.first() + i];
    A.for_each_in_row(rows.first() + i, [&](Index j, double value) { sum += value * z[j]; });
    CHECK(sum == w[i]);
  }
  if (ranks_of_all() == 1) CHECK(rows.halo() == 0);
  if (ranks_of_all() == 2) CHECK(rows.halo() == 36);  // a layer of 6 × 6 nodes
  CHECK(rows.neighbours() == (ranks_of_all() == 1                                           ? 0
                              : rank_of_this() == 0 || rank_of_this() == ranks_of_all() - 1 ? 1
                                                                                            : 2));
}

TEST_CASE("distributed rows: grids assembled a rank at a time are those of one process") {
  const Index side = 12;
  const std::array whole{ball_obstacle(side + 1).problem, journal_bearing(side, side),
                         elastic_plastic_torsion(side, side), space_obstacle(side + 1).problem};
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const Lcp& problem = whole[k];
    const auto grid = static_cast<Grid>(k);
    REQUIRE(rows_of_grid(grid, side) == problem.size());
    const Index first = problem.size() * rank_of_this() / ranks_of_all(), m = problem.size() / ranks_of_all();
    const LocalRows part = part_of_grid(grid, side, first, m);
    double worst = 0;
    for (Index i = 0; i < m; ++i) {
      const auto off = [&](double x, double y) { worst = std::max(worst, x == y ? 0 : std::abs(x - y)); };
      off(part.b[i], problem.b[first + i]);
      off(part.lo[i], problem.lo[first + i]);
      off(part.hi[i], problem.hi[first + i]);
      double entries = 0, own = 0;
      for_each_in_row(problem.A, first + i, [&](Index, double) { ++entries; });
      part.A.for_each_in_row(i, [&](Index j, double value) { ++own, off(value, entry(problem.A, first + i, j)); });
      CHECK(entries == own);
    }
    CHECK(worst < 1e-11);
  }
}

TEST_CASE("distributed rows: symmetry is seen, and one unsymmetric entry too") {
  Lcp problem = journal_bearing(12, 9);
  CHECK(DistributedLcp::from(MPI_COMM_WORLD, problem).symmetric());
  auto& A = std::get<RowSparse>(problem.A);
  A.value[A.value.size() - 2] *= 1 + 1e-6;
  CHECK_FALSE(DistributedLcp::from(MPI_COMM_WORLD, problem).symmetric());
}

TEST_CASE("distributed rows: ranks without rows, a problem without any") {
  const Index n = 2;  // three ranks: one is empty
  const DistributedLcp few =
      DistributedLcp::from(MPI_COMM_WORLD, Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(n, n)), Vector{-1, 2}));
  CHECK(few.size() == 2);
  const DistributedLcp none(MPI_COMM_WORLD, diagonal_rows(0, 0, 0));
  CHECK(none.size() == 0);
}

TEST_CASE("distributed rows: what one rank gives wrong all ranks refuse, naming row, value and rule") {
  CHECK(words_after([](LocalRows&) {}).empty());
  const auto has = [](const std::string& text, const std::string& part) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  };
  const std::string last = "row " + std::to_string(4 * ranks_of_all() - 1);
  has(words_after([](LocalRows& r) { r.A.value[3] = kInf; }), last + ": A in column");
  has(words_after([](LocalRows& r) { r.A.column[3] = 1000; }), last + ": column 1000 must be above the one before");
  has(words_after([](LocalRows& r) { r.A.column[3] = -1; }), last + ": column -1");
  has(words_after([](LocalRows& r) { r.b[3] = std::numeric_limits<double>::quiet_NaN(); }),
      last + ": b must be finite");
  has(words_after([](LocalRows& r) { r.lo[3] = 2, r.hi[3] = 1; }), last + ": bounds must have lo <= hi");
  has(words_after([](LocalRows& r) { r.lo[3] = kInf; }), last + ": bounds must have lo <= hi");
  has(words_after([](LocalRows& r) { r.b.resize(2); }), "b has 2 entries: must be as many as the rank's rows, 4");
  has(words_after([](LocalRows& r) { r.A.start.pop_back(); }), "A.start: must have a 0");
  has(words_after([](LocalRows& r) { r.A.value.pop_back(); }), "column and value");
  has(words_after([](LocalRows& r) { r.first += 1; }), "must be the number of rows of the ranks before");
  has(words_after([](LocalRows& r) { r.A.cols += 1; }), "columns: must be as many as all ranks have rows");
  Lcp friction = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(2, 2)), Vector{-1, 0});
  friction.lo[1] = -kInf;
  friction.friction.push_back({0, 1, 1, 0.5});
  CHECK_THROWS_WITH_AS(DistributedLcp::from(MPI_COMM_WORLD, friction),
                       "friction: a distributed problem must have bounds that do not depend on z",
                       std::invalid_argument);
}
