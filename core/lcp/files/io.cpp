#include <orthant/core/lcp/files/io.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/shortened.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <set>
#include <stdexcept>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Reads fields of one object; every complaint names the file and the field.
class Reader {
 public:
  Reader(const std::string& file, std::string path, const Json& json)
      : file_(file), path_(std::move(path)), json_(json) {
    if (!json.is_object()) refuse("", "must be an object");
  }

  [[noreturn]] void refuse(const std::string& field, const std::string& rule) const {
    std::string where = path_ + field;
    if (where.ends_with('.')) where.pop_back();  // the object itself
    throw std::runtime_error(file_ + ": " + (where.empty() ? "the file" : where) + " " + rule);
  }
  void only(std::initializer_list<const char*> known) const {
    for (const auto& [key, value] : json_.items()) {
      bool found = false;
      std::string list;
      for (const char* k : known) found = found || key == k, list += (list.empty() ? "" : ", ") + std::string(k);
      if (!found) refuse(key.substr(0, 60), "is no known field: must be one of " + list);
    }
  }
  bool has(const char* field) const { return json_.contains(field); }
  const Json& at(const char* field) const {
    if (!has(field)) refuse(field, "is missing");
    return json_[field];
  }
  Reader object(const char* field) const { return {file_, path_ + field + ".", at(field)}; }
  std::string text(const char* field) const {
    if (!at(field).is_string()) refuse(field, "must be a text");
    return at(field).get<std::string>();
  }
  double number(const Json& value, const std::string& field, bool may_be_infinite = false) const {
    if (may_be_infinite && value == "inf") return kInf;
    if (may_be_infinite && value == "-inf") return -kInf;
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      refuse(field,
             "= " + shown(value) + ": must be a finite number" + (may_be_infinite ? ", \"inf\" or \"-inf\"" : ""));
    return value.get<double>();
  }
  Index whole(const Json& value, const std::string& field, Index low, Index high) const {
    if (!value.is_number_integer() || value.get<double>() < static_cast<double>(low) ||
        value.get<double>() > static_cast<double>(high))
      refuse(field, "= " + shown(value) + ": must be a whole number in [" + std::to_string(low) + ", " +
                        std::to_string(high) + "]");
    return value.get<Index>();
  }
  const Json& list(const char* field) const {
    if (!at(field).is_array()) refuse(field, "must be a list");
    return at(field);
  }
  std::vector<double> numbers(const char* field, bool may_be_infinite = false) const {
    std::vector<double> values;
    for (const Json& value : list(field))
      values.push_back(number(value, indexed(field, values.size()), may_be_infinite));
    return values;
  }
  std::vector<int> indices(const char* field, Index high) const {
    std::vector<int> values;
    for (const Json& value : list(field))
      values.push_back(static_cast<int>(whole(value, indexed(field, values.size()), 0, high)));
    return values;
  }
  static std::string indexed(const std::string& field, std::size_t i) { return field + "[" + std::to_string(i) + "]"; }

 private:
  static std::string shown(const Json& value) { return value.dump().substr(0, 40); }
  const std::string& file_;
  std::string path_;
  const Json& json_;
};

/// Refuses while parsing what would be lost or too much: a key twice in one object, brackets deeper than the format.
class StrictShape {
 public:
  explicit StrictShape(const std::string& file) : file_(&file) {}
  bool operator()(int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth > 8) throw std::runtime_error(*file_ + ": brackets nested deeper than a problem file has them");
    const auto level = static_cast<std::size_t>(depth);
    if (event == Json::parse_event_t::object_start) {
      keys_.resize(level + 2);
      keys_[level + 1].clear();
    } else if (event == Json::parse_event_t::key) {
      if (level < keys_.size() && !keys_[level].insert(parsed.get<std::string>()).second)
        throw std::runtime_error(*file_ + ": " + parsed.get<std::string>().substr(0, 60) +
                                 " stands twice in one object");
    }
    return true;
  }

 private:
  const std::string* file_;
  std::vector<std::set<std::string>> keys_;  // per depth
};

