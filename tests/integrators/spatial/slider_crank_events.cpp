// event-driven in space: the planar slider-crank's golden events, built from spatial bodies and turned at will.
#include "tests/support/spatial.h"

#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/scenes/slider_crank_space.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

using namespace orthant;

namespace {

struct GoldenTime {
  std::string event;
  double t = 0;
};

std::vector<GoldenTime> golden_times(double mu, double e) {
  std::ifstream in(ORTHANT_TEST_DATA "/slider_crank_events.csv");
  std::vector<GoldenTime> times;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    double at_mu = 0, at_e = 0, omega3 = 0;
    GoldenTime g;
    words >> at_mu >> at_e >> omega3 >> g.event >> g.t;
    if (at_mu == mu && at_e == e && omega3 == 0) times.push_back(g);
  }
  return times;
}

bool is_kind(const std::string& golden, EventKind kind) {
  if (golden == "impact") return kind == EventKind::impact || kind == EventKind::accumulation;
  if (golden == "release") return kind == EventKind::release;
  return kind == EventKind::slip || kind == EventKind::stick;
}

}  // namespace

TEST_CASE("event-driven in space: every golden event of the slider-crank to 1e-9, in any orientation and width") {
  for (const SliderCrankExact& exact : slider_crank_exact()) {
    const bool sensitive = exact.e > 0.5 && exact.mu > 0.05;  // errors grow some 280 times in 0.2 s
    for (const auto& [turn, width] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.03}}) {
      if (turn > 0 && exact.e != 0.4) continue;
      CAPTURE(exact.mu);
      CAPTURE(exact.e);
      CAPTURE(turn);
      CAPTURE(width);
      SliderCrankSpace p;
      p.mu = exact.mu, p.e = exact.e, p.width = width;
      p.turn_x = turn, p.turn_y = 0.5 * turn, p.turn_z = -0.7 * turn;
      const SpatialSystem system(slider_crank_space(p));
      const spatial::Angle shaft = std::get<spatial::Revolute>(system.scene().joints[0]).angle();
      spatial::Unwrapped turns;
      double angle = 0, start = 0, omega = 0;
      std::vector<Event> events;
      const Run run = run_in_space(system, "event-driven", 2e-3, 0.2, [&](const SpatialSample& m) {
        events.insert(events.end(), m.events.begin(), m.events.end());
        const auto k = poses_of(system, m.state);
        omega = apply(shaft.row(k), m.state.v.data());
        angle = turns.add(m.state.t, shaft.value(k), omega);
        if (m.state.t == 0) start = angle;
      });
      double worst = 0;
      int count = 0;
      for (const GoldenTime& g : golden_times(exact.mu, exact.e)) {
        double nearest = 1;
        for (const Event& event : events)
          if (is_kind(g.event, event.kind)) nearest = std::min(nearest, std::abs(event.t - g.t) / g.t);
        worst = std::max(worst, nearest);
        ++count;
      }
      MESSAGE("mu " << exact.mu << ", e " << exact.e << ": " << count << " events to " << worst << ", theta1 to "
                    << angle - start - exact.theta1 << ", accepted " << run.accepted << ", " << run.seconds << " s");
      CHECK(count > 20);
      CHECK(worst <= (sensitive ? 1e-6 : 1e-9));
      CHECK(std::abs(angle - start - exact.theta1) <= (sensitive ? 1e-6 : 1e-9));
      CHECK(std::abs(omega - exact.omega1) <= (sensitive ? 1e-4 : 1e-7));
      CHECK(std::abs(run.energy_final - exact.energy) <= 1e-9);
      CHECK(run.max_joint_residual <= 1e-12);
      CHECK(run.crossings == 0);
    }
  }
}
