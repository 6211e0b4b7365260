#include "arrays.h"

#include <cmath>
#include <string>

namespace orthant::python {
namespace py = pybind11;
namespace {

[[noreturn]] void refuse(const std::string& words) { throw std::invalid_argument(words); }

std::string shape_of(const py::array& a) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < a.ndim(); ++i) text += (i ? ", " : "") + std::to_string(a.shape(i));
  return text + (a.ndim() == 1 ? ",)" : ")");
}

/// Real numbers, converted to double where they are of another kind. Strides are whole and not negative.
py::array_t<double> numbers(py::handle from, std::string_view name) {
  const std::string label(name);
  py::array any = py::isinstance<py::array>(from) ? py::reinterpret_borrow<py::array>(from) : py::array::ensure(from);
  if (!any) {
    PyErr_Clear();
    throw py::type_error(label + " is a " + std::string(Py_TYPE(from.ptr())->tp_name) +
                         ": must be an array of numbers");
  }
  static const PyTypeObject* const plain = Py_TYPE(py::array_t<double>(0).ptr());
  if (Py_TYPE(any.ptr()) != plain && py::hasattr(any, "mask"))
    throw py::type_error(label + " is a masked array: must have no masks, such as " + label + ".filled(0)");
  if (std::string("fiu").find(any.dtype().kind()) == std::string::npos)
    throw py::type_error(label + " has dtype " + py::str(any.dtype()).cast<std::string>() +
                         ": must be real numbers (float or int)");
  auto doubles = py::array_t<double, py::array::forcecast>::ensure(any);
  if (!doubles) throw py::error_already_set();
  for (py::ssize_t i = 0; i < doubles.ndim(); ++i)
    if (doubles.strides(i) < 0 || doubles.strides(i) % static_cast<py::ssize_t>(sizeof(double)) != 0)
      return py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(doubles);
  return doubles;
}

Index step(const py::array& a, py::ssize_t i) { return a.strides(i) / static_cast<py::ssize_t>(sizeof(double)); }

std::string text_of(double x) { return py::repr(py::float_(x)).cast<std::string>(); }

using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
using Table = Eigen::Map<const Eigen::MatrixXd, Eigen::Unaligned, Strides>;

/// The array's own memory, seen as a matrix.
Table table_of(const py::array_t<double>& a, std::string_view name, Entries entries = Entries::finite) {
  const std::string label(name);
  if (a.ndim() != 2) refuse(label + " has shape " + shape_of(a) + ": must have two dimensions");
  const Table table(a.data(), a.shape(0), a.shape(1), Strides(step(a, 1), step(a, 0)));
  if (entries == Entries::any || table.allFinite()) return table;
  for (Index i = 0; i < table.rows(); ++i)
    for (Index j = 0; j < table.cols(); ++j)
      if (!std::isfinite(table(i, j)))
        refuse(label + "[" + std::to_string(i) + ", " + std::to_string(j) + "] = " + text_of(table(i, j)) +
               ": must be finite");
  return table;
}

bool is_sparse(py::handle from) { return py::hasattr(from, "tocsr") && py::hasattr(from, "nnz"); }
bool is_delassus(py::handle from) { return py::hasattr(from, "W") && py::hasattr(from, "inverse_mass"); }

/// SciPy's own routines read past the ends of arrays whose pointers lie: they are looked through first.
void require_sound(py::handle matrix, const std::string& label) {
  if (!py::hasattr(matrix, "check_format")) return;
  try {
    matrix.attr("check_format")(true);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) throw;
    refuse(label + " is no sound sparse matrix: " + py::str(error.value()).cast<std::string>());
  }
}

std::vector<int> indices(const py::object& from, const std::string& label) {
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(from);
  if (wide.size() > 0 && wide.at(wide.size() - 1) > std::numeric_limits<int>::max())
    refuse(label + " has more than 2^31 entries: must have fewer");
  return {wide.data(), wide.data() + wide.size()};
}

}  // namespace

