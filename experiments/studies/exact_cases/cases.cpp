#include "experiments/studies/exact_cases/exact_case.h"
#include "experiments/studies/support/equivalent_scene.h"

#include <orthant/core/scenes/arch.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/painleve_rod.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/rocking_block.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/roll.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/stick_slip.h>
#include <orthant/core/scenes/superball.h>
#include <orthant/core/scenes/table.h>
#include <orthant/core/scenes/tower.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace orthant {
namespace {

using Energy = ExactCase::Energy;
using Kind = ExactCase::Motion;

constexpr Index kX = 0, kY = 1, kTheta = 2;  // of body 0

/// |q_k − x*(t)| of a scene whose exact motion is at(t).
template <class Scenario> auto along(const Scenario& p, Index k) {
  return [p, k](const RunSample& m) { return std::abs(m.state.q[k] - p.at(m.state.t).x); };
}

void balls(std::vector<ExactCase>& all) {
  const BouncingBall plastic{.e = 0.5}, elastic{.e = 1};
  all.push_back({.id = "B1",
                 .title = "bouncing ball, e = 1/2, past the accumulation of its impacts",
                 .measure = "largest height error [m]",
                 .scene = bouncing_ball(plastic),
                 .duration = 2,
                 .h = 1e-2,
                 .error = along(plastic, kY),
                 .throughout = true});
  all.push_back({.id = "B2",
                 .title = "elastic ball, seven impacts",
                 .measure = "largest height error [m]",
                 .scene = bouncing_ball(elastic),
                 .duration = 6,
                 .h = 1e-2,
                 .error = along(elastic, kY),
                 .throughout = true,
                 .energy = Energy::conserved});
}

void friction(std::vector<ExactCase>& all) {
  const double critical = std::tan(std::numbers::pi / 6);
  const Incline up{.mu = 0.5, .speed = 2}, holds{.mu = critical + 1e-6, .speed = 0},
      slides{.mu = critical - 1e-6, .speed = 0};
  all.push_back({.id = "B3",
                 .title = "block sent up a slope: stops, slides back",
                 .measure = "largest position error [m]",
                 .scene = incline(up),
                 .duration = 1,
                 .h = 1e-2,
                 .error = along(up, kX),
                 .throughout = true});
  all.push_back({.id = "B3",
                 .title = "block just held by friction: no creep",
                 .measure = "largest speed [m/s]",
                 .scene = incline(holds),
                 .duration = 1,
                 .h = 1e-2,
                 .error = [](const RunSample& m) { return std::abs(m.state.v[kX]); },
                 .throughout = true,
                 .exact = 1e-12});
  all.push_back({.id = "B3",
                 .title = "block just not held by friction",
                 .measure = "speed error at 1 s [m/s]",
                 .scene = incline(slides),
                 .duration = 1,
                 .h = 1e-2,
                 .error = [slides](const RunSample& m) { return std::abs(m.state.v[kX] - slides.at(m.state.t).v); },
                 .exact = 1e-12});
  const StickSlip belt;
  const CoulombDecay decay;
  all.push_back({.id = "B4",
                 .title = "stick-slip on a belt, two periods",
                 .measure = "largest position error [m]",
                 .scene = stick_slip(belt),
                 .duration = 18,
                 .h = 2e-2,
                 .error = along(belt, kX),
                 .throughout = true,
                 .energy = Energy::driven});
  all.push_back({.id = "B4",
                 .title = "swings that friction ends: the place where it stops for ever",
                 .measure = "position error + speed at the end [m, m/s]",
                 .scene = coulomb_decay(decay),
                 .duration = 25,
                 .h = 2e-2,
                 .error = [](const RunSample& m) { return std::abs(m.state.q[kX] + 0.2) + std::abs(m.state.v[kX]); }});
}

void rolling(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const Roll& p) {
    all.push_back({.id = "B5",
                   .title = title,
                   .measure = "largest position error [m]",
                   .scene = roll(p),
                   .duration = 1.5,
                   .h = 1e-2,
                   .error = along(p, kX),
                   .throughout = true});
  };
  const double slope = std::numbers::pi / 6;
  add("sphere slides, then rolls", {});
  add("sphere rolls down 30 degrees, friction just enough", {.mu = 0.165, .speed = 0, .slope = slope});
  add("sphere slides down 30 degrees", {.mu = 0.1, .speed = 0, .slope = slope});
}

