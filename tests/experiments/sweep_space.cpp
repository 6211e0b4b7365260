// Sweeps and reports of scenes in space: measures, drifts, default solver, animations in three dimensions.
#include "experiments/report/report.h"
#include "experiments/sweep/case.h"
#include "tests/support/cli.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

using namespace orthant;

namespace {

Case case_of(const std::string& scene, const std::string& measure, double step, double duration) {
  Case c;
  c.scene = scene, c.integrator = "moreau-jean", c.solver = "lemke", c.step = step, c.duration = duration;
  c.measure = measure;
  return c;
}

}  // namespace

TEST_CASE("a case in space measures columns and joint coordinates, and agrees with the same motion in the plane") {
  Case space = case_of("slider_crank_space", "shaft.angle", 1e-4, 0.1);
  space.solver = "auto";
  const ResultRow turned = run_case(space), flat = run_case(case_of("slider_crank", "crank.theta", 1e-4, 0.1));
  CAPTURE(turned.dump());
  REQUIRE(turned.at("status") == "solved");
  CHECK(flat.at("value").get<double>() > 3.2);  // more than half a turn
  for (const char* field : {"value", "energy_final", "impulse", "friction_impulse", "first_touch", "touching"})
    CHECK(turned.at(field).get<double>() == doctest::Approx(flat.at(field).get<double>()).scale(0).epsilon(1e-7));
  CHECK(turned.at("momentum_drift").is_null());  // the ground holds it
  space.measure = "shaft.turn";
  CHECK(run_case(space).at("why").get<std::string>().find("has no such column") != std::string::npos);
}

TEST_CASE(
    "a free body in space: no drift of momentum, energy and spin but rounding; a falling one has no such figures") {
  const Cli folder;
  const std::string body =
      "duration = 1\nstep = 1e-3\n[[body]]\nname = 'b'\nmass = 2\ninertia = [1, 2, 2.5]\n"
      "position = [1, 2, 3]\nvelocity = [3, -2, 1]\nomega = [1, 4, 0.5]\n";
  folder.write("free.toml", "dimension = 3\n" + body);
  folder.write("falls.toml", "dimension = 3\ngravity = [0, 0, -9.81]\n" + body);
  const ResultRow free = run_case(case_of(folder / "free.toml", "b.x", 1e-3, 1));
  CHECK(free.at("value").get<double>() == doctest::Approx(4).epsilon(1e-12));
  CHECK(free.at("momentum_drift").get<double>() < 1e-12);
  CHECK(free.at("spin_drift").get<double>() < 1e-11);  // of about 20 kg m²/s about the origin
  CHECK(free.at("energy_drift").get<double>() < 1e-12);
  const ResultRow falls = run_case(case_of(folder / "falls.toml", "b.z", 1e-3, 1));
  CHECK(falls.at("status") == "solved");
  CHECK(falls.at("momentum_drift").is_null());
  CHECK(falls.at("spin_drift").is_null());
}

