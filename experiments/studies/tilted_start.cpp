// Why time stepping cannot converge on a slider-crank that starts tilted: the restitution of its slider's face.
//
// With ω₃ = −0.01 rad/s the slider reaches the wall with one corner first. Its corners then strike in turn: with e =
// 0.4 infinitely often within 1.6 µs, and the face as a whole is stopped, its effective restitution is 0. So it is up
// to e = 0.65; beyond, the impacts are finitely many and leave a part of e (paper/notes/tilted_start.md).
// A step of size h sees but a few of these impacts. Printed: the face's effective restitution
//   Σ Λ_N of the top corners while the strikes last / the same for e = 0 from the symmetric start − 1
// against h, by integrator, from a state that event-driven integration has brought to 1 µs before the first touch.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <iomanip>
#include <iostream>

using namespace orthant;

namespace {

/// The scene again, starting where a run ended.
Scene from(Scene scene, const State& x) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const auto k = static_cast<Index>(3 * i);
    Body& body = scene.bodies[i];
    body.position = {x.q[k], x.q[k + 1]}, body.angle = x.q[k + 2];
    body.velocity = {x.v[k], x.v[k + 1]}, body.omega = x.v[k + 2];
  }
  return scene;
}

State at(const Scene& scene, double t) {
  const System system(scene);
  const auto scheme = make_integrator("event-driven", system);
  const Run run = simulate(*scheme, *make_solver("lemke"), {.step = t, .duration = t});
  if (run.status != Status::solved) throw std::runtime_error("event-driven: " + run.why);
  return run.final;
}

double first_touch(const Scene& scene) {
  const System system(scene);
  const auto scheme = make_integrator("event-driven", system);
  double t = kInf;
  simulate(*scheme, *make_solver("lemke"), {.step = 4e-3, .duration = 4e-3}, [&](const RunSample& moment) {
    if (!moment.events.empty()) t = std::min(t, moment.events.front().t);
  });
  return t;
}

/// Σ Λ_N of the two top corners over `duration`; NaN when the run failed.
double impulse(const Scene& scene, const std::string& integrator, double h, double duration) {
  const System system(scene);
  const auto scheme = make_integrator(integrator, system);
  double sum = 0;
  const Run run =
      simulate(*scheme, *make_solver("lemke"), {.step = h, .duration = duration, .every = 1 << 20},
               [&](const RunSample& moment) { sum += moment.impulses[0].normal + moment.impulses[1].normal; });
  return run.status == Status::solved ? sum : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

int main(int argc, char** argv) {
  double omega3 = -0.01, e = 0.4, finest = 1e-9;
  std::vector<std::string> specs{"moreau-jean", "rattle", "generalized-alpha", "stewart-trinkle", "event-driven"};
  CLI::App app("Slider-crank that starts tilted: effective restitution of the slider's face against step size");
  app.add_option("--omega3", omega3, "initial angular velocity of the slider [rad/s]")
      ->check(between(-1e6, 1e6))
      ->capture_default_str();
  app.add_option("--restitution", e, "of each corner")->check(between(0.0, 1.0))->capture_default_str();
  app.add_option("--finest", finest, "smallest step size [s]")->check(between(1e-11, 1e-5))->capture_default_str();
  app.add_option("--integrators", specs, "NAME[:option=value,...] ...")->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  try {
    const double before = 1e-6;  // [s]
    const Scene tilted = slider_crank({.e = e, .omega3 = omega3}), plain = slider_crank({.e = 0});
    const System checked(tilted);
    for (const std::string& spec : specs) make_integrator(spec, checked);  // throws if unknown
    const double touch = first_touch(tilted), plain_touch = first_touch(plain);
    std::cout << "first touch at " << std::setprecision(15) << touch << " s\n" << std::setprecision(3) << "| h [s] |";
    for (const std::string& spec : specs) std::cout << " `" << spec << "` |";
    std::cout << "\n|---|";
    for (std::size_t i = 0; i < specs.size(); ++i) std::cout << "---|";
    std::cout << '\n';
    const Scene start = from(tilted, at(tilted, touch - before)),
                plain_start = from(plain, at(plain, plain_touch - before));
    const double stop = impulse(plain_start, "event-driven", 2 * before, 2 * before);  // the impact, and 1 µs
    for (double h = 1e-6; h > 0.9 * finest; h /= 10) {
      const double duration = before + std::max(2e-6, 20 * h);
      std::cout << "| " << h << " |";
      for (const std::string& spec : specs) std::cout << ' ' << impulse(start, spec, h, duration) / stop - 1 << " |";
      std::cout << std::endl;
    }
  } catch (const std::exception& error) {
    std::cerr << "tilted_start: " << error.what() << '\n';
    return 1;
  }
}
