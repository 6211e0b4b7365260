#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_variation.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kParameterStep = 1e-4;  // of the value
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
  base_.project(given.t, before_.q1, before_.v1);
  base_.accelerations(given.t, before_.q1, before_.v1, before_.a1);
  each([&](VariedDirection& d, auto dq, auto dv) {
    map(d, given.q, given.v, d.change.start_q, d.change.start_v, dq, dv,
        [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
          near.set_modes(open);
          near.project(given.t, q, v);
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
