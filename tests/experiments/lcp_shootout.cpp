// The solver comparison: its table, its judge, what becomes of work that crashes or never ends, its pictures.
#include "experiments/studies/support/lcp_trial.h"
#include "experiments/studies/support/solver_table.h"
#include "experiments/support/isolated.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

struct Shootout : Folder {
  Reply shootout(const std::string& arguments) const {  // sanitizers need more addresses than any limit
    return run("OPENBLAS_NUM_THREADS=1 '" ORTHANT_SHOOTOUT "' --memory 0 --output out " + arguments);
  }
  using Row = std::map<std::string, std::string>;
  std::vector<Row> table() const {  // without commas inside the quotes that are looked at
    std::istringstream text(slurp(path / "out/shootout.csv"));
    const auto cells = [&text] {
      std::vector<std::string> all;
      std::string line, cell;
      std::getline(text, line);
      for (std::istringstream in(line); std::getline(in, cell, ',');) {
        std::erase(cell, '"');
        all.push_back(cell);
      }
      return all;
    };
    const auto titles = cells();
    std::vector<Row> rows;
    while (text.peek() != EOF) {
      const auto values = cells();
      for (std::size_t i = 0; i < std::min(titles.size(), values.size()); ++i) {
        if (i == 0) rows.emplace_back();
        rows.back()[titles[i]] = values[i];
      }
    }
    return rows;
  }
};

}  // namespace

TEST_CASE("isolated work: a text, an exception, a signal, an endless loop are outcomes; all end") {
  std::map<std::string, Outcome> outcomes;
  {
    Isolated processes(2, 0);
    const auto start = [&](const char* name, double seconds, const std::function<std::string()>& work) {
      processes.start(work, seconds, [&outcomes, name](const Outcome& outcome) { outcomes[name] = outcome; });
    };
    start("loop", 0.05, [] {
      for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
      return std::string();
    });
    start("long", 30, [] { return std::string(300000, 'x'); });  // more than a pipe holds
    start("throw", 30, []() -> std::string { throw std::runtime_error("words"); });
    start("signal", 30, [] {
      std::signal(SIGTERM, SIG_DFL);
      std::raise(SIGTERM);
      return std::string();
    });
    start("exit", 30, [] {
      std::_Exit(3);
      return std::string();
    });
    processes.wait_for_all();
    CHECK(outcomes.size() == 5);
    start("abandoned", 30, [] { return std::string(300000, 'x'); });  // left behind: killed with its owner
  }
  CHECK(outcomes.at("loop").kind == Outcome::killed);
  CHECK(outcomes.at("long").kind == Outcome::finished);
  CHECK(outcomes.at("long").text == std::string(300000, 'x'));
  CHECK(outcomes.at("throw").kind == Outcome::threw);
  CHECK(outcomes.at("throw").text == "words");
  CHECK(outcomes.at("signal").kind == Outcome::crashed);
  CHECK(outcomes.at("signal").text == "Terminated");
  CHECK(outcomes.at("exit").kind == Outcome::crashed);
  CHECK(outcomes.at("exit").text == "exit code 3");
}

