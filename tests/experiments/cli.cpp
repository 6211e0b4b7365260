// Commands other than simulate: list, analyse, solve, enumerate, replay, completion, help.
#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

namespace fs = std::filesystem;
using orthant::Cli, orthant::Reply, orthant::lines, orthant::slurp;

TEST_CASE("orthant list names everything, with options") {
  const Cli folder;
  const Reply a = folder.orthant("list");
  CHECK(a.exit_code == 0);
  for (const char* word : {"lemke", "pgs", "enumerate", "moreau-jean", "slider_crank", "slider_crank_ideal", "omega",
                           "joints", "clearance"})
    CHECK(a.out.find(word) != std::string::npos);
  CHECK(folder.orthant("list solvers").out.find("moreau-jean") == std::string::npos);

  const auto json = nlohmann::json::parse(folder.orthant("list --json").out);
  CHECK(json.at("solvers").size() > 15);
  const auto option = [&](const char* kind, const std::string& name, const std::string& asked) {
    for (const auto& entry : json.at(kind))
      if (entry.at("name") == name)
        for (const auto& o : entry.at("options"))
          if (o.at("name") == asked) return o;
    return nlohmann::json();
  };
  CHECK(option("solvers", "pgs", "omega").at("range") == nlohmann::json::parse("[0.001, 1.999]"));
  CHECK(option("solvers", "lemke", "rescue").at("default") == true);
  // What is printed is taken back: a whole number without exponent.
  CHECK(a.out.find("max_sweeps=100000 in [1, ") != std::string::npos);
  CHECK(a.out.find("max_sweeps=1e+05") == std::string::npos);
  CHECK(option("integrators", "moreau-jean", "joints").at("choices").size() > 1);
  CHECK(json.at("scenes")[0].at("name") == "bouncing_ball");
  CHECK(!nlohmann::json::parse(folder.orthant("list solvers --json").out).contains("scenes"));
  CHECK(folder.orthant("list --json --markdown").exit_code == 1);
}

TEST_CASE("orthant analyse and solve: the kind of matrix, the rows' places, the error bound") {
  const Cli folder;
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n2 2\n2\n-1\n-1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-1\n5\n");
  const Reply kind = folder.orthant("analyse M.mtx --json");
  CHECK(kind.exit_code == 0);
  const auto json = nlohmann::json::parse(kind.out);
  CHECK(json.at("K") == "yes");
  CHECK(json.at("rank") == 2);
  CHECK(json.at("condition").get<double>() == doctest::Approx(3));
  CHECK(folder.orthant("analyse M.mtx").out.find("positive definite       yes") != std::string::npos);
  CHECK(folder.orthant("analyse missing.mtx").exit_code == 1);

  const Reply solved = folder.orthant("solve --matrix M.mtx --vector q.mtx --error-bound --json");
  const auto answer = nlohmann::json::parse(solved.out);
  CHECK(answer.at("active_set").at("inside") == std::vector<int>{0});
  CHECK(answer.at("active_set").at("lower") == std::vector<int>{1});
  CHECK(answer.at("uniqueness") == "isolated");
  CHECK(answer.at("error_bound").get<double>() < 1e-12);
}

TEST_CASE("experiments/README.md has the table of solvers that orthant list --markdown prints") {
  const Cli folder;
  const Reply a = folder.orthant("list --markdown");
  CHECK(a.exit_code == 0);
  CHECK(lines(a.out) > 5);
  CHECK(slurp(fs::path(ORTHANT_TEST_DATA) / "../../experiments/README.md").find(a.out) != std::string::npos);
}

TEST_CASE("choose_integrator.md has the table of capabilities that orthant list integrators --markdown prints") {
  const Cli folder;
  const Reply table = folder.orthant("list integrators --markdown");
  CHECK(lines(table.out) == 10);
  CHECK(slurp(fs::path(ORTHANT_TEST_DATA) / "../../experiments/docs/choose_integrator.md").find(table.out) !=
        std::string::npos);
  const auto json = nlohmann::json::parse(folder.orthant("list integrators --json").out);
  for (const auto& entry : json.at("integrators"))
    CHECK(entry.at("can").at("error_control") ==
          (entry.at("name") == "adaptive" || entry.at("name") == "event-driven"));
  CHECK(folder.orthant("list integrators").out.find("takes: impact_laws, tangential_restitution") != std::string::npos);
}

