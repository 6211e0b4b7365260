// Linear problems: the caller's arrays are read into the solver's own memory, solved without the interpreter's lock.
#include "experiments/python/arrays.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"
#include "experiments/python/pickle.h"

#include "experiments/runs/problem_file.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/lcp/judge/active_set.h>
#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/judge/error_bound.h>
#include <orthant/core/support/file.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/registry.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <sstream>
#include <thread>

namespace orthant::python {
namespace py = pybind11;
namespace {

void read_friction(py::handle from, std::vector<Friction>& to) {
  to.clear();
  if (from.is_none()) return;
  const auto wrong = [&](const std::string& place) {
    throw py::type_error(place +
                         ": must be (row, normal row, mu) triples, such as [(1, 0, 0.3)], or a (k, 3) array; a disc " +
                         "of two rows is (first row, normal row, mu, 2)");
  };
  if (!py::isinstance<py::iterable>(from)) wrong("friction");
  for (const py::handle entry : from) {
    const std::string place = "friction[" + std::to_string(to.size()) + "]";
    try {
      const auto f = entry.cast<std::vector<double>>();  // of an array the rows' numbers are no integers
      if (f.size() != 3 && f.size() != 4) wrong(place);
      for (const double row : {f[0], f[1]})
        if (!(std::abs(row) < 1e9 && row == std::floor(row)))
          throw std::invalid_argument(place + " = " + py::str(entry).cast<std::string>() +
                                      ": must begin with the numbers of two rows");
      const double rows = f.size() == 4 ? f[3] : 1;
      if (rows != 1 && rows != 2)
        throw std::invalid_argument(place + " = " + py::str(entry).cast<std::string>() +
                                    ": must end with 1 (interval) or 2 (disc)");
      to.push_back({.normal = static_cast<Index>(f[1]),
                    .first = static_cast<Index>(f[0]),
                    .rows = static_cast<Index>(rows),
                    .mu = f[2]});
    } catch (const py::cast_error&) {
      wrong(place);
    }
  }
}

/// A bound of all rows, one entry a row or one number for all but friction rows, which have no bounds of their own.
/// None: `otherwise`.
void read_bound(py::handle from, std::string_view name, double otherwise, double none, const Lcp& problem, Index n,
                Vector& to) {
  const bool one = from.is_none() || py::isinstance<py::float_>(from) || py::isinstance<py::int_>(from) ||
                   (py::hasattr(from, "ndim") && from.attr("ndim").cast<int>() == 0);
  if (!one) return read(from, name, n, Entries::numbers, to);
  double bound = otherwise;
  if (!from.is_none()) {
    py::list alone;
    alone.append(from);
    Vector value;
    read(alone, name, 1, Entries::numbers, value);
    bound = value[0];
  }
  to = Eigen::VectorXd::Constant(n, bound);
  for (const Friction& f : problem.friction)
    for (Index row = f.first; row < f.first + f.rows; ++row)
      if (row >= 0 && row < n) to[row] = none;
}

/// M, q, lower, upper, friction of the Python side; None: 0 for lower, ∞ for upper, no friction. A: M, read before.
void read_problem_into(Lcp& to, py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle friction,
                       const Matrix* A = nullptr) {
  if (A != nullptr)
    to.A = *A;
  else
    read(M, "M", to.A);
  const Index n = order(to.A);
  if (q.is_none()) throw py::type_error("q is missing: must be (" + std::to_string(n) + ",), or M a Problem");
  read(q, "q", n, Entries::finite, to.b);
  read_friction(friction, to.friction);
  read_bound(lower, "lower", 0, -kInf, to, n, to.lo);
  read_bound(upper, "upper", kInf, kInf, to, n, to.hi);
  check(to);
}

/// "[1.5, 0, 2.25]", of many entries the first and the last three.
std::string few(const py::array_t<double>& x) {
  constexpr py::ssize_t kEnd = 3, kMost = 2 * kEnd + 2;
  std::ostringstream text;
  text << '[';
  for (py::ssize_t i = 0; i < x.size(); ++i) {
    if (x.size() > kMost && i == kEnd) text << ", ...", i = x.size() - kEnd;
    text << (i > 0 ? ", " : "") << x.at(i);
  }
  text << ']';
  return text.str();
}

struct Result {
  std::string status;
  py::array_t<double> z, w;
  py::object certificate;
  double residual, rounding;
  int iterations;
  long factorizations;
  double seconds;
  std::string why_not, why;
  double cells;
  std::vector<LogEntry> log;

