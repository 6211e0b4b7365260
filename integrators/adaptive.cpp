#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive.h>
#include <orthant/integrators/horizon.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Where in a step that crosses it an impact is put, as a part of the step; and how late it may be foretold to be. The
// whole step looks at gaps and forces at 1/2, its halves at 1/4 and 3/4. An impact just before 1/4 is taken by the halves
// as if at 1/4: nearly right; and so the error shows.
constexpr double kAhead = 0.2, kLatest = 0.4;
constexpr double kLate = 0.1;      // of the tolerance: what accelerations do before a change of mode is taken note of
constexpr double kDipMet = 1e-3;   // of an arc: so near to its ends a margin's least value has been looked at
constexpr double kTogether = 4;    // of the rounding of gaps: contacts this near count as closed in a crossing
constexpr double kNoise = 0.01;    // of the tolerance: slips and gaps are looked at no closer
constexpr double kSwing = 3;       // [rad] that a load swings in an arc, at the most
constexpr double kTelling = 0.01;  // below, the error of an arc that was cut short may be rounding
constexpr int kCrowd = 200;        // inner steps, rejected ones too, after which is looked how far they came
constexpr double kLeastFloor = 1e-6, kMostFloor = 1e-4;  // [s]
constexpr double kCrossing = 0.2;  // of the tolerance: an event's error is of one sign, and comes on top of the arcs'

/// Where the cubic through value and rate at 0 and 1 last turns from positive to negative; 0 when it never is positive.
double closing(double g0, double r0, double g1, double r1) {
  const double c2 = 3 * (g1 - g0) - 2 * r0 - r1, c3 = 2 * (g0 - g1) + r0 + r1;
  const auto gap = [&](double s) { return g0 + s * (r0 + s * (c2 + s * c3)); };
  constexpr int kLooks = 8;
  double low = -1;
  for (int i = 0; i < kLooks; ++i)
    if (gap(static_cast<double>(i) / kLooks) > 0) low = static_cast<double>(i) / kLooks;
  if (low < 0) return 0;
  double high = low + 1.0 / kLooks, s = (low + high) / 2;
  for (int i = 0; i < 50 && high - low > 1e-15; ++i) {  // Newton's method within the bracket
    const double value = gap(s);
    (value > 0 ? low : high) = s;
    const double next = s - value / (r0 + s * (2 * c2 + s * 3 * c3));
    if (std::abs(next - s) <= 1e-15) break;
    s = next > low && next < high ? next : (low + high) / 2;
  }
  return s;
}

}  // namespace

Adaptive::Adaptive(const System& system, const Options& options)
    : Integrator(system),
      options_(options),
      terms_(system),
      basic_(system),
      motion_(system),
      watch_(motion_),
      transition_(system),
      strikes_(system),
      start_(system),
      end_(system),
      formulation_(system, Form::reduced),
      before_(system.laws().size()),
      gap_margins_(system.laws().size()),
      gaps_before_(system.laws().size()),
      closed_(system.laws().size()),
      half_rate_(system.laws().size()),
      series_(system.laws().size()),
      released_(system.laws().size(), -kInf),
      over_(system.laws().size()),
      q_(system.dof()),
      v_(system.dof()),
      v_new_(system.dof()),
      v_before_(system.dof()),
      v_half_(system.dof()),
      from_(system.dof()),
      force_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()),
      sum_(system.laws().size()),
      kick_(system.laws().size()),
      far_(system.assembly()),
      length_(system.cluster()),
      speed_(system.cluster()),
      omega_(system.cluster()),
      slack_(system.laws().size()),
      noise_(system.laws().size()),
      weight_(2 * system.dof()) {
  refuse_joint_friction("adaptive");
  refuse_collisions("adaptive");
  require_plain_impacts(system, "adaptive");
  for (const Contact& contact : system.scene().contacts)
    bodies_.push_back(std::visit([](const auto& c) { return bodies_of(c); }, contact));
  at_start_ = terms_.at;
  missing_.reserve(system.laws().size());
  events_.reserve(64);  // of one call; more are taken as they come
  row_.assign(static_cast<std::size_t>(options.columns), Eigen::VectorXd(2 * system.dof()));
}