TEST_CASE("orthant list summary names the fields of every run's summary, as statuses.md has them") {
  const Cli folder;
  const std::string page = slurp(fs::path(ORTHANT_TEST_DATA) / "../../experiments/docs/statuses.md");
  const Reply table = folder.orthant("list summary --markdown");
  CHECK(lines(table.out) > 20);
  CHECK(page.find(table.out) != std::string::npos);
  const auto run = nlohmann::json::parse(folder.orthant("simulate bouncing_ball --duration 1 --json").out);
  const auto list = nlohmann::json::parse(folder.orthant("list summary --json").out);
  for (const auto& field : list.at("summary")) {
    const auto name = field.at("name").get<std::string>();
    CAPTURE(name);
    const bool absent = name == "smallest_clearance" || name == "first_passage_time" || name == "first_rounded_time" ||
                        name == "first_plastic_time" || name == "first_undetermined_time";
    CHECK(run.contains(name) == !absent);
    CHECK(folder.orthant("list summary").out.find("  " + name) != std::string::npos);
  }
}

TEST_CASE("every command that takes a problem takes Matrix Market files; solve asks auto") {
  const Cli folder;
  folder.write("M.mtx", "%%MatrixMarket matrix array real general\n2 2\n2\n1\n1\n2\n");
  folder.write("q.mtx", "%%MatrixMarket matrix array real general\n2 1\n-5\n-6\n");
  folder.write("u.mtx", "%%MatrixMarket matrix array real general\n2 1\n1\n9\n");
  const auto json = [&](const std::string& arguments) {
    const Reply a = folder.orthant(arguments + " --json");
    CAPTURE(arguments);
    CHECK(a.exit_code == 0);
    return nlohmann::json::parse(a.out);
  };
  const std::string files = " --matrix M.mtx --vector q.mtx", box = files + " --upper u.mtx";
  CHECK(json("enumerate" + box).at("isolated") == nlohmann::json::parse("[[1.0, 2.5]]"));
  CHECK(json("replay --solver lemke" + box).at(0).at("status") == "solved");
  CHECK(json("analyse --matrix M.mtx").at("P") == "yes");
  CHECK(json("solve" + files).at("solver") == "auto");
  for (const char* arguments : {"enumerate", "replay", "analyse", "enumerate M.mtx", "enumerate --matrix M.mtx",
                                "solve p.json --lower u.mtx"}) {
    CAPTURE(arguments);
    const Reply a = folder.orthant(arguments);
    CHECK(a.exit_code == 1);
    CHECK(lines(a.err) == 1);
  }
  CHECK(folder.orthant("enumerate M.mtx").err.find("--matrix M.mtx --vector FILE") != std::string::npos);
}

TEST_CASE("every command's --help has an example of its own and says what its exit codes mean") {
  const Cli folder;
  for (const std::string command : {"solve", "analyse", "enumerate", "replay", "simulate", "sweep", "results", "report",
                                    "list", "view", "new", "gradient", "lyapunov"}) {
    CAPTURE(command);
    const Reply a = folder.orthant(command + " --help");
    CHECK(a.exit_code == 0);
    CHECK(a.out.find("\n  orthant " + command + " ") != std::string::npos);
    CHECK(a.out.find("Exit codes: 0 ") != std::string::npos);
  }
  CHECK(folder.orthant("solv").err.starts_with("orthant: 'solv' is no subcommand, one of: solve "));
}