  bool solved() const { return status == name(Status::solved); }
  std::string repr() const {
    std::ostringstream text;
    text << "Result(status='" << status << "', z=" << few(z) << ", n=" << z.size() << ", residual=" << residual
         << ", iterations=" << iterations << ")";
    return text.str();
  }
};

Result result_of(const Lcp& problem, const Solution& s, double seconds, std::string why_not,
                 std::vector<LogEntry> log) {
  return {std::string(name(s.status)),
          to_numpy(s.z),
          to_numpy(s.w),
          s.certificate.size() > 0 ? py::object(to_numpy(s.certificate)) : py::none(),
          s.residual,
          s.rounding,
          s.iterations,
          s.factorizations,
          seconds,
          std::move(why_not),
          why(s),
          s.cells.empty() ? 0.0 : count_cells(problem),
          std::move(log)};
}

/// What scipy.optimize calls things, for result["x"] and result.x alike.
constexpr std::array<const char*, 20> kResultKeys = {
    "status",         "solved",  "z",       "w",   "certificate", "residual", "rounding", "iterations",
    "factorizations", "seconds", "why_not", "why", "cells",       "log",      "x",        "fun",
    "success",        "message", "nit",     "nfev"};

bool is_result_key(py::handle key) {  // any object may be a key, as in a dict
  return py::isinstance<py::str>(key) &&
         std::find(kResultKeys.begin(), kResultKeys.end(), key.cast<std::string>()) != kResultKeys.end();
}
std::vector<std::string> result_keys() { return {kResultKeys.begin(), kResultKeys.end()}; }

std::string message_of(const Result& r) {
  std::ostringstream text;
  if (r.solved())
    text << "solved: the judge accepts z, residual " << r.residual;
  else
    text << r.status << (r.why_not.empty() && r.why.empty() ? "" : ": ") << r.why_not << r.why;
  return text.str();
}

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

py::object verdict(Verdict v) {
  return v == Verdict::not_decided ? py::none() : py::object(py::bool_(v == Verdict::yes));
}

py::dict analysis_of(py::handle M, std::optional<double> time_limit) {
  Matrix A;
  if (py::isinstance<Lcp>(M))
    A = py::cast<const Lcp&>(M).A;
  else
    read(M, "M", A);
  Analysis a;
  Watch watch(time_limit);
  {
    const py::gil_scoped_release others_may_run;
    a = analyse(A, watch.stop(), time_limit.value_or(kInf));
  }
  watch.raise();
  py::dict d;
  d["n"] = a.n;
  d["symmetric"] = verdict(a.symmetric);
  d["positive_definite"] = verdict(a.positive_definite);
  d["positive_semidefinite"] = verdict(a.positive_semidefinite);
  d["diagonally_dominant"] = verdict(a.diagonally_dominant);
  d["z"] = verdict(a.z);
  d["k"] = verdict(a.k);
  d["h_plus"] = verdict(a.h_plus);
  d["p"] = verdict(a.p);
  d["p0"] = verdict(a.p0);
  d["copositive"] = verdict(a.copositive);
  d["column_sufficient"] = verdict(a.column_sufficient);
  d["row_sufficient"] = verdict(a.row_sufficient);
  d["rank"] = a.rank < 0 ? py::none() : py::object(py::int_(a.rank));
  d["smallest"] = a.smallest;
  d["largest"] = a.largest;
  d["condition"] = a.condition;
  d["not_p"] = a.not_p;
  return d;
}

py::list arrays(const std::vector<Vector>& vectors) {
  py::list list;
  for (const Vector& x : vectors) list.append(to_numpy(x));
  return list;
}

struct Face {
  Index dimension;
  py::list vertices, directions, lines;

