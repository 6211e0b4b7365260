// Analysis of linear problems: the matrix's class, all solutions, and the distance of a point from the next one.
#include "experiments/python/arrays.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"
#include "experiments/python/pickle.h"
#include "experiments/python/problem_arrays.h"

#include <orthant/core/lcp/judge/analyse.h>
#include <orthant/core/lcp/judge/error_bound.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <sstream>

namespace orthant::python {
namespace py = pybind11;
namespace {

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

}  // namespace

void add_analysis(py::module_& m) {
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
}

}  // namespace orthant::python
