// Events of a SpatialEventDriven integrator: impacts, accumulations, changes of contact modes, crossings of crowds.
#include <orthant/core/mechanics/spatial/friction_impulse.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>
#include <orthant/integrators/step/no_solution_message.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kTogether = 1e-8;      // of the largest force: contacts this near to their ends end together
constexpr double kComesBack = 1e-6;     // of the accelerations: a contact let go that comes back faster does not open
constexpr double kSmallTilt = 1e-9;     // [m] deeper overlaps are no rounding
constexpr double kLastCrossing = 1e-4;  // [s]

}  // namespace

void SpatialEventDriven::emit(double t, EventKind kind, int contact, const Impulse& impulse) {
  events_.push_back(
      {t, kind, contact, impulse.normal, size_of(along_unit_tangents(system_.law(contact), impulse.tangent))});
}

bool SpatialEventDriven::change_or_cross(Solver& solver, const std::optional<Sign>& event, StepReport& report) {
  return change(solver, event, report) || ((no_answer_ || options_.go_on) && cross(solver, report));
}

/// At now_: impacts, then the modes; their events.
bool SpatialEventDriven::change(Solver& solver, const std::optional<Sign>& event, StepReport& report) {
  no_answer_ = false;
  if (++crowd_.instants > options_.max_events)
    return give_up(Status::iteration_limit, "max_events are used up at t = " + detail::text_of(time_));
  if (event && event->watch != Watch::gap && crowd_.standstill == 0 && reshare(solver, *event, report)) return true;
  before_ = motion_.modes;
  std::fill(released_.begin(), released_.end(), false);
  std::fill(slides_.begin(), slides_.end(), Vector3d::Zero());
  for (DatedBounces& b : bounces_) b.over = false;
  int struck = 0;
  // What would touch at once in exact arithmetic has come apart by the rounding of the steps since the last event, and
  // of the velocities that it left.
  const double roundings = 256 + 64.0 * flight_.steps, since = flight_.time;
  flight_ = {};
  struck_scale_.setZero();
  for (int c = 0; c < system_.contacts(); ++c) {
    const auto i = static_cast<std::size_t>(c);
    const bool hit = event && event->watch == Watch::gap && event->contact == c, lasts = motion_.modes[i].lasting;
    tie_[i] = roundings * gap_zero(c) + options_.touching + since * kSame * now_.w.rate_scale[c];
    touching_[i] = hit || lasts || now_.w.gap[c] <= tie_[i];
    if (touching_[i] && !lasts && !hit && stands_still(c)) touching_[i] = false;
    if (!touching_[i] || lasts || now_.w.gap_rate[c] >= -rate_zero(c)) continue;
    ++struck;
    DatedBounces& b = bounces_[i];
    b.add(time_);
    const double height = -now_.w.gap_rate[c] * b.interval / 4;  // of the last one, a parabola of this speed
    b.height = height * b.ratio, b.rounding = height <= 16 * gap_zero(c);
    const double blur = 8 * gap_zero(c) / (-now_.w.gap_rate[c] * (1 - b.ratio) * (1 - b.ratio));  // of the end [s]
    if (!b.accumulates() || !(std::abs(time_ + b.rest - b.end) <= blur)) b.end = time_ + b.rest;
  }
  if (struck > 1) close_together();
  if (struck > 0) {
    struck_scale_ = now_.w.rate_scale;
    const bool plastic = accumulates();
    if (!impact(solver, plastic, report)) return false;
    // A contact that struck now, but has no part in the series that ends, has its own impact after it.
    const auto outside = [this](const DatedBounces& b) { return b.last == time_ && !b.over; };
    const bool again = plastic && std::ranges::any_of(bounces_, outside) && observe(now_, time_) &&
                       std::ranges::any_of(bounces_, [&](const DatedBounces& b) {
                         const auto c = static_cast<int>(&b - bounces_.data());
                         return outside(b) && now_.w.gap_rate[c] < -rate_zero(c);
                       });
    if (again && !impact(solver, false, report)) return false;
  }
  next_ = 0;
  return settle(solver, event, struck > 0, report);
}

/// Contacts that strike together get the gap 0: a tilt that rounding made would grow from impact to impact.
void SpatialEventDriven::close_together() {
  for (std::size_t i = 0; i < touching_.size(); ++i)
    motion_.modes[i].lasting = touching_[i] && now_.w.gap[static_cast<Index>(i)] > -kSmallTilt;
  motion_.modes_changed();
  q_within_ = now_.q, v_within_ = now_.v;
  if (motion_.project(time_, q_within_, v_within_).joint < kInf) now_.q = q_within_;
  motion_.modes = before_;
  motion_.modes_changed();
}

