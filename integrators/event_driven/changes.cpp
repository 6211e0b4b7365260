// Events of an EventDriven integrator: impacts, accumulations, crossings of crowds, changes of contact modes.
#include <orthant/core/support/options.h>
#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/step/no_solution_message.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kForceZero =
    1e-8;                          // of the largest force: contacts this near to opening or sliding off do so together
constexpr double kPressed = 1e-6;  // of the accelerations: a contact let go that comes back faster does not open
constexpr double kLongestCrossing = 1e-4;  // [s]
constexpr double kTilt = 1e-9;             // [m], times length_unit(): deeper overlaps are no rounding
constexpr double kWay = 1e-9;              // of the way since two contacts struck: nearer ones may be one event
constexpr double kNearlyRests =
    1e-7;                     // [m/s], times length_unit(): what a series of impacts leaves of a motion of 1 m/s
constexpr int kShares = 200;  // times that friction is shared again in a crowd, which count for no event

/// Whether none of all combinations of a few contacts solves the impact, not even a little slower, so that nothing
/// hangs on rounding: friction and restitution contradict each other. Impulses that lose all digits solve nothing.
bool contradictory(Lcp impact) {
  constexpr Index kFewRows = 12;
  constexpr double kSlack = 1e-8, kLost = 1e12;  // of the fastest rate; likewise, what one impulse does
  if (impact.size() == 0 || impact.size() > kFewRows || !finite(impact)) return false;
  const double fastest = impact.b.lpNorm<Eigen::Infinity>();
  impact.b += (impact.lo.array() == 0).select(kSlack * fastest, Vector::Zero(impact.size()));
  Vector diag;
  diagonal(impact.A, diag);
  const auto solves = [&](const Vector& z) { return (diag.array() * z.array()).abs().maxCoeff() <= kLost * fastest; };
  const SolutionSet set = enumerate_solutions(impact);
  return std::none_of(set.isolated.begin(), set.isolated.end(), solves) &&
         std::all_of(set.faces.begin(), set.faces.end(), [&](const SolutionFace& face) {
           return std::none_of(face.vertices.begin(), face.vertices.end(), solves);
         });
}

}  // namespace

/// At now_: impacts, then the modes; their events.
bool EventDriven::change_modes(Solver& solver, const std::optional<Sign>& event, StepReport& report) {
  const double t = start_ + elapsed_;
  if (++crowd_.instants > options_.max_events)
    return fail(report, Status::iteration_limit, "max_events are used up at t = " + detail::text_of(t));
  if (event && crowd_.standstill == 0 && shares_anew(*event)) {
    if (++crowd_.shared < kShares)
      crowd_.steps = std::max(0, crowd_.steps - 1);  // no event of a crowd, unless it goes on so
    return true;
  }
  no_answer_ = false;
  before_ = motion_.modes;
  std::fill(freed_.released.begin(), freed_.released.end(), false);
  std::fill(freed_.slides.begin(), freed_.slides.end(), 0.0);
  std::fill(freed_.held.begin(), freed_.held.end(), false);
  for (Bounces& b : bounces_) b.over = false;
  int struck = 0;
  // What would touch at once in exact arithmetic has come apart by the rounding of the steps since the last event, and
  // of the velocities that it left.
  const double roundings = 16 + 64.0 * flight_.steps, since = flight_.time;
  flight_.steps = 0, flight_.time = 0;
  const bool strikes = event && event->watch == Watch::gap;
  const double flight = strikes ? t - bounces_[at(event->contact)].last : kInf;  // of the contact that strikes
  for (int c = 0; c < system_.contacts(); ++c) {
    const ContactMode& mode = motion_.modes[at(c)];
    const bool hit = strikes && event->contact == c;
    const double fast = now_.w.gap_rate_scale[c], way = fast * std::min(flight, t - bounces_[at(c)].last);
    strike_.tie[at(c)] = roundings * gap_zero(c) + std::min(options_.touching, kWay * way) + since * kSame * fast;
    strike_.touching[at(c)] = hit || mode.lasting || now_.w.gap[c] <= strike_.tie[at(c)];
    if (strike_.touching[at(c)] && !mode.lasting && (hit ? turns_back(c) : immobile(c)))
      strike_.touching[at(c)] = false;
    if (!strike_.touching[at(c)] || mode.lasting || now_.w.gap_rate[c] >= -speed_zero(now_.w.gap_rate_scale[c]))
      continue;
    ++struck;
    note_bounce(c);
    const Bounces& b = bounces_[at(c)];
    if (b.accumulates() && b.interval > kInstant * kRounding * std::abs(t)) crowd_.steps = 0;  // a series has an end
  }
  if (struck > 1) close_together();
  if (struck > 0) {
    const bool plastic = accumulates();
    if (!impact(solver, plastic, report)) return false;
    if (plastic && strikes_after_series() && !impact(solver, false, report)) return false;
  }
  return settle(solver, event, struck > 0, report);
}