TEST_CASE(
    "a sweep file in space: auto is the default solver, mistakes are said; its report has an animation in space") {
  const Cli folder;
  const std::string sweep =
      "question = 'How far?'\nscene = 'masse'\nduration = 0.2\nmeasure = 'ball.x'\nreference = 0.19\n[[grid]]\n"
      "integrator = ['moreau-jean', 'stewart-trinkle']\nset = {mu = [0.1, 0.2]}\nstep = [1e-3, 5e-4]\n";
  const std::string animation =
      "[[figure]]\ntitle = 'Error'\nx = 'step'\ny = 'error'\nby = 'integrator'\nlog = 'xy'\n"
      "[[animation]]\ntitle = 'Motion'\nruns = [{integrator = 'moreau-jean', step = 5e-4}, "
      "{integrator = 'stewart-trinkle', step = 5e-4}]\n";
  folder.write("m.sweep.toml", sweep + animation);
  const Reply ran = folder.orthant("sweep m.sweep.toml --results m.sqlite");
  CAPTURE(ran.err);
  REQUIRE(ran.exit_code == 0);
  CHECK(ran.out.find("8 cases") != std::string::npos);
  CHECK(ran.out.find(" 0 not solved") != std::string::npos);
  CHECK(folder.orthant("results m.sqlite --csv").out.find(",moreau-jean,auto,") != std::string::npos);
  const auto data = report_data(Results(folder / "m.sqlite", Results::read_only));
  const auto& shown = data.at("sweeps")[0].at("animations")[0];
  CHECK(shown.at("scene").at("dimension") == 3);
  const auto& frames = shown.at("films")[0].at("frames");
  REQUIRE(frames.size() > 100);
  for (const auto& frame : frames) REQUIRE(frame.size() == 1 + 7 + 4);
  const auto last = frames.back().get<std::vector<double>>();
  CHECK(last[0] == doctest::Approx(0.2));
  CHECK(last[3] == doctest::Approx(0.028575).epsilon(1e-5));  // z: it stays on the table
  CHECK(std::hypot(std::hypot(last[4], last[5]), std::hypot(last[6], last[7])) == doctest::Approx(1).epsilon(1e-6));
  CHECK(std::hypot(last[10], last[11]) == doctest::Approx(0.2 * last[9]).epsilon(1e-3));  // it slides

  REQUIRE(folder.orthant("report m.sqlite --output m.html").exit_code == 0);
  const std::string html = slurp(folder / "m.html");
  CHECK(html.find("three.js authors") != std::string::npos);
  CHECK(html.find(" src=") == std::string::npos);
  folder.write(
      "plane.sweep.toml",
      "scene = 'bouncing_ball'\nduration = 0.1\nmeasure = 'ball.y'\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-2\n"
      "[[animation]]\ntitle = 'Motion'\nruns = [{integrator = 'rattle', step = 1e-2}]\n");
  REQUIRE(folder.orthant("sweep plane.sweep.toml --results p.sqlite").exit_code == 0);
  REQUIRE(folder.orthant("report p.sqlite --output p.html").exit_code == 0);
  CHECK(slurp(folder / "p.html").find("three.js authors") == std::string::npos);  // planar pages stay light

  const auto refusal = [&](const std::string& text) {
    folder.write("bad.sweep.toml", text);
    const Reply reply = folder.orthant("sweep bad.sweep.toml --results bad.sqlite");
    CHECK(reply.exit_code == 1);
    return reply.err;
  };
  const auto with = [&](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(refusal(with(sweep, "'ball.x'", "'ball.theta'")).find("the scene has no such column") != std::string::npos);
  CHECK(refusal(with(sweep, "mu = [0.1, 0.2]", "nu = 1")).find("nu") != std::string::npos);
  CHECK(refusal(sweep + with(animation, "title = 'Motion'", "title = 'Motion'\nmagnify = 'ball'"))
            .find("must be absent where the scene is in space") != std::string::npos);

  if (folder.run("/usr/bin/python3 -s -E -c 'import selenium' && test -x /usr/bin/chromedriver").exit_code != 0) return;
  const Reply seen = folder.run("/usr/bin/python3 -s -E '" ORTHANT_TEST_DATA "/../experiments/report.py' m.html");
  CAPTURE(seen.out);
  CAPTURE(seen.err);
  CHECK(seen.exit_code == 0);
}

TEST_CASE("the second study's sweep: every integrator is compared with adaptive, and errors fall with the step") {
  Case c = case_of("slider_crank_clearance", "slider.x", 1e-3, 0.1);
  c.solver = "auto", c.reference = "adaptive:rtol=1e-11", c.parameters = {{"mu", 0.1}, {"e", 0.4}};
  for (const char* integrator : {"moreau-jean:joints=symmetric", "stewart-trinkle", "rattle"}) {
    CAPTURE(integrator);
    c.integrator = integrator;
    double errors[2];
    for (const bool fine : {false, true}) {
      c.step = fine ? 1e-4 : 1e-3;
      const ResultRow row = run_case(c);
      CAPTURE(row.dump());
      REQUIRE(row.at("status") == "solved");
      errors[fine] = row.at("error").get<double>();
    }
    CHECK(errors[1] < errors[0] / 3);
    CHECK(errors[1] > 0);
  }
}
