// Outputs of a run: events, standard output, Ctrl-C, the progress line, problems of failed steps, help texts.
#include "experiments/support/help_text.h"
#include "tests/support/cli.h"

#include <H5Cpp.h>
#include <doctest/doctest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using orthant::Cli, orthant::Folder, orthant::Reply, orthant::lines, orthant::slurp;

namespace {

/// A ball that falls 0.9 m and bounces with e = 0.5; it hits at t = sqrt(1.8 / 9.81).
const char* const kDroppedBall =
    "gravity = [0, -9.81]\nduration = 0.6\nstep = 0.1\n"
    "[[body]]\nname = 'ball'\nmass = 2\ninertia = 0.01\nposition = [0, 1]\n"
    "[[contact]]\ntype = 'disc-wall'\nname = 'floor'\nbody = 'ball'\nradius = 0.1\ne_n = 0.5\n"
    "wall = {normal = [0, 1]}\n";

/// What a program prints on a terminal of so many columns.
std::string on_terminal(const std::string& command, unsigned short columns) {
  winsize size{};
  size.ws_row = 24, size.ws_col = columns;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string said;
  char bytes[4096];
  for (ssize_t n = 0; (n = read(terminal, bytes, sizeof bytes)) > 0;) said.append(bytes, static_cast<std::size_t>(n));
  waitpid(child, nullptr, 0);
  close(terminal);
  return said;
}

}  // namespace

TEST_CASE("events of a run are in the table next to it, in HDF5 and in JSON, with time, kind, contact, impulse") {
  const Cli folder;
  folder.write("ball.toml", kDroppedBall);
  const double impact = std::sqrt(1.8 / 9.81), impulse = 2 * 1.5 * 9.81 * impact;
  for (const std::string integrator : {"event-driven", "adaptive:rtol=1e-9"}) {
    CAPTURE(integrator);
    const Reply a = folder.orthant("simulate ball.toml --integrator " + integrator + " --output run.csv --json");
    REQUIRE(a.exit_code == 0);
    std::istringstream table(slurp(folder / "run.events.csv"));
    std::string header, row;
    std::getline(table, header), std::getline(table, row);
    CHECK(header == "t,kind,contact,impulse_n,impulse_t");
    CHECK(std::abs(std::stod(row) - impact) < 1e-8);
    CHECK(row.find(",impact,floor,") != std::string::npos);
    const auto json = nlohmann::json::parse(a.out);
    REQUIRE(json.at("event_table").size() == json.at("events").get<std::size_t>());
    const auto& first = json.at("event_table").at(0);
    CHECK(first.at("kind") == "impact");
    CHECK(first.at("contact") == "floor");
    CHECK(first.at("t").get<double>() == std::stod(row));
    CHECK(std::abs(first.at("impulse_n").get<double>() - impulse) < 1e-6);
  }
  REQUIRE(folder.orthant("simulate ball.toml --integrator event-driven --output run.h5").exit_code == 0);
  const H5::H5File h5(folder / "run.h5", H5F_ACC_RDONLY);
  double t[1] = {0};
  const H5::DataSet times = h5.openDataSet("events/t");
  REQUIRE(times.getSpace().getSimpleExtentNpoints() == 1);
  times.read(t, H5::PredType::NATIVE_DOUBLE);
  CHECK(std::abs(t[0] - impact) < 1e-9);
  // A later run without events leaves no event of the earlier one.
  REQUIRE(folder.orthant("simulate ball.toml --output run.csv").exit_code == 0);
  CHECK(slurp(folder / "run.events.csv") == "t,kind,contact,impulse_n,impulse_t\n");
  REQUIRE(folder.orthant("simulate ball.toml --output other.csv").exit_code == 0);
  CHECK(!std::filesystem::exists(folder / "other.events.csv"));
}

TEST_CASE("events survive a checkpoint") {
  const Cli folder;
  folder.write("ball.toml", kDroppedBall);
  const std::string run = "simulate ball.toml --integrator event-driven --checkpoint kept --checkpoint-every 1";
  REQUIRE(folder.orthant(run + " --output whole.csv").exit_code == 0);
  std::filesystem::remove(folder / "kept");
  REQUIRE(folder.orthant(run + " --output part.csv --time-limit 1e-6").exit_code == 3);
  REQUIRE(folder.orthant(run + " --output part.csv --resume").exit_code == 0);
  CHECK(lines(slurp(folder / "whole.events.csv")) == 2);
  CHECK(slurp(folder / "part.events.csv") == slurp(folder / "whole.events.csv"));
}

TEST_CASE("--output - writes the table to standard output, the summary to standard error") {
  const Cli folder;
  folder.write("ball.toml", kDroppedBall);
  REQUIRE(folder.orthant("simulate ball.toml --output run.csv").exit_code == 0);
  const Reply a = folder.orthant("simulate ball.toml --output - --json");
  CHECK(a.exit_code == 0);
  CHECK(a.out == slurp(folder / "run.csv"));
  CHECK(nlohmann::json::parse(a.err).at("status") == "solved");
}

