// core/lcp/problems/families.h — problem families for comparing solvers, each with its known properties.
//
//   A family makes a problem from a size, a hardness (condition, mass ratio, spread of units, …: see its family)
//   and a seed, the same on every machine. Its matrix class and its kind of answer say what may be expected of a
//   solver:
//   the class is what the construction guarantees up to the rounding of the entries.
//   Sources: collection.h, obstacles.h, contact_piles.h, american_put.h, and the names given.
#pragma once

#include <orthant/core/lcp/problems/collection.h>

#include <string_view>

namespace orthant {

struct Family {
  std::string_view name;           // one word
  std::string_view about;          // what it is and what it breaks
  std::string_view matrix;         // its class: "SPD", "PSD", "K", "P", "copositive", …
  Answer answer;                   // of all its problems
  std::string_view hardness_name;  // empty: there is none
  std::vector<double> hardness;    // rising; one entry, 0, where there is none
  std::vector<Index> sizes;        // rising; the first are quick
  Known (*make)(Index size, double hardness, std::uint64_t seed);  // z empty where it is not known
};

/// All of them. A size is the number of rows, or near it.
const std::vector<Family>& families();

/// The family of a name, or nullptr.
const Family* find_family(std::string_view name);

}  // namespace orthant
