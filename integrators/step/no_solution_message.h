// integrators/step/no_solution_message.h — message of a step's problem without a solution: the reason in words.
#pragma once

#include <orthant/integrators/step/spatial_rank_deficiency.h>

#include <string>

namespace orthant {

/// Why there is no solution: of which rows the proof is made (jam.h), what rounding leaves undecided, or which contact
/// has no normal. Empty: the solver ran out of time or was cancelled.
std::string why_unsolved(const System& system, const std::vector<Pair>& pairs, const StepProblem& problem,
                         const Solution& solution, const RankDeficiency& deficiency);

/// In space: the status, the contact that has no normal, or those with relaxed cones that contradict each other.
std::string why_unsolved(const SystemOf<Spatial>& system, const std::vector<Pair>& pairs,
                         const StepProblemOf<Spatial>& problem, const Solution& solution,
                         const SpatialRankDeficiency& deficiency);

/// Why an impact leaves no velocities, where a proof says so: friction contradicts restitution, or drives press. terms:
/// the contacts that strike; proof: Formulation::contradiction().
template <class Space>
std::string why_no_impact(const SystemOf<Space>& system, const TermsOf<Space>& terms, const std::string& proof);

}  // namespace orthant
