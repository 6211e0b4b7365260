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

template <class Space> void StewartTrinkleOf<Space>::set_targets(Step& step) {
  constexpr double kPace = 0.25;  // at which penetration is pushed out at the most, see the header
  for (std::size_t k = 0; k < step.targets.size(); ++k) {
    const ClosedContact& c = step.terms.closed[k];
    const double pace = kPace * (speed(c.rows, step.x.v) + speed(c.rows, step.v));
    const double approach = std::min(closing(step, c), pace);
    const bool rebounds = step.system.law(c.contact).e > 0;
    step.targets[k].normal = rebounds ? std::max(step.targets[k].normal, approach) : approach;
    step.targets[k].least = approach;
  }
}

template class StewartTrinkleOf<Planar>;
template class StewartTrinkleOf<Spatial>;

}  // namespace orthant
