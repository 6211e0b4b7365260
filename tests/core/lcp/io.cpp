#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>

#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

using namespace orthant;
namespace fs = std::filesystem;

namespace {

class IoFolder {  // of this test alone, gone afterwards
 public:
  IoFolder() : path_(fs::temp_directory_path() / ("orthant_io_" + std::to_string(getpid()))) {
    fs::create_directories(path_);
  }
  ~IoFolder() { fs::remove_all(path_); }
  IoFolder(const IoFolder&) = delete;
  IoFolder& operator=(const IoFolder&) = delete;
  fs::path write(const char* name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  fs::path operator/(const char* name) const { return path_ / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }

 private:
  fs::path path_;
};

bool same_to_the_bit(const Vector& a, const Vector& b) {  // bit for bit: −0 is not 0
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0);
}
bool same_to_the_bit(const RowSparse& a, const RowSparse& b) {
  return a.rows == b.rows && a.cols == b.cols && a.start == b.start && a.column == b.column && a.value == b.value;
}
bool same_to_the_bit(const Matrix& a, const Matrix& b) {
  if (a.index() != b.index()) return false;
  if (const auto* dense = std::get_if<DenseMatrix>(&a)) return *dense == std::get<DenseMatrix>(b);
  if (const auto* sparse = std::get_if<RowSparse>(&a)) return same_to_the_bit(*sparse, std::get<RowSparse>(b));
  const auto &x = std::get<Delassus>(a), &y = std::get<Delassus>(b);
  return same_to_the_bit(x.W, y.W) && same_to_the_bit(x.inverse_mass, y.inverse_mass) &&
         same_to_the_bit(x.regularization, y.regularization);
}
bool same_to_the_bit(const Lcp& a, const Lcp& b) {
  if (a.friction.size() != b.friction.size()) return false;
  for (std::size_t k = 0; k < a.friction.size(); ++k)
    if (a.friction[k].first != b.friction[k].first || a.friction[k].rows != b.friction[k].rows ||
        a.friction[k].normal != b.friction[k].normal || a.friction[k].mu != b.friction[k].mu)
      return false;
  return same_to_the_bit(a.A, b.A) && same_to_the_bit(a.b, b.b) && same_to_the_bit(a.lo, b.lo) &&
         same_to_the_bit(a.hi, b.hi);
}

template <class Read> std::string error(const Read& read) {
  const auto begin = std::chrono::steady_clock::now();
  std::string what;
  try {
    read();
  } catch (const std::exception& e) {
    what = e.what();
  }
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(2));
  CHECK(what.find('\n') == std::string::npos);  // one line
  return what;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("problem files bring every problem back bit for bit, in every storage") {
  const IoFolder folder;
  Random random(31);
  std::vector<Lcp> problems;
  for (const Known& k : known_problems()) problems.push_back(k.problem), problems.push_back(as_sparse(k.problem));
  for (int k = 0; k < 20; ++k) problems.push_back(random_contact_problem(1 + k % 4, 5, random.uniform(), random));
  problems.push_back(random_spd_problem(7, random));
  problems.back().b[0] = -0.0;
  problems.back().b[1] = 5e-324;
  problems.back().b[2] = -1.7976931348623157e308;
  for (const Lcp& p : problems) {
    write_problem(folder / "p.json", p, "a note: \"quoted\", ü, \n");
    CHECK(same_to_the_bit(read_problem(folder / "p.json"), p));
  }
  CHECK(folder.files() == 1);  // no temporary file left behind
}

TEST_CASE("Matrix Market files come back bit for bit") {
  const IoFolder folder;
  Random random(32);
  const Lcp p = random_spd_problem(6, random);
  write_matrix_market(folder / "M.mtx", p.A);
  write_matrix_market(folder / "q.mtx", p.b);
  CHECK(same_to_the_bit(read_matrix_market(folder / "M.mtx"), p.A));
  CHECK(same_to_the_bit(read_matrix_market_vector(folder / "q.mtx"), p.b));
  const Lcp sparse = as_sparse(p);
  write_matrix_market(folder / "S.mtx", sparse.A);
  CHECK(same_to_the_bit(read_matrix_market(folder / "S.mtx"), sparse.A));
}

TEST_CASE("Matrix Market: formats, fields and symmetries mean what the format says") {
  const IoFolder folder;
  const auto dense = [&](const std::string& text) {
    DenseMatrix A;
    to_dense(read_matrix_market(folder.write("m.mtx", text)), A);
    return Eigen::MatrixXd(A);
  };
  const std::string banner = "%%MatrixMarket matrix ";
  Eigen::Matrix2d M;
  M << 1, 2, 3, 4;
  CHECK(dense(banner + "array real general\n% by columns\n2 2\n1\n3\n2\n4\n") == M);
  CHECK(dense(banner + "array integer general\n2 2\n1\n3\n2\n4\n") == M);
  CHECK(dense(banner + "array double general\n2 2\n1\n3\n2\n4\n") == M);
  CHECK(dense("%%matrixmarket MATRIX Array Real General\n2 2\n1\n3\n2\n4\n") == M);
  CHECK(dense(banner + "coordinate real general\n2 2 4\n1 1 1\n1 2 2\n2 1 3\n2 2 4\n") == M);
  CHECK(dense(banner + "coordinate double general\n2 2 4\n1 1 1\n1 2 2\n2 1 3\n2 2 4\n") == M);
  M << 1, 3, 3, 4;
  CHECK(dense(banner + "array real symmetric\n2 2\n1\n3\n4\n") == M);
  CHECK(dense(banner + "coordinate real symmetric\n2 2 3\n1 1 1\n2 1 3\n2 2 4\n") == M);
  M << 0, -3, 3, 0;
  CHECK(dense(banner + "array real skew-symmetric\n2 2\n3\n") == M);
  CHECK(dense(banner + "coordinate real skew-symmetric\n2 2 1\n2 1 3\n") == M);
  M << 0, 0, 0, 2.5;
  CHECK(dense(banner + "coordinate real general\n2 2 1\n2 2 2.5\n") == M);
}

TEST_CASE("Matrix Market: errors are one line and come quickly") {
  const IoFolder folder;
  const auto why = [&](const std::string& text) {
    return error([&] { read_matrix_market(folder.write("m.mtx", text)); });
  };
  const std::string banner = "%%MatrixMarket matrix ";
  CHECK(contains(error([&] { read_matrix_market(folder / "none.mtx"); }), "none.mtx"));
  CHECK(contains(error([&] { read_matrix_market(folder / "."); }), "cannot read"));
  CHECK(contains(why(""), "banner"));
  CHECK(contains(why("2 2\n1\n3\n2\n4\n"), "banner"));
  CHECK(contains(why(banner + "array complex general\n1 1\n1 0\n"), "'complex': must be one of"));
  CHECK(contains(why(banner + "coordinate pattern general\n1 1 1\n1 1\n"), "'pattern'"));
  CHECK(contains(why(banner + "coordinate real hermitian\n1 1 1\n1 1 1\n"), "'hermitian'"));
  CHECK(contains(why(banner + "list real general\n1 1 1\n1 1 1\n"), "'list'"));
  CHECK(contains(why(banner + "array real general\n"), "sizes"));
  CHECK(contains(why(banner + "array real general\n2 x\n"), "line 2: columns 'x'"));
  CHECK(contains(why(banner + "array real general\n-2 -2\n1\n2\n3\n4\n"), "rows '-2'"));
  CHECK(contains(why(banner + "array real general\n2 3\n1\n2\n3\n4\n5\n6\n"), "2 x 3: must be square"));
  CHECK(contains(why(banner + "array real general\n1000000 1000000\n1\n"), "announces"));
  CHECK(contains(why(banner + "coordinate real general\n1e15 1e15 1\n1 1 1\n"), "rows '1e15'"));
  CHECK(contains(why(banner + "coordinate real general\n9 9 999999999\n1 1 1\n"), "entries '999999999'"));
  CHECK(contains(why(banner + "array real general\n2 2\n1\n2\nnan\n4\n"), "(1, 2)"));
  CHECK(contains(why(banner + "array real general\n2 2\n1\n2\ninf\n4\n"), "finite"));
  CHECK(contains(why(banner + "coordinate real general\n90000 90000 1\n1 1 1\n"), "more rows or columns"));
  CHECK(contains(why(banner + "array real general\n3 3\n1\n2\n3\n4\n5\n6\n7\n8\n"),
                 "ends after 8 entries"));  // truncated
  CHECK_FALSE(why(banner + "array real general\n2 2\n1\n2\nthree\n4\n").empty());
  CHECK_FALSE(why(banner + "coordinate real general\n2 2 2\n1 1 1\n").empty());
  CHECK_FALSE(why(banner + "coordinate real general\n2 2 1\n3 1 1\n").empty());
  CHECK_FALSE(why(banner + "coordinate real general\n2 2 1\n0 1 1\n").empty());  // indices start at 1
  CHECK_FALSE(why(banner + "coordinate real general\n2 2 1\n1 1\n").empty());    // no value
}

TEST_CASE("problem files: errors are one line and come quickly") {
  const std::string A = R"("A": {"storage": "dense", "n": 1, "rows": [[2]]})";
  const auto why = [](const std::string& fields) {
    return error([&] { parse_problem("{" + fields + "}", "file.json"); });
  };
  const std::string head = R"("format": "orthant-lcp", "version": 1, )";
  CHECK(why(head + A + R"(, "b": [1])") == "");
  CHECK(contains(error([] { parse_problem("{\"format\": ", "file.json"); }), "file.json"));  // truncated
  CHECK(error([] { parse_problem(std::string(400, '\n') + "nope", "file.json"); }).size() <
        400);  // quotes what it read
  CHECK(contains(error([] { parse_problem("[1, 2]", "file.json"); }), "object"));
  CHECK(contains(why(A + R"(, "b": [1])"), "format"));
  CHECK(why(head + R"("A": 3, "b": [1])") == "file.json: A must be an object");
  CHECK(contains(why(R"("format": "other", "version": 1, )" + A + R"(, "b": [1])"), "orthant-lcp"));
  CHECK(contains(why(R"("format": "orthant-lcp", "version": 2, )" + A + R"(, "b": [1])"), "version"));
  CHECK(contains(why(head + A), "b is missing"));
  CHECK(contains(why(head + A + R"(, "b": [1, 2])"), "b has 2 entries"));
  CHECK(contains(why(head + A + R"(, "b": ["inf"])"), "b[0]"));
  CHECK(contains(why(head + A + R"(, "b": [null])"), "finite number"));
  CHECK(contains(why(head + A + R"(, "b": [1e999])"), "file.json"));
  CHECK(contains(why(head + A + R"(, "b": [1], "lo": ["nan"])"), "lo[0]"));
  CHECK(contains(why(head + A + R"(, "b": [1], "lo": [2], "hi": [1])"), "lower <= upper"));
  CHECK(contains(why(head + A + R"(, "b": [1], "extra": 1)"), "extra"));
  CHECK(contains(why(head + R"("A": {"storage": "dense", "n": 2, "rows": [[1, 2]]}, "b": [1, 2])"), "rows"));
  CHECK(contains(why(head + R"("A": {"storage": "dense", "n": 1000000000000, "rows": [[1]]}, "b": [1])"), "n"));
  CHECK(contains(
      why(head +
          R"("A": {"storage": "sparse", "n": 99999999, "start": [0, 1], "column": [0], "value": [1]}, "b": [1])"),
      "start"));
  CHECK(contains(
      why(head + R"("A": {"storage": "sparse", "n": 1, "start": [0, 1], "column": [1], "value": [1]}, "b": [1])"),
      "column[0]"));
  CHECK(contains(  // start[1] leads out of column
      why(head + R"("A": {"storage": "sparse", "n": 2, "start": [0, 9, 1], "column": [0], "value": [1]}, "b": [1, 1])"),
      "start[2] must not be below"));
  CHECK(contains(why(head + R"("A": {"storage": "banded", "n": 1}, "b": [1])"), "banded"));
  CHECK(contains(why(head + A + R"(, "b": [1], "friction": [{"row": 0, "normal": 0, "mu": 0.5}])"), "friction[0]"));
  const auto friction = [&](const std::string& entry) {
    return why(head + R"("A": {"storage": "dense", "n": 3, "rows": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]},)" +
               R"("b": [1, 1, 1], "friction": [{)" + entry + "}]");
  };
  CHECK(friction(R"("first": 1, "rows": 2, "normal": 0, "mu": 0.5)") == "");
  CHECK(friction(R"("first": 2, "rows": 2, "normal": 0, "mu": 0.5)") ==
        "file.json: friction[0].first = 2: must be a whole number in [0, 1]");
  CHECK(friction(R"("row": 3, "normal": 0, "mu": 0.5)") ==
        "file.json: friction[0].row = 3: must be a whole number in [0, 2]");
  CHECK(friction(R"("row": true, "normal": 0, "mu": 0.5)") ==
        "file.json: friction[0].row = true: must be a whole number in [0, 2]");
  CHECK(friction(R"("row": 1, "first": 1, "normal": 0, "mu": 0.5)") ==
        "file.json: friction[0].first and row are both there: must be one of them");
  CHECK(friction(R"("normal": 0, "mu": 0.5)") ==
        "file.json: friction[0].first and row are both missing: must be one of them");
}

TEST_CASE("a file that cannot be written leaves nothing behind and says why") {
  const IoFolder folder;
  const Lcp p = known_problems().front().problem;
  CHECK(contains(error([&] { write_problem(folder / "no/such/folder.json", p); }), "cannot write"));
  write_problem(folder / "p.json", p);
  const auto size = fs::file_size(folder / "p.json");
  CHECK(contains(error([&] { write_problem(folder / ".", p); }), "cannot write"));
  CHECK(fs::file_size(folder / "p.json") == size);
  CHECK(folder.files() == 1);
}
