// Slopes of rows by the poses of their bodies: formulas against differences of the rows themselves.
#include <doctest/doctest.h>

#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/support/random.h>
#include <orthant/integrators/derivatives/row_slope.h>

using namespace orthant;

namespace {

Scene two_bodies() {
  Scene scene;
  scene.bodies.push_back({.name = "one", .position = {0.3, -0.2}, .angle = 0.4});
  scene.bodies.push_back({.name = "two", .position = {-1.1, 0.7}, .angle = -1.3});
  return scene;
}

// Differences of fourth order of rows(kinematics), of all their entries by all coordinates.
template <std::size_t n, class F>
void check_slopes(const System& system, Kinematics& at, const std::array<RowSlope, n>& slopes, F&& rows) {
  constexpr double kAway = 1e-3;
  const Eigen::VectorXd q = system.initial_state().q;
  for (Index by = 0; by < system.dof(); ++by) {
    std::array<std::array<Row, n>, 4> there;
    const std::array<int, 4> places{-2, -1, 1, 2};
    for (std::size_t k = 0; k < 4; ++k) {
      Eigen::VectorXd moved = q;
      moved[by] += places[k] * kAway;
      set_poses(system, 0, moved, at);
      there[k] = rows(at);
    }
    for (std::size_t i = 0; i < n; ++i) {
      Eigen::VectorXd difference = Eigen::VectorXd::Zero(system.dof()), found = difference;
      const std::array<double, 4> weights{1. / 12, -8. / 12, 8. / 12, -1. / 12};
      for (std::size_t k = 0; k < 4; ++k) apply_transposed(there[k][i], weights[k] / kAway, difference.data());
      for (const Slope& slope : slopes[i])
        if (slope.by == by) found[slope.of] += slope.value;
      CHECK((found - difference).lpNorm<Eigen::Infinity>() < 1e-9);
    }
  }
}

}  // namespace

TEST_CASE("slopes of a distance, a span, a journal and two discs: formulas, with both bodies and with the ground") {
  const System system(two_bodies());
  Kinematics at = Terms(system).at;
  const auto here = [&] { set_poses(system, 0, system.initial_state().q, at); };
  const std::array<std::pair<BodyId, BodyId>, 4> pairs{{{0, 1}, {1, 0}, {0, kGround}, {kGround, 1}}};
  for (const auto& [a, b] : pairs) {
    const Distance link{"link", a, b, {0.2, 0.1}, {-0.3, 0.4}, 1};
    std::array<RowSlope, 1> one;
    here(), slopes_of(Joint(link), at, one.data());
    check_slopes(system, at, one, [&](const Kinematics& k) {
      std::array<Row, 1> row;
      link.rows(k, row.data());
      return row;
    });
    const Coordinate span = Span{a, b, {0.2, 0.1}, {-0.3, 0.4}};
    here(), slope_of(span, at, one[0]);
    check_slopes(system, at, one, [&](const Kinematics& k) { return std::array<Row, 1>{span.row(k)}; });
    const Journal hole{"hole", a, {0.2, 0.1}, 0.25, b, {-0.3, 0.4}, 3, {}};
    std::array<RowSlope, 2> both;
    here(), slopes_of(Contact(hole), at, both);
    check_slopes(system, at, both, [&](const Kinematics& k) {
      const ContactRows rows = hole.rows(k);
      return std::array<Row, 2>{rows.normal, rows.tangent};
    });
    const DiscDisc discs{"discs", a, {0.2, 0.1}, 0.5, b, {-0.3, 0.4}, 0.25, {}};
    here(), slopes_of(Contact(discs), at, both);
    check_slopes(system, at, both, [&](const Kinematics& k) {
      const ContactRows rows = discs.rows(k);
      return std::array<Row, 2>{rows.normal, rows.tangent};
    });
  }
}
