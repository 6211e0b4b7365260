// From the second problem of a size on, a solver allocates nothing: a loop over the registry.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/allocations.h"
#include "tests/support/backends.h"

using namespace orthant;

namespace {

/// Allocations while all problems are solved a third time; problems that a solver refuses do not count.
std::size_t third_round(const SolverEntry& entry, const std::vector<Lcp>& problems) {
  const auto solver = entry.make("");
  std::vector<const Lcp*> taken;
  for (const Lcp& p : problems)
    if (solver->why_not(p).empty()) taken.push_back(&p);
  Solution s;
  std::size_t before = 0;
  for (int round = 0; round < 3; ++round) {
    before = AllocationCount::now();
    for (const Lcp* p : taken) solver->solve(*p, s);
  }
  return AllocationCount::now() - before;
}

std::vector<Lcp> dense_problems() {
  Random random(16);
  std::vector<Lcp> all;
  for (int k = 0; k < 20; ++k) all.push_back(random_spd_problem(1 + k % 5, random));
  for (const Index n : {30, 64}) {
    for (int skew = 0; skew < 2; ++skew) {
      all.push_back(random_spd_problem(n, random));
      Lcp& p = all.back();
      std::get<DenseMatrix>(p.A)(0, 1) += 0.01 * skew;
      for (Index i = 0; i < n; i += 4) p.lo[i] = -kInf, p.lo[i + 1] = -0.1, p.hi[i + 1] = 0.2;
    }
    all.push_back(planted_problem(n, n / 2, n / 2, random).problem);
  }
  for (const Known& k : known_problems())
    if (k.name == "kkt" || k.name == "kkt_redundant" || k.name == "box" || k.name == "box_far_from_zero" ||
        k.name == "circulant_scaled")
      all.push_back(k.problem);
  return all;
}

std::vector<Lcp> contact_problems() {
  Random random(17);
  std::vector<Lcp> all;
  for (int k = 0; k < 20; ++k) all.push_back(random_contact_problem(1 + k % 3, 6, 0.5, random));
  for (int k = 0; k < 4; ++k) all.push_back(stewart_trinkle_problem(1 + k, 0.5, 10, random));
  return all;
}

struct Exception {
  std::string_view solver, storage, why;
};
constexpr Exception kExceptions[] = {
    {"enumerate", "dense", "rationals"},
    {"enumerate", "sparse", "rationals"},
    {"enumerate", "contacts", "rationals"},
    {"lemke-howson", "games", "tableaux built anew for every label"},
    {"block-pivot", "sparse", "blocks cut out and factorized as Eigen's sparse matrices"},
    {"newton-min", "sparse", "the same"},
    {"newton-fb", "sparse", "the same, and the Jacobian"},
    {"interior-point", "sparse", "blocks cut out and factorized as Eigen's sparse matrices"},
    {"admm", "sparse", "factors of CHOLMOD and UMFPACK"},
    {"admm", "contacts", "its inner matrix"},
    {"ipopt", "dense", "Ipopt's own"},
    {"ipopt", "sparse", "Ipopt's own"},
    {"ipopt", "contacts", "Ipopt's own"},
    {"nlopt", "sparse", "the polish: blocks as of block-pivot"},
    {"newton-ac", "contacts", "the scaled form of each problem, its blocks"},
    {"prox", "contacts", "the same"},
};

}  // namespace

TEST_CASE("solvers allocate nothing from the second problem of a size on, but for named exceptions") {
  std::vector<Lcp> games, sparse;
  for (const Known& k : known_problems())
    if (k.name == "bimatrix" || k.name == "rock_paper_scissors") games.push_back(k.problem);
  for (const Lcp& p : dense_problems()) sparse.push_back(as_sparse(p));
  const std::pair<std::string_view, std::vector<Lcp>> all[] = {
      {"dense", dense_problems()}, {"sparse", sparse}, {"contacts", contact_problems()}, {"games", games}};
  for (const SolverEntry& entry : solvers())
    for (const auto& [storage, problems] : all) {
      if (!built(entry.name)) continue;
      if (storage == "games" && entry.name != "lemke-howson") continue;  // where others look for proofs, in rationals
      const auto* const exception = std::find_if(std::begin(kExceptions), std::end(kExceptions), [&](const auto& e) {
        return e.solver == entry.name && e.storage == storage;
      });
      if (exception != std::end(kExceptions) && entry.name == "enumerate") continue;  // slow, too
      INFO(entry.name, ", ", storage);
      CHECK((third_round(entry, problems) > 0) == (exception != std::end(kExceptions)));
    }
  const std::size_t before = AllocationCount::now();
  const auto reminder = std::make_unique<int>(1);
  CHECK(AllocationCount::now() > before);  // it does count
}