/// Contacts that strike together get the gap 0: a tilt that rounding made would grow from impact to impact.
void EventDriven::close_together() {
  for (std::size_t c = 0; c < strike_.touching.size(); ++c)
    motion_.modes[c].lasting =
        strike_.touching[c] && now_.w.gap[static_cast<Index>(c)] > -kTilt * system_.length_unit();
  motion_.modes_changed();
  stage_.q = now_.q, stage_.v = now_.v;
  if (motion_.project(start_ + elapsed_, stage_.q, stage_.v).joint < kInf) now_.q = stage_.q;
  motion_.modes = before_;
  motion_.modes_changed();
}

bool EventDriven::impact(Solver& solver, bool plastic, StepReport& report) {
  Terms& terms = motion_.terms();
  if (!motion_.accelerations(start_ + elapsed_, now_.q, now_.v, now_.a))
    return fail(report, Status::numerical_error, "no accelerations at an impact");
  strike_.contacts.clear();
  for (int c = 0; c < system_.contacts(); ++c)
    if (plastic ? bounces_[at(c)].over || motion_.modes[at(c)].lasting : strike_.touching[at(c)])
      strike_.contacts.push_back(c);
  evaluate_closed(system_, strike_.contacts, terms);
  // Residues of earlier contacts (1e-300 has been seen) would only trouble the solvers.
  now_.v = (now_.v.array().abs() < 1e-20 * now_.v.lpNorm<Eigen::Infinity>()).select(0, now_.v);
  newtons_law(system_.laws(), terms, now_.v, targets_);
  restrict_to_strikes(targets_);
  strike_.v_before = now_.v;
  shown_ = &impact_.formulation();
  impact_.anchor(start_ + elapsed_, now_.q), formulation_.anchor(start_ + elapsed_, now_.q);
  const bool in_turn = plastic && ends_in_turn(start_ + elapsed_, bounces_, motion_.modes, strike_.in_turn);
  if (in_turn)
    no_answer_ = !impact_.strike_in_turn(terms, motion_.basic(), strike_.in_turn, now_.v, solver, report);
  else if (!plastic)
    no_answer_ = !impact_.strike(terms, motion_.basic(), strike_.v_before, targets_, now_.v, solver, report);
  if (no_answer_) return fail(report, report.status, impact_.why());
  if (in_turn) newtons_law(system_.laws(), terms, now_.v, targets_), restrict_to_strikes(targets_);
  if (plastic)
    for (RateTarget& target : targets_) target.normal = 0;
  formulation_.formulate(terms, motion_.basic(), targets_, now_.v, none_);
  shown_ = &formulation_;
  no_answer_ = !formulation_.solve(solver, report);
  if (no_answer_) {
    const bool none = contradictory(formulation_.problem());
    return fail(report, none ? Status::infeasible : report.status,
                none ? why_no_impact(system_, terms, formulation_.contradiction()) : "the impact was not solved");
  }
  formulation_.advance(now_.v, strike_.impulses);
  if (in_turn || !plastic) impact_.add_to(strike_.impulses);
  if (meter_) add_work(meter_->over_impact(terms, strike_.v_before, now_.v, strike_.impulses));
  const double t = start_ + elapsed_;
  report.note_rise(energy_rise(system_, terms, targets_, now_.v, strike_.impulses), t);
  for (const ClosedContact& closed : terms.closed) {
    const int c = closed.contact;
    const Impulse& hit = strike_.impulses[at(c)];
    impulses_[at(c)].normal += hit.normal, impulses_[at(c)].tangent += hit.tangent;
    if (plastic && bounces_[at(c)].over)
      events_.push_back({t + bounces_[at(c)].rest, EventKind::accumulation, c, hit.normal, hit.tangent});
    else if (hit.normal > 0)
      events_.push_back({t, EventKind::impact, c, hit.normal, hit.tangent});
  }
  return true;
}

