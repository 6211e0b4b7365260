// Screw, gear, rack, pin in a bush, block in a channel: residuals, rows and gaps against differences and searches.
#include "tests/support/spatial.h"

#include <orthant/core/mechanics/scene/scene_toml.h>

#include <doctest/doctest.h>

#include <numbers>

using namespace orthant;

namespace {

constexpr double kOneTurn = 2 * std::numbers::pi;

Vector3d vector_of(int seed) { return {std::sin(1.0 + seed), std::cos(2.0 + 3 * seed), std::sin(4.0 + 5 * seed)}; }

/// Two bodies with the same axis z, b turned by `angle` about it and moved by `way` along it, all turned in space.
spatial::Scene on_one_axis(double angle, double way) {
  const Eigen::Vector4d R = quaternions::exponential(1.3 * vector_of(3)).normalized();
  const Vector3d z = quaternions::matrix_of(R).col(2);
  spatial::Scene s;
  s.body({.inertia = Vector3d(2, 3, 4).asDiagonal(), .position = vector_of(5), .orientation = R});
  s.body({.inertia = Vector3d(4, 3, 2).asDiagonal(),
          .position = vector_of(5) + way * z,
          .orientation = quaternions::turned(R, Vector3d(0, 0, angle))});
  return s;
}

struct MachineFixture {
  SpatialSystem system;
  State x = system.initial_state();
  TermsOf<Spatial> terms{system};

