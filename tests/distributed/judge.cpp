// Distributed judge: the verdicts of the judge of one process, for any number of ranks.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/distributed/distributed_judge.h>

#include <doctest/doctest.h>

#include "tests/distributed/parts.h"

#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

using namespace orthant;
using namespace orthant::distributed;

namespace {

/// Both judges on one z: equal words and equal bits.
Status compare(const Lcp& problem, const Vector& z, double tolerance) {
  Solution s;
  s.z = z;
  Judge whole;
  whole.certify(problem, tolerance, Claim::candidate, s);
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  DistributedJudge judge(rows);
  Vector part = part_of(rows, z);
  const Verdict verdict = judge.judge(part, tolerance);
  INFO("rank ", rank_of_this(), ", n = ", problem.size(), ", tolerance ", tolerance);
  CHECK(name(verdict.status) == name(s.status));
  if (has_answer(s.status)) {
    CHECK(verdict.residual == s.residual);
    CHECK(whole_of(rows, judge.w()) == s.w);
    CHECK(verdict.miss.row == s.miss.row);
    CHECK(verdict.miss.allowed == s.miss.allowed);
  }
  return verdict.status;
}

/// A chain: row i has z_i and, through entries that shrink or not, the row before. Data come from row 0 alone.
Lcp chain(Index n, double link) {
  RowSparse A;
  A.rows = A.cols = n;
  for (Index i = 0; i < n; ++i) {
    if (i > 0) A.column.push_back(static_cast<int>(i - 1)), A.value.push_back(link);
    A.column.push_back(static_cast<int>(i)), A.value.push_back(1);
    A.start.push_back(static_cast<int>(A.column.size()));
  }
  Vector q(Eigen::VectorXd::Zero(n));
  q[0] = -1;
  return Lcp::standard(A, q);
}

}  // namespace

TEST_CASE("distributed judge: as the judge of one process on random problems, near the limits too") {
  Random random(7);
  std::array<int, 3> seen{};
  for (int trial = 0; trial < 120; ++trial) {
    const double spread = std::array{1.0, 1e2, 1e4}[at(trial % 3)];
    const auto [problem, z] = planted(random.integer(1, 40), spread, random);
    for (const double off : {0.0, 1e-16, 1e-13, 1e-10, 1e-6}) {
      Vector moved = z;
      for (Index i = 0; i < moved.size(); ++i)
        if (moved[i] != problem.lo[i] && moved[i] != problem.hi[i]) moved[i] *= 1 + off * random.uniform(-1, 1);
      for (const double tolerance : {1e-10, 1e-14, 1e-17}) {
        const Status status = compare(problem, moved, tolerance);
        ++seen[status == Status::solved ? 0 : status == Status::rounded ? 1 : 2];
      }
    }
  }
  for (const int each : seen) CHECK(each > 50);
}

TEST_CASE("distributed judge: data travel along chains from rank to rank, as far as the widest path leads") {
  for (const double link : {-1.0, -0.5}) {
    const Lcp problem = chain(60, link);
    Vector z;
    z.resize(60);
    for (Index i = 0; i < 60; ++i) z[i] = std::pow(-link, static_cast<double>(i));
    CHECK(compare(problem, z, 1e-10) == Status::solved);
    Vector off = z;
    off[59] *= 1 + 0.9e-10;  // v is 0.9e-10 of z_59, β_59 as small
    CHECK(compare(problem, off, 1e-10) == Status::solved);
    off[59] = z[59] * (1 + 1.1e-10);
    CHECK(compare(problem, off, 1e-10) == Status::stalled);
  }
}

TEST_CASE("distributed judge: a row at its limit to the last digit is decided by rationals") {
  Lcp problem = Lcp::standard(chain(9, -1).A, Vector(Eigen::VectorXd::Constant(9, -1)));
  Vector z;
  z.resize(9);
  for (Index i = 0; i < 9; ++i) z[i] = static_cast<double>(i + 1);
  const double limit = (1 - 0x1p-20) * 0x1p-33;  // β = s = 2 z_i … at least 1; w = off
  for (const int ulps : {-3, -2, -1, 0, 1, 2, 3}) {
    Vector off = z;
    off[8] += limit * 17;
    for (int k = 0; k < std::abs(ulps); ++k) off[8] = std::nextafter(off[8], ulps < 0 ? 0 : kInf);
    compare(problem, off, 0x1p-33);
  }
}

TEST_CASE("distributed judge: outside of bounds, NaN, overflow, tiny numbers") {
  const auto [problem, z] = [] {
    Random random(3);
    return planted(12, 1, random);
  }();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Index i : {0, 5, 11})
    for (const double value : {nan, kInf, -1e300, 1e300, -3.0}) {
      Vector bad = z;
      bad[i] = value;
      CHECK_FALSE(has_answer(compare(problem, bad, 1e-10)));
    }
  Lcp huge = chain(10, -1e200);
  Vector large(Eigen::VectorXd::Constant(10, 1e200));
  compare(huge, large, 1e-10);
  const double tiny = std::numeric_limits<double>::denorm_min();
  Vector small(Eigen::VectorXd::Constant(10, tiny));
  Lcp faint = chain(10, -1);
  faint.b.setConstant(0);
  compare(faint, small, 1e-10);
}

TEST_CASE("distributed judge: a permuted chain needs one round a crossing and no more") {
  const Index n = 48;
  const Lcp ordered = chain(n, -1);
  std::vector<int> place;  // 0, 24, 1, 25, …: with two ranks each link crosses
  for (Index i = 0; i < n; ++i) place.push_back(static_cast<int>(i % 2 * (n / 2) + i / 2));
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(n, n);
  std::vector<Eigen::Triplet<double>> entries;
  for_each_entry(ordered.A,
                 [&](Index i, Index j, double value) { entries.emplace_back(place[at(i)], place[at(j)], value); });
  A.setFromTriplets(entries.begin(), entries.end());
  Lcp problem = Lcp::standard(RowSparse::from(A), ordered.b);
  Vector z(Eigen::VectorXd::Ones(n));
  z[place[at(n - 1)]] = 1 + 0.5e-10;
  CHECK(compare(problem, z, 1e-10) == Status::solved);
  const DistributedLcp rows = DistributedLcp::from(MPI_COMM_WORLD, problem);
  DistributedJudge judge(rows);
  Vector part = part_of(rows, z);
  const Verdict verdict = judge.judge(part, 1e-10);
  CHECK(verdict.rounds <= n + 1);
  if (ranks_of_all() == 1) CHECK(verdict.rounds <= 1);
}
