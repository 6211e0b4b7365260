// Sweeps from Python: the same files, cases and results as those of `orthant sweep`.
#include "experiments/python/module.h"

#include "experiments/sweep/run.h"

#include <orthant/core/support/options.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <set>

namespace orthant::python {
namespace py = pybind11;
namespace {

using Path = std::filesystem::path;

/// The sweep's name, how many cases it has, and the keys of those that the results lack.
py::tuple declare(const Path& file, bool quick, const Path& results, bool retry) {
  const Sweep sweep = read_sweep(file, quick);
  if (const Path folder = results.parent_path(); !folder.empty()) std::filesystem::create_directories(folder);
  Results kept(results);
  kept.declare(sweep, retry);
  std::vector<std::string> missing;
  for (const Case& c : sweep.cases)
    if (!kept.has(c.key())) missing.push_back(c.key());
  return py::make_tuple(sweep.name, sweep.cases.size(), missing);
}

/// All that is missing. Forks: for a process of its own, without threads. Functions of Python take the lock as they are
/// called, in the forks, too.
void run(const Path& file, bool quick, const Path& results, unsigned jobs) {
  const py::gil_scoped_release forks_may_take_it;
  const Sweep sweep = read_sweep(file, quick);
  Results kept(results);
  run_sweep(sweep, kept, results, jobs);
}

const Case& case_of(const Sweep& sweep, const Path& file, const std::string& key) {
  const auto c = std::find_if(sweep.cases.begin(), sweep.cases.end(), [&](const Case& x) { return x.key() == key; });
  if (c == sweep.cases.end())
    throw std::invalid_argument("case " + key + ": must be one of " + file.string() + " as this build (" + revision() +
                                ") sees it");
  return *c;
}

/// Scenes, integrators and solvers of all cases, by name.
std::set<std::pair<std::string, std::string>> names_in(const Path& file, bool quick) {
  std::set<std::pair<std::string, std::string>> names;
  for (const Case& c : read_sweep(file, quick).cases) {
    names.emplace("scene", c.scene);
    for (const std::string& spec : {c.integrator, c.reference})
      names.emplace("integrator", std::string(Spec::parse(spec).name));
    names.emplace("solver", std::string(Spec::parse(c.solver).name));
  }
  return names;
}

ResultRow run_in_this_process(const Case& c, std::optional<double> reference) {
  ResultRow row;
  {
    const py::gil_scoped_release others_may_run;
    row = run_case(c, reference);
  }
  if (row.at("why").is_string() && row.at("why").get<std::string>().starts_with("KeyboardInterrupt")) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  }
  return row;
}

/// One case, and what it is compared with if that is missing, in this process, which knows names that others do not.
void run_here(const Path& file, bool quick, const Path& results, const std::string& key) {
  const Sweep sweep = read_sweep(file, quick);
  const Case& c = case_of(sweep, file, key);
  Results kept(results);
  std::optional<double> reference;
  if (const auto other = c.reference_case()) {
    auto row = kept.find(other->key());
    if (!row) kept.add(row.emplace(run_in_this_process(*other, {})));
    reference = answer_of(*row);
  }
  kept.add(run_in_this_process(c, reference));
}

/// Forks, too.
std::vector<std::string> run_one(const Path& file, bool quick, const std::string& key) {
  const Sweep sweep = read_sweep(file, quick);
  const Case& c = case_of(sweep, file, key);
  std::vector<std::string> lines;
  for (const ResultRow& row : run_apart(c)) lines.push_back(row.dump());
  return lines;
}

std::vector<std::string> rows(const Path& results, const std::string& name) {
  std::vector<std::string> lines;
  for (const ResultRow& row : Results(results, Results::read_only).rows(name)) lines.push_back(row.dump());
  return lines;
}

}  // namespace

void add_sweeps(py::module_& m) {
  m.def("_declare_sweep", &declare);
  m.def("_run_sweep", &run);
  m.def("_run_case", &run_one);
  m.def("_run_case_here", &run_here);
  m.def("_names_in_sweep", &names_in);
  m.def("_keep_row", [](const Path& results, const std::string& row) { Results(results).add(ResultRow::parse(row)); });
  m.def("_sweep_rows", &rows);
}

}  // namespace orthant::python
