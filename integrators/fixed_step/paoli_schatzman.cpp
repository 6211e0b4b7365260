#include <orthant/integrators/fixed_step/paoli_schatzman.h>

#include <algorithm>

namespace orthant {

template <class Space>
double PaoliSchatzmanOf<Space>::least(const ClosedContact& c, double h, const State& x, const Eigen::VectorXd&) const {
  const double e = system_.law(c.contact).e;
  return e * apply(c.rows.normal, x.v.data()) + (1 + e) * closing(c, h);
}

template <class Space> void PaoliSchatzmanOf<Space>::want(double h, const State& x) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    wanted_[k].normal = wanted_[k].least = least(terms_.closed[k], h, x, v_new_);
    wanted_[k].plastic = std::min(wanted_[k].normal, closing(terms_.closed[k], h));
  }
}

template class PaoliSchatzmanOf<Planar>;
template class PaoliSchatzmanOf<Spatial>;

}  // namespace orthant
