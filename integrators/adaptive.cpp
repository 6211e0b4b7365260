#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive.h>
#include <orthant/integrators/contact_motion.h>
#include <orthant/integrators/horizon.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Where in a step that crosses it an event is put, as a part of the step; and how late it may be foretold to be. The
// whole step looks at gaps and forces at 1/2 and at slip at 1, its halves at 1/4 and 3/4, 1/2 and 1. An impact just before
// 1/4 is taken by the halves as if at 1/4: nearly right. A change of acceleration just after 1/2 is taken by the second
// half as if at 1/2, and by the whole step as if at 0 or 1: so the error shows.
constexpr double kAheadOfImpact = 0.2, kLatestImpact = 0.4, kAheadOfChange = 0.55, kLatestChange = 0.7;
constexpr double kDipMet = 1e-3;   // of an arc: so near to its ends a margin's least value has been looked at
constexpr double kNoise = 0.01;    // of the tolerance: slips and gaps are looked at no closer
constexpr double kSwing = 3;       // [rad] that a load swings in an arc, at the most
constexpr double kTelling = 0.01;  // below, the error of an arc that was cut short may be rounding
constexpr int kCrowd = 200;        // inner steps, rejected ones too, after which is looked how far they came
constexpr double kLeastFloor = 1e-6, kMostFloor = 1e-4;  // [s]
constexpr double kCrossing = 0.2;  // of the tolerance: an event's error is of one sign, and comes on top of the arcs'

