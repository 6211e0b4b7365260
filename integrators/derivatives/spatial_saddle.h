// integrators/derivatives/spatial_saddle.h — saddle-point system of a linearized step in space, and its adjoint.
//
//   A x − Pᵀ λ = f,   H x = c:   A = M and further entries (springs, dampers, slopes of gyroscopic impulses: none of it
//   symmetric), rows P that push and H that hold
//   adjoint of x̄:  [f̄; c̄] = K⁻ᵀ [x̄; 0]
// Rows that repeat others are left out (independent_rows()): their λ is 0, x is the same.
// K is scaled by √M and by the rows' lengths, and factorized: up to 96 equations as a dense matrix, else by KLU.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/derivatives/row_slope.h>
#include <orthant/solvers/linear_algebra/sparse_lu.h>

#include <Eigen/LU>

#include <vector>

namespace orthant {

/// Numbers of joint rows of which none depends on others, at a pose; all of them where none is redundant.
class IndependentRows {
 public:
  explicit IndependentRows(const SystemOf<Spatial>& system);
  /// terms.G there.
  const std::vector<Eigen::Index>& find(const TermsOf<Spatial>& terms);

 private:
  const SystemOf<Spatial>& system_;
  BasicSystemOf<Spatial> basic_;
  std::vector<Eigen::Index> rows_;
};

class SpatialSaddle {
 public:
  using Row = RowOf<Spatial>;
  explicit SpatialSaddle(const SystemOf<Spatial>& system);

  /// added: to M. push, hold: all joint rows, of which `rows` count. Throws std::runtime_error where K is singular.
  void set_up(const std::vector<Slope>& added, const std::vector<Row>& push, const std::vector<Row>& hold,
              const std::vector<Eigen::Index>& rows);

  /// x and λ (all joint rows) of f and c; c null: 0; lambda null: not wanted.
  void solve(const double* f, const double* c, double* x, double* lambda = nullptr);
  void solve_adjoint(const double* of_x, double* of_f, double* of_c);

 private:
  const SystemOf<Spatial>& system_;
  Eigen::VectorXd root_, push_scale_, hold_scale_;  // √M; 1 / the lengths of the scaled rows
  std::vector<Eigen::Index> rows_;
  bool dense_ = false;
  Eigen::MatrixXd K_;
  Eigen::PartialPivLU<Eigen::MatrixXd> dense_lu_;
  SparseLu lu_;
  Eigen::VectorXd x_;
};

}  // namespace orthant
