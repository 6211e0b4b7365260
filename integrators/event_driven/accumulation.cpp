// Impact accumulation (Zeno) of an EventDriven integrator: which series of impacts end at an instant, and with which.
#include <orthant/integrators/event_driven/event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
/// Before an impact at contact c.
void EventDriven::note_bounce(int c) {
  Bounces& b = bounces_[at(c)];
  b.add(start_ + elapsed_);
  const double height = -now_.w.gap_rate[c] * b.interval / 4;  // of the last one, a parabola of this speed
  b.height = height * b.ratio;
  b.rounding = height <= 16 * gap_zero(c);
}

/// Marks the contacts whose bounces need not be resolved any more, if there are any at this time. Those are no higher
/// than what counts as touching: contacts of a series, struck in turn, would else strike at once, with restitution.
bool EventDriven::accumulates() {
  const double t = start_ + elapsed_;
  const auto low = [&](int c) { return std::max({options_.accumulation, 32 * gap_zero(c), strike_.tie[at(c)]}); };
  const auto is_low = [&](std::size_t c) { return now_.w.gap[static_cast<Index>(c)] <= low(static_cast<int>(c)); };
  const GapMotion at_now{now_.w.gap, now_.w.gap_rate, now_.w.gap_acceleration};
  bool any = false, meet = false;
  for (int c = 0; c < system_.contacts(); ++c) {
    const Bounces& b = bounces_[at(c)];
    if (b.last != t) continue;
    meet = meet || (b.accumulates() && meets_in_turn(at(c), t, bounces_, motion_.modes, strike_.touching));
    any = any || meet || b.rounding ||
          (b.accumulates() && b.height <= low(c) && pulled(c, b.interval, at_now) &&
           !waits(b, bounces_, motion_.modes, is_low) && !disturbed(c, t, bounces_, motion_.modes, at_now, low));
  }
  for (int c = 0; c < system_.contacts(); ++c) {
    Bounces& b = bounces_[at(c)];
    const bool closed = now_.w.gap[c] <= low(c) || (meet && strike_.touching[at(c)]);
    b.over = any && (b.rounding || b.accumulates()) && t - b.last <= b.interval && closed;
    strike_.touching[at(c)] = strike_.touching[at(c)] || b.over;
  }
  return any;
}

/// Whether a contact that struck at this instant has no part in the series that just ended there, and approaches still:
/// its own impact follows, with the contacts of the series closed and at rest.
bool EventDriven::strikes_after_series() {
  const double t = start_ + elapsed_;
  const auto outside = [t](const Bounces& b) { return b.last == t && !b.over; };
  return std::ranges::any_of(bounces_, outside) && observe(now_, t) &&
         std::ranges::any_of(bounces_, [&](const Bounces& b) {
           const Index c = &b - bounces_.data();
           return outside(b) && now_.w.gap_rate[c] < -speed_zero(now_.w.gap_rate_scale[c]);
         });
}

}  // namespace orthant
