// tests/support/event_record.h — a run by event-driven, its events and the sums of its impulses.
#pragma once

#include "tests/support/runs.h"

#include <algorithm>
#include <vector>

namespace orthant {

inline constexpr std::string_view kScheme = "event-driven";

struct EventRecord {  // of a run: its events and sums of impulses
  Run run;
  std::vector<Event> events;
  std::vector<Impulse> sum;
  double tilt = 0;  // largest |θ| of the last body [rad]

  std::vector<Event> of(EventKind kind) const {
    std::vector<Event> found;
    std::copy_if(events.begin(), events.end(), std::back_inserter(found),
                 [&](const Event& e) { return e.kind == kind; });
    return found;
  }
};

inline EventRecord tell(Scene scene, double duration, double step, std::string_view solver = "lemke",
                        std::string_view scheme = kScheme) {
  EventRecord record;
  scene.duration = duration;
  record.sum.resize(scene.contacts.size());
  record.run = run(
      scene, scheme, step,
      [&](const RunSample& m) {
        record.events.insert(record.events.end(), m.events.begin(), m.events.end());
        for (std::size_t i = 0; i < record.sum.size(); ++i)
          record.sum[i].normal += m.impulses[i].normal, record.sum[i].tangent += m.impulses[i].tangent;
        record.tilt = std::max(record.tilt, std::abs(m.state.q[m.state.q.size() - 1]));
      },
      solver);
  return record;
}

}  // namespace orthant
