#include "experiments/python/arrays.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

/// A tensor of another library, its memory seen as NumPy's (DLPack).
py::array shared(py::handle from, const std::string& label) {
  try {
    return py::module_::import("numpy").attr("from_dlpack")(from);
  } catch (const py::error_already_set& error) {
    throw py::type_error(label + " is a " + std::string(Py_TYPE(from.ptr())->tp_name) +
                         ": must be in this processor's memory, without gradient (DLPack: " +
                         py::str(error.value()).cast<std::string>() + ")");
  }
}

/// Real numbers, converted to double where they are of another kind. Strides are whole and not negative.
py::array_t<double> numbers(py::handle from, std::string_view name) {
  const std::string label(name);
  py::array any = py::isinstance<py::array>(from)   ? py::reinterpret_borrow<py::array>(from)
                  : py::hasattr(from, "__dlpack__") ? shared(from, label)
                                                    : py::array::ensure(from);
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
  constexpr double kMostEntries = 0x1p36;  // half a terabyte; a view that repeats its rows may claim more
  if (static_cast<double>(a.shape(0)) * static_cast<double>(a.shape(1)) > kMostEntries)
    refuse(label + " has shape " + shape_of(a) + ": must have at most 2^36 entries, or be sparse");
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

/// One of the arrays of a compressed matrix: its own memory where that holds ints in a row, else a copy.
class Places {
 public:
  explicit Places(const py::object& from) {
    if (!py::isinstance<py::array_t<int>>(from)) {
      const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(from);
      if (!wide || wide.ndim() != 1) return;
      for (py::ssize_t i = 0; i < wide.size(); ++i)
        if (wide.data()[i] < 0 || wide.data()[i] > std::numeric_limits<int>::max()) return;
      copy_.assign(wide.data(), wide.data() + wide.size());
      begin_ = copy_.data(), size_ = copy_.size(), good_ = true;
      return;
    }
    array_ = py::reinterpret_borrow<py::array_t<int>>(from);
    if (array_.ndim() != 1 || (array_.size() > 1 && array_.strides(0) != static_cast<py::ssize_t>(sizeof(int)))) return;
    begin_ = array_.data(), size_ = static_cast<std::size_t>(array_.size()), good_ = true;
  }
  bool good() const { return good_; }
  std::size_t size() const { return size_; }
  int operator[](std::size_t i) const { return begin_[i]; }
  const int* begin() const { return begin_; }

 private:
  py::array_t<int> array_;
  std::vector<int> copy_;
  const int* begin_ = nullptr;
  std::size_t size_ = 0;
  bool good_ = false;
};

bool ascending_rows(const RowSparse& A) {
  for (Index i = 0; i < A.rows; ++i)
    for (int k = A.start[static_cast<std::size_t>(i)] + 1; k < A.start[static_cast<std::size_t>(i) + 1]; ++k)
      if (A.column[static_cast<std::size_t>(k)] <= A.column[static_cast<std::size_t>(k) - 1]) return false;
  return true;
}

/// A sound block matrix of SciPy, as read_compressed().
bool read_blocks(py::handle from, RowSparse& to) {
  const Places start(from.attr("indptr")), index(from.attr("indices"));
  const py::object data = from.attr("data");
  if (!start.good() || !index.good() || !py::isinstance<py::array_t<double, py::array::c_style>>(data)) return false;
  const auto values = py::reinterpret_borrow<py::array_t<double>>(data);
  const auto shape = from.attr("shape").cast<std::pair<Index, Index>>();
  if (values.ndim() != 3 || values.shape(1) < 1 || values.shape(2) < 1) return false;
  const auto R = static_cast<Index>(values.shape(1)), C = static_cast<Index>(values.shape(2));
  const Index rows = shape.first / R, cols = shape.second / C;
  if (shape.first % R != 0 || shape.second % C != 0 || start.size() != static_cast<std::size_t>(rows) + 1 ||
      start[0] != 0)
    return false;
  for (std::size_t i = 0; i + 1 < start.size(); ++i)
    if (start[i + 1] < start[i]) return false;
  const auto count = static_cast<std::size_t>(start[start.size() - 1]);
  if (count > index.size() || count > static_cast<std::size_t>(values.shape(0)) ||
      static_cast<double>(count) * static_cast<double>(R * C) > std::numeric_limits<int>::max())
    return false;
  for (std::size_t k = 0; k < count; ++k)
    if (index[k] < 0 || index[k] >= cols) return false;
  const double* const entries = values.data();
  const std::size_t size = count * static_cast<std::size_t>(R * C);
  for (std::size_t k = 0; k < size; ++k)
    if (!std::isfinite(entries[k])) return false;
  to.rows = shape.first, to.cols = shape.second;
  to.start.assign(1, 0), to.start.reserve(static_cast<std::size_t>(to.rows) + 1);
  to.column.resize(size), to.value.resize(size);
  std::size_t next = 0;
  std::vector<int> order;  // the blocks of a row by their columns: SciPy's own are often in another order
  for (Index i = 0; i < rows; ++i) {
    const int begin = start[static_cast<std::size_t>(i)], end = start[static_cast<std::size_t>(i) + 1];
    const auto column = [&](int k) { return index[static_cast<std::size_t>(k)]; };
    order.resize(static_cast<std::size_t>(end - begin));
    std::iota(order.begin(), order.end(), begin);
    std::sort(order.begin(), order.end(), [&](int x, int y) { return column(x) < column(y); });
    for (Index r = 0; r < R; ++r) {
      for (const int k : order)
        for (Index c = 0; c < C; ++c, ++next) {
          to.column[next] = static_cast<int>(column(k) * C + c);
          to.value[next] = entries[(k * R + r) * C + c];
        }
      to.start.push_back(static_cast<int>(next));
    }
  }
  return ascending_rows(to);
}

/// A sound compressed matrix of SciPy, by rows, columns or blocks, without a call of SciPy. False: anything else, which
/// the slower way takes or refuses.
bool read_compressed(py::handle from, RowSparse& to) {
  const py::object format = py::getattr(from, "format", py::none());
  if (!py::isinstance<py::str>(format)) return false;
  const auto kind = format.cast<std::string>();
  if (kind == "bsr") return read_blocks(from, to);
  const bool by_rows = kind == "csr";
  if (!by_rows && kind != "csc") return false;
  const Places start(from.attr("indptr")), index(from.attr("indices"));
  const py::object data = from.attr("data");
  if (!start.good() || !index.good() || !py::isinstance<py::array_t<double>>(data)) return false;
  const auto values = py::reinterpret_borrow<py::array_t<double>>(data);
  const auto shape = from.attr("shape").cast<std::pair<Index, Index>>();
  const Index major = by_rows ? shape.first : shape.second, minor = by_rows ? shape.second : shape.first;
  if (values.ndim() != 1 || (values.size() > 1 && values.strides(0) != static_cast<py::ssize_t>(sizeof(double))) ||
      start.size() != static_cast<std::size_t>(major) + 1 || start[0] != 0)
    return false;
  for (std::size_t i = 0; i + 1 < start.size(); ++i)
    if (start[i + 1] < start[i]) return false;
  const auto count = static_cast<std::size_t>(start[start.size() - 1]);
  if (count > index.size() || count > static_cast<std::size_t>(values.size())) return false;
  for (std::size_t k = 0; k < count; ++k)
    if (index[k] < 0 || index[k] >= minor || !std::isfinite(values.data()[k])) return false;
  to.rows = shape.first, to.cols = shape.second;
  if (by_rows) {
    to.start.assign(start.begin(), start.begin() + start.size());
    to.column.assign(index.begin(), index.begin() + count);
    to.value.assign(values.data(), values.data() + count);
    return ascending_rows(to);
  }
  to.start.assign(static_cast<std::size_t>(to.rows) + 1, 0);
  for (std::size_t k = 0; k < count; ++k) ++to.start[static_cast<std::size_t>(index[k]) + 1];
  for (std::size_t i = 1; i < to.start.size(); ++i) to.start[i] += to.start[i - 1];
  to.column.resize(count), to.value.resize(count);
  std::vector<int> next(to.start.begin(), to.start.end() - 1);
  for (Index j = 0; j < major; ++j)
    for (int k = start[static_cast<std::size_t>(j)]; k < start[static_cast<std::size_t>(j) + 1]; ++k) {
      const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(index[static_cast<std::size_t>(k)])]++);
      to.column[at] = static_cast<int>(j), to.value[at] = values.data()[k];
    }
  return ascending_rows(to);
}

