#include <orthant/integrators/derivatives/begun_friction.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/step/rate_targets.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace orthant {

namespace {

constexpr int kSamples = 4;        // of an arc: slip changes its sign once between two of them, or not at all
constexpr int kHalvings = 50;      // of the way between them
constexpr double kNoSlip = 1e-12;  // of the resting speed

}  // namespace

BegunFriction::BegunFriction(const System& system, NearbyMotion& base, std::vector<char> contacts)
    : system_(system), base_(base), contacts_(std::move(contacts)) {}

int BegunFriction::sense(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const double slip = base_.slip(contact, t, q, v);
  if (!(std::abs(slip) > kNoSlip * kRestSpeed * system_.law(contact).unit)) return 0;
  return slip > 0 ? 1 : -1;
}

BegunFriction::Sample BegunFriction::moved(const Sample& from, double duration) {
  Sample to{from.t + duration, from.q, from.v};
  if (!base_.move(from.t, duration, to.q, to.v)) throw std::runtime_error("derivatives of a motion: not finite");
  return to;
}

BegunFriction::Sample BegunFriction::turn(int contact, const Sample& from, const Sample& to) {
  const int before = sense(contact, from.t, from.q, from.v);
  double low = 0, high = to.t - from.t;
  for (int i = 0; i < kHalvings && high - low > 16 * kRounding * (std::abs(from.t) + high); ++i) {
    const double half = (low + high) / 2;
    const Sample there = moved(from, half);
    (sense(contact, there.t, there.q, there.v) == before ? low : high) = half;
  }
  return moved(from, high);
}

const std::vector<Arc>& BegunFriction::pieces(const Arc& arc, std::vector<int>& at_rest) {
  pieces_.assign(1, arc);
  at_rest.clear();
  std::vector<int> sliding;
  for (int c = 0; c < system_.contacts(); ++c)
    if (of(c) && arc.modes[static_cast<std::size_t>(c)].lasting) sliding.push_back(c);
  if (sliding.empty()) return pieces_;
  base_.set_modes(arc.modes);
  std::vector<Sample> samples{{arc.start, arc.q0, arc.v0}};
  for (int k = 1; k < kSamples; ++k) samples.push_back(moved(samples.front(), k * arc.length / kSamples));
  samples.push_back({arc.start + arc.length, arc.q1, arc.v1});
  std::vector<Sample> turns;
  for (const int c : sliding) {
    const Sample* last = nullptr;  // the last sample that slips
    int was = 0;
    for (const Sample& there : samples) {
      const int is = sense(c, there.t, there.q, there.v);
      if (is == 0) continue;
      if (was * is < 0) turns.push_back(turn(c, *last, there));
      last = &there, was = is;
    }
    if (was == 0) at_rest.push_back(c);
  }
  std::ranges::sort(turns, {}, &Sample::t);
  for (const Sample& t : turns) {
    Arc& before = pieces_.back();
    const double end = before.start + before.length;
    if (!(t.t > before.start && t.t < end)) continue;  // contacts may turn together
    Arc after = before;
    after.start = t.t, after.length = end - t.t, after.q0 = t.q, after.v0 = t.v;
    before.length = t.t - before.start, before.q1 = t.q, before.v1 = t.v;
    pieces_.push_back(std::move(after));
  }
  for (Arc& piece : pieces_) {
    const Sample half = moved({piece.start, piece.q0, piece.v0}, piece.length / 2);
    for (const int c : sliding) piece.modes[static_cast<std::size_t>(c)].slip = sense(c, half.t, half.q, half.v);
  }
  return pieces_;
}

}  // namespace orthant
