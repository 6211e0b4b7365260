// Models in URDF and MJCF by the command: simulate, import, what is listed and refused; the arm that sweeps a box.
#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

using orthant::Cli, orthant::Reply, orthant::slurp;

namespace {

const std::string kArm = ORTHANT_ROOT "/core/scenes/robot_arm.urdf";

}  // namespace

TEST_CASE("orthant import: the scene that it writes runs with the bits of the model, and says what it has not") {
  const Cli folder;
  const std::string start = " --set model.at.lift=0.8 --set model.at.elbow=1";
  const Reply import = folder.orthant("import " + kArm + start + " --output arm.toml");
  CHECK(import.exit_code == 0);
  CHECK(import.out == "scene: arm.toml\n");
  CHECK(import.err.find("note: not taken: effort of <limit> (2 times, line 32)") != std::string::npos);
  CHECK(slurp(folder.path / "arm.toml").find("# not taken: effort of <limit>") != std::string::npos);
  CHECK(slurp(folder.path / "arm.toml") == folder.orthant("import " + kArm + start).out);
  const Reply model = folder.orthant("simulate " + kArm + start + " --duration 0.3 --output model.csv --json");
  CHECK(model.exit_code == 0);
  CHECK(model.err.find("note: " + kArm + ": not taken: velocity of <limit>") != std::string::npos);
  CHECK(folder.orthant("simulate arm.toml --duration 0.3 --output scene.csv").exit_code == 0);
  CHECK(slurp(folder.path / "model.csv") == slurp(folder.path / "scene.csv"));
  const auto json = nlohmann::json::parse(folder.orthant("import " + kArm + " --json").out);
  CHECK(json.at("notes").size() == 3);
  CHECK(json.at("toml").get<std::string>().find("name = \"forearm\"\n# with hand\n") != std::string::npos);
  CHECK(folder.orthant("view " + kArm + start + " --duration 0.1 --output arm.html").exit_code == 0);
}

TEST_CASE("orthant import refuses scenes, options that there are not, and its own input as output") {
  const Cli folder;
  folder.write("a.toml", "gravity = [0, 0]\n");
  CHECK(folder.orthant("import a.toml").err.find("a.toml: must be a model in URDF or MJCF") != std::string::npos);
  CHECK(folder.orthant("import " + kArm + " --set base=free").err.find("must have the form model.KEY=VALUE") !=
        std::string::npos);
  CHECK(folder.orthant("import " + kArm + " --set model.weight=1").err.find("unknown option model.weight") !=
        std::string::npos);
  folder.write("arm.urdf", slurp(kArm));
  CHECK(folder.orthant("import arm.urdf --output arm.urdf").exit_code == 1);
  CHECK(slurp(folder.path / "arm.urdf") == slurp(kArm));
  CHECK(folder.orthant("import none.urdf").err.find("none.urdf: must be a file that exists") != std::string::npos);
}

TEST_CASE("robot_arm: the hand takes the box along, and leaves it when it turns back") {
  const Cli folder;
  const auto end_of = [&](const std::string& more) {
    const Reply run = folder.orthant("simulate robot_arm --json " + more);
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    return nlohmann::json::parse(run.out).at("final");
  };
  const auto there = end_of("--duration 1.5"), back = end_of("--duration 3");
  const double x = there.at("box.x"), y = there.at("box.y");
  CHECK(std::atan2(y, x) > 1.2);  // pushed ahead of the hand, from 0.45
  CHECK(std::atan2(y, x) < 1.6);
  CHECK(std::abs(there.at("box.z").get<double>() - 0.075) < 1e-4);
  CHECK(there.at("turn.angle").get<double>() == doctest::Approx(1.2).epsilon(1e-9));
  CHECK(std::abs(back.at("turn.angle").get<double>()) < 1e-9);
  CHECK(std::hypot(back.at("box.x").get<double>() - x, back.at("box.y").get<double>() - y) < 0.05);
}
