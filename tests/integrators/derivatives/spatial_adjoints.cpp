// Adjoints of runs in space against tangents, closed forms, redundant joints, what has no derivative.
#include "tests/integrators/derivatives/spatial_trials.h"

using namespace orthant;

namespace {

using Kind = RunColumn::Kind;

/// A disc with a rim and a ball on a turning table, tied by a spring; a lever on two hinges, which are redundant.
const std::string kTable = R"(
dimension = 3
gravity = [0, 0.3, -9.81]
[[body]]
name = "disc"
mass = 0.4
inertia = [2e-4, 2e-4, 4e-4]
position = [0, 0, 0.05]
orientation = [0.9, 0.1, 0.2, 0]
velocity = [0.2, 0, -0.3]
omega = [1, 2, 12]
[[body]]
name = "ball"
mass = 0.2
inertia = 3e-5
position = [0.3, 0.1, 0.03]
velocity = [-0.5, 0.3, 0]
omega = [0, 20, 5]
[[body]]
name = "lever"
mass = 0.5
inertia = [0.01, 0.02, 0.015]
position = [0.5, 0.5, 0.2]
omega = [0, 2, 0]
[[joint]]
type = "revolute"
name = "left"
bodies = ["ground", "lever"]
point_a = [0.5, 0.4, 0.25]
point_b = [0, -0.1, 0.05]
axis = [0, 1, 0]
[[joint]]
type = "revolute"
name = "right"
bodies = ["ground", "lever"]
point_a = [0.5, 0.6, 0.25]
point_b = [0, 0.1, 0.05]
axis = [0, 1, 0]
[[spring]]
type = "point"
name = "band"
bodies = ["ball", "lever"]
point_b = [0.05, 0, -0.1]
stiffness = 5
damping = 0.05
rest = 0.2
[[friction]]
name = "brake"
joint = "left"
bound = 1e-3
[[contact]]
type = "rim-wall"
name = "rim"
body = "disc"
radius = 0.045
wall = {point = [0, 0, 0], normal = [0, 0, 1]}
mu = 0.3
e_n = 0.3
surface = {omega = [0, 0, 1]}
[[contact]]
type = "sphere-wall"
name = "floor"
body = "ball"
radius = 0.03
wall = {point = [0, 0, 0], normal = [0, 0, 1]}
mu = 0.2
e_n = 0.5
rolling = 1e-4
)";

std::vector<SpatialParameter> of_table() {
  std::vector<SpatialParameter> all;
  for (const auto& [key, value] :
       {std::pair{"body.disc.mass", 0.4}, std::pair{"body.ball.mass", 0.2}, std::pair{"contact.rim.mu", 0.3},
        std::pair{"contact.rim.radius", 0.045}, std::pair{"contact.floor.mu", 0.2}, std::pair{"contact.floor.e_n", 0.5},
        std::pair{"contact.floor.rolling", 1e-4}, std::pair{"spring.band.stiffness", 5.},
        std::pair{"spring.band.damping", 0.05}})
    all.push_back(by_key(kTable, key, value));
  for (const Index entry : {0, 3, 5, 8, 12 + 4, 18 + 3, 18 + 5, 24 + 1, 30 + 4}) all.push_back({"start", 0, {}, entry});
  all.push_back(by_change(kTable, "hinge.z", 0.25, [](spatial::Scene& s, double x) {
    for (auto& joint : s.joints) std::get<spatial::Revolute>(joint).point_a.z() = x;
  }));
  return all;
}

}  // namespace

TEST_CASE("adjoint of a run in space: states, gaps and impulses of many records, by tangents") {
  const SystemOf<Spatial> system(spatial_from_text(kTable));
  const Clock clock{.step = 1e-3, .duration = 0.1503, .every = 7};
  const std::vector<RunColumn> columns = {{Kind::state, 0},   {Kind::state, 5},   {Kind::state, 12}, {Kind::state, 13},
                                          {Kind::state, 30},  {Kind::state, 37},  {Kind::gap, 0},    {Kind::gap, 1},
                                          {Kind::normal, 0},  {Kind::tangent, 0}, {Kind::across, 1}, {Kind::energy, 0},
                                          {Kind::friction, 0}};
  const auto solver = make_solver("auto");
  const auto parameters = of_table();
  const auto weights = [](long record, bool last, Eigen::MatrixXd& W) {
    for (Index c = 0; c < W.rows(); ++c) {
      W(c, 0) = std::cos(static_cast<double>(1 + record * (c + 1)));
      W(c, 1) = last ? 1 : 0;
    }
  };
  const RunSteps steps(clock);
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(2, std::ssize(parameters));
  Eigen::VectorXd value = Eigen::VectorXd::Zero(2);
  long record = 0;
  const RunTangent forward = differentiate_run(system, parameters, {}, *solver, clock, columns,
                                               [&](double, const Eigen::VectorXd& x, const Eigen::MatrixXd& by) {
                                                 Eigen::MatrixXd W(by.rows(), 2);
                                                 weights(record, record == steps.records() - 1, W);
                                                 value += W.transpose() * x, gradient += W.transpose() * by;
                                                 ++record;
                                               });
  REQUIRE(forward.run.status == Status::solved);
  CHECK(forward.inconsistent == 0);
  const RunAdjoint reverse = differentiate_run_reverse(system, parameters, {}, *solver, clock, columns, 2, weights);
  REQUIRE(reverse.run.status == Status::solved);
  CHECK((reverse.value - value).lpNorm<Eigen::Infinity>() <= 1e-12 * value.lpNorm<Eigen::Infinity>());
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    INFO(parameters[j].name);
    const auto column = static_cast<Index>(j);
    CHECK((reverse.gradient.col(column) - gradient.col(column)).lpNorm<Eigen::Infinity>() <=
          1e-7 * gradient.col(column).lpNorm<Eigen::Infinity>());
    CHECK(gradient.col(column).lpNorm<Eigen::Infinity>() > 0);
  }
}

