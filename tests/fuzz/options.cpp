// What follows a colon on the command line, and the names before it: "pgs:omega=1.3", "adaptive:rtol=1e-6".
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include "target.h"

bool orthant::fuzz::options(std::string_view bytes) {
  static const System kSystem(make_scene("bouncing_ball"));
  const bool solver = parse([&] { make_solver(bytes); });
  const bool integrator = parse([&] { make_integrator(bytes, kSystem); });
  const bool setting = parse([&] { make_scene("bouncing_ball", std::vector<std::string>{std::string(bytes)}); });
  return solver || integrator || setting;
}
