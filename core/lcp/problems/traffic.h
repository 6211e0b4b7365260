// core/lcp/problems/traffic.h — traffic equilibrium (Wardrop): every trip takes a shortest way, given what all take.
//
//   Arc a takes t_a + c_a f_a where f_a trips use it. With x_a^s the trips on it that go to destination s, f_a the sum
//   of x_a^s over s, and π_i^s the time from node i to s (π_s^s = 0):
//     0 ≤ x_a^s ⊥ t_a + c_a f_a + π_head^s − π_tail^s ≥ 0        used arcs are on shortest ways
//     0 ≤ π_i^s ⊥ Σ_out x^s − Σ_in x^s − d_i^s ≥ 0              all trips d leave their node
//   M is sparse, unsymmetric, positive semidefinite and singular: times π and arc flows f are unique where c > 0, flows
//   by destination are not.
//   Source: Ferris, Meeraus & Rutherford, Computing Wardropian equilibria in a complementarity framework, Optimization
//   Methods and Software 10 (1999) 669-685; Braess, Unternehmensforschung 12 (1968) 258-268 (the paradox).
#pragma once

#include <orthant/core/lcp/problem.h>

#include <vector>

namespace orthant {

struct TrafficNetwork {
  struct Arc {
    Index tail = 0, head = 0;
    double time = 0, congestion = 0;  // t ≥ 0 [s]; c ≥ 0 [s per trip]
  };
  struct Trips {
    Index from = 0, to = 0;
    double demand = 0;  // > 0
  };
  Index nodes = 0;
  std::vector<Arc> arcs;
  std::vector<Trips> trips;

  std::vector<Index> destinations() const;  // in rising order
  Index size() const;                       // rows of the problem
  Vector flows(const Vector& z) const;      // f, one an arc
  Vector times(const Vector& z) const;      // t + c f
  /// π of a node, to the destination with this place in destinations().
  double time_to(const Vector& z, Index node, std::size_t destination) const;
};

/// Rows: destination by destination, first x of its arcs, then π of its nodes without itself.
Lcp traffic_equilibrium(const TrafficNetwork& network);

/// Six trips from node 0 to node 3 by two ways of two arcs each, and a bridge between them: all trips take 92 with the
/// bridge and 83 without it.
TrafficNetwork braess_network(bool bridge);

/// A city of side × side crossings, streets in both directions, of different lengths. One trip from each crossing to
/// each of the four corners and to the middle.
TrafficNetwork grid_city(Index side);

}  // namespace orthant
