// experiments/python/problem_arrays.h — linear problems from NumPy's arrays, read into memory that is reused.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <pybind11/numpy.h>

#include <string>

namespace orthant::python {

/// M, q, lower, upper, friction of the Python side; None: 0 for lower, ∞ for upper, no friction. A: M, read before.
void read_problem_into(Lcp& to, pybind11::handle M, pybind11::handle q, pybind11::handle lower, pybind11::handle upper,
                       pybind11::handle friction, const Matrix* A = nullptr);

/// "[1.5, 0, 2.25]", of many entries the first and the last three.
std::string few(const pybind11::array_t<double>& x);

}  // namespace orthant::python
