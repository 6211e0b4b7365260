// Does a step cost only what the scene holds? The slider-crank without some of its parts, relative to the whole.
//
// Printed as a Markdown table: the least time of several runs of 0.05 s of motion, h = 1e-5, over its steps; in units
// of the whole scene's, all measured in turn so that they meet the same disturbances.
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <functional>
#include <iomanip>
#include <iostream>

using namespace orthant;

int main(int argc, char** argv) try {
  CLI::App app("Cost of a step of the slider-crank with parts of the scene left out");
  std::string integrator = "moreau-jean", solver = "auto";
  int repeats = 7;
  app.add_option("--integrator", integrator, "NAME[:option=value,...]")->capture_default_str();
  app.add_option("--solver", solver, "NAME[:option=value,...]")->capture_default_str();
  app.add_option("--repeats", repeats, "runs of each scene; the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;

  struct Variant {
    std::string name;
    Scene scene;
    double seconds = kInf;  // of a step
    long steps = 0;
  };
  const auto changed = [](const SliderCrank& p, const std::function<void(Scene&)>& change) {
    Scene scene = slider_crank(p);
    change(scene);
    return scene;
  };
  std::vector<Variant> variants{
      {"whole", slider_crank()},
      {"frictionless", slider_crank({.mu = 0})},
      {"walls out of reach (1 m)", slider_crank({.clearance = 1})},
      {"walls far away, a free body more",
       changed({.clearance = 1},
               [](Scene& s) {
                 s.body({.name = "far", .mass = 1, .inertia = 1, .position = {100, 100}});
               })},
      {"without contacts", changed({}, [](Scene& s) { s.contacts.clear(); })},
      {"walls far away, without joints", changed({.clearance = 1}, [](Scene& s) { s.joints.clear(); })},
      {"bodies alone", changed({}, [](Scene& s) { s.contacts.clear(), s.joints.clear(); })},
  };
  for (int k = 0; k < repeats; ++k)
    for (Variant& v : variants) {
      const System system(v.scene);
      const auto scheme = make_integrator(integrator, system);
      const auto chosen = make_solver(solver);
      const double begin = thread_time();
      const Run run = simulate(*scheme, *chosen, {.step = 1e-5, .duration = 0.05, .every = 1 << 20});
      const double spent = thread_time() - begin;
      if (run.status != Status::solved) {
        std::cerr << v.name << ": " << name(run.status) << ": " << scheme->why() << '\n';
        return 1;
      }
      v.seconds = std::min(v.seconds, spent / static_cast<double>(run.steps)), v.steps = run.steps;
    }
  std::cout << "| scene | step, µs | of the whole |\n|---|---|---|\n" << std::fixed;
  for (const Variant& v : variants)
    std::cout << "| " << v.name << " | " << std::setprecision(2) << 1e6 * v.seconds << " | "
              << v.seconds / variants[0].seconds << " |\n";
} catch (const std::exception& error) {  // an unknown integrator, solver or option
  std::cerr << "scene_content: " << error.what() << '\n';
  return 1;
}
