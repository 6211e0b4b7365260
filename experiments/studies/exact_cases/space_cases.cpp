#include "experiments/studies/exact_cases/space_groups.h"

#include <orthant/core/scenes/bennett.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/bricard.h>
#include <orthant/core/scenes/cross_slope.h>
#include <orthant/core/scenes/flyball.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/spatial_slider_crank.h>
#include <orthant/core/scenes/top.h>

#include <cmath>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using Kind = ExactCase::Motion;
using System = SystemOf<Spatial>;

struct Ball {
  Vector3d position, velocity, omega;
  ContactLaw law;
  double g = 0, radius = 0.1, mass = 2;
};
/// A homogeneous ball over the floor z = 0.
spatial::Scene ball_on_floor(const Ball& p) {
  spatial::Scene s;
  s.gravity = {0, 0, -p.g};
  const auto ball = s.body({.name = "ball",
                            .mass = p.mass,
                            .inertia = Vector3d::Constant(0.4 * p.mass * p.radius * p.radius).asDiagonal(),
                            .position = p.position,
                            .velocity = p.velocity,
                            .omega = p.omega});
  s.contact(spatial::SpherePlane{"floor", ball, {0, 0, 0}, p.radius, kGround, {0, 0, 0}, {0, 0, 1}, p.law});
  return s;
}

void free_bodies(std::vector<ExactCase>& all) {
  // R(t) = exp(L/I₁ t) R₀ exp(e₃ ω₃ (1 − I₃/I₁) t): Poinsot's motion of a symmetric body.
  const double across = 1, along = 1.7;
  const Eigen::Matrix3d start = quaternions::matrix_of(quaternions::exponential(Vector3d(0.4, -0.3, 0.9)));
  const Vector3d spin(1.5, -0.5, 2);  // in the body
  const Vector3d L = start * Vector3d(across * spin.x(), across * spin.y(), along * spin.z());
  spatial::Scene s;
  s.body({.name = "body",
          .inertia = start * Vector3d(across, across, along).asDiagonal() * start.transpose(),
          .omega = start * spin});
  all.push_back({.id = "S1",
                 .title = "free symmetric body: Poinsot's motion, 4 s",
                 .measure = "error of its axes at the end",
                 .scene = s,
                 .duration = 4,
                 .h = 0.04,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [=](const System& system, const State& x) {
                   // The frame of the body is that of the world at the start: its rotation is exp(…) R₀ exp(…) R₀ᵀ.
                   const Eigen::Matrix3d turn =
                       Eigen::AngleAxisd(L.norm() / across * x.t, L.normalized()).toRotationMatrix() * start *
                       Eigen::AngleAxisd(spin.z() * (1 - along / across) * x.t, Vector3d::UnitZ()).toRotationMatrix();
                   const Vector3d axis = turn.col(2), marked = turn.col(0);
                   const auto k = poses(system, x);
                   return (k.at(0).turn(start.col(2)) - axis).norm() + (k.at(0).turn(start.col(0)) - marked).norm();
                 }});
  spatial::Scene jet;
  const auto rocket = jet.body({.name = "rocket", .mass = 2, .omega = {0, 0, 3}});
  jet.load({.name = "jet", .body = rocket, .force = {4, 0, 0}, .frame = spatial::Frame::body});
  all.push_back({.id = "S2",
                 .title = "rocket that turns evenly, its thrust with it",
                 .measure = "position error at the end [m]",
                 .scene = jet,
                 .duration = 1,
                 .h = 0.02,
                 .motion = Kind::smooth,
                 .energy = Energy::driven,
                 .error_in_space = [](const System&, const State& x) {
                   const double a = 2, w = 3, t = x.t;
                   return (place(x) - a / (w * w) * Vector3d(1 - std::cos(w * t), w * t - std::sin(w * t), 0)).norm();
                 }});
  all.push_back({.id = "S3",
                 .title = "Lagrange's top: precession in one nutation with cusps",
                 .measure = "precession error [rad]",
                 .scene = top(),
                 .duration = 0.10996771481,
                 .h = 4e-4,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [](const System&, const State& x) {
                   const Vector3d axis = quaternions::matrix_of(quaternion(x.q, 0)).col(2);
                   return apart(std::atan2(axis.y(), axis.x()), 0.18417249693);
                 }});
}

