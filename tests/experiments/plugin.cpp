// Plugins: a solver, an integrator and a scene of a shared library are known to the command, sweeps and the shoot-out.
#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

using orthant::Cli, orthant::Reply, orthant::slurp;

TEST_CASE("plugins: their solvers, integrators and scenes have names everywhere") {
  const Cli folder;
  const std::string include = std::filesystem::path(ORTHANT_CLI).parent_path().string() + "/include";
  const Reply built = folder.run("c++ -std=c++20 -O0 -shared -fPIC -I'" + include +
                                 "' -isystem /usr/include/eigen3 -isystem /usr/include/suitesparse '" ORTHANT_ROOT
                                 "/experiments/examples/plugin.cpp' -o mine.so");
  REQUIRE_MESSAGE(built.exit_code == 0, built.err);

  CHECK(folder.orthant("list solvers --plugin ./mine.so").out.find("  mine\n") != std::string::npos);
  CHECK(folder.orthant("list solvers").out.find("  mine\n") == std::string::npos);
  folder.write("p.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 2, "rows": [[2, 1], [1, 2]]}, "b": [-5, -6]})");
  const Reply solved = folder.orthant("--plugin ./mine.so solve p.json --solver mine:omega=1.2 --json");
  CHECK(solved.exit_code == 0);
  const auto answer = nlohmann::json::parse(solved.out);
  CHECK(answer.at("status") == "solved");
  CHECK(answer.at("z")[0].get<double>() == doctest::Approx(4.0 / 3));
  CHECK(folder.orthant("solve p.json --solver mine").exit_code == 1);
  const Reply range = folder.orthant("solve p.json --plugin ./mine.so --solver mine:omega=7");
  CHECK(range.exit_code == 1);
  CHECK(range.err.find("omega") != std::string::npos);

  const Reply run = folder.orthant("simulate falling-disc --plugin ./mine.so --solver mine --step 1e-3 --json");
  CHECK(run.exit_code == 0);
  CHECK(nlohmann::json::parse(run.out).at("lcp_solves").get<int>() > 10);
  folder.write("free.toml", "gravity = [0, -10]\nduration = 1\n[[body]]\nname = \"a\"\nmass = 2\ninertia = 1\n");
  const Reply free = folder.orthant("simulate free.toml --plugin ./mine.so --integrator free-euler --step 0.1 --json");
  CHECK_MESSAGE(free.exit_code == 0, free.err);  // y = −g h² (1 + 2 + … + 10)
  CHECK(nlohmann::json::parse(free.out).at("final").at("a.y").get<double>() == doctest::Approx(-5.5).epsilon(1e-12));
  CHECK(folder.orthant("list integrators --plugin ./mine.so").out.find("  free-euler\n") != std::string::npos);
  CHECK(folder.orthant("simulate falling-disc --plugin ./mine.so --integrator free-euler")
            .err.find("without contacts and joints") != std::string::npos);
  folder.write("mine.sweep.toml",
               "question = \"?\"\nscene = \"falling-disc\"\nduration = 0.5\nmeasure = \"disc.y\"\n[[grid]]\nintegrator "
               "= [\"moreau-jean\"]\nsolver = \"mine\"\nstep = [1e-2, 1e-3]\n");
  const Reply sweep = folder.orthant("sweep mine.sweep.toml --plugin ./mine.so --results r.sqlite");
  CHECK_MESSAGE(sweep.out.find("2 cases in r.sqlite, 2 of them new, 0 not solved") != std::string::npos, sweep.out);

  if (std::filesystem::exists(ORTHANT_SHOOTOUT)) {
    const std::string command = ORTHANT_SHOOTOUT;
    const Reply race = folder.run("'" + command + "' --plugin ./mine.so --solvers mine lemke --families spd --quick" +
                                  " --memory 0 --output out");
    CHECK_MESSAGE(race.exit_code == 0, race.err);
  }
  const Reply none = folder.orthant("list --plugin ./nothing.so");
  CHECK(none.exit_code == 1);
  CHECK(none.err.find("must be a shared library that exists") != std::string::npos);
  folder.write("mine.py", "import orthant");
  CHECK(folder.orthant("list --plugin ./mine.py")
            .err.find("is a Python file: must be given to the command of the Python") != std::string::npos);
  folder.write("text.so", "no library");
  CHECK(folder.orthant("list --plugin ./text.so").err.find("cannot be loaded") != std::string::npos);
  const Reply twice = folder.orthant("list --plugin ./mine.so --plugin ./mine.so");
  CHECK(twice.err.find("solver 'mine': is registered already") != std::string::npos);
}
