// Results files of sweeps: damaged, of a stranger, locked, on a full or a read-only disk; cases to run again.
#include "experiments/sweep/run.h"
#include "tests/support/sweeps.h"

#include <orthant/core/lcp/problems/collection.h>

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <barrier>
#include <thread>

using namespace orthant;

namespace {

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

TEST_CASE("a foreign results file is refused by name") {
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

TEST_CASE("cases that timed out or crashed run again with more time or --retry, and are kept otherwise") {
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

TEST_CASE("an invalid line leaves the results file unchanged; a folder is not a results file") {
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
