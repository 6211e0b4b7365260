// Hard cases with exact answers: rows of the table, none left out.
#include <orthant/integrators/registry.h>

#include <doctest/doctest.h>

#include "tests/support/folder.h"

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
  for (const char* bad : {"--cases B99", "--solvers nobody", "--levels 0"}) {
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
