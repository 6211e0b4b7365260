#include "experiments/studies/pile_scaling/columns.h"

#include <orthant/core/mechanics/spatial/solid.h>

#include <iostream>

namespace orthant {

namespace {

/// The problem of a column of spheres at rest, each on the next one.
Lcp column(int count, double h) {
  constexpr double kRadius = 0.05;
  const spatial::Solid solid = spatial::sphere(kRadius);
  spatial::Scene s;
  s.gravity = {0, 0, -kGravity};
  spatial::Collision all{.name = "column", .shapes = {}, .law = {.mu = 0.3}};
  for (int i = 0; i < count; ++i) {
    const BodyId body = s.body({.name = "sphere" + std::to_string(i + 1),
                                .mass = 1000 * solid.volume,
                                .inertia = 1000 * solid.volume * solid.inertia,
                                .position = {0, 0, (2 * i + 1) * kRadius}});
    all.shapes.push_back({body, {Vector3d::Zero()}, kRadius});
    if (i > 0) continue;
    spatial::SpherePlane floor{.name = "floor", .a = body, .law = all.law};
    floor.radius = kRadius;
    s.contact(floor);
  }
  s.collision(std::move(all));
  const SystemOf<Spatial> system(std::move(s));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto:tolerance=1e-6");
  State x = system.initial_state();
  scheme->step(h, *solver, x);
  return scheme->problem();
}

}  // namespace

void columns(const std::vector<int>& heights, const std::vector<std::string>& specs, double tolerance,
             const Settling& way) {
  std::cout << "| spheres | contacts |";
  for (const std::string& spec : specs) std::cout << " `" << spec << "` |";
  std::cout << "\n|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) std::cout << "---|";
  std::cout << std::endl;
  for (const int height : heights) {
    const Lcp problem = column(height, way.h);
    std::cout << "| " << height << " | " << problem.friction.size() << " |";
    for (const std::string& spec : specs) {
      const auto solver = make_solver(with(spec, tolerance));
      solver->set_time_limit(way.time_limit);
      Solution s;
      const Status status = solver->solve(problem, s).status;
      std::cout << ' ';
      if (has_answer(status))
        std::cout << s.iterations;
      else
        std::cout << name(status);
      if (s.factorizations > 0) std::cout << " (" << s.factorizations << " factorizations)";
      std::cout << " |" << std::flush;
    }
    std::cout << '\n';
  }
}

}  // namespace orthant
