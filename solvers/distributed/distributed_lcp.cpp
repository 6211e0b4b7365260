#include <orthant/solvers/distributed/distributed_lcp.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::distributed {
namespace {

std::string row_name(Index row) { return "row " + std::to_string(row); }

/// Reason why the parts of one rank do not fit together, but for what the other ranks have; else empty.
std::string wrong_rows(const LocalRows& r) {
  const Index m = r.A.rows;
  if (m < 0 || static_cast<Index>(r.A.start.size()) != m + 1 || r.A.start.front() != 0)
    return "A.start: must have a 0 and the end of each of the " + std::to_string(m) + " rows";
  if (at(r.A.start.back()) != r.A.column.size() || r.A.column.size() != r.A.value.size())
    return "A: column and value must have as many entries as start ends with, " + std::to_string(r.A.start.back());
  for (const auto& [name, x] : {std::pair{"b", &r.b}, {"lo", &r.lo}, {"hi", &r.hi}})
    if (x->size() != m)
      return std::string(name) + " has " + std::to_string(x->size()) +
             " entries: must be as many as the rank's rows, " + std::to_string(m);
  for (Index i = 0; i < m; ++i) {
    const std::string row = row_name(r.first + i);
    if (r.A.start[at(i)] > r.A.start[at(i + 1)]) return row + ": A.start must not fall";
    Index last = -1;
    for (auto k = at(r.A.start[at(i)]); k < at(r.A.start[at(i + 1)]); ++k) {
      const Index j = r.A.column[k];
      if (j <= last || j >= r.A.cols)
        return row + ": column " + std::to_string(j) + " must be above the one before and below " +
               std::to_string(r.A.cols);
      if (!std::isfinite(r.A.value[k])) return row + ": A in column " + std::to_string(j) + " must be finite";
      last = j;
    }
    if (!std::isfinite(r.b[i])) return row + ": b must be finite";
    if (!(r.lo[i] <= r.hi[i]) || r.lo[i] == kInf || r.hi[i] == -kInf)
      return row + ": bounds must have lo <= hi, lo < inf, hi > -inf";
  }
  return {};
}

/// In (−1, 1), the same for the same row whatever the number of ranks.
double pseudo_random(Index row) {
  auto x = static_cast<std::uint64_t>(row) + 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return static_cast<double>((x ^ (x >> 31U)) >> 11U) * 0x1p-52 - 1;
}

}  // namespace

OwnedVec view(MPI_Comm comm, Vector& x, Index entries) {
  OwnedVec v;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  const auto m = static_cast<PetscInt>(entries);
  require(ranks == 1 ? VecCreateSeqWithArray(comm, 1, m, x.data(), v.out())
                     : VecCreateMPIWithArray(comm, 1, m, PETSC_DETERMINE, x.data(), v.out()));
  // At state 0, PETSc 3.18 takes norms that it never computed as known: 0.
  PetscScalar* data = nullptr;
  require(VecGetArray(v, &data));
  require(VecRestoreArray(v, &data));  // raises the state
  return v;
}

DistributedLcp::DistributedLcp(MPI_Comm comm, LocalRows rows) : comm_(comm), rows_(std::move(rows)) {
  start_petsc();
  require_everywhere(comm_, wrong_rows(rows_));
  long long m = rows_.A.rows, before = 0, all = 0;
  MPI_Exscan(&m, &before, 1, MPI_LONG_LONG, MPI_SUM, comm_);
  MPI_Allreduce(&m, &all, 1, MPI_LONG_LONG, MPI_SUM, comm_);
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0) before = 0;  // MPI leaves it undefined
  n_ = all;
  require_everywhere(
      comm_, n_ != rows_.A.cols ? "A has " + std::to_string(rows_.A.cols) +
                                      " columns: must be as many as all ranks have rows, " + std::to_string(n_)
             : n_ > std::numeric_limits<PetscInt>::max() ? "n must be below 2^31"
             : before != rows_.first                     ? "first = " + std::to_string(rows_.first) +
                                           ": must be the number of rows of the ranks before, " + std::to_string(before)
                                     : "");
  make_matrix();
  find_halo();
  scale_.resize(rows_.A.rows);
  for (Index i = 0; i < rows_.A.rows; ++i) {
    double diagonal = 0, largest = 0;
    rows_.A.for_each_in_row(i, [&](Index j, double value) {
      largest = std::max(largest, std::abs(value));
      if (j == i) diagonal = value;
    });
    scale_[i] = diagonal > 0 ? diagonal : largest > 0 ? largest : 1;
  }
  symmetric_ = seems_symmetric();
}

