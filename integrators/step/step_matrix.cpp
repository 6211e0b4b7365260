#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/step_matrix.h>

#include <algorithm>

namespace orthant {
namespace {

/// W from its rows.
template <class Row> void fill_delassus(const RowList<Row>& rows, const Eigen::VectorXd& inverse_mass, Delassus& A) {
  A.inverse_mass = inverse_mass;
  RowSparse& W = A.W;
  W.rows = static_cast<Index>(rows.size()), W.cols = inverse_mass.size();
  W.start.assign(1, 0), W.column.clear(), W.value.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    append_to(W.column, W.value, rows[i]);
    W.start.push_back(static_cast<int>(W.column.size()));
  }
}

}  // namespace

template <class Space> void StepMatrixOf<Space>::cut_operator(const RowList<Row>& rows, std::span<const int> numbers,
                                                              std::vector<int>& place, Delassus& A) const {
  constexpr int n = Space::kVelocities;
  RowSparse& W = A.W;
  W.rows = static_cast<Index>(numbers.size());
  W.start.assign(1, 0), W.column.clear(), W.value.clear();
  for (const int number : numbers) {
    append_to(W.column, W.value, rows[static_cast<std::size_t>(number)]);
    W.start.push_back(static_cast<int>(W.column.size()));
  }
  // place: of a body's first column here; −1 outside of a call.
  const auto bodies = static_cast<std::size_t>(inverse_mass_.size() / n);
  if (place.size() < 2 * bodies) place.assign(2 * bodies, -1);
  int* const met = place.data() + bodies;  // the bodies met, ascending
  std::size_t count = 0;
  for (const int column : W.column)
    if (int& at = place[static_cast<std::size_t>(column / n)]; at < 0) at = 0, met[count++] = column / n;
  std::sort(met, met + count);
  for (std::size_t k = 0; k < count; ++k) place[static_cast<std::size_t>(met[k])] = n * static_cast<int>(k);
  for (int& column : W.column) column = place[static_cast<std::size_t>(column / n)] + column % n;
  W.cols = n * static_cast<Index>(count);
  A.inverse_mass.resize(W.cols);
  for (std::size_t k = 0; k < count; ++k) {
    A.inverse_mass.template segment<n>(n * static_cast<Index>(k)) = inverse_mass_.template segment<n>(n * met[k]);
    place[static_cast<std::size_t>(met[k])] = -1;
  }
}

template <class Space>
StepMatrixOf<Space>::StepMatrixOf(const SystemOf<Space>& system, bool diagonal, Index most, Matrix& A)
    : dense_(!diagonal || most <= static_cast<Index>(kFormedRows)), inverse_mass_(system.inverse_mass()) {
  if (!dense_) {
    prepare(A);
  } else if (most <= static_cast<Index>(kFormedRows)) {
    as<DenseMatrix>(A).resize(most, most);
    columns_.resize(system.dof(), most);
  }
}

template <class Space> void StepMatrixOf<Space>::prepare(Matrix& A) const {
  auto& made = A.emplace<Delassus>();
  if (inverse_mass_.size() <= kKeptRows) made.inverse_mass = inverse_mass_;
}

template <class Space> void StepMatrixOf<Space>::respond(const BasicSystem& basic, const RowList<Row>& rows) {
  if (!dense_) {
    inverse_mass_ = basic.inverse_mass();
    return;
  }
  const auto n = static_cast<Index>(rows.size());
  columns_.resize(inverse_mass_.size(), n);
  for (Index j = 0; j < n; ++j) basic.solve_row(rows[static_cast<std::size_t>(j)], columns_.col(j).data());
}

/// B is symmetric; one half is computed, so that A is so to the last bit.
template <class Space> double StepMatrixOf<Space>::entry(const RowList<Row>& rows, Index i, Index j) const {
  const Row& later = rows[static_cast<std::size_t>(std::max(i, j))];
  if (dense_) return apply(later, columns_.col(std::min(i, j)).data());
  return coupling(later, rows[static_cast<std::size_t>(std::min(i, j))], inverse_mass_);
}

template <class Space> void StepMatrixOf<Space>::fill(const RowList<Row>& rows, Matrix& A) const {
  if (auto* delassus = std::get_if<Delassus>(&A)) {
    fill_delassus(rows, inverse_mass_, *delassus);
    return;
  }
  auto& formed = as<DenseMatrix>(A);
  const auto n = static_cast<Index>(rows.size());
  formed.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i)
      formed(i, j) = formed(j, i) = apply(rows[static_cast<std::size_t>(i)], columns_.col(j).data());
}

template <class Space> void StepMatrixOf<Space>::cut(const RowList<Row>& rows, std::span<const int> numbers,
                                                     std::vector<int>& scratch, Matrix& A) const {
  if (auto* delassus = std::get_if<Delassus>(&A)) {
    cut_operator(rows, numbers, scratch, *delassus);
    return;
  }
  auto& formed = as<DenseMatrix>(A);
  const auto n = static_cast<Index>(numbers.size());
  formed.resize(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i)
      formed(i, j) = formed(j, i) =
          entry(rows, numbers[static_cast<std::size_t>(i)], numbers[static_cast<std::size_t>(j)]);
}

template <class Space>
void StepMatrixOf<Space>::add_response(const RowList<Row>& rows, const Vector& z, Eigen::VectorXd& v) const {
  if (dense_) {
    v.noalias() += columns_ * z;
  } else {
    for (std::size_t i = 0; i < rows.size(); ++i) apply_impulse(rows[i], z[static_cast<Index>(i)], inverse_mass_, v);
  }
}

template class StepMatrixOf<Planar>;
template class StepMatrixOf<Spatial>;

}  // namespace orthant
