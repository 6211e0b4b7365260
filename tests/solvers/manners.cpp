// The library is a guest in its host's process: it never ends it, prints nothing, and leaves rounding, floating-point
// exceptions, locale and signal handlers as they were.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>

#include "tests/support/folder.h"

using namespace orthant;

namespace {

/// All that a host may have set and would miss.
struct HostState {
  int rounding = std::fegetround();
  std::string locale = std::setlocale(LC_ALL, nullptr);
  unsigned flush = 0;  // how denormals are treated, which exceptions trap
  std::string handlers;

  HostState() {
    std::fenv_t environment;
    std::fegetenv(&environment);
#ifdef __x86_64__
    flush = environment.__mxcsr & ~0x3fU;  // without the flags of what happened
#endif
    for (int number = 1; number < 32; ++number) {
      struct sigaction action {};
      sigaction(number, nullptr, &action);
      handlers += std::to_string(reinterpret_cast<std::uintptr_t>(action.sa_handler)) + ' ';
    }
  }
  bool operator==(const HostState&) const = default;
};

/// What goes to stdout and stderr meanwhile, by whoever.
template <class Work> std::string printed(const Folder& folder, const Work& work) {
  const std::string file = folder / "printed.txt";
  std::fflush(stdout), std::fflush(stderr);
  const int out = dup(1), err = dup(2);
  std::FILE* target = std::fopen(file.c_str(), "w");
  dup2(fileno(target), 1), dup2(fileno(target), 2);
  work();
  std::fflush(stdout), std::fflush(stderr);
  dup2(out, 1), dup2(err, 2);
  close(out), close(err), std::fclose(target);
  return slurp(file);
}

}  // namespace

TEST_CASE("no solver prints, or changes rounding, denormals, traps, locale or signal handlers") {
  const Folder folder;
  for (const int rounding : {FE_TONEAREST, FE_UPWARD}) {
    std::fesetround(rounding);
    const HostState before;
    std::set<std::string> guilty;
    const std::string words = printed(folder, [&] {
      for (const SolverEntry& entry : solvers()) {
        const auto solver = make_solver(entry.name);
        Solution s;
        for (const Known& known : known_problems())
          if (known.problem.size() <= 4 && solver->why_not(known.problem).empty()) solver->solve(known.problem, s);
        if (!(HostState() == before)) guilty.insert(std::string(entry.name));
      }
    });
    std::fesetround(FE_TONEAREST);
    CHECK(words.empty());
    for (const std::string& name : guilty) FAIL_CHECK(name, " changed the host's state");
  }
}

TEST_CASE("the libraries call nothing that ends the process, prints, or sets its state") {
  const Folder folder;
  const Reply symbols = folder.run("nm -u " ORTHANT_LIBRARIES);
  REQUIRE(symbols.exit_code == 0);
  const std::set<std::string> forbidden{"exit",          "_exit",          "_Exit",
                                        "quick_exit",    "printf",         "__printf_chk",
                                        "puts",          "putchar",        "fprintf",
                                        "__fprintf_chk", "setlocale",      "fesetround",
                                        "fesetenv",      "feenableexcept", "signal",
                                        "sigaction",     "rand",           "srand",
                                        "system",        "popen",          "fork",
                                        "execv",         "execve",         "_ZSt4cout",
                                        "_ZSt4cerr",     "_ZSt4clog",      "_ZNSt6locale6globalERKS_"};
  std::istringstream in(symbols.out);
  long seen = 0;
  for (std::string word; in >> word;) {
    ++seen;
    if (const auto at = word.find('@'); at != std::string::npos) word.resize(at);
    if (forbidden.contains(word)) FAIL_CHECK("the libraries use ", word);
  }
  CHECK(seen > 1000);
}