StepReport Adaptive::step(double h, Solver& solver, State& x) {
  StepReport report;
  report.accepted = 0;
  why_.clear();
  events_.clear();
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  formulation_.clear();
  if (last_.q.size() == 0 || x.q != last_.q || x.v != last_.v) restart(h);

  const double end = x.t + h;
  least_ = 8 * kEps * (std::abs(x.t) + h), limit_ = kInf;
  while (end - x.t > least_) {
    if (stopped(report)) break;
    const double left = std::min(end, system_.next_breakpoint(x.t + least_)) - x.t;
    double wanted = std::min(arc_, kSwing / system_.swing());
    if (system_.contacts() > 0) {
      set_poses(system_, x.t, x.q, terms_.at);
      horizon_ = std::max(horizon(system_, terms_.at, x.v, none_), least_);
      begin_margins(x.t);
      wanted = std::min(wanted, horizon_);
    }
    const double wish = wanted > 0.9 * left ? left : std::min(wanted, left / 2);
    const double taken = std::min(limit_, limit_ <= wanted ? left : wish);
    limit_ = kInf;
    scale(x);
    bool fine = true;
    switch (arc(taken, solver, x, report)) {
      case Outcome::done:
        finish(taken, x, report);
        break;
      case Outcome::dip:
        limit_ = dip_, ++report.rejected;
        break;
      case Outcome::impact:
        fine = pass(taken, left, solver, x, report);
        break;
      case Outcome::change:
        fine = change(taken, left, solver, x, report);
        break;
      case Outcome::failed:
        fine = system_.contacts() > 0 && taken <= (jumped_ ? impact_ : change_) &&
               cross_here(jumped_, left, solver, x, report);
    }
    if (!fine) limit_ = taken / 4, ++report.rejected;
    watch_crowd(x.t);
    if (limit_ < least_ && floor_ < kMostFloor) floor_ = std::max(2 * floor_, kLeastFloor), limit_ = kInf;
    if (limit_ < least_ || report.accepted + report.rejected >= options_.max_steps) {
      give_up(x, report);
      break;
    }
    report.status = Status::solved;  // whatever became of trials
  }
  if (report.status == Status::solved) x.t = end;
  last_ = x;
  return report;
}

void Adaptive::remember(Memory& memory) {
  memory(last_, arc_, impact_, change_, floor_, crowd_since_, crowd_, aim_, decided_, motion_, gap_margins_, series_,
         released_, formulation_, strikes_);
  basic_.forget();
}

/// Where more steps are done in a time than could be wanted, crossings are not made shorter than floor_ any more; where
/// that goes on, it grows.
void Adaptive::watch_crowd(double t) {
  if (++crowd_ < kCrowd) return;
  const double pace = (t - crowd_since_) / kCrowd;
  if (pace < std::max(2 * floor_, kLeastFloor / 2))
    floor_ = std::clamp(2 * floor_, kLeastFloor, kMostFloor);
  else if (pace > 20 * floor_)
    floor_ = 0;
  crowd_ = 0, crowd_since_ = t;
}

void Adaptive::give_up(const State& x, StepReport& report) {
  const bool shortest = limit_ < least_;
  why_ = (shortest ? "not even the shortest step could be done from t = " : "max_steps used up at t = ") +
         detail::text_of(x.t) + " s";
  if (!shortest) report.status = Status::iteration_limit;
  if (report.status == Status::solved) report.status = Status::numerical_error;
}

/// An arc without events: taken if its error allows.
void Adaptive::finish(double taken, State& x, StepReport& report) {
  const double wish = plan(taken);
  const bool cut_short = taken < arc_;
  if (!cut_short || error_ > 1)
    arc_ = wish;
  else if (error_ > kTelling)
    arc_ = std::min(arc_, wish);
  if (error_ <= 1)
    accept(taken, x, report);
  else
    ++report.rejected;
}

/// An arc with an impact at event_: it is stopped short of it, or crossed when it is near.
bool Adaptive::pass(double taken, double left, Solver& solver, State& x, StepReport& report) {
  const double width = crossing(impact_, left);
  if (event_ <= kLatest * width || event_ - kAhead * width <= least_) return cross_here(true, left, solver, x, report);
  limit_ = std::max(least_, std::min(event_ - kAhead * width, 0.9 * taken));
  ++report.rejected;
  return true;
}

