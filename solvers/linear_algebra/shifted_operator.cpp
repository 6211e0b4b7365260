#include <orthant/solvers/linear_algebra/shifted_operator.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kFewer = 0.75;  // columns a row, up to which their space is the better one

}  // namespace

bool ShiftedOperator::load(const Delassus& A, const std::vector<int>& row, const Vector& scale) {
  const RowSparse& W = A.W;
  const std::size_t n = row.size();
  place_.assign(at(W.cols), -1);
  for (std::size_t k = 0; k < W.value.size(); ++k)
    if (W.value[k] != 0 && A.inverse_mass[W.column[k]] > 0) place_[at(W.column[k])] = 0;
  int used = 0;
  for (int& place : place_)
    if (place == 0) place = used++;
  if (used > kFewer * static_cast<double>(n)) return false;

  L_.rows = static_cast<Index>(n), L_.cols = used;
  L_.start.assign(1, 0), L_.column.clear(), L_.value.clear();
  columns_.rows = used, columns_.cols = L_.rows;
  columns_.start.assign(at(used) + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    W.for_each_in_row(row[i], [&](Index j, double value) {
      if (value == 0 || place_[at(j)] < 0) return;
      L_.column.push_back(place_[at(j)]), L_.value.push_back(scale[row[i]] * value * std::sqrt(A.inverse_mass[j]));
      ++columns_.start[at(L_.column.back()) + 1];
    });
    L_.start.push_back(static_cast<int>(L_.value.size()));
  }
  for (std::size_t j = 0; j < at(used); ++j) columns_.start[j + 1] += columns_.start[j];
  columns_.column.resize(L_.column.size()), columns_.value.resize(L_.value.size());
  filled_.assign(columns_.start.begin(), columns_.start.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    L_.for_each_in_row(static_cast<Index>(i), [&](Index j, double value) {
      const auto to = at(filled_[at(j)]++);
      columns_.column[to] = static_cast<int>(i), columns_.value[to] = value;
    });
  form();
  return true;
}

/// K_ without its shift, and the places of its diagonal: row j sums the rows of L that have an entry in column j.
void ShiftedOperator::form() {
  K_.rows = K_.cols = L_.cols;
  K_.start.assign(1, 0), K_.column.clear(), K_.value.clear();
  diagonal_.clear(), shift_ = 0;
  std::vector<int>& seen = place_;  // by which row of K last
  seen.assign(at(L_.cols), -1), sum_.resize(at(L_.cols));
  for (int j = 0; j < L_.cols; ++j) {
    filled_.clear();
    columns_.for_each_in_row(j, [&](Index i, double by) {
      L_.for_each_in_row(i, [&](Index k, double value) {
        if (seen[at(k)] != j) seen[at(k)] = j, sum_[at(k)] = 0, filled_.push_back(static_cast<int>(k));
        sum_[at(k)] += by * value;
      });
    });
    std::sort(filled_.begin(), filled_.end());
    for (const int k : filled_) {
      if (k == j) diagonal_.push_back(static_cast<int>(K_.value.size()));
      K_.column.push_back(k), K_.value.push_back(sum_[at(k)]);
    }
    K_.start.push_back(static_cast<int>(K_.value.size()));
  }
}

bool ShiftedOperator::factorize(double s, const Budget* budget) {
  for (const int place : diagonal_) K_.value[at(place)] += s - shift_;
  shift_ = s;
  return cholesky_.factorize(K_, 0, budget);
}

bool ShiftedOperator::solve(Vector& x) {
  inner_.resize(L_.cols);
  inner_.noalias() = columns_.view() * x;
  if (!cholesky_.solve(inner_)) return false;
  x.noalias() -= L_.view() * inner_;
  x /= shift_;
  return true;
}

}  // namespace orthant