std::size_t at(int i) { return static_cast<std::size_t>(i); }

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
      projection_(system),
      formulation_(system, Form::reduced),
      laws_(system.laws()),
      lasting_(system.laws().size()),
      before_(system.laws().size()),
      closed_(system.laws().size()),
      q_(system.dof()),
      v_(system.dof()),
      v_new_(system.dof()),
      v_half_(system.dof()),
      force_(system.dof()),
      lambda_(system.joint_rows()),
      sum_(system.laws().size()),
      kick_(system.laws().size()) {
  refuse_joint_friction("adaptive");
  refuse_collisions("adaptive");
  require_plain_impacts(system, "adaptive");
  const Index size = 2 * system.dof() + 2 * system.contacts();
  at_start_ = terms_.at;
  events_.reserve(64);  // of one call; more are taken as they come
  row_.assign(static_cast<std::size_t>(options.columns), Eigen::VectorXd(size));
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
    const double left = std::min(end, system_.next_breakpoint(x.t + least_)) - x.t;
    double wanted = std::min({arc_, limit_, kSwing / system_.swing()});
    if (system_.contacts() > 0) {
      set_poses(system_, x.t, x.q, terms_.at);
      horizon_ = std::max(horizon(system_, terms_.at, x.v, none_), least_);
      wanted = std::min(wanted, horizon_);
    }
    const double taken = wanted > 0.9 * left ? left : std::min(wanted, left / 2);
    limit_ = kInf;
    scale(x);
    const Outcome outcome = arc(taken, solver, x, report);
    if (outcome == Outcome::dip)
      limit_ = dip_, ++report.rejected;
    else if (outcome == Outcome::failed ||
             !(outcome == Outcome::done ? finish(taken, x, report)
                                        : pass(outcome == Outcome::impact, taken, left, solver, x, report)))
      limit_ = taken / 4, ++report.rejected;
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
bool Adaptive::finish(double taken, State& x, StepReport& report) {
  const double wish = plan(taken);
  const bool cut_short = taken < arc_;
  if (!cut_short || error_ > 1)
    arc_ = wish;
  else if (error_ > kTelling)
    arc_ = std::min(arc_, wish);
  if (error_ <= 1) return accept(taken, x, report);
  ++report.rejected;
  return true;
}

/// An arc with an event at event_: it is stopped short of it, or crossed when it is near.
bool Adaptive::pass(bool jumps, double taken, double left, Solver& solver, State& x, StepReport& report) {
  const double ahead = jumps ? kAheadOfImpact : kAheadOfChange, latest = jumps ? kLatestImpact : kLatestChange;
  const double shortest = std::min(std::max(floor_, least_), left);
  double &wish = jumps ? impact_ : change_, width = std::max(shortest, std::min({wish, left, arc_ / 8, horizon_}));
  if (event_ > latest * width && event_ - ahead * width > least_) {
    limit_ = std::max(least_, std::min(event_ - ahead * width, 0.9 * taken));
    ++report.rejected;
    return true;
  }
  if (!jumps && event_ > 0) width = std::max(shortest, std::min(width, event_ / ahead));
  if (!cross(width, jumps, solver, x, report)) return false;
  if (error_ > 1 && width > std::max(floor_, least_)) {
    wish = width * std::max(0.7 / error_, 1e-3);
    ++report.rejected;
    return true;
  }
  wish = std::min(4 * wish, width * 0.7 / error_);
  return accept(width, x, report) && (!settle_modes(width, x) || bind(solver, x, report));
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
  impact_ = change_ = h / 100;  // nothing is known of the error yet: crossings grow when it allows
  aim_ = 2;
  std::fill(lasting_.begin(), lasting_.end(), Lasting{});
}

void Adaptive::load(const State& x) {
  q_ = x.q, v_ = x.v;
  std::fill(sum_.begin(), sum_.end(), Impulse{});
}

void Adaptive::store(Eigen::VectorXd& y) const {
  const Index n = system_.dof();
  y.head(n) = q_, y.segment(n, n) = v_;
  for (std::size_t i = 0; i < sum_.size(); ++i)
    y[2 * n + 2 * static_cast<Index>(i)] = sum_[i].normal, y[2 * n + 2 * static_cast<Index>(i) + 1] = sum_[i].tangent;
}

Adaptive::Outcome Adaptive::arc(double h, Solver& solver, const State& x, StepReport& report) {
  rise_ = 0;
  for (std::size_t c = 0; c < laws_.size(); ++c) {
    const ContactLaw& law = system_.laws()[c];
    laws_[c] = law;
    if (lasting_[c].mode == Mode::open) continue;
    laws_[c].e = laws_[c].e_t = 1;
    laws_[c].mu = lasting_[c].mode == Mode::sticks ? std::max(law.mu, law.mu_static) : law.mu;
    laws_[c].mu_static = 0;
  }
  before_ = lasting_;
  const Outcome outcome = extrapolate(h, solver, x, report);
  if (outcome != Outcome::done || error_ > 1) lasting_ = before_;
  return outcome;
}

Adaptive::Outcome Adaptive::extrapolate(double h, Solver& solver, const State& x, StepReport& report) {
  for (columns_ = 0; columns_ < options_.columns;) {
    const int steps = 2 * (columns_ + 1);
    load(x);
    for (std::size_t c = 0; c < lasting_.size(); ++c)  // gaps and slips anew, by the finer steps
      if (lasting_[c].mode == Mode::open)
        lasting_[c].normal = before_[c].normal;
      else if (lasting_[c].mode == Mode::slides)
        lasting_[c].tangent = before_[c].tangent;
    dip_ = kInf;
    for (int i = 0; i < steps; ++i)
      if (const Outcome outcome = symmetric_step(x, i * h / steps, h / steps, solver, report); outcome != Outcome::done)
        return outcome;
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
  q_ = row_[0].head(n), v_ = row_[0].segment(n, n);
  for (std::size_t i = 0; i < sum_.size(); ++i)
    sum_[i] = {row_[0][2 * n + 2 * static_cast<Index>(i)], row_[0][2 * n + 2 * static_cast<Index>(i) + 1]};
  if (error_ > 1 || lasting_.empty()) return Outcome::done;
  set_poses(system_, x.t + h, q_, terms_.at);
  const Outcome outcome = closes(x, h) ? Outcome::impact : ends(x, h) ? Outcome::change : Outcome::done;
  if (dip_ < (outcome == Outcome::done ? (1 - kDipMet) * h : event_) && dip_ > least_) return Outcome::dip;
  return outcome;
}

/// The time when a margin is zero, by the line through its last two values.
double Adaptive::Margin::end() const {
  const auto& [newer, older, oldest] = last;
  const double slope = (newer.value - older.value) / (newer.t - older.t);  // 0 or NaN without two values
  return slope < 0 ? newer.t - newer.value / slope : kInf;
}

/// The time when a margin is least, by the parabola through its last three values, if it may then be below zero: values
/// and parabola are off by some of what it bends between two of them.
double Adaptive::Margin::dip(double noise) const {
  const auto& [c, b, a] = last;
  const double slope = (c.value - b.value) / (c.t - b.t),
               bend = (slope - (b.value - a.value) / (b.t - a.t)) / (c.t - a.t);
  const double apart = std::max(c.t - b.t, b.t - a.t), bent = bend * apart * apart;
  if (!(bent > noise) || !(a.t > -kInf)) return kInf;
  const double least = (b.t + c.t) / 2 - slope / (2 * bend);
  return c.value + (least - c.t) * (slope + bend * (least - b.t)) < bent / 2 ? least : kInf;
}

/// Whether a margin is used up between the last point looked at and the arc's end, where slips are known.
bool Adaptive::ends(const State& x, double h) {
  double end = kInf;
  const double tiny = 1e-13 * v_.lpNorm<Eigen::Infinity>();
  for (int c = 0; c < system_.contacts(); ++c) {
    Lasting& lasting = lasting_[at(c)];
    if (lasting.mode == Mode::open) continue;
    if (lasting.mode == Mode::slides && laws_[at(c)].frictional()) {
      const double slip = lasting.slip * slip_rate(laws_[at(c)], rows(c), v_);
      look(lasting.tangent, x, h, 2 * slip, kNoise / weight_[2]);  // the others are sums of two
      if (slip < -tiny) end = std::min(end, std::min(lasting.tangent.end(), x.t + h));
    } else {
      end = std::min(end, lasting.tangent.end());
    }
    end = std::min(end, lasting.normal.end());
  }
  event_ = end - x.t;
  return event_ <= h;
}

bool Adaptive::closes(const State& x, double offset) {
  evaluate_gaps(system_, terms_);
  bool any = false;
  for (int c = 0; c < system_.contacts(); ++c) {
    if (lasting_[at(c)].mode != Mode::open) continue;
    if (terms_.gap[c] > 0) {
      look(lasting_[at(c)].normal, x, offset, terms_.gap[c], kNoise / weight_[0]);
      continue;
    }
    const double gap = terms_.gap[c], rate = apply(rows(c).normal, v_.data());
    if (rate > 0 && gap >= -slack_) continue;
    at_start_ = terms_.at;
    set_poses(system_, x.t, x.q, at_start_);
    std::swap(at_start_, terms_.at);
    const double before = std::visit([&](const auto& s) { return s.gap(terms_.at); }, system_.scene().contacts[at(c)]);
    if (rate > 0 && before <= 2 * slack_) {  // it opens; else it closed on the way, and opens again
      std::swap(at_start_, terms_.at);
      continue;
    }
    const double rate_before = apply(rows(c).normal, x.v.data());
    const bool now = before <= 2 * slack_ && rate_before <= 0;  // what is left of the gap is rounding
    const double when = now ? 0 : offset * closing(before - slack_, offset * rate_before, gap - slack_, offset * rate);
    std::swap(at_start_, terms_.at);
    event_ = any ? std::min(event_, when) : when;
    any = true;
  }
  return any;
}

ContactRows Adaptive::rows(int contact) const {
  return std::visit([&](const auto& c) { return c.rows(terms_.at); }, system_.scene().contacts[at(contact)]);
}

bool Adaptive::predict(double t, double h) {
  q_ += h / 2 * v_;
  set_poses(system_, t + h / 2, q_, terms_.at);
  evaluate_forces(system_, t + h / 2, v_, terms_);
  evaluate_joint_rows(system_, terms_);
  if (!basic_.factorize(system_, terms_, h * h / 4, h / 2)) return false;
  force_ = h * terms_.f;
  for (Index i = 0; i < lambda_.size(); ++i) lambda_[i] = 2 * terms_.missing_rate(i, v_);
  basic_.solve(force_.data(), lambda_.data(), v_new_.data(), lambda_.data());
  v_new_ += v_;
  return v_new_.allFinite();
}

bool Adaptive::solve(Solver& solver, const std::vector<ContactLaw>& laws, StepReport& report) {
  newtons_law(laws, terms_, v_, wanted_);
  formulation_.formulate(terms_, basic_, wanted_, v_new_, lambda_);
  return formulation_.solve(solver, report);
}

void Adaptive::drift(double h) {
  formulation_.advance(v_new_, kick_);
  v_ = v_new_;
  q_ += h / 2 * v_;
  for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i].normal += kick_[i].normal, sum_[i].tangent += kick_[i].tangent;
}

Adaptive::Outcome Adaptive::symmetric_step(const State& x, double offset, double h, Solver& solver,
                                           StepReport& report) {
  if (!predict(x.t + offset, h)) return Outcome::failed;
  if (lasting_.empty()) {
    terms_.closed.clear();
  } else {
    if (closes(x, offset + h / 2)) return Outcome::impact;
    terms_.closed.clear();
    for (int c = 0; c < system_.contacts(); ++c)
      if (lasting_[at(c)].mode != Mode::open) terms_.closed.push_back({c, rows(c)});
  }
  if (!solve(solver, laws_, report)) return Outcome::failed;
  const bool kept = in_mode(x, offset + h / 2, h);
  drift(h);
  return kept ? Outcome::done : Outcome::change;
}

/// Whether each lasting contact presses, and sticks or slides as it did; else when that ended, by the line through the
/// last two margins.
bool Adaptive::in_mode(const State& x, double offset, double h) {
  if (problem().size() == 0) return true;
  const double tiny = 10 * formulation_.solution().residual + 1e-13 * v_new_.lpNorm<Eigen::Infinity>();
  bool kept = true;
  const auto ended = [&](const Margin& margin) {
    const double end = margin.end() - x.t;
    event_ = std::min(kept ? kInf : event_, end < kInf ? std::clamp(end, 0.0, offset) : offset / 2);
    kept = false;
  };
  // Forces alternate from step to step where joints are met on the average: no dips, and no two steps of one column.
  const auto keep_force = [&](Margin& margin, double value, bool holds) {
    if (!holds)
      ended(margin);
    else if (x.t + offset > margin.last[0].t)
      margin.add(x.t + offset, value);
  };
  auto tangent = static_cast<Index>(terms_.closed.size());
  for (std::size_t k = 0; k < terms_.closed.size(); ++k) {
    const auto c = at(terms_.closed[k].contact);
    const auto normal = static_cast<Index>(k);
    Lasting& lasting = lasting_[c];
    keep_force(lasting.normal, formulation_.solution().z[normal] / h, formulation_.solution().w[normal] <= tiny);
    if (!laws_[c].frictional()) continue;
    const double slip = formulation_.solution().w[tangent];
    if (lasting.mode == Mode::sticks)
      keep_force(lasting.tangent,
                 (laws_[c].mu * formulation_.solution().z[normal] - std::abs(formulation_.solution().z[tangent])) / h,
                 std::abs(slip) <= tiny);
    else if (slip * lasting.slip > tiny)
      look(lasting.tangent, x, offset, slip * lasting.slip, kNoise / weight_[2]);
    else
      ended(lasting.tangent);
    ++tangent;
  }
  return kept;
}

void Adaptive::look(Margin& margin, const State& x, double offset, double value, double noise) {
  margin.add(x.t + offset, value);
  if (const double dip = margin.dip(noise) - x.t; dip > kDipMet * offset) dip_ = std::min(dip_, dip);
}

bool Adaptive::plain_step(const State& x, double offset, double h, Solver& solver, StepReport& report) {
  if (!predict(x.t + offset, h)) return false;
  evaluate_gaps(system_, terms_);
  terms_.closed.clear();
  for (int c = 0; c < system_.contacts(); ++c)
    if (terms_.gap[c] <= 4 * slack_ || lasting_[at(c)].mode != Mode::open) terms_.closed.push_back({c, rows(c)});
  if (!solve(solver, system_.laws(), report)) return false;
  note_forces(terms_, v_new_, wanted_);
  drift(h);
  rise_ += energy_rise(system_, terms_, wanted_, v_, kick_);
  return true;
}

bool Adaptive::cross(double h, bool jumps, Solver& solver, const State& x, StepReport& report) {
  load(x);
  if (!plain_step(x, 0, h, solver, report)) return false;
  store(row_[0]);
  rise_ = 0;
  load(x);
  if (!plain_step(x, 0, h / 2, solver, report)) return false;
  std::fill(closed_.begin(), closed_.end(), false);
  for (const ClosedContact& c : terms_.closed) closed_[at(c.contact)] = true;
  v_half_ = v_;
  if (!plain_step(x, h / 2, h / 2, solver, report)) return false;
  store(row_[1]);
  const Index n = system_.dof();
  error_ = error(row_[0], row_[1]);
  // By whatever luck the halves agree: a jump of v somewhere in the step leaves positions uncertain by h |Δv|, one of
  // the acceleration leaves v so by a part of h |Δa|.
  row_[0] = row_[1];
  if (jumps)
    row_[0].head(n) += h * (v_ - x.v);
  else
    row_[0].segment(n, n) += (x.v - 2 * v_half_ + v_) / 4;
  error_ = std::max(error_, error(row_[0], row_[1])) / kCrossing;
  return true;
}

/// After a crossing: what lasts and how, from its second half; and what happened to each contact. True: some last.
bool Adaptive::settle_modes(double h, const State& x) {
  const double tiny = 10 * formulation_.solution().residual + 1e-13 * v_new_.lpNorm<Eigen::Infinity>();
  before_.swap(lasting_);
  std::fill(lasting_.begin(), lasting_.end(), Lasting{});
  auto tangent = static_cast<Index>(terms_.closed.size());
  bool any = false;
  for (std::size_t k = 0; k < terms_.closed.size(); ++k) {
    const auto c = at(terms_.closed[k].contact);
    const bool frictional = system_.laws()[c].frictional();
    const double slip = frictional ? formulation_.solution().w[tangent++] : 0;
    // The second half gave it a speed γ_N⁺ and would have changed it by −fall without contact. It lasts if it flies no
    // higher than rounding can tell; or if it was stopped, having been closed before, and would be back within a step
    // (else an impact elsewhere sent it off).
    const Row& row = terms_.closed[k].rows.normal;
    const double stopped_from = (1 + system_.laws()[c].e) * apply(row, v_half_.data());
    const double rebound = apply(row, x.v.data()), fall = stopped_from - problem().b[static_cast<Index>(k)];
    const bool low = rebound * rebound * h <= fall * slack_;
    const bool pressed =
        (closed_[c] || before_[c].mode != Mode::open) && formulation_.solution().w[static_cast<Index>(k)] <= tiny;
    if (!low && !(pressed && rebound <= 2 * std::abs(fall))) continue;
    lasting_[c].mode = frictional && std::abs(slip) <= tiny ? Mode::sticks : Mode::slides;
    lasting_[c].slip = slip < 0 ? -1 : 1;
    any = true;
  }
  for (std::size_t c = 0; c < lasting_.size(); ++c) {
    const Mode before = before_[c].mode, after = lasting_[c].mode;
    const auto happens = [&](EventKind kind) {
      events_.push_back({x.t, kind, static_cast<int>(c), sum_[c].normal, sum_[c].tangent});
    };
    if (before == Mode::open && sum_[c].normal > 0)
      happens(after == Mode::open || system_.laws()[c].e == 0 ? EventKind::impact : EventKind::accumulation);
    if (before != Mode::open && after == Mode::open) happens(EventKind::release);
    if (before == Mode::slides && after == Mode::sticks) happens(EventKind::stick);
    if (before == Mode::sticks && after == Mode::slides) happens(EventKind::slip);
  }
  return any;
}

/// Takes q_, v_ as the end of a step of h: onto the joints, and into x.
bool Adaptive::accept(double h, State& x, StepReport& report) {
  report.joint_residual = projection_.position(x.t + h, terms_, q_);
  report.joint_rate = projection_.velocity(terms_, v_);
  if (report.joint_rate > kEps * v_.lpNorm<Eigen::Infinity>()) report.joint_rate = projection_.velocity(terms_, v_);
  const double close = kJointsHold * (1 + q_.lpNorm<Eigen::Infinity>());
  if (!(report.joint_residual <= close) || !q_.allFinite() || !v_.allFinite()) return false;
  ++report.accepted;
  report.energy_rise = std::max(report.energy_rise, rise_);
  rise_ = 0;
  x.t += h;
  x.q.swap(q_), x.v.swap(v_);
  for (std::size_t i = 0; i < sum_.size(); ++i)
    impulses_[i].normal += sum_[i].normal, impulses_[i].tangent += sum_[i].tangent;
  evaluate_gaps(system_, terms_);
  gaps_ = terms_.gap;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  return true;
}

/// After a crossing: lasting contacts get γ_N = 0, sticking ones γ_T = 0.
bool Adaptive::bind(Solver& solver, State& x, StepReport& report) {
  load(x);
  if (!predict(x.t, 0)) return false;
  terms_.closed.clear();
  for (int c = 0; c < system_.contacts(); ++c) {
    laws_[at(c)] = {.belt = system_.law(c).belt};
    if (lasting_[at(c)].mode == Mode::open) continue;
    if (lasting_[at(c)].mode == Mode::sticks) laws_[at(c)].mu = 1;  // any: it gets a tangent row
    terms_.closed.push_back({c, rows(c)});
  }
  newtons_law(laws_, terms_, v_, wanted_);
  formulation_.formulate(terms_, basic_, wanted_, v_new_, lambda_);
  formulation_.bind();
  if (!formulation_.solve(solver, report)) return false;
  drift(0);
  x.v = v_;
  for (std::size_t i = 0; i < sum_.size(); ++i)
    impulses_[i].normal += sum_[i].normal, impulses_[i].tangent += sum_[i].tangent;
  return true;
}

void Adaptive::scale(const State& x) {
  double length = 0, speed = 0, omega = 0;
  for (Index i = 0; i < x.q.size(); i += 3) {
    length = std::max({length, std::abs(x.q[i]), std::abs(x.q[i + 1])});
    speed = std::max({speed, std::abs(x.v[i]), std::abs(x.v[i + 1])});
    omega = std::max(omega, std::abs(x.v[i + 2]));
  }
  const auto weight = [&](double size) { return 1 / (options_.atol + options_.rtol * size); };
  slack_ = 32 * kEps * length;
  weight_ = {weight(length), weight(1), weight(speed), weight(omega)};
}

double Adaptive::error(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  const Index n = system_.dof();
  double worst = 0;
  for (Index i = 0; i < 2 * n; ++i) {
    const double off = std::abs(a[i] - b[i]) * weight_[(i < n ? 0u : 2u) + (i % 3 == 2 ? 1u : 0u)];
    if (!(off <= worst)) worst = off;  // NaN too
  }
  return std::isfinite(worst) ? worst : kInf;
}

}  // namespace orthant