TEST_CASE("trial: claims are held against what is known; a trial survives its way through the pipe") {
  Trial t;
  t.status = "solved";
  t.holds = true;
  t.seconds = 0.1;
  t.stages = "auto: \"x\"";
  CHECK(judge(t, Answer::unique) == Result::certified);
  CHECK(judge(t, {}) == Result::certified);
  CHECK(judge(t, Answer::infeasible) == Result::wrong);
  t.holds = false;
  CHECK(judge(t, Answer::one_of) == Result::wrong);
  t.status = "infeasible";
  CHECK(judge(t, Answer::infeasible) == Result::wrong);  // right, but the proof proves nothing
  t.holds = true;
  CHECK(judge(t, Answer::infeasible) == Result::certified);
  CHECK(judge(t, Answer::unique) == Result::wrong);
  CHECK(judge(t, Answer::none) == Result::certified);  // by cells
  for (const char* status : {"ray", "stalled", "time_limit"}) {
    t.status = status;
    CHECK(judge(t, Answer::unique) == Result::failed);
  }
  t.status = "killed";  // by us, past its time
  CHECK(judge(t, Answer::unique) == Result::late);
  CHECK(std::string(name(Result::late)) == "late");
  for (const char* status : {"crashed", "exception"}) {
    t.status = status;
    CHECK(judge(t, Answer::unique) == Result::crashed);
  }
  const Trial back = trial_from_text(to_text(t));
  CHECK(back.status == t.status);
  CHECK(back.seconds == 0.1);
  CHECK(back.residual == kInf);
  CHECK(back.holds);
  CHECK(back.stages == t.stages);
}

TEST_CASE("lcp_shootout: a row per case, certified where answers are known, pictures from the table") {
  const Shootout folder;
  const Reply a = folder.shootout(
      "--quick --time-limit 3 --families spd infeasible --solvers lemke lemke-howson "
      "pgs:max_sweeps=1");
  CHECK(a.exit_code == 0);
  CHECK(lines(a.out) == 1 + 3);
  const auto rows = folder.table();
  CHECK(rows.size() == (4 + 1) * 3);  // four conditions
  for (const auto& row : rows) {
    CAPTURE(row.at("problem"));
    CAPTURE(row.at("solver"));
    if (row.at("solver") == "lemke") {
      CHECK(row.at("result") == "certified");
      CHECK(row.at("status") == (row.at("family") == "spd" ? "solved" : "infeasible"));
      CHECK(row.at("group") == (row.at("family") == "spd" ? "definite" : "infeasible"));
      CHECK(std::stod(row.at("seconds")) > 0);
      if (row.at("family") == "spd") CHECK(std::stod(row.at("relative_residual")) < 1e-12);
      CHECK(std::stoi(row.at("runs")) >= 1);
      CHECK(!row.at("stages").empty());
    } else if (row.at("solver") == "lemke-howson") {
      CHECK(row.at("result") == "refused");
      CHECK(!row.at("note").empty());
    } else if (row.at("family") == "spd") {
      CHECK(row.at("result") == "failed");
      CHECK(row.at("status") == "iteration_limit");
      CHECK(std::stod(row.at("relative_residual")) > 1e-10);
    }
  }
  const auto manifest = nlohmann::json::parse(slurp(folder.path / "out/manifest.json"));
  CHECK(manifest.at("options").at("time_limit") == 3);
  CHECK(lines(slurp(folder.path / "out/summary.csv")) == 1 + 3);

  if (folder.run("/usr/bin/python3 -s -E -c 'import matplotlib'").exit_code != 0) {
    MESSAGE("no matplotlib: pictures not tested");
    return;
  }
  const Reply drawn = folder.run("/usr/bin/python3 -s -E '" ORTHANT_PLOTS "/plot_lcp_shootout.py' out");
  CAPTURE(drawn.err);
  CHECK(drawn.exit_code == 0);
  for (const char* name : {"performance_profiles", "work_precision", "certified_share"})
    for (const char* kind : {".png", ".svg"})
      CHECK(std::filesystem::file_size(folder.path / "out" / (std::string(name) + kind)) > 10000);
}

