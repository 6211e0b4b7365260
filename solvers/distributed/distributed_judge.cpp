#include <orthant/solvers/distributed/distributed_judge.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace orthant::distributed {
namespace {

using detail::against, detail::limit_of_rounded, detail::limit_of_solved, detail::nearest_to_zero, detail::wrong_by;
using detail::kDouble, detail::kEpsilon, detail::kLeastNormal, detail::kLong, detail::kProducts, detail::kRoundings,
    detail::kSure;

exact::Rational exact_sum(const DistributedLcp& problem, Index i, const Vector& z) {
  exact::Rational w = problem.b()[i];
  problem.A().for_each_in_row(i, [&](Index j, double value) {
    if (value != 0 && z[j] != 0) w += exact::Rational(value) * exact::Rational(z[j]);
  });
  return w;
}

/// On all ranks that of the rank with the largest ratio, the last such rank.
Miss furthest(MPI_Comm comm, const Miss& own, double ratio) {
  struct {
    double ratio;
    int rank;
  } mine{ratio, 0}, worst{};
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  mine.rank = ranks - 1 - rank;  // of equal ones MPI takes the lowest
  MPI_Allreduce(&mine, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, comm);
  std::array<double, 5> parts{static_cast<double>(own.row), static_cast<double>(own.against), own.by, own.allowed,
                              own.tolerance};
  MPI_Bcast(parts.data(), 5, MPI_DOUBLE, ranks - 1 - worst.rank, comm);
  return {static_cast<Index>(parts[0]), static_cast<Miss::Against>(static_cast<int>(parts[1])), parts[2], parts[3],
          parts[4]};
}

}  // namespace

DistributedJudge::DistributedJudge(const DistributedLcp& problem) : problem_(problem) {
  double least = kInf, longest = 0;
  for (Index i = 0; i < problem.rows(); ++i) {
    if (problem.b()[i] != 0) least = std::min(least, std::abs(problem.b()[i]));
    longest = std::max(longest, static_cast<double>(problem.A().start[at(i + 1)] - problem.A().start[at(i)]));
  }
  least_b_ = least_of_all(problem.comm(), least);
  terms_ = largest_of_all(problem.comm(), longest);
  rows_.resize(at(problem.rows()));
  w_.resize(problem.rows());
  beta_.resize(problem.rows() + problem.halo());
  bounds_.resize(problem.rows() + problem.halo());
}

Verdict DistributedJudge::judge(Vector& z, double tolerance) {
  const MPI_Comm comm = problem_.comm();
  problem_.exchange(z);
  Verdict verdict;
  double residual = 0;
  std::array<double, 2> own{surely_solved(z, tolerance, residual) ? 0.0 : 1.0, residual}, all{};
  MPI_Allreduce(own.data(), all.data(), 2, MPI_DOUBLE, MPI_MAX, comm);
  verdict.residual = all[1];
  if (all[0] == 0) {
    verdict.status = Status::solved;
    return verdict;
  }
  weigh(z);
  const double data = largest_of_all(comm, find_data(z));
  bool solved = false;
  if (data < kInf) {
    const bool missed = surely_missed(tolerance, data);
    own = {missed ? 1.0 : 0.0, missed || all_pass(z, tolerance) ? 0.0 : 1.0};
    MPI_Allreduce(own.data(), all.data(), 2, MPI_DOUBLE, MPI_MAX, comm);
    solved = all[0] == 0 && (all[1] == 0 || spreads_to_solved(z, tolerance, verdict.rounds));
  }
  finish(z, tolerance, solved, data, verdict);
  return verdict;
}

// With doubles alone, and |b_i| for β_i: as Judge::surely_solved().
bool DistributedJudge::surely_solved(const Vector& z, double tolerance, double& residual) {
  const double unit = kDouble * (terms_ + 3);
  bool sure = true;
  for (Index i = 0; i < problem_.rows(); ++i) {
    const double b = problem_.b()[i];
    double sum = b, size = std::abs(b);
    problem_.A().for_each_in_row(i, [&](Index j, double value) {
      sum += value * z[j];
      size += std::abs(value) * std::abs(z[j]);
    });
    w_[i] = sum;
    const double wrong = wrong_by(z[i], sum, problem_.lo()[i], problem_.hi()[i]);
    const double limit = b != 0 ? kSure * limit_of_solved(tolerance, size, least_b_) : 0;
    sure = sure && size > kProducts && size < kInf && wrong + unit * size <= limit;
    residual = std::max(residual, wrong);
  }
  return sure;
}

