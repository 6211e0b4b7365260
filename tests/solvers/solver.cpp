#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <chrono>
#include <limits>

using namespace orthant;

namespace {

template <class F> std::string message_of(const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("solvers are made by name; a wrong name or option is answered with the right ones") {
  for (const SolverEntry& entry : solvers()) {
    CHECK(make_solver(entry.name) != nullptr);
    CHECK_FALSE(entry.options().empty());
  }
  const std::string unknown = message_of([] { make_solver("simplex"); });
  for (const SolverEntry& entry : solvers()) CHECK(unknown.find(entry.name) != std::string::npos);
  CHECK(message_of([] { make_solver("pgs:omega=3"); }).find("omega") != std::string::npos);
  CHECK(message_of([] { make_solver("pgs:speed=3"); }).find("max_sweeps") != std::string::npos);
  CHECK(message_of([] { make_solver("lemke:rescue=maybe"); }).find("true or false") != std::string::npos);
  CHECK(message_of([] { make_solver("pgs:omega=1.3,max_sweeps=50"); }) == "");
}

TEST_CASE("data that are not finite give numerical_error, a malformed problem throws: every solver") {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const SolverEntry& entry : solvers()) {
    INFO(entry.name);
    const auto solver = make_solver(entry.name);
    Solution s;
    for (const double bad : {kNaN, kInf, -kInf}) {
      Lcp p = murty_problem(3);
      p.b[1] = bad;
      CHECK(solver->solve(p, s).status == Status::numerical_error);
      CHECK(why(s) == "row 1 is not finite");
      p = murty_problem(3);
      std::get<DenseMatrix>(p.A)(2, 0) = bad;
      CHECK(solver->solve(p, s).status == Status::numerical_error);
      CHECK(solver->solve(as_sparse(p), s).status == Status::numerical_error);
      CHECK(s.z.size() == 3);
    }
    Lcp p = murty_problem(3);
    p.lo = Vector{0};
    CHECK(message_of([&] { solver->solve(p, s); }).find("lo has 1 entries") != std::string::npos);
    const Status after = solver->solve(murty_problem(3), s).status;  // and is none the worse for it
    CHECK(after == (solver->why_not(murty_problem(3)).empty() ? Status::solved : Status::unsupported));
  }
}

TEST_CASE("no rows: solved; huge numbers: solved or an error, never NaN called solved") {
  for (const SolverEntry& entry : solvers()) {
    INFO(entry.name);
    const auto solver = make_solver(entry.name);
    Solution s;
    if (const Lcp none = Lcp::standard(DenseMatrix(), Vector()); solver->why_not(none).empty())
      CHECK(solver->solve(none, s).status == Status::solved);
    for (const double size : {1e-300, 1e-160, 1e160, 1e300}) {
      Lcp p = murty_problem(3);
      std::get<DenseMatrix>(p.A) *= size;
      solver->solve(p, s);
      if (s.status == Status::solved) CHECK(s.z.allFinite());
      p.b *= size;
      solver->solve(p, s);
      if (s.status == Status::solved) CHECK((s.z - Eigen::Vector3d(1, 0, 0)).lpNorm<Eigen::Infinity>() < 1e-6);
    }
  }
}

TEST_CASE("overflow of sums or scaled entries does not abort the process") {
  // A dependent free row beside a product of 1e300 with its scaling; fixed z whose w is infinite.
  Lcp dependent = Lcp::standard(
      DenseMatrix(Eigen::Matrix4d{
          {1, 8.749002899132048e+99, 0, 0}, {0, 0, 0, 0}, {0, 1, 0, 8.183476519740355e+149}, {0, 0, 0, 0}}),
      Vector{0, 0, 0, 0});
  dependent.lo = Vector{-kInf, 1e-10, -kInf, -1e150};
  dependent.hi[1] = 1e-5;
  constexpr double kLargest = std::numeric_limits<double>::max();
  Lcp fixed = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{0, 0}, {-kLargest, 1}}), Vector{0, 0});
  fixed.lo = fixed.hi = Vector{-1e160, -kLargest};
  for (const SolverEntry& entry : solvers())
    for (const Lcp* problem : {&dependent, &fixed}) {
      INFO(entry.name);
      const auto solver = make_solver(entry.name);
      Solution s;
      solver->set_time_limit(2);
      if (solver->solve(*problem, s).status == Status::solved) CHECK(s.w.allFinite());
    }
}

TEST_CASE("a time limit and a raised flag end a run") {
  Eigen::Matrix2d slow;  // a light block under one of 1e9 its mass: projected Gauss-Seidel takes 1e10 sweeps
  slow << 1, -1, -1, 1 + 1e-9;
  const struct {
    std::string spec;
    Lcp problem;
  } cases[] = {{"lemke:max_pivots=1000000000", murty_problem(40)},
               {"pgs:max_sweeps=1000000000", Lcp::standard(DenseMatrix(slow), Vector{-1, 0})}};
  for (const auto& [spec, problem] : cases) {
    INFO(spec);
    const auto solver = make_solver(spec);
    Solution s;
    solver->set_time_limit(0.05);
    const auto begin = std::chrono::steady_clock::now();
    solver->solve(problem, s);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(2));
    CHECK(s.status == Status::time_limit);
    CHECK(s.residual > 0);
    solver->set_time_limit(kInf);
    const std::atomic<bool> cancel{true};
    solver->set_cancel(&cancel);
    CHECK(solver->solve(problem, s).status == Status::cancelled);
  }
}
