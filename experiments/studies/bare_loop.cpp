// How far is a step of Orthant from a loop written by hand for one mechanism?
//
// The slider-crank of slider_crank.h in minimal coordinates (θ₁, θ₂, θ₃), Moreau-Jean's midpoint step, a face's corners
// together and friction by projected sweeps: nothing that could be left out, nothing that is checked, nothing that
// could be another mechanism. Beside it Orthant, which keeps all nine coordinates, the joints and a verdict on each
// problem. Both are timed by turns; the least counts. Equations of motion: Flores, Leine & Glocker, Multibody Syst.
// Dyn. 23 (2010) 165-190.
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>

using namespace orthant;

namespace {

using Three = std::array<double, 3>;
struct Motion {
  Three q{}, v{};
};

double dot(const Three& x, const Three& y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }

class Bare {
 public:
  explicit Bare(const SliderCrank& p) : p_(p) {}

  Motion run(double h, long steps) const {
    Motion s{{0, 0, p_.theta3}, {p_.omega1, p_.omega2, p_.omega3}};
    for (long k = 0; k < steps; ++k) step(h, s);
    return s;
  }

 private:
  struct Touch {
    Three normal, tangent, from_normal, from_tangent;  // rows of the Jacobian, and what an impulse on each does to v
    double e_gap, ratio_n, ratio_t, impulse = 0, friction = 0;
  };

  void step(double h, Motion& s) const {
    auto& [q, v] = s;
    for (std::size_t i = 0; i < 3; ++i) q[i] += h / 2 * v[i];
    const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]),
                 s3 = std::sin(q[2]), c3 = std::cos(q[2]);
    const double l1 = p_.l1, l2 = p_.l2, K = l1 * l2 * (p_.m2 / 2 + p_.m3);
    const double m11 = p_.J1 + l1 * l1 * (p_.m1 / 4 + p_.m2 + p_.m3), m22 = p_.J2 + l2 * l2 * (p_.m2 / 4 + p_.m3),
                 m12 = K * (c1 * c2 + s1 * s2), det = m11 * m22 - m12 * m12;
    const auto solve = [&](const Three& f) {
      return Three{(m22 * f[0] - m12 * f[1]) / det, (m11 * f[1] - m12 * f[0]) / det, f[2] / p_.J3};
    };
    const double k = K * (s1 * c2 - c1 * s2);
    const Three change = solve({h * (-k * v[1] * v[1] - (p_.m1 / 2 + p_.m2 + p_.m3) * p_.g * l1 * c1),
                                h * (k * v[0] * v[0] - (p_.m2 / 2 + p_.m3) * p_.g * l2 * c2), 0});
    const Three before = v;
    for (std::size_t i = 0; i < 3; ++i) v[i] += change[i];

