// Lyapunov exponents of motions against closed forms: an unstable balance, a billiard, volumes that impacts contract.
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/derivatives/lyapunov.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <cmath>

using namespace orthant;

namespace {

Lyapunov exponents_of(const Scene& scene, const LyapunovClock& clock) {
  const auto solver = make_solver("auto");
  return lyapunov_exponents(System(scene), {}, *solver, clock);
}

const char* const kPendulum = R"(
gravity = [0, -9.81]
[[body]]
name = "rod"
mass = 1.5
inertia = 0.2
position = [0, 0.4]
[[body]]
name = "far"
mass = 1
inertia = 1
position = [9, 9]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "rod"]
point_b = [0, -0.4]
[[joint]]
name = "clamp"
type = "fixed"
bodies = ["ground", "far"]
point_a = [9, 9]
)";

// A ball between two posts, one behind the other on the x axis: the unstable orbit along the axis.
const char* const kBilliard = R"(
gravity = [0, 0]
[[body]]
name = "ball"
mass = 2
inertia = 0.1
velocity = [1.5, 0]
[[contact]]
name = "right"
type = "disc-disc"
bodies = ["ground", "ball"]
centre_a = [2.4, 0]
radius_a = 1.5
radius_b = 0.5
e_n = 1
[[contact]]
name = "left"
type = "disc-disc"
bodies = ["ground", "ball"]
centre_a = [-2.4, 0]
radius_a = 1.5
radius_b = 0.5
e_n = 1
)";

}  // namespace

TEST_CASE("Lyapunov exponents of a balanced rod: plus and minus the root of m g l over its moment of inertia") {
  const Lyapunov found = exponents_of(parse_scene(kPendulum, {}, "rod"), {2, 4, 3, 0.1});
  REQUIRE(found.status == Status::solved);
  CHECK(found.none.empty());
  const double exact = std::sqrt(1.5 * 9.81 * 0.4 / (0.2 + 1.5 * 0.4 * 0.4));
  REQUIRE(found.exponents.size() == 2);
  CHECK(std::abs(found.exponents[0] - exact) < 1e-8 * exact);
  CHECK(std::abs(found.exponents[1] + exact) < 1e-7 * exact);
  CHECK(std::abs(found.last_half[0] - exact) < 1e-8 * exact);
  CHECK_THROWS_WITH_AS(exponents_of(parse_scene(kPendulum, {}, "rod"), {3, 4, 3, 0.5}),
                       doctest::Contains("count: must be 1 ... 2"), std::invalid_argument);
}

TEST_CASE("Lyapunov exponents of a billiard orbit between two round posts: that of mirrors, through the impacts") {
  // flights of 0.8 m between mirrors of radius ρ = 2 m: half the trace of a flight and a bounce is 1 + L/ρ
  const double half = 1 + 0.8 / 2, exact = std::log(half + std::sqrt(half * half - 1)) * 1.5 / 0.8;
  const Lyapunov found = exponents_of(parse_scene(kBilliard, {}, "billiard"), {6, 16, 16, 0.8 / 1.5});
  REQUIRE(found.status == Status::solved);
  CHECK(found.none.empty());
  CHECK(std::abs(found.exponents[0] - exact) < 1e-6 * exact);
  CHECK(std::abs(found.exponents[5] + exact) < 1e-6 * exact);
  for (int i = 1; i < 5; ++i) CHECK(std::abs(found.exponents[i]) < 0.2);  // grow as t does: ln(t) / t
}

TEST_CASE("Lyapunov exponents of the impact oscillator: its Floquet multipliers have the modulus e") {
  const ImpactOscillator p;
  const double T = p.period(), exact = std::log(p.e) / T;
  const Lyapunov found = exponents_of(impact_oscillator(p), {6, 40 * T, 40.25 * T, T / 4});  // 40 impacts
  REQUIRE(found.status == Status::solved);
  CHECK(found.none.empty());
  CHECK(std::abs(found.exponents.sum() - 2 * exact) < 1e-6);
  for (int i = 0; i < 4; ++i) CHECK(std::abs(found.exponents[i]) < 0.02);  // of y and of the free rotation: ln(t) / t
  for (int i = 4; i < 6; ++i) CHECK(std::abs(found.exponents[i] - exact) < 0.006);
}

TEST_CASE("Lyapunov exponents: a plastic impact takes directions away") {
  const std::vector<std::string> sets = {"e=0", "height=0.1"};
  const Lyapunov landed = exponents_of(make_scene("bouncing_ball", sets), {6, 0.3, 0, 0.1});
  REQUIRE(landed.status == Status::solved);
  CHECK(std::isinf(landed.exponents[5]));
  CHECK(landed.exponents[5] < 0);
  CHECK(std::isinf(landed.exponents[4]));
  CHECK(std::isfinite(landed.exponents[3]));
}
