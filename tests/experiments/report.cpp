// The report: one page that needs nothing else, says what the results say, and works in a browser.
#include "experiments/report/report.h"
#include "experiments/sweep/analysis.h"

#include <doctest/doctest.h>

#include "tests/support/cli.h"

using namespace orthant;

namespace {

constexpr const char* kSweep = R"(
question = "What is <b>asked</b>?</script><!--<script>"
scene = "slider_crank"
measure = "crank.theta"
reference = "exact"
[[grid]]
integrator = ["moreau-jean", "moreau-jean:joints=position"]
set = {mu = [0.1, 0.01]}
step = {from = 4e-4, to = 5e-5, count = 10, scale = "log"}
[[grid]]
integrator = ["moreau-jean", "event-driven"]
step = [2e-3, 1e-4]
repeats = 1
[[grid]]
integrator = "moreau-jean"
solver = "pgs:max_sweeps=1"
[[animation]]
title = "Motion"
set = {mu = 0.1}
magnify = "slider"
runs = [{integrator = "moreau-jean", step = 1e-4}, {integrator = "event-driven"}]
[[figure]]
title = "Orders"
x = "step"
y = "error"
by = "integrator"
timed = false
octaves = true
log = "xy"
[[figure]]
title = "Friction"
x = "mu"
y = "energy_lost"
by = "integrator"
[[figure]]
title = "Cost"
x = "seconds"
y = "error"
by = "integrator"
timed = true
worst = true
log = "xy"
)";

ResultRow row(double step, double error, double seconds, int repeats) {
  return {{"integrator", "a"},  {"solver", "b"},       {"parameters", "{}"}, {"step", step},
          {"rtol", nullptr},    {"repeats", repeats},  {"error", error},     {"seconds", seconds},
          {"status", "solved"}, {"energy_initial", 2}, {"energy_final", 1}};
}

}  // namespace

TEST_CASE("orders and times to an error: lucky runs do not count, failures do") {
  std::vector<ResultRow> rows;
  for (int i = 0; i < 60; ++i)
    rows.push_back(row(std::exp2(-i / 10.0), std::exp2(-i / 5.0) * (i % 2 ? 1e-3 : 1), 1, 0));
  const auto fits = fitted_orders(rows);
  REQUIRE(fits.size() == 1);
  CHECK(fits[0].at("order").get<double>() == doctest::Approx(2).epsilon(0.02));
  CHECK(fits[0].at("failed") == 0);

  for (std::size_t i = 0; i < rows.size(); ++i) {  // down to rounding, where nothing falls: the order is that above it
    const auto k = static_cast<double>(i);
    rows[i]["error"] = std::max(1e-3 * std::exp2(-k), 1e-14 * (1 + std::fmod(k, 3))), rows[i]["reference"] = 10;
  }
  CHECK(fitted_orders(rows)[0].at("order").get<double>() == doctest::Approx(10).epsilon(0.05));

  rows.resize(20);  // two octaves: a line goes through any two points
  CHECK(fitted_orders(rows).empty());
  rows = {row(1, 1, 1, 0), row(0.1, 0.5, 1, 0), row(0.09, 0.2, 1, 0), row(0.08, 0.4, 1, 0)};  // two as well
  CHECK(fitted_orders(rows).empty());

  rows = {row(8, 1e-9, 1, 3), row(4, 2e-2, 2, 3), row(2, 2e-3, 4, 3), row(1, 5e-4, 7, 3)};  // the first one is lucky
  auto times = time_to_error(rows);
  REQUIRE(times.size() == 1);
  CHECK(times[0].at("seconds")[0] == 4.0);  // 1e-2
  CHECK(times[0].at("seconds")[1] == 7.0);  // 1e-3
  CHECK(times[0].at("seconds")[2].is_null());
  rows[3]["status"] = "ray";
  CHECK(time_to_error(rows)[0].at("seconds")[0].is_null());
  CHECK(answer(rows) == "3 of 4 runs ended solved (not, by integrator: a 1). Between 1 and 1 J of energy went.");
}