    const double y = l1 * s1 + l2 * s2, opening = p_.b + p_.clearance;
    std::array<Touch, 4> touch;
    std::size_t touches = 0;
    for (const double wall : {1.0, -1.0})
      for (const double end : {-p_.a, p_.a}) {
        const double dx = end * c3 - wall * p_.b * s3, dy = end * s3 + wall * p_.b * c3;
        if (opening - wall * (y + dy) > 0) continue;
        Touch& t = touch[touches++];
        t = {};
        t.normal = {-wall * l1 * c1, -wall * l2 * c2, -wall * dx};
        t.tangent = {-l1 * s1, -l2 * s2, -dy};
        t.from_normal = solve(t.normal), t.from_tangent = solve(t.tangent);
        t.e_gap = p_.e * dot(t.normal, before);
        t.ratio_n = 1 / dot(t.normal, t.from_normal), t.ratio_t = 1 / dot(t.tangent, t.from_tangent);
      }
    const auto add = [&v](const Three& direction, double impulse) {
      for (std::size_t i = 0; i < 3; ++i) v[i] += impulse * direction[i];
    };
    const auto gap = [&v](const Touch& t) { return dot(t.normal, v) + t.e_gap; };
    const auto push = [&](Touch& t, double impulse) {
      add(t.from_normal, impulse - t.impulse);
      t.impulse = impulse;
    };
    double moved = touches > 0 ? 1 : 0;
    for (int sweep = 0; sweep < 10000 && moved > 1e-13; ++sweep) {
      moved = 0;
      if (touches == 2) {  // a face: its two corners at once, which decide over each other
        Touch &left = touch[0], &right = touch[1];
        const double g00 = 1 / left.ratio_n, g11 = 1 / right.ratio_n, g01 = dot(left.normal, right.from_normal);
        const double q0 = gap(left) - g00 * left.impulse - g01 * right.impulse,
                     q1 = gap(right) - g01 * left.impulse - g11 * right.impulse;
        const double both = g00 * g11 - g01 * g01, p0 = (g01 * q1 - g11 * q0) / both, p1 = (g01 * q0 - g00 * q1) / both;
        const double alone0 = std::max(-q0 / g00, 0.0), alone1 = std::max(-q1 / g11, 0.0);
        const bool first = q1 + g01 * alone0 >= 0;
        const double n0 = p0 >= 0 && p1 >= 0 ? p0
                          : first            ? alone0
                                             : 0,
                     n1 = p0 >= 0 && p1 >= 0 ? p1
                          : first            ? 0
                                             : alone1;
        moved = std::max(std::abs(n0 - left.impulse), std::abs(n1 - right.impulse));
        push(left, n0), push(right, n1);
      }
      for (std::size_t c = 0; c < touches; ++c) {
        Touch& t = touch[c];
        if (touches != 2) {
          const double impulse = std::max(t.impulse - t.ratio_n * gap(t), 0.0);
          moved = std::max(moved, std::abs(impulse - t.impulse));
          push(t, impulse);
        }
        const double most = p_.mu * t.impulse,
                     friction = std::clamp(t.friction - t.ratio_t * dot(t.tangent, v), -most, most);
        add(t.from_tangent, friction - t.friction);
        moved = std::max(moved, std::abs(friction - t.friction));
        t.friction = friction;
      }
    }
    for (std::size_t i = 0; i < 3; ++i) q[i] += h / 2 * v[i];
  }

  SliderCrank p_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("A step of the slider-crank by Orthant, compared with a loop written by hand for this scene");
  double h = 1e-5;
  int repeats = 9;
  std::vector<double> frictions{0, 0.01, 0.1}, restitutions{0, 0.4};
  app.add_option("--step", h, "[s]")->capture_default_str()->check(between(1e-9, 1e-2));
  app.add_option("--repeats", repeats, "runs of each; the fastest counts")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--friction", frictions, "values of mu")->capture_default_str()->check(between(0, 1e6));
  app.add_option("--restitution", restitutions, "values of e")->capture_default_str()->check(between(0, 1));
  if (const auto end = parse(app, argc, argv)) return *end;

  const double duration = 0.2;
  const long steps = std::lround(duration / h);
  std::cout << "| mu | e | by hand, µs a step | Orthant, µs a step | times | theta_1(0.2 s) by hand | Orthant |\n"
            << "|---|---|---|---|---|---|---|\n";
  for (const double mu : frictions)
    for (const double e : restitutions) {
      const SliderCrank parameters{.mu = mu, .e = e};
      const Bare bare(parameters);
      const System system(slider_crank(parameters));
      const auto scheme = make_integrator("moreau-jean", system);
      const auto solver = make_solver("auto");
      double by_hand = kInf, ours = kInf;
      Motion end;
      Run run;
      for (int k = 0; k < repeats; ++k) {
        double begin = thread_time();
        end = bare.run(h, steps);
        by_hand = std::min(by_hand, thread_time() - begin);
        begin = thread_time();
        run = simulate(*scheme, *solver, {.step = h, .duration = duration, .every = 1 << 30});
        ours = std::min(ours, thread_time() - begin);
        if (run.status != Status::solved) {
          std::cerr << "mu = " << mu << ", e = " << e << ": " << name(run.status) << ": " << scheme->why() << '\n';
          return 1;
        }
      }
      const double each = 1e6 / static_cast<double>(steps);
      std::cout << "| " << mu << " | " << e << " | " << std::fixed << std::setprecision(3) << by_hand * each << " | "
                << ours * each << " | " << std::setprecision(1) << ours / by_hand << " | " << std::setprecision(4)
                << end.q[0] << " | " << run.final.q[2] << " |\n"
                << std::defaultfloat << std::setprecision(6);
    }
}
