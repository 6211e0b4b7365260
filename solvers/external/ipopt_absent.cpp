// In place of ipopt.cpp where the build has no Ipopt: the name stays in the table, why_not() says what is missing.
#include <orthant/solvers/external/ipopt.h>

namespace orthant {

struct IpoptSolver::Work {};

IpoptSolver::IpoptSolver(const Options& options) : options_(options) {}
IpoptSolver::~IpoptSolver() = default;

std::string IpoptSolver::why_not(const Lcp&) const {
  return "built without Ipopt: install coinor-libipopt-dev, then configure with ORTHANT_WITH_IPOPT=ON";
}
Claim IpoptSolver::minimize(const ScaledProblem&, bool, bool, Vector&) { return Claim::unsupported; }

}  // namespace orthant
