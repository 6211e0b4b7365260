// Events in the variations of a motion: guards, changes of their times, resets.
#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_variation.h>
#include <orthant/integrators/derivatives/shared_friction.h>
#include <orthant/integrators/step/rate_targets.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kStrikeTogether = 1e-6;  // of the changes of times: contacts strike together still
constexpr double kSameImpact = 1e-7;      // of v⁺
constexpr double kGrazed = 24 * 0x1p-52;  // of the coordinates in a gap: a lower flight is lost in its rounding
constexpr double kGrazedUnseen = 1e-12;   // likewise: of a motion that does not touch
constexpr double kClose = 1e-2;           // of the way: nearer ones are looked at
constexpr double kGrazingSlip = 1e-7;     // of the accelerations
constexpr double kGrazingForce = 1e-9;    // [1/s] of the force
constexpr double kAtItsBound = 1e-6;      // of the force
constexpr double kForcesJump = 1e-6;      // of the accelerations
constexpr double kForcesRounded = 1e-11;  // of those without contacts
constexpr double kGrows = 1e4;            // of the tangents, through one event
constexpr double kNearlyGrazes = 100;     // times the rate that rounding leaves
constexpr std::size_t kMostWarnings = 20;

}  // namespace

/// Impacts between before_ and `after`, and the contacts that they close.
void MotionVariation::strikes(const Arc& after, Crossing& crossing) {
  std::vector<HeldFriction> held;
  for (const Event& event : events_) {
    if (event.kind != EventKind::impact && event.kind != EventKind::accumulation) continue;
    const ContactLaw& law = system_.law(event.contact);
    double bound = law.mu * event.normal;
    bool sticks = law.frictional() && std::abs(event.tangent) < (1 - kAtFrictionBound) * bound;
    if (bound > 0 && !sticks) sticks = stops(event.contact, after);
    if (sticks && std::abs(event.tangent) > (1 + kAtFrictionBound) * bound) bound = static_mu(law) * event.normal;
    int sense = law.frictional() && !sticks ? (event.tangent > 0 ? 1 : -1) : 0;
    if (begins_.of(event.contact)) {
      sense = -begins_.sense(event.contact, now(), before_.q1, after.v0);
      if (sense == 0)
        none("contact " + name(event.contact) + " strikes without a slip: the friction that begins there has no sense");
    }
    if (sticks) held.push_back({event.contact, event.tangent, bound});
    const ContactMode& mode = after.modes[static_cast<std::size_t>(event.contact)];
    if (sticks && law.e_t == 0 && mode.lasting && mode.slip != 0 && varies_e_t(event.contact))
      none("contact " + name(event.contact) +
           " stops in an impact and slides from there on: restitution e_t of either sign gives it a slip of another "
           "sense");
    crossing.struck.push_back({event.contact, false, sense, sticks});
    crossing.plastic = crossing.plastic || event.kind == EventKind::accumulation;
    if (!before_.modes[static_cast<std::size_t>(event.contact)].lasting) crossing.guards.push_back(event.contact);
  }
  check_held(held);
  for (Struck& s : crossing.struck) s.plastic = crossing.plastic;
  for (std::size_t c = 0; c < after.modes.size() && begun_; ++c) {
    const auto contact = static_cast<int>(c);
    if (!before_.modes[c].lasting && after.modes[c].lasting && std::ranges::count(crossing.guards, contact) == 0)
      none("contact " + name(contact) + " is touched without a velocity (a graze)");
  }
  if (!crossing.struck.empty() && crossing.guards.empty())
    none("contact " + name(crossing.struck.front().contact) + ", which is closed, strikes: its normal turns");
}

/// Whether a struck contact has no slip after the impact, or the one that e_T wants.
bool MotionVariation::varies_e_t(int contact) const {
  return std::ranges::any_of(directions_, [&](const VariedDirection& d) {
    return std::ranges::any_of(d.change.laws, [&](const auto& law) { return law.contact == contact && law.e_t != 0; });
  });
}

