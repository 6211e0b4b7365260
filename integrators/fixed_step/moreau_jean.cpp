#include <orthant/integrators/fixed_step/moreau_jean.h>
#include <orthant/integrators/step/polygon_points.h>

#include <algorithm>

namespace orthant {

bool MoreauJean::may_slide_off(const Scene& scene) {
  const auto pair = [](const Contact& c) { return std::holds_alternative<PolygonPolygon>(c); };
  return !scene.collisions.empty() || std::ranges::any_of(scene.contacts, pair);
}

void MoreauJean::close(double h, const State& x) {
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, nearly(), terms_);
  auto& closed = terms_.closed;
  std::erase_if(closed, [&](const ClosedContact& c) { return terms_.gap[c.contact] > nearly(c.rows); });
  for (std::size_t k = 0; polygons_ && k + 1 < closed.size(); ++k)
    if (closed[k].contact + 1 == closed[k + 1].contact) {
      const std::size_t off = slides_off(h, x, k);
      if (off < closed.size()) closed.erase(closed.begin() + static_cast<std::ptrdiff_t>(off));
    }
  newtons_law(system_.laws(), terms_, x.v, wanted_);
}

std::size_t MoreauJean::slides_off(double h, const State& x, std::size_t k) const {
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

}  // namespace orthant
