// tests/support/allocations.h — allocation counter of this program, to show that hot loops make none.
//
// operator new is replaced, and calls of malloc and its kin (Eigen's containers make them) are wrapped by the linker;
// what shared libraries allocate for themselves is not seen.
#pragma once

#include <cstddef>

namespace orthant {

struct AllocationCount {
  static std::size_t now();
};

}  // namespace orthant
