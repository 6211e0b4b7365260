// Solvers share nothing: in several threads at once each gives the bits that it gives alone.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <thread>

using namespace orthant;

namespace {

/// Statuses and all bits of all solutions, one text.
std::string answers(int thread) {
  std::string bits;
  for (const SolverEntry& entry : solvers()) {
    const auto solver = make_solver(entry.name);
    Solution s;
    for (const Known& known : known_problems()) {
      if (known.problem.size() > 12 || !solver->why_not(known.problem).empty()) continue;
      if (entry.name == "ipopt" && thread >= 0) continue;  // MUMPS and MPI stubs are not for several threads
      solver->solve(known.problem, s);
      if (entry.name == "ipopt") continue;
      bits += std::string(name(s.status)) + ' ';
      bits.append(reinterpret_cast<const char*>(s.z.data()), static_cast<std::size_t>(s.z.size()) * sizeof(double));
    }
  }
  return bits;
}

}  // namespace

TEST_CASE("in 2 and in 8 threads at once every solver gives the bits that it gives alone") {
  const std::string alone = answers(0);
  CHECK(alone.size() > 10000);
  for (const int threads : {2, 8}) {
    std::vector<std::string> found(static_cast<std::size_t>(threads));
    {
      std::vector<std::jthread> running;
      for (int i = 0; i < threads; ++i)
        running.emplace_back([&found, i] { found[static_cast<std::size_t>(i)] = answers(i); });
    }
    for (const std::string& each : found) CHECK((each == alone));
  }
}
