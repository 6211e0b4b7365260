#include <orthant/integrators/fixed_step/stewart_trinkle.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// |γ_N| + |γ_T| [m/s]: of the two surfaces against each other, whatever the frame.
template <class Rows> double speed(const Rows& rows, const Eigen::VectorXd& v) {
  return std::abs(apply(rows.normal, v.data())) + size_of(slip_rate(rows, v.data()));
}

}  // namespace

template <class Space> double StewartTrinkleOf<Space>::reach() const {
  return cone_ == Cone::coulomb ? nearly() : kInf;
}

template <class Space>
double StewartTrinkleOf<Space>::least(const ClosedContact& c, double h, const State&, const Eigen::VectorXd& v) const {
  if (cone_ == Cone::coulomb) return closing(c, h);
  const ContactLaw& law = system_.law(c.contact);
  const auto slip = slip_rate(c.rows, v.data()) - belt_of(law, c.rows);
  return closing(c, h) + mu_at(law, slip) * size_of(slip);
}

/// start_.closed: rows at x of the contacts with restitution that approach by the rows at the end of free flight.
template <class Space> void StewartTrinkleOf<Space>::find_approaches(const State& x) {
  start_.closed.clear();
  bool placed = false;
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const int contact = terms_.closed[k].contact;
    if (!(system_.law(contact).e > 0) || !(wanted_[k].approach < 0)) continue;
    if (!placed) start_.pairs = terms_.pairs, set_poses(system_, x.t, x.q, start_.at);
    placed = true;
    add_closed(system_, contact, start_);
  }
}

template <class Space> void StewartTrinkleOf<Space>::want(double h, const State& x) {
  find_approaches(x);
  auto start = start_.closed.begin();
  constexpr double kPace = 0.25;  // at which penetration is pushed out at the most, see the header
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const auto& rows = terms_.closed[k].rows;
    const double pace = kPace * (speed(rows, x.v) + speed(rows, v_new_));
    const double approach = std::min(closing(terms_.closed[k], h), pace);
    const double e = system_.law(terms_.closed[k].contact).e;
    double rebound = e > 0 ? wanted_[k].normal : approach;
    if (start != start_.closed.end() && start->contact == terms_.closed[k].contact) {
      const double rate = apply(start->rows.normal, x.v.data());
      const bool lasts = -rate <= std::abs(wanted_[k].approach - rate);
      rebound = lasts ? approach : -e * rate;
      ++start;
    }
    wanted_[k].normal = std::max(rebound, approach);
    wanted_[k].least = approach;
  }
}

template class StewartTrinkleOf<Planar>;
template class StewartTrinkleOf<Spatial>;

}  // namespace orthant
