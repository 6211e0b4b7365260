#include <orthant/core/lcp/files/io.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>

#include <cholmod.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace orthant {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

constexpr std::size_t kLongestLine = 1000;

/// A file's text, once everything is checked that CHOLMOD's reader takes on trust or guesses: without a banner it
/// guesses the format, patterns it fills with numbers of its own, an index 0 makes it count from 0, a missing value it
/// makes up.
struct Text {
  std::string text;  // its banner says real where the file says double, a word that CHOLMOD does not know
  bool dense = false;
};

class Checker {
 public:
  explicit Checker(const fs::path& file) : file_(file) {
    result_.text = read_whole(file, largest_input(kLargestProblem));
  }

  Text check() {
    check_banner();
    check_sizes();
    check_entries();
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse_line(const std::string& what) const {
    refuse(file_, "line " + std::to_string(line_number_) + ": " + what);
  }
  /// The next line into words_; with `skip`, the next that is neither blank nor a comment. False at the end.
  bool next_line(bool skip) {
    do {
      if (position_ >= result_.text.size()) return false;
      ++line_number_;
      begin_ = position_;
      const auto end = std::min(result_.text.find('\n', begin_), result_.text.size());
      position_ = end + 1;
      if (end - begin_ > kLongestLine)  // CHOLMOD reads longer ones in pieces, and takes each piece for a line
        refuse_line("has " + std::to_string(end - begin_) + " characters: must have at most " +
                    std::to_string(kLongestLine));
      words_.clear();
      const std::string_view line(result_.text.data() + begin_, end - begin_);
      for (std::size_t i = 0; i < line.size();) {
        const auto from = line.find_first_not_of(" \t\r", i);
        if (from == std::string_view::npos) break;
        const auto to = std::min(line.find_first_of(" \t\r", from), line.size());
        words_.push_back(line.substr(from, to - from));
        i = to;
      }
    } while (skip && (words_.empty() || words_.front().front() == '%'));
    return true;
  }
  static std::string lower(std::string_view word) {
    std::string result(word.substr(0, 40));
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
  }

  void check_banner() {
    if (!next_line(false)) line_number_ = 1;
    const auto word = [&](std::size_t i, const char* what, std::initializer_list<const char*> known) {
      const std::string found = i < words_.size() ? lower(words_[i]) : "";
      std::string list;
      for (const char* k : known) {
        if (found == k) return found;
        list += (list.empty() ? "" : ", ") + std::string(k);
      }
      refuse_line(std::string(what) + " '" + found + "': must be " + (known.size() > 1 ? "one of " : "") + list);
    };
    word(0, "banner", {"%%matrixmarket"});
    word(1, "object", {"matrix"});
    result_.dense = word(2, "format", {"array", "coordinate"}) == "array";
    const std::string field = word(3, "field", {"real", "integer", "double"});
    symmetry_ = word(4, "symmetry", {"general", "symmetric", "skew-symmetric"});
    if (field != "double") return;
    const auto at = static_cast<std::size_t>(words_[3].data() - result_.text.data());
    result_.text.replace(at, field.size(), "real  ");  // same length: the lines stay where they are
  }

  std::uintmax_t whole(std::string_view word, const char* what, std::uintmax_t low, std::uintmax_t high) const {
    std::uintmax_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || value < low || value > high)
      refuse_line(std::string(what) + " '" + std::string(word.substr(0, 40)) + "': must be a whole number in [" +
                  std::to_string(low) + ", " + std::to_string(high) + "]");
    return value;
  }

  void check_sizes() {
    const std::size_t count = result_.dense ? 2 : 3;
    if (!next_line(true) || words_.size() != count)
      refuse_line(std::string("must hold the sizes: rows columns") + (result_.dense ? "" : " entries"));
    // Two characters an entry at the least: a file that announces more than it can hold would only cost memory.
    const std::uintmax_t bytes = result_.text.size(), most = 100000000;
    rows_ = whole(words_[0], "rows", 0, most);
    cols_ = whole(words_[1], "columns", 0, most);
    if (!result_.dense) {
      entries_ = whole(words_[2], "entries", 0, bytes / 2);
      if (rows_ > bytes || cols_ > bytes) refuse_line("announces more rows or columns than the file has bytes");
      return;
    }
    if (symmetry_ != "general" && rows_ != cols_) refuse_line("symmetry " + symmetry_ + ": must be square");
    entries_ = symmetry_ == "general"     ? rows_ * cols_
               : symmetry_ == "symmetric" ? rows_ * (rows_ + 1) / 2
                                          : rows_ * (rows_ - 1) / 2;
    if (rows_ > 0 && entries_ > bytes / 2)
      refuse_line("announces " + std::to_string(entries_) + " numbers: the file has only " + std::to_string(bytes) +
                  " bytes");
  }

