// Traffic equilibria: Braess's paradox; every trip of a city takes a shortest way.
#include <orthant/core/lcp/problems/traffic.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <stdexcept>

using namespace orthant;

namespace {

Vector equilibrium(const TrafficNetwork& network, const char* solver) {
  const auto method = make_solver(solver);
  Solution s;
  REQUIRE(method->solve(traffic_equilibrium(network), s).status == Status::solved);
  return s.z;
}

/// Times of the shortest ways to a node, by relaxation of all arcs until nothing changes.
Vector shortest(const TrafficNetwork& network, const Vector& times, Index to) {
  Vector far = Vector::Constant(network.nodes, kInf);
  far[to] = 0;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t a = 0; a < network.arcs.size(); ++a) {
      const auto& arc = network.arcs[a];
      const double way = far[arc.head] + times[static_cast<Index>(a)];
      if (way < far[arc.tail] * (1 - 1e-14)) far[arc.tail] = way, again = true;
    }
  }
  return far;
}

}  // namespace

TEST_CASE("Braess: a bridge makes every trip longer, 92 for 83, by every solver that takes the problem") {
  for (const char* solver : {"auto", "lemke", "path", "interior-point"})
    for (const bool bridge : {false, true}) {
      CAPTURE(solver);
      const TrafficNetwork network = braess_network(bridge);
      const Vector z = equilibrium(network, solver), f = network.flows(z);
      CHECK(network.time_to(z, 0, 0) == doctest::Approx(bridge ? 92 : 83).epsilon(1e-9));
      CHECK(f[0] == doctest::Approx(bridge ? 4 : 3).epsilon(1e-9));
      if (bridge) CHECK(f[4] == doctest::Approx(2).epsilon(1e-8));
      CHECK(network.time_to(z, 3, 0) == 0);
    }
}

TEST_CASE("a city's trips: all arrive, all take shortest ways") {
  const TrafficNetwork city = grid_city(6);
  const Vector z = equilibrium(city, "auto"), f = city.flows(z), t = city.times(z);
  CHECK(z.minCoeff() >= -1e-9);
  double spent = f.dot(t), owed = 0;
  const auto destinations = city.destinations();
  for (std::size_t s = 0; s < destinations.size(); ++s) {
    const Vector far = shortest(city, t, destinations[s]);
    for (Index node = 0; node < city.nodes; ++node)
      CHECK(city.time_to(z, node, s) == doctest::Approx(far[node]).epsilon(1e-7));
  }
  for (const auto& trip : city.trips) {
    const auto s = static_cast<std::size_t>(std::ranges::find(destinations, trip.to) - destinations.begin());
    owed += trip.demand * city.time_to(z, trip.from, s);
  }
  CHECK(spent == doctest::Approx(owed).epsilon(1e-9));
  CHECK(std::ranges::any_of(city.arcs, [&](const auto& arc) {  // congested
    return t[&arc - city.arcs.data()] > 1.5 * arc.time;
  }));
}

TEST_CASE("traffic networks: what they refuse, in words") {
  TrafficNetwork network = braess_network(true);
  network.arcs[1].head = 9;
  CHECK_THROWS_WITH_AS(traffic_equilibrium(network), doctest::Contains("arc 1 names node 9"), std::invalid_argument);
  network = braess_network(true), network.trips[0].demand = 0;
  CHECK_THROWS_WITH_AS(traffic_equilibrium(network), doctest::Contains("demand > 0"), std::invalid_argument);
  CHECK_THROWS_AS(grid_city(2), std::invalid_argument);
}
