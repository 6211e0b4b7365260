// integrators/derivatives/nearby_motion.h — the smooth motion, guards and impacts of a scene with its modes given.
//
//   The same arc, event functions and impact as those of a motion by event-driven, at another state or of a scene with
//   another value of a parameter: what motion_tangent.h differentiates.
#pragma once

#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

#include <vector>

namespace orthant {

/// A contact of an impact, and how it pushes.
struct Struck {
  int contact = 0;
  bool plastic = false;
  int slides = 0;  // ±1: the sense of the friction impulse, which is at its bound; 0: it sticks, or has no friction
  bool sticks = false;
};

class NearbyMotion {
 public:
  explicit NearbyMotion(const System& system);

  void set_modes(const std::vector<ContactMode>& modes);
  /// Onto the joints and lasting contacts: the velocities along them at the projected coordinates.
  void project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v);
  /// One Runge–Kutta step between projections. False: not finite.
  bool move(double t, double length, Eigen::VectorXd& q, Eigen::VectorXd& v);
  double gap(int contact, double t, const Eigen::VectorXd& q);
  double slip(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);  // γ_T [m/s]
  /// Their rates of change along (v, a): [m/s], [m/s²].
  double gap_rate(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  double slip_rate(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a);
  /// J B Jᵀ of the contacts' normals, B the inverse mass with joints.
  Eigen::MatrixXd coupling(std::span<const Struck> contacts, double t, const Eigen::VectorXd& q);
  double gap_acceleration(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                          const Eigen::VectorXd& a);
  Eigen::VectorXd tangent_push(int contact, double t, const Eigen::VectorXd& q);  // W_Tᵀ
  /// Whether the contact's rows change as the bodies move on: its direction, or the arm of its force.
  bool turns(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  double gap_scale(int contact, double t, const Eigen::VectorXd& q);  // Σ |J_k q_k| of its row
  /// μ_static λ_N − side λ_T of a lasting contact [N], side = ±1 the sense of λ_T; its rate along the motion [N/s],
  /// from the `length` seconds before.
  double room(int contact, int side, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  double room_rate(int contact, int side, double t, double length, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                   const Eigen::VectorXd& a);
  double normal_force(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);   // [N]
  double tangent_force(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);  // [N]
  bool accelerations(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
    return motion_.accelerations(t, q, v, a);
  }
  /// The largest acceleration that the body forces alone would make.
  double free_acceleration(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    motion_.accelerations(t, q, v, a_);
    return motion_.free().lpNorm<Eigen::Infinity>();
  }
  /// The struck contacts' gaps are closed along the directions of their pushes, as if they fell back at once.
  void touch(const std::vector<Struck>& struck, double t, Eigen::VectorXd& q);
  /// Newton's law of the struck contacts; each slides or sticks as `struck` says. Returns the largest error of their
  /// rates [m/s]: more than rounding where contacts depend on each other and contradict.
  double strike(const std::vector<Struck>& struck, double t, const Eigen::VectorXd& q, Eigen::VectorXd& v);

 private:
  ContactRows rows(int contact, double t, const Eigen::VectorXd& q);
  std::size_t place_among_lasting(int contact) const;
  void add_push(const Row& row);

  const System& system_;
  ContactMotion motion_;
  DormandPrince step_;
  Eigen::VectorXd a_, first_, q_end_, v_end_, unused_;
  Eigen::MatrixXd push_;  // of an impact: velocities by its impulses
  Kinematics at_;
};

}  // namespace orthant
