#include <orthant/core/lcp/io.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>

#include <cholmod.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

/// What CHOLMOD's reader takes on trust or guesses: the banner, the sizes. Returns "array" or "coordinate".
/// (Without a banner CHOLMOD guesses the format; patterns it fills with numbers of its own.)
std::string check_header(const fs::path& file) {
  std::ifstream in(file);
  if (!in) refuse(file, std::string("cannot read: ") + std::strerror(errno));
  if (fs::is_directory(file)) refuse(file, "cannot read: is a folder");
  std::string line;
  std::getline(in, line);
  std::istringstream banner(line);
  std::string mark, object, format, field, symmetry;
  banner >> mark >> object >> format >> field >> symmetry;
  for (std::string* word : {&mark, &object, &format, &field, &symmetry})
    for (char& c : *word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto one_of = [&](const std::string& word, const char* name, std::initializer_list<const char*> known) {
    std::string list;
    for (const char* k : known) {
      if (word == k) return;
      list += (list.empty() ? "" : ", ") + std::string(k);
    }
    refuse(file, "line 1: " + std::string(name) + " '" + word.substr(0, 40) + "': must be one of " + list);
  };
  one_of(mark, "banner", {"%%matrixmarket"});
  one_of(object, "object", {"matrix"});
  one_of(format, "format", {"array", "coordinate"});
  one_of(field, "field", {"real", "integer", "double"});
  one_of(symmetry, "symmetry", {"general", "symmetric", "skew-symmetric"});

  long number = 1;
  while (std::getline(in, line) && (++number, line.empty() || line[0] == '%' ||
                                                  line.find_first_not_of(" \t\r") == std::string::npos)) {
  }
  std::istringstream sizes(line);
  double rows = -1, cols = -1, entries = -1;
  sizes >> rows >> cols;
  if (format == "coordinate")
    sizes >> entries;
  else
    entries = rows * cols;
  std::string rest;
  if (!in || !sizes || sizes >> rest || rows < 0 || cols < 0 || entries < 0)
    refuse(file, "line " + std::to_string(number) + ": must hold the sizes: rows columns" +
                     (format == "coordinate" ? " entries" : ""));
  // Two characters an entry at the least: a file that announces more than it can hold would only cost memory.
  const auto bytes = static_cast<double>(fs::file_size(file));
  const double stored = format == "array" && symmetry != "general" ? entries / 2 - rows : entries;
  if (2 * stored > bytes + 2 || rows > 1e8 || cols > 1e8)
    refuse(file, "line " + std::to_string(number) + ": announces " + line.substr(0, 60) +
                     " but the file has only " + std::to_string(fs::file_size(file)) + " bytes");
  return format;
}

thread_local std::string cholmod_message;  // CHOLMOD reports through a plain function

class Cholmod {
 public:
  Cholmod() {
    cholmod_start(&common);
    common.print = 0;
    cholmod_message.clear();
    common.error_handler = [](int, const char*, int, const char* message) { cholmod_message = message; };
  }
  ~Cholmod() { cholmod_finish(&common); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;
  cholmod_common common{};
};

/// Calls use(kind, object) on what the file holds: a cholmod_dense where dense is asked for, else unsymmetric sparse.
template <class Object, class Use> void read(const fs::path& file, int prefer, int wanted, Use&& use) {
  Cholmod cholmod;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "r"), &std::fclose);
  if (!in) refuse(file, std::string("cannot read: ") + std::strerror(errno));
  int kind = 0;
  void* object = cholmod_read_matrix(in.get(), prefer, &kind, &cholmod.common);
  if (object == nullptr || kind != wanted) {
    if (object != nullptr) {
      auto* sparse = static_cast<cholmod_sparse*>(object);
      auto* dense = static_cast<cholmod_dense*>(object);
      kind == CHOLMOD_DENSE ? cholmod_free_dense(&dense, &cholmod.common)
                            : cholmod_free_sparse(&sparse, &cholmod.common);
    }
    refuse(file, "no readable matrix: " +
                     (cholmod_message.empty() ? std::string("entries are missing or no numbers") : cholmod_message));
  }
  auto* typed = static_cast<Object*>(object);
  try {
    use(*typed, cholmod.common);
  } catch (...) {
    if constexpr (std::is_same_v<Object, cholmod_dense>)
      cholmod_free_dense(&typed, &cholmod.common);
    else
      cholmod_free_sparse(&typed, &cholmod.common);
    throw;
  }
  if constexpr (std::is_same_v<Object, cholmod_dense>)
    cholmod_free_dense(&typed, &cholmod.common);
  else
    cholmod_free_sparse(&typed, &cholmod.common);
}