/// An arc in which a lasting contact's mode ends at event_: it is stopped just after it, and the modes are decided there.
bool Adaptive::change(double taken, double left, Solver& solver, State& x, StepReport& report) {
  if (event_ > 0 && taken > event_ + 2 * late_) {
    limit_ = event_ + late_;
    ++report.rejected;
    return true;
  }
  if (event_ > 0) {
    accept(taken, x, report);
    decide(solver, x, report);
    return true;
  }
  ++report.rejected;
  if (decided_ != x.t && decide(solver, x, report)) {
    decided_ = x.t;
    return true;
  }
  return cross_here(false, left, solver, x, report);
}

/// [s] the width of a crossing, of which the last one left `wish`.
double Adaptive::crossing(double wish, double left) const {
  return std::max(std::min(std::max(floor_, least_), left), std::min({wish, left, arc_ / 8, horizon_}));
}

/// A crossing from x, if its error allows; a jump of the velocity is expected in it, or only one of the acceleration.
bool Adaptive::cross_here(bool jumps, double left, Solver& solver, State& x, StepReport& report) {
  double& wish = jumps ? impact_ : change_;
  const double width = crossing(wish, left);
  // Where contacts and joints leave no motion, only G v⁺ = 0 fits the contacts' rows.
  if (!cross(width, jumps, 2, solver, x, report) && !cross(width, jumps, 1, solver, x, report)) return false;
  if (error_ > 1 && width > std::max(floor_, least_)) {
    wish = width * std::max(0.7 / error_, 1e-3);
    ++report.rejected;
    return true;
  }
  wish = std::min(4 * wish, width * 0.7 / error_);
  settle_modes(width, x);
  // Twice: a contact that now lasts may have had a gap that turns its normal when it goes, as in a journal's clearance.
  if (land(x.t + width) && land(x.t + width)) {
    accept(width, x, report);
    return true;
  }
  motion_.modes = before_, motion_.modes_changed();
  return false;
}

/// The modes of lasting contacts at x, by the problem at acceleration level. False: they stay, or it has no one answer.
bool Adaptive::decide(Solver& solver, State& x, StepReport& report) {
  before_ = motion_.modes;
  if (!motion_.accelerations(x.t + least_ / 2, x.q, x.v, force_)) return false;
  motion_.watch_lasting(x.v, force_, end_.w);
  transition_.candidates.clear();
  for (const int c : motion_.lasting()) {
    const double slip = end_.w.slip[c], none = 4 * late_ * std::abs(end_.w.slip_acceleration[c]) + watch_.slow[at(c)];
    transition_.candidates.push_back({c, motion_.modes[at(c)].slip == 0 || std::abs(slip) <= none ? 0.0
                                         : slip > 0                                               ? 1.0
                                                                                                  : -1.0});
  }
  bool changed = transition_.decide(motion_, solver, report) == Status::solved && before_ != motion_.modes;
  if (changed) {
    q_ = x.q, v_ = x.v;
    changed = land(x.t);
  }
  if (!changed) {
    motion_.modes = before_, motion_.modes_changed();
    return false;
  }
  x.q = q_, x.v = v_;
  note_changes(x.t);
  return true;
}

/// Ends and beginnings of lasting modes, against before_; their gaps are looked at anew.
void Adaptive::note_changes(double t) {
  for (std::size_t c = 0; c < before_.size(); ++c) {
    const ContactMode &before = before_[c], &after = motion_.modes[c];
    const auto happens = [&](EventKind kind) { events_.push_back({t, kind, static_cast<int>(c), 0, 0}); };
    if (before.lasting && !after.lasting) happens(EventKind::release), gap_margins_[c] = {}, released_[c] = t;
    if (before.lasting && before.slip != 0 && after.sticks) happens(EventKind::stick);
    if (before.sticks && after.slip != 0) happens(EventKind::slip);
  }
}

/// The step size to try after one of `taken` with the errors found: what makes the least work of a second, by the number
/// of columns aimed at from now on.
double Adaptive::plan(double taken) {
  const auto work = [](int columns) { return columns * (columns + 1.0); };  // steps
  double best = 0;
  for (int k = 2; k <= columns_; ++k) {
    const double size = taken * std::clamp(0.8 * std::pow(errors_[at(k)], -1.0 / (2 * k - 1)), 0.1, 4.0);
    if (size / work(k) < best / work(aim_)) continue;
    const bool gains = k == columns_ && k < options_.columns && size / work(k) > 1.1 * best / work(aim_);
    best = size, aim_ = k;
    if (gains) best *= work(k + 1) / work(k), aim_ = k + 1;
  }
  return error_ > 1 ? std::min(best, 0.9 * taken) : best;
}

