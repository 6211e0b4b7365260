// Derivatives of solutions: orthant._Sensitivity, wrapped by orthant/_derivatives.py.
#include "arrays.h"
#include "module.h"

#include <orthant/solvers/derivatives/sensitivity.h>

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

}  // namespace

void add_derivatives(py::module_& m) {
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