void painleve(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const char* word, double omega) {
    all.push_back({.id = "B6",
                   .title = title,
                   .measure = "steps that could not be solved",
                   .scene = painleve_rod({.omega = omega}),
                   .duration = 1e-3,
                   .h = 1e-4,
                   .error = [](const RunSample&) { return 0.0; },
                   .motion = Kind::instant,
                   .word = word});
  };
  add("Painleve's rod, no consistent acceleration: named, and velocity-level steps go on", "none", 0);
  add("Painleve's rod, two consistent accelerations: named, and velocity-level steps go on", "several", 4);
}

void rocking(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* title, const RockingBlock& p, double duration, double h) {
    all.push_back({.id = "B7",
                   .title = title,
                   .measure = "largest angle error [rad]",
                   .scene = rocking_block(p),
                   .duration = duration,
                   .h = h,
                   .error = along(p, kTheta),
                   .throughout = true});
  };
  add("rocking block, four impacts", {}, 1.7, 4e-3);
  const RockingBlock stops{.half_height = 0.07}, lifts{.half_height = 0.072};
  add("block of h/b = 0.70 stops dead", stops, 2 * stops.impact_time(1), stops.impact_time(1) / 50);
  add("block of h/b = 0.72 lifts its other corner", lifts, 1.5 * lifts.impact_time(1), lifts.impact_time(1) / 100);
}

/// Velocities after impacts, against the law's.
ExactCase impact(std::string id, std::string title, Scene scene, std::vector<std::pair<Index, double>> after) {
  const double duration = scene.duration, step = scene.step;
  return {.id = std::move(id),
          .title = std::move(title),
          .measure = "largest error of the velocities afterwards [m/s, rad/s]",
          .scene = std::move(scene),
          .duration = duration,
          .h = step,
          .error =
              [after = std::move(after)](const RunSample& m) {
                double worst = 0;
                for (const auto& [k, v] : after) worst = std::max(worst, std::abs(m.state.v[k] - v));
                return worst;
              },
          .motion = Kind::instant,
          .exact = 1e-8};
}

std::vector<std::pair<Index, double>> along_x(const std::vector<double>& after) {
  std::vector<std::pair<Index, double>> all;
  for (const double v : after) all.emplace_back(3 * static_cast<Index>(all.size()), v);
  return all;
}

void impacts(std::vector<ExactCase>& all) {
  for (const double ratio : {3.0, 1e6}) {
    const SuperBall p{.ratio = ratio};
    all.push_back(impact("B8", "super-ball, mass ratio " + std::string(ratio > 3 ? "1e6" : "3"), superball(p),
                         {{1, p.after().lower}, {4, p.after().upper}}));
  }
  const Cradle three, half{.e = 0.5}, four{.balls = 4}, in_turn{.balls = 5, .gap = 1e-3};
  all.push_back(impact("B9", "cradle of 3, e = 1, at once", cradle(three), along_x(three.after())));
  all.push_back(impact("B9", "cradle of 3, e = 1/2, at once", cradle(half), along_x(half.after())));
  all.push_back(impact("B9", "cradle of 4, e = 1, at once", cradle(four), along_x(four.after())));
  all.push_back(impact("B9", "cradle of 5, e = 1, gaps", cradle(in_turn), along_x(in_turn.after())));
}

void slanting_impacts(std::vector<ExactCase>& all) {
  for (const double mu : {0.5, 0.1}) {
    const SphereBounce p{.mu = mu};
    const auto v = p.after();
    all.push_back(impact("B17", "sphere strikes a rough floor, " + std::string(mu > 0.3 ? "sticks" : "slides"),
                         sphere_bounce(p), {{0, v.vx}, {1, v.vy}, {2, v.omega}}));
  }
  const RodDrop p;
  all.push_back(
      impact("B18", "slanting rod strikes a smooth floor", rod_drop(p), {{1, p.after().vy}, {2, p.after().omega}}));
  all.back().exact = 1e-3;  // within a step the rod goes down by up to 1 mm before or after it strikes
}

