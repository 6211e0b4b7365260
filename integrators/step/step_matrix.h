// integrators/step/step_matrix.h — Delassus matrix of a step's problem: A = J B Jᵀ, dense or as an operator.
//
// J are the problem's rows, B is the response of the basic system (basic_system.h). A is an operator, W = J, where B is
// diagonal and a scene has many contacts. Else B Jᵀ is kept, and the entries of A are formed where they are read.
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/step/row_list.h>

#include <span>
#include <vector>

namespace orthant {

template <class Space> class StepMatrixOf {
 public:
  using Row = RowOf<Space>;
  using BasicSystem = BasicSystemOf<Space>;

  static constexpr std::size_t kFormedRows = 64;  // up to here a dense A costs less than the operator, applied often

  /// Of at most `most` rows; `diagonal`: B always is. A gets its storage, and the memory of most rows where that is
  /// little.
  StepMatrixOf(const SystemOf<Space>& system, bool diagonal, Index most, Matrix& A);

  void respond(const BasicSystem& basic, const RowList<Row>& rows);  // B Jᵀ
  bool dense() const { return dense_; }
  double entry(const RowList<Row>& rows, Index i, Index j) const;  // A_ij

  /// A becomes an operator, with the memory that it can need where that is little.
  void prepare(Matrix& A) const;
  void fill(const RowList<Row>& rows, Matrix& A) const;
  /// The block of some of the rows, by number, in the storage that A has. An operator has the columns of the bodies in
  /// these rows alone, in their order; `scratch` keeps its places. O(entries of the block).
  void cut(const RowList<Row>& rows, std::span<const int> numbers, std::vector<int>& scratch, Matrix& A) const;

  /// v += B Jᵀ z
  void add_response(const RowList<Row>& rows, const Vector& z, Eigen::VectorXd& v) const;

 private:
  void cut_operator(const RowList<Row>& rows, std::span<const int> numbers, std::vector<int>& place, Delassus& A) const;

  bool dense_;
  DenseMatrix columns_;           // dof × n: B Jᵀ, dense storage only
  Eigen::VectorXd inverse_mass_;  // of the operator
};
extern template class StepMatrixOf<Planar>;
extern template class StepMatrixOf<Spatial>;

}  // namespace orthant