void linkages(std::vector<ExactCase>& all) {
  all.push_back(
      {.id = "S4",
       .title = "spatial slider-crank of the IFToMM library, 5 s",
       .measure = "slider's position error at the end [m]",
       .scene = spatial_slider_crank(),
       .duration = 5,
       .h = 1e-3,
       .motion = Kind::smooth,
       .energy = Energy::conserved,
       .error_in_space = [](const System&, const State& x) { return std::abs(place(x, 2).x() - 0.24071957373); }});
  all.push_back({.id = "S5",
                 .title = "Bricard's linkage (A04): a redundant row in every pose, 10 s",
                 .measure = "corner's position error at the end [m]",
                 .scene = bricard(),
                 .duration = 10,
                 .h = 8e-3,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [](const System&, const State& x) {
                   const Vector3d corner =
                       place(x, 2) + quaternions::matrix_of(quaternion(x.q, 2)) * Vector3d(0, 0, 0.5);
                   return (corner - Vector3d(0.9999999638, -1.0002690127, 0.9997309511)).norm();
                 }});
  all.push_back({.id = "S6",
                 .title = "Bennett's linkage: three rows more than rank, 5 s",
                 .measure = "angle error at the end [rad]",
                 .scene = bennett(),
                 .duration = 5,
                 .h = 4e-3,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved,
                 .error_in_space = [](const System& system, const State& x) {
                   return apart(angle(system, x, 0), 3.01649731398);
                 }});
  all.push_back({.id = "S7",
                 .title = "flyball governor on stiff springs (A05), 10 s",
                 .measure = "error of its turning rate at the end [rad/s]",
                 .scene = flyball(),
                 .duration = 10,
                 .h = 4e-3,
                 .motion = Kind::smooth,
                 .energy = Energy::driven,
                 .error_in_space = [](const System&, const State& x) { return std::abs(x.v[5] - 5.548203622655); }});
}

void colliding_balls(std::vector<ExactCase>& all) {
  const BouncingBall plastic{.e = 0.5};
  const double radius = 0.1;
  all.push_back({.id = "S8",
                 .title = "bouncing ball, e = 1/2, past the accumulation of its impacts",
                 .measure = "height error at the end [m]",
                 .scene = ball_on_floor({.position = {0, 0, plastic.at(0).x + radius},
                                         .velocity = {0, 0, 0},
                                         .omega = {0, 0, 0},
                                         .law = {.e = 0.5},
                                         .g = kGravity}),
                 .duration = 2,
                 .h = 1e-2,
                 .error_in_space = [=](const System&, const State& x) {
                   return std::abs(place(x).z() - radius - plastic.at(x.t).x);
                 }});
  // J = 2/5 m R²: u⁺ = −e_t u⁻ of a slip u = v + ω × r takes the tangential impulse −(1 + e_t) 2/7 m u⁻, if it sticks.
  const Vector3d v(0.4, -0.3, -3), omega(3, 2, 5), r(0, 0, -radius);
  Vector3d slip = v + omega.cross(r);
  slip.z() = 0;
  const Vector3d after = Vector3d(v.x(), v.y(), 3) - 4.0 / 7 * slip;
  all.push_back(
      {.id = "S9",
       .title = "superball, e = e_t = 1: it returns its slip",
       .measure = "velocity error after the impact [m/s]",
       .scene = ball_on_floor(
           {.position = {0, 0, radius + 0.05}, .velocity = v, .omega = omega, .law = {.mu = 10, .e = 1, .e_t = 1}}),
       .duration = 0.1,
       .h = 1e-2,
       .energy = Energy::conserved,
       .error_in_space = [=](const System&, const State& x) { return (velocity(x) - after).norm(); }});
  const double mu = 0.06, cut = kPi / 6, R = 0.03;
  const Vector3d line(1, 0, 0), way(std::cos(cut), std::sin(cut), 0);
  const double gap = 0.01;
  spatial::Scene s;
  const Eigen::Matrix3d J = Vector3d::Constant(0.4 * R * R).asDiagonal();
  s.body({.name = "cue", .inertia = J, .position = -2 * R * line - gap * way, .velocity = way});
  s.body({.name = "object", .inertia = J});
  s.contact(spatial::SphereSphere{"touch", 0, {0, 0, 0}, R, 1, {0, 0, 0}, R, {.mu = mu, .e = 1}});
  all.push_back({.id = "S10",
                 .title = "throw of a cue ball at 30°, slipping",
                 .measure = "velocity error of the object ball [m/s]",
                 .scene = s,
                 .duration = 0.015,
                 .h = 1e-3,
                 .error_in_space = [=](const System&, const State& x) {
                   return (velocity(x, 1) - Vector3d(std::cos(cut), mu * std::cos(cut), 0)).norm();
                 }});
}

