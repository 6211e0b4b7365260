// Events within a step of a SpatialEventDriven integrator: where they are, and the landing on the first.
#include <orthant/integrators/between_events/first_crossing.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr int kHalvings = 6;              // of the time between two looks
constexpr double kCubicError = 4e-5;      // of what a contact moves between two looks
constexpr double kForceRounding = 1e-11;  // of the largest force

/// Where the polynomial is least on [x, 1].
double least_after(const Bernstein<4>& c, double x) {
  const double d0 = c[1] - c[0], d1 = c[2] - c[1], d2 = c[3] - c[2];  // of its derivative
  const auto value = [&](double t) {
    const double u = 1 - t;
    return u * u * u * c[0] + 3 * t * u * u * c[1] + 3 * t * t * u * c[2] + t * t * t * c[3];
  };
  double least = value(1) < value(x) ? 1 : x;
  const double a = d0 - 2 * d1 + d2, b = d1 - d0, root = std::sqrt(std::max(0.0, b * b - a * d0));
  for (const double t : {(-b + root) / a, (-b - root) / a, d0 / (-2 * b)})  // the last one where a = 0
    if (t > x && t < 1 && value(t) < value(least)) least = t;
  return least;
}

}  // namespace

double SpatialEventDriven::room(int contact, const Point& p) const {
  return static_friction(system_.law(contact)) * p.w.normal[contact] - p.w.tangent[contact];
}

double SpatialEventDriven::value(const Sign& sign, const Point& p) const {
  switch (sign.watch) {
    case Watch::gap:
      return p.w.gap[sign.contact];
    case Watch::force:
      return p.w.normal[sign.contact];
    case Watch::cone:
      return room(sign.contact, p);
    case Watch::stop:
      break;
  }
  return p.w.slip[sign.contact];
}

/// Values this far below zero are zero.
double SpatialEventDriven::slack(const Sign& sign) const {
  if (sign.watch == Watch::gap) return 32 * gap_zero(sign.contact) + std::max(0.0, -now_.w.gap[sign.contact]);
  return kForceRounding * (load_ + now_.w.normal.lpNorm<Eigen::Infinity>());
}

/// Whether no force at now_ moves the contact, and the joints' drives do not press it shut.
bool SpatialEventDriven::stands_still(int contact) {
  return immobility_.stand(time_, now_.q) && immobility_.immobile(contact) && immobility_.rate() >= 0;
}

bool SpatialEventDriven::dismissed(Watch watch, int contact) const {
  return std::ranges::any_of(dismissed_,
                             [&](const Sign& sign) { return sign.watch == watch && sign.contact == contact; });
}

/// The first event in the trial step of s.
std::optional<SpatialEventDriven::Sign> SpatialEventDriven::first_sign(double s) {
  std::optional<Sign> first;
  const bool open = static_cast<int>(motion_.lasting().size()) < system_.contacts();
  if (open || !motion_.lasting().empty()) {
    ChartRungeKutta::rate(path_, trial_.v, path_rate_);
    // φ'' at the end: J⁻¹ a + (J⁻¹)' v by central differences
    constexpr double kBeside = 1e-5;
    Eigen::VectorXd ahead, behind;
    const double by = kBeside / std::max(1e-3, largest_rotation<Spatial>(path_rate_));
    ChartRungeKutta::rate(path_ + by * path_rate_, trial_.v, ahead);
    ChartRungeKutta::rate(path_ - by * path_rate_, trial_.v, behind);
    ChartRungeKutta::rate(path_, trial_.a, path_bend_);
    path_bend_ += (ahead - behind) / (2 * by);
  }
  if (open) find_gaps(s, first);
  if (!motion_.lasting().empty()) find_ends(s, first);
  if (first) return first;
  for (const int c : motion_.lasting())
    if (motion_.modes[static_cast<std::size_t>(c)].slides && trial_.w.slip[c] <= slip_zero(trial_) &&
        trial_.w.slip[c] < now_.w.slip[c])
      return Sign{Watch::stop, c, 1};
  return {};
}

