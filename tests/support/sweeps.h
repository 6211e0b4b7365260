// tests/support/sweeps.h — sweeps in a folder of the test's own, by the command and by processes that may be killed.
#pragma once

#include "tests/support/cli.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <spawn.h>

#include <array>
#include <sstream>
#include <string>

namespace orthant {

inline constexpr const char* kSmallSweep = R"(
question = "Does it work?"
scene = "slider_crank"
measure = "crank.theta"
reference = "exact"
[[grid]]
integrator = ["moreau-jean", "rattle"]
set = {mu = [0.01, 0.1]}
step = {from = 2e-5, to = 1e-5, count = 10, scale = "log"}
)";
inline constexpr long kCases = 40;

struct Sweeps : Cli {
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

}  // namespace orthant
