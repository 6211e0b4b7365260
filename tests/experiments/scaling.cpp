// Data files of growth: a line for each case, equal states on any number of threads, failures as lines.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/folder.h"
#include "tests/support/sanitized.h"

using namespace orthant;

namespace {

using Line = std::map<std::string, std::string>;

/// Each line by the names of its columns; a cell has no comma.
std::vector<Line> table(const std::filesystem::path& file) {
  std::istringstream in(slurp(file));
  const auto cells = [](const std::string& line) {
    std::vector<std::string> all{""};
    for (const char c : line)
      if (c == ',')
        all.emplace_back();
      else if (c != '"')
        all.back() += c;
    return all;
  };
  std::string line;
  std::getline(in, line);
  const auto columns = cells(line);
  std::vector<Line> lines;
  while (std::getline(in, line)) {
    const auto values = cells(line);
    REQUIRE_MESSAGE(values.size() == columns.size(), line);
    Line row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = values[i];
    lines.push_back(row);
  }
  return lines;
}

Reply pile_scaling(const Folder& folder, const std::string& options) {
  const Reply a = folder.run("'" ORTHANT_EXPERIMENTS
                             "/pile_scaling' --data piles.csv --apart 1 --spread 0.01 --step "
                             "0.002 --fall 0.15 --counted 2 " +
                             options);
  INFO(a.err);
  CHECK(a.exit_code == 0);
  return a;
}

}  // namespace

TEST_CASE("pile_scaling --data: every kind, solver and tolerance from one settled state") {
  if (kSanitized) return;  // it is not built
  const Folder folder;
  pile_scaling(folder,
               "--kinds discs spheres boxes capsules --sizes 20 --by nncg --by-tolerance 1e-4 --solvers nncg "
               "nncg:max_sweeps=50000 "
               "--tolerances 1e-4 1e-8 --threads 1 2");
  const auto lines = table(folder.path / "piles.csv");
  REQUIRE(lines.size() == 4 * 2 * 2 * 2);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    CAPTURE(line.at("kind") + ' ' + line.at("solver") + ' ' + line.at("tolerance"));
    CHECK(line.at("status") == "solved");
    CHECK(line.at("settling") == "73");
    CHECK(std::stol(line.at("contacts")) > 10);
    CHECK(std::stod(line.at("processor_us_a_contact")) > 0);
    CHECK(std::stod(line.at("scale_free")) <= std::stod(line.at("tolerance")));
    CHECK(line.at("threads") == (i % 2 == 0 ? "1" : "2"));
    CHECK(line.at("state") == lines[i - i % 2].at("state"));
    if (line.at("tolerance") == "1e-08") CHECK(line.at("state") != lines[i - i % 2 - 2].at("state"));
  }
}

TEST_CASE("pile_scaling --data: a case without an answer is a line with its status; --append keeps what is there") {
  if (kSanitized) return;
  const Folder folder;
  pile_scaling(folder, "--kinds boxes --sizes 20 --solvers nncg:max_sweeps=1 nncg --tolerances 1e-8");
  pile_scaling(folder, "--kinds boxes --sizes 20 --by nncg:max_sweeps=1 --solvers nncg --tolerances 1e-8 --append");
  const auto lines = table(folder.path / "piles.csv");
  REQUIRE(lines.size() == 3);
  CHECK(lines[0].at("status") == "iteration_limit");
  CHECK(lines[0].at("contacts") == "");
  CHECK(lines[0].at("sweeps") == "1");
  CHECK(std::stod(lines[0].at("scale_free")) > 1e-8);
  CHECK(lines[1].at("status") == "solved");
  CHECK(lines[2].at("status") == "settling: iteration_limit");
  CHECK(lines[2].at("state") == "");

  folder.write("piles.csv", "kind,bodies\n");
  const Reply refused = folder.run("'" ORTHANT_EXPERIMENTS "/pile_scaling' --data piles.csv --append --steps-only");
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.starts_with("pile_scaling: piles.csv: has other columns: must be kind,bodies,settling,"));
  CHECK(slurp(folder.path / "piles.csv") == "kind,bodies\n");
}

TEST_CASE("mechanism_scaling --data: a line for each mechanism and size; a late case is a line") {
  if (kSanitized) return;
  const Folder folder;
  const std::string program = "'" ORTHANT_EXPERIMENTS "/mechanism_scaling' --data mechanisms.csv ";
  REQUIRE(folder.run(program + "--sizes 25 100").exit_code == 0);
  const auto lines = table(folder.path / "mechanisms.csv");
  REQUIRE(lines.size() == (4 + 3) * 2);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    CAPTURE(line.at("kind") + ' ' + line.at("dimension") + ' ' + line.at("bodies"));
    CHECK(line.at("status") == "solved");
    CHECK(std::stod(line.at("step_us_a_body")) > 0);
    CHECK(std::stod(line.at("first_us_a_body")) > 0);
    CHECK(std::stod(line.at("kB_a_body")) > 0);
    CHECK(std::stod(line.at("joints_m")) < 1e-9);
    if (i % 2 == 0)
      CHECK(line.at("growth") == "");
    else
      CHECK(std::abs(std::stod(line.at("growth"))) < 5);
  }
  REQUIRE(folder.run(program + "--sizes 100000 --kinds chain --dimensions 2 --time-limit 0.001 --append").exit_code ==
          0);
  const auto all = table(folder.path / "mechanisms.csv");
  REQUIRE(all.size() == lines.size() + 1);
  CHECK(all.back().at("bodies") == "100000");
  CHECK(all.back().at("status") == "late");
  CHECK(all.back().at("step_us_a_body") == "");
}
