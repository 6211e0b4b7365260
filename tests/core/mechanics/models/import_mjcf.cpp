// Import of MJCF: angles, classes, masses of geoms, stacks of joints, masks, included files.
#include "tests/core/mechanics/models/imported.h"
#include "tests/support/folder.h"

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <array>
#include <numbers>

using namespace orthant;

TEST_CASE("MJCF: degrees, Euler sequences, default classes, masses of geoms, references of joints") {
  const Imported t = taken(
      mujoco("<compiler angle='degree' eulerseq='XYZ'/><option gravity='0 0 -1' timestep='0.01'/>"
             "<default><geom density='500' rgba='1 0 0 1'/><joint damping='2' armature='1'/>"
             "<default class='light'><geom density='100'/></default></default>" +
             world("<geom type='plane' size='1 1 .1' name='floor' friction='0.5'/>"
                   "<body name='a' pos='0 0 2' euler='0 90 0'>"
                   "<joint name='h' axis='0 1 0' range='-90 45' ref='10' stiffness='3' springref='20'/>"
                   "<geom name='rod' type='capsule' size='0.1' fromto='0 0 0 1 0 0' friction='0.8 .1 .1'/>"
                   "<frame pos='0 0 1'><body name='b' childclass='light'><joint type='slide' axis='1 0 0' damping='0'/>"
                   "<geom type='box' size='0.1 0.2 0.3' pos='0 0 0.5'/><geom type='sphere' size='0.1' mass='7'/></body>"
                   "</frame></body>") +
             "<actuator><motor name='m1' joint='h'/><motor name='m2' joint='h'/></actuator>"));
  const spatial::Scene& s = t.scene;
  CHECK(s.gravity.z() == -1);
  CHECK(s.step == 0.01);
  REQUIRE(s.bodies.size() == 2);
  const spatial::Solid rod = spatial::capsule(0.1, 1), box = spatial::box({0.2, 0.4, 0.6});
  CHECK(s.bodies[0].mass == doctest::Approx(500 * rod.volume).epsilon(1e-14));
  CHECK((s.bodies[0].position - Vector3d(0, 0, 1.5)).norm() < 1e-14);  // x of the body is −z of the world
  CHECK(s.bodies[0].inertia(0, 0) == doctest::Approx(500 * rod.volume * rod.inertia(2, 2)).epsilon(1e-13));
  CHECK(s.bodies[1].mass == doctest::Approx(100 * box.volume + 7).epsilon(1e-14));
  CHECK(broken_at_start(s) < 1e-14);
  const double degree = std::numbers::pi / 180;
  const auto k = at_start(s);
  CHECK(std::get<spatial::Revolute>(s.joints[0]).angle().value(k) == doctest::Approx(10 * degree).epsilon(1e-13));
  CHECK(std::get<spatial::Limit>(s.contacts[0]).gap(k) == doctest::Approx(100 * degree).epsilon(1e-13));
  REQUIRE(s.springs.size() == 1);  // b's own damping is 0
  const auto& spring = std::get<spatial::JointSpring>(s.springs[0]);
  CHECK(spring.rest == doctest::Approx(20 * degree).epsilon(1e-14));
  CHECK(spring.stiffness == 3);
  CHECK(spring.damping == 2);
  double mu = 0;
  for (const auto& c : s.contacts)
    if (const auto* plane = std::get_if<spatial::SpherePlane>(&c); plane && plane->name.starts_with("rod"))
      mu = plane->law.mu;
  CHECK(mu == 0.8);  // the larger of the two
  CHECK(t.noted("not taken: <motor> of <actuator> m1, m2 (2 times, line 3)"));
  CHECK(t.noted("not taken: armature of <joint> (line 2)"));
  CHECK(t.noted("not taken: rgba of <geom>"));
}

TEST_CASE("MJCF: stacks of joints as one joint of the scene") {
  const auto kind_of = [](const std::string& joints) {
    const Imported t = taken(mujoco(world("<body>" + joints + "<geom size='0.1'/></body>")));
    CHECK(broken_at_start(t.scene) < 1e-14);
    constexpr std::array kKinds = {"revolute",  "prismatic",   "fixed",     "distance", "drive",
                                   "spherical", "cylindrical", "universal", "planar"};
    return t.scene.joints.empty() ? std::string("none") : std::string(kKinds[t.scene.joints[0].index()]);
  };
  const std::string x = "<joint type='slide' axis='1 0 0'/>", y = "<joint type='slide' axis='0 1 0'/>",
                    z = "<joint type='slide' axis='0 0 1'/>", turn_x = "<joint axis='1 0 0'/>",
                    turn_y = "<joint axis='0 1 0'/>", turn_z = "<joint axis='0 0 1'/>", ball = "<joint type='ball'/>";
  CHECK(kind_of(turn_x) == "revolute");
  CHECK(kind_of(x) == "prismatic");
  CHECK(kind_of(ball) == "spherical");
  CHECK(kind_of("<freejoint/>") == "none");
  CHECK(kind_of(x + turn_x) == "cylindrical");
  CHECK(kind_of(turn_x + turn_y) == "universal");
  CHECK(kind_of(turn_x + turn_y + turn_z) == "spherical");
  CHECK(kind_of(x + z + turn_y) == "planar");
  CHECK(kind_of(x + y + z + ball) == "none");
  CHECK(kind_of(x + y + z + turn_z + turn_y + turn_x) == "none");
  CHECK(refusal_of_model(mujoco(world("<body name='b'>" + x + y + "<geom size='0.1'/></body>")))
            .find("m.xml:2: <body name=\"b\">: has 2 joints: must be one, or") == 0);
}