TEST_CASE("Ctrl-C keeps the trajectory up to there and says where; exit code 130, of SIGTERM 143") {
  const Cli folder;
  folder.write("ball.toml", kDroppedBall);
  // The signal comes a second after the command catches signals (bit 14 of SigCgt: SIGTERM), not a second after its
  // start: a busy machine may need longer for that.
  const auto stopped = [&](const std::string& signal) {
    return folder.run("sh -c 'env --default-signal=INT \"" ORTHANT_CLI
                      "\" simulate ball.toml --step 1e-9 --every 1000 --time-limit 60 --output run.csv --json & "
                      "until grep -q \"SigCgt:.*[4-7c-f]...$\" /proc/$!/status; do sleep 0.03; done; sleep 1; kill -" +
                      signal + " $!; wait $!'");
  };
  for (const auto& [signal, code] : {std::pair{"INT", 130}, std::pair{"TERM", 143}}) {
    CAPTURE(signal);
    const Reply a = stopped(signal);
    CHECK(a.exit_code == code);
    CHECK(a.err.find(std::string("stopped by ") + (code == 130 ? "Ctrl-C" : "a signal") + " at t = ") !=
          std::string::npos);
    CHECK(a.err.find("; the trajectory up to there is in run.csv") != std::string::npos);
    const auto json = nlohmann::json::parse(a.out);
    CHECK(json.at("status") == "cancelled");
    const std::string csv = slurp(folder / "run.csv");
    CHECK(lines(csv) > 2);
    const std::string last = csv.substr(csv.rfind('\n', csv.size() - 2) + 1);
    CHECK(std::stod(last) == json.at("final").at("t").get<double>());  // the state that it reached
    CHECK(std::stod(last) > 0);
  }
}

TEST_CASE("a progress line: on a terminal, after two seconds, gone at the end") {
  const Cli folder;
  const std::string ball = folder.write("ball.toml", kDroppedBall);
  const std::string run = "'" ORTHANT_CLI "' simulate '" + ball + "' --step 1e-9 --every 1000000000 --time-limit ";
  const std::string said = on_terminal(run + "3.5", 120);
  CHECK(said.find("orthant: t = ") != std::string::npos);
  CHECK(said.find(" of 0.6 s, ") != std::string::npos);
  CHECK(said.find(" s left, 0 events") != std::string::npos);
  CHECK(said.find("\r\033[K") != std::string::npos);
  CHECK(on_terminal(run + "0.2", 120).find("orthant: t = ") == std::string::npos);
  CHECK(folder.run(run + "2.8").err.find("orthant: t = ") == std::string::npos);  // no terminal, no line
}

TEST_CASE("the problem of a failed step goes to the folder that an option names, once for the same run") {
  const Cli folder;
  const std::string run = "simulate slider_crank --solver pgs:max_sweeps=1 --step 1e-5 ";
  const auto files = [&](const char* where) {
    long count = 0;
    for (const auto& file : std::filesystem::directory_iterator(folder / where))
      count += file.path().filename().string().starts_with("failed_step_");
    return count;
  };
  CHECK(folder.orthant(run + "--failed-steps none").exit_code == 3);
  CHECK(files(".") == 0);
  for (int k = 0; k < 2; ++k) CHECK(folder.orthant(run + "--failed-steps kept/here").exit_code == 3);
  CHECK(files("kept/here") == 1);
  CHECK(files(".") == 0);
  std::filesystem::create_directory(folder / "out");
  CHECK(folder.orthant(run + "--output out/run.csv").exit_code == 3);  // by default beside the output
  CHECK(files("out") == 1);
}

TEST_CASE("help wraps to the terminal; orthant alone prints its help's first lines") {
  const Cli folder;
  const std::string help = on_terminal("'" ORTHANT_CLI "' simulate --help", 60);
  std::istringstream text(help);
  std::size_t longest = 0;
  for (std::string line; std::getline(text, line);) longest = std::max(longest, line.find_last_not_of("\r") + 1);
  CHECK(longest <= 60);
  CHECK(longest > 40);
  const Reply alone = folder.orthant("");
  CHECK(alone.exit_code == 1);
  CHECK(alone.err.find("\n  simulate") != std::string::npos);
  CHECK(alone.err.find("orthant COMMAND --help") != std::string::npos);

  const std::string option = "  --step FLOAT   step size of the run, in seconds of its time\n";
  CHECK(orthant::wrapped(option, 41) ==
        "  --step FLOAT   step size of the run, in\n                 seconds of its time\n");
  CHECK(orthant::wrapped(option, 0) == option);
  CHECK(orthant::wrapped("averyveryverylongword short\n", 10) == "averyveryverylongword\n  short\n");
}

TEST_CASE("experiments/run NAME --help sets up and builds nothing") {
  const Folder folder;  // where there is no set-up to call
  std::filesystem::create_directories(folder / "experiments/benchmarks");
  for (const char* script : {"experiments/run", "experiments/benchmarks/peers"})
    std::filesystem::copy_file(std::string(ORTHANT_ROOT "/") + script, folder / script);
  for (const std::string name :
       {"verdict_storm", "friction", "shootout", "docs", "peers", "determinism", "slider_crank"}) {
    CAPTURE(name);
    const Reply a = folder.run("experiments/run " + name + " --quick --help");
    CHECK(a.exit_code == 0);
    CHECK(a.err.empty());
    CHECK(a.out.find(name) != std::string::npos);
  }
  CHECK(folder.run("experiments/run --help").out.find("\nrun verdict_storm ") != std::string::npos);
  CHECK(folder.run("experiments/run nosuch --help").exit_code == 1);
  CHECK(folder.run("experiments/run verdict_storm").exit_code != 0);
}