/// Mean contact forces since the start.
class Forces {
 public:
  std::span<const double> operator()(const RunSample& m) {
    impulses_.resize(m.impulses.size()), forces_.resize(m.impulses.size());
    for (std::size_t i = 0; i < impulses_.size(); ++i) {
      impulses_[i] += m.impulses[i].normal;
      forces_[i] = m.state.t > 0 ? impulses_[i] / m.state.t : 0;
    }
    return forces_;
  }

 private:
  std::vector<double> impulses_, forces_;
};

void at_rest(std::vector<ExactCase>& all) {
  const Table legs;
  all.push_back({.id = "B11",
                 .title = "table on four legs, weight off the middle: any true answer",
                 .measure = "misfit of the legs' forces [N, N m]",
                 .scene = table(legs),
                 .duration = 0.125,
                 .h = 0x1p-7,
                 .error =
                     [legs, forces = Forces()](const RunSample& m) mutable {
                       const auto f = forces(m);
                       return m.state.t > 0 ? legs.misfit(f) : 0;
                     },
                 .motion = Kind::instant});
  for (const Tower& p : {Tower{}, Tower{.blocks = 8, .ratio = 10}, Tower{.blocks = 8, .ratio = 0.1},
                         Tower{.blocks = 8, .ratio = 10, .corners = 2}})
    all.push_back({.id = "B12",
                   .title = "tower of " + std::to_string(p.blocks) + ", masses by " +
                            (p.ratio > 1e3 ? "1e6"
                             : p.ratio > 1 ? "10"
                                           : "1/10") +
                            (p.corners == 2 ? ", two corners" : ""),
                   .measure = "largest relative error of a level's force",
                   .scene = tower(p),
                   .duration = 0.125,
                   .h = 0x1p-7,
                   .error =
                       [p, forces = Forces()](const RunSample& m) mutable {
                         const auto f = forces(m);
                         double worst = 0;
                         for (int k = 1; k <= p.blocks && m.state.t > 0; ++k) {
                           double sum = 0;
                           for (int c = 0; c < p.corners; ++c)
                             sum += f[static_cast<std::size_t>(p.corners * (k - 1) + c)];
                           worst = std::max(worst, std::abs(sum / p.force(k) - 1));
                         }
                         return worst;
                       },
                   .motion = Kind::instant});
  for (const double ratio : {1.0, 10.0, 100.0, 1e4, 1e6}) {
    const double sweeps = std::log(1e-8) / std::log(ratio / (1 + ratio));
    all.push_back({.id = "B12",
                   .title = "sweeps of projected Gauss-Seidel, masses by " + std::to_string(static_cast<int>(ratio)),
                   .measure = "their number against the contraction's, relative",
                   .scene = tower({.ratio = ratio}),
                   .duration = 0x1p-7,
                   .h = 0x1p-7,
                   .error =
                       [sweeps](const RunSample& m) {
                         return m.state.t > 0 ? std::abs(m.report.lcp_iterations / sweeps - 1) : 0;
                       },
                   .motion = Kind::instant,
                   .exact = 0.1,
                   .solvers = {"pgs:tolerance=1e-8,max_sweeps=100000000"},
                   .integrator = "moreau-jean"});
  }
  for (const int grains : {10, 100}) {
    const GrainColumn p{.grains = grains};
    all.push_back({.id = "B20",
                   .title = "column of " + std::to_string(grains) + " grains stops at once",
                   .measure = "largest relative error of a level's impulse",
                   .scene = grain_column(p),
                   .duration = 0.125,
                   .h = 0x1p-7,
                   .error =
                       [p, sum = std::vector<double>(static_cast<std::size_t>(grains))](const RunSample& m) mutable {
                         double worst = 0;
                         for (int k = 1; k <= p.grains; ++k) {
                           double& impulse = sum[static_cast<std::size_t>(k - 1)];
                           impulse += m.impulses[static_cast<std::size_t>(k - 1)].normal;
                           if (m.state.t > 0) worst = std::max(worst, std::abs(impulse / p.impulse(k, m.state.t) - 1));
                         }
                         return worst;
                       },
                   .motion = Kind::instant});
  }
}

