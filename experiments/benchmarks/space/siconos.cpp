// Siconos Kernel and Mechanics: motions in space of Newton-Euler bodies by Moreau-Jean time stepping, θ = 1/2.
//
//   DRIVER                    prints a line for each: motion, method, and what its setting is
//   DRIVER MOTION METHOD STEP runs it and prints: seconds of the run alone, then the end [m]
//
//   Rigid contact, Newton's restitution, Coulomb's cone by two of its solvers; joints as constraints on velocities
//   (its projection onto positions changes the end by less than its error). It has no Hooke joint: a cross of 1e-6 kg
//   with two hinges.
//   The motions: motions.py. Timed is the loop over steps, processor time, once the model is built.
#include "../../support/clock.h"

#include <SiconosKernel.hpp>

#include <SolverOptions.h>
#include <KneeJointR.hpp>
#include <PivotJointR.hpp>
#include <PrismaticJointR.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double g = 9.81;
using Body = std::shared_ptr<NewtonEulerDS>;
using Run = std::function<std::vector<double>()>;

SP::SiconosVector vector(const std::vector<double>& values) {
  auto v = std::make_shared<SiconosVector>(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) (*v)(i) = values[i];
  return v;
}

/// q: place and quaternion; twist: velocity, angular velocity in the body's frame; principal moments of inertia.
Body body(const std::vector<double>& q, const std::vector<double>& twist, double mass, const double (&moments)[3]) {
  auto inertia = std::make_shared<SimpleMatrix>(3, 3);
  inertia->zero();
  for (int i = 0; i < 3; ++i) (*inertia)(i, i) = moments[i];
  auto made = std::make_shared<NewtonEulerDS>(vector(q), vector(twist), mass, inertia);
  made->setFExtPtr(vector({0, 0, -mass * g}));
  return made;
}

/// A ball on the floor z = 0.
class BallOnFloor : public NewtonEuler3DR {
 public:
  explicit BallOnFloor(double radius) : radius_(radius) {}
  void computeh(double, const BlockVector& q, SiconosVector& y) override {
    (*_Pc1)(0) = (*_Pc2)(0) = q(0), (*_Pc1)(1) = (*_Pc2)(1) = q(1);
    (*_Pc1)(2) = q(2) - radius_, (*_Pc2)(2) = 0;
    (*_Nc)(0) = (*_Nc)(1) = 0, (*_Nc)(2) = 1;
    y(0) = q(2) - radius_;
  }

 private:
  double radius_;
};

struct Ball {
  double radius, mass, mu, e, height, duration;  // [m, kg, -, -, m above the floor, s]
  double v[3], omega[3];
  int coordinates;  // of the end: x, y or all
};

Run run_of(const std::shared_ptr<TimeStepping>& stepping, double duration, double h,
           std::function<std::vector<double>()> end) {
  stepping->setNewtonTolerance(1e-10);
  stepping->setNewtonMaxIteration(200);
  stepping->initialize();
  return [=] {
    for (long left = std::lround(duration / h); left > 0; --left) {
      stepping->advanceToEvent();
      stepping->processEvents();
    }
    return end();
  };
}

Run ball(const Ball& p, int solver, double h) {
  const double J = 0.4 * p.mass * p.radius * p.radius;
  const Body made = body({0, 0, p.radius + p.height, 1, 0, 0, 0},
                         {p.v[0], p.v[1], p.v[2], p.omega[0], p.omega[1], p.omega[2]}, p.mass, {J, J, J});
  auto system = std::make_shared<NonSmoothDynamicalSystem>(0, p.duration);
  system->insertDynamicalSystem(made);
  system->link(std::make_shared<Interaction>(std::make_shared<NewtonImpactFrictionNSL>(p.e, 0, p.mu, 3),
                                             std::make_shared<BallOnFloor>(p.radius)),
               made);
  auto cone = std::make_shared<FrictionContact>(3, solver);
  cone->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = 1e-10;
  cone->numericsSolverOptions()->iparam[SICONOS_IPARAM_MAX_ITER] = 10000;
  auto stepping = std::make_shared<TimeStepping>(system, std::make_shared<TimeDiscretisation>(0, h),
                                                 std::make_shared<MoreauJeanOSI>(0.5, 0.0), cone);
  return run_of(stepping, p.duration, h, [made, n = p.coordinates] {
    std::vector<double> end;
    for (int i = 0; i < n; ++i) end.push_back((*made->q())(i));
    return end;
  });
}

/// Quaternion of the rotation with these columns, a trace above −1.
std::vector<double> quaternion(const double (&x)[3], const double (&y)[3], const double (&z)[3]) {
  const double w = std::sqrt(1 + x[0] + y[1] + z[2]) / 2;
  return {w, (y[2] - z[1]) / (4 * w), (z[0] - x[2]) / (4 * w), (x[1] - y[0]) / (4 * w)};
}