// Sums in long double, as Judge::weigh() has them.
void DistributedJudge::weigh(const Vector& z) {
  const long double unit = kLong * (static_cast<long double>(terms_) + 3);
  for (Index i = 0; i < problem_.rows(); ++i) {
    long double sum = 0, size = 0;
    problem_.A().for_each_in_row(i, [&](Index j, double value) {
      const long double product = static_cast<long double>(value) * z[j];
      sum += product;
      size += std::abs(product);
    });
    const long double w = problem_.b()[i] + sum, terms = std::abs(problem_.b()[i]) + size;
    w_[i] = static_cast<double>(w);
    rows_[at(i)] = {wrong_by(z[i], w, problem_.lo()[i], problem_.hi()[i]), unit * terms,
                    std::min(static_cast<double>(terms), std::numeric_limits<double>::max())};
  }
}

/// v_i ≤ limit; where rounding leaves it open, rationals decide.
bool DistributedJudge::within(Index i, double limit, const Vector& z) {
  Row& row = rows_[at(i)];
  if (row.wrong + row.off > limit && row.wrong - row.off <= limit) {
    row.wrong = detail::exactly_wrong_by(exact_sum(problem_, i, z), z[i], problem_.lo()[i], problem_.hi()[i]);
    row.off = kEpsilon * std::abs(row.wrong);
  }
  return row.wrong + row.off <= limit;
}

// beta_ ← each row's own data; returns the largest of this rank.
double DistributedJudge::find_data(const Vector& z) {
  const auto &lo = problem_.lo(), &hi = problem_.hi();
  for (Index i = 0; i < problem_.rows(); ++i)
    bounds_[i] = detail::on_bound(z[i], lo[i], hi[i]) ? z[i] : nearest_to_zero(lo[i], hi[i]);
  problem_.exchange(bounds_);
  double largest = 0;
  for (Index i = 0; i < problem_.rows(); ++i) {
    double data = std::abs(problem_.b()[i]);
    problem_.A().for_each_in_row(i, [&](Index j, double value) { data += std::abs(value) * std::abs(bounds_[j]); });
    beta_[i] = data;
    largest = std::max(largest, data);
  }
  return largest;
}

/// Some row of this rank misses by so much that no data would let it pass.
bool DistributedJudge::surely_missed(double tolerance, double data) const {
  return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
    const double limit = std::max(limit_of_solved(tolerance, row.size, data), limit_of_rounded(row.size)) + kProducts;
    return !(row.wrong - row.off <= 1.001 * limit);
  });
}

bool DistributedJudge::all_pass(const Vector& z, double tolerance) {
  for (Index i = 0; i < problem_.rows(); ++i)
    if (!within(i, kSure * limit_of_solved(tolerance, rows_[at(i)].size, beta_[i]), z)) return false;
  return true;
}

/// Raises β until all rows of all ranks pass (true) or no rank changes.
bool DistributedJudge::spreads_to_solved(const Vector& z, double tolerance, int& rounds) {
  const Index m = problem_.rows(), all = m + problem_.halo();
  couple(z);
  heap_.clear();
  const auto push = [this](Index i) {
    heap_.emplace_back(beta_[i], static_cast<int>(i));
    std::push_heap(heap_.begin(), heap_.end());
  };
  for (Index i = m; i < all; ++i) beta_[i] = 0;
  for (Index i = 0; i < m; ++i)
    if (beta_[i] > 0) push(i);
  spread_within_rank();  // what an exchange then leaves as it was is final
  Vector& before = bounds_;
  while (true) {
    ++rounds;
    for (Index i = m; i < all; ++i) before[i] = beta_[i];
    problem_.exchange(beta_);
    bool raised = false;
    for (Index i = m; i < all; ++i)
      if (beta_[i] > before[i]) push(i), raised = true;
    spread_within_rank();
    std::array<double, 2> own{all_pass(z, tolerance) ? 0.0 : 1.0, raised ? 1.0 : 0.0}, any{};
    MPI_Allreduce(own.data(), any.data(), 2, MPI_DOUBLE, MPI_MAX, problem_.comm());
    if (any[0] == 0) return true;
    if (any[1] == 0) return false;
  }
}

