// Contacts that are closed at the start of a motion: which parameters open or close them, and which side the derivative
// is of (motion_tangent.h).
#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_variation.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kUnmoved = 1e-9;   // of a direction: its change of a gap
constexpr double kUnloaded = 1e-9;  // of the normal force: friction that holds against nothing
constexpr double kTilt = 1e-6;      // of gaps' changes: closer ones are equal
constexpr double kOverlaps = 1e-9;  // [m] and of the places: more than rounding
constexpr double kTouches = 1e-12;  // [m, m/s] and of the places: gaps and rates of contacts that touch
constexpr double kRounded = 1e-14;  // [m, m/s] of gaps and rates

/// A change along a direction that is no more than rounding.
double least_change(const VariedDirection& d, const Eigen::VectorXd& dq, const Eigen::VectorXd& dv) {
  const double size = std::max(dq.lpNorm<Eigen::Infinity>(), dv.lpNorm<Eigen::Infinity>());
  return kUnmoved * std::max(size, 1e-3) + (d.change.of_scene() ? kRounded / d.change.step : 0);
}

}  // namespace

/// Impacts at the start itself, and contacts that are closed there: what a change of their gaps and rates makes falls
/// back at once, by impulses along their pushes.
void MotionVariation::start(const Arc& first) {
  Crossing crossing;
  strikes(first, crossing);
  std::vector<Struck> closed;
  for (std::size_t c = 0; c < first.modes.size(); ++c) {
    const ContactMode& mode = first.modes[c];
    const auto contact = static_cast<int>(c);
    const auto same = [&](const Struck& s) { return s.contact == contact; };
    if (mode.lasting && std::none_of(crossing.struck.begin(), crossing.struck.end(), same))
      closed.push_back({contact, true, mode.slip > 0 ? -1 : mode.slip < 0 ? 1 : 0, mode.sticks});
  }
  std::vector<Struck> all = crossing.struck;
  all.insert(all.end(), closed.begin(), closed.end());
  if (all.empty()) return;
  for (const Struck& s : all)
    if (const double gap = base_.gap(s.contact, before_.start, before_.q1);
        gap < -kOverlaps * (1 + base_.gap_scale(s.contact, before_.start, before_.q1)))
      none("the contact " + name(s.contact) + " overlaps by " + detail::text_of(-gap) +
           " m: the overlap stays, which is not differentiated");
  note_one_sided(all, first);
  if (!closed.empty())
    each([&](VariedDirection& d, auto dq, auto dv) {
      const Eigen::VectorXd from_q = dq, from_v = dv;
      map(d, before_.q1, before_.v1, from_q, from_v, dq, dv,
          [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
            near.set_modes(before_.modes);
            near.touch(closed, before_.start, q);
            if (!crossing.struck.empty()) return;
            near.strike(closed, before_.start, q, v);
            near.set_modes(first.modes);
            near.project(before_.start, q, v);
          });
    });
  if (!crossing.struck.empty()) {
    crossing.struck = all;
    reset(crossing, first);
  }
  note_first_slips(first);
}

/// Each contact as it is, and how its gap would fall.
std::vector<MotionVariation::ClosedContact> MotionVariation::look_at(const std::vector<Struck>& closed,
                                                                     const Arc& first) {
  const double t = before_.start;
  const std::vector<ContactMode> open(first.modes.size());
  std::vector<ClosedContact> all;
  Eigen::VectorXd free(first.a0.size());
  for (const Struck& s : closed) {
    ClosedContact one{.contact = s, .begins = begins_from_rest(s.contact, first)};
    base_.set_modes(open);
    base_.accelerations(t, first.q0, first.v0, free);
    one.fall = base_.gap_acceleration(s.contact, t, first.q0, first.v0, free);
    const ContactMode& mode = first.modes[static_cast<std::size_t>(s.contact)];
    base_.set_modes(first.modes);
    one.grips = mode.lasting && mode.sticks &&
                std::abs(base_.tangent_force(s.contact, t, first.q0, first.v0)) >
                    kUnloaded * std::abs(base_.normal_force(s.contact, t, first.q0, first.v0));
    one.turns = base_.turns(s.contact, t, first.q0, first.v0);
    all.push_back(one);
  }
  return all;
}

