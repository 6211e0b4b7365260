// A joint of your own: gears. Two wheels on pins of the ground; the teeth keep r_a θ_a + r_b θ_b as it is.
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <iostream>

using namespace orthant;

struct Gears {
  static constexpr int kRows = 1;
  std::string name;
  BodyId a, b;
  double r_a, r_b;  // [m]

  void residual(const Kinematics& k, double* phi) const { phi[0] = r_a * k.at(a).theta + r_b * k.at(b).theta; }
  void rows(const Kinematics&, Row* G) const { G[0] = {a, b, {0, 0, r_a}, {0, 0, r_b}}; }
  void bias(const Kinematics&, double* Gdot_v) const { Gdot_v[0] = 0; }
};

int main() {
  Scene scene;
  const BodyId small = scene.body({.name = "small", .mass = 1, .inertia = 0.01});
  const BodyId large = scene.body({.name = "large", .mass = 4, .inertia = 0.16, .position = {0.3, 0}});
  scene.joint(Revolute{"pin1", kGround, small, {0, 0}, {0, 0}});
  scene.joint(Revolute{"pin2", kGround, large, {0.3, 0}, {0, 0}});
  scene.joint(Gears{"teeth", small, large, 0.1, 0.2});  // its derivatives are checked here, by differences
  scene.load({.name = "motor", .body = small, .torque = 1});

  const System system(scene);
  const Run run =
      simulate(*make_integrator("moreau-jean", system), *make_solver("auto"), {.step = 1e-3, .duration = 1});
  const double exact =
      1 / (0.01 + 0.16 / 4);  // [rad/s] after 1 s: the torque over the inertia that the small wheel feels
  std::cout << name(run.status) << ": omega = " << run.final.v[2] << ", exact " << exact << " rad/s\n";
  return run.status == Status::solved && std::abs(run.final.v[2] - exact) < 1e-9 ? 0 : 1;
}
