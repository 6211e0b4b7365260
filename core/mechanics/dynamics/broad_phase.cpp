#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace orthant {
namespace {

constexpr double kLarge = 100;   // cells of a shape
constexpr double kSlack = 1e-9;  // of a box: rounding

bool is_round(const Shape& s) { return s.corners.empty(); }
bool is_round(const spatial::Shape& s) { return s.sphere(); }
/// By how much the shape is larger than the hull of its points.
double grown_by(const Shape& s) { return s.corners.empty() ? s.radius : 0; }
double grown_by(const spatial::Shape& s) { return s.radius; }
/// Points of a shape. The shape is their hull, grown by grown_by().
std::span<const Vector2d> points_of(const Shape& s) {
  if (s.corners.empty()) return {&s.centre, 1};
  return s.corners;
}
std::span<const Vector3d> points_of(const spatial::Shape& s) { return s.corners; }

template <class Shape> double radius_about_body(const Shape& s) {
  double most = 0;
  for (const auto& point : points_of(s)) most = std::max(most, point.norm());
  return most + grown_by(s);
}

std::pair<BodyId, BodyId> in_order(BodyId a, BodyId b) { return {std::min(a, b), std::max(a, b)}; }

/// Bodies of the collision that do not meet, each pair once, sorted.
template <class Collision> std::vector<std::pair<BodyId, BodyId>> kept_apart(const Collision& c) {
  std::vector<std::pair<BodyId, BodyId>> all;
  if constexpr (requires { c.apart; }) {
    for (const auto& [a, b] : c.apart) all.push_back(in_order(a, b));
    std::sort(all.begin(), all.end());
  }
  return all;
}

std::int64_t cell_of(double x, double width) {
  const double cell = std::floor(x / width);
  return static_cast<std::int64_t>(cell > -0x1p50 ? std::min(cell, 0x1p50) : -0x1p50);  // of no number too
}

}  // namespace

template <class Space> BroadPhaseOf<Space>::BroadPhaseOf(const SystemOf<Space>& system) : system_(system) {
  std::size_t most = 0;
  for (const auto& c : system.scene().collisions) {
    apart_.push_back(kept_apart(c));
    auto& radius = radius_.emplace_back();
    for (const auto& s : c.shapes) radius.push_back(radius_about_body(s));
    most = std::max(most, c.shapes.size());
  }
  boxes_.reserve(most), widths_.reserve(most), cells_.reserve(most), large_.reserve(most), near_.reserve(most);
  seen_.reserve(most), member_.reserve(16 * most);
  start_.resize(any() ? std::bit_ceil(4 * most) + 1 : 1);
}

template <class Space> bool BroadPhaseOf<Space>::find(const Eigen::VectorXd& way, TermsOf<Space>& terms, Reach reach) {
  std::fill(terms.pairs.begin(), terms.pairs.end(), Pair{});
  for (int c = 0; c < static_cast<int>(radius_.size()); ++c) {
    set_boxes(c, terms.at, way, reach);
    sort_into_cells();
    if (!find(c, terms)) return false;
  }
  return true;
}

template <class Space> void BroadPhaseOf<Space>::set_boxes(int collision, const KinematicsOf<Space>& at,
                                                           const Eigen::VectorXd& way, Reach reach) {
  const auto c = static_cast<std::size_t>(collision);
  const auto& shapes = system_.scene().collisions[c].shapes;
  boxes_.clear(), widths_.clear();
  double farthest = 0;
  const auto travel = [&](std::size_t i) {
    const BodyId body = shapes[i].body;
    if (body < 0) return 0.0;
    if constexpr (kPlanar<Space>)
      return std::hypot(way[kBlock * body], way[kBlock * body + 1]) + radius_[c][i] * std::abs(rotation(way, body));
    else
      return translation<Space>(way, body).norm() + radius_[c][i] * rotation<Space>(way, body).norm();
  };
  for (std::size_t i = 0; reach == Reach::farthest && i < shapes.size(); ++i) farthest = std::max(farthest, travel(i));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto& s = shapes[i];
    const auto& pose = at.at(s.body);
    const auto points = points_of(s);
    typename Space::Vector low = pose.x + pose.turn(points[0]), high = low;
    for (const auto& point : points.subspan(1)) {
      const typename Space::Vector p = pose.x + pose.turn(point);
      low = low.cwiseMin(p), high = high.cwiseMax(p);
    }
    const double grow = std::max(farthest, travel(i)) + grown_by(s) + kSlack * radius_[c][i];
    boxes_.push_back({s.body, is_round(s), low.array() - grow, high.array() + grow});
    widths_.push_back((high - low).maxCoeff() + 2 * grow);
  }
}

