// The test program: every TEST_CASE of the other files, doctest's command line.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdlib>

int main(int argc, char** argv) {
  const int failed = doctest::Context(argc, argv).run();
  unsetenv("GCOV_PREFIX");  // tests/coverage: what tests start writes its counts elsewhere, this program to their place
  return failed;
}