/// A step of first order next to a singular pose errs in the speed by much more than in the path. Without contacts the
/// energy of the state `before` and the work since tell the speed. False: no accelerations at it.
bool EventDriven::keep_energy(const State& before, double work) {
  constexpr double kLittle = 0.01;  // of the kinetic energy: more is no error of a step
  const auto& pushes = stepping_.impulses();
  if (!conservative_ || std::ranges::any_of(pushes, [](const Impulse& push) { return push.normal != 0; })) return true;
  const double kinetic = now_.v.dot(system_.mass().cwiseProduct(now_.v)) / 2;
  crossing_.state.t = start_ + elapsed_, crossing_.state.q = now_.q, crossing_.state.v = now_.v;
  const double missing = energy(system_, before) + work - energy(system_, crossing_.state);
  if (!(std::abs(missing) <= kLittle * kinetic) || missing == 0) return true;
  now_.v *= std::sqrt(1 + missing / kinetic);
  return observe(now_, start_ + elapsed_);
}

/// Where events have no end, or an instant no answer that could be computed: a step of Moreau–Jean's method. What it
/// leaves no faster than it falls within the step lasts. Where that does not help either the next one is twice as long.
bool EventDriven::cross(Solver& solver, double end, StepReport& report) {
  if (!crossing_.goes_on)
    crossing_.status = report.status, crossing_.why = why_, crossing_.smooth = why_.starts_with(kSingularPose);
  const auto give_up = [&] { return crossing_.goes_on = false, fail(report, crossing_.status, crossing_.why); };
  for (bool calm = false; !calm;) {
    if (stopped(report)) return false;
    crossing_.step = elapsed_ - crossing_.end < kSoon * crossing_.step ? std::min(2 * crossing_.step, kLongestCrossing)
                                                                       : options_.crossing;
    const double shortest = kInstant * kRounding * (std::abs(start_) + elapsed_);
    const double safe = std::max(sweep_.stride(now_.q, now_.v, now_.w.gap), shortest);
    const double s = std::min({crossing_.step, safe, end - elapsed_});
    if (!(s > 0)) {
      if (!options_.go_on) return give_up();
      break;  // the modes are decided where the next call begins
    }
    crossing_.state.t = start_ + elapsed_, crossing_.state.q = now_.q, crossing_.state.v = now_.v;
    const State before = crossing_.state;
    const StepReport step = stepping_.step(s, solver, crossing_.state);
    report.lcp_solves += step.lcp_solves, report.lcp_iterations += step.lcp_iterations;
    report.plastic += step.plastic;
    if (step.status != Status::solved) return give_up();
    if (step.passage.width > 0) {
      report.passage = step.passage;
      return fail(report, Status::numerical_error,
                  "a crowd of events cannot be crossed at t = " + detail::text_of(start_ + elapsed_) +
                      ": bodies would pass through each other in the shortest step");
    }
    if (!leaves_room(crossing_.state)) return fail(report, Status::infeasible, "contacts and drives leave no motion");
    ++report.accepted, ++report.crossings;
    const double worked = work_;
    if (meter_) add_work(meter_->over_step(before, crossing_.state, stepping_.impulses(), frictions_, {}));
    report.error_estimate += s * (crossing_.state.v - now_.v - s * now_.a).lpNorm<Eigen::Infinity>();
    now_.q = crossing_.state.q, now_.v = crossing_.state.v;
    elapsed_ = s < end - elapsed_ ? elapsed_ + s : end;
    crossing_.end = elapsed_, crowd_.standstill = crowd_.steps = crowd_.shared = flight_.steps = 0, flight_.time = 0;
    std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
    motion_.modes_changed();
    if (!observe(now_, start_ + elapsed_)) return fail(report, Status::numerical_error, "no accelerations");
    const double slow = s * largest_of_all(now_.a, system_.length_unit());
    bool any = false;
    for (int c = 0; c < system_.contacts(); ++c) {
      const Impulse& push = stepping_.impulses()[at(c)];
      impulses_[at(c)].normal += push.normal, impulses_[at(c)].tangent += push.tangent;
      bounces_[at(c)] = {};
      strike_.touching[at(c)] = bounces_[at(c)].over = push.normal > 0 && now_.w.gap_rate[c] <= slow;
      any = any || bounces_[at(c)].over;
    }
    std::fill(freed_.released.begin(), freed_.released.end(), false);
    std::fill(freed_.slides.begin(), freed_.slides.end(), 0.0);
    std::fill(freed_.held.begin(), freed_.held.end(), false);
    no_answer_ = false;
    calm = (!any || impact(solver, true, report)) && settle(solver, {}, true, report);
    if (calm && !any && crossing_.smooth && !keep_energy(before, work_ - worked))
      return fail(report, Status::numerical_error, "no accelerations after a singular pose");
    crossing_.state.t = start_ + elapsed_, crossing_.state.q = now_.q, crossing_.state.v = now_.v;
    report.note_rise(gain_of_crossing(system_, before, crossing_.state, work_ - worked), crossing_.state.t);
    if (!calm && !no_answer_ && !options_.go_on) return false;
    crossing_.goes_on = striding_ && !calm;
    if (crossing_.goes_on) break;  // the next stride crosses on
  }
  why_.clear(), report.status = Status::solved;
  return true;
}

