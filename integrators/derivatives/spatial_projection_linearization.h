// integrators/derivatives/spatial_projection_linearization.h — linearized projection of a step onto joints in space.
//
//   q⁺ = q* moved by s, s = M⁻¹ G*ᵀ λ with Φ(q⁺) = 0;   v⁺ = v' + M⁻¹ G*ᵀ ν with G⁺ v⁺ = ṡ                       (1)
//   Changes of poses are those of spatial_row_slope.h. With T = exp(−s) and J = J_s on the turns (gyroscopic_slope.h):
//     δ⁺ = T δ* + J δs,  δs = (M⁻¹ G*ᵀ)˙ λ + M⁻¹ G*ᵀ δλ,  G⁺ δ⁺ = −Φ_p;   likewise v, without T and J            (2)
// (The code's projection moves q in several steps. Where |s| is 1e-3 the product of their turns differs from exp s by
// 1e-9.)
#pragma once

#include <orthant/integrators/derivatives/projection_linearization.h>
#include <orthant/integrators/derivatives/spatial_saddle.h>

namespace orthant {

class SpatialProjectionLinearization {
 public:
  using System = SystemOf<Spatial>;
  using Terms = TermsOf<Spatial>;
  using Row = RowOf<Spatial>;
  explicit SpatialProjectionLinearization(const System& system);

  /// As ProjectionLinearization has them; (q̇, v̇) are changes of poses and of velocities, dof each.
  double set_up(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before, const State& after);
  void part_of(const ParameterChangeOf<Spatial>& parameter, SparsePart& part);
  void push(const PartsOf& parameters, DirectionBlock& q, DirectionBlock& v);
  void pull(double* q, double* v, Eigen::VectorXd& by);

 private:
  void set_slopes(const State& after);

  const System& system_;
  Terms before_, after_;  // at q* and q⁺
  IndependentRows independent_;
  SpatialSaddle places_, rates_;
  std::vector<Row> held_;  // G⁺ J
  Eigen::VectorXd after_v_, moved_, turned_, lambda_, nu_;
  std::vector<RowSlopeOf<Spatial>> slopes_;
  // T and J; of G*ᵀ λ and, dof behind, G*ᵀ ν by q*; of G⁺ v⁺ by q⁺
  std::vector<Slope> carry_, turn_, push_slopes_, rate_slopes_;
  Eigen::VectorXd force_, off_, none_;
  DirectionBlock pushed_, moves_, there_;  // blocks of directions
};

}  // namespace orthant
