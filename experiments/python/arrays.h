// experiments/python/arrays.h — NumPy and SciPy in, NumPy out: each number is copied once, into memory that is reused.
//
// Everything wrong throws std::invalid_argument (ValueError) or pybind11::type_error, naming argument, place and rule.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <pybind11/numpy.h>

#include <string_view>

namespace orthant::python {

enum class Entries { finite, numbers, any };  // numbers: infinities too, but no NaN

/// A one-dimensional array, or anything NumPy makes one of; `n` entries (−1: any number).
void read(pybind11::handle from, std::string_view name, Index n, Entries entries, Vector& to);

/// A square two-dimensional array becomes dense, a scipy.sparse matrix sparse, orthant.Delassus stays what it is.
void read(pybind11::handle from, std::string_view name, Matrix& to, Entries entries = Entries::finite);

/// Rows × columns of a SciPy sparse matrix; indices sorted, duplicates added.
void read(pybind11::handle from, std::string_view name, RowSparse& to, Entries entries = Entries::finite);

/// m × k, for what is not a problem's matrix.
Eigen::MatrixXd read_table(pybind11::handle from, std::string_view name);

pybind11::array_t<double> to_numpy(const Vector& x);
pybind11::object to_scipy(const RowSparse& M);  // scipy.sparse.csr_matrix
pybind11::object to_python(const Matrix& A);    // ndarray, csr_matrix or Delassus

}  // namespace orthant::python
