// experiments/python/module.h — orthant._orthant, what the Python package is made of: one function a part.
#pragma once

#include <pybind11/pybind11.h>

namespace orthant::python {

void add_problems(pybind11::module_& m);     // Problem, and its files
void add_results(pybind11::module_& m);      // Result, LogEntry
void add_solvers(pybind11::module_& m);      // Solver, solve_many, methods written in Python
void add_analysis(pybind11::module_& m);     // analyse, enumerate_solutions, error_bound
void add_derivatives(pybind11::module_& m);  // sensitivities of solutions
void add_nonlinear(pybind11::module_& m);    // mixed complementarity problems by callbacks, bimatrix games
void add_mechanics(pybind11::module_& m);    // scenes, simulate
void add_integrators(pybind11::module_& m);  // integrators written in Python
void add_models(pybind11::module_& m);       // import of URDF and MJCF
void add_sweeps(pybind11::module_& m);       // sweeps into SQLite

}  // namespace orthant::python
