// Solvers of linear problems: orthant.solve, solve_many and methods written in Python, without the interpreter's lock.
#include "experiments/python/arrays.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"
#include "experiments/python/problem_arrays.h"
#include "experiments/python/results.h"

#include <orthant/solvers/registry.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace orthant::python {
namespace py = pybind11;
namespace {

double solve_timed(Solver& solver, const Lcp& problem, Solution& solution, Start start) {
  const auto begin = std::chrono::steady_clock::now();
  solver.solve(problem, solution, start);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// A method written in Python: function(problem, start) gives z; the judge decides, as of every method.
class CallbackSolver final : public Solver {
 public:
  CallbackSolver(const std::string& name, const py::function& function)
      : label_("solver '" + name + "': z"), function_(function) {}

 private:
  Claim run(const Lcp& problem, Solution& s, Start) override {
    const py::gil_scoped_acquire interpreter;
    const py::object z = function_(py::cast(Lcp(problem)), to_numpy(s.z));
    if (z.is_none()) return Claim::stalled;
    read(z, label_, problem.size(), Entries::any, s.z);
    s.iterations = 1;
    return Claim::candidate;
  }
  double tolerance() const override { return 1e-10; }

  std::string label_;
  const py::function& function_;  // of the registry, which keeps it
};

void register_callback(const std::string& name, const py::function& function, const std::string& summary) {
  const auto* kept = new py::function(function);  // as long as the process lives, longer than the interpreter
  const auto make_one = [kept, name](std::string_view options) -> std::unique_ptr<Solver> {
    if (!options.empty())
      throw std::invalid_argument("options '" + std::string(options) + "': a solver written in Python has none");
    return std::make_unique<CallbackSolver>(name, *kept);
  };
  register_solver(SolverEntry{name, summary, make_one, [] { return std::vector<OptionEntry>(); }});
}

/// Each of many problems by one of the threads, each with its own solver; answers do not depend on how many there are.
std::vector<Result> solve_many(const std::string& spec, const std::vector<py::tuple>& wanted, int threads,
                               std::optional<double> time_limit, const std::vector<py::object>& starts) {
  std::vector<Lcp> problems(wanted.size());
  std::vector<Solution> solutions(problems.size());
  std::vector<Start> from(problems.size(), Start::cold);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    try {
      const py::tuple& one = wanted[i];
      const bool again =
          i > 0 && py::object(one[0]).is(py::object(wanted[i - 1][0]));  // one matrix of all is read once
      if (py::isinstance<Lcp>(one[0]))
        problems[i] = py::cast<const Lcp&>(one[0]);
      else
        read_problem_into(problems[i], one[0], one[1], one[2], one[3], one[4], again ? &problems[i - 1].A : nullptr);
      if (!finite(problems[i])) throw std::invalid_argument("M and q must be finite");
      if (!starts.empty() && !starts[i].is_none()) {
        read(starts[i], "start", problems[i].size(), Entries::finite, solutions[i].z);
        from[i] = Start::warm;
      }
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("problem " + std::to_string(i) + ": " + error.what());
    }
  }
  const auto count = std::max<std::size_t>(1, std::min(problems.size(), static_cast<std::size_t>(threads)));
  std::vector<std::unique_ptr<Solver>> solvers;
  const Interruptible interruptible;
  for (std::size_t i = 0; i < count; ++i) {
    solvers.push_back(make_solver(spec));
    solvers.back()->set_time_limit(time_limit.value_or(kInf));
    solvers.back()->set_cancel(interruptible.flag());
  }
  std::vector<double> seconds(problems.size());
  std::vector<std::exception_ptr> thrown(count);
  {
    const py::gil_scoped_release others_may_run;
    const std::atomic<bool>* cancelled = interruptible.flag();
    std::atomic<std::size_t> next{0};
    const auto work = [&](std::size_t thread) {
      try {
        for (std::size_t i = next++; i < problems.size(); i = next++) {
          if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed)) return;
          seconds[i] = solve_timed(*solvers[thread], problems[i], solutions[i], from[i]);
        }
      } catch (...) {
        thrown[thread] = std::current_exception();
      }
    };
    std::vector<std::thread> others;
    for (std::size_t thread = 1; thread < count; ++thread) others.emplace_back(work, thread);
    work(0);
    for (std::thread& other : others) other.join();
  }
  interruptible.raise();
  for (const std::exception_ptr& error : thrown)
    if (error) std::rethrow_exception(error);
  std::vector<Result> results;
  for (std::size_t i = 0; i < problems.size(); ++i)
    results.push_back(result_of(problems[i], solutions[i], seconds[i],
                                solutions[i].status == Status::unsupported ? solvers.front()->refusal(problems[i]) : "",
                                {}));
  return results;
}

