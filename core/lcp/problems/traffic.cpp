#include <orthant/core/lcp/problems/traffic.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace orthant {
namespace {

void check(const TrafficNetwork& network) {
  const auto place = [&](Index node, const char* what, std::size_t i) {
    if (node < 0 || node >= network.nodes)
      throw std::invalid_argument("traffic network: " + std::string(what) + " " + std::to_string(i) + " names node " +
                                  std::to_string(node) + ": must be from 0 to " + std::to_string(network.nodes - 1));
  };
  for (std::size_t i = 0; i < network.arcs.size(); ++i) {
    const auto& arc = network.arcs[i];
    place(arc.tail, "arc", i), place(arc.head, "arc", i);
    if (!(arc.time >= 0) || !(arc.congestion >= 0) || arc.tail == arc.head)
      throw std::invalid_argument("traffic network: arc " + std::to_string(i) +
                                  ": must have two ends, time >= 0 and congestion >= 0");
  }
  for (std::size_t i = 0; i < network.trips.size(); ++i) {
    const auto& trip = network.trips[i];
    place(trip.from, "trips", i), place(trip.to, "trips", i);
    if (!(trip.demand > 0) || trip.from == trip.to)
      throw std::invalid_argument("traffic network: trips " + std::to_string(i) +
                                  ": must have two ends and a demand > 0");
  }
}

Index arcs_of(const TrafficNetwork& network) { return static_cast<Index>(network.arcs.size()); }

/// Row of π among those of the destination's nodes; -1: the destination itself.
Index row_among(Index node, Index destination) {
  if (node == destination) return -1;
  return node < destination ? node : node - 1;
}

}  // namespace

std::vector<Index> TrafficNetwork::destinations() const {
  std::vector<Index> all;
  for (const Trips& trip : trips) all.push_back(trip.to);
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

Index TrafficNetwork::size() const { return static_cast<Index>(destinations().size()) * (arcs_of(*this) + nodes - 1); }

Vector TrafficNetwork::flows(const Vector& z) const {
  const Index m = arcs_of(*this), block = m + nodes - 1;
  Vector f = Vector::Zero(m);
  for (Index first = 0; first < z.size(); first += block) f += z.segment(first, m);
  return f;
}

Vector TrafficNetwork::times(const Vector& z) const {
  Vector t = flows(z);
  for (Index a = 0; a < t.size(); ++a) {
    const Arc& arc = arcs[static_cast<std::size_t>(a)];
    t[a] = arc.time + arc.congestion * t[a];
  }
  return t;
}

double TrafficNetwork::time_to(const Vector& z, Index node, std::size_t destination) const {
  const Index to = destinations()[destination], place = row_among(node, to);
  const Index m = arcs_of(*this);
  return place < 0 ? 0 : z[static_cast<Index>(destination) * (m + nodes - 1) + m + place];
}

Lcp traffic_equilibrium(const TrafficNetwork& network) {
  check(network);
  const std::vector<Index> destinations = network.destinations();
  const Index m = arcs_of(network), block = m + network.nodes - 1;
  std::vector<std::vector<Index>> leaving(static_cast<std::size_t>(network.nodes)), entering = leaving;
  for (Index a = 0; a < m; ++a) {
    const auto& arc = network.arcs[static_cast<std::size_t>(a)];
    leaving[static_cast<std::size_t>(arc.tail)].push_back(a);
    entering[static_cast<std::size_t>(arc.head)].push_back(a);
  }
  const Index n = static_cast<Index>(destinations.size()) * block;
  std::vector<Eigen::Triplet<double>> entries;
  Vector q = Vector::Zero(n);
  for (std::size_t s = 0; s < destinations.size(); ++s) {
    const Index first = static_cast<Index>(s) * block, to = destinations[s];
    for (Index a = 0; a < m; ++a) {
      const auto& arc = network.arcs[static_cast<std::size_t>(a)];
      q[first + a] = arc.time;
      if (arc.congestion > 0)
        for (Index other = a; other < n; other += block) entries.emplace_back(first + a, other, arc.congestion);
      if (const Index head = row_among(arc.head, to); head >= 0) entries.emplace_back(first + a, first + m + head, 1);
      if (const Index tail = row_among(arc.tail, to); tail >= 0) entries.emplace_back(first + a, first + m + tail, -1);
    }
    for (Index node = 0; node < network.nodes; ++node) {
      const Index place = row_among(node, to);
      if (place < 0) continue;
      const auto i = static_cast<std::size_t>(node);
      for (const Index a : leaving[i]) entries.emplace_back(first + m + place, first + a, 1);
      for (const Index a : entering[i]) entries.emplace_back(first + m + place, first + a, -1);
    }
    for (const auto& trip : network.trips)
      if (trip.to == to) q[first + m + row_among(trip.from, to)] -= trip.demand;
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

TrafficNetwork braess_network(bool bridge) {
  TrafficNetwork network{4, {{0, 1, 0, 10}, {0, 2, 50, 1}, {1, 3, 50, 1}, {2, 3, 0, 10}}, {{0, 3, 6}}};
  if (bridge) network.arcs.push_back({1, 2, 10, 1});
  return network;
}

TrafficNetwork grid_city(Index side) {
  if (side < 3) throw std::invalid_argument("grid_city: side = " + std::to_string(side) + ": must be at least 3");
  TrafficNetwork network{side * side, {}, {}};
  const auto street = [&](Index one, Index other) {
    const double length = 1 + static_cast<double>((7 * one + 3 * other) % 11) / 11;
    network.arcs.push_back({one, other, length, 0.05 * length}),
        network.arcs.push_back({other, one, length, 0.05 * length});
  };
  for (Index j = 0; j < side; ++j)
    for (Index i = 0; i < side; ++i) {
      const Index node = j * side + i;
      if (i + 1 < side) street(node, node + 1);
      if (j + 1 < side) street(node, node + side);
    }
  for (const Index to : {Index{0}, side - 1, side * side / 2, side * (side - 1), side * side - 1})
    for (Index from = 0; from < side * side; ++from)
      if (from != to) network.trips.push_back({from, to, 1});
  return network;
}

}  // namespace orthant
