// Directional derivatives where rows are weakly active, redundant contacts, and reports of what has none.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/solvers/derivatives/differences_256.h"

using namespace orthant;

namespace {

// A positive definite and w = A z + b in small multiples of 1/8: exact in double, so that rows with z = w = 0 are.
Lcp exact_problem(const Eigen::VectorXd& z, const Eigen::VectorXd& w, Random& random, bool skew) {
  const Index n = z.size();
  Eigen::MatrixXd B(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) B(i, j) = random.integer(-4, 4) / 8.0;
  Eigen::MatrixXd A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
  if (skew) A += (B - B.transpose()) / 8;
  return Lcp::standard(DenseMatrix(A), Vector(w - A * z));
}

Solution exact_answer(const Lcp& p, const Eigen::VectorXd& z) {
  Solution s;
  s.z = z;
  return make_solver("auto")->solve(p, s, Start::warm);
}

void compare_directional(const Lcp& p, const Solution& s, std::size_t weak, Random& random, int directions) {
  const Sensitivity of = sensitivity(p, s);
  CHECK(of.report().weakly_active.size() == weak);
  for (int k = 0; k < directions; ++k) {
    INFO("direction ", k);
    Perturbation change = random_change(p, random);
    const Difference256 d = difference_256(p, s.z, change, true);
    if (!d.found) continue;  // Newton's method may cycle
    const SolutionTangent t = of.directional(change);
    CHECK((t.z - d.z).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.z.lpNorm<Eigen::Infinity>()));
    CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.w.lpNorm<Eigen::Infinity>()));
  }
}

// A plate on feet × feet feet (planar: feet), more than hold it; rows N T₁ T₂ (planar: N T). Entries are exact in
// double, and b = W v exactly: the rows stay dependent in 256 bits. v: linear velocity along x and down, turn.
struct FeetPlate {
  Eigen::MatrixXd W;
  Lcp problem;
};

FeetPlate feet_plate(int feet, bool spatial, double mu, double vx, double turn) {
  const double height = 0.5;
  std::vector<std::array<double, 2>> at;
  for (int i = 0; i < feet; ++i)
    for (int j = 0; j < (spatial ? feet : 1); ++j) at.push_back({i - 0.75, spatial ? j - 1.25 : 0.0});
  const Index rows = spatial ? 3 : 2, freedoms = spatial ? 6 : 3, contacts = static_cast<Index>(at.size());
  FeetPlate result;
  result.W.setZero(rows * contacts, freedoms);
  for (Index k = 0; k < contacts; ++k) {
    const auto [x, y] = at[static_cast<std::size_t>(k)];
    if (spatial) {
      result.W.row(3 * k) << 0, 0, 1, y, -x, 0;
      result.W.row(3 * k + 1) << 1, 0, 0, 0, -height, -y;
      result.W.row(3 * k + 2) << 0, 1, 0, height, 0, x;
    } else {
      result.W.row(2 * k) << 0, 1, x;
      result.W.row(2 * k + 1) << 1, 0, height;
    }
  }
  Vector v(Eigen::VectorXd::Zero(freedoms));
  v[0] = vx, v[spatial ? 2 : 1] = -1.0, v[freedoms - 1] = spatial ? turn : 0;
  Delassus A{RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(result.W.sparseView())),
             Eigen::VectorXd::Constant(freedoms, 0.7),
             {}};
  for (Index j = freedoms / 2 + 1; j < freedoms; ++j) A.inverse_mass[j] = 1.9;
  result.problem = Lcp::standard(A, Vector(result.W * v));
  for (Index k = 0; k < contacts; ++k) {
    result.problem.friction.push_back({rows * k, rows * k + 1, rows - 1, mu});
    result.problem.lo.segment(rows * k + 1, rows - 1).setConstant(-kInf);
  }
  return result;
}

}  // namespace

TEST_CASE("directional: rows with z = w = 0 choose, as one-sided differences in 256 bits") {
  Random random(44);
  for (int trial = 0; trial < 30; ++trial) {
    INFO("trial ", trial);
    const Index n = random.integer(2, 10);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    std::size_t weak = 0;
    for (Index i = 0; i < n; ++i) {
      const int kind = i == 0 ? 0 : random.integer(0, 2);
      if (kind == 0) ++weak;
      if (kind == 1) z[i] = random.integer(1, 8) / 4.0;
      if (kind == 2) w[i] = random.integer(1, 8) / 4.0;
    }
    const Lcp p = exact_problem(z, w, random, trial % 2 == 1);
    compare_directional(p, exact_answer(p, z), weak, random, 4);
  }
}

