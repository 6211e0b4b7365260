// orthant simulate of scenes in space: columns, joint coordinates, checkpoints, what is refused.
#include "tests/support/cli.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank_exact.h>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

using orthant::Cli, orthant::Reply, orthant::lines, orthant::slurp;

TEST_CASE("orthant simulate slider_crank_space: the planar motion, its columns and joint coordinates") {
  const Cli folder;
  const Reply a = folder.orthant(
      "simulate slider_crank_space --set turn_x=0.4 --set turn_z=1 --step 1e-5 --output run.csv --every 100 --json");
  INFO(a.err);
  REQUIRE(a.exit_code == 0);
  const auto json = nlohmann::json::parse(a.out);
  const auto& last = json.at("final");
  const auto exact = orthant::slider_crank_exact(0.01, 0.4);
  CHECK(std::abs(last.at("shaft.angle").get<double>() - exact->theta1) < 2e-3);
  CHECK(exact->theta1 > 6.3);  // more than a turn
  CHECK(json.at("energy_initial").get<double>() == doctest::Approx(7.49554875).epsilon(1e-12));
  const std::string csv = slurp(folder / "run.csv");
  CHECK(
      csv.starts_with("t,crank.x,crank.y,crank.z,crank.qw,crank.qx,crank.qy,crank.qz,crank.vx,crank.vy,crank.vz,"
                      "crank.wx,crank.wy,crank.wz,rod.x"));
  CHECK(lines(csv) == 1 + 201);
  double square = 0;
  for (const char* part : {"qw", "qx", "qy", "qz"})
    square += std::pow(last.at(std::string("rod.") + part).get<double>(), 2);
  CHECK(std::abs(square - 1) < 1e-15);
}

TEST_CASE("a run in space goes on from its checkpoint with the bits of an unbroken one") {
  const Cli folder;
  REQUIRE(folder.orthant("simulate bricard --duration 0.4 --output whole.csv").exit_code == 0);
  const std::string run = "simulate bricard --duration 0.4 --checkpoint c --checkpoint-every 100 ";
  folder.orthant(run + "--output part.csv --time-limit 0.01");
  const Reply resumed = folder.orthant(run + "--output part.csv --resume");
  INFO(resumed.err);
  CHECK(resumed.exit_code == 0);
  const std::string whole = slurp(folder / "whole.csv"), part = slurp(folder / "part.csv");
  CHECK(lines(whole) == lines(part));
}

TEST_CASE("a scene in space from a file, and what planar scenes alone have") {
  const Cli folder;
  folder.write("spin.toml",
               "dimension = 3\nduration = 1\n[[body]]\nname = 'b'\nmass = 1\ninertia = [1, 2, 3]\nomega = [0, 0, 2]\n"
               "[[joint]]\ntype = 'revolute'\nname = 'hub'\nbodies = ['ground', 'b']\naxis = [0, 0, 1]\n");
  const Reply run = folder.orthant("simulate spin.toml --json --step 0.01 --set 'body.b.omega=[0, 0, 20]'");
  REQUIRE(run.exit_code == 0);
  const auto last = nlohmann::json::parse(run.out).at("final");
  CHECK(std::abs(last.at("hub.angle").get<double>() - 20) < 1e-12);
  CHECK(std::abs(last.at("b.wz").get<double>() - 20) < 1e-12);
  const auto refusal = [&](const std::string& arguments) {
    const Reply reply = folder.orthant("simulate " + arguments);
    CHECK(reply.exit_code == 1);
    return reply.err;
  };
  const Reply exact = folder.orthant("simulate spin.toml --json --step 0.5 --integrator event-driven");
  REQUIRE(exact.exit_code == 0);
  CHECK(std::abs(nlohmann::json::parse(exact.out).at("final").at("hub.angle").get<double>() - 2) < 1e-12);
  CHECK(refusal("spin.toml --set body.b.mass=0").find("body \"b\": mass = 0: must be > 0") != std::string::npos);
  for (const std::string output : {"run.h5", "run.pvd", "run.csv"})
    CHECK(folder.orthant("simulate spin.toml --output " + output).exit_code == 0);
}

TEST_CASE("every built-in scene in space runs, and none is warned of an energy that nothing put in") {
  const Cli folder;
  for (const orthant::SpatialSceneEntry& scene : orthant::spatial_scenes()) {
    CAPTURE(scene.name);
    const Reply a = folder.orthant("simulate " + std::string(scene.name) + " --duration 0.05");
    CHECK(a.exit_code == 0);
    CHECK(a.err.find("energy") == std::string::npos);
  }
}

TEST_CASE("collisions and solids in a file: what they say, what is refused") {
  const Cli folder;
  const std::string pile =
      "dimension = 3\nduration = 0.5\nstep = 1e-3\ngravity = [0, 0, -9.81]\n"
      "[[body]]\nname = 'box'\nsolid = {box = [0.2, 0.2, 0.1]}\ndensity = 700\nposition = [0, 0, 0.05]\n"
      "[[body]]\nname = 'ball'\nsolid = {sphere = 0.1}\nmass = 2\nposition = [0, 0, 0.2]\n"
      "[[body]]\nname = 'log'\nsolid = {capsule = [0.05, 0.3]}\nmass = 1\nposition = [1, 0, 0.05]\n"
      "[[collision]]\nname = 'all'\nmu = 0.4\nwalls = [{normal = [0, 0, 1]}]\nshapes = [\n"
      "  {body = 'box', size = [0.2, 0.2, 0.1]},\n  {body = 'ball', radius = 0.1},\n"
      "  {body = 'log', radius = 0.05, ends = [[-0.15, 0, 0], [0.15, 0, 0]]},\n]\n";
  folder.write("pile.toml", pile);
  const Reply run = folder.orthant("simulate pile.toml --json --output run.csv");
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const auto last = nlohmann::json::parse(run.out).at("final");
  CHECK(std::abs(last.at("ball.z").get<double>() - 0.2) < 1e-9);
  CHECK(std::abs(last.at("box.z").get<double>() - 0.05) < 1e-9);
  CHECK(std::abs(last.at("all.impulse_n").get<double>() - 2 * 9.81e-3) < 1e-6);
  CHECK(slurp(folder / "run.csv").find(",all.gap,all.impulse_n,all.impulse_t,") != std::string::npos);
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string wrong = pile;
    wrong.replace(wrong.find(from), from.size(), to);
    folder.write("wrong.toml", wrong);
    const Reply reply = folder.orthant("simulate wrong.toml");
    CHECK(reply.exit_code == 1);
    CHECK(lines(reply.err) == 1);
    return reply.err;
  };
  CHECK(refusal("density = 700", "").find("body \"box\": solid: needs either \"mass\" or \"density\"") !=
        std::string::npos);
  CHECK(refusal("sphere = 0.1}", "sphere = -1}").find("solid.sphere = -1: must be of lengths > 0") !=
        std::string::npos);
  CHECK(refusal("ends = [[-0.15, 0, 0], [0.15, 0, 0]]", "ends = [[0, 0, 0]]").find("two points") != std::string::npos);
  CHECK(refusal("size = [0.2, 0.2, 0.1]},\n", "size = [0.2, 0.2]},\n").find("size") != std::string::npos);
  CHECK(refusal("radius = 0.1}", "corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]}")
            .find("must not lie in one plane") != std::string::npos);
  CHECK(refusal("mu = 0.4", "mu = -1").find("mu = -1: must be >= 0") != std::string::npos);
  CHECK(refusal("mu = 0.4", "mu = 0.4\nneighbours = 0").find("neighbours = 0: must be > 0") != std::string::npos);
}
