// Block sweeps on friction discs: the solve of one contact, and a sweep against its formula.
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/solvers/cones/cone_sweeps.h>

#include <doctest/doctest.h>
#include <Eigen/Dense>

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
