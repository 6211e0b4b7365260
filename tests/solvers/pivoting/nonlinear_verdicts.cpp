// Verdicts on nonlinear problems: F that only decreases, underflow, a Jacobian that does not fit F.
#include <orthant/solvers/pivoting/path.h>

#include <orthant/core/lcp/mcp.h>

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/nonlinear.h"

using namespace orthant;

TEST_CASE("F = -exp(-z) has no solution: however small it gets, it is not solved") {
  const Mcp p = complementarity(
      1, [](const Vector& z, Vector& F) { F[0] = -std::exp(-z[0]); },
      [](const Vector& z, DenseMatrix& J) { J(0, 0) = std::exp(-z[0]); });
  Solution s;
  for (const double z : {1.0, 26.0, 100.0, 700.0}) {
    s.z = Vector{z};
    certify(p, 1e-10, Claim::candidate, s);
    INFO("z = ", z, ": ", name(s.status));
    CHECK(s.status == Status::stalled);
    CHECK(!why(s).empty());
  }
  Path().solve(p, s);
  CHECK(!has_answer(s.status));
}

TEST_CASE("F and a Jacobian that vanish by underflow are no solution; a root, a flat part and a row of zeros are") {
  using Function = std::function<double(double)>;
  const auto scalar = [](const Function& f, const Function& slope, double lo = 0) {
    Mcp p = complementarity(
        1, [f](const Vector& z, Vector& F) { F[0] = f(z[0]); },
        [slope](const Vector& z, DenseMatrix& J) { J(0, 0) = slope(z[0]); });
    p.lo[0] = lo;
    return p;
  };
  const auto status_at = [](const Mcp& p, double z, const Vector* start = nullptr) {
    Solution s;
    s.z = Vector{z};
    certify(p, 1e-10, Claim::candidate, s, start);
    return s;
  };
  const auto vanishes = [](const Solution& s) {
    CAPTURE(s.z[0]);
    CAPTURE(why(s));
    CHECK(s.status == Status::stalled);
    CHECK(s.miss.against == Miss::Against::underflow);
    CHECK(why(s).find("row 0: F and its Jacobian are 0 by underflow") == 0);
  };
  const Mcp decay = scalar([](double z) { return -std::exp(-z); }, [](double z) { return std::exp(-z); });
  for (const double z : {744.5, 746.0, 1e3, 1e5, 1e100}) vanishes(status_at(decay, z));
  const Mcp bell =
      scalar([](double z) { return -std::exp(-z * z); }, [](double z) { return 2 * z * std::exp(-z * z); });
  for (const double z : {28.0, 1e3}) vanishes(status_at(bell, z));
  const Mcp power = scalar([](double z) { return -std::pow(z, -20); }, [](double z) { return 20 * std::pow(z, -21); });
  for (const double z : {1e17, 1e80}) vanishes(status_at(power, z));  // at 0 it is not finite
  const Mcp equation = scalar([](double z) { return std::exp(z); }, [](double z) { return std::exp(z); }, -kInf);
  vanishes(status_at(equation, -800));
  const Vector start{100.5};  // 0 at the origin, too
  const auto hill = [](double z) { return std::exp(-(z - 100) * (z - 100)); };
  vanishes(status_at(scalar([&](double z) { return -hill(z); }, [&](double z) { return 2 * (z - 100) * hill(z); }),
                     127.5, &start));
  for (const double from : {0.0, 700.0, 746.0, 1e4}) {
    Solution s;
    s.z = Vector{from};
    CHECK(!has_answer(Path().solve(decay, s, Start::warm).status));
  }

  const auto solved = [](const Solution& s) {
    CAPTURE(s.z[0]);
    CAPTURE(why(s));
    CHECK(s.status == Status::solved);
  };
  const Vector one{1};
  const auto zero = [](double) { return 0.0; };
  for (const double z : {0.0, 1.0, 1e6}) solved(status_at(scalar(zero, zero), z, &one));
  const Mcp flat =
      scalar([](double z) { return z < 5 ? (5 - z) * (5 - z) : 0; }, [](double z) { return z < 5 ? 2 * (z - 5) : 0; });
  for (const double z : {5.0, 6.0, 1e6}) solved(status_at(flat, z, &one));
  solved(status_at(scalar([](double z) { return z * z * z; }, [](double z) { return 3 * z * z; }, -kInf), 0, &one));
  for (const double multiple : {2.0, 20.0, 25.0})
    solved(status_at(scalar([=](double z) { return std::pow(z - 1, multiple); },
                            [=](double z) { return multiple * std::pow(z - 1, multiple - 1); }),
                     1));
  solved(status_at(scalar([](double z) { return std::exp(-z); }, [](double z) { return -std::exp(-z); }), 0));
  Mcp at_bound = decay;  // F ≥ 0 at its lower bound, whatever its size
  at_bound.F = [](const Vector& z, Vector& F) { F[0] = std::exp(-z[0]); };
  at_bound.lo[0] = 800;
  solved(status_at(at_bound, 800));
}

TEST_CASE("a Jacobian that does not fit F excuses nothing, and the row is named; one that fits costs no answer") {
  const auto with_slope = [](double slope) {
    return complementarity(
        2, [](const Vector& z, Vector& F) { F[0] = z[0] - 1, F[1] = std::exp(z[1]) - std::exp(2.0); },
        [slope](const Vector& z, DenseMatrix& J) { J << slope, 0, 0, std::exp(z[1]); });
  };
  Solution s;
  s.z = Vector{3, 2};
  certify(with_slope(1e12), 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::stalled);
  CHECK(s.miss.row == 0);
  CHECK(why(s).find("row 0: the Jacobian does not fit F") == 0);
  s.z = Vector{1, 2};
  certify(with_slope(1), 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::solved);
  CHECK(Path().solve(with_slope(1), s).status == Status::solved);
  const Mcp double_root = complementarity(  // J = 0 at the solution: curvature is no misfit
      1, [](const Vector& z, Vector& F) { F[0] = (z[0] - 1) * (z[0] - 1); },
      [](const Vector& z, DenseMatrix& J) { J(0, 0) = 2 * (z[0] - 1); });
  s.z = Vector{1};
  certify(double_root, 1e-10, Claim::candidate, s);
  CHECK(s.status == Status::solved);
}

TEST_CASE("F = atan(z) - 2 has no solution: where its slope is less than any number the run ends") {
  Mcp p = complementarity(
      1, [](const Vector& z, Vector& F) { F[0] = std::atan(z[0]) - 2; },
      [](const Vector& z, DenseMatrix& J) { J(0, 0) = 1 / (1 + z[0] * z[0]); });
  bool finite = true;
  const auto F = p.F;
  p.F = [&](const Vector& z, Vector& value) { finite = finite && std::isfinite(z[0]), F(z, value); };
  for (const double start : {0.0, 3.0, 1e8, 1e80, 1e150}) {
    Path path;
    path.set_time_limit(5);
    Solution s;
    s.z = Vector{start};
    const Status status = path.solve(p, s, Start::warm).status;
    CHECK(!has_answer(status));
    CHECK(status != Status::time_limit);
    CHECK(finite);
  }
}
