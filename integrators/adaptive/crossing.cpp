// Where an Adaptive integrator crosses an event by a step of time stepping, and its two halves.
#include <orthant/integrators/adaptive/adaptive.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kTogether = 4;    // of the rounding of gaps: contacts this near count as closed in a crossing
constexpr double kCrossing = 0.2;  // of the tolerance: an event's error is of one sign, and comes on top of the arcs'

}  // namespace

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

}  // namespace orthant
