#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

using namespace orthant;

namespace {

/// ‖min(z, w)‖∞ ≤ max(1e-10 (1 + ‖q‖∞), 20 ρ), ρ ≤ 1e-6 (1 + ‖q‖∞): measured here, from z alone.
bool passes(const Lcp& problem, const Vector& z) {
  const auto& M = std::get<DenseMatrix>(problem.A);
  const Eigen::VectorXd w = M * z + problem.b;
  const double rho =
      std::numeric_limits<double>::epsilon() * (problem.b.cwiseAbs() + M.cwiseAbs() * z.cwiseAbs()).maxCoeff();
  const double q = 1 + problem.b.lpNorm<Eigen::Infinity>();
  return z.cwiseMin(w).lpNorm<Eigen::Infinity>() <= std::max(1e-10 * q, 20 * rho) && rho <= 1e-6 * q;
}

void all_pass(const char* spec, Index contacts, double mu, double mass_ratio, int seeds) {
  for (int seed = 0; seed < seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(1000 * seed) + static_cast<std::uint64_t>(mass_ratio));
    const Lcp problem = stewart_trinkle_problem(contacts, mu, mass_ratio, random);
    const auto solver = make_solver(spec);
    Solution s;
    solver->solve(problem, s);
    INFO(spec, ", n = ", 4 * contacts, ", mass ratio ", mass_ratio, ", seed ", seed, ": ", name(s.status));
    CHECK(has_answer(s.status));
    CHECK(passes(problem, s.z));
  }
}

}  // namespace

TEST_CASE("friction in Stewart and Trinkle's form is solved whatever the mass ratio") {
  for (const char* spec : {"lemke", "path"})
    for (const double ratio : {1.0, 1e6, 1e10}) {
      all_pass(spec, 5, 0.5, ratio, 30);
      all_pass(spec, 20, 0.5, ratio, 30);
    }
}

TEST_SUITE("slow") {
  TEST_CASE("friction in Stewart and Trinkle's form, 60 and 100 contacts") {
    for (const char* spec : {"lemke", "path"}) {
      for (const double ratio : {1.0, 1e6, 1e10}) all_pass(spec, 60, 0.5, ratio, 3);
      for (const double ratio : {1.0, 1e6}) all_pass(spec, 100, 0.8, ratio, 1);
    }
  }
}

TEST_CASE(
    "a slider's two corners on one wall: Newton's methods from zero, whatever the units and however fast it slides") {
  // Recorded from the slider-crank with clearance: rank 2, normal rates of 1e-3 m/s beside slips of 1e-3 to 1e3 m/s.
  Lcp problem;
  problem.A = Eigen::MatrixXd{{936.5690960531347, -915.2827557987175, 464.2642915134531, 464.2642915134531},
                              {-915.2827557987175, 936.5690960531347, -461.661634412473, -461.661634412473},
                              {464.2642915134531, -461.661634412473, 236.3730545533902, 236.3730545533902},
                              {464.2642915134531, -461.661634412473, 236.3730545533902, 236.3730545533902}};
  problem.lo = Eigen::VectorXd{{0, 0, -kInf, -kInf}};
  problem.hi = Vector::Constant(4, kInf);
  problem.friction = {{.normal = 0, .first = 2, .mu = 0.01}, {.normal = 1, .first = 3, .mu = 0.01}};
  for (const char* spec : {"newton-fb", "newton-min"})
    for (const double slip : {1e-3, 1.0, 1e3, -1e3})
      for (const double unit : {1.0, 0x1p-40, 0x1p40}) {
        problem.b = unit * Eigen::VectorXd{{-1e-3, -1e-3, slip, slip}};
        Solution s;
        make_solver(spec)->solve(problem, s);
        CAPTURE(spec);
        CAPTURE(slip);
        CAPTURE(unit);
        CHECK(s.status == Status::solved);
      }
}

TEST_CASE("a start far from the answer leaves no rounding in it") {
  Lcp problem;
  problem.A = Eigen::MatrixXd{{1.0}};
  problem.b = Vector::Constant(1, -9.39352762241441e-16);
  problem.lo = Vector::Zero(1), problem.hi = Vector::Constant(1, kInf);
  for (const char* spec : {"pgs", "psor", "sgs", "jacobi"})
    for (const double start : {9.18, 0.0918, 1e-3}) {
      Solution s;
      s.z = Vector::Constant(1, start);
      make_solver(spec)->solve(problem, s, Start::warm);
      CAPTURE(spec);
      CHECK(s.status == Status::solved);
    }
}
