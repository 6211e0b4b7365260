// integrators/between_events/spatial_transition.h — contact mode transition in space: contacts that last, stick, slide.
//
//   Over the contacts that touch and do not separate (g = 0, γ_N = 0), with λ_T = −μ λ_N d put in where they slip along
//   d, |d| = 1:
//     0 ≤ λ_N ⊥ W_N a + Ẇ_N v ≥ 0,     γ_T = 0:  |λ_T| ≤ μ λ_N,  inside: γ̇_T = 0,  at the bound: γ̇_T = −κ λ_T, κ ≥ 0.
//   λ_N > 0: the contact lasts, else it opens. γ_T = 0 with |λ_T| inside its disc: it sticks, else it slides off along
//   γ̇_T; with a greater static coefficient the problem is then solved again with the kinetic one.
//   Directions that joints immobilise have no force. With friction there may be no solution, or several (Painlevé):
//   where the solver finds none, why() says so; several are not looked for.
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996), ch. 6.
#pragma once

#include <orthant/integrators/between_events/spatial_motion.h>
#include <orthant/integrators/integrator.h>

#include <string>

namespace orthant {

class SpatialTransition {
 public:
  explicit SpatialTransition(const SystemOf<Spatial>& system);

  struct Candidate {
    int contact = 0;
    bool slides = false;
    bool departs = false;         // it begins to slide
    Vector3d direction{0, 0, 0};  // of slip, in the world, where it slides
  };
  std::vector<Candidate> candidates;  // in the order of the scene

  /// Writes the modes of all contacts; `motion` has just evaluated its accelerations at (q, v), with all contacts open.
  /// Not solved: why() says what is wrong, the modes are as they were.
  Status decide(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Solver& solver,
                StepReport& report);

  const Lcp& problem() const { return lcp_; }
  const std::string& why() const { return why_; }
  void remember(CheckpointData& memory) { memory(solution_.z); }  // the next guess

 private:
  void formulate(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  bool slide_off();
  double zero() const;

  const SystemOf<Spatial>& system_;
  ContactEquationsOf<Spatial> equations_;
  Lcp lcp_;
  Solution solution_;
  std::vector<int> contacts_;
  std::vector<ContactRowsOf<Spatial>> rows_;
  std::string why_;
};

}  // namespace orthant
