#include "module.h"

#include "orthant_build.h"

PYBIND11_MODULE(_orthant, m) {
  m.attr("__version__") = ORTHANT_VERSION;
  m.attr("revision") = ORTHANT_REVISION;
  orthant::python::add_problems(m);
  orthant::python::add_nonlinear(m);
  orthant::python::add_mechanics(m);
  orthant::python::add_sweeps(m);
}
