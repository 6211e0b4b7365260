// Exact cases of single impacts: velocities afterwards, against the law.
#include "experiments/studies/exact_cases/case_groups.h"

#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/superball.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

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
          .motion = ExactCase::Motion::instant,
          .exact = 1e-8};
}

std::vector<std::pair<Index, double>> along_x(const std::vector<double>& after) {
  std::vector<std::pair<Index, double>> all;
  for (const double v : after) all.emplace_back(3 * static_cast<Index>(all.size()), v);
  return all;
}

}  // namespace

void impact_cases(std::vector<ExactCase>& all) {
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

void slanting_impact_cases(std::vector<ExactCase>& all) {
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

/// Discs in a triangle, one struck by a fourth: momentum and energy of one impact.
void impact_law_cases(std::vector<ExactCase>& all) {
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
                 .motion = ExactCase::Motion::instant,
                 .exact = 1e-6});
}

}  // namespace orthant