void Adaptive::restart(double h) {
  arc_ = h;
  floor_ = 0, crowd_ = 0, crowd_since_ = -kInf;
  decided_ = -kInf;
  impact_ = change_ = h / 100;  // nothing is known of the error yet: crossings grow when it allows
  aim_ = 2;
  std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
  motion_.modes_changed();
  std::fill(gap_margins_.begin(), gap_margins_.end(), Margin{});
  std::fill(series_.begin(), series_.end(), ImpactSeries{});
  std::fill(released_.begin(), released_.end(), -kInf);
}

void Adaptive::load(const State& x) {
  q_ = x.q, v_ = x.v;
  std::fill(sum_.begin(), sum_.end(), Impulse{});
}

void Adaptive::store(Eigen::VectorXd& y) const {
  const Index n = system_.dof();
  y.head(n) = q_, y.tail(n) = v_;
}

/// q_, v_ become those at the end of an arc of h from x, sum_ its impulses.
Adaptive::Outcome Adaptive::arc(double h, Solver& solver, const State& x, StepReport& report) {
  rise_ = 0, jumped_ = false;
  gaps_before_ = gap_margins_;
  Outcome outcome = extrapolate(h, x);
  if (outcome == Outcome::done && error_ <= 1) outcome = examine(h, solver, x, report);
  if (outcome != Outcome::done || error_ > 1) gap_margins_ = gaps_before_;
  return outcome;
}

Adaptive::Outcome Adaptive::extrapolate(double h, const State& x) {
  for (columns_ = 0; columns_ < options_.columns;) {
    const int steps = 2 * (columns_ + 1);
    load(x);
    gap_margins_ = gaps_before_;  // anew, by the finer steps
    dip_ = kInf, event_ = 0;
    for (int i = 0; i < steps; ++i)
      if (const Outcome outcome = symmetric_step(x, i * h / steps, h / steps); outcome != Outcome::done) return outcome;
    Eigen::VectorXd& newest = row_[at(columns_)];
    store(newest);
    ++columns_;
    // Aitken–Neville along the row, in place: row_[j] becomes the extrapolation over the last columns_ − j of them.
    for (int j = columns_ - 2; j >= 0; --j) {
      const double ratio = static_cast<double>(steps) / (2 * (j + 1));
      row_[at(j)] = row_[at(j + 1)] + (row_[at(j + 1)] - row_[at(j)]) / (ratio * ratio - 1);
    }
    if (columns_ < 2) continue;
    error_ = errors_[at(columns_)] = error(row_[0], row_[1]);
    if (error_ <= 1 && (columns_ >= aim_ || h < arc_)) break;
  }
  const Index n = system_.dof();
  q_ = row_[0].head(n), v_ = row_[0].tail(n);
  return Outcome::done;
}

/// What happens in the arc that was done: gaps that close, lasting contacts whose mode ends; event_ is when.
Adaptive::Outcome Adaptive::examine(double h, Solver& solver, const State& x, StepReport& report) {
  if (!land(x.t + h)) return Outcome::failed;
  // What the exact motion never leaves is no farther than the error: rows may have jumped since the last step's middle.
  store(row_[1]);
  jumped_ = !motion_.lasting().empty() && error(row_[0], row_[1]) > 1;
  if (jumped_) return Outcome::failed;
  if (system_.contacts() == 0) return Outcome::done;
  set_poses(system_, x.t + h, q_, terms_.at);
  Outcome outcome = closes(x, h, false) ? Outcome::impact : Outcome::done;
  if (!motion_.lasting().empty()) {
    const double impact = outcome == Outcome::impact ? event_ : kInf;
    start_.q = x.q, start_.v = x.v, end_.q = q_, end_.v = v_;
    // Just after the start and just before the end: forces may jump there.
    const double t = x.t + least_ / 2, s = h - least_;
    if (!observe(motion_, t, start_)) return Outcome::failed;
    if (motion_.redundant()) {
      motion_.share_anew(start_.w);
      observe(motion_, t, start_);
    }
    late_ = late();
    if (!observe(motion_, t + s, end_) || !watch_.look(t, s, start_, end_)) return Outcome::failed;
    event_ = mode_end(t, s, solver, report);
    if (event_ < impact && event_ <= h)
      outcome = Outcome::change;
    else
      event_ = impact;
    for (const int c : motion_.lasting()) sum_[at(c)] = watch_.impulse(c);
  }
  if (dip_ < (outcome == Outcome::done ? (1 - kDipMet) * h : event_) && dip_ > least_) return Outcome::dip;
  return outcome;
}

