// Cost of each part (Google Benchmark): small problems, pivots, the judge, proofs, broad phase, steps.
//
//   build/release/experiments/parts --benchmark_filter=step     # --help tells the rest
// Times drift with the machine: compare within one run, or two builds by turns. Regressions are checked by
// tests/integrators/speed.cpp, as ratios.
#include "experiments/support/reference_kernel.h"

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/proof/farkas.h>
#include <orthant/solvers/registry.h>

#include <benchmark/benchmark.h>
#include <Eigen/Cholesky>

#include <cmath>

using namespace orthant;

namespace {

Lcp spd(Index n) {
  Random random(static_cast<std::uint64_t>(n));
  return random_spd_problem(n, random);
}

/// The time of a solve; also its pivots, sweeps or iterations a second.
void solve(benchmark::State& state, const Lcp& problem, const char* spec) {
  const auto solver = make_solver(spec);
  Solution s;
  long iterations = 0;
  for (auto _ : state) {
    solver->solve(problem, s);
    iterations += s.iterations;
  }
  if (s.status != Status::solved) state.SkipWithError("not solved");
  state.counters["iterations"] = benchmark::Counter(static_cast<double>(iterations), benchmark::Counter::kIsRate);
}

void small_spd(benchmark::State& state, const char* spec) { solve(state, spd(state.range(0)), spec); }
BENCHMARK_CAPTURE(small_spd, automatic, "auto")->Arg(2)->Arg(5)->Arg(10)->Arg(20)->Arg(50);
BENCHMARK_CAPTURE(small_spd, lemke, "lemke:form=tableau")->Arg(2)->Arg(10)->Arg(50);
BENCHMARK_CAPTURE(small_spd, dantzig, "dantzig")->Arg(2)->Arg(10)->Arg(50);
BENCHMARK_CAPTURE(small_spd, pgs, "pgs")->Arg(2)->Arg(10);

void lemke_pivots(benchmark::State& state) { solve(state, spd(state.range(0)), "lemke:form=tableau"); }
BENCHMARK(lemke_pivots)->RangeMultiplier(2)->Range(32, 1024)->Unit(benchmark::kMicrosecond);

/// A solve, and how many times as long it takes as the factorizations of its blocks alone, by Eigen, by turns: as many
/// of their mean size, which is the least that blocks of as many rows in all can cost.
void block_pivot(benchmark::State& state) {
  const Lcp problem = spd(state.range(0));
  const auto solver = make_solver("block-pivot");
  Solution s;
  const double before = factorization_count().cubes;
  solver->solve(problem, s);
  if (s.status != Status::solved) state.SkipWithError("not solved");
  const auto rows =
      static_cast<Index>(std::cbrt((factorization_count().cubes - before) / static_cast<double>(s.factorizations)));
  const Eigen::MatrixXd block = std::get<DenseMatrix>(problem.A).topLeftCorner(rows, rows);
  Eigen::MatrixXd factors;
  double whole = 0, blocks = 0;
  for (auto _ : state) {
    double begin = thread_time();
    solver->solve(problem, s);
    whole += thread_time() - begin;
    begin = thread_time();
    for (long k = 0; k < s.factorizations; ++k) {
      factors = block;
      const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factored(factors);
      if (factored.info() != Eigen::Success) state.SkipWithError("no factorization");
    }
    blocks += thread_time() - begin;
  }
  state.counters["factorizations"] = static_cast<double>(s.factorizations);
  state.counters["times_them"] = whole / blocks;
}
BENCHMARK(block_pivot)->Arg(100)->Arg(300)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void friction(benchmark::State& state, const char* spec) {
  Random random(7);
  solve(state, random_contact_problem(state.range(0), 3 * state.range(0), 0.3, random), spec);
}
BENCHMARK_CAPTURE(friction, automatic, "auto")->Arg(2)->Arg(10)->Arg(40)->Unit(benchmark::kMicrosecond);

void obstacle(benchmark::State& state) { solve(state, ball_obstacle(state.range(0) + 1).problem, "auto"); }
BENCHMARK(obstacle)->Arg(31)->Arg(127)->Unit(benchmark::kMillisecond);

void certify(benchmark::State& state) {
  const Lcp problem = spd(state.range(0));
  Solution s;
  make_solver("auto")->solve(problem, s);
  Judge judge;
  for (auto _ : state) judge.certify(problem, 1e-10, Claim::candidate, s);
}
BENCHMARK(certify)->Arg(4)->Arg(50)->Arg(500);

/// One row that contradicts the sum of the others.
void farkas_proof(benchmark::State& state) {
  const Index n = state.range(0);
  Lcp problem = spd(n);
  auto& A = std::get<DenseMatrix>(problem.A);
  A.row(n - 1) = -A.topRows(n - 1).colwise().sum();
  problem.b.setConstant(-1);
  Farkas farkas;
  Vector u;
  Judge judge;
  bool proved = true;
  for (auto _ : state) proved = proved && farkas.propose(problem, u);
  if (!proved || !judge.proves_infeasible(problem, u)) state.SkipWithError("no proof");
}
BENCHMARK(farkas_proof)->Arg(10)->Arg(50)->Arg(100)->Unit(benchmark::kMicrosecond);

void broad_phase(benchmark::State& state) {
  const System system(pile({.discs = static_cast<int>(state.range(0))}));
  BroadPhase broad_phase(system);
  Terms terms(system);
  const State x = system.initial_state();
  set_poses(system, x.t, x.q, terms.at);
  const Eigen::VectorXd way = Eigen::VectorXd::Constant(system.dof(), 1e-3);
  for (auto _ : state) broad_phase.find(way, terms);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0));
}
BENCHMARK(broad_phase)->RangeMultiplier(10)->Range(10, 10000)->Unit(benchmark::kMicrosecond);

/// A step of `scene`, begun again when its duration is over.
void steps(benchmark::State& state, const Scene& scene, const std::string& integrator, double h) {
  const System system(scene);
  const auto scheme = make_integrator(integrator, system);
  const auto solver = make_solver("auto");
  State x = system.initial_state();
  for (auto _ : state) {
    if (x.t > 0.2) x = system.initial_state();
    if (scheme->step(h, *solver, x).status != Status::solved) state.SkipWithError("a step was not solved");
  }
}

void chain_step(benchmark::State& state) {
  steps(state, chain({.links = static_cast<int>(state.range(0))}), "moreau-jean", 1e-3);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0));
}
BENCHMARK(chain_step)->RangeMultiplier(10)->Range(10, 10000)->Unit(benchmark::kMicrosecond);

/// The slider-crank by every integrator: fixed step 1e-5 s; those that control their own get 1e-3 s.
const bool registered = [] {
  for (const IntegratorEntry& entry : integrators()) {
    const std::string name(entry.name);
    const bool controls = name == "adaptive" || name == "event-driven";
    benchmark::RegisterBenchmark(("step/" + name).c_str(), [name, controls](benchmark::State& state) {
      steps(state, slider_crank(), name, controls ? 1e-3 : 1e-5);
    })->Unit(benchmark::kMicrosecond);
  }
  return true;
}();

}  // namespace

BENCHMARK_MAIN();
