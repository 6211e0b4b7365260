// integrators/step/jam.h — jam detection and message: no position satisfies joints, drives and contacts any more.
//
//   Least overlap at the time t, near q:  min ½ Σ o_i²,  o_i = max(0, f_i − g_i(q)),  with Φ(q, t) = 0.
//   Levenberg–Marquardt steps in the metric of M, ε raised until the overlap falls, B the inverse mass with joints:
//     0 ≤ μ ⊥ (W B Wᵀ + ε) μ + g − f ≥ 0,   q ← q + B Wᵀ μ (move() of blocks.h),   then onto the joints
//     (projection.h).
//   f_i ≤ 0 is the contact's gap at the start of the run if bodies overlap there, else 0.
//   A least overlap beyond rounding is a jam. There Wᵀ o = Gᵀ λ: contacts with o > 0 and drives with λ ≠ 0 take part.
//   The search starts at the last good state. Its steps double while positions exist, and shrink where none exists or
//   where a body moves by more than its radius of gyration or turns by more than 0.1 rad in one.
//   Friction is left out. Where it alone holds a mechanism, the problem of the step has no solution (formulate.h).
// Cost: about 10 factorizations per position, about 50 positions, and one per 0.08 rad of turning, up to 20 000.
// Only after a failed step or where bodies overlap, and by `orthant check`.
// Source: Nocedal & Wright, Numerical Optimization (2006), ch. 10 and 18.
#pragma once

#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/integrators/step/projection.h>
#include <orthant/solvers/pivoting/lemke.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace orthant {

struct Jam {
  double since = kInf;                        // [s]; infinity: not known
  std::vector<std::string> drives, contacts;  // in the jam, quoted
  bool joints = false;                        // true: no position of the joints alone follows the drives
};

/// The message of all integrators: `jammed: drive "motor", contacts "B" and "stop" leave no motion; since t = 0.2`.
std::string words(const Jam& jam);
/// The end of that sentence.
std::string since(double t);

/// A contact's name in quotes; of a searched pair its collision and bodies.
template <class Space>
std::string contact_name(const SystemOf<Space>& system, std::span<const Pair> pairs, int contact);

template <class Space> class JamSearchOf {
 public:
  using System = SystemOf<Space>;
  explicit JamSearchOf(const System& system);

  /// First time after x.t, up to `until` [s], from which on no position near x.q exists. If none exists at x.t, an
  /// earlier time. Empty: positions exist until then, or no drive takes part.
  std::optional<Jam> find(const State& x, double until);

  /// [s] up to where the last find() knows positions: less than `until` where motions are too long to follow.
  double looked_until() const { return looked_until_; }

  /// True: a position near q satisfies all constraints at the time t. q becomes this position.
  bool fits(double t, Eigen::VectorXd& q);

 private:
  bool onto_joints(double t, Eigen::VectorXd& q);
  double overlap();                                // ½ Σ o²; worst_, at terms_
  double allowed(const Eigen::VectorXd& q) const;  // [m] overlap that is rounding
  bool linearize();
  bool improve(double t, Eigen::VectorXd& q, double& sum);
  Jam participants(double t);
  double way(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;

  System system_;  // the scene's bodies with masses of 1: places do not depend on them
  TermsOf<Space> terms_;
  BroadPhaseOf<Space> broad_phase_;
  ProjectionOf<Space> projection_;
  BasicSystemOf<Space> basic_;
  Lemke solver_;
  Eigen::VectorXd floor_;  // f, one per listed contact; 0 of searched pairs
  Eigen::VectorXd over_, trial_, force_, change_, lambda_;
  Eigen::MatrixXd columns_;  // B Wᵀ of the contacts nearby
  Lcp lcp_;
  Solution solution_;
  double worst_ = 0;       // [m, rad] the largest overlap
  double compliance_ = 0;  // ε over the largest W B Wᵀ
  bool joints_off_ = false;
  double looked_until_ = 0;
};
extern template class JamSearchOf<Planar>;
extern template class JamSearchOf<Spatial>;
using JamSearch = JamSearchOf<Planar>;

}  // namespace orthant
