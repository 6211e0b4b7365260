// orthant gradient: derivatives of a run by names, against a difference of orthant simulate.
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/cli.h"
#include "tests/support/scene_texts.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace orthant;

namespace {

double number_behind(const std::string& text, const std::string& words) {
  const auto at = text.find(words + " = ");
  REQUIRE(at != std::string::npos);
  return std::strtod(text.c_str() + at + words.size() + 3, nullptr);
}

}  // namespace

TEST_CASE("orthant gradient: by an option of a built-in scene, by keys and array entries of a file, by the start") {
  const Cli folder;
  const std::string clock = " --step 1e-4 --duration 0.05 ";
  const Reply a =
      folder.orthant("gradient slider_crank" + clock + "--of crank.theta,crank.omega --wrt mu,start.crank.omega");
  REQUIRE(a.exit_code == 0);
  double end[2];
  for (int k = 0; k < 2; ++k) {
    const Reply run =
        folder.orthant("simulate slider_crank" + clock + "--json --set mu=" + (k == 0 ? "0.0099999" : "0.0100001"));
    end[k] = nlohmann::json::parse(run.out).at("final").at("crank.theta").get<double>();
  }
  const double difference = (end[1] - end[0]) / 2e-7;
  CHECK(std::abs(number_behind(a.out, "d crank.theta / d mu") - difference) <= 1e-6 * std::abs(difference));
  CHECK(a.out.find("d crank.omega / d start.crank.omega = ") != std::string::npos);

  folder.write("ball.toml", R"(gravity = [0, -10]
duration = 0.5
step = 0.01
[[body]]
name = "ball"
mass = 2
inertia = 1
position = [0, 9]
velocity = [1, 3]
)");
  const Reply b = folder.orthant(
      "gradient ball.toml --of ball.y --wrt 'body.ball.velocity[1],gravity[1]' --set 'body.ball.velocity=[1, 4]'");
  REQUIRE(b.exit_code == 0);
  CHECK(std::abs(number_behind(b.out, "ball.y") - (9 + 2 - 1.25)) < 1e-9);
  CHECK(std::abs(number_behind(b.out, "d ball.y / d body.ball.velocity[1]") - 0.5) < 1e-9);
  CHECK(std::abs(number_behind(b.out, "d ball.y / d gravity[1]") - 0.125) < 1e-9);
}

TEST_CASE("orthant gradient: of a scene in space, by an option, by keys and array entries of a file, by the start") {
  const Cli folder;
  const Reply a =
      folder.orthant("gradient masse --duration 0.5 --of ball.x,table.impulse_n --wrt mu,start.ball.wx,mass");
  REQUIRE(a.exit_code == 0);
  const double u[] = {1 + 100 * 0.028575, -60 * 0.028575}, slip = std::hypot(u[0], u[1]);
  CHECK(std::abs(number_behind(a.out, "d ball.x / d mu") + 9.81 / 8 * u[0] / slip) < 1e-6);
  CHECK(std::abs(number_behind(a.out, "d table.impulse_n / d mass") - 9.81e-3) < 1e-9);

  folder.write("door.toml", R"(dimension = 3
gravity = [0, 0, -10]
duration = 0.5
step = 0.01
[[body]]
name = "door"
mass = 2
inertia = [0.2, 0.25, 0.1]
position = [0, 0, 1]
omega = [0, 0, 2]
[[joint]]
type = "revolute"
name = "hinge"
bodies = ["ground", "door"]
point_b = [0, 0, -1]
axis = [0, 0, 1]
[[friction]]
name = "brake"
joint = "hinge"
bound = 0.3
)");
  // ω = 2 − 0.3 t / 0.1, turned by 1 − 0.375
  const Reply b = folder.orthant(
      "gradient door.toml --of door.wz,door.qz --wrt 'friction.brake.bound,body.door.inertia[2],start.door.wz'");
  REQUIRE(b.exit_code == 0);
  CHECK(std::abs(number_behind(b.out, "door.wz") - 0.5) < 1e-9);
  CHECK(std::abs(number_behind(b.out, "d door.wz / d friction.brake.bound") + 5) < 1e-9);
  CHECK(std::abs(number_behind(b.out, "d door.wz / d body.door.inertia[2]") - 15) < 1e-7);
  CHECK(std::abs(number_behind(b.out, "d door.wz / d start.door.wz") - 1) < 1e-9);
  const double turned = std::cos(0.625 / 2) / 2;  // of qz by the angle
  CHECK(std::abs(number_behind(b.out, "d door.qz / d friction.brake.bound") + turned * 1.25) < 1e-8);
}