void sliding(std::vector<ExactCase>& all) {
  const Masse shot;
  const Vector3d n(0, 0, 1), v(shot.vx, shot.vy, 0), omega(shot.wx, shot.wy, shot.wz);
  const Vector3d slip = v - shot.radius * omega.cross(n);
  const double brake = shot.mu * shot.g, rolls = 2 * slip.norm() / (7 * brake);
  const Vector3d slowing = -brake * slip.normalized(), rolling = v + rolls * slowing;
  const auto at = [=](double t) {
    const double sliding = std::min(t, rolls);
    return Vector3d(shot.radius * n + sliding * v + sliding * sliding / 2 * slowing + (t - sliding) * rolling);
  };
  all.push_back({.id = "S11",
                 .title = "massé shot: slides on a parabola with oblique spin, then rolls",
                 .measure = "position error at the end [m]",
                 .scene = masse(shot),
                 .duration = 1,
                 .h = 4e-3,
                 .error_in_space = [=](const System&, const State& x) { return (place(x) - at(x.t)).norm(); }});
  const CrossSlope slope;
  const SlopeStop stop = *stop_on_slope(slope);
  const auto block = [&](const std::string& id, const std::string& title, const Vector3d& stops) {
    all.push_back({.id = id,
                   .title = title,
                   .measure = "error of the place where it stops [m]",
                   .scene = cross_slope(slope),
                   .duration = 0.5,
                   .h = 1e-2,
                   .error_in_space = [=](const System&, const State& x) { return (place(x) - stops).norm(); }});
  };
  block("S12", "block sent across a slope: a disc bends its path until it stops", stop.place);
  for (const int sides : {4, 8, 16}) {
    const std::string facets = std::to_string(sides);
    block("S12", "the same with a pyramid of " + facets + " facets, by the pyramid's own path",
          stop_on_slope(slope, sides)->place);
    all.back().solvers = {"lemke:facets=" + facets, "path:facets=" + facets, "newton-fb:facets=" + facets};
    all.back().pyramids = true;
  }
  // The centre's velocity turns at 2/7 Ω about n.
  const double Omega = 3.5, R = 0.1, w = 2.0 / 7 * Omega;
  const Vector3d centre(0.2, -0.1, 0), start(0.3, 0.1, 0), surface = Omega * n.cross(-centre);
  all.push_back({.id = "S13",
                 .title = "ball on a turntable: rolls on a circle, two sevenths as fast",
                 .measure = "position error at the end [m]",
                 .scene = ball_on_floor({.position = {0, 0, R},
                                         .velocity = start,
                                         .omega = n.cross(start - surface) / R,
                                         .law = {.mu = 1, .surface = {.omega = Omega * n, .centre = centre}},
                                         .g = 9.81}),
                 .duration = 2,
                 .h = 2e-2,
                 .motion = Kind::events,
                 .energy = Energy::driven,
                 .error_in_space = [=](const System&, const State& x) {
                   const Vector3d u = start.cross(n) / w;
                   return (place(x) - R * n - (Eigen::AngleAxisd(w * x.t, n) * u - u)).norm();
                 }});
}

void plane_in_space(std::vector<ExactCase>& all) {
  const SliderCrankExact exact = *slider_crank_exact(0.01, 0.4);
  SliderCrankSpace p;
  p.mu = 0.01, p.e = 0.4, p.turn_x = 0.4, p.turn_y = -1.1, p.turn_z = 0.7;
  all.push_back({.id = "S14",
                 .title = "planar slider-crank with clearance built in space and turned, e = 0.4",
                 .measure = "crank angle error at 0.2 s [rad]",
                 .scene = slider_crank_space(p),
                 .duration = 0.2,
                 .h = 2e-4,
                 .error_in_space = [exact](const System& system, const State& x) {
                   return apart(angle(system, x, 0), exact.theta1);
                 }});
}

}  // namespace

std::vector<ExactCase> exact_cases_in_space() {
  std::vector<ExactCase> all;
  free_bodies(all);
  linkages(all);
  colliding_balls(all);
  sliding(all);
  plane_in_space(all);
  spinning_cases(all);
  rolling_cases_in_space(all);
  wall_cases(all);
  rod_cases(all);
  return all;
}

}  // namespace orthant
