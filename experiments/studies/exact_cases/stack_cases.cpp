// Exact cases of statics: tables, towers, columns of grains and arches.
#include "experiments/studies/exact_cases/case_groups.h"

#include <orthant/core/scenes/arch.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/table.h>
#include <orthant/core/scenes/tower.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace orthant {
namespace {

/// Mean contact forces since the start.
class Forces {
 public:
  std::span<const double> operator()(const RunSample& m) {
    impulses_.resize(m.impulses.size()), forces_.resize(m.impulses.size());
    for (std::size_t i = 0; i < impulses_.size(); ++i) {
      impulses_[i] += m.impulses[i].normal;
      forces_[i] = m.state.t > 0 ? impulses_[i] / m.state.t : 0;
    }
    return forces_;
  }

 private:
  std::vector<double> impulses_, forces_;
};

}  // namespace

void rest_cases(std::vector<ExactCase>& all) {
  const Table legs;
  all.push_back({.id = "B11",
                 .title = "table on four legs, weight off the middle: any true answer",
                 .measure = "misfit of the legs' forces [N, N m]",
                 .scene = table(legs),
                 .duration = 0.125,
                 .h = 0x1p-7,
                 .error =
                     [legs, forces = Forces()](const RunSample& m) mutable {
                       const auto f = forces(m);
                       return m.state.t > 0 ? legs.misfit(f) : 0;
                     },
                 .motion = ExactCase::Motion::instant});
  for (const Tower& p : {Tower{}, Tower{.blocks = 8, .ratio = 10}, Tower{.blocks = 8, .ratio = 0.1},
                         Tower{.blocks = 8, .ratio = 10, .corners = 2}})
    all.push_back({.id = "B12",
                   .title = "tower of " + std::to_string(p.blocks) + ", masses by " +
                            (p.ratio > 1e3 ? "1e6"
                             : p.ratio > 1 ? "10"
                                           : "1/10") +
                            (p.corners == 2 ? ", two corners" : ""),
                   .measure = "largest relative error of a level's force",
                   .scene = tower(p),
                   .duration = 0.125,
                   .h = 0x1p-7,
                   .error =
                       [p, forces = Forces()](const RunSample& m) mutable {
                         const auto f = forces(m);
                         double worst = 0;
                         for (int k = 1; k <= p.blocks && m.state.t > 0; ++k) {
                           double sum = 0;
                           for (int c = 0; c < p.corners; ++c)
                             sum += f[static_cast<std::size_t>(p.corners * (k - 1) + c)];
                           worst = std::max(worst, std::abs(sum / p.force(k) - 1));
                         }
                         return worst;
                       },
                   .motion = ExactCase::Motion::instant});
  for (const double ratio : {1.0, 10.0, 100.0, 1e4, 1e6}) {
    const double sweeps = std::log(1e-8) / std::log(ratio / (1 + ratio));
    all.push_back({.id = "B12",
                   .title = "sweeps of projected Gauss-Seidel, masses by " + std::to_string(static_cast<int>(ratio)),
                   .measure = "their number against the contraction's, relative",
                   .scene = tower({.ratio = ratio}),
                   .duration = 0x1p-7,
                   .h = 0x1p-7,
                   .error =
                       [sweeps](const RunSample& m) {
                         return m.state.t > 0 ? std::abs(m.report.lcp_iterations / sweeps - 1) : 0;
                       },
                   .motion = ExactCase::Motion::instant,
                   .exact = 0.1,
                   .solvers = {"pgs:tolerance=1e-8,max_sweeps=100000000"},
                   .integrator = "moreau-jean"});
  }
  for (const int grains : {10, 100}) {
    const GrainColumn p{.grains = grains};
    all.push_back({.id = "B20",
                   .title = "column of " + std::to_string(grains) + " grains stops at once",
                   .measure = "largest relative error of a level's impulse",
                   .scene = grain_column(p),
                   .duration = 0.125,
                   .h = 0x1p-7,
                   .error =
                       [p, sum = std::vector<double>(static_cast<std::size_t>(grains))](const RunSample& m) mutable {
                         double worst = 0;
                         for (int k = 1; k <= p.grains; ++k) {
                           double& impulse = sum[static_cast<std::size_t>(k - 1)];
                           impulse += m.impulses[static_cast<std::size_t>(k - 1)].normal;
                           if (m.state.t > 0) worst = std::max(worst, std::abs(impulse / p.impulse(k, m.state.t) - 1));
                         }
                         return worst;
                       },
                   .motion = ExactCase::Motion::instant});
  }
}

void arch_cases(std::vector<ExactCase>& all) {
  for (const bool stands : {true, false}) {
    Arch p;
    p.thickness = (stands ? 1.02 : 0.98) * p.least_thickness();
    all.push_back(
        {.id = "B13",
         .title = stands ? "arch 2 % thicker than the least: stands" : "arch 2 % thinner than the least: falls",
         .measure = stands ? "largest speed [m/s]" : "0 when it moves faster than 1e-3 m/s, else 1",
         .scene = arch(p),
         .duration = 0.02,
         .h = 1e-3,
         .error =
             [stands](const RunSample& m) {
               const double speed = m.state.v.lpNorm<Eigen::Infinity>();
               return stands ? speed : speed > 1e-3 ? 0 : 1;
             },
         .motion = ExactCase::Motion::instant});
  }
}

/// From 2 % below to 2 % above the least thickness.
void thinnest_arch_cases(std::vector<ExactCase>& all) {
  const double least = Arch{}.least_thickness();
  all.push_back({.id = "B13",
                 .title = "least thickness at which the arch stands, by bisection",
                 .measure = "relative distance of the bracket from the exact one",
                 .scene = arch(),
                 .duration = 0.01,
                 .h = 1e-3,
                 .error = [](const RunSample& m) { return m.state.v.lpNorm<Eigen::Infinity>() > 1e-5 ? 1 : 0; },
                 .throughout = true,
                 .motion = ExactCase::Motion::instant,
                 .exact = 1e-3,
                 .family = [](double t) { return arch({.thickness = t}); },
                 .low = 0.98 * least,
                 .high = 1.02 * least,
                 .threshold = least,
                 .solvers = {"auto", "newton-fb"}});
}

}  // namespace orthant
