// solvers/distributed/distributed_lcp.h — linear complementarity problem distributed by rows over the ranks of MPI.
//
//   Find z in [lo, hi], w = A z + b as in core/lcp/problem.h, without friction rows. Rank r of P holds m_r contiguous
//   rows of A, b, lo, hi and the same entries of z: rank 0 the first ones, and so on; m_r = 0 is allowed.
//   Halo: the entries of z of other ranks that own rows refer to. exchange() fetches them: one message from each rank
//   that has some of them, 8 bytes an entry.
//   Memory a rank: own rows twice (for sums in a fixed order, and as PETSc's Mat), 4-byte indices; n < 2³¹.
//   Source: Balay, Gropp, McInnes & Smith, in Modern Software Tools in Scientific Computing (1997) 163-202 (PETSc);
//   Zhang et al., IEEE TPDS 33 (2022) 842-853 (PetscSF).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/solvers/distributed/petsc_objects.h>

namespace orthant::distributed {

/// The rows of one rank.
struct LocalRows {
  Index first = 0;   // index of the first one in the whole problem
  RowSparse A;       // m × n, columns of the whole problem, ascending
  Vector b, lo, hi;  // m
};

class DistributedLcp {
 public:
  /// Collective. `rows` are this rank's. Throws std::invalid_argument on all ranks, naming field, value and rule, where
  /// they do not fit together: shapes, columns, bounds (lo ≤ hi), numbers that are not finite, a first row that is not
  /// the sum of the rows of the ranks before.
  DistributedLcp(MPI_Comm comm, LocalRows rows);
  /// Collective. Each rank has the whole problem and keeps its part, n / P rows or one more. Throws
  /// std::invalid_argument for friction rows and what check() of problem.h refuses. An operator is formed.
  static DistributedLcp from(MPI_Comm comm, const Lcp& problem);

  MPI_Comm comm() const { return comm_; }
  Index size() const { return n_; }  // n, of the whole problem
  Index first() const { return rows_.first; }
  Index rows() const { return rows_.A.rows; }                 // m, of this rank
  Index halo() const { return rows_.A.cols - rows_.A.rows; }  // h
  int neighbours() const { return neighbours_; }              // ranks that own part of the halo
  /// m × (m + h): own columns from 0, then the halo's in ascending order of the whole problem. The entries of a row
  /// stay in the order of their columns in the whole problem.
  const RowSparse& A() const { return rows_.A; }
  const Vector& b() const { return rows_.b; }
  const Vector& lo() const { return rows_.lo; }
  const Vector& hi() const { return rows_.hi; }
  /// A as PETSc has it, MATAIJ of n × n.
  Mat matrix() const { return matrix_; }
  /// d_i = A_ii where positive, else the largest |A_ij| of the row, else 1.
  const Vector& scale() const { return scale_; }
  /// A = Aᵀ up to rounding: A x and Aᵀx agree for a vector of pseudo-random numbers.
  bool symmetric() const { return symmetric_; }

  /// Collective. x has m + h entries, own ones filled: fetches the others.
  void exchange(Vector& x) const;
  /// Collective. w ← A z + b, m entries; z of m + h, own ones filled.
  void residual(Vector& z, Vector& w) const;

 private:
  void find_halo();
  void make_matrix();
  bool seems_symmetric() const;

  MPI_Comm comm_;
  LocalRows rows_;
  Index n_ = 0;
  int neighbours_ = 0;
  bool symmetric_ = false;
  Vector scale_;
  std::vector<PetscInt> halo_;  // ascending
  OwnedMat matrix_;
  OwnedLayout layout_;
  OwnedSf fetch_;
};

/// A vector of PETSc over the entries of x, no copy; x must outlive it and keep its place.
OwnedVec view(MPI_Comm comm, Vector& x, Index entries);

}  // namespace orthant::distributed