Vector to_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
}

RowSparse read_rows(const Reader& r, Index rows, Index cols) {
  constexpr Index kMost = 2147483647;
  RowSparse A;
  A.rows = rows, A.cols = cols;
  A.start = r.indices("start", kMost);
  A.column = r.indices("column", std::max<Index>(0, cols - 1));
  A.value = r.numbers("value");
  if (static_cast<Index>(A.start.size()) != rows + 1) r.refuse("start", "must hold rows + 1 numbers");
  if (A.start.front() != 0 || A.start.back() != static_cast<Index>(A.value.size()) || A.column.size() != A.value.size())
    r.refuse("start", "must run from 0 to the length of column and of value");
  for (std::size_t i = 0; i + 1 < A.start.size(); ++i)  // all of them, before any is followed into column
    if (A.start[i] > A.start[i + 1]) r.refuse(Reader::indexed("start", i + 1), "must not be below the one before");
  for (std::size_t i = 0; i + 1 < A.start.size(); ++i)
    for (int k = A.start[i] + 1; k < A.start[i + 1]; ++k)
      if (A.column[static_cast<std::size_t>(k) - 1] >= A.column[static_cast<std::size_t>(k)])
        r.refuse(Reader::indexed("column", static_cast<std::size_t>(k)), "must ascend within a row");
  return A;
}

Matrix read_matrix(const Reader& r) {
  constexpr Index kMost = 100000000;
  const std::string storage = r.text("storage");
  if (storage == "dense") {
    r.only({"storage", "n", "rows"});
    const Json& rows = r.list("rows");
    const Index n = r.whole(r.at("n"), "n", 1, kMost);
    if (static_cast<Index>(rows.size()) != n)
      r.refuse("rows", "has " + std::to_string(rows.size()) + " rows: must have n");
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!rows[i].is_array() || static_cast<Index>(rows[i].size()) != n)
        r.refuse(Reader::indexed("rows", i), "must be a list of n numbers");
    DenseMatrix A;
    A.resize(n, n);
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
        A(i, j) = r.number(rows[row][column], Reader::indexed(Reader::indexed("rows", row), column));
      }
    return A;
  }
  if (storage == "sparse") {
    r.only({"storage", "n", "start", "column", "value"});
    const Index n = r.whole(r.at("n"), "n", 1, kMost);
    return read_rows(r, n, n);
  }
  if (storage == "delassus") {
    r.only({"storage", "W", "inverse_mass", "regularization"});
    const Reader w = r.object("W");
    w.only({"rows", "cols", "start", "column", "value"});
    Delassus A;
    A.W = read_rows(w, w.whole(w.at("rows"), "rows", 1, kMost), w.whole(w.at("cols"), "cols", 0, kMost));
    A.inverse_mass = to_vector(r.numbers("inverse_mass"));
    if (r.has("regularization")) A.regularization = to_vector(r.numbers("regularization"));
    return A;
  }
  r.refuse("storage", "= \"" + storage.substr(0, 40) + "\": must be dense, sparse or delassus");
}

Json numbers(const Eigen::Ref<const Eigen::VectorXd>& x) {
  Json list = Json::array();
  for (const double value : x) {
    if (std::isinf(value))
      list.push_back(value > 0 ? "inf" : "-inf");
    else
      list.push_back(value);
  }
  return list;
}

Json rows_of(const RowSparse& A) { return {{"start", A.start}, {"column", A.column}, {"value", A.value}}; }

Json matrix_of(const DenseMatrix& A) {
  Json rows = Json::array();
  for (Index i = 0; i < A.rows(); ++i) rows.push_back(numbers(A.row(i).transpose()));
  return {{"storage", "dense"}, {"n", A.rows()}, {"rows", rows}};
}
Json matrix_of(const RowSparse& A) {
  Json json = {{"storage", "sparse"}, {"n", A.rows}};
  json.update(rows_of(A));
  return json;
}
Json matrix_of(const Delassus& A) {
  Json W = {{"rows", A.W.rows}, {"cols", A.W.cols}};
  W.update(rows_of(A.W));
  Json json = {{"storage", "delassus"}, {"W", W}, {"inverse_mass", numbers(A.inverse_mass)}};
  if (A.regularization.size() > 0) json["regularization"] = numbers(A.regularization);
  return json;
}

}  // namespace

