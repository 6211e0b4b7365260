// integrators/derivatives/rattle_linearization.h — linearization of a planar step of rattle, its active sets fixed.
//
//   The step of rattle.h from (q, v) to (q⁺, v⁺), with μ = h R (z₁), P (z₂), both with joints' dry friction, and C
//   the rows along which −R acts; J₁ = (W_N, W_T, F) at q, J₂ at q⁺:
//     r₁ = M̂ (u − v) − h/2 f(t, q, v) − Gᵀ Λ₁ − J₁ᵀ z₁ / h = 0,  r₂ = Φ(q⁺) = 0,  q⁺ = q + h u                 (1)
//     w₁ = (g_N(q⁺), h (W_T u − belt), h F u),  z₁ of the position stage;  M̂ = M + h/2 C                       (2)
//     r₄ = M (v' − u) − h/2 f(t+h, q⁺, u) − G⁺ᵀ Λ' + Cᵀ z₁ / h = 0,  r₅ = G⁺ v' − ṡ = 0                        (3)
//     r₇ = M (v⁺ − v') − G⁺ᵀ Λ'' − J₂ᵀ z₂ = 0,  r₈ = G⁺ (v⁺ − v') = 0                                          (4)
//     w₂ = J₂ v⁺ − target(e, e_T, belt, q, v; at an impact whose speed is that at the surface: u, v', q⁺)      (5)
//   Tangent, in this order: u̇ of (1) at fixed z₁ by skew_saddle.h (G pushes at q, holds at q⁺); ż₁ of the problem with
//   the exact matrix ∂w₁/∂z₁ (not that of the simplified Newton steps); q̇⁺; v̇⁺ of (3) and (4) at fixed z₂; ż₂
//   likewise (step_sensitivity.h). The adjoint goes back. Slopes, parameters, weak rows: step_linearization.h.
//   The step is computed again from its impulses; where that does not give x⁺ (rows frozen again at an iterate, joints
//   stiffened, friction that wins against restitution), std::runtime_error reports it.
//   Cost: two factorizations a step and one of S, then two or three solves for a tangent or an adjoint.
#pragma once

#include <orthant/integrators/derivatives/skew_saddle.h>
#include <orthant/integrators/derivatives/step_linearization.h>
#include <orthant/integrators/fixed_step/rattle.h>

namespace orthant {

/// What a step of rattle leaves behind for its derivative.
struct RattleTrace {
  struct Stage {
    double normal = 0, tangent = 0, mu = 0;        // impulses: [kg m] of positions, [N s] of velocities
    bool has_normal = false, has_tangent = false;  // rows
    bool is_static = false;                        // μ is the static one
  };
  struct Contact {
    int contact = 0;
    Stage position, velocity;
    bool strikes = false, rebounds = false, at_surface = false;  // of γ⁻; where −R acts; how γ⁻ was found
  };
  double h = 0;  // [s]
  bool froze_again = false;
  State before, after;
  std::vector<Contact> contacts;                         // that carry or touch at the end
  Eigen::VectorXd friction_position, friction_velocity;  // of dry friction in joints

  void take(const Rattle& integrator, const State& x, double h, const State& after);
};

class RattleLinearization {
 public:
  using Trace = RattleTrace;
  /// Throws std::invalid_argument for what has no derivative here.
  explicit RattleLinearization(const System& system, const RattleOptions& options = {});

  /// See StepLinearization.
  void begin_friction(std::vector<char> begun) { begun_ = std::move(begun); }
  void set_up(const RattleTrace& step);
  void part_of(const ParameterChange& parameter, StepPart& part);
  /// See StepLinearization.
  void push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
            std::vector<ImpulseChange>* impulses = nullptr);
  template <class F> void pull(double* q, double* v, const ImpulseChange* impulses, F&& parameter) {
    pull(q, v, impulses);
    parameter(by_, none_);
  }
  const std::vector<int>& degenerate() const { return degenerate_; }
  const std::vector<int>& spent() const { return spent_; }
  /// The position stage froze its rows at an iterate: the derivative misses how these move, of the order h².
  bool froze_again() const { return step_->froze_again; }
  bool consistent() const { return consistent_; }
  Sharing sharing() const {
    return position_.sensitivity.redundant() || velocity_.sensitivity.redundant() ? Sharing::impulses : Sharing::unique;
  }

