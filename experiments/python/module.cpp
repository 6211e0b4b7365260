#include "experiments/python/module.h"

#include "experiments/cli/command.h"
#include "experiments/support/printable.h"
#include "orthant_build.h"

#include <pybind11/stl.h>

#include <stdexcept>
#include <string>
#include <vector>

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

/// Runs a Python file for what it registers.
void load_python_plugin(const std::filesystem::path& file) {
  const pybind11::gil_scoped_acquire python;
  try {
    pybind11::module_::import("orthant._command").attr("load_plugin")(file.string());
  } catch (pybind11::error_already_set& error) {
    throw std::invalid_argument(pybind11::str(error.value()).cast<std::string>());
  }
}

/// An exception of a function of a plugin with its place, in one line.
std::string words_of(const std::exception& error) {
  const auto* raised = dynamic_cast<const pybind11::error_already_set*>(&error);
  if (raised == nullptr) return error.what();
  const pybind11::gil_scoped_acquire python;
  if (raised->trace()) PyException_SetTraceback(raised->value().ptr(), raised->trace().ptr());
  return pybind11::module_::import("orthant._command").attr("described")(raised->value()).cast<std::string>();
}

constexpr orthant::PluginKind kPythonPlugin{
    "Python file that registers solvers, integrators and scenes of its own; may be repeated", &load_python_plugin,
    &words_of};

}  // namespace

PYBIND11_MODULE(_orthant, m) {
  pybind11::register_local_exception_translator(&translate);
  m.attr("__version__") = ORTHANT_VERSION;
  m.attr("revision") = ORTHANT_REVISION;
  m.def("_main", [](const std::vector<std::string>& words) {
    std::vector<const char*> argv;
    for (const std::string& word : words) argv.push_back(word.c_str());
    const pybind11::gil_scoped_release others_may_run;
    return orthant::run_command(static_cast<int>(argv.size()), argv.data(), kPythonPlugin);
  });
  orthant::python::add_problems(m);
  orthant::python::add_results(m);
  orthant::python::add_solvers(m);
  orthant::python::add_analysis(m);
  orthant::python::add_derivatives(m);
  orthant::python::add_nonlinear(m);
  orthant::python::add_mechanics(m);
  orthant::python::add_integrators(m);
  orthant::python::add_models(m);
  orthant::python::add_sweeps(m);
}