/// A registered solver with its own memory: the second problem of a size allocates nothing in it.
class PythonSolver {
 public:
  explicit PythonSolver(const std::string& spec) : spec_(spec), solver_(make_solver(spec)) {}
  const std::string& spec() const { return spec_; }

  Result solve(py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle friction, py::handle start,
               std::optional<double> time_limit, bool log) {
    const Busy busy(*this);
    const Lcp* problem = &problem_;
    if (py::isinstance<Lcp>(M)) {
      if (!q.is_none() || !lower.is_none() || !upper.is_none() || !friction.is_none())
        throw std::invalid_argument("a Problem holds q, bounds and friction itself: must be given alone");
      problem = &py::cast<const Lcp&>(M);
      if (!finite(*problem)) throw std::invalid_argument("problem: M and q must be finite");
    } else {
      read_problem_into(problem_, M, q, lower, upper, friction);
    }
    const bool warm = !start.is_none();
    if (warm) read(start, "start", problem->size(), Entries::finite, solution_.z);
    IterationLog entries;
    solver_->set_log(log ? &entries : nullptr);
    solver_->set_time_limit(time_limit.value_or(kInf));
    double seconds = 0;
    const Interruptible interruptible;
    solver_->set_cancel(interruptible.flag());
    {
      const py::gil_scoped_release others_may_run;
      seconds = solve_timed(*solver_, *problem, solution_, warm ? Start::warm : Start::cold);
    }
    solver_->set_log(nullptr);
    interruptible.raise();
    return result_of(*problem, solution_, seconds,
                     solution_.status == Status::unsupported ? solver_->refusal(*problem) : "", std::move(entries));
  }

 private:
  struct Busy {  // a solver's memory serves one thread at a time
    explicit Busy(PythonSolver& owner) : flag(owner.busy_) {
      if (flag) throw std::runtime_error("this Solver is at work in another thread: each thread needs its own");
      flag = true;
    }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;
    ~Busy() { flag = false; }
    bool& flag;  // read and written under the interpreter's lock
  };

  std::string spec_;
  std::unique_ptr<Solver> solver_;
  Lcp problem_;
  Solution solution_;
  bool busy_ = false;
};

}  // namespace

void add_solvers(py::module_& m) {
  py::class_<PythonSolver>(m, "_Solver")
      .def(py::init<const std::string&>())
      .def_property_readonly("spec", &PythonSolver::spec)
      .def("__reduce__",
           [](const py::object& self) {
             return py::make_tuple(py::type::of(self), py::make_tuple(self.cast<const PythonSolver&>().spec()));
           })
      .def("solve", &PythonSolver::solve);

  m.def("_solve_many", &solve_many);
  m.def("_register_solver", &register_callback);
  m.def("_solvers", [] {
    std::vector<std::tuple<std::string_view, std::string_view, std::string>> table;
    for (const SolverEntry& e : solvers()) table.emplace_back(e.name, e.summary, text_of(e.options()));
    return table;
  });
}

}  // namespace orthant::python