/// Contacts whose forces are not unique share them in the proportions of the last decision. One that comes to its end
/// by that alone goes on when they are shared as a new decision finds. False: it has come to its end.
bool SpatialEventDriven::reshare(Solver& solver, const Sign& event, StepReport& report) {
  if (event.watch == Watch::stop || !motion_.redundant()) return false;
  const std::vector<SpatialMode> before = motion_.modes;
  motion_.open_all();
  if (!observe(now_, time_)) return false;
  transition_.candidates.clear();
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i].lasting)
      transition_.candidates.push_back({static_cast<int>(i), before[i].slides, before[i].departs,
                                        before[i].slides ? now_.w.along[i] : Vector3d(0, 0, 0)});
  const bool same = transition_.decide(motion_, now_.q, now_.v, solver, report) == Status::solved &&
                    motion_.modes == before && observe(now_, time_) && value(event, now_) > slack(event);
  if (same) return true;
  motion_.modes = before, motion_.modes_changed();
  observe(now_, time_);
  return false;
}

bool SpatialEventDriven::impact(Solver& solver, bool plastic, StepReport& report) {
  Terms& terms = motion_.terms();
  if (!motion_.accelerations(time_, now_.q, now_.v, now_.a))
    return give_up(Status::numerical_error, "no accelerations at an impact");
  contacts_.clear();
  for (std::size_t i = 0; i < touching_.size(); ++i)
    if (plastic ? bounces_[i].over || motion_.modes[i].lasting : touching_[i]) contacts_.push_back(static_cast<int>(i));
  evaluate_closed(system_, contacts_, terms);
  newtons_law(system_.laws(), terms, now_.v, targets_);
  restrict_to_strikes(targets_);
  v_before_ = now_.v;
  shown_ = &impact_.formulation();
  impact_.anchor(time_, now_.q), formulation_.anchor(time_, now_.q);
  const bool in_turn = plastic && ends_in_turn(time_, bounces_, motion_.modes, in_turn_);
  if (in_turn)
    no_answer_ = !impact_.strike_in_turn(terms, motion_.basic(), in_turn_, now_.v, solver, report);
  else if (!plastic)
    no_answer_ = !impact_.strike(terms, motion_.basic(), v_before_, targets_, now_.v, solver, report);
  if (no_answer_) return give_up(report.status, impact_.why());
  if (in_turn) newtons_law(system_.laws(), terms, now_.v, targets_), restrict_to_strikes(targets_);
  if (plastic)
    for (auto& target : targets_) target.normal = 0;
  formulation_.formulate(terms, motion_.basic(), targets_, now_.v, none_);
  shown_ = &formulation_;
  no_answer_ = !formulation_.solve(solver, report);
  if (no_answer_) {
    const std::string why = formulation_.contradiction();
    if (report.status == Status::infeasible) return give_up(report.status, why_no_impact(system_, terms, why));
    return give_up(report.status, why.empty() ? "the impact was not solved" : "in an impact " + why);
  }
  std::fill(struck_.begin(), struck_.end(), Impulse{});
  formulation_.advance(now_.v, struck_);
  if (in_turn || !plastic) impact_.add_to(struck_);
  report.note_rise(energy_rise(system_, terms, targets_, now_.v, struck_), time_);
  const double worked = work_;
  if (system_.driven()) work_ += (v_before_ + now_.v).dot(system_.mass().cwiseProduct(now_.v - v_before_)) / 2;
  for (const auto& closed : terms.closed) {
    const auto i = static_cast<std::size_t>(closed.contact);
    const Impulse& hit = struck_[i];
    impulses_[i].normal += hit.normal, impulses_[i].tangent += hit.tangent;
    work_ += inner(hit.tangent, closed.rows.belt);
    if (system_.driven()) {
      const auto mean = [&](const RowOf<Spatial>& row) {
        return (apply(row, v_before_.data()) + apply(row, now_.v.data())) / 2;
      };
      work_ -= hit.normal * mean(closed.rows.normal) + hit.tangent.first * mean(closed.rows.tangents[0]) +
               hit.tangent.second * mean(closed.rows.tangents[1]);
    }
    if (plastic && bounces_[i].over)
      emit(std::max(time_, bounces_[i].end), EventKind::accumulation, closed.contact, hit);
    else if (hit.normal > 0)
      emit(time_, EventKind::impact, closed.contact, hit);
  }
  effort_ += std::abs(work_ - worked);
  return true;
}

