// integrators/derivatives/step_linearization.h — linearization of a planar Moreau–Jean step, its active set fixed.
//
//   The step of velocity_stepping.h from x = (q, v) to x⁺, joints symmetric, reduced form, at q_a = q + a h v:
//     r₁ = M̂ (v' − v) − h f − Gᵀ Λ_G − Jᵀ z = 0,   r₂ = G (v/a + v' − v) − ṡ/a = 0                               (1)
//     w = r₃ = J v' − target (e, e_T, belt),  z of the complementarity problem                                     (2)
//     (q* = q + h (θ v' + (1−θ) v), v') → (q⁺, v⁺): the projection (3) of projection_linearization.h
//   Tangent of (q̇, v̇, ṗ): ρ = (r₁, r₂, r₃)˙ at fixed v', Λ_G, z;
//     (x, ·) = K⁻¹ (−ρ₁, −ρ₂),  ẇ₀ = J x + ρ₃,  ż by step_sensitivity.h,  v̇' = x + B Jᵀ ż
//   with K⁻¹ and B of basic_system.h. Adjoint of v̄' and z̄, in the reverse order:
//     β, lō, hī, μ̄ of z̄ + J B v̄';  (x, λ) = K⁻¹ (v̄' + Jᵀ β, 0),  ρ̄ = (−x, λ, β)
//   So impulses, stick and slip, restitution and joints are differentiated implicitly. ρ by state is exact: the rows'
//   slopes (row_slope.h). ρ by a parameter is exact or by differences (parameter_change.h).
//   Between changes of the active set the step is smooth, and this is its derivative; where rows are weakly active it
//   has one-sided ones only (degenerate), of which tangent and adjoint hold the rows at their bounds.
//   The step is computed again from its impulses; where that does not give x⁺ (impacts by another law than Newton's,
//   joint friction that depends on loads, sleep, stiffened joints), std::runtime_error reports it.
//   Cost: two factorizations a step, then two or three solves for a tangent or an adjoint. Tangents of all parameters
//   are the columns of one block: rows and slopes are read once.
#pragma once

#include <orthant/core/lcp/judge/certify.h>
#include <orthant/integrators/derivatives/start_linearization.h>
#include <orthant/integrators/derivatives/step_sensitivity.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>

namespace orthant {

/// What a step leaves behind for its derivative.
struct StepTrace {
  struct Place {
    Index normal = -1, tangent = -1;  // rows of the problem; −1: none
    bool strikes = false;
    bool inelastic = false;  // its targets hold no restitution; of a contact that approaches: e = e_t = 0 in the step
  };
  double h = 0;  // [s]
  State before, after;
  std::vector<int> contacts;                // closed
  std::vector<Place> places;                // of them
  std::vector<std::pair<int, bool>> mu_of;  // of each friction of the problem: its contact, whether μ is the static one
  Index rows = 0, first_friction = 0;       // of the problem; where dry friction in joints begins
  Lcp problem;
  Vector z;

  /// Of the step that `integrator` has done last, from `x` to `after`.
  void take(const MoreauJean& integrator, const State& x, double h, const State& after);
};

/// Impulses: their changes in a tangent, the weights of a scalar in an adjoint.
struct ImpulseChange {
  Eigen::VectorXd normal, tangent, across;  // one entry a contact [N s]; across: of the second tangent, in space
  Eigen::VectorXd friction;                 // one entry a dry friction in joints [N s, N m s]

  template <class Space> void clear(const SystemOf<Space>& system) {
    for (auto* part : {&normal, &tangent, &across}) part->setZero(system.contacts());
    friction.setZero(std::ssize(system.scene().frictions));
  }
};

/// Throws std::runtime_error for tangents or adjoints that are not finite any more, of a step from t on.
void refuse_overflow(bool finite, double t);

/// Throws std::invalid_argument for laws of impacts without derivatives, whether the run has impacts or not.
template <class Scene> void refuse_impact_laws(const Scene& scene) {
  if (scene.contacts.empty()) return;
  if (scene.restitution != Restitution::newton)
    throw std::invalid_argument("derivatives of a run: restitution = poisson: must be newton");
  if (scene.impacts != Impacts::simultaneous)
    throw std::invalid_argument("derivatives of a run: impacts = sequential: must be simultaneous");
}

class StepLinearization {
 public:
  using Trace = StepTrace;
  /// Throws std::invalid_argument for what has no derivative here.
  explicit StepLinearization(const System& system, const MoreauJeanOptions& options = {});

