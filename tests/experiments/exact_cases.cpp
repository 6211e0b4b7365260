// Hard cases with exact answers: rows of the table, none left out.
#include <orthant/integrators/registry.h>

#include <doctest/doctest.h>

#include "tests/support/folder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <sstream>
#include <string>

using namespace orthant;

namespace {

struct ExactCases : Folder {
  Reply visit(const std::string& options) const {
    return run("'" ORTHANT_EXPERIMENTS "/exact_cases' --quick --output out " + options);
  }
};

long count(const std::string& text, const std::string& word) {
  long n = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE(
    "exact cases: a row for every integrator, its error beside its time; what does not pass says why; a page of "
    "pictures") {
  const ExactCases study;
  const Reply a = study.visit("--cases B1 B9 B6 B14 --solvers lemke path");
  CAPTURE(a.err);
  CAPTURE(a.out);
  REQUIRE(a.exit_code == 0);
  for (const IntegratorEntry& entry :
       integrators())  // one of B1, two of B6, four of B9, three of B14: at least a line each
    CHECK(count(a.out, "| `" + std::string(entry.name) + "` |") >= 10);
  CHECK(a.out.find("cradle of 3, e = 1, at once | `moreau-jean` | lemke path |") != std::string::npos);
  CHECK(count(a.out, "another answer") == 0);
  const std::string runs = slurp(study.path / "out/runs.csv");
  CHECK(count(runs, "no acceleration-level solution (none") == 2);  // event-driven, two solvers
  // Two solvers where there are contacts; 12 steps of six schemes and 3 tolerances of two, or 3 steps, or one.
  CHECK(lines(runs) == 1 + 2 * (6 * 12 + 2 * 3) + 2 * 8 * (4 + 2) + 3 * 8 * 3);
  CHECK(std::filesystem::exists(study.path / "out/manifest.json"));

  if (study.run("/usr/bin/python3 -s -E -c 'import matplotlib'").exit_code != 0) {
    MESSAGE("no matplotlib: pictures not tested");
    return;
  }
  const Reply drawn = study.run("/usr/bin/python3 -s -E '" ORTHANT_PLOTS "/plot_exact_cases.py' out");
  CAPTURE(drawn.err);
  CHECK(drawn.exit_code == 0);
  CHECK(std::filesystem::file_size(study.path / "out/exact_cases.png") > 10000);
}

TEST_CASE("exact cases: equivalent mechanisms move alike, by every integrator") {
  const ExactCases study;
  const Reply a = study.visit("--cases C4 C5 --solvers lemke");
  CAPTURE(a.out);
  CHECK(a.exit_code == 0);
  CHECK(count(a.out, " pass |\n") == 8 * 8);
}

TEST_CASE("exact cases: bad options are one line of words") {
  const ExactCases study;
  for (const char* bad : {"--cases B99", "--solvers nobody", "--integrators nobody", "--levels 0"}) {
    CAPTURE(bad);
    const Reply b = study.visit(bad);
    CHECK(b.exit_code != 0);
    CHECK(!b.err.empty());
  }
}

TEST_CASE("exact cases in space: massé shot, a block across a slope, the plane's slider-crank, a symmetric body") {
  const ExactCases study;
  const Reply a = study.visit("--dimension 3 --cases S1 S11 S12 S14 --solvers auto pgs --time-limit 60");
  CAPTURE(a.err);
  CHECK(a.exit_code == 0);
  CHECK(a.out.find("| S11 massé shot: slides on a parabola with oblique spin, then rolls | `adaptive` | auto pgs |") !=
        std::string::npos);
  const std::string passed = a.out.substr(a.out.find("Passed:"));
  CHECK(passed.find("| `moreau-jean` | 1 of 1 | 3 of 3 | 3 of 3 |") != std::string::npos);
  CHECK(passed.find("| `adaptive` | 1 of 1 | 3 of 3 | 3 of 3 |") != std::string::npos);
}

TEST_CASE(
    "exact cases in space: pyramids bend the path of a block, and each has its own by all schemes that take them") {
  const ExactCases study;
  const Reply a = study.visit("--dimension 3 --cases S12 --solvers auto --time-limit 60");
  CAPTURE(a.out);
  REQUIRE(a.exit_code == 0);
  for (const char* facets : {"4", "8", "16"})
    CHECK(count(a.out, "| S12 the same with a pyramid of " + std::string(facets) + " facets") >= 5);
  const std::string passed = a.out.substr(a.out.find("Passed:"));
  CHECK(passed.find("| `moreau-jean` | 1 of 1 | 9 of 9 |") != std::string::npos);
  CHECK(passed.find("| `event-driven` | 1 of 1 | 0 of 0 |") != std::string::npos);
  // Distance from the disc's stop: of the run and of the exact path.
  double found[4] = {}, exact[4] = {};
  const std::string paths = slurp(study.path / "out/pyramids.md");
  const char* rows[] = {"| disc | `auto` | ", "| 4 facets | `lemke:facets=4` | ", "| 8 facets | `lemke:facets=8` | ",
                        "| 16 facets | `lemke:facets=16` | "};
  for (int i = 0; i < 4; ++i) {
    const auto at = paths.find(rows[i]);
    REQUIRE(at != std::string::npos);
    REQUIRE(std::sscanf(paths.c_str() + at + std::strlen(rows[i]), "%lf | %lf", &found[i], &exact[i]) == 2);
  }
  CHECK(found[0] < 3e-4);
  CHECK(exact[0] == 0);
  for (int i = 1; i < 4; ++i) CHECK(std::abs(found[i] - exact[i]) < 0.1 * exact[i] + 3e-4);
  CHECK(exact[1] > 2 * exact[2]);
  CHECK(exact[2] > 2 * exact[3]);
}

TEST_CASE("exact cases in space: event-driven meets every truth that has the digits to 1e-10") {
  const ExactCases study;
  // The published digits of S3 … S7 and S14 are fewer.
  const std::map<std::string, double> most{{"S1", 1e-10},  {"S8", 1e-10},  {"S9", 1e-10},  {"S10", 1e-10},
                                           {"S11", 1e-10}, {"S12", 1e-10}, {"S13", 1e-10}, {"S15", 1e-10},
                                           {"S16", 1e-10}, {"S17", 1e-10}, {"S18", 1e-10}, {"S19", 1e-10},
                                           {"S20", 1e-10}, {"S21", 1e-10}, {"S22", 1e-10}, {"S23", 1e-10}};
  std::string cases;
  for (const auto& [id, error] : most) cases += ' ' + id;
  const Reply a =
      study.visit("--dimension 3 --integrators event-driven --solvers auto --time-limit 60 --cases" + cases);
  CAPTURE(a.out);
  REQUIRE(a.exit_code == 0);
  std::istringstream runs(slurp(study.path / "out/runs.csv"));
  std::map<std::string, int> seen;
  for (std::string line; std::getline(runs, line);) {
    const std::string id = line.substr(0, line.find(','));
    const auto finest =
        std::min(line.find(",\"auto\",1e-13,"), line.find(",\"auto\",1e-09,"));  // without contacts 1e-9
    if (finest == std::string::npos) continue;
    const std::string rest = line.substr(finest + std::strlen(",\"auto\",1e-13,"));
    CAPTURE(line);
    ++seen[id];
    if (line.find("Painleve's rod in space, no") != std::string::npos ||
        line.find("Painleve's rod in space, two") != std::string::npos)
      continue;  // these say why there is no motion
    CHECK(rest.starts_with("solved,"));
    CHECK(std::stod(rest.substr(7)) <= most.at(id));
  }
  CHECK(seen.size() == most.size());
}