  explicit MachineFixture(const spatial::Scene& scene) : system(scene) {}
  TermsOf<Spatial>& at(const Eigen::VectorXd& q) {
    set_poses(system, 0, q, terms.at);
    set_twists(system, x.v, terms.at);
    evaluate_joints(system, terms);
    evaluate_gaps(system, terms);
    evaluate_closed(system, 1e9, terms);
    return terms;
  }
  Eigen::VectorXd moved(double by, Index along) {
    Eigen::VectorXd q;
    move<Spatial>(x.q, by * Eigen::VectorXd::Unit(system.dof(), along), q);
    return q;
  }
};

spatial::Scene machine_of(const std::string& elements) {
  const std::string text = R"(dimension = 3
[[body]]
name = "a"
mass = 1
inertia = 1
position = [1, 0, 0]
[[body]]
name = "b"
mass = 1
inertia = 1
position = [0, 2, 0]
[[joint]]
type = "revolute"
name = "pin_a"
bodies = ["ground", "a"]
point_a = [1, 0, 0]
axis = [0, 0, 1]
angle = 0.3
[[joint]]
type = "prismatic"
name = "rail_b"
bodies = ["ground", "b"]
axis = [0, 1, 0]
)" + elements;
  return std::get<spatial::Scene>(parse_any_scene(text, {}, "machine.toml"));
}
std::string refused_machine(const std::string& elements) {
  try {
    machine_of(elements);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a screw's and a gear's residual is 0 after any number of turns, and its row the derivative") {
  const double pitch = 0.02;
  for (const double turns : {0.0, 0.3, 0.75, -2.6, 7.1}) {
    CAPTURE(turns);
    spatial::Scene s = on_one_axis(kOneTurn * turns, 0.4 + pitch * turns);
    s.joint(spatial::Screw{.name = "screw", .a = 0, .b = 1, .pitch = pitch, .offset = 0.4});
    s.joint(spatial::Gear("rack", spatial::Angle{0, 1}, spatial::Slide{.a = 0, .b = 1, .axis = {0, 0, 1}},
                          pitch / kOneTurn, 0.4));
    MachineFixture f(s);
    CHECK(f.at(f.x.q).phi.lpNorm<Eigen::Infinity>() < 1e-13);
    const std::vector<RowOf<Spatial>> G = f.terms.G;
    for (const Index i : {4, 5})
      for (const Index k : {0, 1, 2, 5, 6, 7, 8, 11}) {  // those that keep the axes along each other
        const double after = f.at(f.moved(1e-6, k)).phi[i], before = f.at(f.moved(-1e-6, k)).phi[i];
        CHECK(std::abs((after - before) / 2e-6 -
                       apply(G[static_cast<std::size_t>(i)], Eigen::VectorXd::Unit(12, k).eval().data())) < 1e-8);
      }
  }
  for (const double turns : {0.0, 0.4, 5.3, -11.8}) {  // 20 outer teeth on 60
    spatial::Scene s = on_one_axis(0, 1);
    const Vector3d z = quaternions::matrix_of(s.bodies[0].orientation).col(2);
    const auto about = [&](BodyId b) { return spatial::Angle{.a = kGround, .b = b, .axis_a = z, .axis_b = {0, 0, 1}}; };
    spatial::Gear gear("gear", about(0), about(1), -20.0 / 60);
    const SpatialSystem start(s);
    gear.offset = gear.value(poses_of(start, start.initial_state()));
    s.bodies[0].orientation = quaternions::turned(s.bodies[0].orientation, Vector3d(0, 0, kOneTurn * turns));
    s.bodies[1].orientation = quaternions::turned(s.bodies[1].orientation, Vector3d(0, 0, -kOneTurn * turns / 3));
    s.joint(gear);
    MachineFixture f(s);
    CHECK(std::abs(f.at(f.x.q).phi[0]) < 1e-12);
    CHECK(std::abs(apply(f.terms.G[0], Eigen::VectorXd::Unit(12, 5).eval().data()) - 1.0 / 3) < 1e-14);
    CHECK(std::abs(apply(f.terms.G[0], Eigen::VectorXd::Unit(12, 11).eval().data()) - 1) < 1e-14);
  }
}

TEST_CASE("a gear refuses ratios without teeth, distances and three bodies") {
  const spatial::Angle one{kGround, 0}, other{kGround, 1};
  CHECK_THROWS_WITH_AS(spatial::Gear("g", one, other, std::sqrt(2.0)),
                       "ratio: must be a quotient of whole numbers up to 1000, such as numbers of teeth",
                       std::invalid_argument);
  CHECK_THROWS_AS(spatial::Gear("g", one, other, 0), std::invalid_argument);
  CHECK_THROWS_AS(spatial::Gear("g", one, spatial::Span{0, 1}, 2), std::invalid_argument);
  CHECK_THROWS_WITH_AS(spatial::Gear("g", spatial::Angle{2, 0}, spatial::Angle{2, 1}, 2),
                       "acts on three bodies: must act on two at the most besides the ground", std::invalid_argument);
  CHECK(spatial::Gear("g", one, spatial::Slide{kGround, 1}, std::sqrt(2.0)).b == 1);
}

TEST_CASE("the gap of a pin in a bush is that of the extreme point of a rim, its row the derivative, for any tilt") {
  int tilted = 0;
  for (int seed = 0; seed < 40; ++seed)
    for (const bool of_pin : {true, false}) {
      CAPTURE(seed);
      CAPTURE(of_pin);
      const double tilt = seed % 4 == 0 ? 0.9 : 0.02, off = seed % 3 == 0 ? 0.3 : 0.004;
      spatial::Scene s = on_one_axis(0.7 * seed, 0.05);
      s.bodies[1].orientation =
          quaternions::turned(s.bodies[1].orientation, Vector3d(tilt * std::sin(seed), tilt * std::cos(seed), 0));
      s.bodies[1].position += off * vector_of(seed);
      const spatial::PinBush pin{.name = "pin",
                                 .a = 1,
                                 .centre_a = {0.001, 0, 0.01},
                                 .radius_a = 0.1,
                                 .b = 0,
                                 .centre_b = {0, 0.002, 0},
                                 .radius_b = 0.11,
                                 .rim_of_pin = of_pin,
                                 .along = seed % 2 == 0 ? 0.2 : -0.2,
                                 .law = {.mu = 0.5}};
      s.contact(pin);
      MachineFixture f(s);
      const ContactRowsOf<Spatial> rows = f.at(f.x.q).closed.at(0).rows;
      const double gap = f.terms.gap[0];
      // All points of the rim.
      const auto& k = f.terms.at;
      const auto& own = k.at(of_pin ? 1 : 0);
      const auto& other = k.at(of_pin ? 0 : 1);
      const Vector3d centre = own.x + own.turn((of_pin ? pin.centre_a : pin.centre_b) + Vector3d(0, 0, pin.along));
      const Vector3d from = other.x + other.turn(of_pin ? pin.centre_b : pin.centre_a), w = other.R.col(2);
      double extreme = of_pin ? 0 : 1e9;
      for (int i = 0; i < 200000; ++i) {
        const double phi = kOneTurn * i / 200000;
        const Vector3d p =
            centre + (of_pin ? 0.1 : 0.11) * (std::cos(phi) * own.R.col(0) + std::sin(phi) * own.R.col(1)) - from;
        const double distance = (p - p.dot(w) * w).norm();
        extreme = of_pin ? std::max(extreme, distance) : std::min(extreme, distance);
      }
      // A pin with its axis outside of the bush's rim is out of the bush.
      const Vector3d to_axis = from - centre, normal = own.R.col(2);
      const Vector3d met = to_axis - w * (to_axis.dot(normal) / w.dot(normal));
      if (!of_pin && met.norm() > 0.11) extreme = -extreme;
      CHECK(std::abs(gap - (of_pin ? 0.11 - extreme : extreme - 0.1)) < 1e-9);
      if (off == 0.3 && !of_pin) continue;  // a rim beside the pin: its nearest point may jump
      tilted += tilt > 0.5;
      for (Index i = 0; i < 12; ++i) {
        const double after = f.at(f.moved(1e-6, i)).gap[0], before = f.at(f.moved(-1e-6, i)).gap[0];
        CHECK(std::abs((after - before) / 2e-6 - apply(rows.normal, Eigen::VectorXd::Unit(12, i).eval().data())) <
              2e-6);
      }
      CHECK(std::abs(spatial::direction_of(rows.normal).norm() - 1) < 1e-14);
    }
  CHECK(tilted > 10);
}

TEST_CASE("a pin that is parallel to its bush, or in its middle, has the gap of two circles") {
  spatial::Scene s = on_one_axis(0.4, 0);
  const spatial::PinBush pin{.name = "pin", .a = 1, .radius_a = 0.1, .b = 0, .radius_b = 0.1005};
  for (const spatial::PinBush& rim : spatial::pin_in_bush(pin, 0.2)) s.contact(rim);
  MachineFixture middle(s);
  CHECK((middle.at(middle.x.q).gap.array() - 0.0005).abs().maxCoeff() < 1e-15);
  const Vector3d x = quaternions::matrix_of(s.bodies[0].orientation).col(0);
  s.bodies[1].position += 0.0003 * x;
  MachineFixture beside(s);
  CHECK((beside.at(beside.x.q).gap.array() - 0.0002).abs().maxCoeff() < 1e-15);
  CHECK((spatial::direction_of(beside.terms.closed.at(0).rows.normal) + x).norm() < 1e-11);
  CHECK(s.contacts.size() == 2);
}

TEST_CASE("screws, gears, racks, pins in bushes and blocks in channels are read from TOML") {
  const spatial::Scene s = machine_of(R"(
[[joint]]
type = "rack"
name = "rack"
joints = ["pin_a", "rail_b"]
radius = 0.5
[[contact]]
type = "pin-bush"
name = "bearing"
bodies = ["a", "b"]
axis = [0, 0, 1]
radius_a = 0.01
radius_b = 0.0101
length_a = 0.05
length_b = 0.04
mu = 0.1
[[contact]]
type = "block-channel"
name = "guide"
bodies = ["b", "ground"]
axis = [0, 1, 0]
up = [0, 0, 1]
size = [0.4, 0.2, 0.1]
width = 0.21
height = 0.11
)");
  const auto& rack = std::get<spatial::Gear>(s.joints.at(2));
  CHECK(rack.ratio == 0.5);
  CHECK(std::abs(rack.offset - (2 - 0.5 * 0.3)) < 1e-12);
  REQUIRE(s.contacts.size() == 2 + 16);
  const auto& rim = std::get<spatial::PinBush>(s.contacts.at(0));
  CHECK(rim.name == "bearing_1");
  CHECK_FALSE(rim.rim_of_pin);  // the bush is shorter
  CHECK(rim.along == -0.02);
  const SpatialSystem system(s);
  TermsOf<Spatial> terms(system);
  set_poses(system, 0, system.initial_state().q, terms.at);
  evaluate_gaps(system, terms);
  for (Index i = 2; i < 18; ++i) CHECK(std::abs(terms.gap[i] - 0.005) < 1e-14);
  const auto screw = std::get<spatial::Screw>(
      machine_of("[[joint]]\ntype = 'screw'\nbodies = ['a', 'b']\npoint_a = [-1, 2, -0.3]\naxis = [0, 0, "
                 "1]\nangle = 1\npitch = 0.02\n")
          .joints.at(2));
  CHECK(screw.pitch == 0.02);
  CHECK(std::abs(screw.offset - (0.3 - 0.02 / kOneTurn)) < 1e-12);
  const auto gear =
      std::get<spatial::Gear>(machine_of("[[joint]]\ntype = 'gear'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\naxis_b = "
                                         "[1, 0, 0]\nteeth = [20, 60]\n")
                                  .joints.at(2));
  CHECK(gear.ratio == -20.0 / 60);
  const std::string play = "[[contact]]\ntype = 'backlash'\nname = 'teeth'\njoints = ['pin_a', 'rail_b']\n";
  const auto flanks = machine_of(play + "radius = 0.5\nplay = 0.02\ne_n = 0.3\n").contacts;
  REQUIRE(flanks.size() == 2);
  const auto &lower = std::get<spatial::Backlash>(flanks.at(0)), &upper = std::get<spatial::Backlash>(flanks.at(1));
  CHECK(lower.name == "teeth_lower");
  CHECK(upper.flank == spatial::Limit::Side::upper);
  CHECK(lower.gear.ratio == 0.5);
  CHECK(upper.law.e == 0.3);
  MachineFixture f(machine_of(play + "radius = 0.5\nplay = 0.02\n"));
  f.at(f.x.q), evaluate_gaps(f.system, f.terms);
  CHECK(std::abs(f.terms.gap[0] - 0.01) < 1e-15);
  CHECK(std::abs(f.terms.gap[1] - 0.01) < 1e-15);
}

TEST_CASE("mistakes in screws, gears, racks, pins and channels are named") {
  const auto has = [](const std::string& elements, const std::string& words) {
    INFO(refused_machine(elements));
    CHECK(refused_machine(elements).find(words) != std::string::npos);
  };
  has("[[joint]]\ntype = 'screw'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\n", "missing key \"pitch\"");
  has("[[joint]]\ntype = 'screw'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\npitch = 0\n", "pitch = 0: must be not 0");
  has("[[joint]]\ntype = 'gear'\njoints = ['pin_a', 'rail_b']\nteeth = [0, 1]\n", "two whole numbers from 1 to 1000");
  has("[[joint]]\ntype = 'gear'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nratio = 0.33333333\n",
      "must be a quotient of whole numbers up to 1000");
  has("[[joint]]\ntype = 'gear'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nratio = 2\nteeth = [1, 2]\n",
      "ratio, teeth: must be one of them");
  has("[[joint]]\ntype = 'rack'\njoints = ['rail_b', 'pin_a']\nradius = 1\n", "must be an angle, then a displacement");
  has("[[joint]]\ntype = 'rack'\njoints = ['pin_a', 'rail_c']\nradius = 1\n", "must be the name of a joint");
  const std::string pin = "[[contact]]\ntype = 'pin-bush'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nradius_a = 1\n";
  has(pin + "radius_b = 2\n", "missing key \"length_a\" or \"length_b\"");
  const std::string teeth = "[[contact]]\ntype = 'backlash'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nteeth = [20, 60]\n";
  has(teeth, "missing key \"play\"");
  has(teeth + "play = -0.1\n", "play = -0.1: must be >= 0");
  has(teeth + "play = 3\n", "play = 3: must be < 2.0943951023931953, from tooth to tooth");
  has(teeth + "play = 0.1\nmu = 0.3\n", "mu");
  has(pin + "radius_b = 1\nlength_a = 1\n", "radius_b = 1: must be > radius_a = 1");
  has(pin + "radius_b = 2\nlength_a = -1\n", "length_a = -1: must be > 0");
  const std::string bush = "[[contact]]\ntype = 'sphere-bush'\nbodies = ['a', 'b']\nradius_a = 1\n";
  has(bush + "radius_b = 2\n", "missing key \"axis_b\"");
  has(bush + "radius_b = 2\naxis_b = [0, 0, 0]\n", "must be a direction, not zero");
  has(bush + "radius_b = 0.9\naxis_b = [0, 0, 1]\n", "radius_b = 0.9: must be > radius_a = 1");
  const std::string block =
      "[[contact]]\ntype = 'block-channel'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nsize = [1, 1, "
      "1]\nheight = 2\n";
  has(block + "up = [0, 1, 1]\nwidth = 2\n", "must be at right angles to axis");
  has(block + "up = [0, 1, 0]\nwidth = 0.5\n", "width = 0.5: must be >= the block's");
}
