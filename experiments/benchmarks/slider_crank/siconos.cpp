// Siconos Kernel: Moreau-Jean time stepping, θ = 1/2, in minimal coordinates θ₁, θ₂, θ₃.
//
//   Joints need no constraints then, nothing drifts: its best model of this mechanism, and the one its users know.
//   Newton's restitution and Coulomb friction as the exact solution has them. Two methods: Newton iterations to the end
//   of each step's equations, its default, and one iteration only, which here is nearer to the exact motion.
//   M(q) v̇ + F_gyr(q, v) + F_int(q) = forces of the corners:  with K = l1 l2 (m2/2 + m3), Δ = θ₁ − θ₂
//     M₁₁ = J1 + l1² (m1/4 + m2 + m3),  M₂₂ = J2 + l2² (m2/4 + m3),  M₁₂ = K cos Δ,  M₃₃ = J3
//     F_gyr = K sin Δ (ω₂², −ω₁², 0),   F_int = g ((m1/2 + m2 + m3) l1 cos θ₁, (m2/2 + m3) l2 cos θ₂, 0)
#include <SolverOptions.h>
#include <SiconosKernel.hpp>

#include "driver.h"

using namespace rival;

namespace {

constexpr double K = l1 * l2 * (m2 / 2 + m3), M11 = J1 + l1 * l1 * (m1 / 4 + m2 + m3),
                 M22 = J2 + l2 * l2 * (m2 / 4 + m3);
constexpr double G1 = g * (m1 / 2 + m2 + m3) * l1, G2 = g * (m2 / 2 + m3) * l2;

/// Arrays by columns, 3 × 3.
void mass(unsigned, double* q, double* M, unsigned, double*) {
  std::fill(M, M + 9, 0);
  M[0] = M11, M[4] = M22, M[8] = J3, M[1] = M[3] = K * std::cos(q[0] - q[1]);
}
void gyroscopic(unsigned, double* q, double* v, double* F, unsigned, double*) {
  const double s = K * std::sin(q[0] - q[1]);
  F[0] = s * v[1] * v[1], F[1] = -s * v[0] * v[0], F[2] = 0;
}
void gyroscopic_q(unsigned, double* q, double* v, double* J, unsigned, double*) {
  const double c = K * std::cos(q[0] - q[1]);
  std::fill(J, J + 9, 0);
  J[0] = c * v[1] * v[1], J[3] = -J[0], J[1] = -c * v[0] * v[0], J[4] = -J[1];
}
void gyroscopic_v(unsigned, double* q, double* v, double* J, unsigned, double*) {
  const double s = K * std::sin(q[0] - q[1]);
  std::fill(J, J + 9, 0);
  J[3] = 2 * s * v[1], J[1] = -2 * s * v[0];
}
void gravity(double, unsigned, double* q, double*, double* F, unsigned, double*) {
  F[0] = G1 * std::cos(q[0]), F[1] = G2 * std::cos(q[1]), F[2] = 0;
}
void gravity_q(double, unsigned, double* q, double*, double* J, unsigned, double*) {
  std::fill(J, J + 9, 0);
  J[0] = -G1 * std::sin(q[0]), J[4] = -G2 * std::sin(q[1]);
}
void gravity_v(double, unsigned, double*, double*, double* J, unsigned, double*) { std::fill(J, J + 9, 0); }

/// A corner (x, y of the slider's frame) against the wall above or below: gap and, of friction, the way along the wall.
class Corner : public LagrangianScleronomousR {
 public:
  Corner(double x, double y) : x_(x), y_(y), side_(y > 0 ? -1 : 1) {}
  void computeh(const BlockVector& q, BlockVector&, SiconosVector& h) override {
    h(0) = wall + side_ * (l1 * std::sin(q(0)) + l2 * std::sin(q(1)) + x_ * std::sin(q(2)) + y_ * std::cos(q(2)));
    if (h.size() > 1) h(1) = l1 * std::cos(q(0)) + l2 * std::cos(q(1)) + x_ * std::cos(q(2)) - y_ * std::sin(q(2));
  }
  void computeJachq(const BlockVector& q, BlockVector&) override {
    SimpleMatrix& J = *_jachq;
    const double s = std::sin(q(2)), c = std::cos(q(2));
    J(0, 0) = side_ * l1 * std::cos(q(0)), J(0, 1) = side_ * l2 * std::cos(q(1)), J(0, 2) = side_ * (x_ * c - y_ * s);
    if (J.size(0) < 2) return;
    J(1, 0) = -l1 * std::sin(q(0)), J(1, 1) = -l2 * std::sin(q(1)), J(1, 2) = -x_ * s - y_ * c;
  }

 private:
  double x_, y_, side_;
};

std::function<Motion()> build(double mu, double e, double h, int newton) {
  auto q = std::make_shared<SiconosVector>(3), v = std::make_shared<SiconosVector>(3);
  q->zero(), v->zero();
  (*v)(0) = omega1, (*v)(1) = omega2;
  auto mechanism = std::make_shared<LagrangianDS>(q, v);
  mechanism->setComputeMassFunction(mass);
  mechanism->setComputeFGyrFunction(gyroscopic);
  mechanism->setComputeJacobianFGyrqFunction(gyroscopic_q);
  mechanism->setComputeJacobianFGyrqDotFunction(gyroscopic_v);
  mechanism->setComputeFIntFunction(gravity);
  mechanism->setComputeJacobianFIntqFunction(gravity_q);
  mechanism->setComputeJacobianFIntqDotFunction(gravity_v);

  auto system = std::make_shared<NonSmoothDynamicalSystem>(0, duration);
  system->insertDynamicalSystem(mechanism);
  SP::NonSmoothLaw law;
  if (mu > 0)
    law = std::make_shared<NewtonImpactFrictionNSL>(e, 0, mu, 2);
  else
    law = std::make_shared<NewtonImpactNSL>(e);
  for (const double y : {b, -b})
    for (const double x : {-a, a})
      system->link(std::make_shared<Interaction>(law, std::make_shared<Corner>(x, y)), mechanism);

  SP::OneStepNSProblem impact;
  if (mu > 0)
    impact = std::make_shared<FrictionContact>(2, SICONOS_FRICTION_2D_ENUM);
  else
    impact = std::make_shared<LCP>(SICONOS_LCP_LEMKE);
  impact->numericsSolverOptions()->dparam[SICONOS_DPARAM_TOL] = 1e-10;
  auto stepping = std::make_shared<TimeStepping>(system, std::make_shared<TimeDiscretisation>(0, h),
                                                 std::make_shared<MoreauJeanOSI>(0.5, 0.0), impact);
  stepping->setNewtonTolerance(1e-10);
  stepping->setNewtonMaxIteration(200);
  stepping->setNewtonOptions(newton);
  stepping->initialize();
  return [=] {
    Motion motion;
    for (const long steps = std::lround(duration / h); motion.steps < steps; ++motion.steps) {
      stepping->advanceToEvent();
      stepping->processEvents();
    }
    motion.theta1 = (*mechanism->q())(0);
    return motion;
  };
}

}  // namespace

int main(int argc, char** argv) {
  const auto with = [](int newton) {
    return [newton](double mu, double e, double h) { return build(mu, e, h, newton); };
  };
  return drive(argc, argv,
               {{"moreau-jean", "step", with(SICONOS_TS_NONLINEAR)},
                {"moreau-jean-one-newton", "step", with(SICONOS_TS_LINEAR_IMPLICIT)}});
}
