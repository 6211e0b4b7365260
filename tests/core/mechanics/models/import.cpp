// Models in URDF and MJCF as scenes: what is taken, what is listed, what is refused.
#include "tests/core/mechanics/models/imported.h"
#include "tests/support/folder.h"

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

using namespace orthant;

namespace {

const std::string kInertial =
    "<inertial><mass value='2'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>"
    "</inertial>";

std::string urdf_link(const std::string& name, const std::string& more = kInertial) {
  return "<link name='" + name + "'>" + more + "</link>\n";
}

std::string urdf_joint(const std::string& name, const std::string& type, const std::string& a, const std::string& b,
                       const std::string& more = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + a + "'/><child link='" + b + "'/>" + more +
         "</joint>\n";
}

std::string robot(const std::string& parts) { return "<robot name='r'>\n" + parts + "</robot>"; }

}  // namespace

TEST_CASE("URDF: joints of every type, their coordinates, limits, damping and friction") {
  const std::string limit = "<limit lower='-1' upper='2.5' effort='9' velocity='1'/>";
  const Imported t =
      taken(robot(urdf_link("base", "") + urdf_link("a") + urdf_link("b") + urdf_link("c") + urdf_link("d") +
                  urdf_link("e") + urdf_link("f") +
                  urdf_joint("r", "revolute", "base", "a",
                             "<origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/><axis xyz='0 2 0'/>" + limit +
                                 "<dynamics damping='0.1' friction='0.2'/>") +
                  urdf_joint("c", "continuous", "a", "b", "<axis xyz='0 0 1'/>") +
                  urdf_joint("p", "prismatic", "b", "c", "<origin xyz='0 0 1'/>" + limit) +
                  urdf_joint("f", "fixed", "c", "d", "<origin xyz='0 0 1'/>") +
                  urdf_joint("q", "planar", "d", "e", "<axis xyz='0 0 1'/>") + urdf_joint("g", "floating", "e", "f")),
            {"at.r=0.5", "at.p=0.25"});
  const spatial::Scene& s = t.scene;
  REQUIRE(s.bodies.size() == 5);  // d is a part of c
  CHECK(s.bodies[2].name == "c");
  CHECK(s.bodies[2].mass == 4);
  CHECK(s.bodies[2].inertia(0, 0) == doctest::Approx(2 + 4 * 0.25).epsilon(1e-14));  // two of mass 2, 1 m apart
  REQUIRE(s.joints.size() == 4);
  CHECK(broken_at_start(s) < 1e-14);
  const auto k = at_start(s);
  const auto& r = std::get<spatial::Revolute>(s.joints[0]);
  CHECK(r.name == "r");
  CHECK((r.axis_a - Vector3d(-1, 0, 0)).norm() < 1e-15);
  CHECK(r.angle().value(k) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(std::get<spatial::Prismatic>(s.joints[2]).displacement().value(k) == doctest::Approx(0.25).epsilon(1e-13));
  CHECK(std::holds_alternative<spatial::PlaneJoint>(s.joints[3]));
  REQUIRE(s.contacts.size() == 4);
  const auto& lower = std::get<spatial::Limit>(s.contacts[0]);
  CHECK(lower.gap(k) == doctest::Approx(1.5).epsilon(1e-13));
  CHECK(std::get<spatial::Limit>(s.contacts[1]).gap(k) == doctest::Approx(2).epsilon(1e-13));
  CHECK(s.frictions.at(0).bound == 0.2);
  CHECK(std::get<spatial::JointSpring>(s.springs.at(0)).damping == 0.1);
  CHECK(t.noted("not taken: effort of <limit> (2 times, line 9)"));
  CHECK_FALSE(t.noted("lower"));
}

TEST_CASE("limits of a joint that turns almost all the way round hold from both sides") {
  const auto gaps = [](double angle) {
    const Imported t =
        taken(robot(urdf_link("base", "") + urdf_link("a") +
                    urdf_joint("j", "revolute", "base", "a", "<axis xyz='0 0 1'/><limit lower='-2.9' upper='2.9'/>")),
              {"at.j=" + std::to_string(angle)});
    const auto k = at_start(t.scene);
    return std::pair{std::get<spatial::Limit>(t.scene.contacts.at(0)).gap(k),
                     std::get<spatial::Limit>(t.scene.contacts.at(1)).gap(k)};
  };
  for (const double angle : {-3.0, -2.9, -2.0, 0.0, 1.0, 2.9, 3.0}) {
    CAPTURE(angle);
    const auto [lower, upper] = gaps(angle);
    CHECK(lower == doctest::Approx(angle + 2.9).epsilon(1e-12));
    CHECK(upper == doctest::Approx(2.9 - angle).epsilon(1e-12));
  }
  CHECK(taken(robot(urdf_link("base", "") + urdf_link("a") +
                    urdf_joint("j", "revolute", "base", "a", "<limit lower='-6.3' upper='6.3'/>")))
            .noted("not taken: limits of joint j, a full turn or more apart"));
}

TEST_CASE("URDF: inertias in any frame, base free or fixed, names that the scene cannot have, starts within limits") {
  const Imported t = taken(
      robot(urdf_link("ground",
                      "<inertial><origin xyz='0 0 1' rpy='0 1.5707963267948966 0'/><mass value='3'/>"
                      "<inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' izz='2.5'/></inertial>") +
            urdf_link("a/b c") + urdf_joint("j.1", "revolute", "ground", "a/b c", "<limit lower='0.2' upper='1'/>")),
      {"base=free"});
  REQUIRE(t.scene.bodies.size() == 2);
  CHECK(t.scene.bodies[0].name == "ground_");
  CHECK(t.scene.bodies[1].name == "a_b_c");
  CHECK((t.scene.bodies[0].position - Vector3d(0, 0, 1)).norm() == 0);
  CHECK((t.scene.bodies[0].inertia.diagonal() - Vector3d(2.5, 2, 1)).norm() < 1e-15);
  CHECK(t.scene.joints.size() == 1);
  CHECK(t.noted("joint j.1 starts at its limit, 0.2"));
  CHECK(taken(robot(urdf_link("base") + urdf_link("a") + urdf_joint("f", "fixed", "base", "a")),
              {"base=free", "fixed_joints=keep"})
            .scene.joints.size() == 1);
}

TEST_CASE("URDF: shapes of collisions; neighbours in the tree and shapes that overlap at the start do not meet") {
  const auto shape = [](const std::string& geometry, const std::string& at = "0 0 0") {
    return kInertial + "<collision><origin xyz='" + at + "'/><geometry>" + geometry + "</geometry></collision>" +
           "<visual><geometry><sphere radius='1'/></geometry></visual>";
  };
  const std::string z = "<origin xyz='0 0 1'/><axis xyz='0 1 0'/>";
  const Imported t =
      taken(robot(urdf_link("base", "<collision><geometry><box size='1 1 0.2'/></geometry></collision>") +
                  urdf_link("a", shape("<sphere radius='0.1'/>", "0 0 0.5")) +
                  urdf_link("b", shape("<cylinder radius='0.1' length='0.5'/>")) +
                  urdf_link("c", shape("<capsule radius='0.1' length='0.5'/>", "0 0 -1.5")) +
                  urdf_joint("x", "continuous", "base", "a", z) + urdf_joint("y", "continuous", "a", "b", z) +
                  urdf_joint("z", "continuous", "b", "c", z)),
            {"floor=-1", "mu=0.25"});
  REQUIRE(t.scene.collisions.size() == 1);
  const spatial::Collision& c = t.scene.collisions[0];
  REQUIRE(c.shapes.size() == 4);
  CHECK(c.law.mu == 0.25);
  CHECK(c.shapes[0].body == kGround);
  CHECK(c.shapes[1].sphere());
  CHECK(c.shapes[2].corners.size() == 48);
  CHECK(c.shapes[3].capsule());
  // Joined: ground and a, a and b, b and c; a and c overlap.
  CHECK(c.apart.size() == 4);
  CHECK(t.noted("overlap at the start, and do not meet: a and c"));
  CHECK(t.noted("1 cylinder meets other bodies as a prism of 24 sides"));
  CHECK(t.noted("not taken: <visual> of <link> (3 times, line 3)"));
  CHECK(t.scene.contacts.size() == 1 + 6 + 2);  // with the floor: sphere, cylinder, capsule
}

TEST_CASE("meshes: only from the model's folder, or the allowed one; links lead nowhere else") {
  const Folder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder.path / name).parent_path());
    std::ofstream(folder.path / name) << text;
  };
  const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  write("robot/urdf/arm.urdf", "");
  write("robot/urdf/near.obj", tetrahedron), write("robot/meshes/far.obj", tetrahedron),
      write("secret.obj", tetrahedron);
  std::filesystem::create_symlink(folder.path / "secret.obj", folder.path / "robot/urdf/link.obj");
  const std::string file = (folder.path / "robot/urdf/arm.urdf").string();
  const auto with = [&](const std::string& name, const std::vector<std::string>& sets = {}) {
    return refusal_of_model(robot(urdf_link("base", "") +
                                  urdf_link("a", kInertial + "<collision><geometry><mesh filename='" + name +
                                                     "'/></geometry></collision>") +
                                  urdf_joint("j", "continuous", "base", "a")),
                            sets, file);
  };
  CHECK(with("near.obj") == "taken");
  for (const char* name : {"../meshes/far.obj", "link.obj", "/etc/passwd", "file:///etc/passwd", "../../secret.obj",
                           "package://robot/../../../secret.obj"}) {
    CAPTURE(name);
    CHECK(with(name).find("must be in the folder ") != std::string::npos);
  }
  const std::string allowed = "folder=" + (folder.path / "robot").string();
  CHECK(with("../meshes/far.obj", {allowed}) == "taken");
  CHECK(with("package://robot/meshes/far.obj", {allowed}) == "taken");
  CHECK(with("package://robot/meshes/far.obj", {"folder=" + folder.path.string()}) == "taken");
  CHECK(with("link.obj", {allowed}).find("must be in the folder ") != std::string::npos);
  CHECK(with("none.obj").find("must be a file that exists") != std::string::npos);
  CHECK(with("http://x/y.obj").find("nothing is fetched") != std::string::npos);
  CHECK(
      refusal_of_model(robot(urdf_link("base", "") +
                             urdf_link("a", kInertial + "<collision><geometry><mesh filename='/etc/passwd'/></geometry>"
                                                        "</collision>") +
                             urdf_joint("j", "continuous", "base", "a")))
          .find("a model without a file of its own names no others") != std::string::npos);
}