TEST_CASE("the answer tells for which parameters no method converges, and where the motion changes most") {
  std::vector<ResultRow> rows;
  for (const double e : {0.0, 0.4})
    for (int i = 0; i < 40; ++i) {
      rows.push_back(row(std::exp2(-i / 10.0), e == 0 ? std::exp2(-i / 10.0) : 1, 1, 0));
      rows.back()["parameters"] = e == 0 ? R"({"e":0.0,"c":1})" : R"({"e":0.4,"c":1})";
    }
  CHECK(answer(rows).find("By no method does the error fall as fast as h^0.5 for 1 of 2 settings: e = 0.4.") !=
        std::string::npos);

  rows.clear();  // many settings are counted by value
  for (int setting = 0; setting < 8; ++setting)
    for (int i = 0; i < 40; ++i) {
      rows.push_back(row(std::exp2(-i / 10.0), setting < 5 ? 1 : std::exp2(-i / 10.0), 1, 0));
      rows.back()["parameters"] =
          "{\"e\":" + std::to_string(setting / 4) + ",\"c\":" + std::to_string(setting % 4) + "}";
    }
  CHECK(answer(rows).find(
            "for 5 of 8 settings: 2 of the 2 with c = 0, 1 of the 2 with c = 1, 1 of the 2 with c = 2, 1 of the "
            "2 with c = 3; 4 of the 4 with e = 0, 1 of the 4 with e = 1.") != std::string::npos);

  rows.clear();
  for (int i = 0; i < 8; ++i) {
    rows.push_back(row(1e-3, 1, 1, 0));
    rows.back().update(
        {{"parameters", "{\"mu\":" + std::to_string(i) + "}"}, {"measure", "angle"}, {"value", i < 3 ? 7 - i : 1}});
  }
  CHECK(answer(rows).find("from mu = 2 to 3 the median of angle at the end goes from 5 to 1.") != std::string::npos);
}

TEST_CASE("the answer names the statistics that still converge where the measure does not, and the best energy") {
  std::vector<ResultRow> rows{row(1e-6, 1e-15, 1, 0)};
  const auto tell = [](ResultRow& one, const char* name, double touch, double lost) {
    one.update({{"integrator", name}, {"compared_with", "exact:rtol=1e-9"}, {"first_touch", touch}});
    one["energy_final"] = one["energy_initial"].get<double>() - lost;
  };
  tell(rows[0], "exact", 1, 0.5);
  for (int i = 0; i < 40; ++i) {
    const double h = std::exp2(-i / 10.0);
    rows.push_back(row(h, 1, 1, 0));
    tell(rows.back(), "a", 1 + 0.1 * h, 0.6);
  }
  CHECK(answer(rows).find("; what still falls so by some method, of 1 such settings looked at: first touch at 1, "
                          "energy lost at none.") != std::string::npos);

  rows = {row(1, 0, 1, 0), row(0.5, 0, 1, 0), row(1, 0, 1, 0)};
  const double drifts[] = {1.0, 0.25, 1e-9};
  for (std::size_t i = 0; i < 3; ++i)
    rows[i].update({{"integrator", i < 2 ? "loses" : "keeps"},
                    {"energy_drift", drifts[i]},
                    {"momentum_drift", 0},
                    {"spin_drift", 0},
                    {"max_joint_residual", 0}});
  CHECK(answer(rows).find("keeps strays from it by 1e-9 J at the most, loses by up to 0.25 J") != std::string::npos);
  rows.pop_back();
  CHECK(answer(rows).find("strays") == std::string::npos);  // where nobody keeps it nobody is said to lose it
}

TEST_CASE("orthant report: a scene's file is found from any folder, and shown as long as the sweep runs it") {
  const Cli folder;
  std::filesystem::create_directory(folder / "below");
  std::filesystem::copy_file(ORTHANT_ROOT "/core/scenes/slider_crank.toml", folder / "below/mine.toml");
  folder.write("below/s.sweep.toml",
               "scene = 'mine.toml'\nduration = 0.01\n[[grid]]\nintegrator = 'rattle'\n"
               "set = {'body.slider.mass' = [0.05, 0.1]}\nstep = 1e-3\n"
               "[[animation]]\ntitle = 'Heavier'\nset = {'body.slider.mass' = 0.1}\nruns = [{integrator = 'rattle', "
               "step = 1e-3}]\n");
  REQUIRE(folder.orthant("sweep below/s.sweep.toml --results r.sqlite").exit_code == 0);
  const Reply a = folder.run("(cd / && '" ORTHANT_CLI "' report '" + (folder / "r.sqlite") + "' --output '" +
                             (folder / "r.html") + "')");
  CAPTURE(a.err);
  CHECK(a.exit_code == 0);
  const auto data = report_data(Results(folder / "r.sqlite", Results::read_only));
  CHECK(data.at("sweeps")[0].at("animations")[0].at("films")[0].at("frames").back()[0] == doctest::Approx(0.01));
}

