// Rows and biases of spatial joints, contacts and springs against differences of their residuals, gaps and energies.
#include "tests/support/spatial.h"

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

Vector3d some(int seed) { return {std::sin(1.0 + seed), std::cos(2.0 + 3 * seed), std::sin(4.0 + 5 * seed)}; }
Eigen::Vector4d orientation(int seed) { return quaternions::exponential(2.5 * some(seed)).normalized(); }

/// Two bodies somewhere, with inertia tensors that are not diagonal.
spatial::Scene two_bodies() {
  spatial::Scene s;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Matrix3d R = quaternions::matrix_of(orientation(7 + i));
    const Vector3d J(2, 3, 4);
    s.body({.mass = 1.5 + i,
            .inertia = R * J.asDiagonal() * R.transpose(),
            .position = some(11 + i),
            .orientation = orientation(3 + i),
            .velocity = some(20 + i),
            .omega = some(30 + i)});
  }
  return s;
}

/// The orientation of b in a, turned by 1 rad.
Eigen::Vector4d off_by_one(const spatial::Scene& scene, BodyId a, BodyId b) {
  const auto of = [&](BodyId body) {
    const Eigen::Vector4d q =
        body < 0 ? Eigen::Vector4d(1, 0, 0, 0) : scene.bodies[static_cast<std::size_t>(body)].orientation;
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  };
  const Eigen::Quaterniond q =
      of(a).conjugate() * of(b) * Eigen::Quaterniond(Eigen::AngleAxisd(1, some(6).normalized()));
  return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()).normalized();
}

/// Joints whose rows are exact at every pose.
std::vector<spatial::Joint> joints(BodyId a, BodyId b) {
  using namespace spatial;
  const Vector3d p = some(40), r = some(41), u = some(42).normalized(), w = some(43).normalized();
  return {spatial::Revolute{"revolute", a, b, p, r, u, w},
          spatial::Prismatic{"prismatic", a, b, p, r, u, orientation(5)},
          spatial::Fixed{"fixed", a, b, p, r, orientation(6)},
          spatial::Distance{"distance", a, b, p, r, 0.7},
          Spherical{"spherical", a, b, p, r},
          Cylindrical{"cylindrical", a, b, p, r, u, w},
          Universal{"universal", a, b, p, r, u, w},
          PlaneJoint{"planar", a, b, p, r, u, w},
          PointInPlane{"point_in_plane", a, b, p, r, u},
          PointOnLine{"point_on_line", a, b, p, r, u}};
}

struct Fixture {
  SpatialSystem system;
  State x = system.initial_state();
  TermsOf<Spatial> terms{system};

  explicit Fixture(const spatial::Scene& scene) : system(scene) {}
  TermsOf<Spatial>& at(const Eigen::VectorXd& q) {
    set_poses(system, 0, q, terms.at);
    set_twists(system, x.v, terms.at);
    evaluate_joints(system, terms);
    evaluate_gaps(system, terms);
    evaluate_closed(system, 1e9, terms);
    return terms;
  }
  Eigen::VectorXd moved(double by, const Eigen::VectorXd& along) {
    Eigen::VectorXd q;
    move<Spatial>(x.q, by * along, q);
    return q;
  }
};

constexpr double kStep = 1e-5;

}  // namespace