/// [s] in which nothing changes by more than a part of the tolerance, from the accelerations at the arc's start.
double Adaptive::late() const {
  double rate = 0;
  const Index n = system_.dof();
  for (Index i = 0; i < n; ++i)
    rate = std::max(rate, std::max(std::abs(start_.a[i]), std::abs(motion_.free()[i])) * weight_[n + i]);
  return std::max(2 * least_, kLate / rate);
}

/// [s] after the start, when a lasting contact's mode ends; infinite: it does not.
double Adaptive::mode_end(double t, double s, Solver& solver, StepReport& report) {
  const auto when = [&](bool forces) {
    const auto sign = watch_.first(forces);
    return sign ? sign->crossing.x * s : kInf;
  };
  const double end = when(true);
  if (end == kInf || !motion_.redundant()) return end;
  // Of forces that are not unique others may do, at all points looked at.
  constexpr std::size_t kLast = ContactWatch::kPoints - 1;
  for (std::size_t i = 0; i <= kLast; ++i)
    if (const double x = static_cast<double>(i) / kLast; !holds(t + x * s, watch_.point(i), solver, report))
      return std::min(when(false), std::max(0.0, x - 0.5 / kLast) * s);
  return when(false);
}

/// Whether forces exist with which all modes go on.
bool Adaptive::holds(double t, const MotionPoint& p, Solver& solver, StepReport& report) {
  if (!motion_.accelerations(t, p.q, p.v, force_)) return false;
  transition_.candidates.clear();
  for (const int c : motion_.lasting()) transition_.candidates.push_back({c, motion_.modes[at(c)].slip});
  before_ = motion_.modes;
  const bool same = transition_.decide(motion_, solver, report) == Status::solved && before_ == motion_.modes;
  motion_.modes = before_, motion_.modes_changed();
  return same;
}

/// The time when a margin is least, by the parabola through its last three values, if it may then be below zero: values
/// and parabola are off by some of what it bends between two of them.
double Adaptive::Margin::dip(double noise) const {
  const auto& [c, b, a] = last;
  if (a.value < b.value && b.value < c.value) return kInf;  // what was least before b has shown when b was looked at
  const double slope = (c.value - b.value) / (c.t - b.t),
               bend = (slope - (b.value - a.value) / (b.t - a.t)) / (c.t - a.t);
  const double apart = std::max(c.t - b.t, b.t - a.t), bent = bend * apart * apart;
  if (!(bent > noise) || !(a.t > -kInf)) return kInf;
  const double least = (b.t + c.t) / 2 - slope / (2 * bend);
  return c.value + (least - c.t) * (slope + bend * (least - b.t)) < bent / 2 ? least : kInf;
}

/// The gaps where an arc begins at t, of those that have not been looked at yet; terms_.at are the poses.
void Adaptive::begin_margins(double t) {
  const auto fresh = [](const Margin& gap) { return gap.last[0].t == -kInf; };
  if (std::none_of(gap_margins_.begin(), gap_margins_.end(), fresh)) return;
  evaluate_gaps(system_, terms_);
  for (std::size_t c = 0; c < gap_margins_.size(); ++c)
    if (fresh(gap_margins_[c])) gap_margins_[c].add(t, terms_.gap[static_cast<Index>(c)]);
}

