// The report: one page that needs nothing else, says what the results say, and works in a browser.
#include "experiments/sweep/analysis.h"

#include <doctest/doctest.h>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

constexpr const char* kSweep = R"(
question = "What is <b>asked</b>?</script>"
scene = "slider_crank"
measure = "crank.theta"
reference = "exact"
[[grid]]
integrator = ["moreau-jean", "moreau-jean:joints=position"]
set = {mu = [0.01, 0.1]}
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

struct Report : Folder {
  Reply orthant(const std::string& arguments) const { return run("'" ORTHANT_CLI "' " + arguments); }
};

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

  rows = {row(8, 1e-9, 1, 3), row(4, 2e-2, 2, 3), row(2, 2e-3, 4, 3), row(1, 5e-4, 7, 3)};  // the first one is lucky
  auto times = time_to_error(rows);
  REQUIRE(times.size() == 1);
  CHECK(times[0].at("seconds")[0] == 4.0);  // 1e-2
  CHECK(times[0].at("seconds")[1] == 7.0);  // 1e-3
  CHECK(times[0].at("seconds")[2].is_null());
  rows[3]["status"] = "ray";
  CHECK(time_to_error(rows)[0].at("seconds")[0].is_null());
  CHECK(answer(rows).starts_with("3 of 4 runs ended solved (not, by solver: b 1)"));
}

TEST_CASE("orthant report: one file without a link to anything outside; a browser shows, plays and zooms it" *
          doctest::test_suite("slow")) {
  const Report folder;
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