TEST_CASE("directional: friction on its bound without slip, discs on their edge, contacts without force or slip") {
  Random random(45);
  for (int trial = 0; trial < 30; ++trial) {
    INFO("trial ", trial);
    const bool discs = trial % 2 == 1;
    const Index contacts = random.integer(1, 3), rows = discs ? 3 : 2, n = rows * contacts;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    std::size_t weak = 0;
    std::vector<Friction> friction;
    for (Index k = 0; k < contacts; ++k) {
      const Index i = rows * k;
      friction.push_back({i, i + 1, rows - 1, 0.5});
      const int kind = k == 0 ? random.integer(0, 1) : random.integer(0, 5);
      if (kind == 0) {  // on the edge: 10 · 0.5 = |(3, 4)|
        z[i] = 10;
        if (discs) z[i + 1] = 3, z[i + 2] = -4;
        if (!discs) z[i + 1] = random.integer(0, 1) == 0 ? 5 : -5;
        weak += discs ? 2 : 1;
      } else if (kind == 1) {  // neither force nor velocity
        weak += static_cast<std::size_t>(rows);
      } else if (kind == 2) {  // no force, slips
        w[i + 1] = 0.75;
        weak += 1;
      } else if (kind == 3) {  // slides
        z[i] = 10;
        if (discs) z[i + 1] = -3, z[i + 2] = 4, w[i + 1] = 0.75, w[i + 2] = -1;
        if (!discs) z[i + 1] = -5, w[i + 1] = 0.5;
      } else if (kind == 4) {  // sticks
        z[i] = 2, z[i + 1] = 0.25;
      } else {  // open
        w[i] = 1, w[i + 1] = 0.5;
      }
    }
    Lcp p = exact_problem(z, w, random, false);
    p.friction = friction;
    for (const Friction& f : friction) p.lo.segment(f.first, f.rows).setConstant(-kInf);
    Solution s = exact_answer(p, z);
    REQUIRE(has_answer(s.status));
    if ((s.z - z).norm() > 1e-12) continue;  // another solution
    compare_directional(p, s, weak, random, 4);
  }
}

TEST_CASE("sensitivity: redundant contacts give the derivative of the motion, whichever forces were found") {
  Random random(46);
  int redundant = 0;
  for (const bool spatial : {false, true})
    for (const double vx : {0.0, 0.125, 4.0})  // sticks, sticks, slides
      for (const double turn : {0.0, 0.5}) {
        if (spatial && vx > 1) continue;  // the motion depends on how the feet share the load
        INFO("spatial ", spatial, ", vx ", vx, ", turn ", turn);
        const FeetPlate table = feet_plate(3, spatial, 0.5, vx, turn);
        Lcp p = table.problem;
        const Delassus parts = std::get<Delassus>(p.A);
        const Index freedoms = parts.W.cols;
        Solution s;
        REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
        // What keeps the redundancy: masses, and velocities, b = W v.
        Perturbation change;
        Delassus masses;
        masses.inverse_mass = normal_vector(random, freedoms).cwiseProduct(parts.inverse_mass);
        Eigen::VectorXd v(freedoms);
        for (Index j = 0; j < freedoms; ++j) v[j] = random.integer(-8, 8) / 8.0;
        change.A = masses, change.b = table.W * v;
        const Difference256 d = difference_256(p, s.z, change, false, 1e-45);
        REQUIRE(d.found);
        const Eigen::VectorXd motion = table.W.transpose() * d.z;
        for (const bool formed : {false, true}) {
          INFO("formed ", formed);
          Perturbation now = change;
          if (formed) {
            DenseMatrix dense;
            to_dense(Delassus{parts.W, masses.inverse_mass, {}}, dense), now.A = dense;
            to_dense(parts, dense), p.A = dense;
          }
          const Sensitivity of = sensitivity(p, s);
          if (of.report().redundant) ++redundant;
          const SolutionTangent t = of.directional(now);
          CHECK(t.consistent);
          CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= 1e-7 * (1 + d.w.lpNorm<Eigen::Infinity>()));
          const Eigen::VectorXd moved = table.W.transpose() * t.z;
          const SolutionTangent held = of.jvp(now);
          const Vector h = normal_vector(random, p.size()), none(Eigen::VectorXd::Zero(p.size()));
          const DataGradient back = of.vjp(none, h);
          CHECK(back.consistent);
          double along = back.b.dot(now.b);
          const Matrix by_A = gradient_of_matrix(of, back);
          if (formed)
            along += std::get<DenseMatrix>(by_A).cwiseProduct(std::get<DenseMatrix>(*now.A)).sum();
          else
            along += std::get<Delassus>(by_A).inverse_mass.dot(masses.inverse_mass);
          CHECK(std::abs(along - h.dot(held.w)) <= 1e-8 * (1 + h.cwiseAbs().dot(held.w.cwiseAbs())));
          CHECK((moved - motion).lpNorm<Eigen::Infinity>() <= 1e-7 * (1 + motion.lpNorm<Eigen::Infinity>()));
        }
      }
  CHECK(redundant >= 8);
  MESSAGE(redundant << " of 20 with a singular block");
}