TEST_CASE("rows of spatial joints are the derivatives of their residuals, biases those of their rates") {
  for (const BodyId other : {1, kGround})
    for (const bool first : {true, false})
      for (spatial::Joint joint : first ? joints(0, other) : joints(other, 0)) {
        CAPTURE(std::visit([](const auto& j) { return j.name; }, joint));
        spatial::Scene scene = two_bodies();
        std::visit(
            [&](auto& j) {
              if constexpr (requires { j.orientation; }) j.orientation = off_by_one(scene, j.a, j.b);
              if constexpr (requires { j.axis_a; })
                j.axis_b = quaternions::matrix_of(off_by_one(scene, j.a, j.b)).transpose() * j.axis_a;
            },
            joint);
        scene.joint(joint);
        Fixture f(scene);
        const std::vector<RowOf<Spatial>> G = f.at(f.x.q).G;
        evaluate_biases(f.system, f.terms);
        const Eigen::VectorXd bias = f.terms.joint_bias;
        for (Index k = 0; k < 12; ++k) {
          const Eigen::VectorXd unit = Eigen::VectorXd::Unit(12, k);
          const Eigen::VectorXd after = f.at(f.moved(kStep, unit)).phi, before = f.at(f.moved(-kStep, unit)).phi;
          for (std::size_t i = 0; i < G.size(); ++i) {
            const auto r = static_cast<Index>(i);
            CHECK(std::abs((after[r] - before[r]) / (2 * kStep) - apply(G[i], unit.data())) < 1e-9);
          }
        }
        const std::vector<RowOf<Spatial>> after = f.at(f.moved(kStep, f.x.v)).G,
                                          before = f.at(f.moved(-kStep, f.x.v)).G;
        for (std::size_t i = 0; i < G.size(); ++i)
          CHECK(std::abs((apply(after[i], f.x.v.data()) - apply(before[i], f.x.v.data())) / (2 * kStep) -
                         bias[static_cast<Index>(i)]) < 1e-7);
      }
}

TEST_CASE("normal rows of spatial contacts are the derivatives of their gaps, tangents are at right angles") {
  using namespace spatial;
  const std::vector<spatial::Contact> contacts = {
      SpherePlane{"sphere", 0, some(1), 0.3, 1, some(2), some(3).normalized(), {.mu = 0.5}},
      SpherePlane{"corner", 0, some(1), 0, kGround, some(2), some(3).normalized(), {.mu = 0.5}},
      SphereSphere{"spheres", 0, some(4), 0.3, 1, some(5), 0.4, {.mu = 0.5}},
      Socket{"socket", 1, some(6), 0.3, 0, some(7), 0.4, {.mu = 0.5}},
      SphereBush{"bush", 1, some(6), 0.3, 0, some(7), some(9).normalized(), 0.4, {.mu = 0.5}},
      SphereBush{"fixed_bush", 0, some(6), 0.3, kGround, some(7), some(8).normalized(), 2.5, {.mu = 0.5}},
      EllipsoidPlane{
          "ellipsoid", 0, some(1), {0.3, 0.5, 0.2}, orientation(4), 1, some(2), some(3).normalized(), {.mu = 0.5}},
      RimPlane{"rim", 1, some(6), some(5).normalized(), 0.4, 0.05, 0, 0, some(2), some(3).normalized(), {.mu = 0.5}},
      spatial::Limit{"rope", spatial::Span{0, 1, some(8), some(9)}, spatial::Limit::Side::upper, 1, {}}};
  for (const spatial::Contact& contact : contacts) {
    CAPTURE(std::visit([](const auto& c) { return c.name; }, contact));
    spatial::Scene scene = two_bodies();
    scene.contact(contact);
    Fixture f(scene);
    const ContactRowsOf<Spatial> rows = f.at(f.x.q).closed.at(0).rows;
    for (Index k = 0; k < 12; ++k) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(12, k);
      const double after = f.at(f.moved(kStep, unit)).gap[0], before = f.at(f.moved(-kStep, unit)).gap[0];
      CHECK(std::abs((after - before) / (2 * kStep) - apply(rows.normal, unit.data())) < 1e-9);
    }
    if (std::holds_alternative<spatial::Limit>(contact)) continue;
    const BodyId body = rows.normal.a;
    const Vector3d n = push_on(rows.normal, body), t1 = push_on(rows.tangents[0], body),
                   t2 = push_on(rows.tangents[1], body);
    Eigen::Matrix3d frame;
    frame << n, t1, t2;
    CHECK((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm() < 1e-14);
    CHECK(frame.determinant() > 0);
    // A common motion of both bodies: no slip but that of turning the gap between two points.
    const Vector3d v = some(50), omega = some(51);
    Eigen::VectorXd common(12);
    const KinematicsOf<Spatial> at = poses_of(f.system, f.x);
    for (int i = 0; i < 2; ++i) {
      translation<Spatial>(common, i) = v + omega.cross(at.at(i).x);
      rotation<Spatial>(common, i) = at.at(i).axes.transpose() * omega;
    }
    if (rows.normal.a < 0 || rows.normal.b < 0) continue;
    const double gap = std::visit(
                           [](const auto& c) {
                             return requires { c.plane_point; };
                           },
                           contact)
                           ? 0
                           : f.at(f.x.q).gap[0];
    const Vector3d expected = omega.cross(gap * n);
    CHECK(size_of(slip_rate(rows, common.data()) - Tangents{expected.dot(t1), expected.dot(t2)}) < 1e-13);
  }
}

