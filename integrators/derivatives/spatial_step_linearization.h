// integrators/derivatives/spatial_step_linearization.h — linearization of a Moreau–Jean step in space, its active set
// fixed.
//
//   The step of velocity_stepping.h from x = (q, v) to x⁺, joints symmetric, reduced form; rows and w, the velocities
//   after the step, stand in the axes F of q_a = q moved by a h v (gyroscopic.h):
//     r₁ = M̂ (w − v) − h f − g(v, w) − Gᵀ Λ_G − Jᵀ z = 0,   r₂ = G (v/a + w − v) − ṡ/a = 0                        (1)
//     r₃ = J w − target (e, e_T, moving surfaces),  z of the complementarity problem with friction discs          (2)
//     ω⁺ of w, q* = q moved by h (θ v' + (1−θ) v), then spatial_projection_linearization.h                        (3)
//   Changes of poses have six coordinates a body: δx in the world, δφ with R → R exp δφ. Tangent of (δq, δv):
//     ρ = (r₁, r₂, r₃)˙ at fixed w, Λ_G, z;   (x, ·) = K⁻¹ (−ρ₁, −ρ₂),  ẇ₀ = J x + ρ₃,  ż by step_sensitivity.h,
//     ẇ = x + B Jᵀ ż,   K: M̂ − ∂g/∂w in place of M̂ (spatial_saddle.h),  B its block of velocities
//   J B Jᵀ, not symmetric, takes the place of the step's own matrix: gyroscopic impulses follow those of contacts.
//   The adjoint takes the same in the reverse order. All maps but K⁻¹ and ż are lists of entries (row_slope.h).
//   What is said in step_linearization.h of changes of the active set, of weakly active rows and of steps that are not
//   plain holds here, too.
#pragma once

#include <orthant/core/lcp/judge/certify.h>
#include <orthant/integrators/derivatives/gyroscopic_slope.h>
#include <orthant/integrators/derivatives/spatial_force_slopes.h>
#include <orthant/integrators/derivatives/spatial_projection_linearization.h>
#include <orthant/integrators/derivatives/step_linearization.h>
#include <orthant/integrators/fixed_step/moreau_jean.h>

namespace orthant {

/// What a step leaves behind for its derivative.
struct SpatialStepTrace {
  struct Place {  // first rows of the problem; −1: none
    Index normal = -1, tangent = -1, rolling = -1, spinning = -1;
    bool strikes = false;
    bool inelastic = false;  // as StepTrace::Place
  };
  enum class Coefficient { kinetic, fixed, rolling, spinning };  // fixed: the static one
  double h = 0;                                                  // [s]
  State before, after;
  std::vector<int> contacts;                             // closed
  std::vector<Place> places;                             // of them
  std::vector<std::pair<int, Coefficient>> friction_of;  // of each friction of the problem: its contact
  Index rows = 0, first_friction = 0;                    // of the problem; where dry friction in joints begins
  std::vector<Friction> friction;
  Vector lo, hi, z;

  /// Of the step that `integrator` has done last, from `x` to `after`.
  void take(const MoreauJeanOf<Spatial>& integrator, const State& x, double h, const State& after);
};

class SpatialStepLinearization {
 public:
  using System = SystemOf<Spatial>;
  using Row = RowOf<Spatial>;
  using Trace = SpatialStepTrace;
  /// Throws std::invalid_argument for what has no derivative here.
  explicit SpatialStepLinearization(const System& system, const MoreauJeanOptions& options = {});

