// The tests of distributed problems: every rank runs all of them, as mpirun -n 1, 2, 3 distributed_tests.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <orthant/solvers/distributed/petsc_objects.h>

int main(int argc, char** argv) {
  orthant::distributed::start_petsc();
  return doctest::Context(argc, argv).run();
}
