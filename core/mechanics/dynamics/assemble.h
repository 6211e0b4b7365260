// core/mechanics/dynamics/assemble.h — assembly: bodies moved into their joints and journals by the least motion.
//
//   min ½ |q − q₀|²_M  with  Φ(q) = 0 and |d| ≤ clearance in every journal (its gap ≥ 0); drives are where they start
// By Gauss-Newton steps: M δ = M (q₀ − q) + Jᵀ λ,  J δ = −Φ, −g, where J has the joints' rows and those of journals
// that are out of their bearings, or held at them by λ > 0. No body turns by more than 0.5 rad in a step, so that it
// stays on its branch; the answer is the nearest one of that branch only. Redundant rows may be there.
// Cost: O(rows² dof) a step, dense, once a scene.
// Source: Nocedal & Wright, Numerical Optimization (2006), ch. 18.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <string>

namespace orthant {

/// The scene with its bodies moved so, its `assemble` then false. Throws std::invalid_argument that names the joint or
/// journal that is off most where there is no such place, or none is found.
Scene assembled(const Scene& scene);

struct OffMost {
  double off = 0;     // |Φ_i| [m, rad], the largest
  std::string joint;  // the name of its joint
};

/// At the coordinates q and the time t.
OffMost off_most(const System& system, double t, const Eigen::VectorXd& q);

}  // namespace orthant
