// Contact problems in the FCLIB format: written and read back, solved, and one clear line for files that lie.
#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/support/file.h>
#include <orthant/solvers/registry.h>

#include "tests/support/folder.h"
#include "tests/support/judge.h"

#include <H5Cpp.h>
#include <doctest/doctest.h>

using namespace orthant;

namespace {

std::string real_file(const char* name) { return std::string(ORTHANT_TEST_DATA) + "/fclib/" + name; }

Solution solution_by(const Lcp& problem, const char* solver = "auto") {
  Solution s;
  make_solver(solver)->solve(problem, s);
  return s;
}

void must_fail(const std::string& file, const std::string& words) {
  std::string said;
  try {
    read_fclib(file);
  } catch (const std::runtime_error& error) {
    said = error.what();
  }
  CAPTURE(said);
  CHECK(said.find(words) != std::string::npos);
  CHECK(said.find('\n') == std::string::npos);
}

}  // namespace

TEST_CASE("fclib: piles written and read back are the same problems") {
  const Folder folder;
  for (const bool spatial : {false, true}) {
    CAPTURE(spatial);
    ContactProblem p{box_column(3, {.mu = 0.4, .mass_ratio = 3, .spatial = spatial, .discs = spatial}), spatial ? 3 : 2,
                     0, "column", "3 boxes"};
    p.contacts = p.problem.size() / p.dimension;
    write_fclib(folder / "p.hdf5", p);
    const ContactProblem q = read_fclib(folder / "p.hdf5");
    CHECK(q.title == "column");
    CHECK(q.description == "3 boxes");
    CHECK(q.dimension == p.dimension);
    CHECK(q.contacts == p.contacts);
    const auto &A = std::get<Delassus>(p.problem.A), &B = std::get<Delassus>(q.problem.A);
    CHECK(A.W.column == B.W.column);
    CHECK(A.W.value == B.W.value);
    CHECK((A.inverse_mass - B.inverse_mass).cwiseAbs().maxCoeff() < 1e-16);
    CHECK(p.problem.b == q.problem.b);
    CHECK(p.problem.lo == q.problem.lo);
    REQUIRE(p.problem.friction.size() == q.problem.friction.size());
    for (std::size_t k = 0; k < p.problem.friction.size(); ++k) {
      CHECK(q.problem.friction[k].mu == 0.4);
      CHECK(q.problem.friction[k].rows == (spatial ? 2 : 1));
    }

    DenseMatrix entries;
    to_dense(p.problem.A, entries);
    p.problem.A = entries;
    write_fclib(folder / "local.hdf5", p);
    const ContactProblem local = read_fclib(folder / "local.hdf5");
    DenseMatrix back;
    to_dense(local.problem.A, back);
    CHECK(back == entries);
    CHECK(solution_by(local.problem).status == Status::solved);
  }
}

TEST_CASE("fclib: joints stand behind the contacts as free rows, a full mass matrix is multiplied out") {
  // One point of mass 2 on the ground, pushed by (3, -4), its x held by a joint: r_n = 4, r_t of no use, the joint
  // bears 3.
  ContactProblem p{{}, 2, 1, "", ""};
  Eigen::SparseMatrix<double, Eigen::RowMajor> J(3, 2);
  J.insert(0, 1) = 1, J.insert(1, 0) = 1, J.insert(2, 0) = 1;
  p.problem.A = Delassus{RowSparse::from(J), {0.5, 0.5}, {}};
  p.problem.b = {-2, 1.5, 1.5}, p.problem.lo = {0, -kInf, -kInf}, p.problem.hi = {kInf, kInf, kInf};
  p.problem.friction = {{0, 1, 1, 0.0}};
  const Folder folder;
  write_fclib(folder / "p.hdf5", p);
  const auto check_it = [&] {
    const Solution s = solution_by(read_fclib(folder / "p.hdf5").problem);
    REQUIRE(s.status == Status::solved);
    CHECK(s.z[0] == doctest::Approx(4));
    CHECK(s.z[1] == 0);
    CHECK(s.z[2] == doctest::Approx(-3));
  };
  check_it();
  {  // the same masses, told as a matrix with an entry beside the diagonal that a second one takes away again
    H5::H5File file(folder / "p.hdf5", H5F_ACC_RDWR);
    const int p_rows[] = {0, 2, 3}, columns[] = {0, 1, 1};
    const double values[] = {2, 1e-14, 2};
    const hsize_t three = 3;
    for (const char* name : {"p", "i", "x"}) file.unlink(std::string("fclib_global/M/") + name);
    const H5::DataSpace space(1, &three);
    file.createDataSet("fclib_global/M/p", H5::PredType::NATIVE_INT, space).write(p_rows, H5::PredType::NATIVE_INT);
    file.createDataSet("fclib_global/M/i", H5::PredType::NATIVE_INT, space).write(columns, H5::PredType::NATIVE_INT);
    file.createDataSet("fclib_global/M/x", H5::PredType::NATIVE_DOUBLE, space)
        .write(values, H5::PredType::NATIVE_DOUBLE);
  }
  CHECK(std::holds_alternative<RowSparse>(read_fclib(folder / "p.hdf5").problem.A));
  check_it();
}

