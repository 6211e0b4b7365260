#include "module.h"

#include "../support/printable.h"
#include "orthant_build.h"

#include <stdexcept>

namespace {

/// Messages quote input, and Python takes UTF-8 only.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const pybind11::builtin_exception&) {  // pybind11's own
    throw;
  } catch (const std::invalid_argument& error) {
    PyErr_SetString(PyExc_ValueError, orthant::printable(error.what()).c_str());
  } catch (const std::runtime_error& error) {
    PyErr_SetString(PyExc_RuntimeError, orthant::printable(error.what()).c_str());
  }
}

}  // namespace

PYBIND11_MODULE(_orthant, m) {
  pybind11::register_local_exception_translator(&translate);
  m.attr("__version__") = ORTHANT_VERSION;
  m.attr("revision") = ORTHANT_REVISION;
  orthant::python::add_problems(m);
  orthant::python::add_nonlinear(m);
  orthant::python::add_mechanics(m);
  orthant::python::add_sweeps(m);
}