  void check_entries() {
    std::uintmax_t found = 0;
    while (next_line(true)) {
      if (++found > entries_) refuse_line("one entry more than announced: " + std::to_string(entries_));
      if (words_.size() != (result_.dense ? 1U : 3U))
        refuse_line(result_.dense ? "must hold one number" : "must hold row column value");
      if (!result_.dense) {
        const auto row = whole(words_[0], "row", 1, rows_), column = whole(words_[1], "column", 1, cols_);
        if (symmetry_ != "general" && (row < column || (row == column && symmetry_ != "symmetric")))
          refuse_line("entry (" + std::to_string(row) + ", " + std::to_string(column) + "): " + symmetry_ +
                      " files hold entries " + (symmetry_ == "symmetric" ? "on or " : "") + "below the diagonal only");
      }
      const std::string value(words_.back());
      char* end = nullptr;
      std::strtod(value.c_str(), &end);
      if (end != value.c_str() + value.size()) refuse_line("value '" + value.substr(0, 40) + "': must be a number");
    }
    if (found < entries_)
      refuse(file_, "ends after " + std::to_string(found) + " entries: announced " + std::to_string(entries_));
  }

  const fs::path& file_;
  Text result_;
  std::string symmetry_;
  std::uintmax_t rows_ = 0, cols_ = 0, entries_ = 0;
  std::size_t position_ = 0, begin_ = 0, line_number_ = 0;
  std::vector<std::string_view> words_;
};

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

/// Calls use(kind, object) on what the file holds: a cholmod_dense if dense is requested, else unsymmetric sparse.
template <class Object, class Use>
void read(const fs::path& file, std::string& text, int prefer, int wanted, Use&& use) {
  Cholmod cholmod;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(fmemopen(text.data(), text.size(), "r"), &std::fclose);
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
    refuse(file, "entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) +
                     ") = " + detail::text_of(value) + ": must be " + (may_be_infinite ? "a number" : "finite"));
}

void check_square(const fs::path& file, std::size_t rows, std::size_t cols) {
  if (rows != cols || rows == 0)
    refuse(file, "is " + std::to_string(rows) + " x " + std::to_string(cols) + ": must be square and not empty");
}

/// CHOLMOD turns what it cannot fit into a number, "1e999" say, into infinity, and ±1e308 too: both are refused as
/// matrix entries, so a file cannot change its meaning on the way in.
Matrix read_dense(const fs::path& file, std::string& text) {
  DenseMatrix A;
  read<cholmod_dense>(file, text, 2, CHOLMOD_DENSE, [&](const cholmod_dense& x, cholmod_common&) {
    check_square(file, x.nrow, x.ncol);
    const auto n = static_cast<Index>(x.nrow);
    A = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x.x), n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) check_number(file, i, j, A(i, j), false);
  });
  return A;
}

Matrix read_sparse(const fs::path& file, std::string& text) {
  RowSparse A;
  read<cholmod_sparse>(file, text, 1, CHOLMOD_SPARSE, [&](cholmod_sparse& x, cholmod_common& common) {
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
  auto [text, dense] = Checker(file).check();
  return dense ? read_dense(file, text) : read_sparse(file, text);
}

Vector read_matrix_market_vector(const fs::path& file) {
  Text text = Checker(file).check();
  Vector result;
  const auto take = [&](const cholmod_dense& x, cholmod_common&) {
    if ((x.ncol != 1 && x.nrow != 1) || x.ncol * x.nrow == 0)
      refuse(file, "is " + std::to_string(x.nrow) + " x " + std::to_string(x.ncol) + ": must be one column");
    result = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x.x), static_cast<Index>(x.nrow * x.ncol));
    for (Index i = 0; i < result.size(); ++i) check_number(file, i, 0, result[i], true);
  };
  if (text.dense)
    read<cholmod_dense>(file, text.text, 2, CHOLMOD_DENSE, take);
  else
    read<cholmod_sparse>(file, text.text, 1, CHOLMOD_SPARSE, [&](cholmod_sparse& x, cholmod_common& common) {
      const auto free = [&common](cholmod_dense* dense) { cholmod_free_dense(&dense, &common); };
      const std::unique_ptr<cholmod_dense, decltype(free)> dense(cholmod_sparse_to_dense(&x, &common), free);
      if (!dense) refuse(file, "too large for the memory at hand");
      take(*dense, common);
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