TEST_CASE("fclib: a global problem is written back as it was read, with a solution that fits it") {
  // A point on the ground, masses coupled, pushed by f = (3, -4): r_n = 4, slides or sticks; v = M⁻¹(f + H r).
  ContactProblem p{{}, 2, 1, "", ""};
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(2, 2), J(2, 2);
  M.insert(0, 0) = 2, M.insert(1, 1) = 3, J.insert(0, 1) = 1, J.insert(1, 0) = 1;
  const auto read_number = [](const H5::H5File& file, const char* set, Index i) {
    double x[2] = {};
    file.openDataSet(set).read(x, H5::PredType::NATIVE_DOUBLE);
    return x[i];
  };
  for (const double coupling : {0.0, 0.5, 3.0}) {
    CAPTURE(coupling);
    const Folder folder;
    if (coupling != 0) M.coeffRef(0, 1) = M.coeffRef(1, 0) = coupling;
    const Eigen::Vector2d f(3, -4), w(0.25, 0.125);
    const Eigen::Matrix2d inverse = Eigen::Matrix2d(M).inverse();
    const Eigen::Matrix2d H = Eigen::Matrix2d(J).transpose();
    p.problem.A = DenseMatrix(Eigen::MatrixXd(H.transpose() * inverse * H));
    p.problem.b = Eigen::VectorXd(H.transpose() * inverse * f + w);
    p.problem.lo = {0, -kInf}, p.problem.hi = {kInf, kInf}, p.problem.friction = {{0, 1, 1, 0.4}};
    p.global = {RowSparse::from(M), RowSparse::from(J), Vector(f), Vector(w)};
    write_fclib(folder / "p.hdf5", p);
    if (coupling == 3) {  // not positive definite: 2 * 3 < 3 * 3
      CHECK_THROWS_WITH_AS(read_fclib(folder / "p.hdf5"), doctest::Contains("positive definite"), std::runtime_error);
      continue;
    }
    const ContactProblem first = read_fclib(folder / "p.hdf5");
    const Solution s = solution_by(first.problem);
    REQUIRE(s.status == Status::solved);
    write_fclib(folder / "again.hdf5", first, &s);
    const ContactProblem again = read_fclib(folder / "again.hdf5");
    CHECK(again.problem.b == first.problem.b);
    CHECK(again.solution == s.z);
    CHECK(again.unfit.empty());
    {
      const H5::H5File file(folder / "again.hdf5", H5F_ACC_RDWR);
      for (const Index i : {0, 1}) {
        CHECK(read_number(file, "fclib_global/vectors/f", i) == f[i]);
        CHECK(read_number(file, "fclib_global/vectors/w", i) == w[i]);
        const Eigen::Vector2d v = inverse * (f + H * s.z);
        CHECK(read_number(file, "solution/v", i) == doctest::Approx(v[i]).epsilon(1e-12));
      }
      // A solution of another problem is no reason to lose this one.
      H5::H5File changed(folder / "again.hdf5", H5F_ACC_RDWR);
      changed.unlink("solution/r");
      const hsize_t three = 3;
      const double r[] = {1, 2, 3};
      changed.createDataSet("solution/r", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &three))
          .write(r, H5::PredType::NATIVE_DOUBLE);
    }
    const ContactProblem unfit = read_fclib(folder / "again.hdf5");
    CHECK(unfit.solution.size() == 0);
    CHECK(unfit.unfit.find("solution/r has 3 entries: must have 2") != std::string::npos);
  }
}

