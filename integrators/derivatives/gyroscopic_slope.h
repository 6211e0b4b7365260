// integrators/derivatives/gyroscopic_slope.h — slopes of a body's turn in a step of gyroscopic.h, in closed form.
//
//   ξ = a h ω, η = h ω_m; F = R exp ξ, R⁺ = R exp η; w⁻ = ω and w in the axes of F, ω⁺ = exp(−η) exp(ξ) w in those
//   of R⁺. Turns change as R → R exp δφ; exp(φ + δφ) = exp φ exp(J_φ δφ), J the right Jacobian of the exponential:
//     δφ_F = exp(−ξ) δφ + a h J_ξ δω,   δφ⁺ = exp(−η) δφ + h J_η δω_m                                           (1)
//     (1 − θ h [ω⁺]× J_η) δω⁺ = exp(−η) exp(ξ) (δw − a h [w]× J_ξ δω) + (1−θ) h [ω⁺]× J_η δω                    (2)
//   g of gyroscopic.h (1), C = exp(−ξ) exp(η), m = C Jω⁺, y = exp(−ξ) Jω:
//     δg = J δw − C (J δω⁺ − [Jω⁺]× J_η δη) − [m]× J_ξ δξ − J δω + exp(−ξ) J δω + [y]× J_ξ δξ                   (3)
// Source of J: Solà, Deray & Atchuthan, A micro Lie theory for state estimation in robotics (2018), eq. 143.
#pragma once

#include <orthant/integrators/step/gyroscopic.h>

namespace orthant {

/// [x]×: its product with y is x × y.
Eigen::Matrix3d cross_matrix(const Vector3d& x);
/// exp φ and J_φ.
Eigen::Matrix3d turn_of(const Vector3d& phi);
Eigen::Matrix3d right_jacobian(const Vector3d& phi);

class TurnSlope {
 public:
  using Matrix3d = Eigen::Matrix3d;

  /// ω before the step, w in the axes of F, ω⁺ at its end.
  TurnSlope(const StepFrames& frames, const Vector3d& omega, const Vector3d& w, const Vector3d& end);

  // (1): of δφ_F and δφ⁺ by δφ and by δω; of δφ⁺ by δω⁺.
  Matrix3d middle_by_turn, middle_by_omega;
  Matrix3d end_by_turn, end_by_omega, end_by_end;
  // (2): of ω⁺
  Matrix3d omega_by_omega, omega_by_w;

  /// (3): of g of a body with these principal moments. Three equal ones: 0.
  void of_impulse(const Vector3d& moments, Matrix3d& by_omega, Matrix3d& by_w) const;
  /// g of any symmetric tensor in place of J, of which it is a linear function.
  Vector3d impulse_of(const Matrix3d& tensor) const;

 private:
  double h_, at_, theta_;
  Vector3d omega_, w_, end_;
  Matrix3d C_, back_, at_xi_, at_eta_;  // exp(−ξ) exp(η); exp(−ξ); J_ξ, J_η
};

}  // namespace orthant
