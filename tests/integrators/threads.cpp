// The states of every scene by every integrator: the same bits again, in 2 and in 8 threads at once, and as pinned.
#include "experiments/support/fingerprint.h"

#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

using namespace orthant;

namespace {

constexpr long kStepsHere = 10;

/// Every scene and integrator with Lemke's method, by Moreau-Jean with two other solvers, too.
std::vector<Fingerprint> share_of_all() {
  std::vector<Fingerprint> all = all_fingerprints();
  std::erase_if(all, [](const Fingerprint& f) {
    return f.solver != "lemke" && !(f.integrator == "moreau-jean" && (f.solver == "auto" || f.solver == "pgs"));
  });
  return all;
}

/// Every scene in space and integrator with solver auto, without the four scenes whose steps take longest.
std::vector<Fingerprint> share_in_space() {
  std::vector<Fingerprint> all = all_spatial_fingerprints();
  std::erase_if(all, [](const Fingerprint& f) {
    return f.solver != "auto" || f.scene == "kapla_tower" || f.scene == "card_house" || f.scene == "box_pyramid" ||
           f.scene == "spheres";
  });
  return all;
}

using Share = std::vector<Fingerprint> (*)();

void same_bits(Share share, long steps, const std::string& pins, std::size_t rows) {
  auto alone = share();
  take(alone, steps, kInf, 1);
  const auto solved = std::count_if(alone.begin(), alone.end(), [](const Fingerprint& f) { return f.hash[0] != 0; });
  MESSAGE(alone.size(), " runs, ", solved, " solved");
  CHECK(solved > static_cast<long>(alone.size() / 2));
  for (const int threads : {2, 8}) {
    auto together = share();
    take(together, steps, kInf, threads);
    for (std::size_t k = 0; k < alone.size(); ++k) CHECK(together[k].row() == alone[k].row());
  }
  std::string build;
  const auto table = read_fingerprints(ORTHANT_TEST_DATA "/" + pins, build);
  CHECK(table.size() == rows);
  if (build != build_of_bits()) {
    MESSAGE("the table is of another build: ", build);
    return;
  }
  std::map<std::string, const Fingerprint*> pinned;
  for (const Fingerprint& f : table) pinned[f.scene + ',' + f.integrator + ',' + f.solver] = &f;
  for (const Fingerprint& f : alone) {
    const auto found = pinned.find(f.scene + ',' + f.integrator + ',' + f.solver);
    REQUIRE(found != pinned.end());
    INFO(f.row(), " and pinned: ", found->second->row());
    CHECK_FALSE(differ(f, *found->second));
  }
}

}  // namespace

TEST_CASE("every scene by every integrator: the same bits in 1, 2 and 8 threads, those of the table in its own build") {
  same_bits(&share_of_all, kStepsHere, "determinism.csv", all_fingerprints().size());
}

TEST_CASE("every scene in space: the same bits in 1, 2 and 8 threads, those of the table in its own build") {
  same_bits(&share_in_space, kStepsHere, "determinism_space.csv", all_spatial_fingerprints().size());
}