// couplings_ ← the own rows that a column has, with |A_ij z_j|.
void DistributedJudge::couple(const Vector& z) {
  const RowSparse& A = problem_.A();
  start_.assign(at(A.cols + 1), 0);
  for (const int column : A.column) ++start_[at(column)];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  couplings_.resize(A.column.size());
  for (Index i = 0; i < A.rows; ++i)
    A.for_each_in_row(i, [&](Index j, double value) {
      couplings_[at(--start_[at(j)])] = {std::abs(value * z[j]), static_cast<int>(i)};
    });
}

void DistributedJudge::spread_within_rank() {
  const auto stale = [this](const std::pair<double, int>& each) { return each.first < beta_[each.second]; };
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const auto next = heap_.back();
    heap_.pop_back();
    if (stale(next)) continue;
    const auto [much, j] = next;
    for (std::size_t k = at(start_[at(j)]); k < at(start_[at(j + 1)]); ++k) {
      const auto [wide, i] = couplings_[k];
      const double by = std::min(wide, much);
      if (by <= beta_[i]) continue;
      beta_[i] = by;
      if (heap_.size() > at(2 * beta_.size())) {
        std::erase_if(heap_, stale);
        std::make_heap(heap_.begin(), heap_.end());
      }
      heap_.emplace_back(by, i);
      std::push_heap(heap_.begin(), heap_.end());
    }
  }
}

double DistributedJudge::limit_of_underflow(Index i) const {
  double floor = 1;
  problem_.A().for_each_in_row(i, [&](Index, double value) { floor += std::abs(value); });
  return kSure * kRoundings * kEpsilon * std::min(kLeastNormal * floor, kProducts);
}

/// With the final β: rounded, or how far the worst row is off.
void DistributedJudge::finish(const Vector& z, double tolerance, bool solved, double data, Verdict& verdict) {
  constexpr int passes = 0, rounded = 1, no = 2;
  int pass = passes;
  std::array<Miss, 3> misses;
  std::array<double, 3> worst{};
  double residual = 0;
  bool finite = true;
  for (Index i = 0; i < problem_.rows(); ++i) {
    const double size = rows_[at(i)].size, allowed = kSure * limit_of_solved(tolerance, size, beta_[i]);
    const bool good = solved || (data < kInf && within(i, allowed, z));
    finite = finite && std::isfinite(z[i]) && std::isfinite(w_[i]);
    residual = std::max(residual, static_cast<double>(rows_[at(i)].wrong));
    if (good) continue;
    double most = kSure * limit_of_rounded(size);
    if (!within(i, most, z) && rows_[at(i)].wrong < kProducts) most = std::max(most, limit_of_underflow(i));
    const int row_pass = data < kInf && within(i, most, z) ? rounded : no;
    const auto by = static_cast<double>(rows_[at(i)].wrong);
    const double limit = row_pass == rounded ? allowed : std::max(allowed, most);
    const double ratio = limit > 0 && by < kInf ? by / limit : kInf;
    pass = std::max(pass, row_pass);
    auto& worst_yet = worst[static_cast<std::size_t>(row_pass)];
    if (!(ratio >= worst_yet)) continue;
    worst_yet = ratio;
    misses[static_cast<std::size_t>(row_pass)] = {
        problem_.first() + i, against(z[i], problem_.lo()[i], problem_.hi()[i]), by, allowed, tolerance};
  }
  const std::array<double, 3> own{static_cast<double>(pass), residual, finite ? 0.0 : 1.0};
  std::array<double, 3> all{};
  MPI_Allreduce(own.data(), all.data(), 3, MPI_DOUBLE, MPI_MAX, problem_.comm());
  verdict.residual = all[1];
  const auto worst_pass = static_cast<int>(all[0]);
  verdict.status = worst_pass == passes    ? Status::solved
                   : worst_pass == rounded ? Status::rounded
                   : all[2] == 0           ? Status::stalled
                                           : Status::numerical_error;
  if (worst_pass == passes) return;
  const auto kind = static_cast<std::size_t>(worst_pass);
  verdict.miss = furthest(problem_.comm(), misses[kind], worst[kind]);
}

}  // namespace orthant::distributed
