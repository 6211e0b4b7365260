#include <orthant/integrators/between_events/listed_contacts.h>

#include <algorithm>

namespace orthant {
namespace {

/// Dry friction as a contact, see the header. Its rows act on three bodies.
struct PressedFriction {
  std::string name;
  Coordinate of;
  BodyId pressed = 0;
  ContactLaw law;

  double gap(const Kinematics& k) const { return k.at(pressed).x.y(); }
  ContactRows rows(const Kinematics& k) const {
    const Row tangent = of.row(k);
    const BodyId beside = tangent.a >= 0 ? tangent.a : tangent.b;  // with no part in it: both rows are of one island
    return {{pressed, beside, {0, 1, 0}, {}}, tangent};
  }
  ContactBias bias(const Kinematics& k) const { return {0, of.bias(k)}; }
  std::string wrong(const Kinematics& /*start*/) const { return {}; }
};

template <class List> std::string free_name(const List& list, std::string name) {
  const auto name_of = [](const auto& x) -> const std::string& {
    if constexpr (requires { x.index(); })
      return std::visit([](const auto& each) -> const std::string& { return each.name; }, x);
    else
      return x.name;
  };
  while (std::any_of(list.begin(), list.end(), [&](const auto& x) { return name_of(x) == name; })) name += "_";
  return name;
}

int pairs_of(const Collision& c) {
  int count = 0;
  each_pair(c, [&](const Pair&) { ++count; });
  return count;
}

}  // namespace

ListedContacts::ListedContacts(const System& system, std::string_view scheme) : system_(system) {
  const Scene& scene = system.scene();
  int pairs = 0;
  first_pair_.push_back(system.listed());
  for (const Collision& c : scene.collisions) {
    const auto shapes = static_cast<double>(c.shapes.size());
    if (shapes * shapes <= 4.0 * kMostPairs) pairs += pairs_of(c);
    if (shapes * shapes > 4.0 * kMostPairs || pairs > kMostPairs)
      throw std::invalid_argument("integrator " + std::string(scheme) + ": collision \"" + c.name +
                                  "\" has more pairs than it can follow one by one: must be " +
                                  std::to_string(kMostPairs) +
                                  " in all, or the integrator one that searches, such as moreau-jean");
    first_pair_.push_back(first_pair_.back() + pairs_of(c));
  }
  Scene all = with_pairs_listed(scene);
  all.frictions.clear();
  for (const JointFriction& f : scene.frictions) {
    friction_of_.push_back(-1);
    if (f.bound <= 0) continue;
    friction_of_.back() = static_cast<int>(all.contacts.size());
    const BodyId pressed =
        all.body({.name = free_name(all.bodies, f.name + "_pressed"), .mass = f.bound, .inertia = f.bound});
    all.load({.name = free_name(all.loads, f.name + "_pressed"),
              .body = pressed,
              .force = -f.bound * (scene.gravity + Vector2d(0, 1))});
    all.contact(PressedFriction{free_name(all.contacts, f.name), f.of, pressed, {.mu = 1}});
  }
  inner_ = std::make_unique<System>(std::move(all));
  place_.resize(inner_->scene().contacts.size()), has_event_.resize(place_.size());
}

StepReport ListedContacts::step(Integrator& scheme, double h, Solver& solver, State& x, Records out) {
  const Index dof = system_.dof();
  if (state_.q.size() == 0 || state_.q.head(dof) != x.q || state_.v.head(dof) != x.v) {
    state_ = inner_->initial_state();
    state_.q.head(dof) = x.q, state_.v.head(dof) = x.v;
  }
  state_.t = x.t;
  const StepReport report = scheme.step(h, solver, state_);
  x.t = state_.t, x.q = state_.q.head(dof), x.v = state_.v.head(dof);

  number_pairs(scheme);
  out.gaps.setConstant(kInf);
  std::fill(out.impulses.begin(), out.impulses.end(), Impulse{});
  std::fill(out.frictions.begin(), out.frictions.end(), 0.0);
  for (std::size_t c = 0; c < place_.size(); ++c)
    if (place_[c] >= 0 && place_[c] < system_.contacts()) {
      out.gaps[place_[c]] = scheme.gaps()[static_cast<Index>(c)];
      out.impulses[static_cast<std::size_t>(place_[c])] = scheme.impulses()[c];
    }
  for (std::size_t i = 0; i < friction_of_.size(); ++i)
    if (friction_of_[i] >= 0) out.frictions[i] = scheme.impulses()[static_cast<std::size_t>(friction_of_[i])].tangent;
  out.events.clear();
  for (Event event : scheme.events()) {
    event.contact = place_[static_cast<std::size_t>(event.contact)];
    const bool friction = event.contact >= system_.contacts();
    if (event.contact >= 0 && (!friction || event.kind == EventKind::stick || event.kind == EventKind::slip))
      out.events.push_back(event);
  }
  return report;
}

void ListedContacts::refuse(const System& system, std::string_view scheme) {
  if (needed(system.scene()))
    throw std::invalid_argument("integrator " + std::string(scheme) +
                                ": takes listed contacts only; make_integrator() lists the pairs of collisions and " +
                                "replaces dry friction in joints");
}

StepReport ListedContactsIntegrator::step(double h, Solver& solver, State& x) {
  scheme_->set_budget(budget());
  const StepReport report = listed_.step(*scheme_, h, solver, x, {gaps_, impulses_, frictions_, events_});
  why_ = scheme_->why();
  return report;
}

/// Frictions come behind all contacts, for their events.
void ListedContacts::number_pairs(const Integrator& scheme) {
  std::fill(place_.begin(), place_.end(), -1);
  std::fill(has_event_.begin(), has_event_.end(), false);
  for (const Event& event : scheme.events()) has_event_[static_cast<std::size_t>(event.contact)] = true;
  for (int c = 0; c < system_.listed(); ++c) place_[static_cast<std::size_t>(c)] = c;
  for (std::size_t i = 0; i < friction_of_.size(); ++i)
    if (friction_of_[i] >= 0)
      place_[static_cast<std::size_t>(friction_of_[i])] = system_.contacts() + static_cast<int>(i);
  const auto counts = [&](int c) {
    return scheme.impulses()[static_cast<std::size_t>(c)].normal != 0 || has_event_[static_cast<std::size_t>(c)];
  };
  for (std::size_t k = 0; k + 1 < first_pair_.size(); ++k) {
    order_.clear();
    for (int c = first_pair_[k]; c < first_pair_[k + 1]; ++c) order_.push_back(c);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
      if (counts(a) != counts(b)) return counts(a);
      const double gap_a = scheme.gaps()[a], gap_b = scheme.gaps()[b];
      return gap_a != gap_b ? gap_a < gap_b : a < b;
    });
    const int begin = system_.listed() + system_.pairs()[k];
    const auto room = static_cast<std::size_t>(system_.pairs()[k + 1] - system_.pairs()[k]);
    for (std::size_t i = 0; i < std::min(room, order_.size()); ++i)
      place_[static_cast<std::size_t>(order_[i])] = begin + static_cast<int>(i);
  }
}

}  // namespace orthant
