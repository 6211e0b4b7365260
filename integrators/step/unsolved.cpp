#include <orthant/core/support/options.h>
#include <orthant/integrators/step/jam.h>
#include <orthant/integrators/step/unsolved.h>

#include <cmath>

namespace orthant {

std::string why_unsolved(const System& system, const std::vector<Pair>& pairs, const StepProblem& problem,
                         const Solution& solution, const RankDeficiency& deficiency) {
  const std::string when = deficiency.time() ? " at t = " + detail::text_of(*deficiency.time()) + " s" : "";
  if (problem.no_normal() >= 0)
    return "contact " + contact_name<Planar>(system, pairs, problem.no_normal()) +
           " has no normal: its centres, or points, are in one place";
  const auto& u = solution.certificate.size() > 0 ? solution.certificate : solution.ray;
  const Status status = solution.status;
  if (status == Status::time_limit || status == Status::cancelled) return {};
  if (status == Status::infeasible && u.size() != problem.size())
    return "friction leaves the step's problem of " + std::to_string(problem.size()) + " rows without a solution" +
           when +
           " (every case of open, sticking and sliding contacts was tried): a shorter step, or another scheme, may go "
           "on";
  if (status != Status::infeasible)
    return "the solver ends the step's problem of " + std::to_string(problem.size()) + " rows as " +
           std::string(name(status)) + when + ", with a residual of " + detail::text_of(solution.residual) +
           (solution.miss.row >= 0 ? "; " + why(solution) : "") + ": try another solver or a shorter step";
  const double least = kPartOfProof * u.lpNorm<Eigen::Infinity>();
  Jam jam;
  problem.each_contact([&](Index i, Index edge, Index, const StepProblem::Contact& c) {
    if (std::abs(u[i]) > least || (edge >= 0 && std::abs(u[edge]) > least))
      jam.contacts.push_back(contact_name<Planar>(system, pairs, c.index));
  });
  jam.joints = jam.contacts.empty();
  if ((deficiency.undecided() || deficiency.relaxed()) && !jam.joints) {
    std::string names;
    for (const std::string& name : jam.contacts) names += (names.empty() ? "" : ", ") + name;
    if (deficiency.relaxed())
      return "the relaxed friction cones of contacts " + names + " have no common velocity" + when +
             ": a contact that slides must open in this scheme; a shorter step, or a scheme with Coulomb's law, "
             "goes on";
    return "rounding leaves undecided whether a motion satisfies contacts " + names +
           (system.joint_rows() > 0 ? " together with the joints" : " together");
  }
  return words(jam);
}

std::string why_unsolved(const SystemOf<Spatial>& system, const std::vector<Pair>& pairs,
                         const StepProblemOf<Spatial>& problem, const Solution& solution,
                         const SpatialRankDeficiency& deficiency) {
  const std::string when = deficiency.time() ? " at t = " + detail::text_of(*deficiency.time()) + " s" : "";
  if (problem.no_normal() >= 0)
    return "contact " + contact_name<Spatial>(system, pairs, problem.no_normal()) +
           " has no normal: its centres, or points, are in one place";
  const Status status = solution.status;
  if (status == Status::time_limit || status == Status::cancelled) return {};
  return "the solver ends the step's problem of " + std::to_string(problem.size()) + " rows as " +
         std::string(name(status)) + when + ", with a residual of " + detail::text_of(solution.residual) +
         ": try another solver or a shorter step";
}

}  // namespace orthant