TEST_CASE("sensitivity: the report names what is near, unsolved and misfitting input is refused") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{2, 0}, {0, 1}}), Vector{-2, 1e-3});
  Solution s;
  REQUIRE(make_solver("lemke")->solve(p, s).status == Status::solved);
  Sensitivity of = sensitivity(p, s);
  CHECK(of.report().nearest == 1);
  CHECK(of.report().margin[1] == 1e-3);
  CHECK(of.report().differentiable());
  p.b[1] = 0;
  REQUIRE(make_solver("lemke")->solve(p, s).status == Status::solved);
  of = sensitivity(p, s);
  REQUIRE(of.report().weakly_active.size() == 1);
  CHECK(of.report().weakly_active[0].row == 1);
  CHECK(words_of(of.report()).find("row 1 is weakly active") != std::string::npos);
  Perturbation change;
  change.b = {0, -1};
  CHECK(of.jvp(change).z[1] == 0);
  CHECK(of.directional(change).z[1] == 1);
  change.b = {0, 1};
  CHECK(of.directional(change).z[1] == 0);
  change.b = {1};
  CHECK_THROWS_AS(of.jvp(change), std::invalid_argument);
  CHECK_THROWS_AS(of.vjp(Vector{1}), std::invalid_argument);
  s.status = Status::stalled;
  CHECK_THROWS_AS(sensitivity(p, s), std::invalid_argument);
}

TEST_CASE("sensitivity: redundant rows that a change parts have no derivative, and that is said") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 1}, {1, 1}}), Vector{-2, -2});
  Solution s;
  s.status = Status::solved, s.z = {1, 1}, s.w = {0, 0}, s.residual = 0, s.rounding = 1e-16;
  const Sensitivity of = sensitivity(p, s);
  CHECK(of.report().redundant);
  Perturbation change;
  change.b = {1, 1};
  CHECK(of.jvp(change).consistent);
  CHECK(of.jvp(change).w.norm() <= 1e-14);
  CHECK(of.vjp(Vector{1, 1}).consistent);         // z_1 + z_2 is unique
  CHECK_FALSE(of.vjp(Vector{1, -1}).consistent);  // z_1 − z_2 is not
  change.b = {1, -1};
  CHECK_FALSE(of.jvp(change).consistent);
}

TEST_CASE("sensitivity: forces of redundant rows have the gradient of even shares, by both products") {
  const Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 1}, {1, 1}}), {-1, -1});
  Solution s;
  s.z = Eigen::Vector2d(0.25, 0.75);
  Judge().certify(p, 1e-10, Claim::candidate, s);
  const Sensitivity of = sensitivity(p, s);
  REQUIRE(of.report().redundant);
  Perturbation change;
  change.b = Eigen::Vector2d(-1, -1);
  const Vector share = of.jvp(change).z;
  CHECK((share - Eigen::Vector2d(0.5, 0.5)).norm() <= 1e-8);
  for (const Eigen::Vector2d& weight : {Eigen::Vector2d(1, 0), Eigen::Vector2d(1, -1), Eigen::Vector2d(1, 1)}) {
    const DataGradient back = of.vjp(weight, {});
    CHECK((back.b - Eigen::Vector2d::Constant(-weight.sum() / 4)).norm() <= 1e-8);
    CHECK(back.consistent == (weight[0] == weight[1]));
  }
}