/// The modes at now_, after an impact or an event of the motion.
bool SpatialEventDriven::settle(Solver& solver, const std::optional<Sign>& event, bool struck, StepReport& report) {
  if (event && !struck && (event->watch == Watch::force || event->watch == Watch::cone)) {
    const double zero = kTogether * (1 + 1e3 * crowd_.standstill) * load_;
    for (const int c : motion_.lasting()) {
      const auto i = static_cast<std::size_t>(c);
      if (event->watch == Watch::force) {
        released_[i] = c == event->contact || now_.w.normal[c] <= zero;
      } else if (before_[i].sticks && (c == event->contact || room(c, now_) <= zero) && now_.w.tangent[c] > 0) {
        const auto place = static_cast<std::size_t>(std::find(motion_.lasting().begin(), motion_.lasting().end(), c) -
                                                    motion_.lasting().begin());
        const auto& rows = motion_.terms().closed[place].rows;
        const Tangents force{now_.force[3 * c + 1], now_.force[3 * c + 2]};
        slides_[i] = -in_world(rows, force) / now_.w.tangent[c];
      }
    }
  }
  const double none = slip_zero(now_) * (event && event->watch == Watch::stop ? 100 : 1);
  for (bool again = true; again;) {
    motion_.open_all();
    if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations after an event");
    transition_.candidates.clear();
    const auto& terms = motion_.terms();
    contacts_.clear();
    for (int c = 0; c < system_.contacts(); ++c) {
      const auto i = static_cast<std::size_t>(c);
      if (!touching_[i] || released_[i]) continue;
      if (now_.w.gap_rate[c] > rate_zero(c) && !bounces_[i].over) continue;
      contacts_.push_back(c);
    }
    evaluate_closed(system_, contacts_, motion_.terms());
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      const auto i = static_cast<std::size_t>(contacts_[k]);
      SpatialTransition::Candidate candidate{contacts_[k], false, false, slides_[i]};
      if (system_.law(contacts_[k]).frictional()) {
        const Tangents slip = slip_of(terms.closed[k].rows, now_.v);
        if (size_of(slip) > none) candidate.direction = in_world(terms.closed[k].rows, slip) / size_of(slip);
        candidate.slides = candidate.direction.squaredNorm() > 0;
        candidate.departs =
            candidate.slides && (size_of(slip) <= none || (!struck && before_[i].departs && before_[i].lasting));
      }
      transition_.candidates.push_back(candidate);
    }
    const Status status = transition_.decide(motion_, now_.q, now_.v, solver, report);
    if (status != Status::solved) {
      shown_ = nullptr;
      no_answer_ = transition_.undecided();
      return give_up(status, transition_.why() + ", at t = " + detail::text_of(time_));
    }
    now_.residual = motion_.project(time_, now_.q, now_.v);
    if (!observe(now_, time_) || !share_equally())
      return give_up(Status::numerical_error, "no accelerations after an event");
    again = false;
    if (std::find(released_.begin(), released_.end(), true) == released_.end()) break;
    evaluate_closed(system_, kInf, motion_.terms());
    for (int c = 0; c < system_.contacts(); ++c) {  // pressed back by what else changes here
      const auto i = static_cast<std::size_t>(c);
      if (released_[i] && goes_in(c)) released_[i] = false, again = true;
    }
    evaluate_closed(system_, motion_.lasting(), motion_.terms());
  }
  load_ = 0;
  note_changes(event.has_value() && !struck);
  return true;
}

/// Equal shares of forces that are not unique, where they hold: of all contacts that last, else of those that the
/// decision found to bear. False: no accelerations.
bool SpatialEventDriven::share_equally() {
  const auto pushes = [&](int c) {  // [N], not [N m]
    const auto& contact = system_.scene().contacts[static_cast<std::size_t>(c)];
    return !std::holds_alternative<spatial::Limit>(contact) && !std::holds_alternative<spatial::Backlash>(contact);
  };
  if (!motion_.redundant() || !std::ranges::all_of(motion_.lasting(), pushes)) return true;
  const std::vector<SpatialMode> found = motion_.modes;
  double most = 0;
  for (const int c : motion_.lasting()) most = std::max(most, found[static_cast<std::size_t>(c)].share_normal);
  for (const double least : {0.0, 2 * kLeastShare * most}) {
    for (const int c : motion_.lasting()) {
      SpatialMode& mode = motion_.modes[static_cast<std::size_t>(c)];
      mode.share_normal = found[static_cast<std::size_t>(c)].share_normal > least ? 1 : kLeastShare;
      mode.share_tangent = static_friction(system_.law(c)) * mode.share_normal;
    }
    if (observe(now_, time_) && shares_hold()) return true;
  }
  motion_.modes = found;
  return observe(now_, time_);
}

/// The forces at now_ push, within their cones, and no contact that touches without force goes in.
bool SpatialEventDriven::shares_hold() {
  const double zero = 1e-12 * now_.w.normal.lpNorm<Eigen::Infinity>();
  for (const int c : motion_.lasting())
    if (now_.w.normal[c] < -zero || (motion_.modes[static_cast<std::size_t>(c)].sticks && room(c, now_) < -zero))
      return false;
  evaluate_closed(system_, kInf, motion_.terms());
  const bool open = std::ranges::none_of(transition_.candidates, [this](const auto& candidate) {
    return !motion_.modes[static_cast<std::size_t>(candidate.contact)].lasting && goes_in(candidate.contact);
  });
  evaluate_closed(system_, motion_.lasting(), motion_.terms());
  return open;
}

