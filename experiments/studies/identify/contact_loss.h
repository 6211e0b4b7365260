// experiments/studies/identify/contact_loss.h — onset of contact loss: the crank speed from which on a slider leaves
// its guide.
//
//   The slider-crank with clearance, not driven, starts at θ₁ = 0 with the crank speed ω₀. Its slider rests on the
//   lower wall, e = 0. N(t; ω₀) is the sum of λ_N of the two lower corners, while these are kept closed. Over a
//   revolution
//     F(ω₀) = min N(t; ω₀) [N],   F′ = ∂N/∂(q, v) δ at the minimum t*,   δ = ∂(q, v)/∂ω₀ by motion_tangent.h        (1)
//   (t* moves, but ∂N/∂t = 0 there). Contact is lost if F < 0. Behind the release N is then that of a guide that holds
//   the slider: negative. A slow crank swings back; its first kLongest seconds count.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/integrators/between_events/contact_motion.h>
#include <orthant/solvers/solver.h>

#include <memory>
#include <optional>

namespace orthant {

struct GuidedSlider {
  double mu = 0.01, clearance = 0.001;  // [m] each side
};

/// The start at rest on the lower wall: e = 0, ω₀ in rad/s.
Scene slider_on_guide(const GuidedSlider& p, double crank_speed);

struct LeastForce {
  double t = 0, angle = 0;  // [s], [rad] t* and θ₁ there
  double force = 0;         // [N] F
  double slope = 0;         // [N s/rad] F′, where it was required
};

/// [rad/s] The crank speed at which F = 0 for μ = 0, in closed form, minimized over θ₁. The speed follows from
/// the energy, N from the two equations of motion and the constraint y_s = −clearance: A(θ₁) + B(θ₁) ω₁².
double frictionless_contact_loss(double clearance);

class ContactLoss {
 public:
  explicit ContactLoss(const GuidedSlider& p);

  /// Throws std::runtime_error where a run fails, and where the least force is that of an event or an end.
  LeastForce least(double crank_speed, bool slope);
  /// [s] Time of the first release within a revolution, by event-driven. Empty: there is none.
  std::optional<double> release(double crank_speed);

  /// Root of F in [low, high], F(low) > 0 > F(high), to 1e-13 of it: by Newton steps, or halves of the bracket where
  /// they leave it; by chords, without derivatives (Illinois); by halving, from release() alone. Throw
  /// std::invalid_argument where contact is not kept at low and lost at high.
  double by_newton(double low, double high);
  double by_chords(double low, double high);
  double by_halving(double low, double high);

  int runs = 0, tangents = 0;  // of motions; of these with derivatives

 private:
  static constexpr double kLongest = 2;  // [s]
  GuidedSlider p_;
  std::unique_ptr<Solver> solver_;
};

}  // namespace orthant
