// --check claims no more digits than are true: against scenes with exact answers, by every integrator.
#include "experiments/runs/check.h"
#include "tests/support/runs.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/spatial_slider_crank.h>
#include <orthant/core/scenes/stick_slip.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <memory>

using namespace orthant;

namespace {

struct Known {
  std::string name;
  Scene scene;
  double duration = 1, step = 1e-3;
  Index column = 0;  // of the check: x, y, theta, vx, vy, omega of each body
  double exact = 0;
};

std::vector<Known> known() {
  const BouncingBall half, lively{.e = 0.9};
  const ImpactOscillator driven;
  const StickSlip belt;
  const CoulombDecay decay;
  const Incline slope;
  const Pendulum swing;
  const NFourBar bars;
  std::vector<Known> list = {
      {"ball", bouncing_ball(half), 1.1, 1e-3, 1, half.at(1.1).x},
      {"ball's velocity", bouncing_ball(half), 1.1, 1e-3, 4, half.at(1.1).v},
      {"lively ball", bouncing_ball(lively), 4.3, 1e-3, 1, lively.at(4.3).x},
      {"driven", impact_oscillator(driven), 20.3, 1e-2, 0, driven.at(20.3).x},
      {"belt", stick_slip(belt), 16, 1e-2, 0, belt.at(16).x},
      {"decay", coulomb_decay(decay), 10, 1e-2, 0, decay.at(10).x},
      {"incline", incline(slope), 0.3, 1e-3, 0, slope.at(0.3).x},
      {"pendulum", pendulum(swing), 4, 1e-3, 0, std::sin(swing.at(4).x)},
      {"four-bars", n_four_bar(bars), 2, 1e-3, 2, -bars.at(2).x},
  };
  for (const SliderCrankExact& exact : slider_crank_exact())
    list.push_back({"slider-crank", slider_crank({.mu = exact.mu, .e = exact.e}), 0.2, 5e-5, 2, exact.theta1});
  return list;
}

}  // namespace

TEST_CASE("check: no integrator claims more digits than are true") {
  int compared = 0, sharp = 0;
  for (const IntegratorEntry& entry : integrators())
    for (Known k : known()) {
      const std::string integrator(entry.name);
      INFO(integrator, ", ", k.name);
      k.scene.duration = k.duration;
      const System system(k.scene);
      const Clock clock{.step = k.step, .duration = k.duration};
      Run r;
      try {
        const auto scheme = make_integrator(integrator, system);
        r = simulate(*scheme, *make_solver("lemke"), clock);
      } catch (const std::invalid_argument&) {
        continue;
      }
      if (r.status != Status::solved) continue;
      const CheckedRun checked = check_run(system, integrator, "lemke", clock, r);
      INFO(checked.against, " left out: ", checked.left_out);
      const CheckedColumn& c = checked.columns.at(static_cast<std::size_t>(k.column));
      const double off = std::abs(c.value - k.exact);
      INFO(c.name, " = ", c.value, " claims ", c.error, ", is off by ", off);
      CHECK(off <= 1.5 * c.error);
      CHECK(c.digits <= 12);
      CHECK(c.digits <= -std::log10(off / std::abs(k.exact) + 1e-16) + 0.5);
      ++compared;
      sharp += c.error <= 100 * off + 1e-9;
    }
  MESSAGE(compared, " checks, ", sharp, " of them within a factor of 100");
  CHECK(compared > 80);
  CHECK(sharp > compared / 2);
}