/// Whether gaps are closed offset into an arc from x: event_ is when the first closed. `midway`: in the middle of a step,
/// where q is of first order only.
bool Adaptive::closes(const State& x, double offset, bool midway) {
  evaluate_gaps(system_, terms_);
  bool any = false;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (motion_.modes[at(c)].lasting) continue;
    if (terms_.gap[c] > 0) {
      look(c, x, offset, terms_.gap[c]);
      continue;
    }
    const bool let_go = released_[at(c)] == x.t;  // its gap begins like t³: less than such a q is off by
    if (let_go && midway) continue;
    const double gap = terms_.gap[c], rate = apply(rows(c).normal, v_.data());
    const double slack = slack_[at(c)];
    if (rate > 0 && gap >= -slack) continue;
    at_start_ = terms_.at;
    set_poses(system_, x.t, x.q, at_start_);
    std::swap(at_start_, terms_.at);
    const double before = std::visit([&](const auto& s) { return s.gap(terms_.at); }, system_.scene().contacts[at(c)]);
    // It opens, or has not moved beyond rounding (a normal that turns has rates of its own, midway); else it closed on
    // the way.
    if (before <= 2 * slack && (rate > 0 || gap >= -slack)) {
      std::swap(at_start_, terms_.at);
      continue;
    }
    const double rate_before = apply(rows(c).normal, x.v.data());
    const bool now = before <= 2 * slack && rate_before <= 0;  // what is left of the gap is rounding
    const double when = let_go ? offset / 2
                        : now  ? 0
                               : offset * closing(before - slack, offset * rate_before, gap - slack, offset * rate);
    std::swap(at_start_, terms_.at);
    event_ = any ? std::min(event_, when) : when;
    any = true;
  }
  return any;
}

ContactRows Adaptive::rows(int contact) const {
  return std::visit([&](const auto& c) { return c.rows(terms_.at); }, system_.scene().contacts[at(contact)]);
}

/// v_new_: without contacts. joints: 2, where they are to hold for the mean of v and v⁺; 1, for v⁺.
bool Adaptive::predict(double t, double h, double joints) {
  q_ += h / 2 * v_;
  set_poses(system_, t + h / 2, q_, terms_.at);
  evaluate_forces(system_, t + h / 2, v_, terms_);
  evaluate_joint_rows(system_, terms_);
  if (!basic_.factorize(system_, terms_, h * h / 4, h / 2)) return false;
  force_ = h * terms_.f;
  from_ = joints * v_, rate_ = joints * terms_.joint_rate;
  basic_.solve_change(terms_.G, force_.data(), from_.data(), rate_.data(), v_new_.data(), lambda_.data());
  v_new_ += v_;
  return v_new_.allFinite();
}

Adaptive::Outcome Adaptive::symmetric_step(const State& x, double offset, double h) {
  if (!predict(x.t + offset, h, 2)) return Outcome::failed;
  if (system_.contacts() > 0 && closes(x, offset + h / 2, true)) return Outcome::impact;
  if (!motion_.lasting().empty()) {
    evaluate_closed(system_, motion_.lasting(), terms_);
    missing_.clear();
    for (const auto& [contact, rows] : terms_.closed)
      missing_.push_back(
          {apply(rows.normal, v_.data()), apply(rows.tangent, v_.data()) - 2 * system_.law(contact).belt});
    motion_.impose(terms_, basic_, missing_, v_new_);
  }
  v_.swap(v_new_);
  q_ += h / 2 * v_;
  return v_.allFinite() ? Outcome::done : Outcome::failed;
}

void Adaptive::look(int contact, const State& x, double offset, double value) {
  Margin& gap = gap_margins_[at(contact)];
  gap.add(x.t + offset, value);
  if (const double dip = gap.dip(noise_[at(contact)]) - x.t; dip > kDipMet * offset) dip_ = std::min(dip_, dip);
}

bool Adaptive::plain_step(const State& x, double offset, double h, double joints, Solver& solver, StepReport& report) {
  if (!predict(x.t + offset, h, joints)) return false;
  evaluate_gaps(system_, terms_);
  terms_.closed.clear();
  for (int c = 0; c < system_.contacts(); ++c)
    if (terms_.gap[c] <= kTogether * slack_[at(c)] || motion_.modes[at(c)].lasting || over_[at(c)])
      terms_.closed.push_back({c, rows(c)});
  if (in_turn_) {
    v_before_ = v_;
    if (!strikes_.strike_in_turn(terms_, basic_, over_, v_, solver, report)) return false;
    v_new_ += v_ - v_before_;
    strikes_.add_to(sum_);
  }
  newtons_law(system_.laws(), terms_, v_, wanted_);
  for (std::size_t k = 0; k < terms_.closed.size(); ++k) {
    const int c = terms_.closed[k].contact;
    if (closed_[at(c)]) wanted_[k].tangent = system_.law(c).belt;
    if (over_[at(c)]) wanted_[k].normal = 0;
  }
  formulation_.formulate(terms_, basic_, wanted_, v_new_, lambda_);
  if (!formulation_.solve(solver, report)) return false;
  note_forces(terms_, v_new_, wanted_);
  formulation_.advance(v_new_, kick_);
  v_ = v_new_;
  q_ += h / 2 * v_;
  for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i].normal += kick_[i].normal, sum_[i].tangent += kick_[i].tangent;
  rise_ += energy_rise(system_, terms_, wanted_, v_, kick_);
  return true;
}

