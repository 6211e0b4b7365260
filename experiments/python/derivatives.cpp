// Derivatives of solutions: orthant._Sensitivity, wrapped by orthant/_derivatives.py.
#include "experiments/python/arrays.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"

#include "experiments/runs/run_gradient.h"

#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <pybind11/stl.h>

#include <stdexcept>

namespace orthant::python {
namespace py = pybind11;
namespace {

Status status_named(const std::string& word) {
  for (const Status s : {Status::solved, Status::rounded, Status::infeasible, Status::ray, Status::iteration_limit,
                         Status::time_limit, Status::cancelled, Status::stalled, Status::unsupported})
    if (name(s) == word) return s;
  return Status::numerical_error;
}

class PythonSensitivity {
 public:
  PythonSensitivity(const Lcp& problem, const std::string& status, py::handle z, py::handle w, double residual,
                    double rounding)
      : of_(made(problem, status, z, w, residual, rounding)) {}

  py::tuple tangent(py::handle dM, py::handle dq, py::handle dlo, py::handle dhi, py::handle dmu,
                    bool one_sided) const {
    Perturbation change;
    if (!dM.is_none()) {
      Matrix A;
      read(dM, "dM", A);
      change.A = std::move(A);
    }
    const auto part = [&](py::handle from, const char* label, Index n, Vector& to) {
      if (!from.is_none()) read(from, label, n, Entries::finite, to);
    };
    const Index n = of_.problem().size();
    part(dq, "dq", n, change.b), part(dlo, "dlo", n, change.lo), part(dhi, "dhi", n, change.hi);
    part(dmu, "dmu", static_cast<Index>(of_.problem().friction.size()), change.mu);
    SolutionTangent t;
    {
      const py::gil_scoped_release others_may_run;
      t = one_sided ? of_.directional(change) : of_.jvp(change);
    }
    return py::make_tuple(to_numpy(t.z), to_numpy(t.w), t.consistent);
  }

  py::tuple vjp(py::handle g, py::handle h) const {
    Vector of_z, of_w;
    read(g, "g", of_.problem().size(), Entries::finite, of_z);
    if (!h.is_none()) read(h, "h", of_.problem().size(), Entries::finite, of_w);
    const DataGradient back = of_.vjp(of_z, of_w);
    return py::make_tuple(to_python(gradient_of_matrix(of_, back)), to_numpy(back.b), to_numpy(back.lo),
                          to_numpy(back.hi), to_numpy(back.mu), back.consistent);
  }

  const SensitivityReport& report() const { return of_.report(); }

 private:
  static Sensitivity made(const Lcp& problem, const std::string& status, py::handle z, py::handle w, double residual,
                          double rounding) {
    Solution s;
    s.status = status_named(status), s.residual = residual, s.rounding = rounding;
    read(z, "result.z", problem.size(), Entries::any, s.z);
    read(w, "result.w", problem.size(), Entries::any, s.w);
    const py::gil_scoped_release others_may_run;
    return {problem, s};
  }

