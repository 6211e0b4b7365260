// integrators/step/spatial_immobility.h — contact rows in space that joints immobilise: no impulse can move them.
//
//   Of a row J, with B the inverse of the mass matrix under the joints' rows, J is immobile when
//     J B Jᵀ ≤ 1e-12 J M⁻¹ Jᵀ:
//   joints leave no more than rounding of the effective inverse mass that it has without joints. The bound admits
//   normals that are given to six digits and more.
//   The rate of an immobile row is the one that the joints' drives give it, J v for the v with G v = ṡ; 0 without
//   drives, and where it is no more than 1e-9 of its bodies' speeds plus rounding of the fastest body's speed.
// Cost: one factorization of the basic system per pose, one solve per row.
// Source: Golub & Van Loan, Matrix Computations (2013), 5.5 (numerical rank).
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>

#include <optional>

namespace orthant {

/// effective: J B Jᵀ.
bool immobile(const RowOf<Spatial>& row, double effective, const Eigen::VectorXd& inverse_mass);

class SpatialImmobility {
 public:
  explicit SpatialImmobility(const SystemOf<Spatial>& system);

  /// From now on rows are those at q, which satisfies the joints at time t. False: no joints, or no usable matrix; then
  /// nothing is immobile.
  bool stand(double t, const Eigen::VectorXd& q);
  /// Of the contact's normal.
  bool immobile(int contact);
  /// [m/s] of the last contact's normal; 0: no more than rounding.
  double rate();
  /// [m] of the last contact.
  double gap() const;

  /// A combination of rows at the places of `terms`. False: no joints, or no usable matrix.
  bool begin(const TermsOf<Spatial>& terms);
  void add(const RowOf<Spatial>& row, double weight);
  /// [m/s] The rate that the joints give the combination, if it is immobile; 0: no more than rounding, or no drives.
  std::optional<double> rate_of_immobile(const TermsOf<Spatial>& terms);
  /// Whether the combination is immobile, and the joints' drives press it shut.
  bool driven_shut(const TermsOf<Spatial>& terms) { return rate_of_immobile(terms).value_or(0) < 0; }

 private:
  double rate_of_sum(const Eigen::VectorXd& joint_rate);

  const SystemOf<Spatial>& system_;
  TermsOf<Spatial> terms_;
  BasicSystemOf<Spatial> basic_;
  bool usable_ = false;
  Eigen::VectorXd change_, sum_, sizes_;  // dof
  Eigen::VectorXd load_;
  double free_ = 0;  // Σ of the rows' effective inverse masses without joints
};

}  // namespace orthant