  std::string repr() const {
    return "Face(dimension=" + std::to_string(dimension) + ", vertices=" + std::to_string(vertices.size()) +
           ", directions=" + std::to_string(directions.size()) + ", lines=" + std::to_string(lines.size()) + ")";
  }
};
struct Solutions {
  py::list isolated;
  std::vector<Face> faces;
  bool complete;

  std::string repr() const {
    constexpr std::size_t kMost = 4;
    std::ostringstream text;
    text << "Solutions(isolated=[";
    for (std::size_t i = 0; i < std::min(kMost, isolated.size()); ++i)
      text << (i > 0 ? ", " : "") << few(isolated[i].cast<py::array_t<double>>());
    if (isolated.size() > kMost) text << ", ... " << isolated.size() << " in all";
    text << "], faces=[";
    for (std::size_t i = 0; i < std::min(kMost, faces.size()); ++i) text << (i > 0 ? ", " : "") << faces[i].repr();
    if (faces.size() > kMost) text << ", ... " << faces.size() << " in all";
    text << "], complete=" << (complete ? "True" : "False") << ")";
    return text.str();
  }
};

Solutions all_solutions(const Lcp& problem, std::optional<double> time_limit) {
  SolutionSet set;
  Watch watch(time_limit);
  {
    const py::gil_scoped_release others_may_run;
    set = enumerate_solutions(problem, watch.stop());
  }
  watch.raise();
  Solutions all{arrays(set.isolated), {}, set.complete};
  for (const SolutionFace& f : set.faces)
    all.faces.push_back({f.dimension, arrays(f.vertices), arrays(f.directions), arrays(f.lines)});
  return all;
}

/// (row, normal row, mu), with discs all with the number of rows behind.
py::list friction_of(const Lcp& p) {
  py::list list;
  const bool discs = p.discs();
  for (const Friction& f : p.friction)
    discs ? list.append(py::make_tuple(f.first, f.normal, f.mu, f.rows))
          : list.append(py::make_tuple(f.first, f.normal, f.mu));
  return list;
}

py::tuple problem_state(const Lcp& p) {
  return py::make_tuple(to_python(p.A), to_numpy(p.b), to_numpy(p.lo), to_numpy(p.hi), friction_of(p));
}

std::unique_ptr<Lcp> problem_of(const py::tuple& state) {
  if (state.size() != 5) throw py::value_error("pickle: is of another version");
  auto p = std::make_unique<Lcp>();  // one that a failed step left may hold anything
  read(state[0], "M", p->A, Entries::any);
  read(state[1], "q", order(p->A), Entries::any, p->b);
  read(state[2], "lower", order(p->A), Entries::numbers, p->lo);
  read(state[3], "upper", order(p->A), Entries::numbers, p->hi);
  read_friction(state[4], p->friction);
  check(*p);
  return p;
}

}  // namespace

/// One table of bindings with their documentation.
void add_problems(py::module_& m) {
  py::class_<Lcp>(m, "Problem",
                  "A problem kept: z in [lower, upper] with w = M z + q, row by row complementary.\n\n"
                  "friction: list of (row, normal row, mu): |z[row]| <= mu z[normal]; (first row, normal row, mu, 2): "
                  "a disc of two rows. bounds: in place of lower and upper, as in `solve`.")
      .def(py::init([](py::handle M, py::handle q, py::object lower, py::object upper, py::handle friction,
                       const py::object& bounds) {
             auto lcp = std::make_unique<Lcp>();
             if (!bounds.is_none()) {
               const py::tuple both = py::module_::import("orthant._problems").attr("_bounds")(bounds, lower, upper);
               lower = both[0], upper = both[1];
             }
             read_problem_into(*lcp, M, q, lower, upper, friction);
             return lcp;
           }),
           py::arg("M"), py::arg("q") = py::none(), py::arg("lower") = py::none(), py::arg("upper") = py::none(),
           py::arg("friction") = py::none(), py::kw_only(), py::arg("bounds") = py::none())
      .def(py::init([](const py::args&, const py::kwargs&) -> std::unique_ptr<Lcp> {  // where the other does not fit
        throw py::type_error(
            "Problem: must be given M, q and, if need be, lower, upper, friction or bounds, nothing else");
      }))
      .def(py::pickle(&problem_state, &problem_of))
      .def_property_readonly(
          "M", [](const Lcp& p) { return to_python(p.A); }, "(n, n) array, scipy.sparse matrix or Delassus, a copy")
      .def_property_readonly(
          "q", [](const Lcp& p) { return to_numpy(p.b); }, "(n,)")
      .def_property_readonly(
          "lower", [](const Lcp& p) { return to_numpy(p.lo); }, "(n,), -inf: no bound")
      .def_property_readonly(
          "upper", [](const Lcp& p) { return to_numpy(p.hi); }, "(n,), inf: no bound")
      .def_property_readonly("friction", &friction_of, "list of (row, normal row, mu), discs with 2 behind")
      .def("__len__", &Lcp::size)
      .def("__repr__", [](const Lcp& p) { return "Problem(n=" + std::to_string(p.size()) + ")"; });

  py::class_<LogEntry>(m, "LogEntry", "What a solver did: iteration, merit, step, and in words where there are some.")
      .def_readonly("iteration", &LogEntry::iteration, "which one")
      .def_readonly("merit", &LogEntry::merit, "what the method drives to zero, in its own measure")
      .def_readonly("step", &LogEntry::step, "length of the step taken, 0 where there is none")
      .def_readonly("event", &LogEntry::event, "in words, where there are some")
      .def(by_members<LogEntry, &LogEntry::iteration, &LogEntry::merit, &LogEntry::step, &LogEntry::event>())
      .def("__repr__", [](const LogEntry& e) {
        return "LogEntry(iteration=" + std::to_string(e.iteration) + ", event='" + e.event + "')";
      });

  py::class_<Result>(m, "Result",
                     "What a solver gives back; `status` is 'solved' or 'rounded' only where the judge accepted z.")
      .def_readonly("status", &Result::status,
                    "'solved', 'rounded', 'infeasible', 'iteration_limit', ...: statuses in the documentation")
      .def_property_readonly("solved", &Result::solved, "status is 'solved': the judge accepted z")
      .def_readonly("z", &Result::z, "(n,) the solution, or the last z")
      .def_readonly("w", &Result::w, "(n,) M z + q, recomputed")
      .def_readonly("certificate", &Result::certificate, "(n,) u that proves infeasibility, else None")
      .def_readonly("residual", &Result::residual, "how far a w_i is from what its z_i allows, at most; in units of w")
      .def_readonly("rounding", &Result::rounding, "w cannot be known below this")
      .def_readonly("iterations", &Result::iterations, "pivots, Newton steps or sweeps, by the method")
      .def_readonly("factorizations", &Result::factorizations, "of a matrix, by the solver")
      .def_readonly("seconds", &Result::seconds, "wall time of the solver alone [s]")
      .def_readonly("why_not", &Result::why_not, "why the solver cannot take the problem (status 'unsupported')")
      .def_readonly("why", &Result::why, "in one line why the status is not 'solved', as far as z tells")
      .def_readonly("cells", &Result::cells,
                    "choices of sides searched, all without a solution, where that is the proof")
      .def_readonly("log", &Result::log, "list of LogEntry, if requested")
      .def_readonly("x", &Result::z, "z, as scipy.optimize calls it")
      .def_property_readonly("success", &Result::solved, "solved, as scipy.optimize calls it")
      .def_readonly("fun", &Result::w, "w = M z + q, the function's values, as scipy.optimize calls them")
      .def_readonly("nit", &Result::iterations, "iterations, as scipy.optimize calls it")
      .def_readonly("nfev", &Result::factorizations, "factorizations: the evaluations that cost, of a linear problem")
      .def_property_readonly("message", &message_of, "the outcome in words")
      .def(
          "keys", [](const Result&) { return result_keys(); }, "the names of what result[name] has")
      .def(
          "values",
          [](const py::object& self) {
            py::list values;
            for (const char* key : kResultKeys) values.append(self.attr(key));
            return values;
          },
          "in the order of keys()")
      .def(
          "items",
          [](const py::object& self) {
            py::list items;
            for (const char* key : kResultKeys) items.append(py::make_tuple(key, self.attr(key)));
            return items;
          },
          "(name, value) in the order of keys()")
      .def(
          "get",
          [](const py::object& self, py::handle key, const py::object& otherwise) -> py::object {
            return is_result_key(key) ? py::object(self.attr(key)) : otherwise;
          },
          py::arg("key"), py::arg("default") = py::none(), "result[key], or default where there is no such name")
      .def("__iter__", [](const Result&) { return py::iter(py::cast(result_keys())); })
      .def("__len__", [](const Result&) { return kResultKeys.size(); })
      .def("__contains__", [](const Result&, py::handle key) { return is_result_key(key); })
      .def("__getitem__",
           [](const py::object& self, py::handle key) -> py::object {
             if (is_result_key(key)) return self.attr(key);
             std::string known;
             for (const char* one : kResultKeys) known += (known.empty() ? "" : ", ") + std::string(one);
             throw py::key_error(py::str(key).cast<std::string>() + ": must be one of " + known);
           })
      .def(by_members<Result, &Result::status, &Result::z, &Result::w, &Result::certificate, &Result::residual,
                      &Result::rounding, &Result::iterations, &Result::factorizations, &Result::seconds,
                      &Result::why_not, &Result::why, &Result::cells, &Result::log>())
      .def("__repr__", &Result::repr);

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
  m.def("_analyse", &analysis_of);

  py::class_<Face>(m, "Face", "The hull of `vertices`, plus nonnegative multiples of `directions`, any of `lines`.")
      .def_readonly("dimension", &Face::dimension, "1: a segment or ray, 2: a polygon, ...")
      .def_readonly("vertices", &Face::vertices, "list of (n,)")
      .def_readonly("directions", &Face::directions, "list of (n,)")
      .def_readonly("lines", &Face::lines, "list of (n,)")
      .def(by_members<Face, &Face::dimension, &Face::vertices, &Face::directions, &Face::lines>())
      .def("__repr__", &Face::repr);
  py::class_<Solutions>(m, "Solutions", "All solutions: isolated points and maximal faces.")
      .def_readonly("isolated", &Solutions::isolated, "list of (n,): solutions without others next to them")
      .def_readonly("faces", &Solutions::faces, "list of Face: maximal ones")
      .def_readonly("complete", &Solutions::complete, "False: the time was over; there may be more")
      .def(by_members<Solutions, &Solutions::isolated, &Solutions::faces, &Solutions::complete>())
      .def("__repr__", &Solutions::repr);
  m.def("_enumerate", &all_solutions);
  m.def("_error_bound", [](const Lcp& p, py::handle z, std::optional<double> time_limit) {
    Vector x;
    read(z, "z", p.size(), Entries::finite, x);
    Watch watch(time_limit);
    double bound = kInf;
    {
      const py::gil_scoped_release others_may_run;
      bound = error_bound(p, x, watch.stop());
    }
    watch.raise();
    return bound;
  });

  m.def("_read_problem", &read_problem_file);
  m.def("_set_largest_input", &set_largest_input);
  m.def("_largest_input", &largest_input);
  m.def("_check_size", &check_size);
  m.def("_write_fclib", [](const std::filesystem::path& file, const Lcp& p, int dimension, const std::string& title,
                           const std::string& description) {
    const Index friction = static_cast<Index>(p.friction.size());
    write_fclib(file, {p, dimension, dimension == 5 ? friction / 2 : friction, title, description});
  });
  m.def("_write_problem",
        [](const std::filesystem::path& file, const Lcp& p, const std::string& note) { write_problem(file, p, note); });
}

}  // namespace orthant::python
