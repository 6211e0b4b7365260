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

template <class Space> void MoreauJeanOf<Space>::close(Step& step) {
  TermsOf<Space>& terms = step.terms;
  evaluate_gaps(step.system, terms);
  evaluate_closed(step.system, step.nearly(), terms);
  auto& closed = terms.closed;
  std::erase_if(closed, [&](const ClosedContact& c) { return terms.gap[c.contact] > step.nearly(c.rows); });
  if constexpr (kPlanar<Space>)
    for (std::size_t k = 0; polygons_ && k + 1 < closed.size(); ++k)
      if (closed[k].contact + 1 == closed[k + 1].contact) {
        const std::size_t off = slides_off(step, k);
        if (off < closed.size()) closed.erase(closed.begin() + static_cast<std::ptrdiff_t>(off));
      }
  newtons_law(step.system.laws(), terms, step.x.v, step.targets);
}

template <class Space> std::size_t MoreauJeanOf<Space>::slides_off(const Step& step, [[maybe_unused]] std::size_t k) {
  const auto& closed = step.terms.closed;
  if constexpr (!kPlanar<Space>)
    return closed.size();
  else {
    const Terms& terms = step.terms;
    const Eigen::VectorXd& v = step.x.v;
    const bool first = terms.gap[closed[k].contact] > terms.gap[closed[k + 1].contact];  // is the shallower one
    const ClosedContact &deep = closed[first ? k + 1 : k], &shallow = closed[first ? k : k + 1];
    const double d = terms.gap[shallow.contact] - terms.gap[deep.contact], near = step.nearly(shallow.rows);
    const double rate = apply(shallow.rows.normal, v.data());
    if (!(d > near) || !(step.h * rate < -near)) return closed.size();
    if (bodies_of(step.system, terms.pairs, deep.contact) != bodies_of(step.system, terms.pairs, shallow.contact))
      return closed.size();
    const auto points = polygon_points(step.system, terms.pairs, deep.contact, terms.at);
    if (!points) return closed.size();
    const bool ends = overlap_ends(*points, terms.at, v, d, rate - apply(deep.rows.normal, v.data()));
    return ends ? (first ? k : k + 1) : closed.size();
  }
}

template class MoreauJeanOf<Planar>;
template class MoreauJeanOf<Spatial>;

}  // namespace orthant