TEST_CASE("orthant enumerate, replay, --version, completion") {
  const Cli folder;
  const std::string file = folder.write("p.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 2, "rows": [[-1, 0], [0, -1]]}, "b": [1, 1]})");
  const Reply all = folder.orthant("enumerate p.json --json");
  CHECK(all.exit_code == 0);
  CHECK(nlohmann::json::parse(all.out).at("isolated").size() == 4);
  const std::string none = folder.write("none.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 1, "rows": [[-1]]}, "b": [-1]})");
  CHECK(folder.orthant("enumerate none.json").exit_code == 2);
  folder.write("beyond.json", R"({"format": "orthant-lcp", "version": 1,
    "A": {"storage": "dense", "n": 1, "rows": [[1e-200]]}, "b": [-1e200]})");
  CHECK(nlohmann::json::parse(folder.orthant("enumerate beyond.json --json").out).at("isolated")[0][0] == "inf");

  const Reply replay = folder.orthant("replay p.json --json");
  CHECK(replay.exit_code == 0);
  const auto table = nlohmann::json::parse(replay.out);
  CHECK(table.size() > 15);
  for (const auto& row : table) {
    if (row.at("solver") == "lemke") CHECK(row.at("status") == "solved");
    if (row.at("status") == "unsupported") CHECK(!row.at("why_not").get<std::string>().empty());
  }
  CHECK(folder.orthant("replay none.json --solver lemke").exit_code == 2);
  CHECK(folder.orthant("replay p.json --solver lemk").exit_code == 1);
  CHECK(folder.orthant("replay p.json --time-limit -1").exit_code == 1);
  CHECK(folder.orthant("replay '" ORTHANT_TEST_DATA "/fclib/Box_Stacks-i0122-82-5.hdf5' --solver auto").exit_code == 0);

  const Reply version = folder.orthant("--version");
  CHECK(version.exit_code == 0);
  CHECK(version.out.find("Eigen 3.") != std::string::npos);
  CHECK(version.out.find("ipopt: ") != std::string::npos);

  const auto build = nlohmann::json::parse(folder.orthant("--version --json").out);
  CHECK(build.at("backends").at("ipopt").is_boolean());
  CHECK(version.out.find(build.at("revision").get<std::string>()) != std::string::npos);
  CHECK(folder.orthant("--json").exit_code == 1);

  const Reply script = folder.orthant("completion");
  CHECK(nlohmann::json::parse(folder.orthant("completion --json").out).at("bash") == script.out);
  folder.write("completion.bash",
               script.out +
                   "COMP_WORDS=(orthant solve --solver le) COMP_CWORD=3; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant sim) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant solve --err) COMP_CWORD=2; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(build/orthant enu) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant list s) COMP_CWORD=2; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max) COMP_CWORD=1; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max-input 8GiB sol) COMP_CWORD=3; _orthant; echo ${COMPREPLY[@]}\n"
                   "COMP_WORDS=(orthant --max-input 8GiB solve --max) COMP_CWORD=4; _orthant; echo ${COMPREPLY[@]}\n");
  CHECK(folder.run("bash completion.bash").out ==
        "lemke lemke-howson\nsimulate\n--error-bound\nenumerate\nsolvers scenes summary\n"
        "--max-input\nsolve\n--max-input\n");
  const auto completed = [&](const std::string& words) {  // at the last word
    folder.write("one.bash", script.out + "COMP_WORDS=(orthant " + words +
                                 ") COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _orthant; echo ${COMPREPLY[@]}\n");
    return folder.run("bash one.bash").out;
  };
  CHECK(completed("simulate --step 1e-3 --json benn") == "bennett\n");
  CHECK(completed("simulate --solver lemke slider_crank_s") == "slider_crank_space\n");
  CHECK(completed("--plugin mine.so check --json benn") == "bennett\n");
  CHECK(completed("--plugin mine.so --max-input 1GiB sol") == "solve\n");
  CHECK(completed("simulate --step 1e-3 bennett ben") == "\n");  // one scene
  CHECK(completed("simulate --step ben") == "\n");               // a value
  CHECK(completed("simulate --solver = lemke-h") == "lemke-howson\n");
  CHECK(completed("simulate --solver = lemke benn") == "bennett\n");
  CHECK(completed("simulate --json --integrator stew") == "stewart-trinkle\n");
  CHECK(completed("simulate bennett --solver lemke-h") == "lemke-howson\n");
  CHECK(completed("solve --json --err") == "--error-bound\n");
  CHECK(completed("view --serve 80 euler_d") == "euler_disc\n");
  CHECK(completed("view run.csv --scene euler_d") == "euler_disc\n");
  CHECK(completed("schema --json sim") == "simulate\n");
  CHECK(completed("man --json sim") == "simulate\n");
}
