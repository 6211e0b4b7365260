// The tests of distributed problems: every rank runs all of them, as mpirun -n 1, 2, 3 distributed_tests. And the start
// of PETSc.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <orthant/solvers/distributed/petsc_objects.h>

#include <signal.h>

#include <array>
#include <cfenv>
#include <clocale>
#include <string>

namespace {

struct Process {  // what a library must leave as it is
  std::array<void (*)(int), 32> handlers{};
  int rounding = 0, traps = 0;
  std::string locale;
  static Process now() {
    Process p;
    for (std::size_t k = 1; k < p.handlers.size(); ++k) {
      struct sigaction action {};
      sigaction(static_cast<int>(k), nullptr, &action);
      p.handlers[k] = action.sa_handler;
    }
    p.rounding = std::fegetround();
    p.traps = fegetexcept();
    p.locale = std::setlocale(LC_ALL, nullptr);
    return p;
  }
};

Process before_start, after_start;

}  // namespace

TEST_CASE("distributed: the start of MPI and PETSc leaves signal handlers, rounding, traps and locale") {
  for (std::size_t k = 1; k < before_start.handlers.size(); ++k) {
    INFO("signal ", k);
    CHECK((before_start.handlers[k] == after_start.handlers[k]));
  }
  CHECK(before_start.rounding == after_start.rounding);
  CHECK(before_start.traps == after_start.traps);
  CHECK(before_start.locale == after_start.locale);
}

int main(int argc, char** argv) {
  before_start = Process::now();
  orthant::distributed::start_petsc();
  after_start = Process::now();
  return doctest::Context(argc, argv).run();
}