void read(py::handle from, std::string_view name, Index n, Entries entries, Vector& to) {
  const std::string label(name);
  const auto a = numbers(from, name);
  if (a.ndim() != 1 || (n >= 0 && a.shape(0) != n))
    refuse(label + " has shape " + shape_of(a) + ": must be " +
           (n >= 0 ? "(" + std::to_string(n) + ",), one entry a row" : "one-dimensional"));
  to.resize(a.shape(0));
  for (Index i = 0; i < to.size(); ++i) {
    to[i] = a.data()[i * step(a, 0)];
    if (entries == Entries::finite ? !std::isfinite(to[i]) : entries == Entries::numbers && std::isnan(to[i]))
      refuse(label + "[" + std::to_string(i) + "] = " + text_of(to[i]) + ": must be " +
             (entries == Entries::finite ? "finite" : "a number or infinite"));
  }
}

void read(py::handle from, std::string_view name, RowSparse& to, Entries entries) {
  const std::string label(name);
  if (!is_sparse(from)) throw py::type_error(label + ": must be a scipy.sparse matrix");
  require_sound(from, label);
  py::object csr = from.attr("tocsr")();
  if (!csr.attr("has_canonical_format").cast<bool>()) {
    if (csr.is(from)) csr = csr.attr("copy")();  // the caller's own is left as it is
    csr.attr("sum_duplicates")();
  }
  const auto shape = csr.attr("shape").cast<std::pair<Index, Index>>();
  to.rows = shape.first, to.cols = shape.second;
  to.start = indices(csr.attr("indptr"), label);
  to.column = indices(csr.attr("indices"), label);
  Vector values;
  read(csr.attr("data"), label + ".data", -1, entries, values);
  to.value.assign(values.data(), values.data() + values.size());
}

void read(py::handle from, std::string_view name, Matrix& to, Entries entries) {
  const std::string label(name);
  if (is_delassus(from)) {
    if (!std::holds_alternative<Delassus>(to)) to = Delassus{};
    auto& A = std::get<Delassus>(to);
    read(from.attr("W"), label + ".W", A.W, entries);
    read(from.attr("inverse_mass"), label + ".inverse_mass", A.W.cols, entries, A.inverse_mass);
    A.regularization.resize(0);
    if (const py::object R = from.attr("regularization"); !R.is_none())
      read(R, label + ".regularization", A.W.rows, entries, A.regularization);
    return;
  }
  if (is_sparse(from)) {
    if (!std::holds_alternative<RowSparse>(to)) to = RowSparse{};
    auto& A = std::get<RowSparse>(to);
    read(from, name, A, entries);
    if (A.rows != A.cols)
      refuse(label + " has shape (" + std::to_string(A.rows) + ", " + std::to_string(A.cols) + "): must be square");
    return;
  }
  const auto a = numbers(from, name);
  const Table table = table_of(a, name, entries);
  if (table.rows() != table.cols()) refuse(label + " has shape " + shape_of(a) + ": must be square");
  if (!std::holds_alternative<DenseMatrix>(to)) to = DenseMatrix{};
  std::get<DenseMatrix>(to) = table;
}

Eigen::MatrixXd read_table(py::handle from, std::string_view name) {
  const auto a = numbers(from, name);
  return table_of(a, name);
}

py::array_t<double> to_numpy(const Vector& x) { return py::array_t<double>(x.size(), x.data()); }

py::object to_scipy(const RowSparse& M) {
  const auto array = [](const auto& v) { return py::array(static_cast<py::ssize_t>(v.size()), v.data()); };
  return py::module_::import("scipy.sparse")
      .attr("csr_matrix")(py::make_tuple(array(M.value), array(M.column), array(M.start)),
                          py::make_tuple(M.rows, M.cols));
}

py::object to_python(const Matrix& A) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    constexpr auto kWord = static_cast<py::ssize_t>(sizeof(double));
    return py::array_t<double>({dense->rows(), dense->cols()}, {kWord, kWord * dense->rows()}, dense->data());
  }
  if (const auto* sparse = std::get_if<RowSparse>(&A)) return to_scipy(*sparse);
  const auto& d = std::get<Delassus>(A);
  const py::object R = d.regularization.size() > 0 ? py::object(to_numpy(d.regularization)) : py::none();
  return py::module_::import("orthant").attr("Delassus")(to_scipy(d.W), to_numpy(d.inverse_mass), R);
}

}  // namespace orthant::python
