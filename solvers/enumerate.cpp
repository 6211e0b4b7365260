#include <orthant/solvers/enumerate.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace orthant {
namespace {

constexpr double kSingular = 1e-11;  // pivot against the block's largest entry: a zero
constexpr double kTolerance = 1e-9;  // generous: the judge decides

}  // namespace

std::string Enumerate::why_not(const Lcp& problem) const {
  Index rows = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    rows += std::isfinite(problem.lo[i]) + std::isfinite(problem.hi[i]);
  }
  rows += 2 * static_cast<Index>(problem.friction.size());
  if (rows <= kMost) return {};
  return std::to_string(rows) + " complementary rows in the pure form: enumeration takes at most " +
         std::to_string(kMost);
}

void Enumerate::form(const Lcp& problem) {
  reduced_ = Pyramid::needed(problem);
  const Lcp& pure = reduced_ ? pyramid_.pure(problem) : problem;
  to_dense(pure.A, M_);
  q_ = pure.b;
  complementary_.clear(), free_.clear();
  for (Index i = 0; i < q_.size(); ++i) (pure.lo[i] == -kInf ? free_ : complementary_).push_back(i);
  subset_ = 0;
}

bool Enumerate::solve_basis(unsigned long subset) {
  basis_ = free_;
  for (std::size_t k = 0; k < complementary_.size(); ++k)
    if (subset >> k & 1UL) basis_.push_back(complementary_[k]);
  const auto m = static_cast<Index>(basis_.size());
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  block_.resize(m * m), rhs_.resize(m);
  double largest = 0;
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < m; ++i)
      largest = std::max(largest, std::abs(block_[j * m + i] = M_(basis_[at(i)], basis_[at(j)])));
  for (Index i = 0; i < m; ++i) rhs_[i] = -q_[basis_[at(i)]];
  const double scale = rhs_.size() > 0 ? rhs_.lpNorm<Eigen::Infinity>() : 0;

  order_.resize(at(m));  // of the columns
  std::iota(order_.begin(), order_.end(), Index{0});
  Index rank = 0;
  for (; rank < m; ++rank) {
    Index row = rank, column = rank;
    for (Index j = rank; j < m; ++j)
      for (Index i = rank; i < m; ++i)
        if (std::abs(block_[j * m + i]) > std::abs(block_[column * m + row])) row = i, column = j;
    if (std::abs(block_[column * m + row]) <= kSingular * largest) break;
    for (Index j = 0; j < m; ++j) std::swap(block_[j * m + row], block_[j * m + rank]);
    for (Index i = 0; i < m; ++i) std::swap(block_[column * m + i], block_[rank * m + i]);
    std::swap(rhs_[row], rhs_[rank]);
    std::swap(order_[at(column)], order_[at(rank)]);
    for (Index i = rank + 1; i < m; ++i) {
      const double factor = block_[rank * m + i] / block_[rank * m + rank];
      if (factor == 0) continue;
      for (Index j = rank; j < m; ++j) block_[j * m + i] -= factor * block_[j * m + rank];
      rhs_[i] -= factor * rhs_[rank];
    }
  }
  for (Index i = rank; i < m; ++i)
    if (std::abs(rhs_[i]) > kTolerance * scale) return false;  // inconsistent
  y_.resize(q_.size());
  y_.setZero();
  for (Index i = rank - 1; i >= 0; --i) {
    double value = rhs_[i];
    for (Index j = i + 1; j < rank; ++j) value -= block_[j * m + i] * y_[basis_[at(order_[at(j)])]];
    y_[basis_[at(order_[at(i)])]] = value / block_[i * m + i];
  }
  const double size = y_.size() > 0 ? y_.lpNorm<Eigen::Infinity>() : 0;
  for (const Index i : complementary_) {
    if (y_[i] < -kTolerance * size) return false;
    y_[i] = std::max(y_[i], 0.0);
  }
  for (const Index i : complementary_) {
    double w = q_[i], magnitude = std::abs(q_[i]);
    for (const Index j : basis_) w += M_(i, j) * y_[j], magnitude += std::abs(M_(i, j) * y_[j]);
    if (w < -kTolerance * magnitude) return false;
  }
  return true;
}

bool Enumerate::next_candidate(const Lcp& problem, Vector& z) {
  while (subset_ >> complementary_.size() == 0) {
    if (!solve_basis(subset_++)) continue;
    if (reduced_)
      pyramid_.restore(problem, y_, z);
    else
      z = y_;
    return true;
  }
  return false;
}

Status Enumerate::run(const Lcp& problem, Solution& s, Start) {
  form(problem);
  const bool found = next_candidate(problem, s.z);
  s.iterations = static_cast<int>(subset_);
  return found ? Status::solved : Status::ray;
}

bool Enumerate::run_again(const Lcp& problem, Solution& s, int, Status& claim) {
  if (claim != Status::solved || !next_candidate(problem, s.z)) return false;
  s.iterations = static_cast<int>(subset_);
  return true;
}

std::vector<Vector> Enumerate::all(const Lcp& problem) {
  std::vector<Vector> found;
  if (!why_not(problem).empty()) return found;
  Judge judge;
  Solution s;
  form(problem);
  while (next_candidate(problem, s.z)) {
    judge.certify(problem, options_.tolerance, Status::solved, s);
    if (s.status != Status::solved) continue;
    const double size = s.z.size() > 0 ? s.z.lpNorm<Eigen::Infinity>() : 0;
    const bool known = std::any_of(found.begin(), found.end(), [&](const Vector& z) {
      return z.size() == 0 || (z - s.z).lpNorm<Eigen::Infinity>() <= kTolerance * (1 + size);
    });
    if (!known) found.push_back(s.z);
  }
  return found;
}

}  // namespace orthant
