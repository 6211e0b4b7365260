// What is wrong with a scene's file or an override: in words, with its line, however hostile the text.
#include <doctest/doctest.h>

#include "tests/support/scene_texts.h"

namespace orthant {
namespace {

using namespace scene_texts;

struct FileMistake {
  std::string text, message;
};

const FileMistake kFileMistakes[] = {
    // Not TOML.
    {"gravity = [0, -9.81", "s.toml:1: "},
    {kBodies + "mass 1", "s.toml:15: "},
    {kBodies + "mass = 1", "s.toml:15: "},  // twice
    // Top level.
    {"", "s.toml:1: scene: has no bodies: must have at least one"},
    {kBodies + "[gravty]",
     "s.toml:15: unknown key \"gravty\": must be one of gravity, duration, step, assemble, restitution, impacts, body, "
     "joint, "
     "contact, collision, friction, spring, load"},
    {"restitution = \"strange\"\n" + kBodies, "s.toml:1: restitution = 'strange': must be one of newton, poisson"},
    {"impacts = 2\n" + kBodies, "s.toml:1: impacts = 2: must be a string in quotes"},
    {"gravity = 9.81\n" + kBodies, "s.toml:1: gravity = 9.81: must be two numbers [x, y]"},
    {"gravity = [0, 0, -9.81]\n" + kBodies, "gravity = [0, 0, -9.81]: must be two numbers [x, y]"},
    {"gravity = [0, \"down\"]\n" + kBodies, "s.toml:1: gravity = 'down': must be a number"},
    {"gravity = [0, nan]\n" + kBodies, "s.toml:1: gravity = nan: must be finite"},
    {"impacts = \"all\"\n" + kBodies, "s.toml:1: impacts = 'all': must be one of simultaneous, sequential"},
    {"step = inf\n" + kBodies, "s.toml:1: step = inf: must be finite"},
    {"step = 0\n" + kBodies, "s.toml:1: scene: step = 0: must be > 0"},
    {"step = true\n" + kBodies, "s.toml:1: step = true: must be a number"},
    {"step = 1979-05-27\n" + kBodies, "s.toml:1: step = 1979-05-27: must be a number"},
    {"body = 3", "s.toml:1: body = 3: must be a list of tables [[body]]"},
    {"body = [3]", "s.toml:1: body = 3: must be a table"},
    {"[body]\nname = \"rod\"", "s.toml:1: body = "},
    // Bodies.
    {"[[body]]\nmass = 1\ninertia = 1", "s.toml:1: body \"body1\": missing key \"name\""},
    {"[[body]]\nname = \"a\"\ninertia = 1", "s.toml:1: body \"a\": missing key \"mass\""},
    {"[[body]]\nname = \"a\"\nmass = 1", "s.toml:1: body \"a\": missing key \"inertia\""},
    {"[[body]]\nname = 7\nmass = 1", "s.toml:2: body \"body1\": name = 7: must be a string in quotes"},
    {"[[body]]\nname = \"\"\nmass = 1\ninertia = 1", "s.toml:2: body \"body1\": name = "},
    {kBodies + "mas = 1",
     "s.toml:15: body \"ball\": unknown key \"mas\": must be one of name, mass, inertia, position, angle, velocity, "
     "omega"},
    {"[[body]]\nname = \"a\"\nmass = -1\ninertia = 1", "s.toml:3: body \"a\": mass = -1: must be > 0"},
    {"[[body]]\nname = \"a.b\"\nmass = 1\ninertia = 1",
     "s.toml:2: body \"a.b\": name = \"a.b\": must be of letters, digits, _ and -"},
    {"[[body]]\nname = \"ground\"\nmass = 1\ninertia = 1", "s.toml:2: body \"ground\": name = \"ground\": must not be"},
    {kBodies + "[[body]]\nname = \"rod\"\nmass = 1\ninertia = 1",
     "s.toml:16: body \"rod\": name = \"rod\": must be distinct, is taken"},
    // Joints.
    {kBodies + "[[joint]]\nbodies = [\"ground\", \"rod\"]", "s.toml:15: joint \"joint1\": missing key \"type\""},
    {kBodies + "[[joint]]\ntype = \"ball\"",
     "s.toml:16: joint \"joint1\": type = 'ball': must be revolute, prismatic, fixed, distance, drive, "
     "relation or gear"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nname = \"pin\"", "s.toml:15: joint \"pin\": missing key \"bodies\""},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nbodies = [\"rod\"]",
     "joint \"joint1\": bodies = ['rod']: must be two names"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nbodies = [\"ground\", \"rood\"]",
     "s.toml:17: joint \"joint1\": bodies = 'rood': must be the name of a body: ground, rod, cart, ball"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nbodies = [0, 1]", "bodies = 0: must be the name of a body"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nbodies = [\"rod\", \"rod\"]",
     "s.toml:17: joint \"joint1\": joins body \"rod\" to itself: must be two different bodies"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nbodies = [\"ground\", \"rod\"]\naxis = [1, 0]",
     "s.toml:18: joint \"joint1\": unknown key \"axis\": must be one of type, name, bodies, point_a, point_b"},
    {kBodies + "[[joint]]\ntype = \"prismatic\"\nbodies = [\"ground\", \"rod\"]\naxis = [0, 0]",
     "s.toml:18: joint \"joint1\": axis = [0, 0]: must be a direction, not zero"},
    {kBodies + "[[joint]]\ntype = \"distance\"\nbodies = [\"ground\", \"rod\"]",  // both at the origin
     "s.toml:15: joint \"joint1\": length = 0: must be > 0"},
    // Contacts.
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"",
     "s.toml:15: contact \"contact1\": missing key \"wall\""},
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"\nwall = 3",
     "s.toml:18: contact \"contact1\": wall = 3: must be a table"},
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"\nwall = {}",
     "s.toml:18: contact \"contact1\": missing key \"wall.normal\""},
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"\nwall = {normal = [0, 0]}",
     "s.toml:18: contact \"contact1\": wall.normal = [0, 0]: must be a direction, not zero"},
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1], tilt = 3}",
     "s.toml:18: contact \"contact1\": unknown key \"wall.tilt\": must be one of body, point, normal"},
    {kBodies + "[[contact]]\ntype = \"corner-wall\"\nbody = \"rod\"\nwall = {body = \"rood\", normal = [0, 1]}",
     "s.toml:18: contact \"contact1\": wall.body = 'rood': must be the name of a body: ground, rod, cart, ball"},
    {kCorner + "mu = -0.1", "s.toml:20: contact \"foot\": mu = -0.1: must be >= 0"},
    {kCorner + "mu = \"much\"", "s.toml:20: contact \"foot\": mu = 'much': must be a number"},
    {kCorner + "mu = 0.3\nmu_static = 0.2", "s.toml:21: contact \"foot\": mu_static = 0.2: must be >= mu = 0.3"},
    {kCorner + "mu_static = -1", "s.toml:20: contact \"foot\": mu_static = -1: must be >= 0"},
    {kCorner + "belt = inf", "s.toml:20: contact \"foot\": belt = inf: must be finite"},
    {kCorner + "e_n = 2", "s.toml:20: contact \"foot\": e_n = 2: must be in [0, 1]"},
    {kCorner + "e_t = -2", "s.toml:20: contact \"foot\": e_t = -2: must be in [-1, 1]"},
    {kCorner + "radius = 1",
     "s.toml:20: contact \"foot\": unknown key \"radius\": must be one of type, name, body, point"},
    {kBodies + "[[contact]]\ntype = \"disc-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1]}",
     "s.toml:15: contact \"contact1\": missing key \"radius\""},
    {kBodies + "[[contact]]\ntype = \"disc-wall\"\nbody = \"rod\"\nradius = 0\nwall = {normal = [0, 1]}",
     "s.toml:18: contact \"contact1\": radius = 0: must be > 0"},
    {kBodies + "[[contact]]\ntype = \"disc-disc\"\nbodies = [\"rod\", \"ball\"]\nradius_a = 1",
     "s.toml:15: contact \"contact1\": missing key \"radius_b\""},
    {kBodies + "[[contact]]\ntype = \"disc\"",
     "type = 'disc': must be corner-wall, disc-wall, disc-disc, polygon-wall, "},
    {kBodies + "[[contact]]\ntype = \"polygon-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1]}",
     "s.toml:15: contact \"contact1\": missing key \"corners\""},
    {kBodies + "[[contact]]\ntype = \"polygon-wall\"\nbody = \"rod\"\nwall = {normal = [0, 1]}\n"
               "corners = [[0, 0], [0, 1], [1, 0]]",
     "s.toml:19: contact \"contact1\": corners = [[0, 0], [0, 1], [1, 0]]: must be the corners of a convex polygon"},
    {kBodies + "[[contact]]\ntype = \"disc-polygon\"\nbodies = [\"rod\", \"ball\"]\nradius = 1\n"
               "corners = [[0, 0], [1, 0], [2, 0], [0, 1]]",
     "s.toml:19: contact \"contact1\": corners (4): must be the corners of a convex polygon"},
    {kBodies + "[[contact]]\ntype = \"disc-polygon\"\nbodies = [\"rod\", \"ball\"]\nradius = 1\ncorners = [0, 1, 2]",
     "s.toml:19: contact \"contact1\": corners = 0: must be two numbers [x, y]"},
    {kBodies + "[[contact]]\ntype = \"polygon-polygon\"\nname = \"p\"\nbodies = [\"rod\", \"ball\"]\n"
               "corners_a = [[0, 0], [1, 0], [0, 1]]\ncorners_b = []",
     "s.toml:20: contact \"p\": corners_b = []: must be the corners of a convex polygon"},
    {kBodies + "[[contact]]\ntype = \"polygon-polygon\"\nbodies = [\"rod\", \"ball\"]\n"
               "corners_a = [[0, 0], [1, 0], [0, 1]]\ncorners_b = [[0, 0], [0, 1], [1, 0]]",
     "s.toml:19: contact \"contact1\": corners_b = [[0, 0], [0, 1], [1, 0]]: must be the corners of a convex polygon"},
    {kBodies + "[[joint]]\ntype = \"distance\"\nbodies = [\"ground\", \"rod\"]\nlength = 1",
     "s.toml:17: joint \"joint1\": its points start in one place: must be apart"},
    {kBodies + "[[contact]]\ntype = \"journal\"\nbodies = [\"rod\", \"cart\"]\nradius_a = 1\nradius_b = 2",
     "s.toml:17: contact \"contact1\": its centres start 5 m apart: must be at most radius_b = 2"},
    {kBodies + "[[contact]]\ntype = \"guide\"\nbody = \"rod\"\nwidth = 4\nheight = 1\nclearance = 0\n"
               "walls = {axis = [0, 1]}",
     "contact \"contact1\": starts off its walls or crosswise: corner \"contact1_1\" is "},
    {kBodies + "[[contact]]\ntype = \"journal\"\nbodies = [\"rod\", \"ball\"]\nradius_a = 1\nradius_b = 1",
     "s.toml:19: contact \"contact1\": radius_b = 1: must be > radius_a = 1"},
    {kBodies + "[[contact]]\ntype = \"guide\"\nbody = \"rod\"\nwidth = 1\nheight = 0\nclearance = 0",
     "s.toml:19: contact \"contact1\": height = 0: must be > 0"},
    {kBodies +
         "[[contact]]\ntype = \"guide\"\nbody = \"rod\"\nwidth = 1\nheight = 1\nclearance = 0\nwalls = {tilt = 1}",
     "unknown key \"walls.tilt\": must be one of body, point, axis"},
    {kBodies + "[[contact]]\ntype = \"guide\"\nbody = \"rod\"\nwidth = 1\nheight = 1\nclearance = 0\nmu = -1",
     "s.toml:21: contact \"contact1_1\": mu = -1: must be >= 0"},
    {kCorner + "[[contact]]\ntype = \"limit\"\njoint = \"pin\"\nlower = 0",
     "s.toml:22: contact \"contact2\": joint = 'pin': must be the name of a joint written before"},
    {kBodies + "[[joint]]\ntype = \"fixed\"\nname = \"weld\"\nbodies = [\"rod\", \"ball\"]\n"
               "[[contact]]\ntype = \"limit\"\njoint = \"weld\"\nlower = 0",
     "contact \"contact1\": joint = 'weld': must be a revolute or prismatic joint"},
    {kBodies + "[[contact]]\ntype = \"limit\"\nlower = 0",
     "s.toml:15: contact \"contact1\": missing key \"joint\" or \"of\""},
    {kBodies + "[[contact]]\ntype = \"limit\"\nof = \"angel\"\nbodies = [\"rod\", \"ball\"]\nlower = 0",
     "s.toml:17: contact \"contact1\": of = 'angel': must be angle, slide or distance"},
    {kBodies + "[[contact]]\ntype = \"limit\"\nof = \"angle\"\nbodies = [\"rod\", \"ball\"]",
     "s.toml:15: contact \"contact1\": missing key \"lower\" or \"upper\""},
    {kBodies + "[[contact]]\ntype = \"limit\"\nof = \"angle\"\nbodies = [\"rod\", \"ball\"]\nlower = 1\nupper = 0",
     "s.toml:19: contact \"contact1\": lower = 1: must be less than upper (a drive holds a coordinate"},
    {kBodies + "[[contact]]\ntype = \"limit\"\nof = \"angle\"\nbodies = [\"rod\", \"ball\"]\nlower = 1\nupper = 1",
     "lower = 1: must be less than upper"},
    // A distance of 0 has no direction; nothing that can meet; a load of no joint.
    {kBodies +
         "[[joint]]\ntype = \"drive\"\nof = \"distance\"\nbodies = [\"ground\", \"rod\"]\npoint_a = [0, 0]\nrate = 1",
     "joint \"joint1\": its points start in one place: must be apart"},
    {kBodies + "[[spring]]\ntype = \"joint\"\nof = \"distance\"\nbodies = [\"ground\", \"rod\"]\nrest = 1",
     "spring \"spring1\": its points start in one place: must be apart"},
    {kBodies + "[[collision]]\nshapes = [{body = \"rod\", radius = 1}]",
     "s.toml:15: collision \"collision1\": shapes: must be of two bodies at least, or there must be walls"},
    {kBodies + "[[friction]]\nof = \"angle\"\nbodies = [\"rod\", \"ball\"]\nmu = 0.1",
     "s.toml:18: friction \"friction1\": no joint is named that mu could multiply the load of: must name a "
     "revolute or prismatic joint"},
    {kBodies + "[[contact]]\ntype = \"limit\"\nof = \"angle\"\nbodies = [\"rod\", \"ball\"]\nlower = 1\nmu = 1",
     "unknown key \"mu\": must be one of type, name, joint, of, bodies, e_n, lower, upper"},
    {kBodies + "[[contact]]\ntype = \"rope\"\nbodies = [\"rod\", \"cart\"]\nlength = 0",
     "s.toml:18: contact \"contact1\": length = 0: must be > 0"},
    // Drives and dry friction.
    {kBodies + "[[joint]]\ntype = \"drive\"\nof = \"slide\"\nbodies = [\"rod\", \"cart\"]\nrate = inf",
     "s.toml:19: joint \"joint1\": rate = inf: must be finite"},
    {kBodies + "[[joint]]\ntype = \"drive\"\nof = \"angle\"\nbodies = [\"rod\", \"cart\"]\n"
               "table = {times = [0, 0], values = [1, 2]}",
     "s.toml:19: joint \"joint1\": table.times = [0, 0]: must be ascending"},
    {kBodies + "[[joint]]\ntype = \"drive\"\nof = \"angle\"\nbodies = [\"rod\", \"cart\"]\n"
               "table = {times = [0, 1e-300], values = [1, 2]}",
     "s.toml:19: joint \"joint1\": table.times: must be so far apart that the values' slopes and curvatures are "
     "finite"},
    {kBodies + "[[joint]]\ntype = \"revolute\"\nname = \"pin\"\nbodies = [\"ground\", \"rod\"]\n"
               "[[joint]]\ntype = \"drive\"\njoint = \"pin\"\nof = \"angle\"\nrate = 1",
     "of = 'angle': must be left out where \"joint\" says what is meant"},
    {kBodies + "[[joint]]\ntype = \"drive\"\nof = \"distance\"\nbodies = [\"ground\", \"rod\"]\npoint_a = [1, 0]\n"
               "offset = -1",
     "joint \"joint1\": starts at a distance of -1 m: must be ≥ 0"},
    {kBodies + "[[joint]]\ntype = \"drive\"\njoint = \"joint1\"",
     "s.toml:17: joint \"joint1\": joint = 'joint1': must be the name of a joint written before"},
    {kBodies + "[[friction]]\nof = \"angle\"\nbodies = [\"rod\", \"cart\"]",
     "s.toml:15: friction \"friction1\": missing key \"bound\""},
    {kBodies + "[[friction]]\nof = \"angle\"\nbodies = [\"rod\", \"cart\"]\nbound = -1",
     "s.toml:18: friction \"friction1\": bound = -1: must be >= 0"},
    {kBodies + "[[friction]]\nof = \"angle\"\nbodies = [\"rod\", \"rod\"]\nbound = 1",
     "s.toml:17: friction \"friction1\": joins body \"rod\" to itself: must be two different bodies"},
    // Springs and loads.
    {kBodies + "[[spring]]\ntype = \"coil\"",
     "s.toml:16: spring \"spring1\": type = 'coil': must be point, torsion or joint"},
    {kBodies + "[[spring]]\ntype = \"point\"\nbodies = [\"rod\", \"ball\"]\nstiffness = -1",
     "s.toml:18: spring \"spring1\": stiffness = -1: must be >= 0"},
    {kBodies + "[[spring]]\ntype = \"torsion\"\nbodies = [\"rod\", \"ball\"]\npoint_a = [0, 0]",
     "s.toml:18: spring \"spring1\": unknown key \"point_a\": must be one of type, name, bodies, stiffness, damping, "
     "rest"},
    {kBodies + "[[load]]\nforce = [0, 1]", "s.toml:15: load \"load1\": missing key \"body\""},
    {kBodies + "[[load]]\nbody = \"ground\"",
     "s.toml:16: load \"load1\": body = \"ground\": must be a body that moves"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = 2", "s.toml:17: load \"load1\": factor = 2: must be a table"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"sine\"}",
     "s.toml:17: load \"load1\": factor.type = 'sine': must be cosine, table or spline"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"cosine\"}",
     "load \"load1\": missing key \"factor.omega\""},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [], values = []}",
     "factor.times = []: must be at least one time"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [0, 1], values = [1]}",
     "factor.times = [0, 1]: must be as many as values"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [0, 1, 1], values = [1, 2, 3]}",
     "factor.times = [0, 1, 1]: must be ascending"},
    {kBodies + "[[load]]\nbody = \"rod\"\nfactor = {type = \"table\", times = [0, \"x\"], values = [1, 2]}",
     "factor.times = 'x': must be a number"},
};