/// Contacts that touch, and that `closed` relieve of their load.
std::vector<Struck> MotionVariation::relieved_by(const std::vector<Struck>& closed, const Arc& first) {
  const double t = before_.start;
  std::vector<Struck> relieved;
  for (int c = 0; c < system_.contacts(); ++c)
    if (std::ranges::none_of(closed, [c](const Struck& s) { return s.contact == c; }) &&
        std::abs(base_.gap(c, t, before_.q1)) <= kTouches * (1 + base_.gap_scale(c, t, before_.q1)) &&
        std::abs(base_.gap_rate(c, t, first.q0, first.v0)) <= kTouches * (1 + first.v0.lpNorm<Eigen::Infinity>()))
      relieved.push_back({c, false, 0, false});
  return relieved;
}

MotionVariation::StartChange MotionVariation::change_of_start(const VariedDirection& d, const Eigen::VectorXd& dq,
                                                              const Eigen::VectorXd& dv,
                                                              const std::vector<ClosedContact>& closed,
                                                              const std::vector<Struck>& relieved) {
  StartChange change;
  const double t = before_.start, least = least_change(d, dq, dv);
  std::vector<Struck> all;
  std::vector<double> gaps;                                          // their changes
  const auto changes_of = [&](const Struck& s) -> Eigen::Vector2d {  // of gap and rate
    const Eigen::Vector2d by = d.derivative(
        before_.q1, before_.v1, dq, dv, [&](NearbyMotion& near, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
          near.set_modes(before_.modes);
          return Eigen::Vector2d(near.gap(s.contact, t, q), s.plastic ? near.gap_rate(s.contact, t, q, v) : 0);
        });
    return (by.array().abs() > least).select(by, 0);
  };
  for (const ClosedContact& one : closed) {
    const int contact = one.contact.contact;
    const Eigen::Vector2d by = changes_of(one.contact);
    all.push_back(one.contact), gaps.push_back(by[0]);
    if (!by.isZero(0)) list(change.contacts, contact);
    if (by[1] != 0) {
      list(by[1] > 0 ? change.rising : change.falling, contact);
      change.begins = change.begins || one.begins;
    }
    if (by[0] == 0) continue;
    list(by[0] > 0 ? change.opened : change.sunk, contact);
    if (one.grips) list(change.gripped, contact);
    change.slides = change.slides || one.contact.slides != 0;
    change.turns = change.turns || one.turns;
  }
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const auto tilts = [&](const ClosedContact& other) {
      const auto j = static_cast<std::size_t>(&other - closed.data());
      const double one = gaps[i] * other.fall, two = gaps[j] * closed[i].fall;
      return touch_one_body(closed[i].contact.contact, other.contact.contact) &&
             std::abs(one - two) > kTilt * (std::abs(one) + std::abs(two));
    };
    if (closed[i].begins && std::ranges::any_of(closed, tilts)) list(change.tilted, closed[i].contact.contact);
  }
  for (const Struck& s : relieved) {
    all.push_back(s), gaps.push_back(changes_of(s)[0]);
    if (gaps.back() != 0) list(change.contacts, s.contact);
  }
  change.redundant = parts_redundant(all, gaps);
  return change;
}

/// Where there is no derivative, why; else which side it is of.
void MotionVariation::say(const std::string& parameter, const StartChange& change, bool damped) {
  const auto of_side = [](bool larger) { return std::string("of ") + (larger ? "larger" : "smaller") + " values"; };
  const auto warn = [&](const std::string& words) { result_.warnings.push_back(parameter + words); };
  const bool moves = !change.opened.empty() || !change.sunk.empty();
  const std::string closed = " opens or closes contacts that are closed at the start (" + change.contacts + "): ";
  if (change.redundant)
    none(parameter + " opens or closes contacts that depend on each other (" + change.contacts +
         ") so that not all of them stay closed: which ones do is another matter on either side of the value");
  else if (!change.opened.empty() && !change.sunk.empty())
    none(parameter + " opens " + change.opened + " and sinks " + change.sunk +
         ", which are closed at the start: one of them overlaps on either side of the value");
  else if (!change.gripped.empty() && change.slides)
    none(parameter + " opens contacts that slide, and " + change.gripped +
         ", which holds at the start: they have derivatives of different sides");
  else if (!change.tilted.empty())  // from rest, a fall of δ ends at speeds of the order √δ
    none(parameter + " opens or closes contacts of one body unequally, and " + change.tilted +
         " begins to slide at the start: the fall that closes them tilts the body and may turn its slip, so the "
         "motion changes by the square root of the change");
  else if (change.begins && !change.rising.empty() && !change.falling.empty())
    none(parameter + " lifts " + change.rising + " and presses " + change.falling +
         ", which begin to slide at the start: impacts without a slip stop one of them on either side of the value");
  else if (!change.gripped.empty())
    warn(" opens or closes contacts that hold at the start (" + change.gripped + "): the derivative is one-sided, " +
         of_side(change.opened.empty()) + ", where they stay closed; on the other side they fly and slip");
  else if (moves && damped)
    none(parameter + closed + "dampers act in the short flight that closes them again, which is not differentiated");
  else if (moves && change.turns)
    none(parameter + closed +
         "their directions turn in the short flight that closes them again, which is not "
         "differentiated");
  else if (moves || change.begins)
    warn(closed + "the derivative is one-sided, " + of_side(moves ? change.sunk.empty() : change.falling.empty()) +
         ", where a short flight closes them again");
  else if (!change.contacts.empty())
    warn(closed + "the derivative is one-sided, of the side that closes them again at once");
}