 private:
  /// One of the two problems: rows of the contacts that have them, then of dry friction in joints.
  struct Stage {
    std::vector<Row> push, hold;              // J that pushes; ∂w/∂u or ∂w/∂v⁺, over h or 1
    std::vector<Index> normal, tangent;       // of each contact of the step; −1: none
    std::vector<std::pair<int, bool>> mu_of;  // of each friction: its contact, whether μ is the static one
    Index rows = 0, first_friction = 0;
    Lcp problem;
    Vector z, w;
    Eigen::MatrixXd unit;  // dof × rows: velocities by each impulse
    StepSensitivity sensitivity;
  };
  void push_one(const StepPart& parameter, double* q, double* v, ImpulseChange* impulses);
  void pull(double* q, double* v, const ImpulseChange* impulses);
  void number(Stage& stage, bool velocity);
  void evaluate();
  void find_velocities();
  void find_positions();
  bool begins(int contact) const;
  void note_rest(Stage& stage);
  void solve_stage(Stage& stage, double bound);  // matrix, z, w become a problem with sensitivity
  void linearize();
  void linearize_joints();
  void linearize_contacts();
  void linearize_targets(std::size_t k, const std::array<RowSlope, 2>& at_start, const std::array<RowSlope, 2>& at_end);
  void linearize_frictions();
  double speed_at_surface(std::size_t k, double& square) const;  // √square, square of (5)
  const Eigen::VectorXd& tangent_of(Stage& stage, Index place, const Eigen::VectorXd& rates);
  Eigen::VectorXd adjoint_of(Stage& stage, Index place, const Vector& of_z);
  void contact_parts(const ParameterChange& parameter, SparsePart& part);
  void moved_contact_part(const ParameterChange& parameter, std::size_t k, SparsePart& part);
  void law_part(const ParameterChange::Law& change, std::size_t k, SparsePart& part);
  void joint_parts(const ParameterChange& parameter, SparsePart& part) const;
  void friction_parts(const ParameterChange& parameter, SparsePart& part) const;

  /// Places of r₁, r₂, w₁ (with bounds and μ behind), r₄, r₅, r₇, r₈, w₂ (likewise).
  struct Places {
    Index r1 = 0, r2 = 0, w1 = 0, r4 = 0, r5 = 0, r7 = 0, r8 = 0, w2 = 0, size = 0;
  };
  const System& system_;
  const RattleTrace* step_ = nullptr;
  Terms start_, end_;
  BasicSystem first_, second_;  // of (1), of (3) and (4)
  SkewSaddle saddle_;
  Stage position_, velocity_;
  Places at_;
  std::vector<char> begun_;
  bool any_at_surface_ = false;
  Eigen::VectorXd u_, kick_, free_, pushed_, new_;  // u, u − v, v', v⁺ − v', v⁺
  Eigen::VectorXd lambda_1_, lambda_free_, lambda_push_;
  std::vector<Row> carry_;                                    // C, one a row of the position stage
  std::vector<Slope> of_q_, of_v_, of_u_, of_end_, of_free_;  // of all equations
  std::vector<RowSlope> slopes_;
  std::vector<int> degenerate_, spent_;
  bool consistent_ = true;
  Judge judge_;
  Eigen::VectorXd rho_, by_, one_q_, one_v_, z_dot_, none_, none_of_joints_, unused_, force_, rate_, x_, y_, joints_;
};

}  // namespace orthant
