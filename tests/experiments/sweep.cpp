// Sweeps: the file's errors in words; the same table however it came about; failures that can be replayed; results files
// that are damaged, locked, on a full or a read-only disk.
#include "experiments/sweep/run.h"

#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <barrier>
#include <chrono>
#include <thread>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

constexpr const char* kSmallSweep = R"(
question = "Does it work?"
scene = "slider_crank"
measure = "crank.theta"
reference = "exact"
[[grid]]
integrator = ["moreau-jean", "rattle"]
set = {mu = [0.01, 0.1]}
step = {from = 2e-5, to = 1e-5, count = 10, scale = "log"}
)";
constexpr long kCases = 40;

struct Sweeps : Folder {
  Reply orthant(const std::string& arguments) const { return run("'" ORTHANT_CLI "' " + arguments); }
  /// The table without what may differ from run to run: the last columns, slowest and seconds.
  std::string table(const std::string& file) const {
    const Reply a = orthant("results " + file + " --csv");
    REQUIRE(a.exit_code == 0);
    std::string text;
    std::istringstream in(a.out);
    for (std::string line; std::getline(in, line);) text += line.substr(0, line.rfind(',', line.rfind(',') - 1)) + '\n';
    return text;
  }
  pid_t start(const std::string& file) const {
    const std::string sweep = path / "a.sweep.toml", results = path / file;
    std::array<const char*, 6> words = {ORTHANT_CLI, "sweep", sweep.c_str(), "--results", results.c_str(), nullptr};
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, 1, (results + ".log").c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    REQUIRE(posix_spawn(&process, ORTHANT_CLI, &quiet, nullptr, const_cast<char**>(words.data()), environ) == 0);
    posix_spawn_file_actions_destroy(&quiet);
    return process;
  }
  long done(const std::string& file) const {
    const Reply a = orthant("results " + file + " --csv");
    return a.exit_code == 0 ? lines(a.out) - 1 : 0;
  }
};

