#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_variation.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kParameterStep = 1e-4;  // of the value
constexpr double kUnmoved = 1e-9;        // of a direction: its change of a gap
constexpr double kUnloaded = 1e-9;       // of the normal force: friction that holds against nothing
constexpr double kTilt = 1e-6;           // of gaps' changes: closer ones are equal
constexpr double kTouches = 1e-12;       // [m, m/s] and of the places: gaps and rates of contacts that touch
constexpr double kRounded = 1e-14;       // [m, m/s] of gaps and rates
constexpr double kOfRadius = 1e-2;       // of the least radius on which a contact's direction turns: differences
constexpr double kStepARadius = 2e-2;    // [1/m] of the value and that radius: a moved joint moves its contacts

/// [m] The least distance of two centres whose line is a contact's normal; infinity: there is none.
double least_radius(const Scene& scene) {
  double least = kInf;
  for (const Contact& contact : scene.contacts) {
    if (const auto* hole = std::get_if<Journal>(&contact)) least = std::min(least, hole->radius_b - hole->radius_a);
    if (const auto* discs = std::get_if<DiscDisc>(&contact)) least = std::min(least, discs->radius_a + discs->radius_b);
    if (const auto* disc = std::get_if<DiscPolygon>(&contact)) least = std::min(least, disc->radius);
  }
  return least;
}

std::vector<ParameterChange> changes_of(const std::vector<RunParameter>& parameters, const System& system,
                                        double duration) {
  std::vector<ParameterChange> changes;
  const double step = std::min(kParameterStep, kStepARadius * least_radius(system.scene()));
  for (const RunParameter& parameter : parameters)
    changes.push_back(orthant::changes_of(parameter, system, duration, step));
  return changes;
}

}  // namespace

MotionVariation::MotionVariation(const System& system, const std::vector<RunParameter>& parameters, double duration,
                                 const EventDrivenOptions& options, MotionTangent& result)
    : MotionVariation(system, parameters, changes_of(parameters, system, duration), options, result) {}

MotionVariation::MotionVariation(const System& system, const std::vector<RunParameter>& parameters,
                                 std::vector<ParameterChange> changes, const EventDrivenOptions& options,
                                 MotionTangent& result)
    : system_(system),
      options_(options),
      base_(system),
      begins_(system, base_, begun_frictions(changes, system)),
      result_(result) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const double radius = least_radius(system.scene());
  result.warnings = one_sided_in_words(parameters, changes);
  result.q.setZero(system.dof(), count), result.v.setZero(system.dof(), count);
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    VariedDirection direction{std::move(changes[j]), &base_, {}};
    direction.way = std::min(direction.way, kOfRadius * radius);
    direction.far = std::min(direction.far, kOfRadius * radius);
    if (direction.change.moves_drive)
      throw std::invalid_argument("derivative with respect to " + parameters[j].name +
                                  ": times of a drive's table have none by event-driven: must be moreau-jean");
    for (std::size_t k = 0; k < 4 && direction.change.of_scene(); ++k)
      direction.near[k] = std::make_unique<NearbyMotion>(*direction.change.at[k]);
    directions_.push_back(std::move(direction));
    names_.push_back(parameters[j].name);
  }
}

void MotionVariation::begin(const State& given) {
  const std::vector<ContactMode> open(static_cast<std::size_t>(system_.contacts()));
  struck_at_.assign(open.size(), given.t);
  before_.start = given.t, before_.length = 0, before_.modes = open;
  before_.q1 = given.q, before_.v1 = given.v, before_.a1.setZero(given.v.size());
  base_.set_modes(open);
  base_.close(given.t, before_.q1, before_.v1);
  base_.accelerations(given.t, before_.q1, before_.v1, before_.a1);
  each([&](VariedDirection& d, auto dq, auto dv) {
    map(d, given.q, given.v, d.change.start_q, d.change.start_v, dq, dv,
        [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
          near.set_modes(open);
          near.close(given.t, q, v);
        });
  });
}

