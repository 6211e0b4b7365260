#include <orthant/integrators/stewart_trinkle.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// |γ_N| + |γ_T| [m/s]: of the two surfaces against each other, whatever the frame.
double speed(const ContactRows& rows, const Eigen::VectorXd& v) {
  return std::abs(apply(rows.normal, v.data())) + std::abs(apply(rows.tangent, v.data()));
}

}  // namespace

void StewartTrinkle::close(double h, const State& x) {
  if (cone_ == Cone::coulomb)
    close_at_end_of_flight(h, x, nearly(),
                           [&](const ClosedContact& c) { return terms_.gap[c.contact] <= nearly(c.rows); });
  else
    close_at_end_of_flight(h, x, kInf, [&](const ClosedContact& c) {
      const ContactLaw& law = system_.law(c.contact);
      const double slip = apply(c.rows.tangent, v_new_.data()) - law.belt;
      return terms_.gap[c.contact] <= nearly(c.rows) + h * law.mu_at(slip) * std::abs(slip);
    });
  constexpr double kPace = 0.25;  // at which penetration is pushed out at the most, see the header
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const ContactRows& rows = terms_.closed[k].rows;
    const double pace = kPace * (speed(rows, x.v) + speed(rows, v_new_));
    const double approach = std::min(closing(terms_.closed[k], h), pace);
    const bool rebounds = system_.law(terms_.closed[k].contact).e > 0;
    wanted_[k].normal = rebounds ? std::max(wanted_[k].normal, approach) : approach;
    wanted_[k].least = approach;
  }
}

}  // namespace orthant
