// Disjoint sets against a table of connections; the hash against published values.
#include <orthant/core/support/disjoint_sets.h>
#include <orthant/core/support/hash.h>

#include <doctest/doctest.h>

using namespace orthant;

TEST_CASE("disjoint sets: every element's set is the component of a graph, named by its least element") {
  constexpr int kSize = 40;
  DisjointSets sets(kSize);
  std::vector<int> label(kSize);
  std::iota(label.begin(), label.end(), 0);
  for (int k = 0; k < 30; ++k) {
    const int a = (17 * k + 5) % kSize, b = (23 * k * k + 11) % kSize;
    sets.join(a, b);
    const int low = std::min(label[static_cast<std::size_t>(a)], label[static_cast<std::size_t>(b)]);
    const int high = std::max(label[static_cast<std::size_t>(a)], label[static_cast<std::size_t>(b)]);
    for (int& each : label)
      if (each == high) each = low;
    for (int i = 0; i < kSize; ++i) CHECK(sets.find(i) == label[static_cast<std::size_t>(i)]);
  }
  CHECK(sets.first() == label);
  DisjointSets others(kSize);
  others.assign(sets.first());
  others.join(0, kSize - 1);
  CHECK(others.find(kSize - 1) == 0);
  CHECK(sets.find(kSize - 1) == label.back());
}

TEST_CASE("FNV-1a has the published values, and goes on from a part") {
  CHECK(fnv1a("") == 0xcbf29ce484222325U);
  CHECK(fnv1a("a") == 0xaf63dc4c8601ec8cU);
  CHECK(fnv1a("foobar") == 0x85944171f73967e8U);
  CHECK(fnv1a("bar", fnv1a("foo")) == fnv1a("foobar"));
}
