// core/mechanics/dynamics/assemble.h — assembly: bodies moved into their joints and clearance joints by the least
// motion.
//
//   min ½ |q − q₀|²_M  with  Φ(q) = 0 and gap ≥ 0 in every clearance joint (plane: journals; space: balls in sockets
//   and pins in bushes); drives are where they start. In space q − q₀ of a rotation is its rotation vector.
// By Gauss-Newton steps: M δ = M (q₀ − q) + Jᵀ λ,  J δ = −Φ, −g, where J has the joints' rows and those of clearances
// that are exceeded, or held at their end by λ > 0. No body turns by more than 0.5 rad in a step, so that it
// stays on its branch; the answer is the nearest one of that branch only. Redundant rows may be there.
// Cost: O(rows² dof) a step, dense, once a scene.
// Source: Nocedal & Wright, Numerical Optimization (2006), ch. 18.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <string>

namespace orthant {

/// The scene with its bodies moved so, its `assemble` then false. Throws std::invalid_argument that names the joint or
/// clearance joint that is off most where there is no such place, or none is found.
Scene assembled(const Scene& scene);
spatial::Scene assembled(const spatial::Scene& scene);

struct OffMost {
  double off = 0;     // |Φ_i| [m, rad], the largest
  std::string joint;  // the name of its joint
};

/// At the coordinates q and the time t.
template <class Space> OffMost off_most(const SystemOf<Space>& system, double t, const Eigen::VectorXd& q);

}  // namespace orthant
