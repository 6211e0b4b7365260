// Other people's solvers and simulators beside Orthant's: how they are asked and judged, by stand-ins written in shell
// (none has to be installed); those that are there, whether their drivers still work.
#include "experiments/studies/support/rivals.h"

#include <doctest/doctest.h>

#include <map>
#include <sstream>
#include <stdexcept>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

struct StandIns : Folder {
  StandIns() { std::filesystem::create_directory(path / "rivals"); }
  /// A driver: `methods` is what it prints without arguments, `solve` the shell that answers "$1" to "$3".
  void driver(const char* name, const std::string& methods, const std::string& solve) const {
    const auto file = path / "rivals" / name;
    if (!std::filesystem::exists(file)) std::ofstream(path / "rivals/drivers.txt", std::ios::app) << name << '\n';
    std::ofstream(file) << "#!/bin/sh\nif [ $# = 0 ]; then " << methods << "; exit; fi\n" << solve << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  std::vector<Rival> all() const { return rivals(path / "rivals"); }
};

Lcp pair() { return Lcp::standard(DenseMatrix(Eigen::MatrixXd{{2, 1}, {1, 2}}), Vector{-5, -6}); }  // z = (4/3, 7/3)

/// The drivers that experiments/benchmarks/setup has built for this tree.
std::vector<Rival> installed(const char* kind) {
  const auto folder = std::filesystem::path(ORTHANT_EXPERIMENTS) / "../../peers" / kind;
  return std::filesystem::is_directory(folder) ? rivals(folder) : std::vector<Rival>{};
}

}  // namespace

TEST_CASE("rivals: an answer is judged here; wrong answer, crash, refusal and absence are distinguished") {
  const StandIns folder;
  folder.driver("two", "echo right pure; echo lie pure; echo crash pure; echo refuse pure; echo nan pure", R"(case $1 in
    right) printf 'solved 3 5 1e-6 in words\n1.3333333333333333\n2.3333333333333335\n' > $3 ;;
    lie) printf 'solved 3 5 1e-6 -\n1.3\n2.3333333333333335\n' > $3 ;;
    refuse) echo 'unsupported 0 0 0 too hard' > $3 ;;
    nan) printf 'solved 3 5 1e-6 -\nnan\ninf\n' > $3 ;;
    crash) kill -SEGV $$ ;;
  esac)");
  folder.driver("absent", "echo 'no such package' >&2; exit 3", "");
  folder.write("rivals/other", "#!/bin/sh\ntouch \"$0.started\"; echo method pure");  // not in the list: not started
  std::filesystem::permissions(folder.path / "rivals/other", std::filesystem::perms::owner_all);
  std::map<std::string, Rival> found;
  for (const Rival& rival : folder.all()) found[rival.name] = rival;
  CHECK(found.size() == 6);
  const auto result = [&](const char* name) { return judge(try_rival(pair(), found.at(name)), Answer::unique); };
  const Trial right = try_rival(pair(), found.at("two/right"));
  CHECK(judge(right, Answer::unique) == Result::certified);
  CHECK(right.residual < 1e-15);
  CHECK(right.seconds == 1e-6);
  CHECK(right.iterations == 3);
  CHECK(right.note == "in words");
  CHECK(result("two/lie") == Result::wrong);
  CHECK(result("two/nan") == Result::wrong);
  CHECK(result("two/refuse") == Result::refused);
  CHECK(result("absent") == Result::refused);
  CHECK(found.at("absent").absent == "no such package");
  CHECK_THROWS_WITH_AS(result("two/crash"), "Segmentation fault", std::runtime_error);
  CHECK_FALSE(std::filesystem::exists(folder.path / "rivals/other.started"));
  CHECK_THROWS_AS(rivals(folder.path / "nowhere"), std::invalid_argument);
  CHECK_THROWS_AS(rivals(folder.path), std::invalid_argument);  // a folder, but none of drivers
  folder.write("drivers.txt", "rivals/other");
  CHECK_THROWS_AS(rivals(folder.path), std::invalid_argument);  // a file elsewhere
}

TEST_CASE("rivals: friction and boxes are rows of their own for solvers of pure problems, untouched for others") {
  const StandIns folder;
  folder.driver("size", "echo pure pure; echo boxes boxes; echo friction friction",
                "echo solved 0 1 0 $(od -An -t d8 -N 24 $2) > $3");  // rows, entries, friction rows
  const auto sizes = [&](const Lcp& problem) {
    std::string text;
    for (const Rival& rival : folder.all()) text += rival.method + " " + try_rival(problem, rival).note + "; ";
    return text;
  };
  CHECK(sizes(pair()) == "boxes 2 4 0; friction 2 4 0; pure 2 4 0; ");
  Lcp contact = pair();
  contact.lo[1] = -kInf;
  contact.friction = {{0, 1, 1, 0.3}};                                     // row 1 rubs on row 0
  CHECK(sizes(contact) == "boxes 4 14 0; friction 2 4 1; pure 4 14 0; ");  // normal, z+, bound, z-: 3 + 4 + 3 + 4
  Lcp box = pair();
  box.hi[1] = 2;
  CHECK(sizes(box) == "boxes 2 4 0; friction 2 4 0; pure 3 6 0; ");
  Lcp joint = pair();
  joint.lo[1] = -kInf;
  CHECK(sizes(joint) == "boxes 2 4 0; friction 2 4 0; pure free rows; ");
}

