// A mechanism in a few lines: a rod on a pin swings down and strikes a wall with friction.
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <iostream>

int main() {
  using namespace orthant;
  Scene scene;
  scene.gravity = {0, -9.81};
  const BodyId rod = scene.body({.name = "rod", .mass = 1, .inertia = 1.0 / 12, .position = {0.5, 0}});
  scene.joint(Revolute{"pin", kGround, rod, {0, 0}, {-0.5, 0}});
  scene.contact(CornerWall{.name = "tip",
                           .a = rod,
                           .point = {0.5, 0},
                           .wall_point = {-0.5, 0},
                           .normal = {1, 0},
                           .law = {.mu = 0.3, .e = 0.5}});

  const System system(scene);
  const auto integrator = make_integrator("adaptive:rtol=1e-8", system);
  const auto solver = make_solver("auto");
  const Run run = simulate(*integrator, *solver, {.step = 0.01, .duration = 1}, [](const RunSample& now) {
    if (now.impulses[0].normal > 0)
      std::cout << "t = " << now.state.t << " s: the wall gives " << now.impulses[0].normal << " N s\n";
  });
  std::cout << name(run.status) << ", joints kept to " << run.max_joint_residual << " m\n";
  return run.status == Status::solved ? 0 : 1;
}
