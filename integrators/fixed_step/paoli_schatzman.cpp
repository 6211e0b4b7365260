#include <orthant/integrators/fixed_step/paoli_schatzman.h>

#include <algorithm>

namespace orthant {

template <class Space>
double PaoliSchatzmanOf<Space>::least(const Step& step, const ClosedContact& c, const Eigen::VectorXd&) const {
  const double e = step.system.law(c.contact).e;
  return e * apply(c.rows.normal, step.x.v.data()) + (1 + e) * closing(step, c);
}

template <class Space> void PaoliSchatzmanOf<Space>::set_targets(Step& step) {
  for (std::size_t k = 0; k < step.targets.size(); ++k) {
    const ClosedContact& c = step.terms.closed[k];
    step.targets[k].normal = step.targets[k].least = least(step, c, step.v);
    step.targets[k].plastic = std::min(step.targets[k].normal, closing(step, c));
  }
}

template class PaoliSchatzmanOf<Planar>;
template class PaoliSchatzmanOf<Spatial>;

}  // namespace orthant