// One table of faults and the words that they must give.
TEST_CASE("wrong models are refused with file, line, element, value and rule") {
  const std::string base = urdf_link("base", ""), a = urdf_link("a"),
                    hinge = urdf_joint("j", "continuous", "base", "a");
  const auto geometry = [&](const std::string& g) {
    return robot(base + urdf_link("a", kInertial + "<collision><geometry>" + g + "</geometry></collision>") + hinge);
  };
  const auto body = [](const std::string& parts) { return mujoco(world("<body name='b'>" + parts + "</body>")); };
  const std::string ball = "<geom size='0.1'/>";
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"<robot", "m.xml:1: is no XML: "},
      {"<scene/>", "m.xml:1: <scene>: must be <robot> (URDF) or <mujoco> (MJCF)"},
      {"<!DOCTYPE x [<!ENTITY a 'b'>]><robot/>", "must have no document type"},
      {robot(""), "<robot name=\"r\">: must have a <link>"},
      {robot(base + base), "m.xml:3: <link name=\"base\">: name = 'base': must be distinct, is taken"},
      {robot(base + a), "m.xml:3: <link name=\"a\">: is a root as link base is: must be one tree"},
      {robot(base + a + urdf_joint("j", "hinge", "base", "a")),
       "m.xml:4: <joint name=\"j\">: type = 'hinge': must be one of revolute, continuous"},
      {robot(base + a + urdf_joint("j", "continuous", "base", "b")),
       "<child>: link = 'b': must be the name of a <link>"},
      {robot(base + a + urdf_joint("j", "continuous", "a", "a")), "joins link a to itself"},
      {robot(base + a + hinge + urdf_joint("k", "fixed", "base", "a")),
       "is the child of m.xml:4: <joint name=\"j\"> already"},
      {robot(urdf_link("a") + urdf_link("b") + urdf_joint("j", "fixed", "a", "b") + urdf_joint("k", "fixed", "b", "a")),
       "has no root"},
      {robot(base + a + urdf_joint("j", "revolute", "base", "a")), "missing element <limit>"},
      {robot(base + a + urdf_joint("j", "revolute", "base", "a", "<limit lower='1' upper='1'/>")),
       "<limit>: lower = 1: must be < upper = 1"},
      {robot(base + a + urdf_joint("j", "continuous", "base", "a", "<axis xyz='0 0 0'/>")),
       "<axis>: xyz = '0 0 0': must be a direction, not zero"},
      {robot(base + a + urdf_joint("j", "continuous", "base", "a", "<axis xyz='0 1'/>")),
       "xyz = '0 1': must be 3 numbers"},
      {robot(base + a + urdf_joint("j", "continuous", "base", "a", "<origin xyz='0 nan 1'/>")), "must be 3 numbers"},
      {robot(base + a + urdf_joint("j", "continuous", "base", "a", "<dynamics damping='-1'/>")),
       "damping = '-1': must be >= 0"},
      {robot(base + urdf_link("a", "") + hinge), "<link name=\"a\">: has no mass, but moves"},
      {robot(base + urdf_link("a", "<inertial><mass value='-2'/></inertial>") + hinge), "value = '-2': must be >= 0"},
      {robot(base + urdf_link("a", "<inertial><mass value='2'/></inertial>") + hinge), "missing element <inertia>"},
      {robot(base +
             urdf_link("a",
                       "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='3'/>"
                       "</inertial>") +
             hinge),
       "must be those of a body, no one larger than the sum of the others"},
      {robot(base), "nothing can move"},
      {robot("<xacro:macro/>" + base), "must be expanded before"},
      {geometry("<box size='1 1 0'/>"), "size = '1 1 0': must be three lengths > 0"},
      {geometry("<sphere radius='-1'/>"), "radius = '-1': must be > 0"},
      {geometry("<cone/>"), "<cone>: must be <box>, <sphere>"},
      {geometry(""), "<geometry>: must have one shape"},
      {mujoco(""), "missing element <worldbody>"},
      {body("<joint type='screw'/>" + ball), "type = 'screw': must be one of hinge, slide, ball, free"},
      {body("<joint range='1 0'/>" + ball), "range = '1 0': must be two numbers, the first one less"},
      {body("<joint limited='true'/>" + ball), "limited = 'true': must have a range"},
      {body("<joint class='x'/>" + ball), "class = 'x': must be the class of a <default>"},
      {body("<joint/><geom type='box' size='1 1'/>"), "size: must be 3 numbers"},
      {body("<joint/><geom type='capsule' size='1' fromto='0 0 0 0 0 0'/>"), "must be two different points"},
      {body("<joint/><geom type='mesh' mesh='x'/>"), "mesh = 'x': must be the name of a <mesh>"},
      {body("<joint/><geom type='plane' size='1 1 1'/>"), "must be in a body that cannot move"},
      {body("<joint/>"), "<body name=\"b\">: has no mass, but moves"},
      {body("<freejoint/><joint/>" + ball), "must be the only joint of its body"},
      {body("<joint/><inertial mass='1'/>"), "must have either diaginertia or fullinertia"},
      {mujoco(world("<body quat='0 0 0 0'><joint/>" + ball + "</body>")), "quat = '0 0 0 0': must be a quaternion"},
      {mujoco(world("<body euler='0 0 1' quat='1 0 0 0'><joint/>" + ball + "</body>")), "must be the only orientation"},
      {mujoco("<compiler eulerseq='xyw'/>" + world("")), "eulerseq = 'xyw': must be three letters"},
      {mujoco("<compiler coordinate='global'/>" + world("")), "coordinate = 'global': must be local"},
      {mujoco(world("")), "nothing can move"},
      {mujoco(world("<replicate count='3'><body><freejoint/>" + ball + "</body></replicate>")),
       "not taken: <replicate> of <worldbody> (line 2)"},
      {body("<joint/><inertial mass='1' pos='0 0 0' quat='0 1 0 0' fullinertia='1 1 1 0 0 0'/>"),
       "quat = '0 1 0 0': must be left out next to fullinertia"},
  };
  for (const auto& [text, words] : wrong) {
    CAPTURE(text);
    const std::string said = refusal_of_model(text);
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
    CHECK(said.starts_with("m.xml"));
  }
  const std::string good = robot(base + a + hinge);
  CHECK(refusal_of_model(good, {"base=loose"}) == "option model.base = 'loose': must be one of fixed, free");
  CHECK(refusal_of_model(good, {"at.k=1"})
            .find("option model.at.k: must be the name of a joint that turns or slides, one of j") == 0);
  CHECK(refusal_of_model(good, {"speed=1"}).find("unknown option model.speed: must be one of") == 0);
  CHECK(refusal_of_model(good, {"floor=high"}).find("option model.floor = 'high': must be a number") == 0);
  std::string deep;
  for (int i = 0; i < 600; ++i) deep += "<a>";
  CHECK(refusal_of_model(deep).find("elements are nested too deep: must be at most ") != std::string::npos);
  CHECK(refusal_of_model(std::string(200001, '<')).find("has more than 200000 tags") != std::string::npos);
}

TEST_CASE("models are scenes wherever a file is: overrides, options, notes; planar readers refuse them") {
  const std::string text = robot(urdf_link("base", "") + urdf_link("a") + urdf_joint("j", "continuous", "base", "a"));
  const std::vector<std::string> sets = {"body.a.mass=5", "model.at.j=0.3", "duration=2"};
  const auto scene = std::get<spatial::Scene>(parse_any_scene(text, sets, "arm.urdf"));
  CHECK(scene.bodies.at(0).mass == 5);
  CHECK(scene.duration == 2);
  const auto noted = std::get<spatial::Scene>(parse_any_scene(
      robot(urdf_link("base", "<visual/>") + urdf_link("a") + urdf_joint("j", "continuous", "base", "a")), {},
      "arm.urdf"));
  REQUIRE(noted.notes.size() == 1);
  CHECK(noted.notes[0] == "arm.urdf: not taken: <visual> of <link> (line 2)");
  CHECK_THROWS_WITH_AS(static_cast<void>(parse_scene(text, {}, "arm.urdf")),
                       "arm.urdf: is a model in space: must be a planar scene here", std::invalid_argument);
}