  // As StepLinearization has them; q and v of dof entries each.
  void begin_friction(std::vector<char> begun) { begun_ = std::move(begun); }
  void set_up(const Trace& step);
  void part_of(const ParameterChangeOf<Spatial>& parameter, StepPart& part);
  void push(const std::vector<StepPart>& parameters, DirectionBlock& q, DirectionBlock& v,
            std::vector<ImpulseChange>* impulses = nullptr);
  template <class F> void pull(double* q, double* v, const ImpulseChange* impulses, F&& parameter) {
    pull(q, v, impulses);
    parameter(by_step_, by_projection_);
  }
  const std::vector<int>& degenerate() const { return degenerate_; }
  const std::vector<int>& spent() const { return spent_; }
  /// Contacts whose tangents jump as their normals turn, by the pose or by a parameter: their sum is differentiated.
  const std::vector<int>& jumping() const { return jumping_; }
  bool consistent() const { return consistent_; }
  Sharing sharing() const { return sharing_; }

 private:
  void pull(double* q, double* v, const ImpulseChange* impulses);
  Eigen::Index size() const;  // of r: r₁, r₂, r₃, bounds of z, friction coefficients
  void extend(const Trace& step);
  void collect_rows();
  void find_strikes();
  void solve_step(const Vector* z);  // w_, joint_, by Newton's method; null: without contacts
  void find_turns();
  void find_problem();
  void find_pattern();
  void note_degenerate(Index row);
  static constexpr double kTurn = 1e-6;  // slope of a normal that turns: more than rounding
  bool jumps(std::size_t k) const;       // closed contact k, where its normal turns
  void note_jumps(const ParameterChangeOf<Spatial>& parameter);
  bool any_slides() const;
  void linearize_frames();
  void linearize_rows();
  /// Row `row` with the impulse `force` in r₁, its rate (u, and e v at the start) in r at `out`.
  void add_row(const Row& row, const RowSlopeOf<Spatial>& slope, double force, const Eigen::VectorXd& u, double e,
               Index out);
  void append_turn_slopes(std::vector<Slope>& to, Index of, Index by, const Eigen::Matrix3d& block) const;
  void contact_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const;
  void law_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const;
  void element_parts(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) const;
  /// Calls f(place in r₃, place in SurfaceRows) for the rows of closed contact k.
  template <class F> void each_row(std::size_t k, F&& f) const;

  const System& system_;
  MoreauJeanOptions options_;
  Trace step_;  // with rows for friction that begins
  std::vector<char> begun_;
  TermsOf<Spatial> terms_;  // at q_a
  StepFrames frames_;
  ForceShare share_;
  IndependentRows independent_;
  SpatialSaddle saddle_;
  SpatialProjectionLinearization projection_;
  std::vector<SurfaceRows> surfaces_;         // of the closed contacts
  std::vector<Row> rows_;                     // of the problem
  Eigen::VectorXd belt_, e_;                  // of them: r₃ = J (w + e v) − (1 + e) belt
  Eigen::VectorXd w_, change_, end_, joint_;  // w, w − v, v', Λ_G
  std::vector<TurnSlope> turns_;              // of the bodies
  bool turning_ = false;                      // some body has different moments
  std::vector<Slope> to_middle_, by_pose_, by_start_, end_by_start_, end_by_w_;
  Eigen::MatrixXd response_;  // B Jᵀ
  Lcp problem_;
  Solution solution_;
  Judge judge_;
  StepSensitivity sensitivity_;
  std::vector<int> degenerate_, spent_, jumping_;
  bool consistent_ = true;
  Sharing sharing_ = Sharing::unique;
  Eigen::VectorXd force_, rate_, x_, q_end_, by_step_, by_projection_;
  DirectionBlock start_, middle_, rho_, solved_, z_, both_;  // of the directions
};

template <class F> void SpatialStepLinearization::each_row(std::size_t k, F&& f) const {
  const Trace::Place& place = step_.places[k];
  if (place.normal < 0) return;
  f(place.normal, std::size_t{0});
  if (place.tangent >= 0) f(place.tangent, std::size_t{1}), f(place.tangent + 1, std::size_t{2});
  if (place.rolling >= 0) f(place.rolling, std::size_t{3}), f(place.rolling + 1, std::size_t{4});
  if (place.spinning >= 0) f(place.spinning, std::size_t{5});
}

}  // namespace orthant
