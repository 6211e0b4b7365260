// Row scales of the judge: parts of coupled rows, and the data that come from one row to another.
#include <orthant/core/lcp/judge/certify.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace orthant {
// Which rows belong together: path-halving union of the rows that an entry of A, a body or a friction bound couples.
void Judge::label_parts(const Lcp& problem) {
  const Index n = problem.size();
  part_.resize(at(n));
  for (Index i = 0; i < n; ++i) part_[at(i)] = static_cast<int>(i);
  const auto root = [this](Index i) {
    auto k = static_cast<std::size_t>(i);
    while (part_[k] != static_cast<int>(k)) {
      part_[k] = part_[at(part_[k])];
      k = at(part_[k]);
    }
    return static_cast<int>(k);
  };
  const auto join = [&](Index i, Index j) {
    const int a = root(i), b = root(j);
    part_[at(std::max(a, b))] = std::min(a, b);
  };
  const bool stored = for_each_entry(problem.A, [&](Index i, Index j, double a) {
    if (a != 0 && i != j) join(i, j);
  });
  if (!stored) {
    const auto& [W, inverse_mass, regularization] = std::get<Delassus>(problem.A);
    first_.assign(at(W.cols), -1);
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
        if (inverse_mass[W.column[k]] == 0) continue;
        int& first = first_[at(W.column[k])];
        if (first < 0) first = static_cast<int>(i);
        join(i, first);
      }
  }
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t) join(t, f.normal);
  for (Index i = 0; i < n; ++i) part_[at(i)] = root(i);
}

// x_i ← the least with x_i ≥ x_i and x_i ≥ min(|A_ij z_j|, x_j) for all j. The widest paths, the widest first: n log n
// for n rows, where sweeps over a long chain of unordered rows take n². Friction has its normal's.
void Judge::spread(const Lcp& problem, const Vector& z, Vector& x) {
  const auto* dense = std::get_if<DenseMatrix>(&problem.A);
  const auto* rows = std::get_if<RowSparse>(&problem.A);
  if (std::holds_alternative<Delassus>(problem.A)) rows = &entries_;
  const Index n = problem.size();
  if (rows != nullptr) {  // by columns
    first_.assign(at(n + 1), 0);
    for (const int column : rows->column) ++first_[at(column)];
    for (const Friction& f : problem.friction) ++first_[at(f.normal)];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    couplings_.resize(at(first_[at(n)]));
    const auto place = [&](Index j, Index i, double wide) {
      couplings_[at(--first_[at(j)])] = {wide, static_cast<int>(i)};
    };
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(rows->start[at(i)]); k < at(rows->start[at(i) + 1]); ++k)
        place(rows->column[k], i, std::abs(rows->value[k] * z[rows->column[k]]));
    for (const Friction& f : problem.friction) place(f.normal, f.first, kInf);
  }
  heap_.clear();
  for (Index i = 0; i < n; ++i)
    if (x[i] > 0) heap_.emplace_back(x[i], static_cast<int>(i));
  std::make_heap(heap_.begin(), heap_.end());
  const auto stale = [&](const Coupling& each) { return each.first < x[each.second]; };
  const auto raise = [&](Index i, double by) {
    if (by <= x[i]) return;
    x[i] = by;
    if (heap_.size() > at(2 * n)) {  // no more than n are not stale
      std::erase_if(heap_, stale);
      std::make_heap(heap_.begin(), heap_.end());
    }
    heap_.emplace_back(by, static_cast<int>(i));
    std::push_heap(heap_.begin(), heap_.end());
  };
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Coupling next = heap_.back();
    heap_.pop_back();
    if (stale(next)) continue;
    const auto [much, j] = next;
    if (dense != nullptr) {
      for (Index i = 0; i < n; ++i) raise(i, std::min(std::abs((*dense)(i, j) * z[j]), much));
      for (const Friction& f : problem.friction)
        if (f.normal == j) raise(f.first, much);
    } else {
      for (std::size_t k = at(first_[at(j)]); k < at(first_[at(j + 1)]); ++k)
        raise(couplings_[k].second, std::min(couplings_[k].first, much));
    }
  }
}

// The largest number of operations in one w_i.
double Judge::terms(const Matrix& A) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) return static_cast<double>(dense->cols());
  const auto longest = [](const RowSparse& rows) {
    int most = 0;
    for (std::size_t i = 1; i < rows.start.size(); ++i) most = std::max(most, rows.start[i] - rows.start[i - 1]);
    return most;
  };
  if (const auto* sparse = std::get_if<RowSparse>(&A)) return longest(*sparse);
  const RowSparse& W = std::get<Delassus>(A).W;
  first_.assign(at(W.cols), 0);
  int tallest = 0;
  for (const int column : W.column) tallest = std::max(tallest, ++first_[at(column)]);
  return longest(W) + tallest + 4;
}

}  // namespace orthant
