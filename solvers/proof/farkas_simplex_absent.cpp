// In place of farkas_simplex.cpp where the build has no CLP (ORTHANT_WITH_CLP=OFF).
#include <orthant/solvers/proof/farkas_simplex.h>

namespace orthant {

bool has_simplex() { return false; }
bool propose_by_simplex(const Lcp&, const Budget&, Vector&) { return false; }

}  // namespace orthant
