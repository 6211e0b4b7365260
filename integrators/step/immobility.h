// integrators/step/immobility.h — immobile contact rows, linearly dependent on the joints' rows: no impulse can move
// them.
//
//   Remainder of a combination J = Σ w_i J_i of contact rows without the joints' share:
//     r = Jᵀ + Gᵀ λ,   λ from the basic system, r put through it again until only rounding is left.
//   J is immobile when r is no more than rounding of what it is summed of,
//     Σ_b |r_b|² ≤ Σ_b (256 ε (1 + (1 + |x_b|)/ρ_b) P_b)²,   P_b = Σ |w_i| |J_i,b| + Σ |λ_k| |G_k,b|  of body b.
//   Forces are compared, torques divided by the radius of gyration ρ_b: no ratio of masses enters, as it would into the
//   effective inverse mass J B Jᵀ, which is next to nothing between light and heavy bodies, too. |x_b|/ρ_b is what
//   rounding of places far away makes of levers; joints hold to some ε (1 + |x_b|) (projection.h).
//   Poses are those where the joints hold, at the start of a step: on its way a scheme is off them by O(h²), and levers
//   so. The rate of an immobile J is the one that the joints give it, J v for any v with G v = ṡ; 0 without drives, and
//   where it is no more than 1e-9 of the speeds of J's bodies plus rounding of the fastest body's speed and of what the
//   drives' rates are summed of.
// Cost: one factorization of the basic system per step with a row to test, and three solves per row. Callers test only
// rows with a small effective inverse mass: suspicious().
// Source: Golub & Van Loan, Matrix Computations (2013), 5.5 (numerical rank), 5.3.8 (iterative refinement).
#pragma once

#include <orthant/core/mechanics/dynamics/basic_system.h>

namespace orthant {

class Immobility {
 public:
  struct Verdict {
    bool immobile = false;
    double rate = 0;  // that the joints' drives give the combination; 0: no more than rounding
  };
  explicit Immobility(const System& system);

  /// From now on rows are those at q, which satisfies the joints at time t. pairs: of the contacts that are not listed.
  /// False: no usable matrix; then nothing is immobile.
  bool stand(double t, const Eigen::VectorXd& q, const std::vector<Pair>& pairs = {});
  /// Likewise at the poses of `at`.
  bool stand(const Kinematics& at);
  /// With the joints' rows of `terms`, poses as far as rounding goes: rows that are added are such of the same problem.
  bool stand(const Terms& terms);

  ContactRows rows(int contact);
  double gap(int contact);  // [m] there
  /// J B Jᵀ there.
  double effective(const Row& row);

  /// A combination, row by row, of rows that are there.
  void begin();
  void add(const Row& row, double weight = 1);
  Verdict judge();
  /// λ of the last one judged, one a joint row.
  const Eigen::VectorXd& loads() const { return load_; }
  Verdict judge(const Row& row) { return begin(), add(row), judge(); }
  /// Of one row; cheaper where it is far from immobile.
  Verdict look(const Row& row) {
    return suspicious(row, effective(row), system_.inverse_mass()) ? judge(row) : Verdict{};
  }

  /// Whether an effective inverse mass is so much below J M⁻¹ Jᵀ, of the row without joints, that the row has to be
  /// judged.
  static bool suspicious(const Row& row, double effective, const Eigen::VectorXd& inverse_mass);

 private:
  bool factorize();
  /// Adds a row's entries to what its bodies' forces are summed of.
  void measure(const Row& row, double weight);
  double rounding_of_rate(const Eigen::VectorXd& sizes, const Eigen::VectorXd& v) const;
  double rounding_of_drives() const;
  double far(Index body) const;  // [m] 1 m more than its distance from the origin

  const System& system_;
  Terms terms_;
  BasicSystem basic_;
  bool usable_ = false;
  Eigen::VectorXd gyration_;                            // [m] ρ, one a body
  Eigen::VectorXd sum_, sizes_, left_, change_, none_;  // dof
  Eigen::VectorXd load_, more_;                         // λ
};

}  // namespace orthant
