#include <orthant/integrators/step/step_matrix.h>

#include <algorithm>

namespace orthant {
namespace {

/// W from its rows.
template <class Row>
void fill_delassus(const std::vector<Row>& rows, const Eigen::VectorXd& inverse_mass, Delassus& A) {
  A.inverse_mass = inverse_mass;
  RowSparse& W = A.W;
  W.rows = static_cast<Index>(rows.size()), W.cols = inverse_mass.size();
  W.start.assign(1, 0), W.column.clear(), W.value.clear();
  for (const Row& row : rows) {
    append_to(W.column, W.value, row);
    W.start.push_back(static_cast<int>(W.column.size()));
  }
}

}  // namespace

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

template <class Space> void StepMatrixOf<Space>::respond(const BasicSystem& basic, const std::vector<Row>& rows) {
  if (!dense_) {
    inverse_mass_ = basic.inverse_mass();
    return;
  }
  const auto n = static_cast<Index>(rows.size());
  columns_.resize(inverse_mass_.size(), n);
  for (Index j = 0; j < n; ++j) basic.solve_row(rows[static_cast<std::size_t>(j)], columns_.col(j).data());
}

/// B is symmetric; one half is computed, so that A is so to the last bit.
template <class Space> double StepMatrixOf<Space>::entry(const std::vector<Row>& rows, Index i, Index j) const {
  const Row& later = rows[static_cast<std::size_t>(std::max(i, j))];
  if (dense_) return apply(later, columns_.col(std::min(i, j)).data());
  return coupling(later, rows[static_cast<std::size_t>(std::min(i, j))], inverse_mass_);
}

template <class Space> void StepMatrixOf<Space>::fill(const std::vector<Row>& rows, Matrix& A) const {
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

template <class Space> void StepMatrixOf<Space>::cut(const std::vector<Row>& rows, std::span<const int> numbers,
                                                     std::vector<Row>& scratch, Matrix& A) const {
  if (auto* delassus = std::get_if<Delassus>(&A)) {
    scratch.clear();
    for (const int row : numbers) scratch.push_back(rows[static_cast<std::size_t>(row)]);
    fill_delassus(scratch, inverse_mass_, *delassus);
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
void StepMatrixOf<Space>::add_response(const std::vector<Row>& rows, const Vector& z, Eigen::VectorXd& v) const {
  if (dense_) {
    v.noalias() += columns_ * z;
  } else {
    for (std::size_t i = 0; i < rows.size(); ++i) apply_impulse(rows[i], z[static_cast<Index>(i)], inverse_mass_, v);
  }
}

template class StepMatrixOf<Planar>;
template class StepMatrixOf<Spatial>;

}  // namespace orthant