DistributedLcp DistributedLcp::from(MPI_Comm comm, const Lcp& problem) {
  start_petsc();
  check(problem);
  if (!problem.friction.empty())
    throw std::invalid_argument("friction: a distributed problem must have bounds that do not depend on z");
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  RowSparse room;
  const RowSparse& A = *rows_of(problem.A, room);
  const Index n = problem.size(), first = n * rank / ranks, m = n * (rank + 1) / ranks - first;
  LocalRows rows;
  rows.first = first;
  rows.A.rows = m, rows.A.cols = n;
  const int begin = A.start[at(first)], end = A.start[at(first + m)];
  for (Index i = 0; i < m; ++i) rows.A.start.push_back(A.start[at(first + i + 1)] - begin);
  rows.A.column.assign(A.column.begin() + begin, A.column.begin() + end);
  rows.A.value.assign(A.value.begin() + begin, A.value.begin() + end);
  rows.b = problem.b.segment(first, m);
  rows.lo = problem.lo.segment(first, m);
  rows.hi = problem.hi.segment(first, m);
  return {comm, std::move(rows)};
}

void DistributedLcp::make_matrix() {
  const auto m = static_cast<PetscInt>(rows_.A.rows), n = static_cast<PetscInt>(n_);
  RowSparse A;  // with all of the diagonal, where zeros are missing: V of a semismooth method has it
  for (Index i = 0; i < rows_.A.rows; ++i) {
    const Index own = rows_.first + i;
    bool there = false;
    const auto put = [&](Index j, double value) { A.column.push_back(static_cast<int>(j)), A.value.push_back(value); };
    rows_.A.for_each_in_row(i, [&](Index j, double value) {
      if (j > own && !there) put(own, 0);
      there = there || j >= own;
      put(j, value);
    });
    if (!there) put(own, 0);
    A.start.push_back(static_cast<int>(A.column.size()));
  }
  require(MatCreate(comm_, matrix_.out()));
  require(MatSetSizes(matrix_, m, m, n, n));
  require(MatSetType(matrix_, MATAIJ));
  require(MatSeqAIJSetPreallocationCSR(matrix_, A.start.data(), A.column.data(), A.value.data()));
  require(MatMPIAIJSetPreallocationCSR(matrix_, A.start.data(), A.column.data(), A.value.data()));
}

void DistributedLcp::find_halo() {
  const Index m = rows_.A.rows, first = rows_.first;
  const auto own = [&](int j) { return j >= first && j < first + m; };
  for (const int j : rows_.A.column)
    if (!own(j)) halo_.push_back(j);
  std::sort(halo_.begin(), halo_.end());
  halo_.erase(std::unique(halo_.begin(), halo_.end()), halo_.end());
  halo_.shrink_to_fit();
  for (int& j : rows_.A.column)
    j = own(j) ? static_cast<int>(j - first)
               : static_cast<int>(m + (std::lower_bound(halo_.begin(), halo_.end(), j) - halo_.begin()));
  rows_.A.cols = m + static_cast<Index>(halo_.size());
  require(PetscLayoutCreateFromSizes(comm_, static_cast<PetscInt>(m), static_cast<PetscInt>(n_), 1, layout_.out()));
  require(PetscSFCreate(comm_, fetch_.out()));
  require(PetscSFSetGraphLayout(fetch_, layout_, static_cast<PetscInt>(halo_.size()), nullptr, PETSC_COPY_VALUES,
                                halo_.data()));
  require(PetscSFSetUp(fetch_));
  const PetscInt* ranges = nullptr;
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  require(PetscLayoutGetRanges(layout_, &ranges));
  auto next = halo_.begin();
  for (int r = 0; r < ranks; ++r) {
    const auto end = std::lower_bound(next, halo_.end(), ranges[r + 1]);
    neighbours_ += end != next ? 1 : 0;
    next = end;
  }
}

void DistributedLcp::exchange(Vector& x) const {
  require(PetscSFBcastBegin(fetch_, MPIU_SCALAR, x.data(), x.data() + rows(), MPI_REPLACE));
  require(PetscSFBcastEnd(fetch_, MPIU_SCALAR, x.data(), x.data() + rows(), MPI_REPLACE));
}

void DistributedLcp::residual(Vector& z, Vector& w) const {
  exchange(z);
  w.resize(rows());
  for (Index i = 0; i < rows(); ++i) {
    double sum = b()[i];
    A().for_each_in_row(i, [&](Index j, double value) { sum += value * z[j]; });
    w[i] = sum;
  }
}

bool DistributedLcp::seems_symmetric() const {
  Vector x, y, transposed;
  for (Vector* each : {&x, &y, &transposed}) each->resize(rows() + halo());
  for (Index i = 0; i < rows(); ++i) x[i] = pseudo_random(first() + i);
  const OwnedVec from = view(comm_, x, rows()), to = view(comm_, transposed, rows());
  require(MatMultTranspose(matrix_, from, to));
  exchange(x);
  bool equal = true;
  for (Index i = 0; i < rows(); ++i) {
    double sum = 0, size = 0;
    A().for_each_in_row(i, [&](Index j, double value) {
      sum += value * x[j];
      size += std::abs(value * x[j]);
    });
    equal = equal && std::abs(sum - transposed[i]) <= 1e-12 * size;
  }
  return !any_of_all(comm_, !equal);
}

}  // namespace orthant::distributed
