// orthant gradient: derivatives of a run by names, against a difference of orthant simulate.
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/cli.h"

#include <cmath>
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

TEST_CASE("orthant gradient refuses in one line; steps with weakly active contacts are reported") {
  const Cli folder;
  for (const std::string arguments :
       {"gradient slider_crank --of crank.gap --wrt mu", "gradient slider_crank --of crank.theta --wrt nu",
        "gradient slider_crank --of crank.theta --wrt mu --integrator rattle", "gradient masse --of ball.x --wrt mu"}) {
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
