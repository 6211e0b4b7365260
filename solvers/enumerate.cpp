#include <orthant/solvers/enumerate.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace orthant {
namespace {

constexpr long double kSingular = 1e-15L;  // pivot against 1, the rows' largest entry: a zero
constexpr long double kNoise = 1e-13L;     // signs are wrong beyond this share of the terms; then the judge decides

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

std::string Enumerate::why_not(const Lcp& problem) const {
  Index rows = 2 * static_cast<Index>(problem.friction.size());
  for (Index i = 0; i < problem.size(); ++i) rows += std::isfinite(problem.lo[i]) + std::isfinite(problem.hi[i]);
  if (rows <= kMost) return {};
  return std::to_string(rows) + " complementary rows in the pure form: enumeration takes at most " +
         std::to_string(kMost);
}

void Enumerate::form(const Lcp& problem) {
  pure_ = &pyramid_.pure(problem);
  scaling_.fit(std::get<DenseMatrix>(pure_->A));
  complementary_.clear();
  free_.clear();
  for (Index i = 0; i < pure_->size(); ++i) (pure_->lo[i] == -kInf ? free_ : complementary_).push_back(i);
  subset_ = 0;
}

bool Enumerate::solve_basis(unsigned long subset) {
  const auto& M = std::get<DenseMatrix>(pure_->A);
  const Vector& q = pure_->b;
  basis_ = free_;
  for (std::size_t k = 0; k < complementary_.size(); ++k)
    if (subset >> k & 1UL) basis_.push_back(complementary_[k]);
  const std::size_t m = basis_.size(), width = m + 1;
  inside_.assign(at(q.size()), 0);
  for (const Index i : basis_) inside_[at(i)] = 1;

  // Gauss–Jordan on rows [M_ββ | −q_β]; columns scaled, rows divided by their largest entry: units do not matter.
  block_.resize(m * width);
  const auto row = [&](std::size_t i) { return block_.data() + i * width; };
  for (std::size_t i = 0; i < m; ++i) {
    long double largest = 0;
    for (std::size_t j = 0; j < m; ++j) {
      row(i)[j] = M(basis_[i], basis_[j]) * scaling_.col[basis_[j]];
      largest = std::max(largest, std::abs(row(i)[j]));
    }
    row(i)[m] = -static_cast<long double>(q[basis_[i]]);
    if (largest > 0) std::for_each(row(i), row(i) + width, [&](long double& entry) { entry /= largest; });
  }
  order_.resize(m);  // of the columns
  std::iota(order_.begin(), order_.end(), Index{0});
  std::size_t rank = 0;
  for (; rank < m; ++rank) {
    std::size_t r = rank, c = rank;
    for (std::size_t i = rank; i < m; ++i)
      for (std::size_t j = rank; j < m; ++j)
        if (std::abs(row(i)[j]) > std::abs(row(r)[c])) r = i, c = j;
    if (std::abs(row(r)[c]) <= kSingular) break;
    std::swap_ranges(row(r), row(r) + width, row(rank));
    for (std::size_t i = 0; i < m; ++i) std::swap(row(i)[c], row(i)[rank]);
    std::swap(order_[c], order_[rank]);
    for (std::size_t i = 0; i < m; ++i) {
      const long double factor = row(i)[rank] / row(rank)[rank];
      if (i == rank || factor == 0) continue;
      for (std::size_t j = rank; j < width; ++j) row(i)[j] -= factor * row(rank)[j];
    }
  }
  regular_ = rank == m;

  y_.resize(q.size());
  y_.setZero();
  long double size = 0;
  for (std::size_t k = 0; k < rank; ++k) size = std::max(size, std::abs(row(k)[m] / row(k)[k]));
  for (std::size_t k = 0; k < rank; ++k) {
    const Index i = basis_[at(order_[k])];
    const long double value = row(k)[m] / row(k)[k];
    const bool free = pure_->lo[i] == -kInf;
    if (!free && value < -kNoise * size) return false;
    y_[i] = static_cast<double>(free ? value : std::max(value, 0.0L)) * scaling_.col[i];
  }
  for (Index i = 0; i < q.size(); ++i) {  // w ≥ 0, and w = 0 on β: a row without a pivot may not agree
    long double w = q[i], terms = std::abs(w);
    for (const Index j : basis_) {
      const long double term = static_cast<long double>(M(i, j)) * y_[j];
      w += term, terms += std::abs(term);
    }
    if (w < -kNoise * terms || (inside_[at(i)] && w > kNoise * terms)) return false;
  }
  return true;
}

bool Enumerate::next_candidate(const Lcp& problem, Vector& z) {
  while (subset_ >> complementary_.size() == 0) {
    if (!solve_basis(subset_++)) continue;
    pyramid_.restore(problem, y_, z);
    return true;
  }
  return false;
}

Status Enumerate::run(const Lcp& problem, Solution& s, Start) {
  form(problem);
  const bool found = next_candidate(problem, s.z);
  s.iterations = static_cast<int>(subset_);
  if (found) return Status::solved;
  s.z.setZero();
  farkas_.propose(problem, s.certificate);
  return Status::ray;
}

bool Enumerate::run_again(const Lcp& problem, Solution& s, int, Status& claim) {
  if (claim != Status::solved) return false;
  if (next_candidate(problem, s.z)) {
    s.iterations = static_cast<int>(subset_);
    return true;
  }
  s.z.setZero();
  farkas_.propose(problem, s.certificate);
  claim = Status::ray;
  return true;
}

std::vector<Vector> Enumerate::all(const Lcp& problem) {
  std::vector<Vector> found;
  check(problem);
  if (!why_not(problem).empty()) return found;
  Judge judge;
  Solution s;
  form(problem);
  while (next_candidate(problem, s.z)) {
    if (!regular_) continue;
    judge.certify(problem, options_.tolerance, Status::solved, s);
    if (s.status != Status::solved) continue;
    const auto same = [&](const Vector& z) {
      return (z - s.z).lpNorm<Eigen::Infinity>() <= 1e-9 * s.z.lpNorm<Eigen::Infinity>();
    };
    if (std::none_of(found.begin(), found.end(), same)) found.push_back(s.z);
  }
  return found;
}

}  // namespace orthant
