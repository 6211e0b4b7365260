#include "experiments/studies/exact_cases/pyramid_paths.h"

#include <orthant/core/scenes/cross_slope.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace orthant {
namespace {

constexpr double kTurnDegree = std::numbers::pi / 180;

struct Bend {
  double place = 0, angle = 0;  // [m], [degrees]
  void take(const Vector3d& there, const Vector3d& disc) {
    place = std::max(place, (there - disc).norm());
    angle = std::max(angle, std::atan2(there.cross(disc).norm(), there.dot(disc)) / kTurnDegree);
  }
};

Vector3d stops_at(const CrossSlope& p, const std::string& solver) {
  const SystemOf<Spatial> system(cross_slope(p));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto method = make_solver(solver);
  const Run run = simulate(*scheme, *method, {.step = 1e-4, .duration = 0.5});
  return run.status == Status::solved ? Vector3d(place_of<Spatial>(run.final.q, 0)) : Vector3d(kInf, kInf, kInf);
}

}  // namespace

std::string pyramid_paths() {
  std::string table =
      "\nBlock sent across a slope, turned by 0 to 45 degrees against the facets (largest values):\n\n"
      "| friction | solver | distance from the disc's stop [m] | of the exact path | off by [degrees] | exactly |\n"
      "|---|---|---|---|---|---|\n";
  for (const int sides : {0, 4, 8, 16}) {
    const std::string solver = sides == 0 ? "auto" : "lemke:facets=" + std::to_string(sides);
    Bend found, exact;
    for (const double degrees : {0.0, 5.0, 11.25, 22.5, 30.0, 45.0}) {
      CrossSlope p;
      p.turn = degrees * kTurnDegree;
      const Vector3d disc = stop_on_slope(p)->place;
      found.take(stops_at(p, solver), disc);
      exact.take(sides == 0 ? disc : stop_on_slope(p, sides)->place, disc);
    }
    char line[200];
    std::snprintf(line, sizeof line, "| %s | `%s` | %.2g | %.2g | %.2g | %.2g |\n",
                  sides == 0 ? "disc" : (std::to_string(sides) + " facets").c_str(), solver.c_str(), found.place,
                  exact.place, found.angle, exact.angle);
    table += line;
  }
  return table;
}

}  // namespace orthant
