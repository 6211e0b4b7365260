// Impulses that contacts share by the solver's choice: their derivatives are said to be such.
#include "tests/integrators/derivatives/spatial_trials.h"

namespace orthant {

namespace {

bool any_has(const std::vector<std::string>& warnings, const char* words) {
  return std::ranges::any_of(warnings, [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

const char* const kBoxOnSlope = R"(
gravity = [0, -9.81]
[[body]]
name = "b"
mass = 2
inertia = 0.05
position = [0, 0.10467516015380857]
angle = 0.3
[[contact]]
type = "polygon-wall"
name = "f"
body = "b"
corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]]
wall = {normal = [-0.29552020666133955, 0.955336489125606]}
mu = 0.6
)";
const char* const kBlockInChannel = R"(
dimension = 3
gravity = [1, 0.5, -9.81]
[[body]]
name = "k"
mass = 0.8
inertia = [0.004, 0.005, 0.006]
position = [0, 3, 0.0005]
velocity = [0.2, 0.3, 0.1]
omega = [0.3, 0.2, 0.1]
[[contact]]
type = "block-channel"
name = "bc"
bodies = ["k", "ground"]
centre_b = [0, 3, 0]
axis = [1, 0, 0]
up = [0, 0, 1]
size = [0.1, 0.06, 0.04]
width = 0.062
height = 0.043
mu = 0.2
e_n = 0.3
)";

}  // namespace

TEST_CASE("derivatives of impulses that two corners hold together are said to be those of even shares, by both modes") {
  const System system(from_text(kBoxOnSlope)({}));
  const auto solver = make_solver("auto");
  const Clock clock{.step = 1e-3, .duration = 0.05};
  const auto mass = parameters_by_keys(kBoxOnSlope, {{"body.b.mass", 2}});
  const std::vector<RunColumn> impulses = {{RunColumn::Kind::tangent, 0}, {RunColumn::Kind::tangent, 1}}, place(2);
  const auto forward = [&](const auto& columns) {
    return differentiate_run(system, mass, MoreauJeanOptions{}, *solver, clock, columns).warnings;
  };
  const auto reverse = [&](const auto& columns) {
    return differentiate_run_reverse(system, mass, MoreauJeanOptions{}, *solver, clock, columns, 2, weigh_last())
        .warnings;
  };
  CHECK(any_has(forward(impulses), "share their impulses by the solver's choice"));
  CHECK(any_has(reverse(impulses), "share their impulses by the solver's choice"));
  CHECK_FALSE(any_has(forward(place), "share"));
  CHECK_FALSE(any_has(reverse(place), "share"));
}

TEST_CASE("derivatives in space: contacts that slide and share a load that rigid bodies leave open are named") {
  const auto warnings = [](const std::string& text) {
    const SystemOf<Spatial> system(spatial_from_text(text));
    const auto solver = make_solver("auto");
    const std::vector<SpatialParameter> mass = {by_key(text, "body.k.mass", 0.8)};
    const Clock clock{.step = 1e-3, .duration = 0.01};
    return differentiate_run(system, mass, {}, *solver, clock).warnings;
  };
  CHECK(any_has(warnings(kBlockInChannel), "contacts that slide share a load which rigid bodies leave open"));
  std::string smooth = kBlockInChannel;
  smooth.replace(smooth.find("mu = 0.2"), 8, "mu = 0.0");
  CHECK_FALSE(any_has(warnings(smooth), "share"));
}

}  // namespace orthant
