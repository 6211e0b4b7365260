// core/mechanics/dynamics/terms.h — quantities of the equations of motion at one (t, q, v), in reused storage.
//
//   M v̇ = f(t, q, v) + Gᵀ λ + W_Nᵀ λ_N + W_Tᵀ λ_T,   Φ(q, t) = 0,  g_N(q) ≥ 0
//   Φ̇ = G v − ṡ,   Φ̈ = G v̇ + (Ġ v − s̈);   ṡ, s̈ are zero except for driven joints (drive.h).
// M is constant and diagonal here (planar bodies at their centres of mass): System::mass().
// Only the requested terms are evaluated. Rows are built for closed contacts only.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/reusable.h>

#include <span>

namespace orthant {

template <class Space> struct ClosedContactOf {
  int contact = 0;  // index in the scene
  ContactRowsOf<Space> rows;
};
using ClosedContact = ClosedContactOf<Planar>;

/// Of what a row's rate measures: `unit` [m], or 1 rad where it moves no point.
template <class Space> double unit_of(const RowOf<Space>& row, double unit) {
  for (std::size_t k = 0; k < Space::kTranslations; ++k)
    if (row.ja[k] != 0 || row.jb[k] != 0) return unit;
  return 1;
}

template <class Space> struct TermsOf {
  using ContactBias = typename ElementsOf<Space>::ContactBias;
  KinematicsOf<Space> at;
  Eigen::VectorXd f;                          // dof: weight, loads, springs
  std::vector<SpringStateOf<Space>> springs;  // one per spring of the scene
  std::vector<RowOf<Space>> G;                // joint_rows
  Eigen::VectorXd phi;                        // joint_rows: joint residual [m, rad]
  Eigen::VectorXd joint_rate;                 // joint_rows: ṡ, what G v has to be
  Eigen::VectorXd joint_bias;                 // joint_rows: Ġ v − s̈
  std::vector<Pair> pairs;                    // behind the listed contacts; set by BroadPhase::find()
  Eigen::VectorXd gap;                        // contacts [m]; infinity where there is no pair
  std::vector<ClosedContactOf<Space>> closed;
  std::vector<ContactBias> contact_bias;  // one per closed contact

  double unit = 1;  // [m] System's length_unit()

  TermsOf() = default;
  explicit TermsOf(const SystemOf<Space>& system);  // sized, so that evaluation allocates nothing

  /// ṡ − G v of joint row i: the defect of the joint's velocity.
  double missing_rate(Eigen::Index i, const Eigen::VectorXd& v) const {
    return joint_rate[i] - apply(G[static_cast<std::size_t>(i)], v.data());
  }
  /// Of what joint row i measures: unit, or 1 rad.
  double unit_of_row(Eigen::Index i) const { return unit == 1 ? 1 : unit_of(G[static_cast<std::size_t>(i)], unit); }
};
extern template struct TermsOf<Planar>;
extern template struct TermsOf<Spatial>;
using Terms = TermsOf<Planar>;

/// Planar: cosine and sine are turned on from the nearest of a fixed grid of angles, whose own `at` keeps: to one
/// rounding more, in a quarter of the time, and a function of the angle alone.
void set_poses(const SystemOf<Planar>& system, double t, const Eigen::VectorXd& q, KinematicsOf<Planar>& at);
void set_poses(const SystemOf<Spatial>& system, double t, const Eigen::VectorXd& q, KinematicsOf<Spatial>& at);
template <class Space>
void set_twists(const SystemOf<Space>& system, const Eigen::VectorXd& v, KinematicsOf<Space>& at);

/// Each reads terms.at; functions of velocities read twists too. All in the order of the scene.
/// Weight, loads and springs; in space without −ω × Jω, see add_gyroscopic().
template <class Space>
void evaluate_forces(const SystemOf<Space>& system, double t, const Eigen::VectorXd& v, TermsOf<Space>& terms);
template <class Space> void evaluate_joint_residual(const SystemOf<Space>& system, TermsOf<Space>& terms);
/// G and joint_rate.
template <class Space> void evaluate_joint_rows(const SystemOf<Space>& system, TermsOf<Space>& terms);
/// Both.
template <class Space> void evaluate_joints(const SystemOf<Space>& system, TermsOf<Space>& terms);
template <class Space> void evaluate_gaps(const SystemOf<Space>& system, TermsOf<Space>& terms);
/// The gap of one contact, listed or one of these pairs, in poses `at` of its two bodies.
template <class Space> double gap_of(const SystemOf<Space>& system, const std::vector<Pair>& pairs, int contact,
                                     const KinematicsOf<Space>& at);
/// The bodies of a contact, listed or one of these pairs.
template <class Space>
std::pair<BodyId, BodyId> bodies_of(const SystemOf<Space>& system, const std::vector<Pair>& pairs, int contact);
/// The contacts with gap ≤ threshold become `closed`, with their rows; evaluate_gaps comes first.
template <class Space> void evaluate_closed(const SystemOf<Space>& system, double threshold, TermsOf<Space>& terms);
/// One more closed contact, whatever its gap.
template <class Space> void add_closed(const SystemOf<Space>& system, int contact, TermsOf<Space>& terms);
/// The same, of a contact as it is at `there.at`, the same pairs, with its rows at terms.at. Polytopes may have other
/// points there, or none: then the rows are those of the point that was nearest in both bodies, or those at `there`.
void add_closed_as(const SystemOf<Planar>& system, int contact, const TermsOf<Planar>& there, TermsOf<Planar>& terms);
void add_closed_as(const SystemOf<Spatial>& system, int contact, const TermsOf<Spatial>& there,
                   TermsOf<Spatial>& terms);
/// These contacts become `closed`, whatever their gaps.
template <class Space>
void evaluate_closed(const SystemOf<Space>& system, std::span<const int> contacts, TermsOf<Space>& terms);
/// The biases of the joints and of the closed contacts (planar; in space of the joints).
template <class Space> void evaluate_biases(const SystemOf<Space>& system, TermsOf<Space>& terms);

/// f −= ω × Jω in the body's axes, in space; in the plane nothing.
inline void add_gyroscopic(const SystemOf<Planar>& /*system*/, const Eigen::VectorXd& /*v*/, Eigen::VectorXd& /*f*/) {}
void add_gyroscopic(const SystemOf<Spatial>& system, const Eigen::VectorXd& v, Eigen::VectorXd& f);

}  // namespace orthant