struct Override {
  Strings sets;
  std::string message;
};

const Override kBadOverrides[] = {
    {{"gravity"}, "override gravity: must have the form key=value"},
    {{"gravity[1]=-9"}, "override gravity[1]=-9: a key has no places: must give the whole array, gravity=[...]"},
    {{"gravty=[0, 0]"}, "override gravty=[0, 0]: unknown key \"gravty\": must be one of gravity, duration, step"},
    {{"gravity=down"}, "override gravity=down: "},
    {{"gravity=[0, \"x\"]"}, "override gravity=[0, \"x\"]: gravity = 'x': must be a number"},
    {{"gravity.x=1"}, "override gravity.x=1: unknown kind \"gravity\": must be one of body, joint, contact"},
    {{"contact.foot=1"}, "override contact.foot=1: must have the form contact.NAME.KEY=VALUE"},
    {{"contact.feet.mu=1"}, "override contact.feet.mu=1: no contact is named \"feet\": must be one of foot"},
    {{"joint.pin.angle=1"},
     "override joint.pin.angle=1: no joint is named \"pin\": must be one of (the scene has none)"},
    {{"contact.foot.muu=1"},
     "override contact.foot.muu=1: contact \"foot\": unknown key \"muu\": must be one of type, name, body, point"},
    {{"contact.foot.mu=0.1", "contact.foot.mu=0.2"}, "override contact.foot.mu=0.2: is given twice"},
    {{"contact.foot.mu=0.1", "contact.foot.mu =0.1"}, "override contact.foot.mu =0.1: is given twice"},
    {{"step=1e-3", "\"step\"=1e-4"}, "override \"step\"=1e-4: is given twice"},
    {{"contact.foot.wall.normal=[1, 0]", "contact.foot.wall={normal = [0, 1]}"},
     "override contact.foot.wall={normal = [0, 1]}: is given twice"},
    {{"contact.foot.wall={normal = [0, 1]}", "contact.foot.wall.normal=[1, 0]"},
     "override contact.foot.wall.normal=[1, 0]: is given twice"},
    {{"step=1e-3\nduration=1"}, "must be one line"},
    {{"contact.foot.mu=-1"}, "override contact.foot.mu=-1: contact \"foot\": mu = -1: must be >= 0"},
    {{"contact.foot.mu.x=1"}, "override contact.foot.mu.x=1: contact \"foot\": mu = "},
    {{"contact.foot.wall.tilt=1"}, "override contact.foot.wall.tilt=1: contact \"foot\": unknown key \"wall.tilt\""},
    {{"contact.foot.wall={point = [0, 0]}"}, "missing key \"wall.normal\""},
    {{"body.rod.mass="}, "override body.rod.mass=: "},
    {{"body.rod.mass=1 2"}, "override body.rod.mass=1 2: "},
    {{"body.rod.mass=nan"}, "override body.rod.mass=nan: body \"rod\": mass = nan: must be finite"},
    {{""}, "override : must have the form key=value"},
    {{"="}, "override =: "},
    {{"body..mass=1"}, "no body is named \"\": must be one of rod, cart, ball"},
};

}  // namespace

