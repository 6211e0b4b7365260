#include <orthant/core/support/options.h>
#include <orthant/integrators/adaptive/adaptive.h>
#include <orthant/integrators/between_events/look_ahead.h>

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
constexpr double kSwing = 3;       // [rad] that a load swings in an arc, at the most
constexpr double kTelling = 0.01;  // below, the error of an arc that was cut short may be rounding
constexpr int kCrowd = 200;        // inner steps, rejected ones too, after which is looked how far they came
constexpr double kLeastFloor = 1e-6, kMostFloor = 1e-4;  // [s]

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
    report.crossings += error_ > 1;
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
