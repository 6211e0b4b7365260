#include <orthant/core/mechanics/blocks.h>
#include <orthant/integrators/derivatives/run_columns.h>
#include <orthant/integrators/derivatives/touching_start.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kNoGap = 8 * 0x1p-52;  // of the lengths in it
constexpr double kNoChange = 1e-8;      // of a gap: of the parts that it is a sum of

/// [m] The coordinates and levers that the gap is a difference of.
template <class Space>
double lengths_in_gap(const SystemOf<Space>& system, const State& x, int contact, const KinematicsOf<Space>& at) {
  const auto [a, b] = bodies_of(system, {}, contact);
  double sum = 0;
  for (const BodyId body : {a, b}) {
    if (body < 0) continue;
    for (Index i = 0; i < Space::kTranslations; ++i) sum += std::abs(x.q[Space::kCoordinates * body + i]);
  }
  const auto row = std::visit([&](const auto& c) { return c.rows(at).normal; },
                              system.scene().contacts[static_cast<std::size_t>(contact)]);
  each_entry(row, [&](Index place, double j) {
    if (place % Space::kVelocities >= Space::kTranslations) sum += std::abs(j);
  });
  return sum;
}

}  // namespace

template <class Space> std::vector<int> touching_starts(const SystemOf<Space>& system, const State& start, double ahead,
                                                        const std::vector<ParameterChangeOf<Space>>& changes,
                                                        const DirectionBlock& q, const DirectionBlock& v) {
  State x = start;
  x.t += ahead;
  move<Space>(start.q, ahead * start.v, x.q);
  KinematicsOf<Space> at = TermsOf<Space>(system).at;
  set_poses(system, x.t, x.q, at);
  std::vector<RunColumn> gaps;
  std::vector<double> rounding;  // [m] of each
  for (int c = 0; c < system.contacts(); ++c) {
    const double none = kNoGap * lengths_in_gap(system, x, c, at);
    if (std::abs(gap_of(system, {}, c, at)) <= none)
      gaps.push_back({RunColumn::Kind::gap, c}), rounding.push_back(none);
  }
  std::vector<int> touching;
  if (gaps.empty()) return touching;
  ColumnSlopesOf<Space> slopes(system, gaps);
  slopes.set_up(x);
  for (std::size_t i = 0; i < gaps.size(); ++i)
    for (std::size_t j = 0; j < changes.size(); ++j) {
      const auto column = static_cast<Index>(j);
      const Eigen::VectorXd change = q.col(column) + ahead * v.col(column);
      const double by_geometry = slopes.by_parameter(i, changes[j]);
      const double by_state = slopes.push(i, changes[j], change.data(), change.data()) - by_geometry;
      const double of_differences = changes[j].of_scene() ? rounding[i] / changes[j].step : 0;
      const double none = kNoChange * (std::abs(by_geometry) + change.template lpNorm<1>()) + of_differences;
      if (std::abs(by_state + by_geometry) <= none) continue;
      touching.push_back(static_cast<int>(gaps[i].place));
      break;
    }
  return touching;
}

template std::vector<int> touching_starts(const SystemOf<Planar>&, const State&, double,
                                          const std::vector<ParameterChangeOf<Planar>>&, const DirectionBlock&,
                                          const DirectionBlock&);
template std::vector<int> touching_starts(const SystemOf<Spatial>&, const State&, double,
                                          const std::vector<ParameterChangeOf<Spatial>>&, const DirectionBlock&,
                                          const DirectionBlock&);

}  // namespace orthant