int end_of(pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Two finished cases.
void small_results(const Folder& folder, const char* file) {
  const Sweep sweep = read_sweep(folder.write("ball.sweep.toml", R"(
question = "Which?"
scene = "bouncing_ball"
duration = 0.1
measure = "ball.y"
[[grid]]
integrator = ["rattle"]
step = [1e-2, 5e-3]
)"),
                                 false);
  Results results(folder / file);
  results.declare(sweep);
  for (const Case& c : sweep.cases) results.add(run_case(c));
}

/// What `file` holds in words, or why it cannot be read; any other exception fails.
std::string read_all(const std::string& file) {
  try {
    const Results results(file, Results::read_only);
    std::string text;
    for (const auto& [name, about] : results.sweeps()) {
      text += name + about.dump() + std::to_string(results.members(name));
      for (const ResultRow& row : results.rows(name)) text += row.dump();
    }
    return text;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

void change(const std::string& file, const std::string& sql) {
  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open(file.c_str(), &db) == SQLITE_OK);
  CAPTURE(sql);
  CHECK(sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
  sqlite3_close(db);
}

}  // namespace

TEST_CASE("a results file with any of its bytes changed or cut off is read, or refused by name") {
  const Folder folder;
  small_results(folder, "r.sqlite");
  const std::string whole = slurp(folder / "r.sqlite"), right = read_all(folder / "r.sqlite");
  REQUIRE(right.find("Which?") != std::string::npos);
  Random random(3);
  int refused = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::string bytes = whole;
    const int size = static_cast<int>(bytes.size());
    if (trial % 10 == 0) bytes.resize(static_cast<std::size_t>(random.integer(1, size - 1)));
    const int begin = random.integer(0, size - 1), most = trial % 3 == 0 ? 1 : 2000;
    for (int k = 0; k < most; ++k)  // one byte; many in a page
      bytes[static_cast<std::size_t>(begin + k) % bytes.size()] ^= static_cast<char>(random.integer(1, 255));
    const std::string file = folder.write("d.sqlite", bytes);
    const std::string said = read_all(file);
    INFO("trial ", trial, ": ", said);
    const bool named = said.find("d.sqlite: ") != std::string::npos;
    CHECK((named || said.empty() || said.find("ball") != std::string::npos));
    if (named) CHECK(lines(said) == 0);
    refused += named;
  }
  CHECK(refused > 100);
}

TEST_CASE("a results file of a stranger: what no orthant wrote is refused by name, and leads nowhere") {
  const Folder folder;
  small_results(folder, "r.sqlite");
  const std::string whole = slurp(folder / "r.sqlite");
  for (const char* sql :
       {"UPDATE cases SET key = '../out' WHERE rowid = 1; UPDATE members SET key = '../out' WHERE place = 0",
        "UPDATE cases SET status = NULL", "UPDATE cases SET parameters = '{'", "UPDATE cases SET parameters = '3'",
        "UPDATE cases SET integrator = x'ff'", "UPDATE cases SET why = CAST(x'ff' AS TEXT)",
        "UPDATE cases SET seconds = 'soon'", "UPDATE sweeps SET about = '{'", "UPDATE sweeps SET about = NULL",
        "UPDATE sweeps SET about = '{}'", "UPDATE sweeps SET name = CAST(x'ff' AS TEXT)", "DROP TABLE members",
        "DROP TABLE cases", "ALTER TABLE cases RENAME COLUMN step TO stop", "PRAGMA user_version = 99",
        "PRAGMA application_id = 3"}) {
    CAPTURE(sql);
    std::filesystem::remove(folder / "d.sqlite-wal");
    change(folder.write("d.sqlite", whole), sql);
    const std::string said = read_all(folder / "d.sqlite");
    CAPTURE(said);
    CHECK(said.find("d.sqlite: ") != std::string::npos);
    CHECK(lines(said) == 0);
  }
}

TEST_SUITE_BEGIN("slow");  // for sanitizers: whole programs, several times

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

TEST_CASE("what fails is a row: its problem can be replayed; refused, out of time") {
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
      "bodies = ['ground', 'b']\n[[friction]]\njoint = 'j'\nbound = 1\n");
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

TEST_CASE("what the clock or a crash ended is run again with more time or --retry, and is kept otherwise") {
  const Sweeps folder;
  const auto ask = [&](double limit, const std::string& more = {}) {
    folder.write("l.sweep.toml",
                 "scene = 'slider_crank'\nmeasure = 'crank.theta'\nreference = 'event-driven:rtol=1e-12'\n[[grid]]\n"
                 "integrator = ['moreau-jean', 'rattle']\nstep = [5e-6, 2.5e-6]\ntime_limit = " +
                     std::to_string(limit) + "\n");
    const Reply a = folder.orthant("sweep l.sweep.toml --results r.sqlite --json " + more);
    REQUIRE(a.exit_code == 0);
    return nlohmann::json::parse(a.out).at("new").get<int>();
  };
  CHECK(ask(2e-3) == 4);
  const std::string before = folder.table("r.sqlite");
  CHECK(before.find("time_limit") != std::string::npos);
  CHECK(ask(2e-3) == 0);  // asked for the same, it keeps what it has
  CHECK(folder.table("r.sqlite") == before);
  CHECK(ask(1e-3) == 0);  // and for less
  CHECK(ask(60) == 4);    // those that were compared with a run without end, too
  for (const ResultRow& row : Results(folder / "r.sqlite", Results::read_only).rows("l")) {
    CHECK(row.at("status") == "solved");
    CHECK(!row.at("error").is_null());
  }
  CHECK(ask(60, "--retry") == 0);  // what is solved stays
  change(folder / "r.sqlite", "UPDATE cases SET status = 'crashed' WHERE integrator = 'rattle'");
  CHECK(ask(90) == 0);  // a crash is no matter of time
  CHECK(ask(90, "--retry") == 2);
  CHECK(ask(90, "--retry") == 0);
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
  const auto experiments = std::filesystem::path(ORTHANT_SCRIPTS).parent_path();
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
  CHECK(found == 4);
}

TEST_CASE("a line that is no row leaves the results file as it was; a folder is none") {
  const Sweeps folder;
  folder.write("r.sweep.toml",
               "scene = 'bouncing_ball'\nduration = 0.1\n[[grid]]\nintegrator = 'rattle'\nstep = 1e-2\n");
  const std::string key = folder.orthant("sweep r.sweep.toml --results r.sqlite --list").out.substr(0, 16);
  for (const std::string& line :
       {"{\"key\":\"" + key + "\"}", std::string(R"({"key":5})"), std::string(R"({"key":"zz","step":[1]})")}) {
    CAPTURE(line);
    folder.write("line.json", line + '\n');
    const Reply a = folder.orthant("results r.sqlite --add <line.json");
    CHECK(a.exit_code == 1);
    CHECK(a.err.find("no row of a sweep: a row whose ") != std::string::npos);
  }
  CHECK(folder.orthant("sweep r.sweep.toml --results r.sqlite --json").out.find("\"new\":1,") != std::string::npos);
  CHECK(folder.orthant("results .").err.find("it is a folder") != std::string::npos);
  std::filesystem::create_symlink("round", folder / "round");
  CHECK(folder.orthant("results round").err.find("symbolic links") != std::string::npos);
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK(folder.orthant("sweep r.sweep.toml --results pipe").err.find("it is no regular file") != std::string::npos);
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

TEST_CASE("results that cannot be written or read: one line with file and reason; a full disk loses no row") {
  const Sweeps folder;
  folder.write("a.sweep.toml", kSmallSweep);
  folder.write("text.sqlite", std::string(5000, 'x'));
  for (const auto& [file, word] : {std::array{"/proc/r.sqlite", "/proc"}, std::array{"text.sqlite", "no results file"},
                                   std::array{"a.sweep.toml/r.sqlite", "a.sweep.toml"}}) {
    CAPTURE(file);
    const Reply a = folder.orthant("sweep a.sweep.toml --results " + std::string(file));
    CAPTURE(a.err);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
    CHECK(a.err.find(word) != std::string::npos);
  }
  CHECK(folder.orthant("results missing.sqlite").exit_code == 1);
  Results(folder / "none.sqlite");  // a first sweep that a full disk ended at once
  CHECK(folder.orthant("results none.sqlite").err.find("none.sqlite: holds no sweep yet") != std::string::npos);
  CHECK(!std::filesystem::exists(folder / "missing.sqlite"));

  const Reply full = folder.run("bash -c \"trap '' XFSZ; ulimit -f 48; '" ORTHANT_CLI
                                "' sweep a.sweep.toml --results r.sqlite\"");  // [KiB]
  CAPTURE(full.err);
  CHECK(full.exit_code == 1);
  CHECK(full.err.find("r.sqlite: ") != std::string::npos);
  CHECK(full.err.find("full") != std::string::npos);
  const long kept = folder.done("r.sqlite");
  CHECK(folder.orthant("sweep a.sweep.toml --results r.sqlite").exit_code == 0);
  CHECK(folder.done("r.sqlite") == kCases);
  CHECK(kept < kCases);

  sqlite3* db = nullptr;
  REQUIRE(sqlite3_open((folder / "r.sqlite").c_str(), &db) == SQLITE_OK);
  REQUIRE(sqlite3_exec(db, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr) == SQLITE_OK);
  CHECK_THROWS_WITH(Results(folder / "r.sqlite", Results::read_write, 0.05).add({{"key", "0"}}),
                    doctest::Contains("another program has locked it"));
  sqlite3_close(db);
}

TEST_CASE("a results file that several begin at the same moment is everybody's") {
  const Folder folder;
  for (int round = 0; round < 30; ++round) {
    const auto file = folder.path / ("r" + std::to_string(round) + ".sqlite");
    std::barrier together(4);
    std::array<std::string, 4> words;
    std::vector<std::jthread> threads;
    for (std::string& word : words)
      threads.emplace_back([&] {
        together.arrive_and_wait();
        try {
          const Results results(file);
        } catch (const std::exception& error) {
          word = error.what();
        }
      });
    threads.clear();
    for (const std::string& word : words) CHECK(word == "");
  }
}

TEST_CASE("results on a read-only disk are read and reported as ever; writing there is refused in a line") {
  const Sweeps folder;
  const Folder elsewhere;
  small_results(folder, "r?#%41.sqlite");  // what means something to the name of a database
  const std::string here = folder.path.string();
  const bool by_mount = geteuid() == 0;  // permissions do not bind root
  const std::string enter = by_mount
                                ? "unshare -m sh -ec 'mount --bind \"$0\" \"$0\"; mount -o remount,bind,ro \"$0\"; "
                                  "cd \"$0\"; exec \"$@\"' '" +
                                      here + "' "
                                : "env -C '" + here + "' ";
  const auto run = [&](const std::string& command) { return elsewhere.run(enter + command); };
  if (const Reply tried = run("true"); tried.exit_code != 0) {
    MESSAGE("skipped, nothing can be mounted here: ", tried.err);
    return;
  }
  using std::filesystem::perms;
  const auto writable = perms::owner_write | perms::group_write | perms::others_write;
  if (!by_mount) std::filesystem::permissions(folder.path, writable, std::filesystem::perm_options::remove);
  const std::string file = "'r?#%41.sqlite'", table = folder.orthant("results " + file + " --csv").out;
  const auto reply = run("'" ORTHANT_CLI "' results " + file + " --csv");
  CAPTURE(reply.err);
  CHECK(reply.exit_code == 0);
  CHECK(reply.out == table);
  CHECK(lines(table) == 3);
  CHECK(run("'" ORTHANT_CLI "' report " + file + " --output '" + elsewhere.path.string() + "/r.html'").exit_code == 0);
  for (const std::string& words : {"sweep ball.sweep.toml --results " + file, "results " + file + " --add",
                                   std::string("sweep ball.sweep.toml --results new.sqlite")}) {
    const Reply refused = run("'" ORTHANT_CLI "' " + words + " </dev/null");
    CAPTURE(refused.err);
    CHECK(refused.exit_code == 1);
    CHECK(lines(refused.err) == 1);
    CHECK(refused.err.find("ead-only") != std::string::npos);
    CHECK(refused.err.find(".sqlite") != std::string::npos);
  }
  if (!by_mount) std::filesystem::permissions(folder.path, writable, std::filesystem::perm_options::add);
}
