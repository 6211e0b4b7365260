// core/support/kept_memory.h — which memory stays for the next problem.
//
// A step or a solve that allocates costs time, so scratch is kept. In large problems the memory counts for more, and an
// allocation for less: there scratch is freed after use.
#pragma once

#include <orthant/core/support/reusable.h>

namespace orthant {

/// Rows (or coordinates, or contacts) up to which scratch is taken in advance and stays: some MB.
constexpr Index kKeptRows = 50000;

/// Frees the memory of containers. `x = {}` and `x.clear()` keep that of a vector.
template <class... Containers> void free_memory(Containers&... all) { ((all = Containers()), ...); }

}  // namespace orthant