TEST_CASE("fclib: real files are read and solved") {
  const ContactProblem boxes = read_fclib(real_file("Box_Stacks-i0122-82-5.hdf5"));
  CHECK(boxes.title == "Box_stacks");
  CHECK(boxes.dimension == 3);
  CHECK(boxes.contacts == 82);
  const ContactProblem capsules = read_fclib(real_file("Capsules-i125-1213.hdf5"));
  CHECK(capsules.contacts == 286);
  CHECK(capsules.problem.friction.size() == 286);
  CHECK(capsules.problem.friction.front().rows == 2);
  CHECK(capsules.problem.friction.front().mu == 0.7);
  const Solution s = solution_by(boxes.problem);
  CHECK(s.status == Status::solved);
}

TEST_CASE("fclib: redundant capsules with unsymmetric W are solved to 1e-12, the answer written next to the problem") {
  const Folder folder;
  ContactProblem capsules = read_fclib(real_file("Capsules-i125-1213.hdf5"));
  const Solution s = solution_by(capsules.problem, "auto:tolerance=1e-11");
  CHECK(s.status == Status::solved);
  CHECK(independent_scale_free(capsules.problem, s.z) <= 1e-12);
  write_fclib(folder / "p.hdf5", capsules, &s);
  const ContactProblem back = read_fclib(folder / "p.hdf5");
  CHECK(back.solution == s.z);
  const H5::H5File file(folder / "p.hdf5", H5F_ACC_RDONLY);
  double written = 1;
  file.openDataSet("solution/residual_scale_free").read(&written, H5::PredType::NATIVE_DOUBLE);
  CHECK(written == cone_residuals(capsules.problem, s.z).scale_free);
}

