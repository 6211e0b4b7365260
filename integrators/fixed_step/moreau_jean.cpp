#include <orthant/integrators/fixed_step/moreau_jean.h>

namespace orthant {

void MoreauJean::close(double /*h*/, const State& x) {
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, nearly(), terms_);
  std::erase_if(terms_.closed, [&](const ClosedContact& c) { return terms_.gap[c.contact] > nearly(c.rows); });
  newtons_law(system_.laws(), terms_, x.v, wanted_);
}

}  // namespace orthant