TEST_CASE("the error of every mistake in a file names file, line, element, key, value and rule") {
  REQUIRE(error_of(kCorner).empty());
  for (const FileMistake& mistake : kFileMistakes) {
    CAPTURE(mistake.text);
    const std::string error = error_of(mistake.text);
    INFO("said: " << error);
    CHECK(error.starts_with("s.toml"));
    CHECK(contains(error, mistake.message));
    CHECK_FALSE(contains(error, "\n"));
  }
}

TEST_CASE("the error of every bad override quotes its text") {
  for (const Override& bad : kBadOverrides) {
    const std::string error = error_of(kCorner, bad.sets);
    INFO("said: " << error);
    CHECK(contains(error, bad.message));
    CHECK_FALSE(contains(error, "\n"));
  }
}

TEST_CASE("hostile text is refused: deep, long, binary, cut off") {
  const auto repeated = [](const std::string& part, int n) {
    std::string text;
    for (int i = 0; i < n; ++i) text += part;
    return text;
  };
  const int many = 200000;
  CHECK(contains(error_of("x = " + repeated("[", many)), "nested deeper"));
  CHECK(contains(error_of("x = " + repeated("[\n", many)), "nested deeper"));
  CHECK(contains(error_of("x = " + repeated("{a = ", many)), "nested deeper"));
  CHECK(contains(error_of(repeated("a.", many) + "a = 1"), "nested deeper"));
  CHECK(contains(error_of(repeated("a . ", many) + "a = 1"), "nested deeper"));
  CHECK(contains(error_of("[" + repeated("\"a,=\".", many) + "a]"), "nested deeper"));
  CHECK(contains(error_of("[" + repeated("'#[\"'.", many) + "a]"), "nested deeper"));
  CHECK(contains(error_of("s = \"\"\"a\"\"\"\"\"\n[" + repeated("a.", many) + "a]"), "s.toml:2: nested deeper"));
  CHECK(contains(error_of("x = {s = \"\"\"a\"\"\"\", " + repeated("a.", many) + "a = 1}"), "nested deeper"));
  CHECK(contains(error_of("s = '''\n\\'''\n" + repeated("a.", many) + "a = 1"), "s.toml:3: nested deeper"));
  CHECK(contains(error_of(kCorner, {"contact.foot.mu=" + repeated("[", many)}), "nested deeper"));
  CHECK(contains(error_of(kCorner, {"body.rod." + repeated("a.", many) + "a=1"}), "nested deeper"));
  CHECK(error_of(kCorner + "# " + repeated("[a.b.c.", many)).empty());  // a comment may say anything
  CHECK(contains(error_of(kCorner + "x = \"" + repeated("[.", many) + "\""), "unknown key"));  // and so may a string
  CHECK(contains(error_of(std::string((16 << 20) + 1, ' ')), "must be at most 16 MiB"));
  CHECK(contains(error_of(std::string("\0\xff\xfe[[", 5)), "s.toml:1: "));
  for (const std::string& long_one :
       {error_of(repeated("a", many) + " = 1"), error_of(kCorner, {"nobody." + repeated("a", many) + ".mass=1"}),
        error_of(kCorner, {repeated("a", many)}),
        error_of("[[body]]\nname = '" + repeated("a", many) + "'\nmass = -1\ninertia = 1")}) {
    CAPTURE(long_one);
    CHECK(contains(long_one, "aaa ... "));
    CHECK(contains(long_one, "must "));
    CHECK(long_one.size() < 1100);
  }
  CHECK(contains(error_of("[[body]]\nname = \"a\\u0000b\"\nmass = -1\ninertia = 1"), "body \"a\\0b\""));
  CHECK(error_of(repeated("[[body]]\n", 1000)).starts_with("s.toml:1: body"));

  const std::string whole = contents(kCore / "scenes" / "slider_crank.toml");
  int scenes = 0;
  for (std::size_t n = 0; n <= whole.size(); ++n) scenes += error_of(whole.substr(0, n)).empty();
  CHECK(scenes > 0);
  CHECK(scenes < static_cast<int>(whole.size()) / 2);
}

}  // namespace orthant
