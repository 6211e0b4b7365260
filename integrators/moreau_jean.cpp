#include <orthant/integrators/moreau_jean.h>

namespace orthant {

void MoreauJean::close(double h, const State& x) {
  constexpr double kParted = 1e-3;  // of the way that the applied forces move anything
  const double moved = h * h * free_fall();
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, nearly(h, x) + kParted * moved, terms_);
  newtons_law(system_.laws(), terms_, x.v, wanted_);
}

}  // namespace orthant
