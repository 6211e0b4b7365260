// integrators/step/spatial_rank_deficiency.h — rank deficiency of a step's problem in space: contacts that joints
// immobilise.
//
// No impulse moves what joints immobilise (spatial_immobility.h). Such a contact has no rows, and its rates are what
// the joints make them; where drives move it inwards the problem has no solution. One of which both tangents are
// immobile has no friction. Reduced form only, and contact by contact: combinations of contacts are left to the
// solver (rank_deficiency.h has them for the plane), but for relaxed cones: where a proof has edges of cones and its
// normals do not contradict the drives, the step stalls.
#pragma once

#include <orthant/integrators/step/rank_deficiency.h>
#include <orthant/integrators/step/spatial_immobility.h>

#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace orthant {

class SpatialRankDeficiency {
 public:
  using Terms = TermsOf<Spatial>;
  using StepProblem = StepProblemOf<Spatial>;
  SpatialRankDeficiency(const SystemOf<Spatial>& system, Form /*form*/) : system_(system) {}

  void anchor(double t, const Eigen::VectorXd& q, double ahead) { time_ = t, anchor_ = &q, ahead_ = ahead; }
  std::optional<double> time() const { return time_; }
  void begin(const Terms& terms) { terms_ = &terms, held_.clear(); }
  bool find(const StepProblem& problem);
  std::span<const Held> held() const { return held_; }
  void start_solving() { relaxed_ = false; }
  /// Never changes the problem; it tells whether the relaxation of cones is to blame: relaxed(), stalled.
  bool give_way(const StepProblem& problem, const Solution& solution, bool solved, StepReport& report);
  void note_undecided() {}
  bool relaxed() const { return relaxed_; }  // the relaxation of cones alone leaves the problem without a solution

 private:
  bool driven_inwards(const StepProblem::Contact& c);

  const SystemOf<Spatial>& system_;
  const Terms* terms_ = nullptr;
  std::optional<double> time_;
  const Eigen::VectorXd* anchor_ = nullptr;
  double ahead_ = 0;                             // [s]
  std::optional<SpatialImmobility> immobility_;  // from the first immobile contact of a driven scene, or proof, on
  std::vector<Held> held_;
  bool relaxed_ = false;
};

template <class Space> using RankDeficiencyOf =
    std::conditional_t<kPlanar<Space>, RankDeficiency, SpatialRankDeficiency>;

}  // namespace orthant