/// Marks two contacts that strike in turn, at ever shorter intervals, and next within a crossing from x: it cannot tell them
/// apart any more. Two ratios of resolved intervals make a series, and the gaps taken for zero count as a crossing's error.
void Adaptive::end_series(double width, const State& x) {
  set_poses(system_, x.t, x.q, terms_.at);
  evaluate_gaps(system_, terms_);
  double first = kInf, last = -kInf, interval = kInf;
  for (std::size_t c = 0; c < over_.size(); ++c) {
    const ImpactSeries& s = series_[c];
    over_[c] = s.shrinking >= 3 && s.last + s.interval * s.ratio <= x.t + 2 * width && x.t - s.last <= s.interval &&
               terms_.gap[static_cast<Index>(c)] <= kCrossing / kNoise * noise_[c];
    if (!over_[c]) continue;
    first = std::min(first, s.last), last = std::max(last, s.last), interval = std::min(interval, s.interval);
  }
  in_turn_ = std::count(over_.begin(), over_.end(), true) == 2 && last - first > kInTurn * interval;
  if (!in_turn_) std::fill(over_.begin(), over_.end(), false);
}

bool Adaptive::cross(double h, bool jumps, double joints, Solver& solver, const State& x, StepReport& report) {
  // Tangential restitution is for contacts that strike: not for what lasts, nor once more in the second half.
  for (std::size_t c = 0; c < closed_.size(); ++c) closed_[c] = !jumps && motion_.modes[c].lasting;
  end_series(h, x);
  load(x);
  if (!plain_step(x, 0, h, joints, solver, report)) return false;
  store(row_[0]);
  rise_ = 0;
  load(x);
  if (!plain_step(x, 0, h / 2, joints, solver, report)) return false;
  std::fill(closed_.begin(), closed_.end(), false);
  for (const auto& [contact, rows] : terms_.closed)
    closed_[at(contact)] = true, half_rate_[at(contact)] = apply(rows.normal, v_.data());
  v_half_ = v_;
  if (!plain_step(x, h / 2, h / 2, joints, solver, report)) return false;
  store(row_[1]);
  const Index n = system_.dof();
  error_ = error(row_[0], row_[1]);
  // By whatever luck the halves agree: a jump of v somewhere in the step leaves positions uncertain by h |Δv|, one of
  // the acceleration leaves v so by a part of h |Δa|.
  row_[0] = row_[1];
  if (jumps)
    row_[0].head(n) += h * (v_ - x.v);
  else
    row_[0].tail(n) += (x.v - 2 * v_half_ + v_) / 4;
  error_ = std::max(error_, error(row_[0], row_[1])) / kCrossing;
  return true;
}