TEST_CASE("orthant gradient: of a run of rattle") {
  const Cli folder;
  const std::string clock = " --integrator rattle --step 1e-4 --duration 0.03 ";
  const Reply a = folder.orthant("gradient slider_crank" + clock + "--of crank.theta --wrt mu");
  REQUIRE(a.exit_code == 0);
  double end[2];
  for (int k = 0; k < 2; ++k) {
    const Reply run =
        folder.orthant("simulate slider_crank" + clock + "--json --set mu=" + (k == 0 ? "0.0099999" : "0.0100001"));
    end[k] = nlohmann::json::parse(run.out).at("final").at("crank.theta").get<double>();
  }
  const double difference = (end[1] - end[0]) / 2e-7;
  CHECK(std::abs(number_behind(a.out, "d crank.theta / d mu") - difference) <= 1e-5 * std::abs(difference));
}

TEST_CASE("orthant gradient refuses in one line; steps with weakly active contacts are reported") {
  const Cli folder;
  for (const std::string arguments :
       {"gradient slider_crank --of crank.gap --wrt mu", "gradient slider_crank --of crank.theta --wrt nu",
        "gradient slider_crank --of crank.theta --wrt mu --integrator adaptive",
        "gradient masse --of ball.x --wrt mu --integrator rattle", "gradient masse --of ball.theta --wrt mu",
        "gradient masse --of ball.x --wrt start.ball.theta", "gradient spheres --of sphere1.x --wrt mu"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
  folder.write("rest.toml", R"(duration = 0.1
step = 0.01
gravity = [0, 0]
[[body]]
name = "ball"
mass = 2
inertia = 1
position = [0, 1]
[[contact]]
name = "floor"
type = "disc-wall"
body = "ball"
radius = 1
wall = {normal = [0, 1]}
)");
  const Reply a = folder.orthant("gradient rest.toml --of ball.y --wrt body.ball.mass");
  CHECK(a.exit_code == 0);
  CHECK(a.err.find("10 steps have weakly active contacts, the first at t = 0 s (floor)") != std::string::npos);
}

TEST_CASE(
    "orthant gradient: elements without a name, defaults, ends of a range; what it refuses, in the file's words") {
  const Cli folder;
  const std::string ball = R"(gravity = [0, -9.81]
duration = 1
step = 1e-3
[[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.5]
velocity = [1, 0]
[[contact]]
type = "disc-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 1]}
mu = 0.3
e_n = 1
[[load]]
body = "b"
force = [1, 0]
)";
  folder.write("ball.toml", ball);
  const Reply a = folder.orthant(
      "gradient ball.toml --of b.x --wrt "
      "'contact.contact1.e_t,load.load1.force[0],load.load1.force[1],contact.contact1.e_n,body.b.omega,"
      "load.load1.torque,contact.contact1.wall.point[0]'");
  REQUIRE(a.exit_code == 0);
  CHECK(a.err.find("contact.contact1.e_n = 1 is at the end of its range: the derivative is one-sided") !=
        std::string::npos);
  CHECK(lines(a.err) == 1);
  double end[2];
  for (int k = 0; k < 2; ++k)
    end[k] =
        nlohmann::json::parse(
            folder.orthant("simulate ball.toml --json --set contact.contact1.e_t=" + std::string(k ? "1e-6" : "-1e-6"))
                .out)
            .at("final")
            .at("b.x")
            .get<double>();
  CHECK(std::abs(number_behind(a.out, "d b.x / d contact.contact1.e_t") - (end[1] - end[0]) / 2e-6) < 1e-6);
  CHECK(std::abs(number_behind(a.out, "d b.x / d contact.contact1.wall.point[0]")) < 1e-9);
  CHECK(folder.orthant("gradient ball.toml --of b.x --wrt contact.contact1.nothing").exit_code == 1);

  const Reply full = folder.orthant(
      "gradient ball.toml --of b.x --wrt contact.contact1.mu --integrator "
      "moreau-jean:form=full");
  CHECK(full.exit_code == 1);
  CHECK(full.err.find("form = full: must be reduced") != std::string::npos);
  folder.write("rubs.toml", ball +
                                "[[joint]]\ntype = \"prismatic\"\nname = \"rail\"\nbodies = [\"ground\", \"b\"]\n"
                                "[[friction]]\nname = \"rub\"\njoint = \"rail\"\nbound = 0.1\n");
  const Reply rubs = folder.orthant("gradient rubs.toml --of b.x --wrt body.b.mass --integrator event-driven");
  CHECK(rubs.exit_code == 1);
  CHECK(rubs.err.find("the [[friction]] 'rub' has no derivatives") != std::string::npos);
}

TEST_CASE("orthant gradient: entries of arrays of arrays, by differences; wrong keys are named") {
  const Cli folder;
  folder.write("box.toml", R"(gravity = [0, -10]
duration = 0.3
step = 1e-3
[[body]]
name = "b"
mass = 2
inertia = 0.3
position = [0, 0.3]
velocity = [1, -1]
angle = 0.1
[[contact]]
name = "f"
type = "polygon-wall"
body = "b"
corners = [[-0.5, -0.25], [0.5, -0.25], [0.5, 0.25], [-0.5, 0.25]]
wall = {normal = [0, 1]}
mu = 0.3
)");
  const Reply a =
      folder.orthant("gradient box.toml --of b.theta --wrt 'contact.f.corners[0][1],contact.f.corners[1][0]'");
  REQUIRE(a.exit_code == 0);
  const auto theta = [&](double left_y, double right_x) {
    char set[200];
    std::snprintf(set, sizeof set, "'contact.f.corners=[[-0.5, %.12g], [%.12g, -0.25], [0.5, 0.25], [-0.5, 0.25]]'",
                  left_y, right_x);
    const Reply run = folder.orthant("simulate box.toml --json --set " + std::string(set));
    return nlohmann::json::parse(run.out).at("final").at("b.theta").get<double>();
  };
  const double step = 1e-7;
  const double of_left = (theta(-0.25 + step, 0.5) - theta(-0.25 - step, 0.5)) / (2 * step);
  const double of_right = (theta(-0.25, 0.5 + step) - theta(-0.25, 0.5 - step)) / (2 * step);
  CHECK(std::abs(of_left) > 0.01);
  CHECK(std::abs(number_behind(a.out, "d b.theta / d contact.f.corners[0][1]") - of_left) < 1e-5 * std::abs(of_left));
  CHECK(std::abs(number_behind(a.out, "d b.theta / d contact.f.corners[1][0]") - of_right) < 1e-5);

  const auto refused = [&](const std::string& key, const std::string& words) {
    const Reply reply = folder.orthant("gradient box.toml --of b.x --wrt '" + key + "'");
    CHECK(reply.exit_code == 1);
    INFO(reply.err);
    CHECK(reply.err.find(words) != std::string::npos);
  };
  refused("contact.f.corners[4][0]", "there is no such entry in [[-0.5, -0.25], ");
  refused("contact.f.corners[0]", "must be a number, or one of its entries by their places from 0");
  refused("body.b.position[2]", "there is no such entry in [0, 0.3]: places count from 0");
  refused("body.b.position[x]", "a place must be a whole number from 0 on, such as [0]");
  refused("body.b.nothing", "the [[body]] 'b' has no number 'nothing'");
  refused("body.c.mass", "the scene has no [[body]] with the name 'c'");
  refused("bodies.b.mass", "the scene has no [[bodies]]");
  refused("gravty", "no number is found at this key");
  refused("contact.f.mu[0]", "no array: must be written without a place");
  refused("start.c.x", "no body has the name 'c': must be start.BODY.COLUMN");
  refused("contact.f.mu,contact.f.mu", "parameter 'contact.f.mu': is given twice: must be given once");

  const auto no_column = [&](const std::string& column, const std::string& words) {
    const Reply reply = folder.orthant("gradient box.toml --of " + column + " --wrt body.b.mass");
    CHECK(reply.exit_code == 1);
    INFO(reply.err);
    CHECK(reply.err.find(words) != std::string::npos);
  };
  no_column("c.x", "no body, contact or friction has the name 'c'. must be BODY.COLUMN");
  no_column("b.z", "column 'b.z': must be BODY.COLUMN");
  no_column("t", "has no derivative: records stand at fixed times. must be");
  no_column("penetration", "has no derivative: it measures errors of the step. must be");
}

TEST_CASE("orthant gradient: derivatives that exceed the range of numbers, and grazes, are errors with a reason") {
  const Cli folder;
  const std::string tower = "gradient tower --of body1.x --wrt start.body1.vx --duration 1 --step 1e-3";
  const Reply a = folder.orthant(tower), b = folder.orthant(tower + " --json");
  for (const Reply& reply : {a, b}) {
    CHECK(reply.exit_code != 0);
    CHECK((reply.err + reply.out).find("exceed the range of numbers") != std::string::npos);
    CHECK(reply.out.find("null") == std::string::npos);
  }
  folder.write("graze.toml", R"([[body]]
name = "b"
mass = 1
inertia = 0.1
position = [0, 0.6]
velocity = [1, -1]
[[load]]
body = "b"
force = [0, 1]
[[contact]]
name = "f"
type = "disc-wall"
body = "b"
radius = 0.1
wall = {normal = [0, 1]}
)");
  const Reply c = folder.orthant(
      "gradient graze.toml --of b.y --wrt start.b.vy --integrator event-driven --step 1 "
      "--duration 2");
  CHECK(c.exit_code != 0);
  CHECK(c.err.find("graze") != std::string::npos);
}

TEST_CASE("orthant lyapunov: the exponents of the impact oscillator, and what it refuses") {
  const Cli folder;
  const Reply a = folder.orthant(
      "lyapunov impact_oscillator --count 6 --duration 78.53981633974483 --transient 40.25165587 --every "
      "0.9817477042468103 "
      "--json");
  REQUIRE(a.exit_code == 0);
  const auto found = nlohmann::json::parse(a.out);
  double sum = 0;
  for (const auto& one : found.at("exponents")) sum += one.get<double>();
  CHECK(std::abs(sum - 2 * std::log(0.8) / 3.9269908169872414) < 1e-6);  // 20 impacts in 20 periods
  const Reply b = folder.orthant("lyapunov bouncing_ball --set e=0 --duration 1 --count 6 --json");
  REQUIRE(b.exit_code == 0);
  CHECK(nlohmann::json::parse(b.out).at("exponents").back().is_null());
  CHECK(folder.orthant("lyapunov bouncing_ball --count 7").err.find("count: must be 1 ... 6") != std::string::npos);
  CHECK(folder.orthant("lyapunov bouncing_ball --integrator rattle").exit_code == 1);
}

TEST_CASE("orthant gradient: an entry of an inertia tensor beside the diagonal changes with its mirror image") {
  const Cli folder;
  folder.write("top.toml", R"(dimension = 3
[[body]]
name = "top"
mass = 1
inertia = [[0.02, 0.001, 0], [0.001, 0.03, 0], [0, 0, 0.04]]
omega = [1, 2, 5]
)");
  const std::string how = " --step 1e-3 --duration 0.3 ";
  const Reply a = folder.orthant("gradient top.toml --of top.wx --wrt 'body.top.inertia[0][1]'" + how);
  REQUIRE(a.exit_code == 0);
  const auto spin = [&](double entry) {
    char set[200];
    std::snprintf(set, sizeof set, "'body.top.inertia=[[0.02, %.12g, 0], [%.12g, 0.03, 0], [0, 0, 0.04]]'", entry,
                  entry);
    const Reply run = folder.orthant("simulate top.toml --integrator moreau-jean --json" + how + "--set " + set);
    return nlohmann::json::parse(run.out).at("final").at("top.wx").get<double>();
  };
  const double difference = (spin(0.001 + 1e-6) - spin(0.001 - 1e-6)) / 2e-6;
  CHECK(std::abs(difference) > 1);
  CHECK(std::abs(number_behind(a.out, "d top.wx / d body.top.inertia[0][1]") - difference) <
        1e-5 * std::abs(difference));
}

TEST_CASE("orthant gradient: the mass of a body, of built-in scenes too") {
  const Cli folder;
  const std::string how = " --of crank.theta --step 1e-4 --duration 0.02 --wrt ";
  const Reply built_in = folder.orthant("gradient slider_crank" + how + "rod.mass");
  const Reply file = folder.orthant("gradient " + (scene_texts::kCore / "scenes/slider_crank.toml").string() + how +
                                    "rod.mass,body.rod.mass");
  REQUIRE(built_in.exit_code == 0);
  REQUIRE(file.exit_code == 0);
  const double of_key = number_behind(file.out, "d crank.theta / d body.rod.mass");
  CHECK(std::abs(of_key) > 0.1);
  CHECK(std::abs(number_behind(file.out, "d crank.theta / d rod.mass") - of_key) < 1e-9 * std::abs(of_key));
  CHECK(std::abs(number_behind(built_in.out, "d crank.theta / d rod.mass") - of_key) < 1e-6 * std::abs(of_key));
}