TEST_CASE("fclib: rolling resistance and further unknowns, local and global, in every storage") {
  const Folder folder;
  Random random(5);
  const Known known = disc_contacts({.contacts = 4, .rolling = true}, random);
  ContactProblem p{known.problem, 5, 4, "rolling", ""};
  write_fclib(folder / "rolling.hdf5", p);
  const ContactProblem rolling = read_fclib(folder / "rolling.hdf5");
  CHECK(rolling.dimension == 5);
  REQUIRE(rolling.problem.friction.size() == 8);
  CHECK(rolling.problem.friction[1].first == 3);
  CHECK(rolling.problem.friction[1].mu == doctest::Approx(0.05));
  CHECK(cone_residuals(rolling.problem, known.z).scale_free <= 1e-12);

  // Two more unknowns, coupled as FCLIB's V and R are: free rows behind the contacts.
  ContactProblem coupled = p;
  const Index n = known.problem.size();
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n + 2, n + 2);
  A.topLeftCorner(n, n) = std::get<DenseMatrix>(known.problem.A);
  A.block(0, n, n, 2).setConstant(0.5), A.block(n, 0, 2, n).setConstant(0.5);
  Lcp& q = coupled.problem;
  q.A = DenseMatrix(A), q.b.resize(n + 2), q.lo.resize(n + 2), q.hi.resize(n + 2);
  q.b.head(n) = known.problem.b, q.lo.head(n) = known.problem.lo, q.hi.head(n) = known.problem.hi;
  q.b.tail(2) << 3, 4;
  q.lo.tail(2).setConstant(-kInf), q.hi.tail(2).setConstant(kInf);
  write_fclib(folder / "coupled.hdf5", coupled);
  const ContactProblem back = read_fclib(folder / "coupled.hdf5");
  DenseMatrix B;
  to_dense(back.problem.A, B);
  CHECK(B == A);
  CHECK(back.problem.b == q.b);
  CHECK(back.problem.lo == q.lo);
  A(n, 0) += 1;
  q.A = DenseMatrix(A);
  CHECK_THROWS_WITH_AS(write_fclib(folder / "no.hdf5", coupled), doctest::Contains("symmetrically"),
                       std::invalid_argument);

  // Triplets, two of which meet, and compressed columns say the same as rows.
  const auto stored = [&](int nz, std::vector<int> rows, std::vector<int> columns, std::vector<double> values) {
    folder.write("stored.hdf5", slurp(folder / "one.hdf5"));
    H5::H5File file(folder / "stored.hdf5", H5F_ACC_RDWR);
    const auto put = [&](const std::string& name, const void* data, std::size_t size, const H5::PredType& type) {
      const hsize_t count = size;
      file.unlink("fclib_local/W/" + name);
      file.createDataSet("fclib_local/W/" + name, type, H5::DataSpace(1, &count)).write(data, type);
    };
    put("nz", &nz, 1, H5::PredType::NATIVE_INT);
    put("i", rows.data(), rows.size(), H5::PredType::NATIVE_INT);
    put("p", columns.data(), columns.size(), H5::PredType::NATIVE_INT);
    put("x", values.data(), values.size(), H5::PredType::NATIVE_DOUBLE);
    file.close();
    DenseMatrix W;
    to_dense(read_fclib(folder / "stored.hdf5").problem.A, W);
    return W;
  };
  ContactProblem one{{}, 3, 1, "", ""};
  const Eigen::Matrix3d W = (Eigen::Matrix3d() << 2, 0.5, 0, 0.25, 3, 0, 0, 0, 4).finished();  // not symmetric
  one.problem.A = DenseMatrix(W), one.problem.b = {-1, 0, 0};
  one.problem.lo = {0, -kInf, -kInf}, one.problem.hi = {kInf, kInf, kInf};
  one.problem.friction = {{.normal = 0, .first = 1, .rows = 2, .mu = 0.5}};
  write_fclib(folder / "one.hdf5", one);
  CHECK(stored(6, {0, 0, 1, 1, 2, 2}, {0, 1, 0, 1, 2, 2}, {2, 0.5, 0.25, 3, 1, 3}) == W);
  CHECK(stored(-1, {0, 1, 0, 1, 2}, {0, 2, 4, 5}, {2, 0.25, 0.5, 3, 4}) == W);
}

TEST_CASE("fclib: bodies with full mass blocks: the velocity of the solution") {
  const Folder folder;
  ContactProblem boxes = read_fclib(real_file("Box_Stacks-i0122-82-5.hdf5"));
  const Solution s = solution_by(boxes.problem);
  CHECK(s.status == Status::solved);
  const Vector v = boxes.velocity(s.z);
  REQUIRE(v.size() == std::get<Delassus>(boxes.problem.A).W.cols);
  const Eigen::VectorXd offset = boxes.global->offset;  // u = Hᵀv + w: the contacts' part of w = A z + b
  const Eigen::VectorXd u = boxes.global->jacobian.view() * v + offset;
  CHECK((u - s.w).cwiseAbs().maxCoeff() <= 1e-12 * s.w.cwiseAbs().maxCoeff());
}