TEST_CASE("tangent of a run in space: a body on redundant hinges, whose place changes, by differences") {
  const spatial::Scene scene = spatial_from_text(kTable);
  std::vector<SpatialParameter> parameters = {of_table().back(), by_key(kTable, "body.ball.mass", 0.2),
                                              by_key(kTable, "spring.band.stiffness", 5)};
  check_spatial(scene, parameters, {.step = 1e-3, .duration = 0.05}, {.step = 1e-7});
}

TEST_CASE("tangent of a run in space: a ball that slides on a table has a closed form") {
  constexpr double kTime = 0.5, kG = 9.81, kRadius = 0.028575;
  const auto scene_of = [](double mu) {
    const std::vector<std::string> sets = {override_text("mu", mu)};
    return std::get<spatial::Scene>(make_any_scene("masse", sets));
  };
  const SystemOf<Spatial> system(scene_of(0.2));
  const auto solver = make_solver("auto");
  std::vector<SpatialParameter> parameters = {{"mu", 0.2, scene_of, -1}, {"wx", 0, {}, 6 + 3}, {"vy", 0, {}, 6 + 1}};
  Eigen::MatrixXd by;
  differentiate_run(system, parameters, {}, *solver, {.step = 1e-3, .duration = kTime, .every = 1000},
                    {{Kind::state, 0}, {Kind::state, 1}, {Kind::state, 10}},
                    [&](double, const Eigen::VectorXd&, const Eigen::MatrixXd& x) { by = x; });
  const Eigen::Vector2d slip(1 + 100 * kRadius, -60 * kRadius), u = slip.normalized(), across(-u.y(), u.x());
  const double half = kG * kTime * kTime / 2;
  CHECK(std::abs(by(0, 0) + half * u.x()) < 1e-8);
  CHECK(std::abs(by(1, 0) + half * u.y()) < 1e-8);
  // the slip's direction turns by its part across
  const auto turned = [&](const Eigen::Vector2d& by_slip) -> Eigen::Vector2d {
    return -0.2 * half * by_slip.dot(across) / slip.norm() * across;
  };
  const Eigen::Vector2d by_spin = turned({0, kRadius}), by_speed = turned({0, 1});
  CHECK(std::abs(by(0, 1) - by_spin.x()) < 1e-8);
  CHECK(std::abs(by(1, 1) - by_spin.y()) < 1e-8);
  CHECK(std::abs(by(0, 2) - by_speed.x()) < 1e-7);
  CHECK(std::abs(by(1, 2) - kTime - by_speed.y()) < 1e-7);
}

TEST_CASE("tangent of a run in space: friction that begins at mu = 0 is against the slip") {
  const auto scene_of = [](double mu) {
    const std::vector<std::string> sets = {override_text("mu", mu)};
    return std::get<spatial::Scene>(make_any_scene("masse", sets));
  };
  const SystemOf<Spatial> system(scene_of(0));
  const auto solver = make_solver("auto");
  const RunTangent t =
      differentiate_run(system, {{"mu", 0, scene_of, -1}}, {}, *solver, {.step = 1e-3, .duration = 0.5});
  REQUIRE(t.run.status == Status::solved);
  CHECK(t.warnings.size() == 1);
  const Eigen::Vector2d u = Eigen::Vector2d(1 + 2.8575, -60 * 0.028575).normalized();
  CHECK(std::abs(t.q(0, 0) + 9.81 / 8 * u.x()) < 1e-6);
  CHECK(std::abs(t.q(1, 0) + 9.81 / 8 * u.y()) < 1e-6);
}