TEST_CASE("check in space: no scheme claims more digits than are true") {
  struct KnownInSpace {
    std::string name;
    spatial::Scene scene;
    double duration = 1, step = 1e-3;
    std::string column;
    double exact = 0;
  };
  // Closed forms of masse.h; published digits of the slider-crank (IFToMM) at 5 s, a quadrature of Bennett's linkage.
  const KnownInSpace all[] = {{"massé", masse(), 1, 1e-3, "ball.x", 0.2366174053},
                              {"massé", masse(), 1, 1e-3, "ball.vy", 0.489857142857},
                              {"slider-crank", spatial_slider_crank(), 1, 1e-3, "slider.x", 0.21172166}};
  int sharp = 0, compared = 0;
  for (const char* scheme : {"moreau-jean", "stewart-trinkle", "paoli-schatzman", "generalized-alpha"})
    for (const KnownInSpace& k : all) {
      INFO(scheme, ", ", k.name);
      const SystemOf<Spatial> system(k.scene);
      const Clock clock{.step = k.step, .duration = k.duration};
      const Run r = simulate(*make_integrator(scheme, system), *make_solver("auto"), clock);
      if (r.status != Status::solved) continue;
      const CheckedRun checked = check_run(system, scheme, "auto", clock, r);
      for (const CheckedColumn& c : checked.columns) {
        if (c.name != k.column) continue;
        const double off = std::abs(c.value - k.exact);
        INFO(c.name, " = ", c.value, " claims ", c.error, ", is off by ", off);
        CHECK(off <= 1.5 * c.error + 1e-8);  // the digits of the exact value
        ++compared, sharp += c.error <= 100 * off + 1e-9;
      }
    }
  CHECK(compared >= 9);
  CHECK(sharp > compared / 2);
}

TEST_CASE("check: runs that agree by construction claim no more than the floor") {
  Scene s{.gravity = {0, -10}, .duration = 1};
  s.body({.name = "stone", .position = {3, 0}});
  const System system(s);
  for (const IntegratorEntry& entry : integrators()) {
    INFO(std::string(entry.name));
    const auto scheme = make_integrator(entry.name, system);
    const Clock clock{.step = 0.125, .duration = 1};
    const Run r = simulate(*scheme, *make_solver("lemke"), clock);
    const CheckedRun checked = check_run(system, entry.name, "lemke", clock, r);
    REQUIRE(checked.columns.size() == 6);
    CHECK(checked.columns[0].name == "stone.x");
    CHECK(checked.columns[0].value == 3);
    CHECK(checked.columns[0].digits <= 12);
    CHECK(checked.columns[0].digits >= 10);
    CHECK(checked.columns[0].error >= 3e-12);
  }
}

TEST_CASE("check: a run that cannot be repeated is named, and no digits are claimed") {
  Scene s{.duration = 1};
  s.body({.name = "stone", .velocity = {1, 0}});
  const System system(s);
  const auto scheme = make_integrator("adaptive", system);
  const Clock clock{.step = 0.1, .duration = 1};
  Run r = simulate(*scheme, *make_solver("lemke"), clock);
  const std::atomic<bool> cancelled = true;
  const CheckedRun checked =
      check_run(system, "adaptive", "lemke", {.step = 0.1, .duration = 1, .cancel = &cancelled}, r);
  CHECK(checked.against.empty());
  CHECK(checked.left_out.find("cancelled") != std::string::npos);
  CHECK(checked.columns[0].digits == 0);
  CHECK(checked.columns[0].error == kInf);
}

TEST_CASE("check: the command's summary has errors and digits by column, and only when they are wanted") {
  const auto summary = [](const std::string& options) {
    const std::string command = std::string(ORTHANT_CLI) + " simulate bouncing_ball --duration 0.6 --json" + options;
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::string text;
    for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) text += static_cast<char>(c);
    return nlohmann::json::parse(text);
  };
  const auto checked = summary(" --check --integrator adaptive:rtol=1e-4");
  const double exact = BouncingBall{}.at(0.6).x, off = std::abs(checked["final"]["ball.y"].get<double>() - exact);
  CHECK(checked["check_error"]["ball.y"].get<double>() >= off);
  CHECK(checked["check_digits"]["ball.y"].get<int>() >= 3);
  CHECK(checked["check_digits"]["ball.y"].get<int>() <= 12);
  CHECK(checked["check_against"].get<std::string>().find("adaptive:rtol=1") != std::string::npos);
  CHECK(checked["error_estimate"].get<double>() >= 0);
  CHECK(!summary("").contains("check_digits"));
}