/// A contact without force that touches; the rows of all contacts have been evaluated.
bool SpatialEventDriven::goes_in(int contact) {
  return acceleration_of(contact) < -kComesBack * now_.a.lpNorm<Eigen::Infinity>();
}

/// Of its gap [m/s²]; the rows of all contacts have been evaluated.
double SpatialEventDriven::acceleration_of(int contact) {
  const RowOf<Spatial>& normal = motion_.terms().closed[static_cast<std::size_t>(contact)].rows.normal;
  return apply(normal, now_.a.data()) + motion_.bias(contact, now_.q, now_.v).normal;
}

void SpatialEventDriven::note_changes(bool touched) {
  for (int c = 0; c < system_.contacts(); ++c) {
    const SpatialMode &old = before_[static_cast<std::size_t>(c)], &mode = motion_.modes[static_cast<std::size_t>(c)];
    const bool reversed = old.slides && mode.slides && mode.departs && !old.departs;  // a stop, and off again
    if (old == mode && !reversed) continue;
    if (!mode.lasting)
      emit(time_, EventKind::release, c);
    else if (old.lasting)
      emit(time_, mode.sticks ? EventKind::stick : EventKind::slip, c);
    else if (touched)
      emit(time_, EventKind::touch, c);
  }
}

/// Where events have no end, or an instant no answer that could be computed: steps of Moreau–Jean's method, each twice
/// as long as the last one where no calm has come since. Contacts that push in it last, unless they come away faster
/// than bodies fall within it.
bool SpatialEventDriven::cross(Solver& solver, StepReport& report) {
  const Failure reason = failed_;
  for (bool calm = false; !calm;) {
    if (stopped(report)) return give_up(report.status, "");
    crowd_.length =
        time_ - crowd_.end < 50 * crowd_.length ? std::min(2 * crowd_.length, kLastCrossing) : options_.crossing;
    const double s = std::min(crowd_.length, end_ - time_);
    if (!(s > time_rounding(time_))) {  // the call ends here: the modes are decided where the next one begins
      begun_ = false;
      break;
    }
    crossed_.t = time_, crossed_.q = now_.q, crossed_.v = now_.v;
    const State before = crossed_;
    const StepReport one = stepping_.step(s, solver, crossed_);
    report.lcp_solves += one.lcp_solves, report.lcp_iterations += one.lcp_iterations;
    ++report.accepted, ++report.crossings;
    if (one.status != Status::solved) return give_up(reason.status, reason.why);
    if (one.passage.width > 0) {
      report.passage = one.passage;
      return give_up(Status::numerical_error, "a crowd of events cannot be crossed at t = " + detail::text_of(time_) +
                                                  ": bodies would pass through each other");
    }
    const double worked = work_;
    if (meter_) {
      work_ += meter_->over_step(before, crossed_, stepping_.impulses(), stepping_.frictions(), stepping_.pairs());
      effort_ += std::abs(work_ - worked);
    }
    report.error_estimate += s * (crossed_.v - now_.v - s * now_.a).lpNorm<Eigen::Infinity>();
    now_.q = crossed_.q, now_.v = crossed_.v;
    time_ += s;
    crowd_.end = time_, crowd_.steps = crowd_.standstill = 0;
    struck_scale_.setZero();
    arc_.length = 0;
    motion_.open_all();
    stop_ = kInf;
    if (!observe(now_, time_)) return give_up(Status::numerical_error, "no accelerations");
    const double slow = s * now_.a.lpNorm<Eigen::Infinity>();
    bool any = false;
    for (std::size_t i = 0; i < touching_.size(); ++i) {
      const Impulse& push = stepping_.impulses()[i];
      impulses_[i].normal += push.normal, impulses_[i].tangent += push.tangent;
      bounces_[i] = {}, bounces_[i].end = time_;
      touching_[i] = bounces_[i].over = push.normal > 0 && now_.w.gap_rate[static_cast<Index>(i)] <= slow;
      any = any || touching_[i];
    }
    std::fill(released_.begin(), released_.end(), false);
    std::fill(slides_.begin(), slides_.end(), Vector3d::Zero());
    no_answer_ = false;
    calm = (!any || impact(solver, true, report)) && settle(solver, {}, true, report);
    crossed_.t = time_, crossed_.q = now_.q, crossed_.v = now_.v;
    report.note_rise(gain_of_crossing(system_, before, crossed_, work_ - worked), time_);
    for (DatedBounces& b : bounces_) b.over = false;
    if (!calm && !no_answer_ && !options_.go_on) return false;
  }
  failed_ = {}, next_ = 0;
  return true;
}

}  // namespace orthant
