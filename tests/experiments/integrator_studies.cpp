// The integrators' studies: the cost of an error, and what a tilted start does.
#include <orthant/integrators/registry.h>

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

/// Cells by separator, spaces and backquotes removed.
std::vector<std::string> cells(std::string line, char separator) {
  std::erase_if(line, [](char c) { return c == ' ' || c == '`'; });
  std::vector<std::string> all;
  std::string cell;
  for (std::istringstream in(line); std::getline(in, cell, separator);) all.push_back(cell);
  return all;
}

}  // namespace

TEST_CASE("work_precision: a row an integrator; adaptive and event-driven reach what no fixed step does; a picture") {
  const Folder folder;
  const Reply a = folder.run("'" ORTHANT_EXPERIMENTS "/work_precision' --quick --repeats 1 --output out");
  CAPTURE(a.err);
  REQUIRE(a.exit_code == 0);
  std::map<std::string, std::vector<std::string>> rows;  // 1e-2, 1e-3, 1e-6, 1e-9
  std::istringstream table(slurp(folder.path / "out/time_to_error.csv"));
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    auto row = cells(line + ",", ',');
    row.resize(5);
    rows[row[0]] = {row.begin() + 1, row.end()};
  }
  CHECK(rows.size() == integrators().size());
  CHECK(!rows["moreau-jean"][0].empty());
  CHECK(rows["moreau-jean"][2].empty());
  CHECK(!rows["adaptive"][2].empty());
  CHECK(!rows["event-driven"][3].empty());
  CHECK(std::stod(rows["adaptive"][1]) < 10 * std::stod(rows["moreau-jean"][0]));  // [s]: 1e-3 beside 1e-2

  if (folder.run("/usr/bin/python3 -s -E -c 'import matplotlib'").exit_code != 0) {
    MESSAGE("no matplotlib: pictures not tested");
    return;
  }
  const Reply drawn = folder.run("/usr/bin/python3 -s -E '" ORTHANT_PLOTS "/plot_work_precision.py' out");
  CAPTURE(drawn.err);
  CHECK(drawn.exit_code == 0);
  CHECK(std::filesystem::file_size(folder.path / "out/work_precision.png") > 10000);
}

TEST_CASE("tilted_start: the face's restitution falls with h as known, and is 0 for event-driven") {
  const Folder folder;
  const Reply a =
      folder.run("'" ORTHANT_EXPERIMENTS "/tilted_start' --finest 1e-9 --integrators moreau-jean event-driven");
  CAPTURE(a.err);
  REQUIRE(a.exit_code == 0);
  std::istringstream text(a.out);
  std::string line;
  for (int skipped = 0; skipped < 3; ++skipped) std::getline(text, line);
  // h: from an independent program that steps from t = 0; where impacts fall within a step shifts it by some 0.02.
  for (const double known : {0.397, 0.350, 0.313, 0.280}) {
    REQUIRE(std::getline(text, line));
    const auto row = cells(line, '|');
    CAPTURE(line);
    CHECK(std::abs(std::stod(row[2]) - known) < 0.025);
    CHECK(std::abs(std::stod(row[3])) < 0.01);
  }
}
