// tests/support/backends.h — some builds lack the library that a solver is made of.
#pragma once

#include <orthant/solvers/registry.h>

namespace orthant {

/// Whether this build has what the solver needs.
inline bool built(std::string_view solver) {
  const Lcp none = Lcp::standard(DenseMatrix(), Vector());
  return make_solver(solver)->why_not(none).find("built without") == std::string::npos;
}

}  // namespace orthant
