// core/mechanics/dynamics/terms.h — quantities of the equations of motion at one (t, q, v), in reused storage.
//
//   M v̇ = f(t, q, v) + Gᵀ λ + W_Nᵀ λ_N + W_Tᵀ λ_T,   Φ(q, t) = 0,  g_N(q) ≥ 0
//   Φ̇ = G v − ṡ,   Φ̈ = G v̇ + (Ġ v − s̈);   ṡ, s̈ are zero except for driven joints (drive.h).
// M is constant and diagonal here (planar bodies at their centres of mass): System::mass().
// Only what is asked for is evaluated, and only rows of contacts that are closed are built.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/reusable.h>

#include <span>

namespace orthant {

struct ClosedContact {
  int contact = 0;  // index in the scene
  ContactRows rows;
};

struct Terms {
  Kinematics at;
  Eigen::VectorXd f;                 // dof: weight, loads, springs
  std::vector<SpringState> springs;  // one per spring of the scene
  std::vector<Row> G;                // joint_rows
  Eigen::VectorXd phi;               // joint_rows: joint residual [m, rad]
  Eigen::VectorXd joint_rate;        // joint_rows: ṡ, what G v has to be
  Eigen::VectorXd joint_bias;        // joint_rows: Ġ v − s̈
  std::vector<Pair> pairs;           // behind the listed contacts; set by BroadPhase::find()
  Eigen::VectorXd gap;               // contacts [m]; infinity where there is no pair
  std::vector<ClosedContact> closed;
  std::vector<ContactBias> contact_bias;  // one per closed contact

  Terms() = default;
  explicit Terms(const System& system);  // sized, so that evaluation allocates nothing

  /// ṡ − G v of joint row i: what is missing to the velocity that the joint wants.
  double missing_rate(Eigen::Index i, const Eigen::VectorXd& v) const {
    return joint_rate[i] - apply(G[static_cast<std::size_t>(i)], v.data());
  }
};

/// Cosine and sine are turned on from the nearest of a fixed grid of angles, whose own `at` keeps: to one rounding
/// more, in a quarter of the time, and a function of the angle alone.
void set_poses(const System& system, double t, const Eigen::VectorXd& q, Kinematics& at);
void set_twists(const System& system, const Eigen::VectorXd& v, Kinematics& at);

/// Each reads terms.at; what needs velocities reads twists too. All in the order of the scene.
void evaluate_forces(const System& system, double t, const Eigen::VectorXd& v, Terms& terms);
void evaluate_joint_residual(const System& system, Terms& terms);
/// G and joint_rate.
void evaluate_joint_rows(const System& system, Terms& terms);
/// Both.
void evaluate_joints(const System& system, Terms& terms);
void evaluate_gaps(const System& system, Terms& terms);
/// The gap of one contact, listed or one of these pairs, in poses `at` of its two bodies.
double gap_of(const System& system, const std::vector<Pair>& pairs, int contact, const Kinematics& at);
/// The bodies of a contact, listed or one of these pairs.
std::pair<BodyId, BodyId> bodies_of(const System& system, const std::vector<Pair>& pairs, int contact);
/// The contacts with gap ≤ threshold become `closed`, with their rows; evaluate_gaps comes first.
void evaluate_closed(const System& system, double threshold, Terms& terms);
/// One more closed contact, whatever its gap.
void add_closed(const System& system, int contact, Terms& terms);
/// These contacts become `closed`, whatever their gaps.
void evaluate_closed(const System& system, std::span<const int> contacts, Terms& terms);
/// The biases of the joints and of the closed contacts.
void evaluate_biases(const System& system, Terms& terms);

}  // namespace orthant