void arches(std::vector<ExactCase>& all) {
  for (const bool stands : {true, false}) {
    Arch p;
    p.thickness = (stands ? 1.02 : 0.98) * p.least_thickness();
    all.push_back(
        {.id = "B13",
         .title = stands ? "arch 2 % thicker than the least: stands" : "arch 2 % thinner than the least: falls",
         .measure = stands ? "largest speed [m/s]" : "0 when it moves faster than 1e-3 m/s, else 1",
         .scene = arch(p),
         .duration = 0.02,
         .h = 1e-3,
         .error =
             [stands](const RunSample& m) {
               const double speed = m.state.v.lpNorm<Eigen::Infinity>();
               return stands ? speed : speed > 1e-3 ? 0 : 1;
             },
         .motion = Kind::instant});
  }
}

/// From 2 % below to 2 % above the least thickness.
void thinnest_arch(std::vector<ExactCase>& all) {
  const double least = Arch{}.least_thickness();
  all.push_back({.id = "B13",
                 .title = "least thickness at which the arch stands, by bisection",
                 .measure = "relative distance of the bracket from the exact one",
                 .scene = arch(),
                 .duration = 0.01,
                 .h = 1e-3,
                 .error = [](const RunSample& m) { return m.state.v.lpNorm<Eigen::Infinity>() > 1e-5 ? 1 : 0; },
                 .throughout = true,
                 .motion = Kind::instant,
                 .exact = 1e-3,
                 .family = [](double t) { return arch({.thickness = t}); },
                 .low = 0.98 * least,
                 .high = 1.02 * least,
                 .threshold = least,
                 .solvers = {"auto", "newton-fb"}});
}