/// After a crossing of h from x: what lasts and how, from its second half; and what happened to each contact.
void Adaptive::settle_modes(double h, const State& x) {
  const double tiny = 10 * formulation_.solution().residual + 1e-13 * v_new_.lpNorm<Eigen::Infinity>();
  before_ = motion_.modes;
  std::fill(motion_.modes.begin(), motion_.modes.end(), ContactMode{});
  auto tangent = static_cast<Index>(terms_.closed.size());
  for (std::size_t k = 0; k < terms_.closed.size(); ++k) {
    const auto c = at(terms_.closed[k].contact);
    // What approached struck, whichever copy of a contact has the impulse.
    if (closed_[c] && !before_[c].lasting && !(sum_[c].normal > 0) &&
        apply(terms_.closed[k].rows.normal, x.v.data()) < 0)
      series_[c].add(x.t + std::clamp(event_, 0.0, h));
    const bool frictional = system_.laws()[c].frictional();
    const double slip = frictional ? formulation_.solution().w[tangent++] : 0;
    // The second half gave it a speed γ_N⁺ and would have changed it by −fall without contact, the turning of its normal
    // included; where it has no impulse, what the others did is known too. It lasts if it flies no higher than rounding
    // can tell; or if it was stopped, having been closed before, and would be back within a step (else an impact
    // elsewhere sent it off).
    const Row& row = terms_.closed[k].rows.normal;
    const double w = formulation_.solution().w[static_cast<Index>(k)], e = over_[c] ? 0 : system_.laws()[c].e;
    const double rate = apply(row, v_half_.data()), before = closed_[c] ? half_rate_[c] : rate;
    const double rebound = apply(row, v_.data());
    const double fall = before - (w > tiny ? rebound : problem().b[static_cast<Index>(k)] - e * rate);
    const bool low = rebound * rebound * h <= fall * slack_[c];
    const bool pressed = (closed_[c] || before_[c].lasting) && w <= tiny;
    if (!low && !(pressed && rebound <= 2 * std::abs(fall))) continue;
    ContactMode& mode = motion_.modes[c];
    mode.lasting = true;
    mode.sticks = frictional && std::abs(slip) <= tiny;
    mode.slip = !frictional || mode.sticks ? 0 : slip < 0 ? -1 : 1;
  }
  motion_.modes_changed();
  for (std::size_t c = 0; c < before_.size(); ++c) {
    gap_margins_[c] = {};
    if (before_[c].lasting || !(sum_[c].normal > 0)) continue;
    const bool impact = !motion_.modes[c].lasting || system_.laws()[c].e == 0;
    series_[c].add(x.t + std::clamp(event_, 0.0, h));
    events_.push_back({x.t + h, impact ? EventKind::impact : EventKind::accumulation, static_cast<int>(c),
                       sum_[c].normal, sum_[c].tangent});
  }
  note_changes(x.t + h);
}

/// Takes q_, v_ as the state at t: onto the joints and lasting contacts.
bool Adaptive::land(double t) {
  residual_ = motion_.project(t, q_, v_);
  if (residual_.rate > kEps * v_.lpNorm<Eigen::Infinity>()) residual_ = motion_.project(t, q_, v_);
  return residual_.off <= kJointsHold && q_.allFinite() && v_.allFinite();
}

/// Takes q_, v_, landed already, as the end of a step of h, into x.
void Adaptive::accept(double h, State& x, StepReport& report) {
  report.joint_residual = residual_.joint, report.joint_rate = residual_.rate;
  ++report.accepted;
  report.energy_rise = std::max(report.energy_rise, rise_);
  rise_ = 0;
  x.t += h;
  x.q.swap(q_), x.v.swap(v_);
  for (std::size_t i = 0; i < sum_.size(); ++i)
    impulses_[i].normal += sum_[i].normal, impulses_[i].tangent += sum_[i].tangent;
  set_poses(system_, x.t, x.q, terms_.at);
  evaluate_gaps(system_, terms_);
  gaps_ = terms_.gap;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
}

void Adaptive::scale(const State& x) {
  const auto translation = [](const Eigen::VectorXd& y) {
    return [&y](Index i) { return std::max(std::abs(y[3 * i]), std::abs(y[3 * i + 1])); };
  };
  far_.measure(translation(x.q)), length_.measure(translation(x.q)), speed_.measure(translation(x.v));
  omega_.measure([&](Index i) { return std::abs(x.v[3 * i + 2]); });
  const auto tolerance = [&](double size) { return options_.atol + options_.rtol * size; };
  const Index n = system_.dof();
  for (Index i = 0; i < n; i += 3) {
    weight_[i] = weight_[i + 1] = 1 / tolerance(length_.of_entry(i));
    weight_[i + 2] = 1 / tolerance(1);
    weight_[n + i] = weight_[n + i + 1] = 1 / tolerance(speed_.of_entry(i));
    weight_[n + i + 2] = 1 / tolerance(omega_.of_entry(i));
  }
  for (std::size_t c = 0; c < bodies_.size(); ++c) {
    const auto [a, b] = bodies_[c];
    slack_[c] = 32 * kEps * far_.of(a, b);
    noise_[c] = kNoise * tolerance(length_.of(a, b));
    watch_.slow[c] = kNone * tolerance(speed_.of(a, b));
  }
}

double Adaptive::error(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  double worst = 0;
  for (Index i = 0; i < weight_.size(); ++i) {
    const double off = std::abs(a[i] - b[i]) * weight_[i];
    if (!(off < kInf)) return kInf;  // NaN too
    worst = std::max(worst, off);
  }
  return worst;
}

}  // namespace orthant
