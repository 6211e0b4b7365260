// Derivatives of runs in space against central differences of runs, between changes of the contact pattern.
#include "tests/integrators/derivatives/spatial_trials.h"

#include <orthant/integrators/derivatives/gyroscopic_slope.h>

using namespace orthant;

namespace {

const std::string kTumbler = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "top"
mass = 0.7
inertia = [0.02, 0.05, 0.06]
position = [0.1, 0.2, 0.3]
orientation = [0.9, 0.1, 0.3, 0.3]
velocity = [0.3, -0.2, 1]
omega = [3, 7, -2]
)";

std::vector<SpatialParameter> all_starts(const spatial::Scene& scene, BodyId body = 0) {
  std::vector<SpatialParameter> all;
  const Index dof = 6 * std::ssize(scene.bodies);
  for (Index i = 0; i < 6; ++i) all.push_back(by_start(scene, 6 * body + i));
  for (Index i = 0; i < 6; ++i) all.push_back(by_start(scene, dof + 6 * body + i));
  return all;
}

spatial::Scene normalized(const std::string& text) {
  spatial::Scene scene = spatial_from_text(text);
  for (spatial::Body& body : scene.bodies) body.orientation.normalize();
  return scene;
}

}  // namespace

TEST_CASE("slopes of a turn in a step: frames, velocities at the end and gyroscopic impulses, by differences") {
  const SystemOf<Spatial> system(spatial_from_text(kTumbler));
  for (const double theta : {0.5, 1.0}) {
    const StepFrames frames{0.05, theta, theta};
    const Vector3d omega(3, 7, -2), w(3.5, 6, -1);
    const auto at_end = [&](const Vector3d& before, const Vector3d& after) {
      Eigen::VectorXd v = Eigen::VectorXd::Zero(6), end = v;
      v.tail<3>() = before, end.tail<3>() = after;
      to_end_axes(system, frames, v, end);
      return Vector3d(end.tail<3>());
    };
    const auto impulse = [&](const Vector3d& before, const Vector3d& after) {
      Eigen::VectorXd v = Eigen::VectorXd::Zero(6), there = v, g = v;
      v.tail<3>() = before, there.tail<3>() = after;
      gyroscopic_impulse(system, frames, v, there, g);
      return Vector3d(g.tail<3>());
    };
    const TurnSlope slope(frames, omega, w, at_end(omega, w));
    Eigen::Matrix3d by_omega, by_w;
    const Vector3d moments = rotation<Spatial>(system.mass(), 0);
    slope.of_impulse(moments, by_omega, by_w);
    CHECK((slope.impulse_of(moments.asDiagonal()) - impulse(omega, w)).norm() < 1e-15);
    constexpr double kStep = 1e-5;
    for (Index i = 0; i < 3; ++i) {
      const Vector3d e = kStep * Vector3d::Unit(i);
      const auto difference = [&](auto&& f, bool first) -> Vector3d {
        return (first ? f(omega + e, w) - f(omega - e, w) : f(omega, w + e) - f(omega, w - e)) / (2 * kStep);
      };
      CHECK((slope.omega_by_omega.col(i) - difference(at_end, true)).norm() < 1e-9);
      CHECK((slope.omega_by_w.col(i) - difference(at_end, false)).norm() < 1e-9);
      CHECK((by_omega.col(i) - difference(impulse, true)).norm() < 1e-10);
      CHECK((by_w.col(i) - difference(impulse, false)).norm() < 1e-10);
      // exp(−ξ) exp(ξ + δ) = exp(J δ)
      const Vector3d xi(0.4, -1.1, 0.8);
      const auto turned = [&](const Vector3d& by) {
        return quaternions::turn_between(quaternions::exponential(xi), quaternions::exponential(Vector3d(xi + by)));
      };
      CHECK((right_jacobian(xi).col(i) - (turned(e) - turned(-e)) / (2 * kStep)).norm() < 1e-9);
    }
  }
}

