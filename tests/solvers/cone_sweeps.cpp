// Block sweeps on friction discs: the solve of one contact, and a sweep against its formula.
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/solvers/cones/cone_sweeps.h>
#include <orthant/solvers/cones/operator_sweeps.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

using namespace orthant;

TEST_CASE("cones: one sliding disc is found from any direction, with few exceptions") {
  Random random(82);
  int missed = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Eigen::Matrix3d B;
    for (double& value : B.reshaped()) value = random.normal();
    const Eigen::Matrix3d A = B * B.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    Lcp p;
    p.A = DenseMatrix(A), p.b = {-random.uniform(), random.normal(), random.normal()};
    p.lo = {0, -kInf, -kInf}, p.hi = {kInf, kInf, kInf};
    p.friction = {{.normal = 0, .first = 1, .rows = 2, .mu = random.uniform(0, 2)}};
    cones::Blocks blocks;
    blocks.load(p);
    DiscContact contact;
    contact.prepare(blocks, blocks[0], A.data());
    const double away = 1e-3 * random.uniform();
    Eigen::Vector3d z(1, p.b[1] + away, p.b[2]);  // along the slip
    missed += !contact.solve(p.b.data(), z.data());
  }
  CHECK(missed <= 6);
}

TEST_CASE("cones: a sweep solves each block with the others held: blocks of one, three and five rows") {
  Random random(83);
  for (const bool rolling : {false, true}) {
    CAPTURE(rolling);
    Lcp p = disc_contacts({.contacts = 6, .freedoms = 40, .rolling = rolling}, random).problem;
    p.friction.pop_back();  // of the last contact: single rows as well
    if (rolling) p.friction.pop_back();
    ConeForm form;
    REQUIRE(form.load(p));
    ConeSweeps sweeps;
    sweeps.load(form);
    const DenseMatrix A(Eigen::MatrixXd(form.A.view()));
    Vector z(Eigen::VectorXd::Zero(form.size())), expected = z;
    for (const bool backward : {false, true, false}) {
      for (int k = 0; k < form.blocks(); ++k) {
        const int c = backward ? form.blocks() - 1 - k : k, m = form.block(c).rows, i = form.begin(c);
        const Eigen::MatrixXd own = A.block(i, i, m, m);
        const Eigen::VectorXd q = form.q.segment(i, m) + A.middleRows(i, m) * expected - own * expected.segment(i, m);
        Eigen::VectorXd of_block = expected.segment(i, m);
        solve_contact(form.all(), form.block(c), own.data(), q.data(), of_block.data());
        expected.segment(i, m) = of_block;
      }
      sweeps.sweep(z, 1, backward);
      CHECK((z - expected).norm() <= 1e-9 * (1 + expected.norm()));
    }
  }
}

namespace {

/// Spheres of 1 kg and 0.1 m on a grid of side³ places, each in contact with the next ones along x, y, z and those of
/// the lowest layer with the floor: a normal row and a disc each, as an operator. They fall onto the floor, and are
/// pushed to a side.
Lcp grid_of_spheres(int nx, int ny, int nz, Random& random) {
  Delassus A;
  A.W.cols = Index{6} * nx * ny * nz;
  A.inverse_mass = Eigen::VectorXd::Ones(A.W.cols);
  for (Index k = 0; k < A.W.cols; ++k)
    if (k % 6 > 2) A.inverse_mass[k] = 250;  // 2/5 m r²
  const auto body = [&](int x, int y, int z) { return x + nx * (y + ny * z); };
  std::vector<std::array<int, 3>> contacts;  // body, other or −1, direction
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        if (x + 1 < nx) contacts.push_back({body(x + 1, y, z), body(x, y, z), 0});
        if (y + 1 < ny) contacts.push_back({body(x, y + 1, z), body(x, y, z), 1});
        contacts.push_back({body(x, y, z), z > 0 ? body(x, y, z - 1) : -1, 2});
      }
  const auto count = static_cast<int>(contacts.size());
  Lcp p;
  p.b.resize(Index{3} * count), p.lo.resize(Index{3} * count), p.hi.resize(Index{3} * count);
  p.lo.setConstant(-kInf), p.hi.setConstant(kInf);
  const auto add = [&](int of, double sign, const Eigen::Vector3d& along, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d turn = -0.1 * normal.cross(along);  // the arm is ∓0.1 n
    for (int k = 0; k < 3; ++k) A.W.column.push_back(6 * of + k), A.W.value.push_back(sign * along[k]);
    for (int k = 0; k < 3; ++k) A.W.column.push_back(6 * of + 3 + k), A.W.value.push_back(turn[k]);
  };
  const auto add_row = [&](int c, int t) {  // t = 0: the normal; columns ascend, as b < a
    const auto [a, b, direction] = contacts[at(c)];
    const Eigen::Vector3d n = Eigen::Vector3d::Unit(direction), along = Eigen::Vector3d::Unit((direction + t) % 3);
    if (b >= 0) add(b, -1, along, n);
    add(a, 1, along, n);
    A.W.start.push_back(static_cast<int>(A.W.column.size()));
  };
  for (int c = 0; c < count; ++c) add_row(c, 0);
  for (int c = 0; c < count; ++c) add_row(c, 1), add_row(c, 2);
  A.W.rows = Index{3} * count;
  for (int c = 0; c < count; ++c) {
    const bool floor = contacts[at(c)][1] < 0;
    p.lo[c] = 0;
    p.b[c] = floor ? -0.01 : -1e-3 * random.uniform();
    p.b[count + 2 * c] = 1e-3 * random.normal(), p.b[count + 2 * c + 1] = 1e-3 * random.normal();
    p.friction.push_back({.normal = c, .first = Index{count} + 2 * c, .rows = 2, .mu = 0.3});
  }
  p.A = std::move(A);
  return p;
}

}  // namespace