TEST_CASE("orthant report: opens no file that a results file names") {
  const Cli folder;
  std::filesystem::copy_file(ORTHANT_ROOT "/core/scenes/slider_crank.toml", folder / "mine.toml");
  folder.write("s.sweep.toml",
               "scene = 'mine.toml'\nduration = 0.01\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-3\n"
               "[[animation]]\ntitle = 'Motion'\nruns = [{integrator = 'rattle', step = 1e-3}]\n");
  REQUIRE(folder.orthant("sweep s.sweep.toml --results r.sqlite").exit_code == 0);
  CHECK(slurp(folder / "r.sqlite").find(folder.path.string() + "/mine.toml") == std::string::npos);
  std::filesystem::remove(folder / "mine.toml");  // the text is in the results
  CHECK(folder.orthant("report r.sqlite --output own.html").exit_code == 0);

  const auto changed = [&](const std::string& about) {
    return folder
        .run(
            "/usr/bin/python3 -s -E -c 'import json, sqlite3, sys\n"
            "db = sqlite3.connect(\"r.sqlite\")\n"
            "about = json.loads(db.execute(\"select about from sweeps\").fetchone()[0])\n" +
            about + "\ndb.execute(\"update sweeps set about = ?\", [json.dumps(about)])\ndb.commit()'")
        .exit_code;
  };
  folder.write("private.toml", slurp(ORTHANT_ROOT "/core/scenes/slider_crank.toml"));  // a scene, and not asked for
  folder.write("secret", "the combination is 4711\n");
  for (const std::string other : {"secret", "private.toml", "no/such/file"}) {
    const std::string named = folder / other.c_str();
    REQUIRE(changed("about.pop(\"scene_text\", 0)\nabout[\"scene\"] = \"" + named + "\"") == 0);
    const Reply a = folder.orthant("report r.sqlite --output stranger.html");
    CHECK(a.exit_code == 1);
    CHECK(a.err.find("names the scene '" + named + "' without its text") != std::string::npos);
    CHECK((a.out + a.err).find("4711") == std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "stranger.html"));
  }
  for (const std::string text : {"\"[[body]\"", "7", "[]"}) {
    REQUIRE(changed("about[\"scene_text\"] = " + text) == 0);
    const Reply a = folder.orthant("report r.sqlite --output stranger.html");
    CHECK(a.exit_code == 1);
    CHECK_FALSE(std::filesystem::exists(folder / "stranger.html"));
  }
}

TEST_CASE("orthant report: an animation without end in a stranger's results is refused") {
  const Cli folder;
  folder.write("s.sweep.toml",
               "scene = 'slider_crank'\nduration = 0.01\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-3\n"
               "[[animation]]\ntitle = 'Motion'\nruns = [{integrator = 'rattle', step = 1e-3}]\n");
  REQUIRE(folder.orthant("sweep s.sweep.toml --results r.sqlite").exit_code == 0);
  const auto spoil = [&](const std::string& what, const std::string& value) {
    REQUIRE(folder
                .run("/usr/bin/python3 -s -E -c 'import sqlite3\ndb = sqlite3.connect(\"r.sqlite\")\n"
                     "db.execute(\"update sweeps set about = json_set(about, ?, json(?))\", [\"$.page.animation[0]" +
                     what + "\", \"" + value + "\"])\ndb.commit()'")
                .exit_code == 0);
    const Reply a = folder.orthant("report r.sqlite --output r.html");
    CAPTURE(a.err);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
    return a.err;
  };
  CHECK(spoil(".runs[0].step", "1e-14").find("at most a million steps") != std::string::npos);
  CHECK(spoil(".duration", "-1").find("animation.duration") != std::string::npos);
  CHECK(spoil(".runs", "7").find("animation") != std::string::npos);
}

TEST_CASE("orthant report: one file without a link to anything outside; a browser shows, plays and zooms it" *
          doctest::test_suite("slow")) {
  const Cli folder;
  folder.write("r.sweep.toml", kSweep);
  REQUIRE(folder.orthant("sweep r.sweep.toml --results r.sqlite").exit_code == 0);
  const Reply a = folder.orthant("report r.sqlite --output r.html");
  CAPTURE(a.err);
  REQUIRE(a.exit_code == 0);
  const std::string html = slurp(folder / "r.html");
  CHECK(html.find(" src=") == std::string::npos);
  CHECK(html.find("@import") == std::string::npos);
  CHECK(html.find("url(") == std::string::npos);
  CHECK(html.find("What is <b>asked</b>?</script>") == std::string::npos);
  CHECK(html.find("<!--") == std::string::npos);
  CHECK(html.find("44 of 45 runs ended solved") != std::string::npos);
  CHECK(folder.orthant("report missing.sqlite").exit_code == 1);
  CHECK(folder.orthant("report r.sqlite --output no/such/r.html").exit_code == 1);

  if (folder.run("/usr/bin/python3 -s -E -c 'import selenium' && test -x /usr/bin/chromedriver").exit_code != 0) {
    MESSAGE("no chromium with selenium: the page is not tested in a browser");
    return;
  }
  const Reply seen = folder.run("/usr/bin/python3 -s -E '" ORTHANT_TEST_DATA "/../experiments/report.py' r.html");
  CAPTURE(seen.out);
  CAPTURE(seen.err);
  CHECK(seen.exit_code == 0);
}
