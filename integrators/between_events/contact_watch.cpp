#include <orthant/integrators/between_events/contact_watch.h>

namespace orthant {

bool observe(ContactMotion& motion, double t, MotionPoint& p) {
  if (!motion.accelerations(t, p.q, p.v, p.a)) return false;
  motion.watch(p.q, p.v, p.a, p.w);
  return true;
}

void interpolate(const MotionPoint& a, const MotionPoint& b, double s, double x, MotionPoint& inner) {
  // What the Taylor polynomials from a lack at b, put right by those of degree 5 and 3 that vanish at 0, their rates
  // too, and have value, rate (and second derivative) 1 at 1. Not the rate of q's: that is rounded by ε |q| / s.
  const double y = x * x * x;
  inner.q = a.q + s * x * (a.v + s * x / 2 * a.a) +
            y * (10 + x * (6 * x - 15)) * (b.q - a.q - s * (a.v + s / 2 * a.a)) +
            s * y * (-4 + x * (7 - 3 * x)) * (b.v - a.v - s * a.a) + s * s * y * (0.5 + x * (x / 2 - 1)) * (b.a - a.a);
  inner.v = a.v + s * x * a.a + x * x * (3 - 2 * x) * (b.v - a.v - s * a.a) + s * x * x * (x - 1) * (b.a - a.a);
}

ContactWatch::ContactWatch(ContactMotion& motion)
    : slow(motion.modes.size()),
      motion_(motion),
      weight_(motion.modes.size()),
      inner_{MotionPoint(motion.system()), MotionPoint(motion.system()), MotionPoint(motion.system())} {
  const System& system = motion.system();
  const double g = system.scene().gravity.norm();
  const auto mass = [&](BodyId i) { return i < 0 ? 0 : system.scene().bodies[static_cast<std::size_t>(i)].mass; };
  for (int c = 0; c < system.listed(); ++c) {
    const auto [a, b] = bodies_of(system, {}, c);
    weight_[static_cast<std::size_t>(c)] = g * (mass(a) + mass(b));
  }
}

bool ContactWatch::look(double t, double s, const MotionPoint& a, const MotionPoint& b, double stop) {
  points_ = {&a, &inner_[0], &inner_[1], &inner_[2], &b};
  s_ = s;
  for (std::size_t i = 0; i < inner_.size(); ++i) {
    MotionPoint& p = inner_[i];
    const double x = static_cast<double>(i + 1) / (kPoints - 1);
    interpolate(a, b, s, x, p);
    if (!motion_.accelerations(std::min(t + x * s, stop), p.q, p.v, p.a)) return false;
    motion_.watch_lasting(p.v, p.a, p.w);
  }
  return true;
}

double ContactWatch::value(const Sign& sign, const Watched& w) const {
  const int c = sign.contact;
  const double bound = static_mu(motion_.system().law(c)) * w.normal[c];
  switch (sign.watch) {
    case Watch::gap:
      return w.gap[c];
    case Watch::force:
      return w.normal[c];
    case Watch::cone_up:
      return bound - w.tangent[c];
    case Watch::cone_down:
      return bound + w.tangent[c];
    case Watch::slip:
      return motion_.modes[static_cast<std::size_t>(c)].slip * w.slip[c];
    case Watch::approach:
      return w.gap_rate[c];
  }
  return 0;
}

double ContactWatch::slack(const Sign& sign) const {
  const Watched &a = points_.front()->w, &b = points_.back()->w;
  if (sign.watch == Watch::slip)
    return slow[static_cast<std::size_t>(sign.contact)] + kSame * a.slip_scale[sign.contact];
  constexpr double kRounded = 16 * 0x1p-52;  // of the weight: bodies that hang side by side press by that much
  return 10 * kSame * std::max(a.normal.lpNorm<Eigen::Infinity>(), b.normal.lpNorm<Eigen::Infinity>()) +
         kRounded * weight_[static_cast<std::size_t>(sign.contact)];
}

std::optional<Sign> ContactWatch::first(bool forces) const {
  std::optional<Sign> first;
  const auto take = [&](Sign sign, const std::optional<Crossing>& found, double from, double part) {
    if (!found || (first && first->crossing.x <= from + part * found->x)) return found.has_value();
    sign.crossing = {from + part * found->x, found->slope / part};
    first = sign;
    return true;
  };
  for (const int c : motion_.lasting()) {
    const ContactMode& mode = motion_.modes[static_cast<std::size_t>(c)];
    for (const Watch watch : {Watch::force, Watch::cone_up, Watch::cone_down}) {
      if (!forces || (watch != Watch::force && !mode.sticks)) continue;
      const Sign sign{watch, c, {}};
      std::array<double, kPoints> f;
      for (std::size_t i = 0; i < kPoints; ++i) f[i] = value(sign, points_[i]->w);
      take(sign, first_crossing(quartic(f), slack(sign)), 0, 1);
    }
    if (mode.slip == 0) continue;
    const Sign sign{Watch::slip, c, {}};
    constexpr double kPart = 1.0 / (kPoints - 1);
    for (std::size_t i = 0; i + 1 < kPoints; ++i) {
      const Watched &a = points_[i]->w, &b = points_[i + 1]->w;
      const auto piece = cubic(mode.slip * a.slip[c], mode.slip * a.slip_acceleration[c], mode.slip * b.slip[c],
                               mode.slip * b.slip_acceleration[c], kPart * s_);
      if (take(sign, first_crossing(piece, slack(sign)), kPart * static_cast<double>(i), kPart)) break;
    }
  }
  return first;
}

Impulse ContactWatch::impulse(int contact) const {
  constexpr std::array<double, kPoints> kWeights = {7.0 / 90, 32.0 / 90, 12.0 / 90, 32.0 / 90, 7.0 / 90};
  Impulse sum;
  for (std::size_t i = 0; i < kPoints; ++i) {
    sum.normal += s_ * kWeights[i] * points_[i]->w.normal[contact];
    sum.tangent += s_ * kWeights[i] * points_[i]->w.tangent[contact];
  }
  return sum;
}

}  // namespace orthant