TEST_CASE("tangent of a run in space: restitution along the surface at its default of 0, by differences") {
  const std::string text = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "ball"
mass = 1
inertia = 0.004
position = [0, 0, 0.15]
velocity = [0.5, 0.2, 0]
[[contact]]
type = "sphere-wall"
name = "floor"
body = "ball"
radius = 0.1
mu = 0.5
e_n = 0.3
wall = {normal = [0, 0, 1]}
)";
  check_spatial(spatial_from_text(text), {by_key(text, "contact.floor.e_t", 0)}, {.step = 1e-3, .duration = 0.15});
}

TEST_CASE("columns of a run in space: gaps of points next to the lowest one of a rim, by differences of poses") {
  const std::string text = R"(
dimension = 3
[[body]]
name = "drum"
mass = 0.8
inertia = [0.004, 0.005, 0.006]
position = [0, 0, 0.16]
orientation = [0.9, 0.3, 0.3, 0.1]
[[contact]]
type = "cylinder-wall"
name = "floor"
body = "drum"
radius = 0.1
height = 0.16
wall = {normal = [0, 0.03, 1]}
)";
  const SystemOf<Spatial> system(spatial_from_text(text));
  std::vector<RunColumn> columns;
  for (Index i = 0; i < system.contacts(); ++i) columns.push_back({Kind::gap, i});
  ColumnSlopesOf<Spatial> slopes(system, columns);
  const State x = system.initial_state();
  const double way = 1e-6;
  for (Index j = 0; j < system.dof(); ++j) {
    const Eigen::VectorXd direction = Eigen::VectorXd::Unit(system.dof(), j);
    std::vector<double> side[2];
    for (int k = 0; k < 2; ++k) {
      State moved = x;
      move<Spatial>(x.q, (k == 0 ? -way : way) * direction, moved.q);
      slopes.set_up(moved);
      for (std::size_t i = 0; i < columns.size(); ++i) side[k].push_back(slopes.value(i, moved));
    }
    slopes.set_up(x);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      INFO(i, ' ', j);
      const double by = (side[1][i] - side[0][i]) / (2 * way);
      CHECK(std::abs(slopes.push(i, {}, direction.data(), direction.data()) - by) < 1e-8);
      Eigen::VectorXd q = Eigen::VectorXd::Zero(system.dof()), v = q;
      slopes.pull(i, 2, q.data(), v.data());
      CHECK(std::abs(q[j] - 2 * by) < 1e-8);
    }
  }
}

TEST_CASE("tangent of a run in space: contacts without force are named; what has no derivative is refused") {
  const std::string text = R"(
dimension = 3
[[body]]
name = "ball"
mass = 1
inertia = 1
position = [0, 0, 1]
[[contact]]
type = "sphere-wall"
name = "floor"
body = "ball"
radius = 1
wall = {point = [0, 0, 0], normal = [0, 0, 1]}
)";
  const auto solver = make_solver("auto");
  const Clock clock{.step = 0.01, .duration = 0.1};
  const SystemOf<Spatial> resting(spatial_from_text(text));
  const RunTangent t = differentiate_run(resting, {by_key(text, "body.ball.mass", 1)}, {}, *solver, clock);
  REQUIRE(t.degenerate.size() == 10);
  CHECK(t.degenerate[3].contacts == std::vector<int>{0});

  const SystemOf<Spatial> poisson(
      spatial_from_text("restitution = \"poisson\"\n" + text,
                        {"gravity=[0, 0, -9]", "body.ball.velocity=[0, 0, -1]", "contact.floor.e_n=0.5"}));
  CHECK_THROWS_AS(differentiate_run(poisson, {}, {}, *solver, clock), std::invalid_argument);
  MoreauJeanOptions full;
  full.form = Form::full;
  CHECK_THROWS_AS(differentiate_run(resting, {}, full, *solver, clock), std::invalid_argument);
  const SystemOf<Spatial> searched(spatial_from_text(
      text + "[[collision]]\nshapes = [{body = \"ball\", radius = 1}]\nwalls = [{normal = [0, 0, 1]}]\n"));
  CHECK_THROWS_AS(differentiate_run(searched, {}, {}, *solver, clock), std::invalid_argument);
  CHECK_THROWS_AS(differentiate_run(resting, {{"none", 0, {}, 12}}, {}, *solver, clock), std::invalid_argument);
  CHECK_THROWS_AS(differentiate_run(resting, {}, {}, *solver, clock, {{Kind::state, 13}}), std::invalid_argument);
  const SystemOf<Spatial> grooved(spatial_from_text(
      text, {"contact.floor.mu=0.2", "contact.floor.mu_across=0.1", "contact.floor.direction=[1, 0, 0]"}));
  CHECK_THROWS_AS(differentiate_run(grooved, {}, {}, *solver, clock, {{Kind::across, 0}}), std::invalid_argument);
}

