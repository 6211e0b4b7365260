// core/mechanics/terms.h — evaluate: the quantities of the equations of motion at one (t, q, v), in reused storage.
//
//   M v̇ = f(t, q, v) + Gᵀ λ + W_Nᵀ λ_N + W_Tᵀ λ_T,   Φ(q) = 0,  g_N(q) ≥ 0
// M is constant and diagonal here (planar bodies at their centres of mass): System::mass().
// Only what is asked for is evaluated, and only rows of contacts that are closed are built.
#pragma once

#include <orthant/core/mechanics/system.h>
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
  Eigen::VectorXd joint_bias;        // joint_rows: Ġ v
  Eigen::VectorXd gap;               // contacts [m]
  std::vector<ClosedContact> closed;
  std::vector<ContactBias> contact_bias;  // one per closed contact

  Terms() = default;
  explicit Terms(const System& system);  // sized, so that evaluation allocates nothing
};

void set_poses(const System& system, const Eigen::VectorXd& q, Kinematics& at);
void set_twists(const System& system, const Eigen::VectorXd& v, Kinematics& at);

/// Each reads terms.at; what needs velocities reads twists too. All in the order of the scene.
void evaluate_forces(const System& system, double t, const Eigen::VectorXd& v, Terms& terms);
void evaluate_joint_residual(const System& system, Terms& terms);
void evaluate_joint_rows(const System& system, Terms& terms);
void evaluate_gaps(const System& system, Terms& terms);
/// The contacts with gap ≤ threshold become `closed`, with their rows; evaluate_gaps comes first.
void evaluate_closed(const System& system, double threshold, Terms& terms);
/// One more closed contact, whatever its gap.
void add_closed(const System& system, int contact, Terms& terms);
/// These contacts become `closed`, whatever their gaps.
void evaluate_closed(const System& system, std::span<const int> contacts, Terms& terms);
/// Ġ v and the biases of the closed contacts.
void evaluate_biases(const System& system, Terms& terms);

}  // namespace orthant
