#include "experiments/python/results.h"

#include "experiments/python/arrays.h"
#include "experiments/python/module.h"
#include "experiments/python/pickle.h"
#include "experiments/python/problem_arrays.h"

#include <orthant/core/lcp/judge/cell_words.h>
#include <orthant/core/lcp/judge/cells.h>
#include <orthant/core/lcp/judge/certify_cones.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace orthant::python {
namespace py = pybind11;
namespace {

/// What scipy.optimize calls things, for result["x"] and result.x alike.
constexpr std::array<const char*, 23> kResultKeys = {"status",
                                                     "solved",
                                                     "z",
                                                     "w",
                                                     "certificate",
                                                     "residual",
                                                     "residual_scale_free",
                                                     "residual_natural",
                                                     "rounding",
                                                     "iterations",
                                                     "factorizations",
                                                     "seconds",
                                                     "why_not",
                                                     "why",
                                                     "cells",
                                                     "cell_search",
                                                     "log",
                                                     "x",
                                                     "fun",
                                                     "success",
                                                     "message",
                                                     "nit",
                                                     "nfev"};

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

/// The search of all cells as `orthant solve --json` has it, or None.
py::object search_of(const Lcp& problem, const std::vector<Cell>& cells) {
  if (cells.empty()) return py::none();
  py::list classes;
  for (const Cell& cell : cells)
    classes.append(py::dict(py::arg("sides") = letters(cell), py::arg("expressed") = cell.expressed,
                            py::arg("why") = words_of(cell.why), py::arg("row") = cell.row));
  return py::dict(py::arg("count") = count_cells(problem), py::arg("order") = order_of_decision(problem),
                  py::arg("classes") = classes);
}

}  // namespace

std::string Result::repr() const {
  std::ostringstream text;
  text << "Result(status='" << status << "', z=" << few(z) << ", n=" << z.size() << ", residual=" << residual
       << ", iterations=" << iterations << ")";
  return text.str();
}

Result result_of(const Lcp& problem, const Solution& s, double seconds, std::string why_not,
                 std::vector<LogEntry> log) {
  py::object scale_free = py::none(), natural = py::none();
  if (problem.discs() && s.z.size() == problem.size() && s.z.allFinite()) {
    const ConeResiduals residuals = cone_residuals(problem, s.z);
    scale_free = py::float_(residuals.scale_free), natural = py::float_(residuals.natural);
  }
  return {std::string(name(s.status)),
          to_numpy(s.z),
          to_numpy(s.w),
          s.certificate.size() > 0 ? py::object(to_numpy(s.certificate)) : py::none(),
          s.residual,
          std::move(scale_free),
          std::move(natural),
          s.rounding,
          s.iterations,
          s.factorizations,
          seconds,
          std::move(why_not),
          why(s),
          s.cells.empty() ? 0.0 : count_cells(problem),
          search_of(problem, s.cells),
          std::move(log)};
}

/// One table of bindings with their documentation.
void add_results(py::module_& m) {
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
      .def_readonly("certificate", &Result::certificate,
                    "(n,) u that proves infeasibility, as it is or as the doubles nearest to an exact u, else None")
      .def_readonly("residual", &Result::residual, "how far a w_i is from what its z_i allows, at most; in units of w")
      .def_readonly("residual_scale_free", &Result::residual_scale_free,
                    "of friction discs: the same in any units of impulse, velocity or a single contact; else None")
      .def_readonly("residual_natural", &Result::residual_natural,
                    "of friction discs: the residual of the literature, which depends on units; else None")
      .def_readonly("rounding", &Result::rounding, "w cannot be known below this")
      .def_readonly("iterations", &Result::iterations, "pivots, Newton steps or sweeps, by the method")
      .def_readonly("factorizations", &Result::factorizations, "of a matrix, by the solver")
      .def_readonly("seconds", &Result::seconds, "wall time of the solver alone [s]")
      .def_readonly("why_not", &Result::why_not, "why the solver cannot take the problem (status 'unsupported')")
      .def_readonly("why", &Result::why, "in one line why the status is not 'solved', as far as z tells")
      .def_readonly("cells", &Result::cells,
                    "choices of sides searched, all without a solution, where that is the proof")
      .def_readonly(
          "cell_search", &Result::cell_search,
          "that proof: dict of count, order (rows) and classes, each with sides (a letter a row), expressed, why "
          "and row; else None")
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
                      &Result::residual_scale_free, &Result::residual_natural, &Result::rounding, &Result::iterations,
                      &Result::factorizations, &Result::seconds, &Result::why_not, &Result::why, &Result::cells,
                      &Result::cell_search, &Result::log>())
      .def("__repr__", &Result::repr);
}

}  // namespace orthant::python