bool MotionVariation::stops(int contact, const Arc& after) {
  const ContactLaw& law = system_.law(contact);
  const bool strikes = -base_.gap_rate(contact, now(), before_.q1, before_.v1) > kRestSpeed * law.unit;
  double slip = base_.slip(contact, now(), before_.q1, after.v0);
  if (strikes) slip += law.e_t * base_.slip(contact, now(), before_.q1, before_.v1);
  return std::abs(slip) <= kStickSpeed * law.unit;
}

/// Friction that stops contacts must be able to hold them on both sides of a change.
void MotionVariation::check_held(const std::vector<HeldFriction>& held) {
  const auto at_bound = [](const HeldFriction& h) { return std::abs(h.tangent) >= (1 - kAtFrictionBound) * h.bound; };
  const auto first = std::ranges::find_if(held, at_bound);
  if (first == held.end()) return;
  const auto count = static_cast<Eigen::Index>(held.size());
  Eigen::MatrixXd acts(system_.dof(), count);
  Eigen::VectorXd bounds(count), tangents(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const HeldFriction& h = held[static_cast<std::size_t>(i)];
    acts.col(i) = base_.tangent_push(h.contact, now(), before_.q1);
    bounds[i] = h.bound, tangents[i] = h.tangent;
  }
  if (!share_friction(acts, bounds, tangents))
    none("contact " + name(first->contact) +
         " strikes, and its friction stops it with all that it has: it slides on one side of a change and sticks on "
         "the other");
}

/// Slip that ends; where there is none, and the accelerations jump, slip that begins.
void MotionVariation::slips(const Arc& after, Crossing& crossing) {
  const auto each_lasting = [&](auto&& act) {
    for (std::size_t c = 0; c < after.modes.size(); ++c)
      if (before_.modes[c].lasting && after.modes[c].lasting)
        act(static_cast<int>(c), before_.modes[c], after.modes[c]);
  };
  crossing.kind = Guard::slip;
  each_lasting([&](int contact, const ContactMode& was, const ContactMode& is) {
    if (was.slip != 0 && was.slip != is.slip && !begins_.of(contact)) crossing.guards.push_back(contact);
  });
  if (!crossing.guards.empty() || !jumps(after)) return;
  crossing.kind = Guard::room;
  base_.set_modes(before_.modes);
  each_lasting([&](int contact, const ContactMode& was, const ContactMode& is) {
    if (!was.sticks || is.slip == 0) return;
    const double tangent = base_.tangent_force(contact, just_before(), before_.q1, before_.v1);
    const int side = tangent > 0 ? 1 : -1;
    const double room = base_.room(contact, side, just_before(), before_.q1, before_.v1);
    if (std::abs(room) > kAtItsBound * std::abs(tangent)) return;  // it follows another one
    crossing.guards.push_back(contact), crossing.sides.push_back(side);
  });
}

/// At rest the accelerations are what rounding leaves of the forces.
bool MotionVariation::jumps(const Arc& after) {
  const double size = std::max(before_.a1.lpNorm<Eigen::Infinity>(), after.a0.lpNorm<Eigen::Infinity>());
  const double jump = (after.a0 - before_.a1).lpNorm<Eigen::Infinity>();
  if (jump <= kForcesJump * size) return false;
  return jump > kForcesRounded * base_.free_acceleration(now(), before_.q1, before_.v1);
}

void MotionVariation::cross(const Arc& after) {
  Crossing crossing;
  strikes(after, crossing);
  if (crossing.struck.empty()) slips(after, crossing);
  if (!crossing.guards.empty()) return reset(crossing, after);
  if (crossing.struck.empty() && jumps(after)) cross_knot(after);  // else f is continuous
}

/// A load that jumps at its breakpoint.
void MotionVariation::cross_knot(const Arc& after) {
  const double near = 16 * kRounding * (std::abs(now()) + before_.length);
  if (system_.next_breakpoint(now() - near) > now() + near)
    return none("the accelerations jump: the normal or the curvature of a contact changes");
  each([&](VariedDirection& d, auto /*dq*/, auto dv) {
    for (const auto& [t, by] : d.change.knots)
      if (std::abs(t - now()) <= near) {
        dv += by * (before_.a1 - after.a0);
        break;
      }
  });
}