TEST_CASE("regret: the time of one solver over that of the fastest, problems that it does not certify first") {
  SolverTable table{{"auto", "pgs:omega=1,tolerance=1e-9"}, {}, {}};
  for (const char* name : {"even", "slow", "open", "nobody"}) {
    LcpCase about;
    about.family = "f", about.name = name;
    table.problems.push_back({about, "own", 7});
  }
  const auto add = [&](std::size_t problem, std::size_t solver, double seconds, Result result) {
    SolverTable::Row row{problem, solver, {}, result};
    row.trial.seconds = seconds;
    table.rows.push_back(row);
  };
  add(0, 0, 1, Result::certified), add(0, 1, 2, Result::certified);
  add(1, 0, 12, Result::certified), add(1, 1, 3, Result::certified);
  add(2, 0, 1, Result::failed), add(2, 1, 5, Result::certified);
  add(3, 0, 1, Result::failed), add(3, 1, 1, Result::wrong);
  const SolverTable::Cells expected{{"problem", "family", "n", "fastest", "seconds", "auto", "regret"},
                                    {"open", "f", "7", "\"pgs:omega=1,tolerance=1e-9\"", "5", "", ""},
                                    {"slow", "f", "7", "\"pgs:omega=1,tolerance=1e-9\"", "3", "12", "4"},
                                    {"even", "f", "7", "\"auto\"", "1", "1", "1"}};
  CHECK(table.regret("auto") == expected);
}

TEST_CASE("lcp_shootout: out of time is a row, larger problems of the kind are then skipped; bad input is one line") {
  const Shootout folder;
  // Enumeration needs seconds for 20 rows; 80 it would refuse, were it asked.
  const Reply a = folder.shootout("--families degenerate --largest 80 --solvers enumerate --time-limit 0.01");
  CHECK(a.exit_code == 0);
  const auto rows = folder.table();
  CHECK(rows.size() == 4);
  for (const auto& row : rows) {
    CAPTURE(row.at("problem"));
    if (row.at("n") == "80") {
      CHECK(row.at("result") == "skipped");
      CHECK(row.at("seconds").empty());
    } else if (row.at("status") == "killed") {  // a busy machine may let it come to that
      CHECK(row.at("result") == "late");
    } else {
      CHECK(row.at("status") == "time_limit");
      CHECK(row.at("result") == "failed");
    }
  }
  for (const char* bad : {"--families nobody", "--solvers nobody", "--problems missing.json", "--seeds 0"}) {
    CAPTURE(bad);
    const Reply b = folder.shootout(bad);
    CHECK(b.exit_code != 0);
    CHECK(b.out.empty());
    CHECK(!b.err.empty());
  }
}

TEST_CASE("lcp_shootout: own files, Matrix Market among them, have a panel of their own") {
  const Shootout folder;
  const std::string head = "%%MatrixMarket matrix array real general\n";
  folder.write("m.mtx", head + "2 2\n2\n1\n1\n2\n"), folder.write("m_q.mtx", head + "2 1\n-5\n-6\n");
  folder.write("other.mtx", head + "2 1\n-1\n-1\n"), folder.write("q3.mtx", head + "3 1\n-1\n-1\n-1\n");
  const Reply a = folder.shootout("--quick --families known --solvers lemke pgs --problems m.mtx m.mtx+other.mtx");
  CAPTURE(a.err);
  CHECK(a.exit_code == 0);
  int own = 0;
  for (const auto& row : folder.table()) {
    if (row.at("family") != "file") continue;
    CHECK(row.at("group") == "own");
    CHECK(row.at("result") == "certified");
    CHECK(row.at("n") == "2");
    ++own;
  }
  CHECK(own == 4);
  CHECK(folder.shootout("--problems other.mtx").err.find("a matrix alone is no problem: must be other.mtx+") !=
        std::string::npos);
  CHECK(folder.shootout("--problems m.mtx+q3.mtx").err.find("q3.mtx: has 3 entries: must have 2") != std::string::npos);
  if (folder.run("/usr/bin/python3 -s -E -c 'import matplotlib'").exit_code != 0) return;
  const Reply drawn = folder.run("/usr/bin/python3 -s -E '" ORTHANT_PLOTS "/plot_lcp_shootout.py' out");
  CAPTURE(drawn.err);
  CHECK(drawn.exit_code == 0);
  CHECK(slurp(folder.path / "out/work_precision.svg").find("axes_7") != std::string::npos);
}
