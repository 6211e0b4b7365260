// integrators/event_driven/bounces.h — impact accumulation (Zeno) between contacts: series that end alone or together.
//
// Each contact has the series of its impacts. A mode has the member `lasting`; the lists have one entry a contact.
#pragma once

#include <orthant/integrators/between_events/impact_series.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace orthant {

struct Bounces : ImpactSeries {  // a contact's impacts
  double height = 0;             // [m] bound of the next bounce
  bool rounding = false;         // the last bounce was of the size of rounding
  bool over = false;             // accumulated, just now

  /// When the contact struck last before now [s].
  double before(double now) const { return last == now ? last - interval : last; }
};

/// True when another contact struck since `ending` last did, and its bounces are still resolved: they end together.
/// is_low(c): contact c bounces no higher than what is not resolved any more.
template <class Series, class Mode, class IsLow>
bool waits(const Series& ending, const std::vector<Series>& all, const std::vector<Mode>& modes, const IsLow& is_low) {
  for (std::size_t c = 0; c < all.size(); ++c) {
    const bool between = all[c].last < ending.last && all[c].last > ending.last - ending.interval;
    if (between && !modes[c].lasting && !(all[c].accumulates() && is_low(c))) return true;
  }
  return false;
}

/// True when contact c, which strikes now, and another one that touches have had their impacts in turn, at ever shorter
/// intervals. Rounding hides which of them is next. Together they would strike by another law, which may have no
/// solution.
template <class Series, class Mode> bool meets_in_turn(std::size_t c, double now, const std::vector<Series>& all,
                                                       const std::vector<Mode>& modes,
                                                       const std::vector<char>& touching) {
  const Series& one = all[c];
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Series& b = all[k];
    if (k == c || !touching[k] || modes[k].lasting || !b.accumulates()) continue;
    const bool recent = one.last - b.last <= b.interval;
    if (recent && std::abs(b.before(now) - one.before(now)) > kInTurn * one.interval) return true;
  }
  return false;
}

/// Gaps of all contacts, their rates and accelerations. [m, m/s, m/s²]
struct GapMotion {
  const Eigen::VectorXd &gap, &rate, &acceleration;
};

/// Whether forces bring contact c back from bounce to bounce. Where it is other impacts, as of a body crushed between
/// others, the bounces become low as all gaps close, but no slower, and their impulses remain large.
inline bool pulled(Eigen::Index c, double interval, const GapMotion& at) {
  constexpr double kPulled = 10;  // of its acceleration times the interval: a faster contact was pushed
  return -at.rate[c] <= kPulled * std::abs(at.acceleration[c]) * interval;
}

/// Whether another contact strikes before the bounces of contact c have come to their end: then c is open or closed,
/// and takes another part in that impact than it would from now on. low(k): gaps of contact k that count as touching.
template <class Series, class Mode, class Low>
bool disturbed(Eigen::Index c, double now, const std::vector<Series>& all, const std::vector<Mode>& modes,
               const GapMotion& at, const Low& low) {
  const double rest = all[static_cast<std::size_t>(c)].rest, left = std::abs(at.rate[c]);
  for (Eigen::Index k = 0; k < at.gap.size(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Series& b = all[i];
    const bool ends_too = b.accumulates() && at.gap[k] <= low(static_cast<int>(k)) && now - b.last <= b.interval;
    if (k == c || modes[i].lasting || ends_too) continue;
    const double closing = std::max(0.0, -at.rate[k]), faster = std::max(0.0, -at.acceleration[k]);
    if (at.gap[k] < rest * (closing + left + rest / 2 * faster)) return true;
  }
  return false;
}

/// True when several of the series that are over had their impacts in turn. in_turn: the contacts of these series.
template <class Series, class Mode> bool ends_in_turn(double now, const std::vector<Series>& all,
                                                      const std::vector<Mode>& modes, std::vector<char>& in_turn) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double first = kNever, last = -kNever, interval = kNever;
  for (std::size_t c = 0; c < all.size(); ++c) {
    in_turn[c] = all[c].over && !modes[c].lasting;
    if (!in_turn[c]) continue;
    const double before = all[c].before(now);
    first = std::min(first, before), last = std::max(last, before), interval = std::min(interval, all[c].interval);
  }
  return last - first > kInTurn * interval;
}

}  // namespace orthant
