// integrators/derivatives/projection_linearization.h — linearized projection of a step onto the joints.
//
//   q⁺ = q* + M⁻¹ G*ᵀ λ with Φ(q⁺) = 0,   v⁺ = v' + M⁻¹ G*ᵀ ν with G⁺ v⁺ = ṡ                                     (3)
//   S = G⁺ M⁻¹ G*ᵀ;  u = q̇* + (M⁻¹ G*ᵀ λ)˙,  q̇⁺ = u + M⁻¹ G*ᵀ S⁻¹ (−Φ̇_p − G⁺ u);  likewise v̇⁺ with (G⁺ v⁺ − ṡ)˙
//   adjoint of q⁺, x̄:  κ = S⁻ᵀ G* M⁻¹ x̄;  that of u is x̄ − G⁺ᵀ κ, that of Φ_p is −κ; then back through q*
// S is dense and inverted, up to 48 joint rows; beyond, or where joints are redundant, S⁻¹ is the fixed point of the
// factorization of G* M⁻¹ G*ᵀ (basic_system.h), from which S differs by O(h).
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/derivatives/force_slopes.h>

namespace orthant {

/// A parameter's part in the equations of a step or of the start, and in those of the projection behind it.
struct StepPart {
  SparsePart step, projection;
};
/// Σ part · adjoint.
inline double inner(const SparsePart& part, const Eigen::VectorXd& by) {
  double sum = 0;
  for (const auto& [place, value] : part) sum += value * by[place];
  return sum;
}
inline double inner(const StepPart& part, const Eigen::VectorXd& by_step, const Eigen::VectorXd& by_projection) {
  return inner(part.step, by_step) + inner(part.projection, by_projection);
}
/// One a parameter, and which of its two lists.
using PartsOf = std::pair<const std::vector<StepPart>*, SparsePart StepPart::*>;
/// dof × parameters.
using DirectionBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class ProjectionLinearization {
 public:
  explicit ProjectionLinearization(const System& system);

  /// At the end of a step: λ, ν and all slopes. Returns what q⁺ and v⁺ miss of (3), relative to 1 + their size.
  double set_up(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before, const State& after);

  /// The part of a parameter: places count M⁻¹ G*ᵀ λ, M⁻¹ G*ᵀ ν, Φ and G⁺ v⁺ − ṡ one behind the other.
  void part_of(const ParameterChange& parameter, SparsePart& part);

  /// (q̇*, v̇') become (q̇⁺, v̇⁺).
  void push(const PartsOf& parameters, DirectionBlock& q, DirectionBlock& v);
  /// (q̄⁺, v̄⁺) become (q̄*, v̄'); `by`: adjoints of the four parts.
  void pull(double* q, double* v, Eigen::VectorXd& by);

 private:
  void fill_rows();
  void form();                                                          // S_
  bool factorize();                                                     // S_, in place; false: singular
  void correct(const double* off, double* lambda, Eigen::Index count);  // S⁻¹, of blocks
  void correct_transposed(const double* off, double* lambda);           // S⁻ᵀ
  void close(Eigen::Index count, double* off, double* x);               // x −= M⁻¹ G*ᵀ S⁻¹ (off + G⁺ x)
  /// λ with G_rate M⁻¹ G_pushᵀ λ = off, by corrections that basic_ finds at q*.
  void iterate(const Terms& push, const Terms& rate, const double* off, double* lambda);
  void rates(const std::vector<Row>& rows, const double* x, double* to) const;
  void impulses(const std::vector<Row>& rows, const double* lambda, double* to) const;  // +=

  const System& system_;
  Terms before_, after_;  // at q* and q⁺
  BasicSystem basic_;     // at q*, where `dense_` is not
  Eigen::VectorXd after_v_, moved_, turned_, lambda_, nu_;
  std::vector<RowSlope> slopes_;
  std::vector<Slope> rates_, pushes_;                 // G⁺; −M⁻¹ G*ᵀ
  std::vector<Slope> q_push_slopes_, v_push_slopes_;  // of M⁻¹ G*ᵀ λ and of M⁻¹ G*ᵀ ν by q*
  std::vector<Slope> rate_slopes_;                    // of G⁺ v⁺ by q⁺
  struct Coupled {  // rows of G⁺ and G*, by one body: their entries on it, its M⁻¹, the entry of S
    const double *rate, *push, *inverse_mass;
    double* S;
  };
  std::vector<Coupled> coupled_;
  bool dense_ = true;
  DirectionBlock S_;                                  // L with unit diagonal, and U, the diagonal inverted
  std::vector<Eigen::Index> row_;                     // of S in row i of S_
  DirectionBlock pushed_, off_block_, lambda_block_;  // blocks of directions
  Eigen::VectorXd force_, off_, x_, left_, none_, unused_, unused_joints_;
};

}  // namespace orthant
