#include <orthant/core/support/options.h>
#include <orthant/integrators/step/jam.h>
#include <orthant/integrators/step/no_solution_message.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

/// The contacts of which a proof u is made.
template <class Space>
std::vector<std::string> contacts_of_proof(const SystemOf<Space>& system, const std::vector<Pair>& pairs,
                                           const StepProblemOf<Space>& problem, const Vector& u) {
  const double least = kPartOfProof * u.lpNorm<Eigen::Infinity>();
  std::vector<std::string> names;
  problem.each_contact([&](Index i, Index edge, Index, const typename StepProblemOf<Space>::Contact& c) {
    const auto entries = u.segment(i, edge >= 0 ? StepProblemOf<Space>::kEdges : 1);
    if (entries.template lpNorm<Eigen::Infinity>() > least)
      names.push_back(contact_name<Space>(system, pairs, c.index));
  });
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string why_relaxed(const std::vector<std::string>& contacts, const std::string& when) {
  return "the relaxed friction cones of contacts " + joined(contacts) + " have no common velocity" + when +
         ": a contact that slides must open in this scheme; a shorter step, or a scheme with Coulomb's law, goes on";
}

std::string why_no_case(Index rows, const std::string& when) {
  return "friction leaves the step's problem of " + std::to_string(rows) + " rows without a solution" + when +
         " (every case of open, sticking and sliding contacts was tried): a shorter step, or another scheme, may go on";
}

}  // namespace

std::string why_unsolved(const System& system, const std::vector<Pair>& pairs, const StepProblem& problem,
                         const Solution& solution, const RankDeficiency& deficiency) {
  const std::string when = deficiency.time() ? " at t = " + detail::text_of(*deficiency.time()) + " s" : "";
  if (problem.no_normal() >= 0)
    return "contact " + contact_name<Planar>(system, pairs, problem.no_normal()) +
           " has no normal: its centres, or points, are in one place";
  const auto& u = solution.certificate.size() > 0 ? solution.certificate : solution.ray;
  const Status status = solution.status;
  if (status == Status::time_limit || status == Status::cancelled) return {};
  if (status == Status::infeasible && u.size() != problem.size()) return why_no_case(problem.size(), when);
  if (status != Status::infeasible)
    return "the solver ends the step's problem of " + std::to_string(problem.size()) + " rows as " +
           std::string(name(status)) + when + ", with a residual of " + detail::text_of(solution.residual) +
           (solution.miss.row >= 0 ? "; " + why(solution) : "") + ": try another solver or a shorter step";
  Jam jam;
  jam.contacts = contacts_of_proof<Planar>(system, pairs, problem, u);
  jam.joints = jam.contacts.empty();
  if ((deficiency.undecided() || deficiency.relaxed()) && !jam.joints) {
    if (deficiency.relaxed()) return why_relaxed(jam.contacts, when);
    return "rounding leaves undecided whether a motion satisfies contacts " + joined(jam.contacts) +
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
  if (status == Status::infeasible && solution.certificate.size() == 0) return why_no_case(problem.size(), when);
  if (deficiency.relaxed() && solution.certificate.size() == problem.size())
    return why_relaxed(contacts_of_proof<Spatial>(system, pairs, problem, solution.certificate), when);
  return "the solver ends the step's problem of " + std::to_string(problem.size()) + " rows as " +
         std::string(name(status)) + when + ", with a residual of " + detail::text_of(solution.residual) +
         ": try another solver or a shorter step";
}

template <class Space>
std::string why_no_impact(const SystemOf<Space>& system, const TermsOf<Space>& terms, const std::string& proof) {
  std::vector<std::string> rough;
  bool thrown = false;
  for (const auto& c : terms.closed) {
    thrown = thrown || system.law(c.contact).e > 0;
    if (system.law(c.contact).frictional()) rough.push_back(contact_name<Space>(system, terms.pairs, c.contact));
  }
  if (!rough.empty())
    return "friction jams contacts " + joined(rough) + (thrown ? ", which restitution throws apart" : "") +
           ": no impulse satisfies Newton's law and Coulomb's there";
  // Without friction only drives can leave no velocity.
  return proof.starts_with("jammed") ? proof : "jammed: contacts and drives leave no motion";
}
template std::string why_no_impact(const System&, const Terms&, const std::string&);
template std::string why_no_impact(const SystemOf<Spatial>&, const TermsOf<Spatial>&, const std::string&);

}  // namespace orthant