TEST_CASE(
    "tangent of a run in space: a body that tumbles freely, by its start, mass and inertia, also about others axes") {
  const spatial::Scene scene = normalized(kTumbler);
  const Clock clock{.step = 0.01, .duration = 1};
  check_spatial(scene, all_starts(scene), clock);
  check_spatial(scene, all_starts(scene), clock, {.scenes_of_start = true});
  std::vector<SpatialParameter> parameters;
  for (const auto& [i, j] : {std::pair{0, 0}, std::pair{2, 2}, std::pair{0, 1}, std::pair{1, 2}})
    parameters.push_back({"inertia", scene.bodies[0].inertia(i, j),
                          [scene, i = i, j = j](double x) {
                            spatial::Scene s = scene;
                            s.bodies[0].inertia(i, j) = s.bodies[0].inertia(j, i) = x;
                            return s;
                          },
                          -1});
  check_spatial(scene, parameters, clock);
  // of a ball: its axes are any, and jump
  spatial::Scene ball = scene;
  ball.bodies[0].inertia = 0.05 * Eigen::Matrix3d::Identity();
  for (SpatialParameter& p : parameters) {
    const auto given = p.scene;
    p.scene = [given, ball](double x) {
      const Eigen::Matrix3d changed = given(x).bodies[0].inertia, was = given(0).bodies[0].inertia;
      spatial::Scene s = ball;
      s.bodies[0].inertia += changed - was;
      return s;
    };
    p.value = 0;
  }
  check_spatial(ball, parameters, clock, {.step = 1e-6});
  check_spatial(scene, all_starts(scene), clock, {}, {.theta = 1});
}

namespace {

/// Two links on the ground's revolute and on a universal joint, a driven door, springs of every kind, drag and loads.
const std::string kMachine = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "arm"
mass = 1.3
inertia = [0.01, 0.08, 0.085]
position = [0.4, 0, 1]
[[body]]
name = "rod"
mass = 0.6
inertia = [[0.006, 0.001, 0], [0.001, 0.03, 0.002], [0, 0.002, 0.031]]
position = [1.1, 0, 1]
[[body]]
name = "door"
mass = 2
inertia = [0.1, 0.1, 0.15]
position = [0, 0.5, 0.2]
[[joint]]
type = "revolute"
name = "hinge"
bodies = ["ground", "arm"]
point_a = [0, 0, 1]
point_b = [-0.4, 0, 0]
axis = [0.1, 1, 0.2]
[[joint]]
type = "spherical"
name = "ball"
bodies = ["arm", "rod"]
point_a = [0.4, 0, 0]
point_b = [-0.3, 0, 0]
[[joint]]
type = "revolute"
name = "post"
bodies = ["ground", "door"]
point_a = [0, 0.2, 0.2]
point_b = [0, -0.3, 0]
axis = [0, 0, 1]
[[joint]]
type = "drive"
name = "motor"
joint = "post"
offset = 0
rate = 0
amplitude = 0.3
omega = 9
[[spring]]
type = "point"
name = "coil"
bodies = ["rod", "door"]
point_a = [0.2, 0.05, 0]
point_b = [0.1, 0.3, 0.1]
stiffness = 40
damping = 0.5
rest = 0.6
[[spring]]
type = "joint"
name = "torsion"
joint = "hinge"
stiffness = 3
damping = 0.1
rest = 0.2
[[spring]]
type = "drag"
name = "air"
body = "rod"
point = [0.1, 0, 0]
linear = 0.05
quadratic = 0.2
angular = 0.001
[[friction]]
name = "brake"
joint = "hinge"
bound = 0.4
[[load]]
name = "jet"
body = "rod"
point = [0.3, 0, 0]
force = [0, 0.5, 0.3]
torque = [0.02, 0, 0]
frame = "body"
[[load]]
name = "pull"
body = "arm"
point = [0.1, 0.1, 0]
force = [0.2, 1, 0]
)";

/// A block that strikes, slides and turns on a slope: on all its corners, and on three feet.
const std::string kSlidingCrate = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "block"
mass = 2
inertia = [0.02, 0.03, 0.04]
position = [0, 0, 0.31]
orientation = [0.99, 0.05, 0.1, 0.05]
velocity = [0.8, 0.3, 0]
omega = [0.5, 1, 2]
)";
const std::string kCorners = R"(
[[contact]]
type = "box-wall"
name = "floor"
body = "block"
size = [0.3, 0.25, 0.2]
wall = {point = [0, 0, 0], normal = [0, 0.05, 1]}
mu = 0.25
e_n = 0.4
)";
std::string foot(const std::string& name, const std::string& place) {
  return "[[contact]]\ntype = \"corner-wall\"\nname = \"" + name + "\"\nbody = \"block\"\npoint = " + place +
         "\nwall = {point = [0, 0, 0], normal = [0, 0.05, 1]}\nmu = 0.25\ne_n = 0.4\n";
}

