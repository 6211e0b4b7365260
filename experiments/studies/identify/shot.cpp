#include "experiments/studies/identify/shot.h"

#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kRadius = 0.028575, kMass = 0.17;  // [m, kg] of pool balls
constexpr double kRoll = 0.4 * kMass * kRadius * kRadius;
const ContactLaw kCloth{.mu = 0.2}, kCushion{.mu = 0.2, .e = 0.85}, kBalls{.mu = 0.06, .e = 0.95};

Eigen::VectorXd parameters_at(const Eigen::VectorXd& x, const Eigen::VectorXd& unit) { return x.cwiseProduct(unit); }

}  // namespace

Scene draw_shot(const Eigen::VectorXd& p) {
  Scene s;
  s.gravity = {0, -9.81};
  const auto ball = [&](const char* name, double x) {
    return s.body({.name = name, .mass = kMass, .inertia = kRoll, .position = {x, kRadius}});
  };
  const auto cue = ball("cue", 0), two = ball("two", 0.6);
  s.bodies[0].velocity = {p[0], 0}, s.bodies[0].omega = -p[1];
  s.contact(DiscWall{"cue_cloth", cue, {0, 0}, kRadius, kGround, {0, 0}, {0, 1}, kCloth});
  s.contact(DiscWall{"two_cloth", two, {0, 0}, kRadius, kGround, {0, 0}, {0, 1}, kCloth});
  s.contact(DiscWall{"two_cushion", two, {0, 0}, kRadius, kGround, {1.3, 0}, {-1, 0}, kCushion});
  s.contact(DiscDisc{"balls", cue, {0, 0}, kRadius, two, {0, 0}, kRadius, kBalls});
  return s;
}

spatial::Scene bank_shot(const Eigen::VectorXd& p) {
  spatial::Scene s;
  s.gravity = {0, 0, -9.81};
  const Vector3d along(std::cos(p[1]), std::sin(p[1]), 0), across(-along.y(), along.x(), 0);
  const auto ball = [&](const char* name, double x, double y) {
    return s.body(
        {.name = name, .mass = kMass, .inertia = Vector3d::Constant(kRoll).asDiagonal(), .position = {x, y, kRadius}});
  };
  const auto cue = ball("cue", 0, 0), two = ball("two", 1, 0.1);
  s.bodies[0].velocity = p[0] * along, s.bodies[0].omega = p[2] * across + p[3] * Vector3d::UnitZ();
  for (const BodyId body : {cue, two}) {
    const std::string name = body == cue ? "cue" : "two";
    s.contact(spatial::SpherePlane{name + "_cloth", body, {0, 0, 0}, kRadius, kGround, {0, 0, 0}, {0, 0, 1}, kCloth});
    s.contact(
        spatial::SpherePlane{name + "_cushion", body, {0, 0, 0}, kRadius, kGround, {0, -0.3, 0}, {0, 1, 0}, kCushion});
  }
  s.contact(spatial::SphereSphere{"balls", cue, {0, 0, 0}, kRadius, two, {0, 0, 0}, kRadius, kBalls});
  return s;
}

Shot::Shot(int dimension) : dimension_(dimension), duration_(dimension == 3 ? 1.5 : 2), solver_(make_solver("auto")) {
  if (dimension == 3) {
    names = {"speed", "direction", "follow", "side"};
    start = Eigen::Vector4d(2.5, -0.63, 20, 10), unit = Eigen::Vector4d(1, 0.1, 20, 20);
    low = Eigen::Vector4d(1, -1.2, -150, -150), high = Eigen::Vector4d(5, -0.3, 150, 150);
    aim = Eigen::Vector4d(1.28, 0.21, 1.95, 0.59);
  } else {
    names = {"speed", "follow"};
    start = Eigen::Vector2d(2, -40), unit = Eigen::Vector2d(1, 20);
    low = Eigen::Vector2d(0.5, -200), high = Eigen::Vector2d(5, 200);
    aim = Eigen::Vector2d(0.5, 0.8);
  }
}

Eigen::VectorXd Shot::places(const State& x) const {
  if (dimension_ == 2) return Eigen::Vector2d(x.q[0], x.q[3]);
  return Eigen::Vector4d(x.q[0], x.q[1], x.q[7], x.q[8]);
}

Eigen::VectorXd Shot::miss(const Eigen::VectorXd& x) {
  ++runs;
  const Eigen::VectorXd p = parameters_at(x, unit);
  const auto end_of = [&](auto& integrator) {
    const Run run = simulate(integrator, *solver_, {.step = duration_, .duration = duration_});
    if (run.status != Status::solved) throw std::runtime_error("event-driven: " + run.why);
    return Eigen::VectorXd(places(run.final) - aim);
  };
  if (dimension_ == 2) {
    const System system(draw_shot(p));
    EventDriven integrator(system);
    return end_of(integrator);
  }
  const SystemOf<Spatial> system(bank_shot(p));
  SpatialEventDriven integrator(system);
  return end_of(integrator);
}

Eigen::VectorXd Shot::miss(const Eigen::VectorXd& x, Eigen::MatrixXd& J) {
  const Eigen::Index n = x.size();
  J.resize(aim.size(), n);
  if (dimension_ == 3) {
    constexpr double kStep = 1e-5;  // errors of 1e-8: rounding of runs, and curvature
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(n, k);
      J.col(k) = (miss(x + step) - miss(x - step)) / (2 * kStep);
    }
    return miss(x);
  }
  ++tangents;
  std::vector<RunParameter> parameters;
  for (Eigen::Index k = 0; k < n; ++k)
    parameters.push_back({names[static_cast<std::size_t>(k)], x[k],
                          [this, x, k](double value) {
                            Eigen::VectorXd other = x;
                            other[k] = value;
                            return draw_shot(parameters_at(other, unit));
                          },
                          -1});
  const System system(draw_shot(parameters_at(x, unit)));
  const MotionTangent t = differentiate_motion(system, parameters, {}, *solver_, duration_);
  if (t.status != Status::solved) throw std::runtime_error("event-driven: " + t.why);
  if (!t.none.empty()) throw std::runtime_error("no derivative: " + t.none);
  J.row(0) = t.q.row(0), J.row(1) = t.q.row(3);
  return places(t.final) - aim;
}

void Shot::by_newton(Eigen::VectorXd& x, double enough) {
  constexpr double kShortest = 1e-3;  // of a step
  Eigen::VectorXd r = miss(x);
  Eigen::MatrixXd J;
  while (r.norm() > enough) {
    miss(x, J);
    const Eigen::VectorXd step = J.fullPivLu().solve(-r);
    double length = 1;
    Eigen::VectorXd next = miss(x + step);
    for (; !(next.norm() < r.norm()); next = miss(x + length * step))
      if ((length /= 2) < kShortest) throw std::runtime_error("Newton's method: no step makes the miss smaller");
    x += length * step, r = next;
  }
}

}  // namespace orthant
