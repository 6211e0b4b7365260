// Plugin `petsc`: the methods of distributed_newton.h in one process, as a solver among the others.
//   orthant --plugin build/release/petsc.so solve problem.json --solver petsc:method=semismooth
#include <orthant/solvers/distributed/distributed_newton.h>
#include <orthant/solvers/registry.h>

#include <mutex>

namespace orthant::distributed {
namespace {

class PetscSolver final : public Solver {
 public:
  using Options = NewtonOptions;
  explicit PetscSolver(const Options& options) : options_(options) {}
  std::string why_not(const Lcp& problem) const override {
    return problem.friction.empty() ? "" : "friction rows: the method needs bounds that do not depend on z";
  }

 private:
  Claim run(const Lcp& problem, Solution& s, Start start) override {
    if (problem.size() == 0) return Claim::candidate;
    static std::mutex one_at_a_time;  // PETSc has global state
    const std::lock_guard lock(one_at_a_time);
    try {
      const DistributedLcp rows = DistributedLcp::from(MPI_COMM_SELF, problem);
      DistributedNewton newton(rows, options_);
      newton.set_time_limit(budget().remaining());
      newton.set_cancel(budget().cancel());
      IterationLog entries;
      if (logging()) newton.set_log(&entries);
      NewtonSolution found;
      found.z = s.z;
      newton.solve(found, start == Start::warm);
      for (const LogEntry& entry : entries) log(entry.iteration, entry.merit, entry.step, entry.event.c_str());
      s.z = found.z;
      s.iterations = found.iterations;
      return claim_of(found.status);
    } catch (const PetscError& error) {
      log(s.iterations, 0, 0, error.what());
      return Claim::numerical_error;
    }
  }
  static Claim claim_of(Status status) {
    switch (status) {
      case Status::iteration_limit:
        return Claim::iteration_limit;
      case Status::time_limit:
        return Claim::time_limit;
      case Status::cancelled:
        return Claim::cancelled;
      default:
        return Claim::candidate;
    }
  }
  double tolerance() const override { return options_.tolerance; }
  Options options_;
};

}  // namespace
}  // namespace orthant::distributed

extern "C" void orthant_plugin() {
  orthant::register_solver<orthant::distributed::PetscSolver>(
      "petsc", "active set and semismooth Newton over PETSc's Krylov methods; sparse, boxes and free rows");
}
