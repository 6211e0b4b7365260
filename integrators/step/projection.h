// integrators/step/projection.h — projection of coordinates and velocities onto the joints' manifold, metric M.
//
//   position:  min |Δq|_M with Φ(q + Δq) = 0, by simplified Newton: M Δq = Gᵀ λ, G Δq = −Φ, the matrix of the first
//              iterate serving all (the step is a small one), until rounding; a further one where that ends far off.
//   velocity:  min |Δv|_M with G(q)(v + Δv) = ṡ (0 except for driven joints), one solve; with driven joints,
//              whose rates may be far off, as many as needed to reach rounding.
// Source: Hairer & Wanner, Solving Ordinary Differential Equations II (1996), VII.2; Eich, SINUM 30 (1993) 1467-1482.
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/step/magnitudes.h>

namespace orthant {

/// Of 1 m + the largest coordinate: joints left farther than this contradict each other, or the step was much too long.
inline constexpr double kJointsHold = 1e-8;

/// 1 m: below and elsewhere the system's length_unit(), and 1 rad of rows of angles.
/// The largest |Φ_i|, at q with the terms there, over 1 m + the largest coordinate of the bodies that are tied to those
/// of its row, angles counting by their rounding; up to 1e-9 the largest |Φ_i| itself. far: of System::assembly(), for
/// its room.
template <class Space> double joints_off(const TermsOf<Space>& terms, const Eigen::VectorXd& q, Magnitudes& far);

/// The largest |off_i|, of joint rows, over 1 + the largest entry of v of its row's own bodies, or NaN.
template <class Space> double off_by(const TermsOf<Space>& terms, const Eigen::VectorXd& v, const Eigen::VectorXd& off);
/// Likewise over 1 + the largest coordinate.
template <class Space> double off_at(const TermsOf<Space>& terms, const Eigen::VectorXd& q, const Eigen::VectorXd& off);

template <class Space> class ProjectionOf {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;
  using Row = RowOf<Space>;

  explicit ProjectionOf(const System& system, bool with_joints = true);

  /// Moves q at the time t. Afterwards terms.at, phi and G are those at q. Returns max |Φ| left [m, rad], infinity when
  /// the joint matrix is not usable. Without joints: sets the poses, 0.
  /// added: to M, in velocity() too (dof); null: nothing.
  double position(double t, Terms& terms, Eigen::VectorXd& q, const Eigen::VectorXd* added = nullptr);

  /// Moves v at the coordinates that position() ended at, with the terms it left. Returns max |G v − ṡ| left
  /// [m/s, rad/s].
  double velocity(Terms& terms, Eigen::VectorXd& v);

  /// Of the q that position() ended at, with the terms it left.
  double off(const Terms& terms, const Eigen::VectorXd& q) { return joints_off(terms, q, far_); }

  void forget() { basic_.forget(); }  // see there

 private:
  /// With the matrix at hand; worst: max |Φ| at q. Returns it.
  double approach(double t, Terms& terms, Eigen::VectorXd& q, double worst);

  const System& system_;
  BasicSystemOf<Space> basic_;
  Magnitudes far_;
  Eigen::VectorXd trial_, rate_, step_;
};
extern template class ProjectionOf<Planar>;
extern template class ProjectionOf<Spatial>;
using Projection = ProjectionOf<Planar>;

}  // namespace orthant
