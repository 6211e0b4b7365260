// Derivatives of event-driven motions of linked bodies: pins with clearance, links that land, starts that break a
// joint; against central differences of runs.
#include <doctest/doctest.h>

#include "tests/integrators/derivatives/motion_trials.h"

using namespace orthant;

namespace {

// The bodies' velocities break their joint.
const std::string kBrokenStart = R"(
[[body]]
name = "rod"
mass = 0.5
inertia = 0.01
position = [0.45, 0.002]
velocity = [0, 1.6]
[[body]]
name = "sl"
mass = 0.3
inertia = 0.002
position = [0.70, 0.001]
[[joint]]
name = "wrist"
type = "revolute"
bodies = ["rod", "sl"]
point_a = [0.25, 0]
point_b = [0, 0.001]
)";

// A disc in a hole of a driven arm, 0.1 mm of clearance; it starts in the middle.
const std::string kDiscInHole = R"(
gravity = [0, -9.81]
[[body]]
name = "arm"
mass = 1
inertia = 0.02
omega = 8
[[joint]]
name = "shaft"
type = "revolute"
bodies = ["ground", "arm"]
[[joint]]
name = "motor"
type = "drive"
joint = "shaft"
rate = 8
[[body]]
name = "d"
mass = 1
inertia = 0.001
position = [0.1, 0]
velocity = [0, 0.8]
[[contact]]
name = "B"
type = "journal"
bodies = ["d", "arm"]
centre_b = [0.1, 0]
radius_a = 0.01
radius_b = 0.0101
mu = 0.1
e_n = 0.0
)";

const std::vector<MotionTrial> kBreaks = {{"body.rod.position", "[", ", 0.002]", 0.45},
                                          {"body.sl.velocity", "[0, ", "]", 0},
                                          {"body.sl.angle", "", "", 0},
                                          {"joint.wrist.point_a", "[", ", 0]", 0.25},
                                          {"body.sl.mass", "", "", 0.3}};

}  // namespace

TEST_CASE("tangent of a motion: differences are short beside a clearance, also of a disc that starts in the middle") {
  const std::vector<MotionTrial> trials = {{"body.d.velocity", "[", ", 0.8]", 0, 1e-5},
                                           {"contact.B.radius_b", "", "", 0.0101, 1e-7},
                                           {"contact.B.centre_b", "[", ", 0]", 0.1, 1e-7},
                                           {"contact.B.centre_b", "[0.1, ", "]", 0, 1e-7}};
  check_motion(kDiscInHole, trials, 0.04, 2e-5);
}

TEST_CASE("tangents of a start that breaks a joint: by its velocities, and by 0.2 mm") {
  check_motion(kBrokenStart, kBreaks, 0.02, 1e-7);
  std::string apart = kBrokenStart;
  apart.replace(apart.find("[0.70, 0.001]"), 13, "[0.7002, 0.001]");
  check_motion(apart, kBreaks, 0.02, 1e-7);
  const Clock clock{.step = 1e-3, .duration = 0.02};
  const auto solver = make_solver("auto");
  for (const std::string& text : {kBrokenStart, apart}) {
    const System system(from_text(text)({}));
    const std::vector<RunParameter> parameters = parameters_of(text, kBreaks);
    const RunTangent tangent = differentiate_run(system, parameters, {}, *solver, clock);
    std::vector<RunColumn> columns;
    for (Index i = 0; i < 2 * system.dof(); ++i) columns.push_back({RunColumn::Kind::state, i});
    const RunAdjoint adjoint =
        differentiate_run_reverse(system, parameters, {}, *solver, clock, columns, 2 * system.dof(), weigh_last());
    for (std::size_t j = 0; j < kBreaks.size(); ++j) {
      INFO(kBreaks[j].key);
      const State a = end_of(from_text(text)({set_of(kBreaks[j], kBreaks[j].value - 1e-5)}), "moreau-jean", clock);
      const State b = end_of(from_text(text)({set_of(kBreaks[j], kBreaks[j].value + 1e-5)}), "moreau-jean", clock);
      const auto column = static_cast<Index>(j);
      Eigen::VectorXd difference(2 * system.dof()), exact(2 * system.dof());
      difference << (b.q - a.q) / 2e-5, (b.v - a.v) / 2e-5;
      exact << tangent.q.col(column), tangent.v.col(column);
      CHECK((exact - difference).lpNorm<Eigen::Infinity>() <= 1e-7 * difference.lpNorm<Eigen::Infinity>());
      CHECK((adjoint.gradient.col(column) - exact).lpNorm<Eigen::Infinity>() <= 1e-9 * exact.lpNorm<Eigen::Infinity>());
    }
  }
}