/// q and v at x ∈ [0, 1] of the trial step: the quintic Hermite polynomial of the chart, and the cubic one of v.
void SpatialEventDriven::between_ends(double s, double x, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  const double xx = x * x;
  hermite_.resize(path_.size()), v.resize(path_.size());
  for (Index i = 0; i < path_.size(); ++i) {
    const double d = path_[i] - s * (now_.v[i] + s / 2 * now_.a[i]),
                 e = s * (path_rate_[i] - now_.v[i] - s * now_.a[i]), f = s * s * (path_bend_[i] - now_.a[i]);
    const double c3 = 10 * d - 4 * e + f / 2, c4 = -15 * d + 7 * e - f, c5 = 6 * d - 3 * e + f / 2;
    hermite_[i] = s * x * (now_.v[i] + s * x / 2 * now_.a[i]) + xx * x * (c3 + x * (c4 + x * c5));
    const double change = trial_.v[i] - now_.v[i];
    v[i] = now_.v[i] + change * xx * (3 - 2 * x) + s * x * (1 - x) * (now_.a[i] * (1 - x) - trial_.a[i] * x);
  }
  move<Spatial>(now_.q, hermite_, q);
}

void SpatialEventDriven::find_gaps(double s, std::optional<Sign>& first) {
  double turning = 0;
  set_poses(system_, time_, now_.q, motion_.terms().at);
  for (int c = 0; c < system_.contacts(); ++c)
    if (!motion_.modes[static_cast<std::size_t>(c)].lasting)
      turning = std::max({turning, motion_.pace(c, now_.v), motion_.pace(c, trial_.v)});
  const int nodes = static_cast<int>(std::clamp(std::ceil(s * turning / kTurnOfNode), 1.0, 1.0 * kMostNodes));
  Node low{0, now_.w.gap, now_.w.gap_rate}, high;
  for (int k = 1; k <= nodes; ++k) {
    high.x = static_cast<double>(k) / nodes;
    if (k == nodes) {
      high.gap = trial_.w.gap, high.rate = trial_.w.gap_rate;
    } else {
      between_ends(s, high.x, q_within_, v_within_);
      motion_.watch_gaps(time_ + high.x * s, q_within_, v_within_, high.gap, high.rate);
    }
    for (int c = 0; c < system_.contacts(); ++c) {
      const auto seen = [&](const Sign& sign) {  // it came near there only
        return sign.watch == Watch::gap && sign.contact == c && sign.x >= low.x;
      };
      if (motion_.modes[static_cast<std::size_t>(c)].lasting || std::ranges::any_of(dismissed_, seen)) continue;
      const std::optional<Sign> sign = closing(c, s, low, high, 0);
      if (!sign || (first && first->x <= sign->x)) continue;
      if (stays(now_, c) && stays(trial_, c) && stands_still(c)) continue;  // rounding of what the joints hold
      first = sign;
    }
    if (first) return;
    std::swap(low, high);
  }
}

/// Where the gap of a contact first falls below zero between two looks at it.
auto SpatialEventDriven::closing(int c, double s, const Node& low, const Node& high, int depth) -> std::optional<Sign> {
  const double part = high.x - low.x, length = part * s, zero = slack({Watch::gap, c, 1});
  const Bernstein<4> gap = cubic(low.gap[c], low.rate[c], high.gap[c], high.rate[c], length);
  const double fast = std::max(now_.w.rate_scale[c], trial_.w.rate_scale[c]);
  const double margin = kCubicError * std::pow(0.125, depth) * length * fast;
  const double least = *std::min_element(gap.begin(), gap.end());
  if (least > margin) return {};
  const bool sure = high.gap[c] < -margin && low.gap[c] > margin;
  if (!sure && depth < kHalvings && margin > zero) {
    Node middle;
    middle.x = (low.x + high.x) / 2;
    Eigen::VectorXd q, v;
    between_ends(s, middle.x, q, v);
    motion_.watch_gaps(time_ + middle.x * s, q, v, middle.gap, middle.rate);
    if (const auto sign = closing(c, s, low, middle, depth + 1)) return sign;
    return closing(c, s, middle, high, depth + 1);
  }
  const auto found = first_crossing(gap, zero);
  if (!found) return {};
  return Sign{Watch::gap, c, low.x + part * found->x, low.x + part * least_after(gap, found->x)};
}

