// tests/support/eigen_assert.h — Eigen's checks of sizes and indices in objects with sanitizers, which have NDEBUG.
//
//   (They have it as the tests' objects do: code in headers of other libraries must be the same in both.)
#pragma once

#include <cstdio>
#include <cstdlib>

#define eigen_assert(x) \
  ((x) ? static_cast<void>(0) : (std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #x), std::abort()))
