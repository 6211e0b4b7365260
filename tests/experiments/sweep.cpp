// Sweeps: the file's errors in words; the same table however it came about; failures that can be replayed.
#include "experiments/sweep/run.h"
#include "tests/support/sweeps.h"

#include <doctest/doctest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

using namespace orthant;

namespace {

int end_of(pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

TEST_CASE("a sweep gives the same table however often, by however many at once, killed midway or not") {
  const Sweeps folder;
  folder.write("a.sweep.toml", kSmallSweep);
  const Reply whole = folder.orthant("sweep a.sweep.toml --results whole.sqlite --jobs 1");
  CAPTURE(whole.err);
  REQUIRE(whole.exit_code == 0);
  CHECK(whole.out.starts_with("a: 40 cases in whole.sqlite, 40 of them new, 0 not solved"));
  const std::string table = folder.table("whole.sqlite");
  CHECK(lines(table) == kCases + 1);

  SUBCASE("again: nothing is left to do; into another file: the same") {
    CHECK(folder.orthant("sweep a.sweep.toml --results whole.sqlite").out.find(" 0 of them new") != std::string::npos);
    CHECK(folder.table("whole.sqlite") == table);
    CHECK(folder.orthant("sweep a.sweep.toml --results again.sqlite --jobs 2").exit_code == 0);
    CHECK(folder.table("again.sqlite") == table);
  }
  SUBCASE("killed midway: what was done stays, the rest is done later") {
    const pid_t process = folder.start("killed.sqlite");
    for (int i = 0; i < 1000 && folder.done("killed.sqlite") < 5; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(process, SIGKILL);
    CHECK(end_of(process) == -SIGKILL);
    const long kept = folder.done("killed.sqlite");
    CHECK(kept >= 5);
    CHECK(kept < kCases);
    const Reply rest = folder.orthant("sweep a.sweep.toml --results killed.sqlite");
    CHECK(rest.exit_code == 0);
    CHECK(rest.out.find(", " + std::to_string(kCases - kept) + " of them new") != std::string::npos);
    CHECK(folder.table("killed.sqlite") == table);
  }
  SUBCASE("two at once: no case is lost, none is done twice") {
    const pid_t one = folder.start("both.sqlite");
    const Reply two = folder.orthant("sweep a.sweep.toml --results both.sqlite");
    CHECK(end_of(one) == 0);
    CHECK(two.exit_code == 0);
    CHECK(folder.table("both.sqlite") == table);
    const auto count = [](const std::string& text) { return std::stol(text.substr(text.find("sqlite, ") + 8)); };
    CHECK(count(slurp(folder / "both.sqlite.log")) + count(two.out) == kCases);
  }
}

TEST_CASE("a sweep by Dask workers: one is killed midway, no case is lost or doubled") {
  const Sweeps folder;
  if (folder.run("/usr/bin/python3 -s -E -c 'import distributed'").exit_code != 0) {
    MESSAGE("no distributed: not tested");
    return;
  }
  folder.write("a.sweep.toml", kSmallSweep);
  CHECK(folder.orthant("sweep a.sweep.toml --results whole.sqlite").exit_code == 0);
  const Reply a = folder.run("/usr/bin/python3 -s -E '" ORTHANT_TEST_DATA "/../experiments/dask.py' '" ORTHANT_SCRIPTS
                             "/sweep_dask.py' '" ORTHANT_CLI "' \"$PWD/a.sweep.toml\" \"$PWD/dask.sqlite\"");
  CAPTURE(a.out);
  CAPTURE(a.err);
  CHECK(a.exit_code == 0);
  CHECK(std::stol("0" + a.out) < kCases);  // else it was killed too late to tell anything
  CHECK(a.out.find(std::to_string(kCases) + " at the end") != std::string::npos);
  CHECK(folder.table("dask.sqlite") == folder.table("whole.sqlite"));
}

TEST_SUITE_END();

TEST_CASE("a sweep's errors: against the exact motion as against an integrator's, each run of it made once") {
  const Sweeps folder;
  std::string text = kSmallSweep;
  text.replace(text.find("count = 10"), 10, "count = 2");
  folder.write("exact.sweep.toml", text);
  text.replace(text.find("\"exact\""), 7, "\"event-driven:rtol=1e-12\"");
  folder.write("other.sweep.toml", text);
  for (const char* name : {"exact", "other"})
    CHECK(folder.orthant(std::string("sweep ") + name + ".sweep.toml --results r.sqlite").exit_code == 0);
  const Results results(folder / "r.sqlite", Results::read_only);
  const auto exact = results.rows("exact"), other = results.rows("other");
  REQUIRE(exact.size() == 8);
  REQUIRE(other.size() == 8);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    CHECK(exact[i].at("value") == other[i].at("value"));
    CHECK(exact[i].at("error").get<double>() > 1e-7);
    CHECK(std::abs(exact[i].at("error").get<double>() - other[i].at("error").get<double>()) < 1e-9);
    CHECK(exact[i].at("key") != other[i].at("key"));
  }
  sqlite3* db = nullptr;  // the two references are rows too, of no sweep
  REQUIRE(sqlite3_open((folder / "r.sqlite").c_str(), &db) == SQLITE_OK);
  sqlite3_stmt* count = nullptr;
  sqlite3_prepare_v2(db, "SELECT count(*) FROM cases", -1, &count, nullptr);
  REQUIRE(sqlite3_step(count) == SQLITE_ROW);
  CHECK(sqlite3_column_int(count, 0) == 18);
  sqlite3_finalize(count);
  sqlite3_close(db);
}

TEST_CASE("a failed case is a row, and its problem can be replayed; likewise refused and timed-out cases") {
  const Sweeps folder;
  folder.write("f.sweep.toml",
               "scene = 'slider_crank'\n"
               "[[grid]]\nintegrator = 'moreau-jean'\nsolver = ['lemke', 'pgs:max_sweeps=1', 'murty']\nstep = 1e-4\n"
               "[[grid]]\nintegrator = 'event-driven'\ntime_limit = 1e-3\n");
  folder.write("r.sweep.toml",
               "scene = 'rub.toml'\n[[grid]]\nintegrator = ['moreau-jean', 'adaptive']\n"
               "set = {\"body.b.mass\" = [1, 2]}\n");
  folder.write(
      "rub.toml",
      "duration = 0.01\n[[body]]\nname = 'b'\nmass = 1\ninertia = 1\n[[joint]]\ntype = 'revolute'\nname = 'j'\n"
      "bodies = ['ground', 'b']\n[[friction]]\njoint = 'j'\nbound = 1\nmu = 0.1\n");
  CHECK(folder.orthant("sweep f.sweep.toml --results r.sqlite").exit_code == 0);
  CHECK(folder.orthant("sweep r.sweep.toml --results r.sqlite").exit_code == 0);
  const Results results(folder / "r.sqlite", Results::read_only);
  const auto rows = results.rows("f"), rub = results.rows("r");
  REQUIRE(rows.size() == 4);
  REQUIRE(rub.size() == 4);
  CHECK(rows[0].at("status") == "solved");
  CHECK(rows[1].at("status") == "iteration_limit");
  CHECK(rows[2].at("status") == "unsupported");
  CHECK(!rows[2].at("why").get<std::string>().empty());
  CHECK(rows[3].at("status") == "time_limit");
  CHECK(rub[0].at("status") == "solved");
  CHECK(rub[2].at("status") == "refused");
  CHECK(rub[2].at("why").get<std::string>().find("friction") != std::string::npos);
  const Reply failures = folder.orthant("results r.sqlite --failures --sweep f");
  CHECK(failures.exit_code == 0);
  CHECK(lines(failures.out) == 3);
  const std::string dump = "r.failures/" + rows[1].at("key").get<std::string>() + ".json";
  CHECK(failures.out.find("orthant solve " + dump) != std::string::npos);
  CHECK(folder.orthant("solve " + dump).exit_code == 0);
  const auto listed = nlohmann::json::parse(folder.orthant("results r.sqlite --failures --sweep f --json").out);
  REQUIRE(listed.size() == 3);
  CHECK(listed[0].at("dump") == dump);
  CHECK(folder.orthant("results r.sqlite")
            .out.find("f: 4 of 4 cases done, 1 iteration_limit, 1 solved, 1 time_limit, 1 unsupported") !=
        std::string::npos);
}

TEST_CASE("when contacts that last end: known of a motion, whatever the scheme's way to carry them") {
  const Sweeps folder;
  folder.write(
      "l.sweep.toml",
      "scene = 'slider_crank'\n[[grid]]\nintegrator = ['event-driven', 'moreau-jean', 'paoli-schatzman', 'rattle']\n"
      "step = 1e-5\nset = {e = 0.4}\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-5\nduration = 1e-3\n");
  REQUIRE(folder.orthant("sweep l.sweep.toml --results r.sqlite").exit_code == 0);
  const auto rows = Results(folder / "r.sqlite", Results::read_only).rows("l");
  REQUIRE(rows.size() == 5);
  for (std::size_t i = 0; i < 4; ++i) {  // the golden releases: tests/data
    CHECK(rows[i].at("first_release").get<double>() == doctest::Approx(15.03e-3).epsilon(2e-3));
    CHECK(rows[i].at("last_release").get<double>() == doctest::Approx(172.8e-3).epsilon(1e-3));
  }
  CHECK(rows[4].at("first_release").is_null());  // before the first touch
  CHECK(rows[4].at("first_touch").is_null());
}

TEST_CASE("a case alone, as other programs ask for it, is the row of the sweep: out of time included") {
  const Sweeps folder;
  folder.write("l.sweep.toml",
               "scene = 'slider_crank'\nmeasure = 'crank.theta'\nreference = 'event-driven'\n"
               "[[grid]]\nintegrator = 'moreau-jean'\nstep = [1e-4, 1e-8]\ntime_limit = 3\n");
  CHECK(folder.orthant("sweep l.sweep.toml --results r.sqlite").exit_code == 0);
  const auto rows = Results(folder / "r.sqlite", Results::read_only).rows("l");
  REQUIRE(rows.size() == 2);
  CHECK(rows[1].at("status") == "time_limit");
  for (const ResultRow& row : rows) {
    const Reply lone = folder.orthant("sweep l.sweep.toml --case " + row.at("key").get<std::string>());
    REQUIRE(lines(lone.out) == 2);  // what it is compared with comes first
    folder.write("rows", lone.out);
    CHECK(folder.run("'" ORTHANT_CLI "' results apart.sqlite --add < rows").exit_code == 0);
    const auto alone = ResultRow::parse(lone.out.substr(lone.out.find('\n')), nullptr, false);
    REQUIRE(alone.is_object());
    for (const auto& [name, value] : row.items())
      if (name != "seconds" && name != "slowest") CHECK(alone.value(name, ResultRow()) == value);
  }
  for (const char* file : {"r.sqlite", "apart.sqlite"})  // the file is the same, whoever keeps it
    CHECK(folder
              .run("/usr/bin/python3 -s -E -c 'import sqlite3; print(sqlite3.connect(\"" + std::string(file) +
                   "\").execute(\"select count(*) from cases\").fetchone()[0])'")
              .out == "3\n");
}

TEST_CASE("the project's own sweeps can be read, whole and quick") {
  const Sweeps folder;
  const auto experiments = std::filesystem::path(ORTHANT_PLOTS).parent_path();
  int found = 0;
  for (const auto& file : std::filesystem::directory_iterator(experiments)) {
    if (!file.path().filename().string().ends_with(".sweep.toml")) continue;
    ++found;
    const auto list = [&](const char* more) {
      return folder.orthant("sweep '" + file.path().string() + "' --list --results r.sqlite" + more);
    };
    const Reply whole = list(""), quick = list(" --quick");
    CAPTURE(whole.err + quick.err);
    CHECK(whole.exit_code == 0);
    CHECK(quick.exit_code == 0);
    CHECK(lines(quick.out) > 10);
    CHECK(lines(quick.out) < lines(whole.out) / 2);
    for (const Case& c : read_sweep(file.path(), false).cases)  // 0.3, and no 0.30000000000000004
      for (const auto& [name, value] : c.parameters) CHECK((value.is_string() || value.dump().size() < 16));
  }
  CHECK(found == 5);
}

TEST_CASE("a figure whose texts are lists is several figures, alike in the rest") {
  const Sweeps folder;
  folder.write("f.sweep.toml",
               "scene = 'slider_crank'\n[[grid]]\nintegrator = 'rattle'\n[[figure]]\ntitle = ['a', 'b']\nx = 'step'\n"
               "y = ['error', 'value']\nby = 'solver'\nlog = 'x'\n[[figure]]\ntitle = 'c'\nx = 'step'\ny = 'value'\nby "
               "= 'solver'\n");
  const auto figures = read_sweep(folder / "f.sweep.toml", false).page.at("figure");
  std::string told;
  for (const auto& f : figures)
    told += f.at("title").get<std::string>() + ' ' + f.at("y").get<std::string>() + f.value("log", "") + ' ';
  CHECK(told == "a errorx b valuex c value ");
}

TEST_CASE("bad sweep files: one line that names file, key, value and rule") {
  const Sweeps folder;
  const std::string head = "scene = 'slider_crank'\nmeasure = 'crank.theta'\n",
                    grid = "[[grid]]\nintegrator = 'rattle'\n";
  const std::array<std::array<std::string, 2>, 37> bad = {{
      {"scene = ", "b.sweep.toml:"},
      {grid, "scene: is missing"},
      {"scene = 'nobody'\n" + grid, "scene: unknown scene 'nobody'"},
      {head, "at least one [[grid]]"},
      {head + "colour = 1\n" + grid, "colour = 1: unknown key"},
      {head + grid + "h = 1\n", "grid.h = 1: unknown key"},
      {head + "[[grid]]\nstep = 1e-4\n", "grid.integrator: is missing"},
      {head + "[[grid]]\nintegrator = 'nobody'\n", "unknown integrator 'nobody'"},
      {head + "[[grid]]\nintegrator = 'rattle:x=1'\n", "unknown option 'x'"},
      {head + grid + "solver = 'nobody'\n", "nobody"},
      {head + grid + "solver = 3\n", "grid.solver = 3: must be a text"},
      {head + grid + "step = 0\n", "grid.step = 0: must be in"},
      {head + grid + "step = 1\n", "grid.step = 1: must be in [1e-15, 0.2]"},
      {head + grid + "step = []\n", "grid.step = []"},
      {head + grid + "step = {from = 1, to = 2}\n", "a range needs count"},
      {head + grid + "step = {from = -1, to = 2, count = 3, scale = 'log'}\n", "needs from > 0"},
      {head + grid + "step = {from = 1e-3, to = 1e-4, count = 2.5}\n", "must be a whole number"},
      {head + grid + "set = {mu = [0, -1]}\n", "mu"},
      {head + grid + "rtol = 1e-3\n", "rtol"},
      {head + "reference = 'exact'\n" + grid + "set = {mu = 0.02}\n", "mu = 0.02"},
      {head + grid + "step = nan\n", "grid.step = nan: must be in"},
      {head + grid + "step = {from = 1e-3, to = inf, count = 2}\n", "grid.step.to = inf: must be in"},
      {head + grid + "repeats = 1.5\n", "grid.repeats = 1.5: must be a whole number"},
      {head + grid + "set = {mu = 2020-01-01}\n", "b.sweep.toml:5: a date or time"},
      {head + grid + "quick = 'no'\n", "grid.quick = \"no\": must be a table, true or false"},
      {head + grid + "quick = {step = -1}\n", "grid.step = -1: must be in"},
      {head + "grid = [3]\n", "grid = 3: must be a table"},
      {head + "figure = 3\n" + grid, "figure = 3: must be tables [[figure]]"},
      {head + grid + "[[figure]]\ntitle = 'a'\nx = 'stp'\ny = 'error'\nby = 'solver'\n", "figure.x = \"stp\""},
      {head + grid + "[[figure]]\nlogs = 'x'\n", "figure.logs = \"x\": unknown key"},
      {head + grid + "[[figure]]\ntitle = 'a'\nx = 'step'\ny = 'error'\nby = 'solver'\nwhere = {no = 1}\n",
       "figure.where.no = 1: must be one of"},
      {head + grid + "[[figure]]\ntitle = 'a'\nx = 'step'\ny = 'error'\nby = 'solver'\nwhere = 1\n",
       "figure.where = 1: must be a table"},
      {head + grid + "[[figure]]\ntitle = ['a', 'b']\nx = 'step'\ny = ['error', 'value', 'seconds']\nby = 'solver'\n",
       "figure.title = [\"a\",\"b\"]: must have as many texts as the figure's other lists: 3"},
      {head + grid + "[[animation]]\ntitle = 'a'\nruns = [{integrator = 'rattle', step = 1e-10}]\n",
       "animation.runs.step = 1e-10: must make at most a million steps"},
      {head + grid + "[[animation]]\ntitle = 'a'\n", "animation.runs = []: must have at least one run"},
      {head + grid + "[[animation]]\ntitle = 'a'\nruns = [{integrator = 'nobody'}]\n", "integrator 'nobody'"},
      {head + grid + "[[animation]]\ntitle = 'a'\nmagnify = 'rat'\nruns = [{integrator = 'rattle'}]\n",
       "animation.magnify = \"rat\": must be a body of the scene"},
  }};
  for (const auto& [text, word] : bad) {
    CAPTURE(text);
    folder.write("b.sweep.toml", text);
    const Reply a = folder.orthant("sweep b.sweep.toml --results b.sqlite");
    CAPTURE(a.err);
    CHECK(a.exit_code == 1);
    CHECK(a.out.empty());
    CHECK(lines(a.err) == 1);
    CHECK(a.err.find("b.sweep.toml") != std::string::npos);
    CHECK(a.err.find(word) != std::string::npos);
    CHECK(!std::filesystem::exists(folder / "b.sqlite"));
  }
}
