// One arc of an Adaptive integrator: its extrapolation, and what is seen to happen in it.
#include <orthant/integrators/adaptive/adaptive.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kLate = 0.1;     // of the tolerance: what accelerations do before a change of mode is taken note of
constexpr double kDipMet = 1e-3;  // of an arc: so near to its ends a margin's least value has been looked at

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

}  // namespace orthant