TEST_CASE("the force of a spatial spring is minus the derivative of its energy") {
  using namespace spatial;
  const Vector3d z = some(60).normalized();
  const std::vector<spatial::Spring> springs = {
      spatial::PointSpring{"point", 0, 1, some(1), some(2), 3, 0, 0.2},
      spatial::JointSpring{"slide", spatial::Slide{0, 1, some(3), some(4), z}, 3, 0, 0.1}};
  for (const spatial::Spring& spring : springs) {
    spatial::Scene scene = two_bodies();
    scene.spring(spring);
    Fixture f(scene);
    const auto energy_at = [&](const Eigen::VectorXd& q) {
      set_poses(f.system, 0, q, f.terms.at);
      return std::visit([&](const auto& s) { return s.evaluate(f.terms.at, f.x.v.data()); }, spring);
    };
    const SpringStateOf<Spatial> here = energy_at(f.x.q);
    for (Index k = 0; k < 12; ++k) {
      const Eigen::VectorXd unit = Eigen::VectorXd::Unit(12, k);
      const double slope =
          (energy_at(f.moved(kStep, unit)).energy - energy_at(f.moved(-kStep, unit)).energy) / (2 * kStep);
      CHECK(std::abs(slope - here.tension * apply(here.row, unit.data())) < 1e-8);
    }
  }
}

TEST_CASE("a load in the body's frame turns with it, and its moment is about the centre of mass") {
  spatial::Scene scene = two_bodies();
  scene.load({.name = "world", .body = 0, .point = some(1), .force = some(2), .moment = some(3)});
  scene.load({.name = "body",
              .body = 1,
              .point = some(1),
              .force = some(2),
              .moment = some(3),
              .frame = spatial::Frame::body,
              .factor = [](double t) { return 2 * t; }});
  const SpatialSystem system(scene);
  const State x = system.initial_state();
  TermsOf<Spatial> terms(system);
  set_poses(system, 0.5, x.q, terms.at);
  evaluate_forces(system, 0.5, x.v, terms);
  const auto check = [&](int i, const Vector3d& force, const Vector3d& moment) {
    const Vector3d r = terms.at.at(i).turn(some(1));
    CHECK((translation<Spatial>(terms.f, i) - force).norm() < 1e-14);
    CHECK((terms.at.at(i).axes * rotation<Spatial>(terms.f, i) - moment - r.cross(force)).norm() < 1e-14);
  };
  check(0, some(2), some(3));
  check(1, terms.at.at(1).turn(some(2)), terms.at.at(1).turn(some(3)));
}

TEST_CASE("angles in space are those of the plane where both axes are z, and are followed through full turns") {
  spatial::Unwrapped turns;
  double last = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.01 * i, angle = 7 * t + 0.5 * std::sin(3 * t), rate = 7 + 1.5 * std::cos(3 * t);
    spatial::Kinematics k;
    k.pose.resize(2);
    k.pose[0].R = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
    last = turns.add(t, spatial::Angle{kGround, 0}.value(k), rate);
    REQUIRE(std::abs(last - angle) < 1e-12);
  }
  CHECK(last > 60);
}