/// Whether positions near x keep the gaps open: a step that overlaps goes on through a jam, and so past the end of the
/// motion.
bool EventDriven::leaves_room(const State& x) {
  if (!system_.driven()) return true;
  if (!jam_search_) jam_search_ = std::make_unique<JamSearch>(system_);
  stage_.q = x.q;
  return jam_search_->fits(x.t, stage_.q);
}

/// A body that all but rests has no slip for forces to follow: without drives it is at rest. False: it was, or moves.
bool EventDriven::come_to_rest() {
  const double fastest = largest_of_all(now_.v, system_.length_unit());
  if (fastest == 0 || fastest > kNearlyRests * system_.length_unit() || system_.driven()) return false;
  now_.v.setZero();
  return true;
}

/// The modes at now_, after an impact or an event of the motion.
bool EventDriven::settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report) {
  const double t = start_ + elapsed_;
  if (event && !struck) let_go(*event);
  const auto open_all = [&] {
    std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
    motion_.modes_changed();
    return observe(now_, t);
  };
  for (bool again = true; again;) {
    if (!open_all()) return fail(report, Status::numerical_error, "no accelerations after an event");
    gather_candidates();
    const Status status = transition_.decide(motion_, solver, report);
    if (status != Status::solved) {
      shown_ = nullptr;
      if (status == Status::infeasible && come_to_rest()) continue;
      no_answer_ = transition_.undecided();
      return fail(report, status, transition_.why() + ", at t = " + detail::text_of(t));
    }
    residual_ = motion_.project(t, now_.q, now_.v);
    if (!observe(now_, t) ||
        (leaves_cones() && transition_.find_forces_in_cones(motion_, solver, report) && !observe(now_, t)))
      return fail(report, Status::numerical_error, "no accelerations after an event");
    again = false;
    for (int c = 0; c < system_.contacts(); ++c)
      if (freed_.released[at(c)] &&
          now_.w.gap_acceleration[c] < -kPressed * largest_of_all(now_.a, system_.length_unit()))
        freed_.released[at(c)] = false, again = true;  // pressed back by what else changes here
      else if (freed_.held[at(c)] && freed_.slides[at(c)] * now_.w.slip_acceleration[c] <
                                         -kPressed * largest_of_all(now_.a, system_.length_unit()))
        freed_.held[at(c)] = false, freed_.slides[at(c)] = 0, again = true;
  }
  load_ = 0, scale_.noise.setZero(), flow_.forget_noise();
  note_changes(event.has_value() && !struck);
  return true;
}

