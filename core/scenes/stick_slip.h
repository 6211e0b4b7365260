// core/scenes/stick_slip.h — stick-slip: a block with a spring on a moving belt; exact periodic motion.
//
//   m ẍ + k x = friction of the belt (speed v_b): it carries the block while k |x| ≤ μ_s m g; a block that slides feels
//   μ m g. With x_s = μ_s m g / k, x_k = μ m g / k, ω = √(k/m), slip begins at x = x_s with ẋ = v_b and is
//     x = x_k + (x_s − x_k) cos ωt + v_b/ω sin ωt,
//   until ẋ = v_b again after 2 (π − arctan((x_s − x_k) ω / v_b)) / ω, at x = 2 x_k − x_s; the belt then carries the
//   block back to x_s in 2 (x_s − x_k) / v_b. The scene starts where sticking starts.
//   Defaults: k = m = 1, μ_s m g = 1, μ m g = 1/2.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/scenes/motion.h>

namespace orthant {

struct StickSlip {
  double mass = 1, stiffness = 1, g = 1;       // [kg], [N/m], [m/s²]
  double mu_static = 1, mu = 0.5, belt = 0.2;  // [m/s] > 0

  template <class V> void visit(V&& v) {
    v("mass", mass, 1e-6, 1e6), v("stiffness", stiffness, 1e-6, 1e6), v("g", g, 1e-6, 1e6);
    v("mu_static", mu_static, 0.0, 1e6), v("mu", mu, 0.0, 1e6), v("belt", belt, 1e-6, 1e6);
  }

  double stick_time() const;  // [s] from the start to the first slip
  double slip_time() const;   // [s]
  double period() const { return stick_time() + slip_time(); }
  Motion at(double t) const;

 private:
  double static_stretch() const { return mu_static * mass * g / stiffness; }
  double kinetic_stretch() const { return mu * mass * g / stiffness; }
  double frequency() const;
};

Scene stick_slip(const StickSlip& p = {});

}  // namespace orthant