Lcp parse_problem(std::string_view text, const std::string& name) {
  Json json;
  try {
    json = Json::parse(text, StrictShape(name));
  } catch (const nlohmann::json::exception& error) {
    const std::string words = error.what();  // "[json.exception.parse_error.101] parse error at …"
    throw std::runtime_error(
        name + ": no JSON: " + shortened(words.substr(std::min(words.size(), words.find("] ") + 2)), 300));
  }
  const Reader r(name, "", json);
  r.only({"format", "version", "A", "b", "lo", "hi", "friction", "note"});
  if (r.text("format") != "orthant-lcp") r.refuse("format", "must be \"orthant-lcp\"");
  r.whole(r.at("version"), "version", 1, 1);
  if (r.has("note")) r.text("note");
  Lcp problem;
  problem.A = read_matrix(r.object("A"));
  problem.b = to_vector(r.numbers("b"));
  problem.lo = r.has("lo") ? to_vector(r.numbers("lo", true)) : Vector(Eigen::VectorXd::Zero(problem.size()));
  problem.hi = r.has("hi") ? to_vector(r.numbers("hi", true)) : Vector(Eigen::VectorXd::Constant(problem.size(), kInf));
  if (r.has("friction")) {
    const Json& list = r.list("friction");
    for (std::size_t i = 0; i < list.size(); ++i) {
      const Reader f(name, Reader::indexed("friction", i) + ".", list[i]);
      f.only({"row", "first", "rows", "normal", "mu"});
      if (f.has("row") == f.has("first"))
        f.refuse("first", std::string(f.has("row") ? "and row are both there" : "and row are both missing") +
                              ": must be one of them");
      const Index last = std::max<Index>(0, problem.size() - 1);
      const Index rows = f.has("rows") ? f.whole(f.at("rows"), "rows", 1, 2) : 1;
      const char* const first = f.has("row") ? "row" : "first";
      problem.friction.push_back({.normal = f.whole(f.at("normal"), "normal", 0, last),
                                  .first = f.whole(f.at(first), first, 0, std::max<Index>(0, last + 1 - rows)),
                                  .rows = rows,
                                  .mu = f.number(f.at("mu"), "mu")});
    }
  }
  for (const Friction& f : problem.friction)  // which sets their bounds
    for (Index i = f.first; i < std::min<Index>(f.first + f.rows, problem.size()); ++i) {
      if (!r.has("lo")) problem.lo[i] = -kInf;
      if (!r.has("hi")) problem.hi[i] = kInf;
    }
  try {
    check(problem);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
  return problem;
}

Lcp read_problem(const fs::path& file) {
  return parse_problem(read_whole(file, largest_input(kLargestProblem)), file.string());
}

std::string to_json(const Lcp& problem, std::string_view note) {
  Json json = {{"format", "orthant-lcp"}, {"version", 1}};
  if (!note.empty()) json["note"] = note;
  json["A"] = std::visit([](const auto& A) { return matrix_of(A); }, problem.A);
  json["b"] = numbers(problem.b);
  json["lo"] = numbers(problem.lo);
  json["hi"] = numbers(problem.hi);
  if (!problem.friction.empty()) {
    json["friction"] = Json::array();
    for (const Friction& f : problem.friction) {
      if (f.rows == 1)
        json["friction"].push_back({{"row", f.first}, {"normal", f.normal}, {"mu", f.mu}});
      else
        json["friction"].push_back({{"first", f.first}, {"rows", f.rows}, {"normal", f.normal}, {"mu", f.mu}});
    }
  }
  return json.dump(1) + "\n";
}

void write_problem(const fs::path& file, const Lcp& problem, std::string_view note) {
  write_whole(file, to_json(problem, note));
}

}  // namespace orthant
