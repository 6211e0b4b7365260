// Linear problems: orthant.Problem, made from arrays or files.
#include "experiments/python/arrays.h"
#include "experiments/python/module.h"
#include "experiments/python/problem_arrays.h"

#include "experiments/runs/problem_file.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/support/file.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <sstream>

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
      if (py::isinstance<py::iterable>(entry))
        for (const py::handle number : entry)
          if (const std::string type = Py_TYPE(number.ptr())->tp_name; type == "bool" || type.starts_with("numpy.bool"))
            throw py::type_error(place + " = " + py::str(entry).cast<std::string>() +
                                 ": must be numbers, not booleans");
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

void read_problem_into(Lcp& to, py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle friction,
                       const Matrix* A) {
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
