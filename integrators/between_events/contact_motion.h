// integrators/between_events/contact_motion.h — equations of motion while no contact changes its mode.
//
//   M a = f + Gᵀ λ + W_Nᵀ λ_N + W_Tᵀ λ_T,   G a = −Ġ v,   of each lasting contact W_N a = −Ẇ_N v, and
//     sticking:  W_T a = −Ẇ_T v         sliding in the sense σ = ±1:  λ_T = −σ μ λ_N         (μ = 0: neither)
//   The joints are eliminated through the basic system (contact_equations.h); redundant contacts share their forces in
//   the proportion that the decision about the modes found, or differ the least from forces that it found in the cones
//   of friction (contacts that hold each other: a wedge, a drawer that jams).
//   project(): q and v back onto joints, lasting contacts (g = 0, W_N v = 0) and sticking ones (γ_T = 0), each in the
//   metric of M; contacts by one Newton step, which is enough for the errors of a step of high order, or by several
//   where they overlap more.
//   Source: Brogliato & Acary (2008), ch. 5; Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996),
//   ch. 5.
#pragma once

#include <orthant/integrators/between_events/contact_equations.h>
#include <orthant/integrators/step/projection.h>

#include <orthant/integrators/checkpoint.h>

#include <span>

namespace orthant {

inline constexpr double kSame = 1e-12;  // what counts as zero, relative to the terms it is summed of

struct ContactMode {
  bool lasting = false, sticks = false;
  double slip = 0;                             // σ of a contact that slides
  double share_normal = 1, share_tangent = 1;  // see ContactEquations::solve
  bool known = false;                          // likewise, with these forces
  double known_normal = 0, known_tangent = 0;  // [N]
  bool operator==(const ContactMode& other) const {
    return lasting == other.lasting && sticks == other.sticks && slip == other.slip;
  }
};

/// Everything that an event shows in: one entry per contact. Rates and accelerations of gap and slip; forces [N].
struct Watched {
  Eigen::VectorXd gap, gap_rate, gap_acceleration, slip, slip_acceleration, normal, tangent;
  Eigen::VectorXd gap_scale, gap_rate_scale, slip_scale;  // Σ |J_k| |q_k|, Σ |J_k| |v_k|: what they are rounded from
  explicit Watched(Index contacts);
  void remember(CheckpointData& memory) {
    memory(gap, gap_rate, gap_acceleration, slip, slip_acceleration, normal, tangent);
    memory(gap_scale, gap_rate_scale, slip_scale);
  }
};

class ContactMotion {
 public:
  explicit ContactMotion(const System& system);

  std::vector<ContactMode> modes;  // one per contact; call modes_changed() after writing
  void modes_changed();
  void remember(CheckpointData& memory);
  std::span<const int> lasting() const { return lasting_; }

  /// dof. False: not finite, no usable matrix.
  bool accelerations(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a);
  /// Forces of the last accelerations() [N], in the order of lasting().
  double normal_force(std::size_t i) const { return normal_[i]; }
  double tangent_force(std::size_t i) const { return tangent_[i]; }
  /// [W] of drives, loads and moving surfaces there: Σ λ_i ṡ_i + F · Ṗ + λ_T belt; v and the a found.
  double power(double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a);
  /// [W] Largest change of it by velocity errors of the size v_off, from the forces of joints and contacts.
  double power_of(const Eigen::VectorXd& v_off, const Eigen::VectorXd& a) const;
  /// Forces and slips of the lasting contacts there, the rest as it is; dof: v and the a found.
  void watch_lasting(const Eigen::VectorXd& v, const Eigen::VectorXd& a, Watched& w) const;
  /// Gaps, rates and accelerations of all contacts where accelerations() was evaluated last.
  void watch(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a, Watched& w);

  /// x + B Fᵀ z, such that J x + missing = 0 for the rows J of the modes. terms.closed: the lasting contacts; missing:
  /// one each; basic: factorized. z: read by normal_force() and tangent_force().
  void impose(const Terms& terms, const BasicSystem& basic, std::span<const ContactBias> missing, Eigen::VectorXd& x);
  /// The lasting contacts' rows, in the last accelerations(), depend on each other: their forces are not unique.
  bool redundant() const { return equations_.dependent; }
  /// Known forces are used for them.
  bool knows_forces() const { return knows_; }
  /// Such forces are shared in the proportions of the normal forces of w from now on.
  void share_anew(const Watched& w);

  struct Residual {
    double joint = 0, rate = 0;
    double off = kInf;  // of joints_off()
    bool changed =
        false;  // of project(): a lasting contact has changed places; velocities and contacts are as they were
  };
  Residual residual(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);  // of the joints
  /// Infinite residual: no usable matrix.
  Residual project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v);
  /// [m/s] γ_N of lasting contact i, by the order of lasting(), that the last project() took out of v: no more than a
  /// scheme's error, unless the contact's normal has jumped, at an edge where a polygon's corner or face comes to its
  /// end.
  double rate_taken(std::size_t i) const { return taken_[i]; }

  /// A lasting contact of polygons whose gap is suddenly that large stands for another corner, or lies next to the
  /// faces.
  bool changed_places(int contact, double gap) const;

  const System& system() const { return system_; }
  const BasicSystem& basic() const { return basic_; }    // as factorized last
  const Eigen::VectorXd& free() const { return free_; }  // accelerations without contact forces, last evaluated
  const Terms& terms() const { return terms_; }
  Terms& terms() { return terms_; }

 private:
  double largest_gap() const;  // [m] of the lasting contacts

  const System& system_;
  Terms terms_;
  BasicSystem basic_;
  Projection projection_;
  ContactEquations equations_;
  std::vector<int> lasting_;
  std::vector<double> normal_, tangent_, taken_;
  Magnitudes far_, fast_;  // [m], [m/s] of translations
  Vector share_, known_;
  bool knows_ = false;
  Eigen::VectorXd free_, zero_, rate_, lambda_, load_;
};

double slip_rate(const ContactLaw& law, const ContactRows& rows, const Eigen::VectorXd& v);  // γ_T [m/s]
double static_mu(const ContactLaw& law);                                                     // of a contact that sticks

}  // namespace orthant
