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

template <class Space> double StewartTrinkleOf<Space>::reach(const Step& step) const {
  return cone_ == Cone::coulomb ? step.nearly() : kInf;
}

template <class Space>
double StewartTrinkleOf<Space>::least(const Step& step, const ClosedContact& c, const Eigen::VectorXd& v) const {
  if (cone_ == Cone::coulomb) return closing(step, c);
  const ContactLaw& law = step.system.law(c.contact);
  const auto slip = slip_rate(c.rows, v.data()) - belt_of(law, c.rows);
  return closing(step, c) + mu_at(law, slip) * size_of(slip);
}

/// start_.closed: rows at x of the contacts with restitution that approach by the rows at the end of free flight.
template <class Space> void StewartTrinkleOf<Space>::find_approaches(const Step& step) {
  start_.closed.clear();
  bool placed = false;
  for (std::size_t k = 0; k < step.targets.size(); ++k) {
    const int contact = step.terms.closed[k].contact;
    if (!(step.system.law(contact).e > 0) || !(step.targets[k].approach < 0)) continue;
    if (!placed) start_.pairs = step.terms.pairs, set_poses(step.system, step.x.t, step.x.q, start_.at);
    placed = true;
    add_closed(step.system, contact, start_);
  }
}

template <class Space> void StewartTrinkleOf<Space>::set_targets(Step& step) {
  find_approaches(step);
  auto start = start_.closed.begin();
  constexpr double kPace = 0.25;  // at which penetration is pushed out at the most, see the header
  for (std::size_t k = 0; k < step.targets.size(); ++k) {
    const ClosedContact& c = step.terms.closed[k];
    const double pace = kPace * (speed(c.rows, step.x.v) + speed(c.rows, step.v));
    const double approach = std::min(closing(step, c), pace);
    const double e = step.system.law(c.contact).e;
    double rebound = e > 0 ? step.targets[k].normal : approach;
    if (start != start_.closed.end() && start->contact == c.contact) {
      const double rate = apply(start->rows.normal, step.x.v.data());
      const bool lasts = -rate <= std::abs(step.targets[k].approach - rate);
      rebound = lasts ? approach : -e * rate;
      ++start;
    }
    step.targets[k].normal = std::max(rebound, approach);
    step.targets[k].least = approach;
  }
}

template class StewartTrinkleOf<Planar>;
template class StewartTrinkleOf<Spatial>;

}  // namespace orthant