/// Equivalent formulations move alike: the slider-crank's first 20 ms, crank angle; and more friction holds more.
void told_otherwise(std::vector<ExactCase>& all) {
  const auto add = [&all](const char* id, const char* title, const Scene& original, const Scene& told, auto unlike) {
    all.push_back({.id = id,
                   .title = title,
                   .measure = "difference of the crank angles [rad]",
                   .scene = told,
                   .duration = 0.02,
                   .h = 1e-4,
                   .error = nullptr,
                   .motion = Kind::instant,
                   .energy = Energy::driven,
                   .exact = 1e-10,
                   .original = original,
                   .unlike = unlike});
  };
  const auto apart = [](Index k, double sign, double angle) {
    return [=](const State& a, const State& b) { return std::abs(sign * (a.q[k] - angle) - b.q[kTheta]); };
  };
  const Scene drawn = slider_crank({.mu = 0.1});
  add("C4", "slider-crank, its elements in the opposite order", drawn, reversed(drawn), apart(8, 1, 0));
  add("C4", "slider-crank mirrored", drawn, mirrored(drawn), apart(kTheta, -1, 0));
  add("C4", "slider-crank turned with gravity", drawn, moved(drawn, 0.7, {0, 0}), apart(kTheta, 1, 0.7));
  add("C4", "slider-crank elsewhere", drawn, moved(drawn, 0, {3, -2}), apart(kTheta, 1, 0));
  add("C4", "slider-crank 1000 km away", drawn, moved(drawn, 0, {1e6, 1e6}), apart(kTheta, 1, 0));
  all.back().exact = 1e-2;  // coordinates of 1e6 m are known to 1e-10 m, the guide's clearance is 1 mm
  add("C4", "slider-crank in other units", drawn, in_units(drawn, 1024, 0.25), apart(kTheta, 1, 0));
  add("C4", "slider-crank under other names", drawn, renamed(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, a joint and a contact written twice", drawn, doubled(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, a far body and walls never reached", drawn, furnished(drawn), apart(kTheta, 1, 0));
  add("C7", "slider-crank, no friction written as friction", slider_crank({.mu = 0}), slider_crank({.mu = 1e-14}),
      apart(kTheta, 1, 0));
  const Incline less{.mu = 0.5, .speed = 2}, more{.mu = 0.6, .speed = 2};
  add("C5", "block sent up a slope: more friction, no farther", incline(less), incline(more),
      [](const State& a, const State& b) { return std::max(0.0, a.q[kX] - b.q[kX]); });
  all.back().measure = "how much farther [m]", all.back().duration = 0.25, all.back().h = 1e-3;
  // A pendulum's angle in minimal coordinates, from elliptic functions, against two coordinates and a joint.
  const Pendulum swing;
  all.push_back({.id = "C7",
                 .title = "pendulum: a body and a pin against one angle (B14, B15: chains, loops)",
                 .measure = "largest angle error in 1 s [rad]",
                 .scene = pendulum(swing),
                 .duration = 1,
                 .h = 1e-2,
                 .error =
                     [swing](const RunSample& m) {
                       const double angle = std::atan2(m.state.q[kX], -m.state.q[kY]);
                       return std::abs(std::remainder(angle - swing.at(m.state.t).x, 2 * std::numbers::pi));
                     },
                 .throughout = true,
                 .motion = Kind::smooth,
                 .energy = Energy::conserved});
}

/// A table that drops aslant on more legs than its three coordinates tell apart, without friction: W is symmetric,
/// positive semidefinite and singular, forces are not unique, velocities are.
void across_solvers(std::vector<ExactCase>& all) {
  Scene s = table();
  s.bodies[0].velocity = {0, -1}, s.bodies[0].omega = 0.5;
  for (Contact& contact : s.contacts) std::get<CornerWall>(contact).law.e = 0.5;
  all.push_back({.id = "C6",
                 .title = "table dropped on its four legs: every solver's velocities are Lemke's",
                 .measure = "largest difference of the velocities at 1/2 s [m/s, rad/s]",
                 .scene = s,
                 .duration = 0.5,
                 .h = 0x1p-7,
                 .error = nullptr,
                 .motion = Kind::instant,
                 .exact = 1e-8,
                 .original = s,
                 .rival = "lemke",
                 .unlike = [](const State& a, const State& b) { return (a.v - b.v).lpNorm<Eigen::Infinity>(); }});
}

/// Discs in a triangle, one struck by a fourth: momentum and energy of one impact.
void impact_laws(std::vector<ExactCase>& all) {
  constexpr double e = 0.5, radius = 0.5;
  Scene s;
  const double up = std::numbers::sqrt3 / 2;
  for (const Vector2d& at : {Vector2d(0, 0), Vector2d(up, 0.5), Vector2d(up, -0.5), Vector2d(-1, 0)})
    s.body({.mass = at.y() > 0 ? 2.0 : 1.0, .inertia = 0.1, .position = at, .velocity = {at.x() < 0 ? 1.0 : 0.0, 0}});
  for (const auto& [a, b] : {std::pair{3, 0}, std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
    s.contact(DiscDisc{"", a, {0, 0}, radius, b, {0, 0}, radius, {.e = e}});
  const System system(s);
  const State before = system.initial_state();
  all.push_back({.id = "C3",
                 .title = "four discs collide, one e: momentum kept, energy lost by the law",
                 .measure = "momentum lost [N s] + misfit of the energy lost [J]",
                 .scene = s,
                 .duration = 0x1p-16,  // so short that nothing turns
                 .h = 0x1p-17,
                 .error =
                     [mass = system.mass(), v = before.v](const RunSample& m) {
                       if (m.state.t == 0) return 0.0;
                       const Eigen::VectorXd change = m.state.v - v, sum = m.state.v + v;
                       const double lost = -0.5 * mass.cwiseProduct(change).dot(sum);
                       const double law = 0.5 * (1 - e) / (1 + e) * mass.cwiseProduct(change).dot(change);
                       Vector2d momentum{0, 0};
                       for (Index b = 0; b < v.size(); b += 3) momentum += mass[b] * change.segment<2>(b);
                       return momentum.norm() + std::abs(lost - law);
                     },
                 .motion = Kind::instant,
                 .exact = 1e-6});
}

void driven(std::vector<ExactCase>& all) {
  const ImpactOscillator oscillator;
  all.push_back({.id = "B10",
                 .title = "impact oscillator on its periodic motion, ten periods",
                 .measure = "position error at the end [m]",
                 .scene = impact_oscillator(oscillator),
                 .duration = 10.25 * oscillator.period(),
                 .h = oscillator.period() / 200,
                 .error = along(oscillator, kX),
                 .energy = Energy::driven});
}

double error_of(const ChainExact& exact, const State& x) {
  const Vector2d tip{x.q[3 * exact.links - 3], x.q[3 * exact.links - 2]};
  return std::hypot(tip.x() - exact.tip[0], tip.y() - exact.tip[1]);
}

void loops_and_chains(std::vector<ExactCase>& all) {
  const Pendulum swing{};
  all.push_back({.id = "B14",
                 .title = "pendulum from 3 rad, one period",
                 .measure = "angle error at the end [rad]",
                 .scene = pendulum(swing),
                 .duration = swing.period(),
                 .h = swing.period() / 500,
                 .error =
                     [swing](const RunSample& m) {
                       return std::abs(std::atan2(m.state.q[kX], -m.state.q[kY]) - swing.at(m.state.t).x);
                     },
                 .motion = Kind::smooth,
                 .energy = Energy::conserved});
  for (const ChainExact& exact : chain_exact())
    all.push_back({.id = "B14",
                   .title = "chain of " + std::to_string(exact.links) + " links let go from the horizontal",
                   .measure = "distance of the tip at " + std::to_string(static_cast<int>(exact.t)) + " s [m]",
                   .scene = chain({.links = exact.links}),
                   .duration = exact.t,
                   .h = 2e-3,
                   .error = [exact](const RunSample& m) { return error_of(exact, m.state); },
                   .motion = Kind::smooth,
                   .energy = Energy::conserved});
  const NFourBar bars;
  all.push_back(
      {.id = "B15",
       .title = "two parallelograms through their singular poses, 10 s",
       .measure = "crank angle error at the end [rad]",
       .scene = n_four_bar(bars),
       .duration = 10,
       .h = 4e-3,
       .error = [bars](const RunSample& m) { return std::abs(std::abs(m.state.q[kTheta]) - bars.at(m.state.t).x); },
       .motion = Kind::smooth,
       .energy = Energy::conserved});
}

void slider_cranks(std::vector<ExactCase>& all) {
  for (const auto& [mu, e] : {std::pair{0.01, 0.4}, std::pair{0.1, 0.0}}) {
    const SliderCrankExact exact = *slider_crank_exact(mu, e);
    all.push_back({.id = "SC",
                   .title = "slider-crank with clearance, e = " + std::string(e == 0 ? "0" : "0.4"),
                   .measure = "crank angle error at 0.2 s [rad]",
                   .scene = slider_crank({.mu = mu, .e = e}),
                   .duration = 0.2,
                   .h = 2e-4,
                   .error = [exact](const RunSample& m) { return std::abs(m.state.q[kTheta] - exact.theta1); }});
  }
}

}  // namespace

std::vector<ExactCase> exact_cases() {
  std::vector<ExactCase> all;
  balls(all);
  friction(all);
  rolling(all);
  painleve(all);
  rocking(all);
  impacts(all);
  driven(all);
  at_rest(all);
  arches(all);
  thinnest_arch(all);
  impact_laws(all);
  told_otherwise(all);
  across_solvers(all);
  loops_and_chains(all);
  slanting_impacts(all);
  slider_cranks(all);
  const auto number = [](const ExactCase& e) {  // B1 … B20, C3 … C7, the slider-crank
    return e.id[0] == 'S' ? 2000 : (e.id[0] == 'C' ? 1000 : 0) + std::stoi(e.id.substr(1));
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const ExactCase& a, const ExactCase& b) { return number(a) < number(b); });
  return all;
}

}  // namespace orthant
