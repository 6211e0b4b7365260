// tests/support/work.h — workloads whose speed is tested: by integrators/speed.cpp and tests/instructions.
#pragma once

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace orthant {

struct Work {
  std::string name, unit;
  long least, more;  // units of a short run and a longer one: their difference is free of what comes once
  std::function<std::function<void(long)>()> make;  // what does so many units
};

/// Steps of moreau-jean, a run of so many each time.
inline auto steps_of(const Scene& scene, double h) {
  return [scene, h] {
    const auto system = std::make_shared<System>(scene);
    const std::shared_ptr<Integrator> scheme = make_integrator("moreau-jean", *system);
    const std::shared_ptr<Solver> solver = make_solver("auto");
    return [=](long count) {
      (void)system;  // the scheme holds on to it
      const double duration = h * static_cast<double>(count);
      const Run run = simulate(*scheme, *solver, {.step = h, .duration = duration, .every = count});
      if (run.status != Status::solved) throw std::runtime_error(scheme->why());
    };
  };
}

/// Cold solves of one problem.
inline auto solves_of(const Lcp& problem, const std::string& spec) {
  return [problem, spec] {
    const std::shared_ptr<Solver> solver = make_solver(spec);
    return [=, s = Solution()](long count) mutable {
      for (long k = 0; k < count; ++k)
        if (solver->solve(problem, s).status != Status::solved) throw std::runtime_error(spec + " fails");
    };
  };
}

/// The judge's verdict on auto's solution of a problem: its share of a solve or step.
inline auto verdicts_on(const Lcp& problem) {
  return [problem] {
    Solution s;
    make_solver("auto")->solve(problem, s);
    return [=, judge = std::make_shared<Judge>()](long count) mutable {
      for (long k = 0; k < count; ++k) judge->certify(problem, 1e-10, Claim::candidate, s);
      if (s.status != Status::solved) throw std::runtime_error("not solved");
    };
  };
}

/// The problem of the slider-crank's first step in contact.
inline Lcp slider_crank_problem() {
  const System system(slider_crank());
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto");
  State x = system.initial_state();
  while (scheme->problem().size() == 0)
    if (scheme->step(1e-5, *solver, x).status != Status::solved) throw std::runtime_error(scheme->why());
  return scheme->problem();
}

/// tridiagonal(−1, 4, −1) z − e: rows tied in each of Lemke's ratio tests.
inline Lcp tied_problem(int n) {
  RowSparse M{n, n, {0}, {}, {}};
  for (int i = 0; i < n; ++i) {
    for (const int j : {i - 1, i, i + 1})
      if (j >= 0 && j < n) M.column.push_back(j), M.value.push_back(j == i ? 4 : -1);
    M.start.push_back(static_cast<int>(M.column.size()));
  }
  Vector q;
  q.resize(n);
  q.setConstant(-1);
  return Lcp::standard(M, q);
}

inline std::vector<Work> watched_work() {
  Random random(1);
  const Lcp ten = random_spd_problem(10, random), hundred = random_spd_problem(100, random);
  const Lcp rubbing = random_contact_problem(6, 12, 0.3, random);
  return {
      {"slider_crank", "step", 2000, 4000, steps_of(slider_crank(), 1e-5)},
      {"chain", "step of 100 links", 20, 40, steps_of(chain({.links = 100}), 1e-3)},
      {"pile", "step of 30 discs", 200, 300, steps_of(pile({.discs = 30}), 1e-3)},
      {"spd_10", "solve by auto", 20, 40, solves_of(ten, "auto")},
      {"friction_12", "solve by auto", 20, 40, solves_of(rubbing, "auto")},
      {"judge_step", "verdict on the slider-crank's", 200, 400, [] { return verdicts_on(slider_crank_problem())(); }},
      {"judge_10", "verdict on spd_10's", 200, 400, verdicts_on(ten)},
      {"judge_100", "verdict on spd_100's", 20, 40, verdicts_on(hundred)},
      {"spd_100", "solve by Lemke's tableau", 2, 4, solves_of(hundred, "lemke:form=tableau")},
      {"ties_400", "solve by Lemke's revised form", 1, 2, solves_of(tied_problem(400), "lemke:form=revised")}};
}

}  // namespace orthant
