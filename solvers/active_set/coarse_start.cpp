#include <orthant/solvers/active_set/coarse_start.h>

namespace orthant {
namespace {

constexpr Index kFew = 64;   // rows that need no start
constexpr int kEnough = 20;  // iterations on a level: a start need not be a solution

bool is_z_matrix(const RowSparse& A) {
  for (Index i = 0; i < A.rows; ++i)
    for (int k = A.start[at(i)]; k < A.start[at(i + 1)]; ++k)
      if (A.column[at(k)] == i ? !(A.value[at(k)] > 0) : A.value[at(k)] > 0) return false;
  return true;
}

}  // namespace

/// False when a coarse problem would hardly be smaller.
bool CoarseStart::interpolation(const Lcp& fine, Sparse& P, std::vector<int>& coarse) const {
  const auto& A = std::get<RowSparse>(fine.A);
  const auto weights = [&A](Index i, auto&& use) {  // use(j, −a_ij) for the strong neighbours of row i
    double most = 0;
    for (int k = A.start[at(i)]; k < A.start[at(i + 1)]; ++k) most = std::max(most, -A.value[at(k)]);
    for (int k = A.start[at(i)]; k < A.start[at(i + 1)]; ++k)
      if (-A.value[at(k)] > 0.25 * most) use(A.column[at(k)], -A.value[at(k)]);
  };
  constexpr int kOpen = -1, kFine = -2;
  std::vector<int> place(at(A.rows), kOpen);  // of a coarse row among them
  coarse.clear();
  for (Index i = 0; i < A.rows; ++i) {
    bool adjacent = place[at(i)] == kFine;
    weights(i, [&](int j, double) { adjacent = adjacent || place[at(j)] >= 0; });
    if (adjacent) {
      place[at(i)] = kFine;
      continue;
    }
    place[at(i)] = static_cast<int>(coarse.size());
    coarse.push_back(static_cast<int>(i));
    weights(i, [&](int j, double) { place[at(j)] = kFine; });
  }
  if (coarse.size() > at(A.rows) * 3 / 4) return false;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < A.rows; ++i) {
    if (place[at(i)] >= 0) {
      entries.emplace_back(i, place[at(i)], 1.0);
      continue;
    }
    double reached = 0, all = 0;
    weights(i, [&](int j, double a) { reached += place[at(j)] >= 0 ? a : 0; });
    for (int k = A.start[at(i)]; k < A.start[at(i + 1)]; ++k)
      if (A.column[at(k)] != i) all -= A.value[at(k)];
    if (!(reached > 0) || !(all > 0)) continue;
    weights(i, [&](int j, double a) {
      if (place[at(j)] >= 0) entries.emplace_back(i, place[at(j)], a * all / (reached * diagonal(fine.A, i)));
    });
  }
  P.resize(A.rows, static_cast<Index>(coarse.size()));
  P.setFromTriplets(entries.begin(), entries.end());
  return true;
}

void CoarseStart::solve(const Lcp& problem, const Budget& budget, Vector& z, bool guessed) {
  rows_.load(problem, z, budget);
  if (!guessed && !rows_.release_all()) rows_.load(problem, z, budget);
  for (int k = 0; k < kEnough && !budget.exhausted() && rows_.solve(); ++k) {
    z = rows_.z.cwiseMax(problem.lo).cwiseMin(problem.hi);
    bool moved = false;
    for (Index i = 0; i < problem.size(); ++i) {
      const Side better = rows_.better(i);
      moved = moved || better != rows_.side[at(i)];
      rows_.side[at(i)] = better;
    }
    if (!moved) return;
  }
}

bool CoarseStart::guess(const Lcp& problem, const Budget& budget, Vector& z) {
  const auto* A = std::get_if<RowSparse>(&problem.A);
  if (A == nullptr || A->rows < kFew || !is_z_matrix(*A)) return false;
  std::vector<Lcp> levels;  // below the given problem
  std::vector<Sparse> up;
  Sparse P;
  std::vector<int> coarse;
  for (const Lcp* fine = &problem; fine->size() >= kFew && interpolation(*fine, P, coarse); fine = &levels.back()) {
    if (budget.exhausted()) return false;
    const Sparse down = P.transpose(), product = down * std::get<RowSparse>(fine->A).view() * P;
    Lcp next;
    next.A = RowSparse::from(product);
    next.b = down * fine->b, next.lo = fine->lo(coarse), next.hi = fine->hi(coarse);
    levels.push_back(std::move(next));
    up.push_back(P);
  }
  if (levels.empty()) return false;
  Vector y(Eigen::VectorXd::Zero(levels.back().size()));
  for (std::size_t level = levels.size(); level-- > 0;) {
    solve(levels[level], budget, y, level + 1 < levels.size());
    y = Vector(up[level] * y);
  }
  if (!y.allFinite()) return false;
  z = y;
  return true;
}

}  // namespace orthant
