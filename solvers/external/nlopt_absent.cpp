// In place of nlopt.cpp where the build has no NLopt: the name stays in the table, why_not() says what is missing.
#include <orthant/solvers/external/nlopt.h>

namespace orthant {

std::string NloptSolver::why_not(const Lcp&) const {
  return "built without NLopt: install libnlopt-dev, then configure with ORTHANT_WITH_NLOPT=ON";
}
Claim NloptSolver::minimize(const ScaledProblem&, bool, bool, Vector&) { return Claim::unsupported; }

}  // namespace orthant
