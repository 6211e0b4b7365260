// integrators/between_events/spatial_transition.h — contact mode transition in space: contacts that last, stick, slide.
//
//   Over the contacts that touch and do not separate (g = 0, γ_N = 0), with λ_T = −μ λ_N d put in where they slip along
//   d, |d| = 1:
//     0 ≤ λ_N ⊥ W_N a + Ẇ_N v ≥ 0,     γ_T = 0:  |λ_T| ≤ μ λ_N,  inside: γ̇_T = 0,  at the bound: γ̇_T = −κ λ_T, κ ≥ 0.
//   λ_N > 0: the contact lasts, as one does that stays closed while others bear its load; else it opens. γ_T = 0 with
//   |λ_T| inside its disc: it sticks, else it slides off along γ̇_T; with a greater static coefficient the problem is
//   then solved again with the kinetic one.
//   Contacts that joints immobilise are no candidates, immobile tangents have no force (spatial_immobility.h). With
//   friction there may be no solution or several (Painlevé). "None" is reported with a proof that rounding of the
//   problem could not have produced, or if all modes were tried; a problem neither solved nor proved is undecided().
//   Several solutions are searched for where a contact's own coupling
//   allows them (W_N B (W_N − μ W_T d)ᵀ ≤ 0 for a direction d that it may take), of at most 12 contacts that all slide
//   or have no friction, by enumeration, and of a single contact without slip. Its directions of departure are the
//   zeros of
//     d × γ̇_T (d),   γ̇_T (d) = b_T + λ_N (A_TN − μ A_TT d),   λ_N (d) = −b_N / (A_NN − μ A_NT d),
//   times A_NN − μ A_NT d a trigonometric polynomial of degree 2; those nearer to each other than half a degree count
//   as one. Solutions count as one where the accelerations are the same.
//   Source: Pfeiffer & Glocker, Multibody Dynamics with Unilateral Contacts (1996), ch. 6; Génot & Brogliato,
//   European Journal of Mechanics A 18 (1999) 653-677.
#pragma once

#include <orthant/integrators/between_events/spatial_motion.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/spatial_immobility.h>
#include <orthant/solvers/even_share.h>
#include <orthant/solvers/refinement.h>

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
  bool undecided() const { return undecided_; }                   // not solved, and not known whether it can be
  void remember(CheckpointData& memory) { memory(solution_.z); }  // the next guess

 private:
  void leave_out_immobile(SpatialMotion& motion);
  void formulate(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v);
  bool slide_off();
  double zero() const;
  bool doubtful() const;
  enum class Proof { none, immobile, paradox };  // immobile: of a combination that no force moves
  Proof proof() const;
  std::vector<Vector> all_of_one() const;
  bool find_all(const Eigen::VectorXd& free, std::vector<Vector>& different) const;
  Status examine(const Eigen::VectorXd& free);

  const SystemOf<Spatial>& system_;
  ContactEquationsOf<Spatial> equations_;
  Lcp lcp_;
  Solution solution_;
  Refinement refinement_;
  EvenShare even_share_;
  std::vector<int> contacts_;
  std::vector<ContactRowsOf<Spatial>> rows_;
  std::string why_;
  bool undecided_ = false;
};

}  // namespace orthant