  /// From now on contacts with this flag (one a contact, or none) that have no friction have rows for it, with μ = 0:
  /// derivatives by μ are those of μ → 0+. Friction is at its bound, against the slip. Where there is no slip, the
  /// contact is degenerate: it is held without friction.
  void begin_friction(std::vector<char> begun) { begun_ = std::move(begun); }

  void set_up(const StepTrace& step);
  void part_of(const ParameterChange& parameter, StepPart& part);

  /// (q̇, v̇) at the step's begin become those at its end, one column a parameter. `impulses`: of the contacts, one a
  /// parameter; null: not wanted.
  void push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
            std::vector<ImpulseChange>* impulses = nullptr);
  /// (q̄, v̄) at the end become those at the begin. `impulses`: the scalar's derivative by the contacts' impulses.
  /// Calls parameter(adjoint of the step's equations, adjoint of the projection's) for inner products with parts.
  template <class F> void pull(double* q, double* v, const ImpulseChange* impulses, F&& parameter) {
    pull(q, v, impulses);
    parameter(by_step_, by_projection_);
  }

  /// Of the last step: contacts with weakly active rows, and whether redundant contacts parted.
  const std::vector<int>& degenerate() const { return degenerate_; }
  /// Dry frictions in joints that hold with their whole bound.
  const std::vector<int>& spent() const { return spent_; }
  bool consistent() const { return consistent_; }
  Sharing sharing() const { return sharing_; }

 private:
  void pull(double* q, double* v, const ImpulseChange* impulses);
  void linearize_rows();
  /// extended_: the step with rows for friction that begins; its matrix, at v'.
  void extend(const StepTrace& step);
  void form_extended(const StepTrace& step);
  /// A row with the impulse `force` in r₁, and the rate J u + by_rate J v in r at `out`.
  void add_row(const Row& row, const RowSlope& slope, double force, const Eigen::VectorXd& u, double by_rate,
               Index out);
  void contact_parts(const ParameterChange& parameter, SparsePart& part) const;
  void element_parts(const ParameterChange& parameter, SparsePart& part) const;
  Eigen::Index size() const;

  const System& system_;
  MoreauJeanOptions options_;
  const StepTrace* step_ = nullptr;
  StepTrace extended_;
  std::vector<char> begun_;
  Terms terms_;  // at q_a
  BasicSystem basic_;
  ProjectionLinearization projection_;
  std::vector<Row> rows_;                     // of the problem
  std::vector<StepTrace::Place> places_;      // with what strikes
  Eigen::VectorXd v_new_, change_, joint_;    // v', v' − v, Λ_G
  std::vector<Slope> by_pose_, by_velocity_;  // of r by q_a and by v, but for M
  std::vector<RowSlope> slopes_;
  StepSensitivity sensitivity_;
  std::vector<int> degenerate_, spent_;
  bool consistent_ = true;
  Sharing sharing_ = Sharing::unique;
  Judge judge_;
  Solution solution_;
  std::vector<double> stick_;  // [m/s] of each friction
  void push_contacts(Index count, std::vector<ImpulseChange>* impulses);
  void add_response(Index count);
  void solve_columns(Index count, const double* f, const double* c, DirectionBlock& x);  // basic_; c null: 0
  Eigen::VectorXd fixed_, by_z_, q_a_, force_, none_, unused_joints_, by_step_, by_projection_;
  DirectionBlock rho_, q_at_, solved_, z_, forces_, by_force_;  // of the directions
  std::vector<Index> changed_;                                  // rows
};

}  // namespace orthant
