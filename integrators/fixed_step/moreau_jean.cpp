#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/integrators/step/polygon_points.h>

#include <algorithm>

namespace orthant {

template <class Space> bool MoreauJeanOf<Space>::may_slide_off(const typename System::Scene& scene) {
  if constexpr (kPlanar<Space>) {
    const auto pair = [](const Contact& c) { return std::holds_alternative<PolygonPolygon>(c); };
    return !scene.collisions.empty() || std::ranges::any_of(scene.contacts, pair);
  } else {
    static_cast<void>(scene);
    return false;
  }
}

template <class Space> void MoreauJeanOf<Space>::close(double h, const State& x) {
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, nearly(), terms_);
  auto& closed = terms_.closed;
  std::erase_if(closed, [&](const ClosedContact& c) { return terms_.gap[c.contact] > nearly(c.rows); });
  if constexpr (kPlanar<Space>)
    for (std::size_t k = 0; polygons_ && k + 1 < closed.size(); ++k)
      if (closed[k].contact + 1 == closed[k + 1].contact) {
        const std::size_t off = slides_off(h, x, k);
        if (off < closed.size()) closed.erase(closed.begin() + static_cast<std::ptrdiff_t>(off));
      }
  newtons_law(system_.laws(), terms_, x.v, wanted_);
}

template <class Space> std::size_t MoreauJeanOf<Space>::slides_off([[maybe_unused]] double h,
                                                                   [[maybe_unused]] const State& x,
                                                                   [[maybe_unused]] std::size_t k) const {
  if constexpr (!kPlanar<Space>)
    return terms_.closed.size();
  else {
    const auto& closed = terms_.closed;
    const bool first = terms_.gap[closed[k].contact] > terms_.gap[closed[k + 1].contact];  // is the shallower one
    const ClosedContact &deep = closed[first ? k + 1 : k], &shallow = closed[first ? k : k + 1];
    const double d = terms_.gap[shallow.contact] - terms_.gap[deep.contact], near = nearly(shallow.rows);
    const double rate = apply(shallow.rows.normal, x.v.data());
    if (!(d > near) || !(h * rate < -near)) return closed.size();
    if (bodies_of(system_, terms_.pairs, deep.contact) != bodies_of(system_, terms_.pairs, shallow.contact))
      return closed.size();
    const auto points = polygon_points(system_, terms_.pairs, deep.contact, terms_.at);
    if (!points) return closed.size();
    const bool ends = overlap_ends(*points, terms_.at, x.v, d, rate - apply(deep.rows.normal, x.v.data()));
    return ends ? (first ? k : k + 1) : closed.size();
  }
}

template class MoreauJeanOf<Planar>;
template class MoreauJeanOf<Spatial>;

}  // namespace orthant