const std::string kEllipsoid = R"(
dimension = 3
gravity = [0, 0, -9.81]
[[body]]
name = "egg"
mass = 0.5
inertia = [2e-3, 1.6e-3, 1e-3]
position = [0, 0, 0.101]
velocity = [0.5, 0.2, 0]
omega = [1, 3, 5]
[[contact]]
type = "ellipsoid-wall"
name = "table"
body = "egg"
semi_axes = [0.06, 0.08, 0.1]
wall = {point = [0, 0, 0], normal = [0, 0, 1]}
mu = 0.2
e_n = 0
rolling = 1e-3
spinning = 2e-3
surface = {velocity = [0.1, 0, 0], omega = [0, 0, 0.4]}
[[contact]]
type = "sphere-wall"
name = "side"
body = "egg"
radius = 0.07
wall = {point = [0.3, 0, 0], normal = [-1, 0, 0]}
mu = 0.3
mu_across = 0.15
direction = [0, 1, 0]
e_n = 0.5
e_t = 0.3
surface = {omega = [2, 0, 0]}
)";

}  // namespace

TEST_CASE("tangent of a run in space: joints, a drive, springs, drag, dry friction, loads") {
  const spatial::Scene scene = spatial_from_text(kMachine);
  const Clock clock{.step = 2e-3, .duration = 0.6};
  std::vector<SpatialParameter> parameters;
  for (const auto& [key, value] :
       {std::pair{"body.arm.mass", 1.3}, std::pair{"joint.motor.amplitude", 0.3}, std::pair{"joint.motor.omega", 9.},
        std::pair{"spring.coil.stiffness", 40.}, std::pair{"spring.coil.damping", 0.5},
        std::pair{"spring.coil.rest", 0.6}, std::pair{"spring.torsion.stiffness", 3.},
        std::pair{"spring.torsion.rest", 0.2}, std::pair{"friction.brake.bound", 0.4}})
    parameters.push_back(by_key(kMachine, key, value));
  parameters.push_back(by_change(kMachine, "gravity", -9.81, [](spatial::Scene& s, double x) { s.gravity.z() = x; }));
  parameters.push_back(by_change(kMachine, "hinge.point_b.x", -0.4, [](spatial::Scene& s, double x) {
    std::get<spatial::Revolute>(s.joints[0]).point_b.x() = x;
  }));
  parameters.push_back(by_change(kMachine, "ball.point_b.y", 0, [](spatial::Scene& s, double x) {
    std::get<spatial::Spherical>(s.joints[1]).point_b.y() = x;
  }));
  parameters.push_back(by_change(kMachine, "coil.point_b.z", 0.1, [](spatial::Scene& s, double x) {
    std::get<spatial::PointSpring>(s.springs[0]).point_b.z() = x;
  }));
  parameters.push_back(by_change(kMachine, "air.quadratic", 0.2, [](spatial::Scene& s, double x) {
    for (auto& spring : s.springs)
      if (auto* drag = std::get_if<spatial::Drag>(&spring); drag != nullptr && !drag->turning) drag->quadratic = x;
  }));
  parameters.push_back(
      by_change(kMachine, "jet.force.y", 0.5, [](spatial::Scene& s, double x) { s.loads[0].force.y() = x; }));
  parameters.push_back(
      by_change(kMachine, "pull.point.x", 0.1, [](spatial::Scene& s, double x) { s.loads[1].point.x() = x; }));
  parameters.push_back(by_change(kMachine, "rod.inertia.yz", 0.002, [](spatial::Scene& s, double x) {
    s.bodies[1].inertia(1, 2) = s.bodies[1].inertia(2, 1) = x;
  }));
  const RunTangent t = check_spatial(scene, parameters, clock);
  CHECK(t.degenerate.empty());
  std::vector<SpatialParameter> starts;  // those that the joints leave
  for (const SpatialParameter& p : all_starts(scene, 1))
    if (p.start % 6 != 0) starts.push_back(p);
  check_spatial(scene, starts, clock, {.step = 1e-5});
}

