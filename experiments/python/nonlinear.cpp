// Problems given by callbacks, which run under the interpreter's lock; games of two players.
#include "experiments/python/arrays.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"
#include "experiments/python/pickle.h"

#include <orthant/core/support/options.h>
#include <orthant/solvers/pivoting/extreme_equilibria.h>
#include <orthant/solvers/pivoting/lemke_howson.h>
#include <orthant/solvers/pivoting/path.h>

#include <pybind11/eigen.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

namespace orthant::python {
namespace py = pybind11;
namespace {

py::dict solve_mcp(const py::object& F, const py::object& jacobian, py::handle start, py::handle lower,
                   py::handle upper, const std::string& options, std::optional<double> time_limit) {
  Solution s;
  read(start, "start", -1, Entries::finite, s.z);
  const Index n = s.z.size();
  Mcp problem;
  problem.lo = Eigen::VectorXd::Zero(n), problem.hi = Eigen::VectorXd::Constant(n, kInf);
  if (!lower.is_none()) read(lower, "lower", n, Entries::numbers, problem.lo);
  if (!upper.is_none()) read(upper, "upper", n, Entries::numbers, problem.hi);
  const auto numbers = [](const py::object& value, const char* what) {
    if (const auto any = py::array::ensure(value); any && any.dtype().kind() == 'c')
      throw py::type_error(std::string(what) + " returned complex numbers: must be real");
    const auto a = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
    if (!a || value.is_none()) throw py::type_error(std::string(what) + " returned no array of numbers");
    return a;
  };
  std::string why;  // the first entry that is not finite
  const auto note = [&](const std::string& entry, double value) {
    if (why.empty())
      why = entry + " = " + (std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf") + ": must be finite";
  };
  problem.F = [&](const Vector& z, Vector& value) {  // NaN is the solver's to avoid: it steps back
    const auto a = numbers(F(to_numpy(z)), "F");
    if (a.ndim() != 1 || a.shape(0) != n)
      throw std::invalid_argument("F returned " + std::to_string(a.size()) + " numbers" +
                                  (a.ndim() == 1 ? "" : " in " + std::to_string(a.ndim()) + " dimensions") +
                                  ": must be (" + std::to_string(n) + ",)");
    value = Eigen::Map<const Eigen::VectorXd>(a.data(), n);
    for (Index i = 0; i < n; ++i)
      if (!std::isfinite(value[i])) note("F[" + std::to_string(i) + "]", value[i]);
  };
  problem.jacobian = [&](const Vector& z, Matrix& J) {
    const py::object value = jacobian(to_numpy(z));
    if (py::hasattr(value, "tocsr")) return read(value, "jacobian", J);
    const auto a = numbers(value, "jacobian");
    if (a.ndim() != 2 || a.shape(0) != n || a.shape(1) != n)
      throw std::invalid_argument("jacobian returned another shape: must be (" + std::to_string(n) + ", " +
                                  std::to_string(n) + ")");
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Map<const Rows> rows(a.data(), n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j)
        if (!std::isfinite(rows(i, j)))
          note("jacobian[" + std::to_string(i) + ", " + std::to_string(j) + "]", rows(i, j));
    J = DenseMatrix(rows);
  };
  PathOptions given;
  set_options(given, options);
  Path path(given);
  if (time_limit) path.set_time_limit(*time_limit);
  path.solve(problem, s, Start::warm);
  py::dict d;
  d["status"] = name(s.status);
  d["solved"] = s.status == Status::solved;
  d["z"] = to_numpy(s.z);
  d["F"] = to_numpy(s.w);
  d["residual"] = s.residual;
  d["iterations"] = s.iterations;
  d["why"] = s.status == Status::numerical_error && !why.empty() ? why : orthant::why(s);
  return d;
}

/// A game's answer has no status: TimeoutError where there is none in time.
template <class Solve> auto play(py::handle A, py::handle B, std::optional<double> time_limit, const Solve& solve) {
  const Eigen::MatrixXd a = read_table(A, "A"), b = read_table(B, "B");
  Watch watch(time_limit);
  decltype(solve(a, b, watch.stop())) answer;
  {
    const py::gil_scoped_release others_may_run;
    answer = solve(a, b, watch.stop());
  }
  watch.raise();
  if (watch.stopped()) {
    PyErr_SetString(PyExc_TimeoutError, "time_limit: over before all paths had ended");
    throw py::error_already_set();
  }
  return answer;
}

}  // namespace

void add_nonlinear(py::module_& m) {
  m.def("_solve_mcp", &solve_mcp);

  py::class_<Equilibrium>(
      m, "Equilibrium",
      "Mixed strategies x (m,), y (k,), both players' expected costs, and regret: the most that one of them gains by\n"
      "another strategy, in units of the costs; above 0 by rounding alone, which costs of 1e12 next to 1 make large.")
      .def_readonly("x", &Equilibrium::x, "(m,) the first player's mixed strategy")
      .def_readonly("y", &Equilibrium::y, "(k,) the second player's")
      .def_readonly("cost_1", &Equilibrium::cost_1, "x' A y, expected")
      .def_readonly("cost_2", &Equilibrium::cost_2, "x' B y, expected")
      .def_readonly("regret", &Equilibrium::regret, "the most that one of them gains by another strategy")
      .def_readonly("label", &Equilibrium::label, "the path's label; of extreme_equilibria the connected component's")
      .def("__repr__",
           [](const py::object& e) {
             return py::str("Equilibrium(x={}, y={}, cost_1={:g}, cost_2={:g}, regret={:g})")
                 .format(e.attr("x"), e.attr("y"), e.attr("cost_1"), e.attr("cost_2"), e.attr("regret"));
           })
      .def(by_members<Equilibrium, &Equilibrium::x, &Equilibrium::y, &Equilibrium::cost_1, &Equilibrium::cost_2,
                      &Equilibrium::regret, &Equilibrium::label>());
  m.def("_equilibrium", [](py::handle A, py::handle B, int label, std::optional<double> time_limit) {
    return play(A, B, time_limit,
                [&](const auto& a, const auto& b, const auto& stop) { return lemke_howson(a, b, label, stop); });
  });
  m.def("_equilibria", [](py::handle A, py::handle B, std::optional<double> time_limit) {
    return play(A, B, time_limit,
                [](const auto& a, const auto& b, const auto& stop) { return lemke_howson_all(a, b, stop); });
  });
  m.def("_extreme_equilibria", [](py::handle A, py::handle B, std::optional<double> time_limit) {
    return play(A, B, time_limit,
                [](const auto& a, const auto& b, const auto& stop) { return extreme_equilibria(a, b, stop).all; });
  });
}

}  // namespace orthant::python