TEST_CASE("peers: rivals are rows of both tables, and of the report and its pictures") {
  const StandIns folder;
  folder.driver("half", "echo always pure", "printf 'solved 0 1 1e-9 -\\n0.5\\n' > $3");  // right for 2 z = 1
  folder.driver("shy", "echo always pure", "printf 'failed 0 1 1e-9 -\\n0.5\\n' > $3");
  folder.driver("gone", "echo 'not here' >&2; exit 3", "");
  const Reply lcp = folder.run("'" ORTHANT_SHOOTOUT
                               "' --memory 0 --families known spd --quick --solvers lemke "
                               "--rivals rivals --output out/lcp");
  CAPTURE(lcp.err);
  REQUIRE(lcp.exit_code == 0);
  const std::string table = slurp(folder.path / "out/lcp/shootout.csv");
  CHECK(table.find("\"scalar_+-\",known,other,1,0,0,\"half/always\",certified") != std::string::npos);
  CHECK(table.find("\"scalar_++\",known,other,1,0,0,\"half/always\",wrong") != std::string::npos);
  CHECK(table.find("\"scalar_+-\",known,other,1,0,0,\"shy/always\",certified,solved") != std::string::npos);
  CHECK(table.find("\"scalar_++\",known,other,1,0,0,\"shy/always\",failed") != std::string::npos);
  CHECK(table.find("\"scalar_tiny--\",known,infeasible,1,0,0,\"shy/always\",failed") != std::string::npos);  // has none
  CHECK(table.find("\"gone\",refused,unsupported,0,0,,,,,\"\",\"not here\"") != std::string::npos);

  // θ₁ of µ = 0.01, e = 0.4, exact; one that gives up, and one that speaks before it answers.
  folder.driver("half", "echo exact step; echo silent tolerance", R"([ $1 = exact ] || exit 1
    echo 'a warning'; echo 18.0836786523406 0.001 20)");
  const Reply mechanism = folder.run("'" ORTHANT_EXPERIMENTS
                                     "/work_precision' --quick --repeats 1 --integrators adaptive "
                                     "--rivals rivals --output out/slider_crank");
  CAPTURE(mechanism.err);
  REQUIRE(mechanism.exit_code == 0);
  int exact = 0, silent = 0;
  std::istringstream rows(slurp(folder.path / "out/slider_crank/runs.csv"));
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with("half/exact,") && row.find(",0.01,0.4,solved,") != std::string::npos)
      exact += row.find(",0.001,20,") != std::string::npos;
    silent += row.starts_with("half/silent,") && row.find(",numerical_error,,,") != std::string::npos;
  }
  CHECK(exact == 6);  // step sizes
  CHECK(silent >= 9);
  CHECK(mechanism.out.find("| `gone` | absent: not here |") != std::string::npos);

  if (folder.run("/usr/bin/python3 -s -E -c 'import matplotlib'").exit_code != 0) {
    MESSAGE("no matplotlib: pictures not tested");
    return;
  }
  const Reply drawn = folder.run("/usr/bin/python3 -s -E '" ORTHANT_PLOTS "/plot_peers.py' out");
  CAPTURE(drawn.err);
  CHECK(drawn.exit_code == 0);
  const std::string report = slurp(folder.path / "out/report.md");
  CHECK(report.find("| half/always |") != std::string::npos);
  CHECK(report.find("| half/exact | 1 | 1 | 1 | 1 |") != std::string::npos);  // [ms] to any error
  CHECK(report.find("| gone | absent |") != std::string::npos);
  for (const char* picture : {"lcp_profile.png", "lcp_profile.svg", "slider_crank.png", "slider_crank.svg"})
    CHECK(std::filesystem::file_size(folder.path / "out" / picture) > 10000);
}

TEST_CASE("peers: the drivers that are there solve a small problem and move the slider-crank") {
  if (installed("lcp").empty())
    MESSAGE("NO RIVALS ARE INSTALLED (experiments/run peers does it): their drivers are not tested");
  for (const Rival& rival : installed("lcp")) {
    CAPTURE(rival.name);
    if (rival.absent.empty())
      CHECK(judge(try_rival(pair(), rival), Answer::unique) == Result::certified);
    else
      MESSAGE(rival.name << " is absent: " << rival.absent);
  }
  for (const Rival& rival : installed("slider_crank")) {
    CAPTURE(rival.name);
    if (rival.absent.empty()) {
      const std::string setting = rival.takes == "tolerance" ? "1e-3" : "2e-5";
      const std::string text = output_of({rival.program.string(), rival.method, "0.01", "0.4", setting});
      double theta1 = 0, seconds = 0;
      const auto line = text.find_last_of('\n', text.size() - 2);
      std::istringstream(text.substr(line == std::string::npos ? 0 : line + 1)) >> theta1 >> seconds;
      CHECK(std::abs(theta1 - 18.0837) < 0.5);  // [rad], of 2.9 turns
      CHECK(seconds > 0);
    } else {
      MESSAGE(rival.name << " is absent: " << rival.absent);
    }
  }
}