TEST_CASE("tangent of a run in space: axes of joints along the coordinates' axes, where directions across them jump") {
  const auto turned = [](const Vector3d& axis, int entry, double by) {
    Vector3d other = axis;
    other[entry] += by;
    return Vector3d(other.normalized());
  };
  for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(Vector3d(1, 1, 1).normalized())})
    for (int entry = 0; entry < 3; ++entry) {
      CAPTURE(axis.transpose());
      CAPTURE(entry);
      const auto with = [&](auto joint, const std::string& name, const Vector3d& omega = {0, 0, 0}) {
        spatial::Scene scene;
        scene.gravity = {1, 2, -9.81};
        scene.body({.name = "b", .inertia = Vector3d(0.02, 0.03, 0.04).asDiagonal(), .omega = omega});
        scene.joint(joint);
        const SpatialParameter parameter{name, 0,
                                         [=](double x) {
                                           spatial::Scene other = scene;
                                           auto& j = std::get<decltype(joint)>(other.joints[0]);
                                           if constexpr (requires { j.axis_a; })
                                             j.axis_a = j.axis_b = turned(axis, entry, x);
                                           else
                                             j.axis = turned(axis, entry, x);
                                           return other;
                                         },
                                         -1};
        const Vector3d moves = (turned(axis, entry, 1e-3) - axis) / 1e-3;
        if (moves.norm() > 0.1)
          check_spatial(scene, {parameter}, {.step = 1e-3, .duration = 0.02}, {.tolerance = 1e-5, .step = 1e-5});
      };
      with(spatial::Prismatic{"k", kGround, 0, {0, 0, 0}, {0.1, 0, 0.2}, axis}, "prismatic");
      with(spatial::PointOnLine{"k", kGround, 0, {0, 0, 0}, {0, 0, 0}, axis}, "point on line");
      with(spatial::Revolute{"k", kGround, 0, {0, 0, 0}, {0, 0, 0}, axis, axis}, "revolute", 3 * axis);
    }
}

TEST_CASE("tangent of a run in space: a block whose corners or feet strike, slide and turn, with friction discs") {
  for (const bool on_feet : {false, true}) {
    INFO(on_feet);
    const spatial::Scene scene =
        normalized(kSlidingCrate + (on_feet ? foot("front", "[0.15, 0, -0.1]") + foot("left", "[-0.1, 0.12, -0.1]") +
                                                  foot("right", "[-0.1, -0.12, -0.1]")
                                            : kCorners));
    const Clock clock{.step = 1e-3, .duration = on_feet ? 0.5 : 0.45};
    std::vector<SpatialParameter> parameters = all_starts(scene);
    const auto laws = [&](const std::string& name, double value, auto set) {
      parameters.push_back({name, value,
                            [scene, set](double x) {
                              spatial::Scene s = scene;
                              for (auto& c : s.contacts) std::visit([&](auto& one) { set(one.law, x); }, c);
                              return s;
                            },
                            -1});
    };
    laws("mu", 0.25, [](ContactLaw& law, double x) { law.mu = x; });
    laws("e_n", 0.4, [](ContactLaw& law, double x) { law.e = x; });
    const RunTangent t = check_spatial(scene, parameters, clock, {.step = 1e-7});
    CHECK(t.degenerate.empty());
    CHECK(t.inconsistent == 0);
  }
}

TEST_CASE(
    "tangent of a run in space: rolling and spinning friction, moving surfaces, orthotropic friction, restitution") {
  const spatial::Scene scene = spatial_from_text(kEllipsoid);
  const Clock clock{.step = 1e-3, .duration = 0.6};
  std::vector<SpatialParameter> parameters = all_starts(scene);
  for (const auto& [key, value] : {std::pair{"contact.table.mu", 0.2}, std::pair{"contact.table.rolling", 1e-3},
                                   std::pair{"contact.table.spinning", 2e-3}, std::pair{"contact.side.mu", 0.3},
                                   std::pair{"contact.side.mu_across", 0.15}, std::pair{"contact.side.e_n", 0.5},
                                   std::pair{"contact.side.e_t", 0.3}, std::pair{"contact.side.radius", 0.07}})
    parameters.push_back(by_key(kEllipsoid, key, value));
  parameters.push_back(by_change(kEllipsoid, "semi_axes.z", 0.1, [](spatial::Scene& s, double x) {
    std::get<spatial::EllipsoidPlane>(s.contacts[0]).semi_axes.z() = x;
  }));
  parameters.push_back(by_change(kEllipsoid, "surface.omega.z", 0.4, [](spatial::Scene& s, double x) {
    std::get<spatial::EllipsoidPlane>(s.contacts[0]).law.surface.omega.z() = x;
  }));
  check_spatial(scene, parameters, clock, {.step = 1e-7});
}