TEST_CASE("derivatives of a run in space: impulses along tangents that jump as the normal turns are named") {
  const std::string text = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "b"
mass = 1
inertia = [0.004, 0.006, 0.007]
position = [0, 0, 0.1]
velocity = [1, 0, 0]
[[contact]]
name = "c"
type = "sphere-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 0, 1]}
mu = 0.3
)";
  const auto by_normal = [&](double x, double y) {
    return by_change(text, "wall.normal.x", x, [y](spatial::Scene& s, double to) {
      std::get<spatial::SpherePlane>(s.contacts[0]).normal = Vector3d(to, y, 1).normalized();
    });
  };
  const auto solver = make_solver("auto");
  const Clock clock{.step = 1e-3, .duration = 0.02};
  const auto warned = [&](const SpatialParameter& parameter, Kind kind) {
    const SystemOf<Spatial> system(parameter.scene(parameter.value));
    const std::vector<RunColumn> columns = {{kind, 0}};
    const auto forward = differentiate_run(system, {parameter}, MoreauJeanOptions{}, *solver, clock, columns);
    const auto reverse =
        differentiate_run_reverse(system, {parameter}, MoreauJeanOptions{}, *solver, clock, columns, 1, weigh_last());
    const auto jumps = [](const std::vector<std::string>& warnings) {
      return std::ranges::any_of(warnings, [](const auto& w) { return w.find("'c' have no derivative") != w.npos; });
    };
    CHECK(jumps(forward.warnings) == jumps(reverse.warnings));
    return jumps(forward.warnings);
  };
  CHECK(warned(by_normal(0, 0), Kind::tangent));
  CHECK(warned(by_normal(0, 0), Kind::across));
  CHECK_FALSE(warned(by_normal(0, 0), Kind::normal));
  CHECK_FALSE(warned(by_normal(0, 0.1), Kind::tangent));
  CHECK_FALSE(warned(by_key(text, "body.b.mass", 1), Kind::tangent));
}

TEST_CASE("tangent of a run in space: normals with two components that are equal, where the tangents jump") {
  const std::string text = R"(
dimension = 3
gravity = [0.3, 0.1, -9.81]
[[body]]
name = "b"
mass = 1
inertia = [0.004, 0.006, 0.007]
position = [0, 0, 0.102]
velocity = [0.3, -0.1, 0]
[[contact]]
name = "c"
type = "sphere-wall"
body = "b"
radius = 0.1
wall = {normal = [0.1, 0.1, 1]}
mu = 0.3
e_n = 0.4
)";
  std::vector<SpatialParameter> parameters;
  for (const double apart : {0.0, 1e-10, 1e-6})
    for (const int entry : {0, 1})
      parameters.push_back(by_change(text, "normal " + std::to_string(entry), 0.1, [=](spatial::Scene& s, double x) {
        Vector3d n(0.1, 0.1 + apart, 1);
        n[entry] += x - 0.1;
        std::get<spatial::SpherePlane>(s.contacts[0]).normal = n.normalized();
      }));
  for (const SpatialParameter& p : parameters)
    check_spatial(p.scene(p.value), {p}, {.step = 1e-3, .duration = 0.05}, {.tolerance = 1e-5});
}

TEST_CASE("derivatives of a run: dry friction that holds a joint with its whole bound is named") {
  const std::string text = R"(
dimension = 3
[[body]]
name = "b"
mass = 1
inertia = 0.01
[[joint]]
name = "slide"
type = "prismatic"
bodies = ["ground", "b"]
axis = [1, 0, 0]
[[friction]]
name = "f"
joint = "slide"
bound = 0.5
[[load]]
name = "pull"
body = "b"
force = [0.5, 0, 0]
)";
  const auto solver = make_solver("auto");
  const auto warned = [&](double bound) {
    const SpatialParameter p = by_key(text, "friction.f.bound", bound);
    const SystemOf<Spatial> system(p.scene(bound));
    const Clock clock{.step = 1e-2, .duration = 0.05};
    const auto says = [](const std::vector<std::string>& warnings) {
      return std::ranges::any_of(warnings,
                                 [](const auto& w) { return w.find("friction 'f' holds its joint") != w.npos; });
    };
    const auto forward = differentiate_run(system, {p}, MoreauJeanOptions{}, *solver, clock);
    const auto reverse = differentiate_run_reverse(system, {p}, MoreauJeanOptions{}, *solver, clock,
                                                   {{Kind::energy, 0}}, 1, weigh_last());
    CHECK(says(forward.warnings) == says(reverse.warnings));
    return says(forward.warnings);
  };
  CHECK(warned(0.5));
  CHECK_FALSE(warned(0.6));
  CHECK_FALSE(warned(0.4));
}
