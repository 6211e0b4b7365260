// integrators/event.h — event: change at a contact and its time; for schemes that locate it.
#pragma once

#include <array>
#include <string_view>

namespace orthant {

/// impact: the velocity jumps; accumulation: infinitely many impacts end here, the contact lasts from now on;
/// touch: contact is made without an impact; release: it is lost; stick, slip: the tangential mode begins.
enum class EventKind { impact, accumulation, touch, release, stick, slip };
inline constexpr std::array<std::string_view, 6> kEventNames = {"impact",  "accumulation", "touch",
                                                                "release", "stick",        "slip"};

struct Event {
  double t = 0;  // [s]
  EventKind kind = EventKind::impact;
  int contact = 0;                 // index in the system; of dry friction in joints: behind all contacts
  double normal = 0, tangent = 0;  // [N s] impulses of an impact
};

}  // namespace orthant
