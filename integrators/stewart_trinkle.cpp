#include <orthant/integrators/stewart_trinkle.h>

namespace orthant {

void StewartTrinkle::close(double h, const State& x) {
  if (cone_ == Cone::coulomb)
    close_at_end_of_flight(h, x, nearly(h, x), [](const ClosedContact&) { return true; });
  else
    close_at_end_of_flight(h, x, kInf, [&](const ClosedContact& c) {
      const ContactLaw& law = system_.law(c.contact);
      const double slip = apply(c.rows.tangent, v_new_.data()) - law.belt;
      return terms_.gap[c.contact] <= nearly(h, x) + h * law.mu_at(slip) * std::abs(slip);
    });
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const double approach = closing(terms_.closed[k], h);
    const bool rebounds = system_.law(terms_.closed[k].contact).e > 0;
    wanted_[k].normal = rebounds ? std::max(wanted_[k].normal, approach) : approach;
    wanted_[k].least = approach;
  }
}

}  // namespace orthant