void MotionVariation::pass(const Arc& arc, std::span<const Event> events) {
  std::vector<Event> after;
  if (arc.length > 0) {
    for (const Event& event : events) (!begun_ && event.t <= arc.start ? events_ : after).push_back(event);
    const std::vector<Arc>& pieces = begins_.pieces(arc, at_rest_);
    begun_ ? cross(pieces.front()) : start(pieces.front());
    begun_ = true;
    watch_grazes(arc, after);
    for (const Arc& piece : pieces) follow(piece);
    for (const int contact : at_rest_)
      none("contact " + name(contact) + " rests without a slip: the friction that begins there has no sense");
    if (!result_.q.allFinite() || !result_.v.allFinite())
      throw std::runtime_error("derivatives of a motion: before t = " + detail::text_of(arc.start + arc.length) +
                               " s they exceed the range of numbers: the motion is so unstable that they have no "
                               "meaning, or the duration is too long for them");
    before_ = pieces.back();
    events_ = std::move(after);
  } else {
    events_.insert(events_.end(), events.begin(), events.end());
  }
}

void MotionVariation::follow(const Arc& arc) {
  each([&](VariedDirection& d, auto dq, auto dv) {
    const Eigen::VectorXd from_q = dq, from_v = dv;
    map(d, arc.q0, arc.v0, from_q, from_v, dq, dv, [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
      near.set_modes(arc.modes);
      if (!near.move(arc.start, arc.length, q, v)) throw std::runtime_error("derivatives of a motion: not finite");
    });
  });
}

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