Run slider_crank(double h) {
  const double r5 = std::sqrt(5.0), along[3] = {2 / 3.0, -1 / 3.0, -2 / 3.0}, square[3] = {0, 2 / r5, -1 / r5};
  const double third[3] = {along[1] * square[2] - along[2] * square[1], along[2] * square[0] - along[0] * square[2],
                           along[0] * square[1] - along[1] * square[0]};
  const double turn[3] = {1.92, -0.96, 0.48};  // [rad/s] of the rod
  const auto dot = [](const double(&a)[3], const double(&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const double in_rod[3] = {dot(along, turn), dot(square, turn), dot(third, turn)};
  const std::vector<double> R = quaternion(along, square, third);
  const Body crank = body({0, 0.1, 0.16, 1, 0, 0, 0}, {0, -0.24, 0, 6, 0, 0}, 0.12, {1e-4, 1e-4, 1e-5});
  // The rod's middle is the mean of its ends: 0, −.48, 0 at the pin and .24, 0, 0 at the slider.
  const Body rod = body({0.1, 0.05, 0.1, R[0], R[1], R[2], R[3]}, {0.12, -0.24, 0, in_rod[0], in_rod[1], in_rod[2]},
                        0.5, {4e-4, 4e-3, 4e-3});
  const Body slider = body({0.2, 0, 0, 1, 0, 0, 0}, {0.24, 0, 0, 0, 0, 0}, 2, {1e-4, 1e-4, 1e-4});
  // The cross turns with the slider's axis x only: the rest of the rod's rate is about the other axis.
  const double about_x = turn[0];
  const Body cross = body({0.2, 0, 0, 1, 0, 0, 0}, {0.24, 0, 0, about_x, 0, 0}, 1e-6, {1e-10, 1e-10, 1e-10});
  auto system = std::make_shared<NonSmoothDynamicalSystem>(0, 5);
  for (const Body& one : {crank, rod, slider, cross}) system->insertDynamicalSystem(one);
  const auto link = [&](const std::shared_ptr<NewtonEulerJointR>& joint, const Body& a, const Body& b) {
    auto law = std::make_shared<EqualityConditionNSL>(joint->numberOfConstraints());
    system->link(std::make_shared<Interaction>(law, joint), a, b);
  };
  const auto x = vector({1, 0, 0}), end = vector({0.2, 0, 0});
  link(std::make_shared<PivotJointR>(vector({0, 0.1, 0.12}), x, true, crank), crank, nullptr);
  link(std::make_shared<KneeJointR>(vector({0, 0.1, 0.2}), true, crank, rod), crank, rod);
  link(std::make_shared<PivotJointR>(end, x, true, slider, cross), slider, cross);
  link(std::make_shared<PivotJointR>(end, vector({square[0], square[1], square[2]}), true, cross, rod), cross, rod);
  link(std::make_shared<PrismaticJointR>(x, true, slider), slider, nullptr);

  auto stepping =
      std::make_shared<TimeStepping>(system, std::make_shared<TimeDiscretisation>(0, h),
                                     std::make_shared<MoreauJeanOSI>(0.5, 0.0), std::make_shared<Equality>());
  return run_of(stepping, 5, h, [slider] { return std::vector<double>{(*slider->q())(0)}; });
}

struct Case {
  const char *motion, *method;
  std::function<Run(double h)> build;
};

const Ball masse{0.028575, 0.17, 0.2, 0, 0, 1, {1, 0, 0}, {-60, -100, 40}, 2};
const Ball bounces{0.1, 1, 0.25, 0.5, 0.4, 0.73, {2, 1, 0}, {10, -20, 5}, 3};

std::vector<Case> cases() {
  const auto with = [](const Ball& p, int solver) { return [&p, solver](double h) { return ball(p, solver, h); }; };
  return {{"masse", "nsgs", with(masse, SICONOS_FRICTION_3D_NSGS)},
          {"masse", "nsn-ac", with(masse, SICONOS_FRICTION_3D_NSN_AC)},
          {"slider_crank", "moreau-jean", slider_crank},
          {"bounces", "nsgs", with(bounces, SICONOS_FRICTION_3D_NSGS)},
          {"bounces", "nsn-ac", with(bounces, SICONOS_FRICTION_3D_NSN_AC)}};
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 4)
    for (const Case& one : cases())
      if (!std::strcmp(one.motion, argv[1]) && !std::strcmp(one.method, argv[2])) {
        const Run run = one.build(std::atof(argv[3]));
        const double begin = rival::processor_time();
        const std::vector<double> end = run();
        std::printf("%.9g", rival::processor_time() - begin);
        for (const double value : end) std::printf(" %.17g", value);
        std::printf("\n");
        return 0;
      }
  for (const Case& one : cases()) std::printf("%s %s step\n", one.motion, one.method);
  return argc == 1 ? 0 : 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
