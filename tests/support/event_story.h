// tests/support/event_story.h — a run by event-driven, its events and the sums of its impulses.
#pragma once

#include "tests/support/runs.h"

#include <algorithm>
#include <vector>

namespace orthant {

inline constexpr std::string_view kScheme = "event-driven";

struct Story {  // of a run: its events and sums of impulses
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

inline Story tell(Scene scene, double duration, double step, std::string_view solver = "lemke",
                  std::string_view scheme = kScheme) {
  Story story;
  scene.duration = duration;
  story.sum.resize(scene.contacts.size());
  story.run = run(
      scene, scheme, step,
      [&](const Moment& m) {
        story.events.insert(story.events.end(), m.events.begin(), m.events.end());
        for (std::size_t i = 0; i < story.sum.size(); ++i)
          story.sum[i].normal += m.impulses[i].normal, story.sum[i].tangent += m.impulses[i].tangent;
        story.tilt = std::max(story.tilt, std::abs(m.state.q[m.state.q.size() - 1]));
      },
      solver);
  return story;
}

}  // namespace orthant