/// Ends of lasting contacts, and of sticking.
void SpatialEventDriven::find_ends(double s, std::optional<Sign>& first) {
  const auto& lasting = motion_.lasting();
  std::vector<std::array<double, 5>> normal(lasting.size()), rooms(lasting.size());
  Eigen::VectorXd q, v, a;
  for (std::size_t k = 0; k < 5; ++k) {
    const bool end = k == 0 || k == 4;
    if (!end) {
      const double x = static_cast<double>(k) / 4;
      between_ends(s, x, q, v);
      if (!motion_.accelerations(std::min(time_ + x * s, stop_), q, v, a)) return;
    }
    for (std::size_t i = 0; i < lasting.size(); ++i) {
      const int c = lasting[i];
      const Point& p = k == 0 ? now_ : trial_;
      normal[i][k] = end ? p.w.normal[c] : motion_.normal_force(i);
      rooms[i][k] =
          end ? room(c, p) : static_friction(system_.law(c)) * normal[i][k] - size_of(motion_.tangent_force(i));
    }
  }
  const auto look = [&](Watch watch, int c, const std::array<double, 5>& values) {
    if (dismissed(watch, c)) return;
    Sign sign{watch, c, 1};
    const double zero = slack(sign) + std::max(0.0, -values[0]);
    const auto found = first_crossing(quartic(values), zero);
    if (!found) return;
    sign.x = found->x;
    if (!first || sign.x < first->x) first = sign;
  };
  for (std::size_t i = 0; i < lasting.size(); ++i) {
    look(Watch::force, lasting[i], normal[i]);
    if (motion_.modes[static_cast<std::size_t>(lasting[i])].sticks) look(Watch::cone, lasting[i], rooms[i]);
  }
}

/// Shortens the trial step of s to where the value of `sign` is zero, if it is negative there.
auto SpatialEventDriven::land(const Sign& sign, double& s) -> Landing {
  constexpr int kIterations = 80;
  const double zero = slack(sign), whole = s, start = value(sign, now_);
  if (sign.watch == Watch::stop) return Landing::there;
  double low = 0, f_low = start, high = s, f_high = value(sign, trial_);
  const auto restore = [&] { attempt(s = whole, true); };
  if (!(f_high < -zero)) {
    bool found = false, fails = false;
    const auto between = [&](double part) { return sign.x + part * (1 - sign.x); };
    for (const double at : {sign.deep, sign.x, between(1.0 / 64), between(1.0 / 16), between(1.0 / 4), between(0.5)}) {
      high = whole * at;
      if (!(high > 0)) high = 1e-3 * whole;
      if (!(attempt(high, true) < kInf)) {
        fails = true;
        continue;
      }
      f_high = value(sign, trial_);
      found = f_high < -zero;
      if (found) break;
    }
    if (!found) return restore(), fails ? Landing::fails : Landing::none;
  }
  const double enough = sign.watch == Watch::gap ? 4 * gap_zero(sign.contact) : zero / 8;
  double guess = std::clamp(sign.x * whole, 0.0, high);
  if (guess <= 0 || guess >= high) guess = high / 2;
  for (int i = 0; i < kIterations; ++i) {
    if (!(attempt(guess, true) < kInf)) return restore(), Landing::fails;
    const double f = value(sign, trial_);
    s = guess;
    if (std::abs(f) <= enough && (sign.watch != Watch::gap || trial_.w.gap_rate[sign.contact] < 0 || f < 0)) break;
    if (high - low <= 2 * time_rounding(time_ + high) * 0.125 + 1e-300) break;
    if (f < 0)
      high = guess, f_high = f;
    else
      low = guess, f_low = f;
    double next = sign.watch == Watch::gap ? guess - f / trial_.w.gap_rate[sign.contact]
                                           : (low * f_high - high * f_low) / (f_high - f_low);
    const bool inside = next > low && next < high && (sign.watch != Watch::gap || trial_.w.gap_rate[sign.contact] < 0);
    if (!inside || (sign.watch != Watch::gap && i % 3 == 2) || f_low <= 0) next = (low + high) / 2;
    guess = next;
  }
  return Landing::there;
}

}  // namespace orthant