/// Whether forces at now_, which are not unique, are shared such that a contact would open or slide by that alone.
bool EventDriven::leaves_cones() const {
  if (!motion_.redundant()) return false;
  const double zero = kForceZero * now_.w.normal.lpNorm<Eigen::Infinity>();
  return std::ranges::any_of(motion_.lasting(), [&](int c) {
    return now_.w.normal[c] < -zero || (motion_.modes[at(c)].sticks && room(c) < -zero);
  });
}

/// Contacts that share a force do so in the proportion of the normal forces when their modes were decided. One that
/// comes to the bound of friction by that alone sticks on when it is shared as the normal forces are now.
bool EventDriven::shares_anew(const Sign& event) {
  if (event.watch != Watch::cone_up && event.watch != Watch::cone_down) return false;
  if (motion_.knows_forces()) return false;
  motion_.share_anew(now_.w);
  return observe(now_, start_ + elapsed_) && room(event.contact) > slack(event);
}

/// What is "at the same time" in forces [N]. When events repeat at one time it is no better known than that.
double EventDriven::force_zero() const { return kForceZero * (1 + 1e3 * crowd_.standstill) * load_; }

double EventDriven::room(int contact) const {
  return static_mu(system_.law(contact)) * now_.w.normal[contact] - std::abs(now_.w.tangent[contact]);
}

/// Which contacts open (freed_.released) or slide off (freed_.slides) because their force has come to its end.
void EventDriven::let_go(const Sign& event) {
  if (event.watch == Watch::gap || event.watch == Watch::slip || event.watch == Watch::approach) return;
  const Watched& w = now_.w;
  const double zero = force_zero();
  for (const int c : motion_.lasting()) {
    if (event.watch == Watch::force) {
      freed_.released[at(c)] = c == event.contact || w.normal[c] <= zero;
    } else if (before_[at(c)].slip != 0 && std::abs(w.slip[c]) <= speed_zero(w.slip_scale[c])) {
      freed_.held[at(c)] = true,
      freed_.slides[at(c)] = before_[at(c)].slip;  // at its bound while others hold it: let it be
    } else if (before_[at(c)].sticks) {
      if (c == event.contact || room(c) <= zero) freed_.slides[at(c)] = w.tangent[c] > 0 ? -1 : 1;
    }
  }
}

/// Contacts that touch and neither separate nor were let go.
void EventDriven::gather_candidates() {
  transition_.candidates.clear();
  const Watched& w = now_.w;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (!strike_.touching[at(c)] || freed_.released[at(c)]) continue;
    if (w.gap_rate[c] > speed_zero(w.gap_rate_scale[c]) && !bounces_[at(c)].over) continue;
    double slip = 0;
    if (system_.law(c).frictional())
      slip = std::abs(w.slip[c]) <= speed_zero(w.slip_scale[c]) ? freed_.slides[at(c)] : w.slip[c] > 0 ? 1 : -1;
    transition_.candidates.push_back({c, slip});
  }
}

void EventDriven::note_changes(bool touched) {
  for (int c = 0; c < system_.contacts(); ++c) {
    const ContactMode &old = before_[at(c)], &mode = motion_.modes[at(c)];
    if (old == mode) continue;
    const auto emit = [&](EventKind kind) { events_.push_back({start_ + elapsed_, kind, c, 0, 0}); };
    if (!mode.lasting)
      emit(EventKind::release);
    else if (old.lasting)
      emit(mode.sticks ? EventKind::stick : EventKind::slip);
    else if (touched)
      emit(EventKind::touch);
  }
}

}  // namespace orthant
