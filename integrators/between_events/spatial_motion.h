// integrators/between_events/spatial_motion.h — equations of motion in space while no contact changes its mode.
//
//   M a = f − ω × Jω + Gᵀ λ + W_Nᵀ λ_N + W_Tᵀ λ_T,   G a = −Ġ v,   of each lasting contact W_N a = −Ẇ_N v, and
//     sticking:  W_T a = −Ẇ_T v (two rows)      sliding:  λ_T = −μ λ_N γ_T / |γ_T|      (μ = 0: neither)
//   The direction of slip turns with γ_T: at the rate μ λ_N / |γ_T| it returns to where γ̇_T is along it, so that slow
//   slip is stiff. A contact that has just begun to slide departs: its direction is the one along which γ̇_T is, by
//   fixed-point iterations. The error is |γ_T| times the turn since the departure, or a part of it.
//   Ẇ v is the derivative of W v along q exp(s v), by differences of fourth order over a turn of 1e-3 rad of what turns
//   fastest, the bodies, the normal or a surface: to about 1e-13 of |v| times the rate of turning. It is taken of the
//   velocity in the world, since the tangents of a contact may turn about its normal (those of orthotropic friction are
//   fixed in a body: row by row).
//   project(): q and v back onto joints, lasting contacts (g = 0, W_N v = 0) and sticking ones (γ_T = 0), in the metric
//   of M.
//   Contacts that overlap at the start of a motion have the gap g − g_0 until they are open (rest()).
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996), ch. 5; Brogliato & Acary (2008),
//   ch. 5.
#pragma once

#include <orthant/integrators/between_events/contact_equations.h>
#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/step/projection.h>

#include <span>

namespace orthant {

inline constexpr double kLeastShare = 1e-13;  // of a load, of the largest: none so small that it counts as dependent

struct SpatialMode {
  bool lasting = false, sticks = false, slides = false;  // neither of the two: without friction
  bool departs = false;                                  // slides, along its acceleration
  Vector3d departure{0, 0, 0};                           // unit, in the world: of slip at first
  double share_normal = 1, share_tangent = 1;            // see ContactEquationsOf::solve
  void remember(CheckpointData& memory) {
    memory(lasting, sticks, slides, departs, departure[0], departure[1], departure[2], share_normal, share_tangent);
  }
  bool operator==(const SpatialMode& other) const {
    return lasting == other.lasting && sticks == other.sticks && slides == other.slides;
  }
};

/// What an event shows in: one entry per contact. Of contacts that do not last the forces are 0.
struct SpatialWatched {
  Eigen::VectorXd gap, gap_rate;          // [m, m/s]
  Eigen::VectorXd gap_scale, rate_scale;  // Σ |J_k| |q_k|, Σ |J_k| |v_k|: what they are rounded from
  Eigen::VectorXd normal, tangent;        // [N] λ_N, |λ_T|
  Eigen::VectorXd slip, slip_change;      // [m/s, m/s²] |γ_T| and its derivative; the latter of lasting contacts
  std::vector<Vector3d> along;            // unit, in the world: slip of contacts that slide
  explicit SpatialWatched(Index contacts);
};

class SpatialMotion {
 public:
  using System = SystemOf<Spatial>;
  using Rows = ContactRowsOf<Spatial>;
  using Terms = TermsOf<Spatial>;

  struct Bias {
    double normal = 0;
    Tangents tangent{};
  };
  struct Residual {
    double joint = 0, rate = 0;  // [m, rad]; [m/s, rad/s]
    double off = kInf;           // of joints_off()
  };

  explicit SpatialMotion(const System& system);

  std::vector<SpatialMode> modes;  // one per contact; call modes_changed() after writing
  void modes_changed();
  void open_all();
  std::span<const int> lasting() const { return lasting_; }

  /// dof. False: not finite, no usable matrix.
  bool accelerations(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a);
  /// Of the last accelerations(), in the order of lasting() [N].
  double normal_force(std::size_t i) const { return normal_[i]; }
  Tangents tangent_force(std::size_t i) const { return tangent_[i]; }
  /// Of drives, loads and moving surfaces, there [W].
  double power(double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a);
  /// The lasting contacts' rows depend on each other: their forces are not unique.
  bool redundant() const { return !lasting_.empty() && equations_.dependent; }
  /// Likewise, and the accelerations depend on which are taken: on slip that a yaw turns from contact to contact.
  bool undetermined() const { return redundant() && equations_.leaves_open(system_.mass()); }
  /// All but the gaps' scales: where accelerations() was evaluated last.
  void watch(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a, SpatialWatched& w);