void check_number(const fs::path& file, Index row, Index column, double value, bool may_be_infinite) {
  if (std::isnan(value) || (!may_be_infinite && std::isinf(value)))
    refuse(file, "entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) + ") = " +
                     detail::text_of(value) + ": must be " + (may_be_infinite ? "a number" : "finite"));
}

void check_square(const fs::path& file, std::size_t rows, std::size_t cols) {
  if (rows != cols || rows == 0)
    refuse(file, "is " + std::to_string(rows) + " x " + std::to_string(cols) + ": must be square and not empty");
}

/// CHOLMOD turns what it cannot fit into a number, "1e999" say, into infinity, and ±1e308 too: both are refused as
/// matrix entries, so a file cannot change its meaning on the way in.
Matrix read_dense(const fs::path& file) {
  DenseMatrix A;
  read<cholmod_dense>(file, 2, CHOLMOD_DENSE, [&](const cholmod_dense& x, cholmod_common&) {
    check_square(file, x.nrow, x.ncol);
    const auto n = static_cast<Index>(x.nrow);
    A = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x.x), n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) check_number(file, i, j, A(i, j), false);
  });
  return A;
}

Matrix read_sparse(const fs::path& file) {
  RowSparse A;
  read<cholmod_sparse>(file, 1, CHOLMOD_SPARSE, [&](cholmod_sparse& x, cholmod_common& common) {
    check_square(file, x.nrow, x.ncol);
    cholmod_sparse* t = cholmod_transpose(&x, 1, &common);  // its columns are our rows, sorted
    if (t == nullptr) refuse(file, "too large for the memory at hand");
    const auto* start = static_cast<const int*>(t->p);
    const auto* column = static_cast<const int*>(t->i);
    const auto* value = static_cast<const double*>(t->x);
    A.rows = A.cols = static_cast<Index>(t->ncol);
    A.start.assign(start, start + t->ncol + 1);
    A.column.assign(column, column + A.start.back());
    A.value.assign(value, value + A.start.back());
    cholmod_free_sparse(&t, &common);
    for (std::size_t i = 0; i + 1 < A.start.size(); ++i)
      for (int k = A.start[i]; k < A.start[i + 1]; ++k)
        check_number(file, static_cast<Index>(i), A.column[static_cast<std::size_t>(k)],
                     A.value[static_cast<std::size_t>(k)], false);
  });
  return A;
}

}  // namespace

Matrix read_matrix_market(const fs::path& file) {
  return check_header(file) == "array" ? read_dense(file) : read_sparse(file);
}

Vector read_matrix_market_vector(const fs::path& file) {
  check_header(file);
  Vector result;
  read<cholmod_dense>(file, 2, CHOLMOD_DENSE, [&](const cholmod_dense& x, cholmod_common&) {
    if ((x.ncol != 1 && x.nrow != 1) || x.ncol * x.nrow == 0)
      refuse(file, "is " + std::to_string(x.nrow) + " x " + std::to_string(x.ncol) + ": must be one column");
    result = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x.x), static_cast<Index>(x.nrow * x.ncol));
    for (Index i = 0; i < result.size(); ++i) check_number(file, i, 0, result[i], true);
  });
  return result;
}

namespace {

constexpr const char* kBanner = "%%MatrixMarket matrix ";

}  // namespace

void write_matrix_market(const fs::path& file, const Matrix& A) {
  std::string text;
  if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    text = kBanner + std::string("coordinate real general\n") + std::to_string(sparse->rows) + ' ' +
           std::to_string(sparse->cols) + ' ' + std::to_string(sparse->value.size()) + '\n';
    for (std::size_t i = 0; i + 1 < sparse->start.size(); ++i)
      for (auto k = static_cast<std::size_t>(sparse->start[i]); k < static_cast<std::size_t>(sparse->start[i + 1]); ++k)
        text += std::to_string(i + 1) + ' ' + std::to_string(sparse->column[k] + 1) + ' ' +
                detail::text_of(sparse->value[k]) + '\n';
  } else {
    DenseMatrix dense;
    to_dense(A, dense);
    text = kBanner + std::string("array real general\n") + std::to_string(dense.rows()) + ' ' +
           std::to_string(dense.cols()) + '\n';
    for (Index k = 0; k < dense.size(); ++k) text += detail::text_of(dense.data()[k]) + '\n';
  }
  write_whole(file, text);
}

void write_matrix_market(const fs::path& file, const Vector& x) {
  std::string text = kBanner + std::string("array real general\n") + std::to_string(x.size()) + " 1\n";
  for (Index i = 0; i < x.size(); ++i) text += detail::text_of(x[i]) + '\n';
  write_whole(file, text);
}

}  // namespace orthant
