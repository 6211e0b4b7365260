// integrators/event_driven/overlap.cpp — initial overlap: when a contact that separates opens or approaches again.
#include <orthant/integrators/event_driven/event_driven.h>

namespace orthant {

/// Of a contact that overlaps at now_, in the trial step of s: where it begins to approach, or where its gap is zero.
/// The event does not depend on where steps end.
std::optional<Sign> EventDriven::end_of_overlap(int c, double s) {
  constexpr int kParts = 16;
  constexpr double kPart = 1.0 / kParts;
  if (immobile(c)) return {};
  using Sample = ContinuousCollision::Sample;
  const double slow = 2 * speed_zero(now_.w.gap_rate_scale[c]), near = 2 * gap_zero(c);
  const auto of = [&](const Watched& w) -> Sample { return {w.gap[c], w.gap_rate[c], w.gap_acceleration[c]}; };
  Sample from = of(now_.w);
  for (int i = 0; i < kParts; ++i) {
    const Sample to = i + 1 < kParts ? sweep_.sample(c, kPart * (i + 1)) : of(trial_.w);
    const auto rate = cubic(from.rate, from.acceleration, to.rate, to.acceleration, kPart * s);
    const auto depth =
        quintic(-from.gap, -from.rate, -from.acceleration, -to.gap, -to.rate, -to.acceleration, kPart * s);
    const auto turns = first_crossing(rate, slow), opens = first_crossing(depth, near);
    const auto sign = [&](Watch watch, const Crossing& found) {
      return Sign{watch, c, {kPart * (i + found.x), found.slope / kPart}, kPart * i, kPart * (i + 1)};
    };
    if (opens && !(turns && turns->x < opens->x)) return sign(Watch::gap, *opens);
    if (turns) return sign(Watch::approach, *turns);
    from = to;
  }
  return {};
}

}  // namespace orthant