  /// Gaps and their rates alone, of all contacts, at poses that it sets.
  void watch_gaps(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& gap,
                  Eigen::VectorXd& rate);

  /// [rad/s] by which the rows of a contact turn, at most; at the poses set last.
  double pace(int contact, const Eigen::VectorXd& v) const;
  Bias bias(int contact, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  /// Infinite residual: no usable matrix.
  Residual project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v);

  /// The gaps at which contacts rest: those of the start where bodies overlap; 0.
  void rest(double t, const Eigen::VectorXd& q, double touching);
  const Eigen::VectorXd& resting_gaps() const { return rest_; }
  void rest_at(const Eigen::VectorXd& gaps) { rest_ = gaps; }
  /// Contacts that have opened rest at 0 from now on; w.gap is theirs then.
  void forget_overlaps(SpatialWatched& w);

  /// μ λ_N (W_T M⁻¹ W_Tᵀ) of lasting contact i [m/s²], where accelerations() was evaluated last: |γ_T| over it is the
  /// time in which its direction of slip returns.
  double grip(std::size_t i) const;

  /// What rounding makes of the slip γ_T [m/s].
  double slip_rounding(const Eigen::VectorXd& v) const { return 1e-12 * v.lpNorm<Eigen::Infinity>() + 1e-16; }

  void remember(CheckpointData& memory);

  const System& system() const { return system_; }
  Terms& terms() { return terms_; }
  const BasicSystemOf<Spatial>& basic() const { return basic_; }  // as factorized last
  const Eigen::VectorXd& free() const { return free_; }           // accelerations without contacts, evaluated last

 private:
  void place(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double s);
  bool impose(const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a);
  void solve_contacts(Eigen::VectorXd& a);
  double turn_departures(const Eigen::VectorXd& a);
  Tangents direction(std::size_t i, const Eigen::VectorXd& v) const;

  const System& system_;
  Terms terms_;
  BasicSystemOf<Spatial> basic_;
  ProjectionOf<Spatial> projection_;
  ContactEquationsOf<Spatial> equations_;
  KinematicsOf<Spatial> beside_;  // of bias()
  std::vector<int> lasting_;
  std::vector<double> normal_;
  std::vector<Tangents> tangent_, slip_direction_;
  std::vector<Bias> bias_;
  Vector share_;
  Eigen::VectorXd rest_;  // [m]
  Eigen::VectorXd free_, rate_, lambda_, zero_, step_;
};

/// The world's direction of a row of contact_rows().
inline Vector3d direction_of(const RowOf<Spatial>& row) {
  return row.a >= 0 ? Vector3d(row.ja[0], row.ja[1], row.ja[2]) : Vector3d(-row.jb[0], -row.jb[1], -row.jb[2]);
}
/// Of a tangent row likewise, a unit vector: rows of orthotropic friction are scaled.
inline Vector3d axis_of(const RowOf<Spatial>& row) {
  constexpr double kUnit = 1e-9;
  const Vector3d d = direction_of(row);
  const double square = d.squaredNorm();
  return std::abs(square - 1) < kUnit ? d : Vector3d(d / std::sqrt(square));
}
/// Slip and forces in the rows of a contact as vectors along its two tangents in the world, and back.
inline Vector3d in_world(const ContactRowsOf<Spatial>& rows, const Tangents& x) {
  return x.first * axis_of(rows.tangents[0]) + x.second * axis_of(rows.tangents[1]);
}
inline Tangents along_tangents(const ContactRowsOf<Spatial>& rows, const Vector3d& x) {
  return {axis_of(rows.tangents[0]).dot(x), axis_of(rows.tangents[1]).dot(x)};
}
/// γ_T: against b's surface, which may move.
inline Tangents slip_of(const ContactRowsOf<Spatial>& rows, const Eigen::VectorXd& v) {
  return slip_rate(rows, v.data()) - rows.belt;
}
/// The coefficient of a contact that sticks.
inline double static_friction(const ContactLaw& law) { return std::max(law.mu, law.mu_static); }

}  // namespace orthant
