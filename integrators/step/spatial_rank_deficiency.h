// integrators/step/spatial_rank_deficiency.h — rank deficiency of a step's problem in space: contacts that joints
// immobilise.
//
// A contact of which joints leave less than 1e-12 of the effective inverse mass that it has without joints has no rows:
// no impulse moves it. One of which both tangents are immobile has no friction. Reduced form only, and contact by
// contact: combinations of contacts, and what drives do to them, are left to the solver (rank_deficiency.h has both for
// the plane).
#pragma once

#include <orthant/integrators/step/rank_deficiency.h>

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

  void anchor(double t, const Eigen::VectorXd& /*q*/) { time_ = t; }
  std::optional<double> time() const { return time_; }
  void begin(const Terms& terms) { terms_ = &terms, held_.clear(); }
  bool find(const StepProblem& problem);
  std::span<const Held> held() const { return held_; }
  void start_solving() {}
  bool give_way(StepProblem&, const Solution&, bool, StepReport&) { return false; }
  void note_undecided() {}

 private:
  const SystemOf<Spatial>& system_;
  const Terms* terms_ = nullptr;
  std::optional<double> time_;
  std::vector<Held> held_;
};

template <class Space> using RankDeficiencyOf =
    std::conditional_t<kPlanar<Space>, RankDeficiency, SpatialRankDeficiency>;

}  // namespace orthant
