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

template <class Space> void GapSteppingOf<Space>::close(double h, const State& x) {
  flight_ = v_new_;
  move<Space>(x.q, h * flight_, q_new_);
  set_poses(system_, x.t + h, q_new_, terms_.at);
  this->set_frames();
  evaluate_gaps(system_, terms_);
  terms_.closed.clear();
  const double near = reach();
  for (int i = 0; i < system_.contacts(); ++i) {
    const bool joined = std::find(joined_.begin(), joined_.end(), i) != joined_.end();
    if (terms_.gap[i] == kInf || (terms_.gap[i] > near && !joined)) continue;
    add_closed(system_, i, terms_);
    const ClosedContact& c = terms_.closed.back();
    if (!joined && apply(c.rows.normal, flight_.data()) > least(c, h, x, flight_) + nearly(c.rows) / h)
      terms_.closed.pop_back();
  }
  newtons_law(system_.laws(), terms_, x.v, wanted_);
  want(h, x);
}

template <class Space> bool GapSteppingOf<Space>::missed(double h, const State& x) {
  if (terms_.closed.empty() || v_new_ == flight_) return false;
  const std::size_t before = joined_.size(), taking_part = terms_.closed.size();
  for (int i = 0, next = 0; i < system_.contacts(); ++i) {
    if (static_cast<std::size_t>(next) < taking_part && terms_.closed[static_cast<std::size_t>(next)].contact == i) {
      ++next;
      continue;
    }
    if (terms_.gap[i] == kInf) continue;
    add_closed(system_, i, terms_);
    const ClosedContact c = terms_.closed.back();
    terms_.closed.pop_back();
    const double rate = apply(c.rows.normal, v_new_.data());
    const auto belt = belt_of(system_.law(i), c.rows);
    if (rate < apply(c.rows.normal, flight_.data()) && rate < least(c, h, x, v_new_) - nearly(c.rows) / h &&
        terms_.gap[i] <= h * (speed<Space>(c.rows, x.v, belt) + speed<Space>(c.rows, flight_, belt) +
                              largest_change<Space>(c.rows.normal, flight_, x.v)) +
                             nearly(c.rows))
      joined_.push_back(i);
  }
  if (joined_.size() == before) return false;
  v_new_ = flight_;
  return true;
}

template class GapSteppingOf<Planar>;
template class GapSteppingOf<Spatial>;

}  // namespace orthant