TEST_CASE("cones: sweeps of an operator that is not formed are those of its entries, and keep their residual") {
  Random random(84);
  for (const bool rolling : {false, true}) {
    CAPTURE(rolling);
    Lcp p = rolling ? disc_contacts({.contacts = 6, .freedoms = 40, .rolling = true}, random).problem
                    : grid_of_spheres(3, 3, 4, random);
    if (rolling) {
      DenseMatrix A;
      to_dense(p.A, A);
      const Eigen::MatrixXd root = Eigen::MatrixXd(A).llt().matrixL();
      Delassus same;
      same.W = RowSparse::from(root.sparseView());
      same.inverse_mass = Eigen::VectorXd::Ones(A.cols());
      same.regularization = Eigen::VectorXd::Constant(A.rows(), 0.1);
      p.A = same;
    }
    ConeForm formed, unformed;
    REQUIRE(formed.load(p));
    unformed.load_unformed(p);
    ConeSweeps by_entries;
    by_entries.load(formed);
    OperatorSweeps sweeps;
    sweeps.load(unformed);
    Vector z(Eigen::VectorXd::Zero(formed.size())), expected = z, w;
    sweeps.start(z);
    for (int k = 0; k < 100; ++k) {  // the state is summed up again on the way
      const double moved = sweeps.sweep(z, 1.2, k % 3 == 1), as_expected = by_entries.sweep(expected, 1.2, k % 3 == 1);
      CHECK(moved == doctest::Approx(as_expected).epsilon(1e-6));
    }
    CHECK((z - expected).norm() <= 1e-9 * expected.norm());
    formed.apply(z, w);
    CHECK(sweeps.residual(z) == doctest::Approx(formed.residual(z, w)).epsilon(1e-6).scale(1e-9));
    Vector product;
    unformed.apply(z, product);
    CHECK((product - w).norm() <= 1e-12 * (1 + w.norm()));
  }
}

TEST_CASE("cones: domains hold each contact once, one colour's share no velocity, threads change no bit") {
  Random random(85);
  const Lcp p = grid_of_spheres(12, 11, 13, random);
  REQUIRE(p.friction.size() > SweepDomains::kAlone);
  ConeForm form;
  form.load_unformed(p);
  SweepDomains domains;
  domains.load(form);
  CHECK(domains.count() > 10);
  CHECK(domains.colours() < 30);
  std::vector<int> met(p.friction.size(), 0);
  const RowSparse& W = form.operand().W;
  for (int colour = 0; colour < domains.colours(); ++colour) {
    std::vector<int> owner(at(W.cols), -1);
    int shared = 0;
    for (const int domain : domains.domains(colour))
      for (const int c : domains.contacts(domain)) {
        ++met[at(c)];
        for (const int row : form.rows(c))
          W.for_each_in_row(row, [&](Index k, double) {
            shared += owner[at(k)] >= 0 && owner[at(k)] != domain;
            owner[at(k)] = domain;
          });
      }
    CHECK(shared == 0);
  }
  CHECK(std::ranges::all_of(met, [](int times) { return times == 1; }));

  std::vector<Vector> answers;
  std::vector<double> residuals;
  for (const int threads : {1, 2, 5}) {
    ThreadTeam team(threads);
    OperatorSweeps sweeps;
    sweeps.load(form, &team);
    Vector z(Eigen::VectorXd::Zero(form.size()));
    sweeps.start(z);
    for (int k = 0; k < 70; ++k) sweeps.sweep(z, 1.2, k % 2 == 1);
    residuals.push_back(sweeps.residual(z));
    answers.push_back(z);
  }
  CHECK(residuals[0] < 0.5);
  for (const std::size_t k : {1U, 2U}) CHECK((answers[k] == answers[0] && residuals[k] == residuals[0]));
  for (const std::string spec : {"pgs", "psor", "sgs", "nncg"}) {
    CAPTURE(spec);
    Solution one, two;
    make_solver(spec + ":tolerance=1e-9,max_sweeps=20")->solve(p, one);
    make_solver(spec + ":tolerance=1e-9,max_sweeps=20,threads=2")->solve(p, two);
    CHECK(one.iterations == 20);
    CHECK((one.z == two.z && one.residual == two.residual && one.z.norm() > 0));
  }
}

TEST_CASE("cones: on a column the sweeps of nncg grow like its height, those of pgs like the square") {
  Random random(86);
  const auto sweeps = [&](const char* solver, int height) {
    Lcp p = grid_of_spheres(1, 1, height, random);
    for (Index i = 1; i < p.size(); ++i) p.b[i] = 0;  // at rest but for the weight on the floor
    Solution s;
    CHECK(make_solver(std::string(solver) + ":tolerance=1e-6,max_sweeps=100000")->solve(p, s).status == Status::solved);
    return static_cast<double>(s.iterations);
  };
  const double slow = sweeps("pgs", 80) / sweeps("pgs", 20), fast = sweeps("nncg", 80) / sweeps("nncg", 20);
  MESSAGE("four times the height: pgs ", slow, " times the sweeps, nncg ", fast);
  CHECK(slow > 8);
  CHECK(fast < 6);
}
