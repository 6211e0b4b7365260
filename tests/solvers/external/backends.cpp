// Libraries under the solvers that fail: without memory a sparse factorization is refused, and the solver says so.
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/linear_algebra/sparse_cholesky.h>
#include <orthant/solvers/registry.h>

#include <SuiteSparse_config.h>
#include <doctest/doctest.h>

using namespace orthant;

namespace {

long g_left = 0;  // allocations until there is no memory

using Malloc = void*(std::size_t);
using Calloc = void*(std::size_t, std::size_t);
using Realloc = void*(void*, std::size_t);

/// Functions that SuiteSparse (CHOLMOD, KLU, UMFPACK) takes memory by; from version 7 on its table of them is hidden.
void allocate_by(Malloc* malloc_function, Calloc* calloc_function, Realloc* realloc_function) {
#if SUITESPARSE_MAIN_VERSION >= 7
  SuiteSparse_config_malloc_func_set(malloc_function);
  SuiteSparse_config_calloc_func_set(calloc_function);
  SuiteSparse_config_realloc_func_set(realloc_function);
#else
  SuiteSparse_config.malloc_func = malloc_function;
  SuiteSparse_config.calloc_func = calloc_function;
  SuiteSparse_config.realloc_func = realloc_function;
#endif
}

/// While it lives SuiteSparse gets that many pieces of memory and no more.
struct Shortage {
  explicit Shortage(long pieces) {
    g_left = pieces;
    allocate_by([](std::size_t size) { return g_left-- > 0 ? std::malloc(size) : nullptr; },
                [](std::size_t n, std::size_t size) { return g_left-- > 0 ? std::calloc(n, size) : nullptr; },
                [](void* p, std::size_t size) { return g_left-- > 0 ? std::realloc(p, size) : nullptr; });
  }
  ~Shortage() { allocate_by(std::malloc, std::calloc, std::realloc); }
  Shortage(const Shortage&) = delete;
  Shortage& operator=(const Shortage&) = delete;
};

}  // namespace

TEST_CASE("sparse solvers whose factorizations get no memory end with a status, and solve when there is some again") {
  std::vector<Lcp> problems(2, string_on_obstacle(100));
  auto& A = std::get<RowSparse>(problems[1].A);  // not symmetric
  for (std::size_t i = 0; i + 1 < A.start.size(); ++i)
    for (auto k = static_cast<std::size_t>(A.start[i]); k < static_cast<std::size_t>(A.start[i + 1]); ++k)
      if (A.column[k] > static_cast<int>(i)) A.value[k] *= 0.5;
  for (const std::string name :
       {"block-pivot", "newton-min", "newton-fb", "path", "interior-point", "lemke", "auto", "admm"})
    for (const Lcp& problem : problems) {
      INFO(name);
      const bool sparse_only = name == "block-pivot" || name == "interior-point" || name == "admm";
      const auto solver = make_solver(name);
      Solution s;
      int failed = 0;
      for (const long pieces : {0, 3, 12, 21, 40}) {
        const auto fresh = make_solver(name);
        fresh->set_time_limit(1);
        solver->set_time_limit(1);
        const Shortage shortage(pieces);
        for (Solver* each : {fresh.get(), solver.get()}) {
          each->solve(problem, s);
          CHECK(s.status != Status::not_run);
          failed += s.status != Status::solved;
        }
      }
      if (sparse_only) CHECK(failed > 0);
      solver->set_time_limit(kInf);
      const Status again = solver->solve(problem, s, Start::cold).status;
      CHECK(again == make_solver(name)->solve(problem, s, Start::cold).status);
    }
}

TEST_CASE("sparse Cholesky that gets no memory for a solve says so, and solves when there is some again") {
  const Lcp p = string_on_obstacle(100);
  for (const long pieces : {0, 1, 2}) {
    CAPTURE(pieces);
    SparseCholesky cholesky;
    REQUIRE(cholesky.factorize(std::get<RowSparse>(p.A), 0));
    Vector x = p.b;
    {
      const Shortage shortage(pieces);
      REQUIRE_FALSE(cholesky.solve(x));
    }
    CHECK(x == p.b);  // it keeps what it was given
    REQUIRE(cholesky.solve(x));
    Vector back, scratch;
    multiply(p.A, x, back, scratch);
    CHECK((back - p.b).lpNorm<Eigen::Infinity>() <= 1e-12 * p.b.lpNorm<Eigen::Infinity>());
  }
}
