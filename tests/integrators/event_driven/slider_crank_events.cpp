// Events of the slider-crank with clearance against the golden table, and from a tilt.
#include "tests/support/event_record.h"

#include <orthant/core/scenes/slider_crank_exact.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

using namespace orthant;

namespace {

struct Golden {
  double mu, e, omega3;
  std::string event;
  double t;
};

std::vector<Golden> golden_events() {
  std::ifstream in(ORTHANT_TEST_DATA "/slider_crank_events.csv");
  std::vector<Golden> events;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    Golden g;
    words >> g.mu >> g.e >> g.omega3 >> g.event >> g.t;
    events.push_back(g);
  }
  return events;
}

bool same_kind(const std::string& golden, EventKind kind) {
  if (golden == "impact") return kind == EventKind::impact || kind == EventKind::accumulation;
  if (golden == "release") return kind == EventKind::release;
  return kind == EventKind::slip || kind == EventKind::stick;
}

/// The largest relative distance of a golden event's time from the nearest one of the record.
double worst_time(const EventRecord& record, double mu, double e, double omega3, int& count) {
  double worst = 0;
  for (const Golden& g : golden_events()) {
    if (g.mu != mu || g.e != e || g.omega3 != omega3) continue;
    double nearest = 1;
    for (const Event& event : record.events)
      if (same_kind(g.event, event.kind)) nearest = std::min(nearest, std::abs(event.t - g.t) / g.t);
    worst = std::max(worst, nearest);
    ++count;
  }
  return worst;
}

}  // namespace

TEST_CASE("slider-crank: every golden event to 1e-9, the crank's angle to 1e-9, joints to rounding") {
  for (const SliderCrankExact& exact : slider_crank_exact())
    for (const double step : {0.2, 2e-3}) {
      CAPTURE(exact.mu);
      CAPTURE(exact.e);
      CAPTURE(step);
      const bool sensitive = exact.e > 0.5 && exact.mu > 0.05;  // errors grow some 280 times in 0.2 s
      const EventRecord record = tell(slider_crank({.mu = exact.mu, .e = exact.e}), 0.2, step);
      REQUIRE(record.run.status == Status::solved);
      int events = 0;
      const double worst = worst_time(record, exact.mu, exact.e, 0, events);
      const double theta1 = std::abs(record.run.final.q[kTheta1] - exact.theta1);
      MESSAGE("mu = " << exact.mu << ", e = " << exact.e << ", step " << step << ": " << events << " events to "
                      << worst << ", theta1 to " << theta1 << ", " << record.run.seconds * 1e3 << " ms");
      CHECK(events > 20);
      CHECK(worst <= (sensitive ? 1e-6 : 1e-9));
      CHECK(theta1 <= (sensitive ? 1e-6 : 1e-9));
      CHECK(std::abs(record.run.energy_final - exact.energy) <= 1e-9);
      CHECK(record.run.max_joint_residual <= 1e-12);
      CHECK(record.run.max_joint_rate <= 1e-12);
      CHECK(record.tilt <= 1e-12);
    }
}

TEST_CASE("slider-crank from a tilt: infinitely many alternate impacts within 1.6 microseconds are passed") {
  const EventRecord record = tell(slider_crank({.omega3 = -0.01}), 0.2, 0.2);
  REQUIRE(record.run.status == Status::solved);
  CHECK(record.events.front().t == doctest::Approx(2.69090364840784e-3).epsilon(1e-12));
  CHECK(record.run.final.q[kTheta1] == doctest::Approx(18.0811239872).epsilon(1e-10 / 18));
  int events = 0;
  CHECK(worst_time(record, 0.01, 0.4, -0.01, events) <= 1e-9);
  CHECK(events > 80);
  const auto accumulation = record.of(EventKind::accumulation);
  REQUIRE(accumulation.size() > 2);
  CHECK(accumulation[0].t == doctest::Approx(2.6925481074359572e-3).epsilon(1e-9));
}