std::vector<int> indices(const py::object& from, const std::string& label) {
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(from);
  if (wide.size() > 0 && wide.at(wide.size() - 1) > std::numeric_limits<int>::max())
    refuse(label + " has more than 2^31 entries: must have fewer");
  return {wide.data(), wide.data() + wide.size()};
}

void require_square(const RowSparse& A, const std::string& label) {
  if (A.rows != A.cols)
    refuse(label + " has shape (" + std::to_string(A.rows) + ", " + std::to_string(A.cols) + "): must be square");
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
  if (read_compressed(from, to)) return;
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
  if (!py::isinstance<py::array>(from) && py::hasattr(from, "indptr")) {
    auto& A = as<RowSparse>(to);
    read(from, name, A, entries);
    return require_square(A, label);
  }
  if (is_delassus(from)) {
    auto& A = as<Delassus>(to);
    read(from.attr("W"), label + ".W", A.W, entries);
    read(from.attr("inverse_mass"), label + ".inverse_mass", A.W.cols, entries, A.inverse_mass);
    A.regularization.resize(0);
    if (const py::object R = from.attr("regularization"); !R.is_none())
      read(R, label + ".regularization", A.W.rows, entries, A.regularization);
    return;
  }
  if (is_sparse(from)) {
    auto& A = as<RowSparse>(to);
    read(from, name, A, entries);
    return require_square(A, label);
  }
  const auto a = numbers(from, name);
  const Table table = table_of(a, name, entries);
  if (table.rows() != table.cols()) refuse(label + " has shape " + shape_of(a) + ": must be square");
  as<DenseMatrix>(to) = table;
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
