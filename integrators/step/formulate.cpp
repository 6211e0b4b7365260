#include <orthant/integrators/step/formulate.h>
#include <orthant/integrators/step/no_solution_message.h>
#include <orthant/solvers/proof/disc_cases.h>

namespace orthant {

template <class Space> FormulationOf<Space>::FormulationOf(const System& system, Form form, Cone cone)
    : system_(system), problem_(system, form, cone), islands_(system, problem_), deficiency_(system, form) {}

template <class Space> void FormulationOf<Space>::formulate(const Terms& terms, const BasicSystem& basic,
                                                            const std::vector<RateTarget>& targets,
                                                            const Eigen::VectorXd& v_free,
                                                            const Eigen::VectorXd& joint_rate) {
  if (problem_.empty(targets.size())) return problem_.clear_rows();  // most steps of most scenes
  terms_ = &terms;
  deficiency_.begin(terms);
  const auto collect = [&] {
    problem_.collect(terms, targets, deficiency_.held());
    islands_.sort(problem_);
    problem_.respond(basic);
  };
  collect();
  if (deficiency_.find(problem_)) collect();
  retarget(targets, v_free, joint_rate);
  if constexpr (!kPlanar<Space>) guess_.fit(problem_, terms, system_.listed(), solution_.z);
}

template <class Space>
bool FormulationOf<Space>::solve(Solver& solver, StepReport& report, SolverPool* pool, ClosedContacts* closed) {
  if (problem_.size() == 0) return true;
  if (problem_.no_normal() >= 0) {
    report.status = Status::numerical_error;
    return false;
  }
  constexpr int kPasses = 10;
  deficiency_.start_solving();
  bool elastic = friction_wins_;
  for (int pass = 1;; ++pass) {
    // Of contacts that static friction held, one that lets go may take others with it: exact motions ask again.
    const int grades = precise_ && !kPlanar<Space> ? kPasses : 1;
    bool solved = solve_once(solver, report, pool, closed), shared = solved && share_evenly(solver);
    for (int grade = 0; solved && grade < grades && problem_.regrade(solution_.z, solution_.w); ++grade)
      solved = solve_once(solver, report, pool, closed), shared = solved && share_evenly(solver);
    if (!deficiency_.give_way(problem_, solution_, solved, report)) {
      if (solved) {
        if (shared && even_share_.matters(problem_.whole(), solution_)) ++report.undetermined;
        return true;
      }
      const Status status = report.status;
      const bool tries = status == Status::infeasible || status == Status::stalled || status == Status::ray;
      if (elastic && tries && problem_.drop_restitution()) {
        elastic = false, ++report.plastic;
        continue;
      }
      if constexpr (!kPlanar<Space>)
        if (precise_ && (status == Status::stalled || status == Status::ray) && excludes_all_cases(problem_.whole())) {
          solution_.certificate.resize(0), solution_.ray.resize(0);
          solution_.status = report.status = Status::infeasible;
        }
      // Without a combination of rows that contradicts itself it is friction that leaves this step no solution. That
      // says nothing of the motion, which another step or scheme may find; of an exact motion it does.
      if (!precise_ && status == Status::infeasible && solution_.certificate.size() != problem_.size())
        report.status = Status::stalled;
      return false;
    }
    if (pass < kPasses) continue;
    if (!solved) deficiency_.note_undecided(), report.status = Status::numerical_error;
    return solved;
  }
}

/// Impulses that the rows leave open. False: they are not, or the answer stays as it is.
template <class Space> bool FormulationOf<Space>::share_evenly(Solver& solver) {
  if (kPlanar<Space> || !precise_ || problem_.whole().friction.empty()) return false;
  return even_share_.improve(problem_.whole(), std::ssize(problem_.contacts()), solver, solution_);
}

template <class Space> std::string FormulationOf<Space>::contradiction() const {
  return why_unsolved(system_, terms_->pairs, problem_, solution_, deficiency_);
}

template class FormulationOf<Planar>;
template class FormulationOf<Spatial>;

}  // namespace orthant
