// Impact accumulation (Zeno) of a SpatialEventDriven integrator: which series of impacts end at an instant.
#include <orthant/integrators/event_driven/spatial_event_driven.h>

#include <algorithm>

namespace orthant {

/// Marks the contacts whose bounces need not be resolved any more, if there are any that struck now.
bool SpatialEventDriven::accumulates() {
  const auto is_low = [this](std::size_t c) {
    return now_.w.gap[static_cast<Index>(c)] <= low_gap(static_cast<int>(c));
  };
  evaluate_closed(system_, kInf, motion_.terms());
  for (int c = 0; c < system_.contacts(); ++c) fall_[c] = acceleration_of(c);
  const GapMotion at_now{now_.w.gap, now_.w.gap_rate, fall_};
  const auto low = [this](int c) { return low_gap(c); };
  bool any = false, meet = false;
  for (int c = 0; c < system_.contacts(); ++c) {
    const DatedBounces& b = bounces_[static_cast<std::size_t>(c)];
    if (b.last != time_) continue;
    meet = meet ||
           (b.accumulates() && meets_in_turn(static_cast<std::size_t>(c), time_, bounces_, motion_.modes, touching_));
    any = any || meet || b.rounding ||
          (b.accumulates() && b.height <= low_gap(c) && pulled(c, b.interval, at_now) &&
           !waits(b, bounces_, motion_.modes, is_low) && !disturbed(c, time_, bounces_, motion_.modes, at_now, low));
  }
  evaluate_closed(system_, motion_.lasting(), motion_.terms());
  for (int c = 0; any && c < system_.contacts(); ++c) {
    const auto i = static_cast<std::size_t>(c);
    DatedBounces& b = bounces_[i];
    const bool closed = now_.w.gap[c] <= low_gap(c) || (meet && touching_[i]);
    b.over = (b.rounding || b.accumulates()) && time_ - b.last <= b.interval && closed;
    touching_[i] = touching_[i] || b.over;
  }
  return any;
}

}  // namespace orthant