TEST_CASE("spatial scenes are checked: element, field, value and rule") {
  const auto refusal = [](auto&& spoil) -> std::string {
    spatial::Scene scene = two_bodies();
    for (spatial::Body& body : scene.bodies) body.orientation = {1, 0, 0, 0};
    scene.joint(spatial::Revolute{"pin", 0, 1});
    scene.contact(spatial::SpherePlane{.name = "floor", .a = 0});
    spoil(scene);
    try {
      spatial::check(scene);
    } catch (const SceneError& error) {
      return error.what();
    }
    return {};
  };
  using Scene = spatial::Scene;
  CHECK(refusal([](Scene&) {}).empty());
  CHECK(refusal([](Scene& s) { s.bodies[0].mass = 0; }) == "body \"body1\": mass = 0: must be > 0");
  CHECK(refusal([](Scene& s) { s.bodies[1].inertia = Vector3d(1, 1, 3).asDiagonal(); }) ==
        "body \"body2\": inertia = (1, 1, 3): must be that of a body: no principal moment larger than the sum of the "
        "others");
  CHECK(refusal([](Scene& s) { s.bodies[1].inertia(0, 1) += 1; }).find("must be symmetric") != std::string::npos);
  CHECK(refusal([](Scene& s) {
          s.bodies[0].orientation = {1, 1, 0, 0};
        }) == "body \"body1\": orientation = (1, 1, 0, 0): must be a unit quaternion");
  CHECK(refusal([](Scene& s) {
          std::get<spatial::Revolute>(s.joints[0]).axis_b = {0, 0, 2};
        }) == "joint \"pin\": axis_b = (0, 0, 2): must be a unit vector");
  CHECK(refusal([](Scene& s) { std::get<spatial::Revolute>(s.joints[0]).b = 0; }) ==
        "joint \"pin\": joins body \"body1\" to itself: must be two different bodies");
  CHECK(
      refusal([](Scene& s) {
        std::get<spatial::Revolute>(s.joints[0]).axis_b = {0, 0, -1};
      }) ==
      "joint \"pin\": axis_b = (0, 0, -1): must be less than 90 degrees from the axis of the first body at the start; "
      "it is 180 degrees off. Reverse an axis, or set assemble = true to turn the bodies");
  CHECK(refusal([](Scene& s) {
          s.assemble = true;
          std::get<spatial::Revolute>(s.joints[0]).axis_b = {0, 0, -1};
        }).empty());
  for (const auto& [degrees, refused] : {std::pair{89.0, false}, {91.0, true}, {-120.0, true}, {180.0, true}}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Eigen::Vector4d turned(std::cos(angle / 2), std::sin(angle / 2), 0, 0);
    const spatial::Joint kinds[] = {spatial::Revolute{"j", 0, 1}, spatial::Cylindrical{"j", 0, 1},
                                    spatial::PlaneJoint{"j", 0, 1}, spatial::Prismatic{"j", 0, 1},
                                    spatial::Fixed{"j", 0, 1}};
    for (const spatial::Joint& kind : kinds)
      CHECK(refusal([&](Scene& s) { s.joints = {kind}, s.bodies[1].orientation = turned; }).empty() != refused);
    CHECK(refusal([&](Scene& s) {
            s.joints = {spatial::Universal{"j", 0, 1}}, s.bodies[1].orientation = turned;
          }).empty());
  }
  spatial::Universal along{"j", 0, 1};
  along.axis_a = along.axis_b = {0, 0, 1};
  CHECK(refusal([&](Scene& s) { s.joints = {along}; }).find("must be at right angles") != std::string::npos);
  const auto on_surface = [&](const SurfaceLaw& surface) {
    return refusal([&](Scene& s) {
      auto& wall = std::get<spatial::SpherePlane>(s.contacts[0]);
      wall.law.mu = 0.3, wall.law.surface = surface;
    });
  };
  CHECK(on_surface({.velocity = {1, 2, 0}, .omega = {0, 0, -3}}).empty());
  CHECK(on_surface({.velocity = {1, 0, 1e-3}}) ==
        "contact \"floor\": velocity = (1, 0, 0.001): must be along the wall: the surface moves along itself");
  CHECK(on_surface({.omega = {0, 1e-3, 1}}).find("must be along the wall's normal") != std::string::npos);
  CHECK(on_surface({.mu_across = 0.1, .direction = {0, 0, 1}}).find("a direction along the wall") != std::string::npos);
  CHECK(on_surface({.mu_across = 0.1, .direction = Vector3d(1, 0, 1).normalized()}).empty());
  CHECK(refusal([](Scene& s) { std::get<spatial::SpherePlane>(s.contacts[0]).radius = -1; }) ==
        "contact \"floor\": radius = -1: must be >= 0");
  CHECK(refusal([](Scene& s) { std::get<spatial::SpherePlane>(s.contacts[0]).law.belt = 1; }).find("planar only") !=
        std::string::npos);
  CHECK(refusal([](Scene& s) { s.bodies.clear(); }) == "scene: has no bodies: must have at least one");
}
