// Parts of a problem: rows that A or friction couples.
#include <orthant/core/lcp/judge/certify.h>

#include <algorithm>

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
  if (const auto* dense = std::get_if<DenseMatrix>(&problem.A)) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        if ((*dense)(i, j) != 0 && i != j) join(i, j);
  } else if (const auto* sparse = std::get_if<RowSparse>(&problem.A)) {
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(sparse->start[at(i)]); k < at(sparse->start[at(i) + 1]); ++k)
        if (sparse->value[k] != 0) join(i, sparse->column[k]);
  } else {
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
  for (const Friction& f : problem.friction) join(f.row, f.normal);
  for (Index i = 0; i < n; ++i) part_[at(i)] = root(i);
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