void MotionVariation::note_one_sided(const std::vector<Struck>& closed, const Arc& first) {
  const std::vector<ClosedContact> contacts = look_at(closed, first);
  const std::vector<Struck> relieved = relieved_by(closed, first);
  const bool damped = std::ranges::any_of(system_.scene().springs, [](const Spring& spring) {
    return std::visit([](const auto& s) { return s.damping != 0; }, spring);
  });
  each([&](VariedDirection& d, auto dq, auto dv) {
    say(names_[static_cast<std::size_t>(&d - directions_.data())], change_of_start(d, dq, dv, contacts, relieved),
        damped);
  });
}

/// No motion closes all gaps again.
bool MotionVariation::parts_redundant(const std::vector<Struck>& closed, const std::vector<double>& gaps) {
  const Eigen::Map<const Eigen::VectorXd> change(gaps.data(), std::ssize(gaps));
  if (change.isZero(0) || gaps.size() < 2) return false;
  const Eigen::MatrixXd A = base_.coupling(closed, before_.start, before_.q1);
  const Eigen::VectorXd pushes = A.completeOrthogonalDecomposition().solve(change);
  return (A * pushes - change).lpNorm<Eigen::Infinity>() > kTilt * change.lpNorm<Eigen::Infinity>();
}

bool MotionVariation::touch_one_body(int one, int other) const {
  const auto a = bodies_of(system_, {}, one), b = bodies_of(system_, {}, other);
  const auto touches = [&](BodyId body) { return body >= 0 && (body == b.first || body == b.second); };
  return touches(a.first) || touches(a.second);
}

bool MotionVariation::begins_from_rest(int contact, const Arc& first) {
  const ContactMode& mode = first.modes[static_cast<std::size_t>(contact)];
  if (!mode.lasting || mode.slip == 0 || system_.law(contact).mu == 0) return false;
  base_.set_modes(first.modes);
  return std::abs(base_.slip(contact, first.start, first.q0, first.v0)) <= kStickSpeed * system_.law(contact).unit;
}

/// Contacts that begin to slide at the start, from rest: a slip in the other sense meets other friction.
void MotionVariation::note_first_slips(const Arc& first) {
  each([&](VariedDirection& d, auto dq, auto dv) {
    std::string with, against;
    for (std::size_t c = 0; c < first.modes.size(); ++c) {
      const auto contact = static_cast<int>(c);
      const ContactMode& mode = first.modes[c];
      if (!begins_from_rest(contact, first)) continue;
      const Eigen::VectorXd from_q = dq, from_v = dv;
      const double by =
          d.derivative(first.q0, first.v0, from_q, from_v,
                       [&](NearbyMotion& near, const Eigen::VectorXd& q, const Eigen::VectorXd& v) -> Eigen::VectorXd {
                         return Eigen::VectorXd::Constant(1, near.slip(contact, first.start, q, v));
                       })[0];
      if (std::abs(by) > least_change(d, from_q, from_v)) list(by * mode.slip > 0 ? with : against, contact);
    }
    const std::string& parameter = names_[static_cast<std::size_t>(&d - directions_.data())];
    if (!with.empty() && !against.empty())
      none(parameter + " pushes " + with + " on and " + against +
           " back, which begin to slide at the start: on either side of the value one of them turns");
    else if (!with.empty() || !against.empty())
      result_.warnings.push_back(parameter + " changes the slip of contacts that begin to slide at the start (" + with +
                                 against + "): the derivative is one-sided, of " +
                                 (against.empty() ? "larger" : "smaller") + " values");
  });
}

}  // namespace orthant
