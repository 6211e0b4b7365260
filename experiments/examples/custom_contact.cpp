// A contact of your own: a particle slides and bounces on a wavy floor y = A sin(κ x), without friction.
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <iostream>

using namespace orthant;

struct WavyFloor {
  std::string name;
  BodyId a, b = kGround;
  ContactLaw law;
  double height, kappa;  // A [m], κ [1/m]

  double gap(const Kinematics& k) const { return k.at(a).x.y() - height * std::sin(kappa * k.at(a).x.x()); }
  ContactRows rows(const Kinematics& k) const {  // with friction both would have to be of unit directions
    const double slope = height * kappa * std::cos(kappa * k.at(a).x.x());
    return {{a, b, {-slope, 1, 0}, {}}, {a, b, {1, slope, 0}, {}}};
  }
  ContactBias bias(const Kinematics& k) const {
    const Vector2d v = k.rate(a).v;
    const double bend = -height * kappa * kappa * std::sin(kappa * k.at(a).x.x());
    return {-bend * v.x() * v.x(), bend * v.x() * v.y()};
  }
  double length() const { return 1 / kappa; }
};

int main() {
  Scene scene;
  scene.gravity = {0, -9.81};
  const BodyId bead =
      scene.body({.name = "bead", .mass = 1, .inertia = 1, .position = {0.4, 0.5}, .velocity = {0.5, 0}});
  scene.contact(WavyFloor{"floor", bead, kGround, {.e = 0.5}, 0.05, 6});

  const System system(scene);
  const Run run =
      simulate(*make_integrator("adaptive:rtol=1e-8", system), *make_solver("auto"), {.step = 0.01, .duration = 2});
  std::cout << name(run.status) << ": at x = " << run.final.q[0] << " m, below the floor by at most "
            << run.max_penetration << " m\n";
  return run.status == Status::solved && run.max_penetration < 1e-6 ? 0 : 1;
}
