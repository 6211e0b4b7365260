// experiments/studies/motion_storm/tally.h — counts of results by kind of scene and integrator, faults; tables.
#pragma once

#include "experiments/studies/motion_storm/judge.h"

#include <cstdint>
#include <map>

namespace orthant::motion_storm {

struct Fault {
  std::uint64_t k = 0;  // the scene's number
  std::string kind, integrator, what, why;
};

struct Tally {
  using Counts = std::array<long, kResults.size()>;
  std::map<std::pair<std::string, std::string>, Counts> rows;  // by kind and integrator
  std::vector<Fault> faults;

  void count(const std::string& kind, const std::string& integrator, Result result);
  void add(const Tally& other);
};

/// Scenes first … first + count − 1 of a seed. A crash or an endless loop ends this process: the caller isolates.
template <class Space = Planar> Tally storm(std::uint64_t seed, std::uint64_t first, std::uint64_t count,
                                            const std::vector<std::string>& integrators, const Limits& limits);

std::string to_text(const Tally& tally);
Tally tally_from_text(const std::string& text);

std::string csv(const Tally& tally);
/// Result × integrator, then fault × kind of scene, as Markdown.
std::string tables(const Tally& tally, std::uint64_t scenes);
/// Both tables, the choices and the faults.
std::string json(const Tally& tally, std::uint64_t scenes, std::uint64_t seed);

}  // namespace orthant::motion_storm