  Sensitivity of_;
};

py::array_t<double> table_of_rows(const std::vector<double>& numbers, std::vector<py::ssize_t> shape) {
  return py::array_t<double>(std::move(shape), numbers.data());
}

py::list degenerate_of(const AnyScene& scene, const std::vector<DegenerateStep>& steps) {
  py::list degenerate;
  for (const DegenerateStep& one : steps) {
    py::list names;
    for (const int contact : one.contacts) names.append(name_of_contact(scene, contact));
    degenerate.append(py::make_tuple(one.t, names));
  }
  return degenerate;
}

/// Without step or duration: the scene's.
Clock clock_of(const AnyScene& scene, std::optional<double> step, std::optional<double> duration, long every,
               const std::atomic<bool>* cancel = nullptr) {
  return {.step = step.value_or(step_of(scene)),
          .duration = duration.value_or(duration_of(scene)),
          .every = every,
          .cancel = cancel};
}

/// t, values (rows × columns), derivatives (rows × columns × parameters), status, why, degenerate steps, inconsistent,
/// warnings.
py::tuple gradient(const std::optional<std::string>& text, const std::string& scene_name,
                   const std::vector<std::string>& sets, const std::vector<std::string>& of,
                   const std::vector<std::string>& wrt, const std::string& integrator, const std::string& solver,
                   std::optional<double> step, std::optional<double> duration, long every) {
  const SceneSource source{text, scene_name, sets};
  const AnyScene scene = source.make();
  const auto method = make_solver(solver);
  const Interruptible interruptible;
  const Clock clock = clock_of(scene, step, duration, every, interruptible.flag());
  GradientOfRun found;
  {
    const py::gil_scoped_release others_may_run;
    found = gradient_of_run(source, of, wrt, integrator, *method, clock);
  }
  interruptible.raise();
  const auto rows = static_cast<py::ssize_t>(found.t.size()), columns = static_cast<py::ssize_t>(of.size());
  return py::make_tuple(table_of_rows(found.t, {rows}), table_of_rows(found.value, {rows, columns}),
                        table_of_rows(found.by, {rows, columns, static_cast<py::ssize_t>(wrt.size())}),
                        std::string(name(found.tangent.run.status)), found.tangent.run.why,
                        degenerate_of(scene, found.tangent.degenerate), found.tangent.inconsistent,
                        found.tangent.warnings);
}

long records_of_run(const std::optional<std::string>& text, const std::string& scene_name,
                    const std::vector<std::string>& sets, std::optional<double> step, std::optional<double> duration,
                    long every) {
  const AnyScene scene = SceneSource{text, scene_name, sets}.make();
  const Clock clock = clock_of(scene, step, duration, every);
  check(clock);
  return RunSteps(clock).records();
}

/// Of the scalar Σ weights (records × columns) · values: t of the last record, value, gradient, status, why, degenerate
/// steps, inconsistent, warnings. Without weights the scalars are the columns at the end, or (sum) over all records.
py::tuple vjp_of_run(const std::optional<std::string>& text, const std::string& scene_name,
                     const std::vector<std::string>& sets, const std::vector<std::string>& of,
                     const std::vector<std::string>& wrt, const std::string& integrator, const std::string& solver,
                     std::optional<double> step, std::optional<double> duration, long every,
                     std::optional<py::array_t<double, py::array::c_style | py::array::forcecast>> weights, bool sum) {
  const SceneSource source{text, scene_name, sets};
  const AnyScene scene = source.make();
  const auto method = make_solver(solver);
  const Interruptible interruptible;
  const Clock clock = clock_of(scene, step, duration, every, interruptible.flag());
  check(clock);
  const auto columns = static_cast<Index>(of.size());
  RecordWeights weigh = sum ? weigh_all() : weigh_last();
  if (weights) {
    const long records = RunSteps(clock).records();
    if (weights->ndim() != 2 || weights->shape(0) != records || weights->shape(1) != columns)
      throw std::invalid_argument("vjp: weights must have " + std::to_string(records) +
                                  " rows, the records of the run, or be a number, of the last one");
    weigh = [data = weights->data(), columns](long record, bool /*last*/, Eigen::MatrixXd& W) {
      W = Eigen::Map<const Eigen::VectorXd>(data + record * columns, columns);
    };
  }
  RunAdjoint found;
  {
    const py::gil_scoped_release others_may_run;
    found = adjoint_of_run(source, of, wrt, integrator, *method, clock, weights ? 1 : columns, weigh);
  }
  interruptible.raise();
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by = found.gradient;
  return py::make_tuple(found.run.final.t, to_numpy(Vector(found.value)),
                        py::array_t<double>({by.rows(), by.cols()}, by.data()), std::string(name(found.run.status)),
                        found.run.why, degenerate_of(scene, found.degenerate), found.inconsistent, found.warnings);
}

/// t, exponents, those of the last half, status, why.
py::tuple lyapunov(const std::optional<std::string>& text, const std::string& scene_name,
                   const std::vector<std::string>& sets, const std::string& integrator, const std::string& solver,
                   int count, double duration, double transient, double every) {
  const SceneSource source{text, scene_name, sets};
  const auto method = make_solver(solver);
  const Interruptible interruptible;
  Lyapunov found;
  {
    const py::gil_scoped_release others_may_run;
    found = lyapunov_of(source, integrator, *method, {count, duration, transient, every}, interruptible.flag());
  }
  interruptible.raise();
  return py::make_tuple(found.final.t, to_numpy(Vector(found.exponents)), to_numpy(Vector(found.last_half)),
                        std::string(name(found.status)), found.why);
}

}  // namespace

void add_derivatives(py::module_& m) {
  m.def("_gradient", &gradient);
  m.def("_vjp_of_run", &vjp_of_run);
  m.def("_lyapunov", &lyapunov);
  m.def("_records_of_run", &records_of_run);
  py::class_<PythonSensitivity>(m, "_Sensitivity")
      .def(py::init<const Lcp&, const std::string&, py::handle, py::handle, double, double>())
      .def("tangent", &PythonSensitivity::tangent)
      .def("vjp", &PythonSensitivity::vjp)
      .def_property_readonly("unknowns", [](const PythonSensitivity& s) { return s.report().unknowns; })
      .def_property_readonly("reciprocal_condition",
                             [](const PythonSensitivity& s) { return s.report().reciprocal_condition; })
      .def_property_readonly("redundant", [](const PythonSensitivity& s) { return s.report().redundant; })
      .def_property_readonly("margin", [](const PythonSensitivity& s) { return to_numpy(s.report().margin); })
      .def_property_readonly("nearest", [](const PythonSensitivity& s) { return s.report().nearest; })
      .def_property_readonly("weakly_active",
                             [](const PythonSensitivity& s) {
                               std::vector<std::tuple<Index, double, double>> rows;
                               for (const WeaklyActive& row : s.report().weakly_active)
                                 rows.emplace_back(row.row, row.distance, row.w);
                               return rows;
                             })
      .def("__str__", [](const PythonSensitivity& s) { return words_of(s.report()); });
}

}  // namespace orthant::python