/// Contacts that come within rounding of a touch in the arc and turn back: the integrator does not see them touch.
void MotionVariation::watch_grazes(const Arc& arc, std::span<const Event> at_end) {
  base_.set_modes(arc.modes);
  for (int c = 0; c < system_.contacts(); ++c) {
    if (arc.modes[static_cast<std::size_t>(c)].lasting) continue;
    const double end = arc.start + arc.length, h = arc.length, zero = kGrazedUnseen * base_.gap_scale(c, end, arc.q1);
    const double g0 = base_.gap(c, arc.start, arc.q0), g1 = base_.gap(c, end, arc.q1);
    const double r0 = base_.gap_rate(c, arc.start, arc.q0, arc.v0), r1 = base_.gap_rate(c, end, arc.q1, arc.v1);
    const double back = base_.gap_acceleration(c, end, arc.q1, arc.v1, arc.a1);
    if (g0 > zero && g1 <= zero && back > 0 && std::abs(r1) <= 2 * std::sqrt(2 * back * zero) && result_.none.empty() &&
        std::ranges::none_of(at_end, [c](const Event& event) { return event.contact == c; }))
      result_.none =
          "at t = " + detail::text_of(end) + " s contact " + name(c) + " comes within rounding of a touch (a graze)";
    if (!(g0 > zero && g1 > zero && r0 < 0 && r1 > 0)) continue;
    const auto slope = [&](double s) {  // of the cubic through both ends, times h
      return 6 * s * (s - 1) * (g0 - g1) + (3 * s - 1) * (s - 1) * h * r0 + s * (3 * s - 2) * h * r1;
    };
    double low = 0, high = 1;
    while (high - low > 1e-12) (slope((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
    const double s = low, t = arc.start + s * h;
    const double least = (1 + 2 * s) * (1 - s) * (1 - s) * g0 + s * (1 - s) * (1 - s) * h * r0 +
                         s * s * (3 - 2 * s) * g1 + s * s * (s - 1) * h * r1;
    if (!(least < kClose * h * (r1 - r0))) continue;
    Eigen::VectorXd q = arc.q0, v = arc.v0, a = arc.a0;
    if (!base_.move(arc.start, s * h, q, v) || !base_.accelerations(t, q, v, a)) continue;
    const double rate = base_.gap_rate(c, t, q, v), pulled = base_.gap_acceleration(c, t, q, v, a);
    if (!(pulled > 0) || base_.gap(c, t, q) - rate * rate / (2 * pulled) > zero) continue;
    if (result_.none.empty())
      result_.none = "at t = " + detail::text_of(t - rate / pulled) + " s contact " + name(c) +
                     " comes within rounding of a touch (a graze)";
  }
}

/// (1) of motion_tangent.h.
void MotionVariation::reset(const Crossing& crossing, const Arc& after) {
  check_reset(crossing, after);
  std::vector<Struck> falls_back;  // where e = 0 and is varied: short flights, which end as the impact itself does
  for (const Struck& s : crossing.struck)
    if (const ContactMode& mode = after.modes[static_cast<std::size_t>(s.contact)];
        mode.lasting && system_.law(s.contact).e == 0) {
      falls_back.push_back(s);
      Struck& last = falls_back.back();
      last.plastic = true;
      if (mode.slip != 0) last.sticks = false, last.slides = mode.slip > 0 ? -1 : 1;  // as e_T has left it
    }
  const EventKind kind = crossing.kind != Guard::gap ? EventKind::slip
                         : crossing.plastic          ? EventKind::accumulation
                                                     : EventKind::impact;
  CrossedGuard crossed{now(), kind, crossing.guards.front(), 0, {}};
  const Eigen::VectorXd rate = rates(crossing);
  crossed.rate = rate[0];
  const double jump = std::max((after.v0 - before_.v1).lpNorm<Eigen::Infinity>(),
                               before_.a1.lpNorm<Eigen::Infinity>() + after.a0.lpNorm<Eigen::Infinity>());
  double most = 0;
  each([&](VariedDirection& d, auto dq, auto dv) {
    double guard = 0;
    const double moves = change_of_time(d, crossing, rate, dq, dv, guard);
    crossed.moves.push_back(moves);
    const double from = std::max({guard, dq.template lpNorm<Eigen::Infinity>(), dv.template lpNorm<Eigen::Infinity>()});
    const Eigen::VectorXd from_q = dq + moves * before_.v1, from_v = dv + moves * before_.a1;
    std::vector<double> missed;
    map(d, before_.q1, before_.v1, from_q, from_v, dq, dv,
        [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
          near.set_modes(before_.modes);
          if (!crossing.struck.empty()) missed.push_back(near.strike(crossing.struck, now(), q, v));
          if (!falls_back.empty()) near.strike(falls_back, now(), q, v);
          near.set_modes(after.modes);
          near.project(now(), q, v);
        });
    if (parts_struck(d, from_q, from_v, missed))
      none(names_[static_cast<std::size_t>(&d - directions_.data())] +
           " parts contacts that strike at once and stick (" + names_of(crossing.struck) +
           "): which of them slides is another matter on either side of the value");
    dq -= moves * after.v0, dv -= moves * after.a0;
    if (from > 0) most = std::max(most, std::abs(moves) * jump / from);
  });
  result_.guards.push_back(std::move(crossed));
  base_.set_modes(before_.modes);
  const bool nearly = std::abs(rate[0]) < kNearlyGrazes * least_rate(crossing, 0);
  if (nearly && most > kGrows && result_.warnings.size() < kMostWarnings)
    result_.warnings.push_back("at t = " + detail::text_of(now()) + " s contact " + name(crossing.guards.front()) +
                               (crossing.kind == Guard::gap    ? " is touched at a rate of "
                                : crossing.kind == Guard::slip ? " stops at a rate of "
                                                               : " begins to slip at a rate of ") +
                               detail::text_of(rate[0]) + ", nearly a graze: derivatives grow there by a factor of " +
                               detail::text_of(most) + ", and so do their errors");
  for (const Struck& s : crossing.struck) struck_at_[static_cast<std::size_t>(s.contact)] = now();
}

/// missed: [m/s] what nearby impacts leave of their rates, of contacts that depend on each other here; four of a
/// difference. What grows with the square of the change does not part them.
bool MotionVariation::parts_struck(const VariedDirection& d, const Eigen::VectorXd& dq, const Eigen::VectorXd& dv,
                                   std::span<const double> missed) const {
  constexpr double kParts = 1e-4, kOfSpeed = 1e-12;  // of the change; rounding
  double linear = 0;
  for (std::size_t k = 0; k + 4 <= missed.size(); k += 4) {
    const auto grows = [&](std::size_t near, std::size_t far) {
      linear = std::max(linear, std::abs(4 * missed[k + near] - missed[k + far]) / 2);
    };
    d.change.side != 0 ? grows(1, 2) : (grows(1, 0), grows(2, 3));
  }
  const double step = d.moved(dq, dv, before_.v1), speed = 1 + before_.v1.lpNorm<Eigen::Infinity>();
  return linear > kParts * step * std::max(1e-3, dv.lpNorm<Eigen::Infinity>()) + kOfSpeed * speed;
}

void MotionVariation::check_reset(const Crossing& crossing, const Arc& after) {
  if (crossing.struck.empty()) return;
  Eigen::VectorXd q = before_.q1, v = before_.v1;
  base_.set_modes(before_.modes);
  base_.strike(crossing.struck, now(), q, v);
  base_.set_modes(after.modes);
  base_.project(now(), q, v);
  const double off = (v - after.v0).lpNorm<Eigen::Infinity>() / (1 + v.lpNorm<Eigen::Infinity>());
  if (off <= kSameImpact) return;
  std::string names;
  for (const Struck& s : crossing.struck) names += (names.empty() ? "" : ", ") + name(s.contact);
  const std::string where =
      "at t = " + detail::text_of(now()) + " s, contact" + (crossing.struck.size() > 1 ? "s " : " ") + names + ": ";
  throw std::runtime_error(
      "derivatives of a motion: " + where +
      (crossing.plastic ? "series of impacts end there together with other impacts, one after the other: the end of "
                          "such series has no derivative here"
                        : "the impact is not one by Newton's law on all contacts at once: its velocities differ from "
                          "that by " +
                              detail::text_of(off)));
}

/// Of the guards; a graze has no derivative.
Eigen::VectorXd MotionVariation::rates(const Crossing& crossing) {
  const double t = now();
  Eigen::VectorXd rate(static_cast<Eigen::Index>(crossing.guards.size()));
  for (std::size_t i = 0; i < crossing.guards.size(); ++i) {
    const int contact = crossing.guards[i];
    double& one = rate[static_cast<Eigen::Index>(i)];
    base_.set_modes(before_.modes);
    if (crossing.kind == Guard::gap)
      one = base_.gap_rate(contact, t, before_.q1, before_.v1);
    else if (crossing.kind == Guard::slip)
      one = base_.slip_rate(contact, t, before_.q1, before_.v1, before_.a1);
    else
      one = base_.room_rate(contact, crossing.sides[i], t, before_.length, before_.q1, before_.v1, before_.a1);
    if (std::abs(one) > least_rate(crossing, i)) continue;
    none("contact " + name(contact) +
         (crossing.kind == Guard::gap    ? " is touched"
          : crossing.kind == Guard::slip ? " stops"
                                         : " begins to slip") +
         " at a rate of " + detail::text_of(one) + ": not transversal (a graze)");
    if (one == 0) one = 1;
  }
  return rate;
}

/// What rounding of the event's place leaves of a rate that is 0.
double MotionVariation::least_rate(const Crossing& crossing, std::size_t guard) {
  const int contact = crossing.guards[guard];
  const double size = before_.a1.lpNorm<Eigen::Infinity>();
  if (crossing.kind == Guard::slip) return kGrazingSlip * size;
  if (crossing.kind == Guard::room)
    return kGrazingForce * std::abs(base_.tangent_force(contact, now(), before_.q1, before_.v1));
  const double pulled = std::abs(base_.gap_acceleration(contact, now(), before_.q1, before_.v1, before_.a1));
  const double fast = before_.v1.lpNorm<Eigen::Infinity>();
  const double way = fast * (now() - struck_at_[static_cast<std::size_t>(contact)]);
  const double lost = kGrazed * base_.gap_scale(contact, now(), before_.q1) + 4 * options_.rtol * way;
  return std::sqrt(2 * pulled * lost) + 16 * kRounding * fast;
}

/// δt of (1); of several guards the mean, where they agree. change: the largest one of a guard.
double MotionVariation::change_of_time(VariedDirection& d, const Crossing& crossing, const Eigen::VectorXd& rate,
                                       const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, double& change) {
  const double t = now();
  double sum = 0, least = kInf, most = -kInf;
  for (std::size_t i = 0; i < crossing.guards.size(); ++i) {
    const int contact = crossing.guards[i];
    const auto value = [&](NearbyMotion& near, const Eigen::VectorXd& q, const Eigen::VectorXd& v) -> Eigen::VectorXd {
      near.set_modes(before_.modes);
      return Eigen::VectorXd::Constant(1, crossing.kind == Guard::gap ? near.gap(contact, t, q)
                                          : crossing.kind == Guard::slip
                                              ? near.slip(contact, t, q, v)
                                              : near.room(contact, crossing.sides[i], just_before(), q, v));
    };
    const double by = d.derivative(before_.q1, before_.v1, dq, dv, value)[0];
    const double moves = -by / rate[static_cast<Eigen::Index>(i)];
    change = std::max(change, std::abs(by));
    sum += moves, least = std::min(least, moves), most = std::max(most, moves);
  }
  const double size = std::max(std::abs(least), std::abs(most));
  const double way = crossing.kind == Guard::gap ? std::abs(rate[rate.size() - 1]) : 1;
  if (most - least > kStrikeTogether * size && (most - least) * way * d.moved(dq, dv, before_.v1) > 1e-12)
    none("contacts strike together that a parameter parts");
  return sum / static_cast<double>(crossing.guards.size());
}

}  // namespace orthant
