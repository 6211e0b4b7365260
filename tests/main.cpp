// The test program: every TEST_CASE of the other files, doctest's command line.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
