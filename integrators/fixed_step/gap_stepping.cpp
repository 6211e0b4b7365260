#include <orthant/integrators/fixed_step/gap_stepping.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// |γ_N| + |γ_T| [m/s]: of the two surfaces against each other, whatever the frame.
template <class Space>
double speed(const ContactRowsOf<Space>& rows, const Eigen::VectorXd& v, const Tangent<Space>& belt) {
  return std::abs(apply(rows.normal, v.data())) + size_of(slip_rate(rows, v.data()) - belt);
}

/// Σ |J_k| |a_k − b_k| [m/s]: of the velocities without regard to signs.
template <class Space>
double largest_change(const RowOf<Space>& row, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  double sum = 0;
  each_entry(row, [&](Index k, double entry) { sum += std::abs(entry) * std::abs(a[k] - b[k]); });
  return sum;
}

}  // namespace

/// step.terms is at the end of free flight, with its gaps: sets held_ and their gaps.
template <class Space> void GapSteppingOf<Space>::hold_directions(Step& step) {
  held_.clear();
  if constexpr (kPlanar<Space>) {
    if (ropes_.empty()) return;
    TermsOf<Space>& start = rope_start_;
    set_poses(step.system, step.x.t, step.x.q, start.at);
    start.pairs = step.terms.pairs;
    evaluate_gaps(step.system, start);
    for (const int i : ropes_) {
      start.closed.clear(), step.terms.closed.clear();
      add_closed(step.system, i, start), add_closed(step.system, i, step.terms);
      const ClosedContact& before = start.closed[0];
      if (!turned_back(before.rows.normal, step.terms.closed[0].rows.normal)) continue;
      const double gap = start.gap[i] + step.h * apply(before.rows.normal, flight_.data());
      if (gap > step.nearly()) continue;
      step.terms.gap[i] = gap;
      held_.push_back(before);
    }
    step.terms.closed.clear();
  }
}

template <class Space> void GapSteppingOf<Space>::close(Step& step) {
  flight_ = step.v;
  move<Space>(step.x.q, step.h * flight_, step.q_end);
  TermsOf<Space>& terms = step.terms;
  set_poses(step.system, step.x.t + step.h, step.q_end, terms.at);
  step.set_frames();
  evaluate_gaps(step.system, terms);
  hold_directions(step);
  terms.closed.clear();
  const double near = reach(step);
  for (int i = 0; i < step.system.contacts(); ++i) {
    const bool joined = std::find(step.joined.begin(), step.joined.end(), i) != step.joined.end();
    if (terms.gap[i] == kInf || (terms.gap[i] > near && !joined)) continue;
    add_closed(step.system, i, terms);
    for (const ClosedContact& held : held_)
      if (held.contact == i) terms.closed.back() = held;
    const ClosedContact& c = terms.closed.back();
    if (!joined && apply(c.rows.normal, flight_.data()) > least(step, c, flight_) + step.nearly(c.rows) / step.h)
      terms.closed.pop_back();
  }
  newtons_law(step.system.laws(), terms, step.x.v, step.targets);
  set_targets(step);
}

template <class Space> bool GapSteppingOf<Space>::missed(Step& step) {
  TermsOf<Space>& terms = step.terms;
  if (terms.closed.empty() || step.v == flight_) return false;
  const double h = step.h;
  const std::size_t before = step.joined.size(), taking_part = terms.closed.size();
  for (int i = 0, next = 0; i < step.system.contacts(); ++i) {
    if (static_cast<std::size_t>(next) < taking_part && terms.closed[static_cast<std::size_t>(next)].contact == i) {
      ++next;
      continue;
    }
    if (terms.gap[i] == kInf) continue;
    add_closed(step.system, i, terms);
    const ClosedContact c = terms.closed.back();
    terms.closed.pop_back();
    const double rate = apply(c.rows.normal, step.v.data()), near = step.nearly(c.rows);
    const auto belt = belt_of(step.system.law(i), c.rows);
    if (rate < apply(c.rows.normal, flight_.data()) && rate < least(step, c, step.v) - near / h &&
        terms.gap[i] <= h * (speed<Space>(c.rows, step.x.v, belt) + speed<Space>(c.rows, flight_, belt) +
                             largest_change<Space>(c.rows.normal, flight_, step.x.v)) +
                            near)
      step.joined.push_back(i);
  }
  if (step.joined.size() == before) return false;
  step.v = flight_;
  return true;
}

template class GapSteppingOf<Planar>;
template class GapSteppingOf<Spatial>;

}  // namespace orthant
