#include <orthant/core/support/factorization_cost.h>

#include <amd.h>

#include <limits>
#include <vector>

namespace orthant {

double factorization_cost(int n, const int* start, const int* index) {
  if (n == 0 || start[n] == 0) return 0;  // amd_order refuses a pattern without entries
  std::vector<int> order(static_cast<std::size_t>(n));
  double info[AMD_INFO];
  if (amd_order(n, start, index, order.data(), nullptr, info) < 0) return std::numeric_limits<double>::infinity();
  return info[AMD_NDIV] + 2 * info[AMD_NMULTSUBS_LU];
}

}  // namespace orthant