TEST_CASE("MJCF: condim and friction of a contact are each the larger of the two") {
  const auto mu = [](const char* floor, const char* ball, const std::string& other = "") {
    const Imported t =
        taken(mujoco(world("<geom type='plane' size='1 1 1' " + std::string(floor) +
                           "/><body name='a' pos='0 0 1'><freejoint/><geom size='0.1' " + ball + "/></body>" + other)));
    return other.empty() ? std::get<spatial::SpherePlane>(t.scene.contacts.at(0)).law.mu
                         : t.scene.collisions.at(0).law.mu;
  };
  CHECK(mu("condim='1' friction='1'", "friction='0.2'") == 1);
  CHECK(mu("friction='0.5'", "friction='0.9' condim='1'") == 0.9);
  CHECK(mu("condim='1'", "condim='1'") == 0);
  const std::string slippery =
      "<body name='b' pos='0 0 2'><freejoint/><geom size='0.1' condim='1' friction='0.7'/></body>";
  CHECK(mu("", "condim='1'", slippery) == 0);
  CHECK(mu("", "friction='0.3'", slippery) == 0.7);
}

TEST_CASE(
    "MJCF: a hinge with a reference beyond half a turn starts within it, and takes its limits and springs along") {
  const Imported t =
      taken(mujoco(world("<body><joint ref='270' range='200 300' stiffness='1' springref='260'/>"
                         "<geom size='0.1'/></body>")));
  const auto k = at_start(t.scene);
  const double degree = std::numbers::pi / 180;
  CHECK(std::get<spatial::Revolute>(t.scene.joints[0]).angle().value(k) == doctest::Approx(-90 * degree));
  CHECK(std::get<spatial::Limit>(t.scene.contacts[0]).gap(k) == doctest::Approx(70 * degree));
  CHECK(std::get<spatial::Limit>(t.scene.contacts[1]).gap(k) == doctest::Approx(30 * degree));
  CHECK(std::get<spatial::JointSpring>(t.scene.springs[0]).rest == doctest::Approx(-100 * degree));
  CHECK(refusal_of_model(mujoco(world("<body><joint stiffness='1' springref='300'/><geom size='0.1'/></body>")))
            .find("must be less than half a turn from the angle at the start, 0") != std::string::npos);
}

TEST_CASE("MJCF: masks, exclusions, ties, files that are included") {
  const std::string body = "<geom size='0.1' contype='2' conaffinity='2'/>";
  const Imported t = taken(mujoco(world("<body name='a'><freejoint/><geom size='0.1'/></body><body name='b' pos='0 0 "
                                        "1'><freejoint/><geom size='0.1'/></body>"
                                        "<body name='c' pos='0 0 2'><freejoint/>" +
                                        body + "</body><body name='d' pos='0 0 3'><freejoint/>" + body + "</body>") +
                                  "<contact><exclude body1='a' body2='b'/><pair geom1='x' geom2='y'/></contact>"
                                  "<equality><connect body1='a' body2='b' anchor='0 0 0.5'/><weld body1='c'/><joint "
                                  "joint1='x' joint2='y'/></equality>"));
  REQUIRE(t.scene.collisions.size() == 1);
  CHECK(t.scene.collisions[0].apart.size() == 5);  // a b; and a, b with c, d
  REQUIRE(t.scene.joints.size() == 2);
  CHECK(std::holds_alternative<spatial::Spherical>(t.scene.joints[0]));
  CHECK(std::holds_alternative<spatial::Fixed>(t.scene.joints[1]));
  CHECK(broken_at_start(t.scene) < 1e-14);
  CHECK(t.noted("<pair> of <contact>"));
  CHECK(t.noted("<joint> of <equality>"));

  const Folder folder;
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder.path / name) << text; };
  const std::string file = (folder.path / "main.xml").string();
  write("main.xml", ""), write("part.xml", mujoco(world("<body><freejoint/><geom size='1'/></body>")));
  write("loop.xml", mujoco("<include file='loop.xml'/>"));
  CHECK(taken(mujoco("<include file='part.xml'/>"), {}, file).scene.bodies.size() == 1);
  CHECK(refusal_of_model(mujoco("<include file='loop.xml'/>"), {}, file).find("included at most 16 files deep") !=
        std::string::npos);
  CHECK(refusal_of_model(mujoco("<include file='/etc/passwd'/>"), {}, file).find("must be in the folder") !=
        std::string::npos);
}