TEST_CASE("tangent of a motion: a point of a joint, through a series of impacts in a pin whose clearance is small") {
  const std::string text = scene_texts::contents(scene_texts::kCore / "scenes/slider_crank_pin.toml");
  const MotionTrial point{"joint.crank_pin.point_b", "[", ", 0]", -0.0765};
  const auto solver = make_solver("auto");
  const System system(from_text(text)({}));
  const double end = 0.00105, step = 3e-8;
  const auto omega = [&](double by) {
    return end_of(from_text(text)({set_of(point, point.value + by)}), "event-driven", {.step = end, .duration = end})
        .v[2];
  };
  const double expected = (omega(step) - omega(-step)) / (2 * step);
  for (const double every : {end, end / 10}) {
    CAPTURE(every);
    const MotionTangent t = differentiate_motion(system, parameters_of(text, {point}), {}, *solver, end, every);
    CHECK(t.none == "");
    CHECK(t.v(2, 0) == doctest::Approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("tangent of a motion: links on pins that land, also far from the origin") {
  const auto links = [](double y) {
    char text[1200];
    std::snprintf(text, sizeof text, R"(
gravity = [0, -9.81]
[[body]]
name = "one"
mass = 1
inertia = 0.03
position = [0.3, %.17g]
omega = -1
velocity = [0, -0.3]
[[body]]
name = "two"
mass = 1
inertia = 0.03
position = [0.9, %.17g]
velocity = [0, -0.6]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "one"]
point_a = [0, %.17g]
point_b = [-0.3, 0]
[[joint]]
name = "knee"
type = "revolute"
bodies = ["one", "two"]
point_a = [0.3, 0]
point_b = [-0.3, 0]
[[contact]]
name = "c"
type = "corner-wall"
body = "two"
point = [0.3, 0]
wall = {point = [0, %.17g], normal = [0.2, 1]}
mu = 0.05
)",
                  y, y, y, y - 0.15);
    return std::string(text);
  };
  const auto solver = make_solver("auto");
  const auto tangent = [&](double y) {
    const std::string text = links(y);
    const RunParameter plane{"wall.point.y", y - 0.15,
                             [text](double x) {
                               Scene s = from_text(text)({});
                               std::get<CornerWall>(s.contacts[0]).wall_point.y() = x;
                               return s;
                             },
                             -1};
    const MotionTangent t = differentiate_motion(System(from_text(text)({})), {plane}, {}, *solver, 0.3);
    REQUIRE(t.none.empty());
    return t.v;
  };
  const Eigen::VectorXd near = tangent(0);
  for (const double y : {-1.27, -5.0, -30.0, 300.0}) {
    CAPTURE(y);
    CHECK((tangent(y) - near).lpNorm<Eigen::Infinity>() <= 1e-6 * near.lpNorm<Eigen::Infinity>());
  }
}

TEST_CASE("tangent of a motion: a link on a pin that lands and stays is not parted by its one contact") {
  const std::string text = R"(
gravity = [0, -9.81]
[[body]]
name = "link"
mass = 1
inertia = 0.03
position = [0.3, 0]
omega = -1
velocity = [0, -0.3]
[[joint]]
name = "pin"
type = "revolute"
bodies = ["ground", "link"]
point_b = [-0.3, 0]
[[contact]]
name = "c"
type = "corner-wall"
body = "link"
point = [0.3, 0]
mu = 0.2
wall = {point = [0, -0.15], normal = [0.2, 1]}
)";
  const auto solver = make_solver("auto");
  const Clock clock{.step = 0.05, .duration = 0.6};
  const MotionTrial drop{"contact.c.wall.point", "[0, ", "]", -0.15};
  const MotionTrial weight{"gravity", "[0, ", "]", -9.81};
  const MotionTangent t =
      differentiate_motion(System(from_text(text)({})), parameters_of(text, {drop, weight}), {}, *solver, 0.6);
  CHECK(t.none == "");
  REQUIRE(t.q.cols() == 2);
  State end[2];
  for (int k = 0; k < 2; ++k)
    end[k] = end_of(from_text(text)({set_of(drop, drop.value + (k == 0 ? -1e-6 : 1e-6))}), "event-driven", clock);
  const Eigen::VectorXd difference = (end[1].q - end[0].q) / 2e-6;
  CHECK((t.q.col(0) - difference).lpNorm<Eigen::Infinity>() <= 1e-6 * difference.lpNorm<Eigen::Infinity>());
  CHECK(t.q.col(1).lpNorm<Eigen::Infinity>() <= 1e-9);  // it rests
}