template <class Space> bool BroadPhaseOf<Space>::find(int collision, TermsOf<Space>& terms) {
  const auto c = static_cast<std::size_t>(collision);
  const auto& of = system_.scene().collisions[c];
  auto next = static_cast<std::size_t>(system_.pairs()[c]);
  const auto end = static_cast<std::size_t>(system_.pairs()[c + 1]);
  bool fits = true;
  for (int i = 0; fits && i < static_cast<int>(boxes_.size()); ++i) {
    meet(i, collision);
    for (const int j : near_)
      each_point(of, {collision, i, j, 0}, [&](const Pair& pair) {
        fits = next < end;
        if (fits) terms.pairs[next++] = pair;
      });
  }
  if (!fits)
    why_ = "collision \"" + of.name +
           "\": more pairs are near each other than neighbours = " + detail::text_of(of.neighbours) +
           " a shape leave room for: must be larger, or the step smaller";
  return fits;
}

template <class Space> template <class What> void BroadPhaseOf<Space>::each_cell(const Cells& cells, What&& what) {
  const auto& [low, high] = cells;
  if constexpr (kPlanar<Space>) {
    for (auto x = low[0]; x <= high[0]; ++x)
      for (auto y = low[1]; y <= high[1]; ++y) what({x, y});
  } else {
    for (auto x = low[0]; x <= high[0]; ++x)
      for (auto y = low[1]; y <= high[1]; ++y)
        for (auto z = low[2]; z <= high[2]; ++z) what({x, y, z});
  }
}

template <class Space> void BroadPhaseOf<Space>::sort_into_cells() {
  const std::size_t n = boxes_.size();
  cells_.clear(), large_.clear(), seen_.assign(n, -1);
  std::fill(start_.begin(), start_.end(), 0);
  if (n == 0) return;
  std::nth_element(widths_.begin(), widths_.begin() + static_cast<std::ptrdiff_t>(n / 2), widths_.end());
  const double width = widths_[n / 2];
  for (std::size_t i = 0; i < n; ++i) {
    const Box& box = boxes_[i];
    Cells cells;
    for (std::size_t k = 0; k < cells.low.size(); ++k) {
      const auto direction = static_cast<Eigen::Index>(k);
      cells.low[k] = cell_of(box.low[direction], width), cells.high[k] = cell_of(box.high[direction], width);
    }
    if (cells.count() > kLarge) {
      large_.push_back(static_cast<int>(i));
      cells.low.fill(0), cells.high.fill(-1);
    }
    cells_.push_back(cells);
    each_cell(cells, [&](const Cell& cell) { ++start_[slot(cell) + 1]; });
  }
  for (std::size_t s = 1; s < start_.size(); ++s) start_[s] += start_[s - 1];
  member_.resize(static_cast<std::size_t>(start_.back()));
  for (std::size_t i = n; i-- > 0;)  // from behind, each slot's end moves down to its start
    each_cell(cells_[i], [&](const Cell& cell) {
      member_[static_cast<std::size_t>(--start_[slot(cell) + 1])] = static_cast<int>(i);
    });
  std::rotate(start_.begin(), start_.begin() + 1, start_.end());
  start_.back() = static_cast<int>(member_.size());
}

template <class Space> std::size_t BroadPhaseOf<Space>::slot(const Cell& cell) const {
  constexpr std::array<std::uint64_t, 3> kMix = {0x9E3779B97F4A7C15U, 0xC2B2AE3D27D4EB4FU, 0x165667B19E3779F9U};
  std::uint64_t mix = 0;
  for (std::size_t k = 0; k < cell.size(); ++k) mix ^= static_cast<std::uint64_t>(cell[k]) * kMix[k];
  return static_cast<std::size_t>(mix ^ (mix >> 32)) & (start_.size() - 2);
}

template <class Space> void BroadPhaseOf<Space>::meet(int i, int collision) {
  const auto& apart = apart_[static_cast<std::size_t>(collision)];
  const Box& box = boxes_[static_cast<std::size_t>(i)];
  near_.clear();
  const auto look = [&](int j) {
    const Box& other = boxes_[static_cast<std::size_t>(j)];
    int& seen = seen_[static_cast<std::size_t>(j)];
    if (j <= i || seen == i || other.body == box.body) return;
    seen = i;
    if ((box.low.array() > other.high.array()).any() || (other.low.array() > box.high.array()).any()) return;
    if (box.round && other.round) {
      const double sum = (box.high.x() - box.low.x() + other.high.x() - other.low.x()) / 2;
      if ((box.low + box.high - other.low - other.high).squaredNorm() / 4 > sum * sum * (1 + kSlack)) return;
    }
    if (!apart.empty() && std::binary_search(apart.begin(), apart.end(), in_order(box.body, other.body))) return;
    near_.push_back(j);
  };
  const Cells& cells = cells_[static_cast<std::size_t>(i)];
  if (cells.high[0] < cells.low[0]) {  // a large one
    for (int j = i + 1; j < static_cast<int>(boxes_.size()); ++j) look(j);
    return;
  }
  each_cell(cells, [&](const Cell& cell) {
    const std::size_t s = slot(cell);
    for (int k = start_[s]; k < start_[s + 1]; ++k) look(member_[static_cast<std::size_t>(k)]);
  });
  for (const int j : large_) look(j);
  std::sort(near_.begin(), near_.end());
}

template class BroadPhaseOf<Planar>;
template class BroadPhaseOf<Spatial>;

}  // namespace orthant
