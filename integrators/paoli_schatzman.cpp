#include <orthant/integrators/paoli_schatzman.h>

namespace orthant {

void PaoliSchatzman::close(double h, const State& x) {
  const auto least = [&](const ClosedContact& c) {
    const double e = system_.law(c.contact).e;
    return e * apply(c.rows.normal, x.v.data()) + (1 + e) * closing(c, h);
  };
  close_at_end_of_flight(h, x, kInf, [&](const ClosedContact& c) {
    return apply(c.rows.normal, v_new_.data()) <= least(c) + nearly(c.rows) / h;
  });
  for (std::size_t k = 0; k < wanted_.size(); ++k) wanted_[k].normal = wanted_[k].least = least(terms_.closed[k]);
}

}  // namespace orthant
