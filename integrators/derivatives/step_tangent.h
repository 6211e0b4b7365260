// integrators/derivatives/step_tangent.h — tangent of one planar Moreau–Jean step, active set fixed.
//
//   The step of velocity_stepping.h from x = (q, v) to x⁺, joints symmetric, reduced form, at q_a = q + a h v:
//     r₁ = M̂ (v' − v) − h f − Gᵀ Λ_G − Jᵀ z = 0,   r₂ = G (v/a + v' − v) − ṡ/a = 0                               (1)
//     w = r₃ = J v' − target (e, e_T, belt),  z of the complementarity problem                                     (2)
//     q* = q + h (θ v' + (1−θ) v),  q⁺ = q* + M⁻¹ G*ᵀ λ with Φ(q⁺) = 0,  v⁺ = v' + M⁻¹ G*ᵀ ν with G⁺ v⁺ = ṡ        (3)
//   Along a change (q̇, v̇, ṗ) of state and parameters: the changes of r₁ … r₃ at fixed v', Λ_G, z give v̇' and ẇ₀ at a
//   fixed z by the basic system; ż by sensitivity() of the step's problem (solvers/derivatives/sensitivity.h), which
//   adds B Jᵀ ż to v̇'; then (3) likewise. So impulses, stick and slip, restitution and joints are differentiated
//   implicitly, without differences; the terms r, M⁻¹ Gᵀ λ, Φ and G v themselves by central differences of fourth
//   order: of parameters over 1e-3 of their value, of the state over 3e-6 m (rad), each with an error of about 1e-10.
//   Between changes of the active set the step is smooth, and this is its derivative; where rows are weakly active it
//   has one-sided ones only (degenerate), of which the tangent holds the rows at their bounds.
//   The step is computed again from its impulses; where that does not give x⁺ (impacts by another law than Newton's,
//   joint friction that depends on loads, sleep, stiffened joints), std::runtime_error says so.
#pragma once

#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/mechanics/dynamics/basic_system.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/solvers/derivatives/sensitivity.h>

#include <array>
#include <memory>
#include <vector>

namespace orthant {

/// A parameter as the systems next to the scene's: at value + k step, k = −2, −1, 1, 2. Null: it is none of the scene's
/// (the tangent then has no part of its own).
struct NearbySystems {
  double step = 0;
  std::array<std::unique_ptr<System>, 4> at;
};

class StepTangent {
 public:
  explicit StepTangent(const System& system, const MoreauJeanOptions& options = {});

  /// q̇ and v̇ at the start, a column a parameter, that the scenes' own initial states give: projected onto the joints.
  /// `closed`: where the run begins.
  void begin(const State& closed, const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq,
             Eigen::MatrixXd& dv);

  /// The step that `integrator` has done from x over h to `after`: dq and dv are those of x, and become those of after.
  void advance(const MoreauJean& integrator, const State& x, double h, const State& after,
               const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq, Eigen::MatrixXd& dv);

  /// Of the last step: contacts with weakly active rows, and whether redundant contacts parted.
  const std::vector<int>& degenerate() const { return degenerate_; }
  bool consistent() const { return consistent_; }

 private:
  struct Step;  // what is held fixed
  /// r₁, r₂, r₃, then the bounds of dry friction, then μ of each friction.
  void residual(const System& system, const Step& step, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                Eigen::VectorXd& r);
  /// M⁻¹ Gᵀ λ and M⁻¹ Gᵀ ν at q.
  void pushes(const System& system, double t, const Eigen::VectorXd& q, Eigen::VectorXd& r);
  /// Φ and G v − ṡ at q.
  void constraints(const System& system, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                   Eigen::VectorXd& r);
  void project(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before, const State& after,
               const std::vector<NearbySystems>& parameters, Eigen::MatrixXd& dq, Eigen::MatrixXd& dv);
  void set_up_projection(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before,
                         const State& after);

  const System& system_;
  MoreauJeanOptions options_;
  Terms terms_;                     // of differences
  Terms at_, projected_, after_;    // at q_a, q* and q⁺
  BasicSystem basic_, projection_;  // at q_a, at q*
  Eigen::VectorXd lambda_, nu_;     // λ, ν
  double missed_ = 0;               // of x⁺, by what (3) gives
  std::vector<int> degenerate_;
  bool consistent_ = true;
  Judge judge_;
};

}  // namespace orthant