/// Of contacts that are closed at the start: which parameters open or close them, and which side the derivative is of.
void MotionVariation::note_one_sided(const std::vector<Struck>& closed, const Arc& first) {
  const double t = before_.start;
  std::vector<char> grips, from_rest;  // holds against a force; begins to slide
  const bool damped = std::ranges::any_of(system_.scene().springs, [](const Spring& spring) {
    return std::visit([](const auto& s) { return s.damping != 0; }, spring);
  });
  const std::vector<ContactMode> open(first.modes.size());
  std::vector<double> falls;  // [m/s²] of the gaps, all of them open
  Eigen::VectorXd free(first.a0.size());
  for (const Struck& s : closed) {
    base_.set_modes(open);
    base_.accelerations(t, first.q0, first.v0, free);
    falls.push_back(base_.gap_acceleration(s.contact, t, first.q0, first.v0, free));
    const ContactMode& mode = first.modes[static_cast<std::size_t>(s.contact)];
    base_.set_modes(first.modes);
    grips.push_back(mode.lasting && mode.sticks &&
                    std::abs(base_.tangent_force(s.contact, t, first.q0, first.v0)) >
                        kUnloaded * std::abs(base_.normal_force(s.contact, t, first.q0, first.v0)));
    from_rest.push_back(begins_from_rest(s.contact, first));
  }
  std::vector<Struck> touching = closed;  // and those that others relieve of their load
  for (int c = 0; c < system_.contacts(); ++c)
    if (std::ranges::none_of(closed, [c](const Struck& s) { return s.contact == c; }) &&
        std::abs(base_.gap(c, t, before_.q1)) <= kTouches * (1 + base_.gap_scale(c, t, before_.q1)) &&
        std::abs(base_.gap_rate(c, t, first.q0, first.v0)) <= kTouches * (1 + first.v0.lpNorm<Eigen::Infinity>()))
      touching.push_back({c, false, 0, false});
  each([&](VariedDirection& d, auto dq, auto dv) {
    std::string contacts, opened, sunk, gripped, rising, falling, tilted;
    bool slide = false, rest = false;
    std::vector<double> gaps;  // their changes
    const Eigen::VectorXd from_q = dq, from_v = dv;
    const double size = std::max(from_q.lpNorm<Eigen::Infinity>(), from_v.lpNorm<Eigen::Infinity>());
    const double least = kUnmoved * std::max(size, 1e-3) + (d.change.of_scene() ? kRounded / d.change.step : 0);
    const auto changes_of = [&](const Struck& s) {
      return d.derivative(before_.q1, before_.v1, from_q, from_v,
                          [&](NearbyMotion& near, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
                            near.set_modes(before_.modes);
                            return Eigen::Vector2d(near.gap(s.contact, t, q),
                                                   s.plastic ? near.gap_rate(s.contact, t, q, v) : 0);
                          });
    };
    for (std::size_t i = 0; i < closed.size(); ++i) {
      const Struck& s = closed[i];
      const Eigen::VectorXd changes = changes_of(s);
      gaps.push_back(std::abs(changes[0]) > least ? changes[0] : 0);
      if (changes.lpNorm<Eigen::Infinity>() > least) list(contacts, s.contact);
      if (std::abs(changes[1]) > least) {
        list(changes[1] > 0 ? rising : falling, s.contact);
        rest = rest || from_rest[i] != 0;
      }
      if (std::abs(changes[0]) <= least) continue;
      list(changes[0] > 0 ? opened : sunk, s.contact);
      if (grips[i] != 0) list(gripped, s.contact);
      slide = slide || s.slides != 0;
    }
    for (std::size_t i = 0; i < closed.size(); ++i) {
      const auto apart = [&](const Struck& other) {
        const auto j = static_cast<std::size_t>(&other - closed.data());
        return touch_one_body(closed[i].contact, other.contact) &&
               std::abs(gaps[i] * falls[j] - gaps[j] * falls[i]) >
                   kTilt * (std::abs(gaps[i] * falls[j]) + std::abs(gaps[j] * falls[i]));
      };
      if (from_rest[i] != 0 && std::ranges::any_of(closed, apart)) list(tilted, closed[i].contact);
    }
    for (std::size_t i = closed.size(); i < touching.size(); ++i) {
      const double change = changes_of(touching[i])[0];
      gaps.push_back(std::abs(change) > least ? change : 0);
      if (gaps.back() != 0) list(contacts, touching[i].contact);
    }
    const std::string& parameter = names_[static_cast<std::size_t>(&d - directions_.data())];
    const auto of_side = [](bool larger) { return std::string("of ") + (larger ? "larger" : "smaller") + " values"; };
    if (parts_redundant(touching, gaps))
      none(parameter + " opens or closes contacts that depend on each other (" + contacts +
           ") so that not all of them stay closed: which ones do is another matter on either side of the value");
    else if (!opened.empty() && !sunk.empty())
      none(parameter + " opens " + opened + " and sinks " + sunk +
           ", which are closed at the start: one of them overlaps on either side of the value");
    else if (!gripped.empty() && slide)
      none(parameter + " opens contacts that slide, and " + gripped +
           ", which holds at the start: they have derivatives of different sides");
    else if (!tilted.empty())  // from rest, a fall of δ ends at speeds of the order √δ
      none(parameter + " opens or closes contacts of one body unequally, and " + tilted +
           " begins to slide at the start: the fall that closes them tilts the body and may turn its slip, so the "
           "motion changes by the square root of the change");
    else if (rest && !rising.empty() && !falling.empty())
      none(parameter + " lifts " + rising + " and presses " + falling +
           ", which begin to slide at the start: impacts without a slip stop one of them on either side of the value");
    else if (!gripped.empty())
      result_.warnings.push_back(parameter + " opens or closes contacts that hold at the start (" + gripped +
                                 "): the derivative is one-sided, " + of_side(opened.empty()) +
                                 ", where they stay closed; on the other side they fly and slip");
    else if ((!opened.empty() || !sunk.empty()) && damped)
      none(parameter + " opens or closes contacts that are closed at the start (" + contacts +
           "): dampers act in the short flight that closes them again, which is not differentiated");
    else if (!opened.empty() || !sunk.empty() || rest)
      result_.warnings.push_back(parameter + " opens or closes contacts that are closed at the start (" + contacts +
                                 "): the derivative is one-sided, " +
                                 of_side(opened.empty() && sunk.empty() ? falling.empty() : sunk.empty()) +
                                 ", where a short flight closes them again");
    else if (!contacts.empty())
      result_.warnings.push_back(parameter + " opens or closes contacts that are closed at the start (" + contacts +
                                 "): the derivative is one-sided, of the side that closes them again at once");
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
      const double size = std::max(dq.template lpNorm<Eigen::Infinity>(), dv.template lpNorm<Eigen::Infinity>());
      const double rounding = d.change.of_scene() ? kRounded / d.change.step : 0;
      if (std::abs(by) > kUnmoved * std::max(size, 1e-3) + rounding) list(by * mode.slip > 0 ? with : against, contact);
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

void MotionVariation::list(std::string& names, int contact) const {
  names += (names.empty() ? "" : ", ") + name(contact);
}

std::string MotionVariation::names_of(const std::vector<Struck>& contacts) const {
  std::string names;
  for (const Struck& s : contacts) list(names, s.contact);
  return names;
}

void MotionVariation::none(const std::string& why) {
  if (result_.none.empty()) result_.none = "at t = " + detail::text_of(now()) + " s " + why;
}

std::string MotionVariation::name(int contact) const {
  return std::visit([](const auto& c) { return "'" + c.name + "'"; },
                    system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

}  // namespace orthant