TEST_CASE("fclib: a reading error names file, dataset and reason") {
  const Folder folder;
  must_fail(folder / "none.hdf5", "no such file");
  must_fail(folder.write("text.hdf5", "not HDF5 at all"), "is no HDF5 file");
  const std::string whole = slurp(real_file("Capsules-i125-1213.hdf5"));
  for (const std::size_t length : {whole.size() / 2, whole.size() - 1, std::size_t{600}})
    must_fail(folder.write("cut.hdf5", whole.substr(0, length)), "cut.hdf5: ");
  { H5::H5File(folder / "empty.hdf5", H5F_ACC_TRUNC); }
  must_fail(folder / "empty.hdf5", "fclib_local or fclib_global");

  const auto changed = [&](const char* path, auto value, const H5::PredType& type) {
    folder.write("bad.hdf5", whole);
    H5::H5File file(folder / "bad.hdf5", H5F_ACC_RDWR);
    file.unlink(path);
    const hsize_t one = 1;
    file.createDataSet(path, type, H5::DataSpace(1, &one)).write(&value, type);
  };
  changed("fclib_local/spacedim", 4, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "fclib_local/spacedim = 4: must be 2 or 3");
  changed("fclib_local/W/nz", -3, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "fclib_local/W/nz = -3");
  changed("fclib_local/W/m", -1, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "sizes must be >= 0");
  changed("fclib_local/W/m", 857, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "fclib_local/W/p must ascend");
  changed("fclib_local/W/n", 100, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "fclib_local/W has an entry at");
  changed("fclib_local/vectors/q", std::nan(""), H5::PredType::NATIVE_DOUBLE);
  must_fail(folder / "bad.hdf5", "fclib_local/vectors/q has 1 entries: must have 858");
  changed("fclib_local/W/n", 857, H5::PredType::NATIVE_INT);
  must_fail(folder / "bad.hdf5", "fclib_local/W");
  const auto with = [&](const char* path, std::size_t count, double last) {
    folder.write("bad.hdf5", whole);
    H5::H5File file(folder / "bad.hdf5", H5F_ACC_RDWR);
    file.unlink(path);
    const std::vector<double> values = [&] {
      std::vector<double> list(count, 0.5);
      list.back() = last;
      return list;
    }();
    const hsize_t length = count;
    file.createDataSet(path, H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &length))
        .write(values.data(), H5::PredType::NATIVE_DOUBLE);
  };
  with("fclib_local/vectors/mu", 286, -0.25);
  must_fail(folder / "bad.hdf5", "fclib_local/vectors/mu[285] = -0.25: must be >= 0");
  with("fclib_local/vectors/q", 858, kInf);
  must_fail(folder / "bad.hdf5", "fclib_local/vectors/q[857] = inf: must be finite");
  changed("fclib_local/W/m", 1.5, H5::PredType::NATIVE_DOUBLE);
  must_fail(folder / "bad.hdf5", "must hold whole numbers");
  {
    folder.write("bad.hdf5", whole);
    H5::H5File file(folder / "bad.hdf5", H5F_ACC_RDWR);
    file.unlink("fclib_local/vectors/mu");
    const hsize_t endless = hsize_t{1} << 40;  // an address space full, promised by a hundred bytes
    file.createDataSet("fclib_local/vectors/mu", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &endless), [] {
      H5::DSetCreatPropList late;
      const hsize_t chunk = 1024;
      late.setChunk(1, &chunk);
      return late;
    }());
  }
  must_fail(folder / "bad.hdf5", "fclib_local/vectors/mu: 8796093022208 bytes: must be at most 1 GiB");
}

TEST_CASE("fclib: a file is as large as largest_input() lets it be") {
  const Folder folder;
  ContactProblem p{box_column(2, {.mu = 0.4}), 2, 0, "", ""};
  p.contacts = p.problem.size() / p.dimension;
  write_fclib(folder / "p.hdf5", p);
  const auto size = std::filesystem::file_size(folder / "p.hdf5");
  set_largest_input(size - 1);
  must_fail(folder / "p.hdf5", "p.hdf5: " + std::to_string(size) + " bytes: must be at most ");
  set_largest_input(size);
  CHECK(read_fclib(folder / "p.hdf5").contacts == p.contacts);
  set_largest_input(0);
}

TEST_CASE("fclib: a problem that is not a contact problem is not written") {
  const Folder folder;
  const auto refuse = [&](const ContactProblem& p, const char* words) {
    CHECK_THROWS_WITH_AS(write_fclib(folder / "p.hdf5", p), doctest::Contains(words), std::invalid_argument);
    CHECK(!std::filesystem::exists(folder / "p.hdf5"));
  };
  ContactProblem p{Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(2, 2)), {-1, 1}), 2, 1, "", ""};
  refuse(p, "row 1: must be friction of the normal row before it");
  p.contacts = 2;
  refuse(p, "contacts = 2");
  p.dimension = 4;
  refuse(p, "dimension = 4");
}
