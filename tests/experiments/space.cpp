// orthant simulate of scenes in space: columns, joint coordinates, checkpoints, what is refused.
#include "tests/support/cli.h"

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
  CHECK(refusal("spin.toml --integrator rattle").find("takes planar scenes only") != std::string::npos);
  CHECK(refusal("spin.toml --check").find("takes planar scenes only") != std::string::npos);
  CHECK(refusal("spin.toml --set body.b.mass=0").find("body \"b\": mass = 0: must be > 0") != std::string::npos);
  for (const std::string output : {"run.h5", "run.pvd", "run.csv"})
    CHECK(folder.orthant("simulate spin.toml --output " + output).exit_code == 0);
}
