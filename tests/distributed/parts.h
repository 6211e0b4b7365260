// tests/distributed/parts.h — parts of a whole problem on the ranks, and an answer put together again.
#pragma once

#include <orthant/core/support/random.h>
#include <orthant/solvers/distributed/distributed_lcp.h>

#include <cmath>
#include <vector>

namespace orthant::distributed {

inline int rank_of_this() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
inline int ranks_of_all() {
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks;
}

/// The own part of x, with room for the halo.
inline Vector part_of(const DistributedLcp& problem, const Vector& x) {
  Vector part;
  part.resize(problem.rows() + problem.halo());
  part.setZero();
  part.head(problem.rows()) = x.segment(problem.first(), problem.rows());
  return part;
}

/// The whole of what each rank has a part of, on all ranks.
inline Vector whole_of(const DistributedLcp& problem, const Vector& part) {
  Vector whole(Eigen::VectorXd::Zero(problem.size())), sum(Eigen::VectorXd::Zero(problem.size()));
  whole.segment(problem.first(), problem.rows()) = part.head(problem.rows());
  MPI_Allreduce(whole.data(), sum.data(), static_cast<int>(problem.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return sum;
}

/// A sparse problem with boxes and free rows, rows in units apart by powers of `spread`, and an answer known where the
/// rounding of b is left out.
struct Planted {
  Lcp problem;
  Vector z;
};
inline Planted planted(Index n, double spread, Random& random) {
  Planted made;
  RowSparse A;
  A.rows = A.cols = n;
  made.z.resize(n);
  Lcp& p = made.problem;
  p.b.resize(n), p.lo.resize(n), p.hi.resize(n);
  for (Index i = 0; i < n; ++i) {
    const double unit = std::pow(spread, random.integer(-3, 3));
    for (Index j = 0; j < n; ++j)
      if (i == j || random.uniform() < 4.0 / static_cast<double>(n))
        A.column.push_back(static_cast<int>(j)), A.value.push_back(unit * (i == j ? 5 : random.uniform(-1, 1)));
    A.start.push_back(static_cast<int>(A.column.size()));
    const int kind = random.integer(0, 5);
    p.lo[i] = kind == 0 ? -kInf : kind == 1 ? random.uniform(-1, 1) : 0;
    p.hi[i] = kind == 0 || kind >= 3 ? kInf : p.lo[i] + random.integer(0, 2);
    made.z[i] = kind == 0 ? random.uniform(-1, 1) : random.integer(0, 1) == 0 ? p.lo[i] : p.lo[i] + random.uniform();
    if (made.z[i] > p.hi[i]) made.z[i] = p.hi[i];
  }
  for (Index i = 0; i < n; ++i) {
    double w = 0, size = 0;
    A.for_each_in_row(i, [&](Index j, double value) { w += value * made.z[j], size += std::abs(value); });
    const double slack = random.integer(0, 3) == 0 ? 0 : size * random.uniform();
    p.b[i] = -w + (made.z[i] == p.lo[i] ? slack : made.z[i] == p.hi[i] ? -slack : 0);
  }
  p.A = A;
  return made;
}

}  // namespace orthant::distributed
