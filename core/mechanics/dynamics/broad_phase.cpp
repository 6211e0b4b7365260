#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/support/options.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace orthant {
namespace {

constexpr double kLarge = 100;   // cells of a shape
constexpr double kSlack = 1e-9;  // of a box: rounding

double radius_about_body(const Shape& s) {
  if (s.corners.empty()) return s.centre.norm() + s.radius;
  double most = 0;
  for (const Vector2d& corner : s.corners) most = std::max(most, corner.norm());
  return most;
}

std::int64_t cell_of(double x, double width) {
  const double cell = std::floor(x / width);
  return static_cast<std::int64_t>(cell > -0x1p50 ? std::min(cell, 0x1p50) : -0x1p50);  // of no number too
}

}  // namespace

BroadPhase::BroadPhase(const System& system) : system_(system) {
  std::size_t most = 0;
  for (const Collision& c : system.scene().collisions) {
    auto& radius = radius_.emplace_back();
    for (const Shape& s : c.shapes) radius.push_back(radius_about_body(s));
    most = std::max(most, c.shapes.size());
  }
  boxes_.reserve(most), widths_.reserve(most), cells_.reserve(most), large_.reserve(most), near_.reserve(most);
  seen_.reserve(most), member_.reserve(16 * most);
  start_.resize(any() ? std::bit_ceil(4 * most) + 1 : 1);
}

bool BroadPhase::find(const Eigen::VectorXd& way, Terms& terms, Reach reach) {
  std::fill(terms.pairs.begin(), terms.pairs.end(), Pair{});
  for (int c = 0; c < static_cast<int>(radius_.size()); ++c) {
    set_boxes(c, terms.at, way, reach);
    sort_into_cells();
    if (!find(c, terms)) return false;
  }
  return true;
}

void BroadPhase::set_boxes(int collision, const Kinematics& at, const Eigen::VectorXd& way, Reach reach) {
  const auto c = static_cast<std::size_t>(collision);
  const auto& shapes = system_.scene().collisions[c].shapes;
  boxes_.clear(), widths_.clear();
  double farthest = 0;
  const auto travel = [&](std::size_t i) {
    const BodyId body = shapes[i].body;
    return body < 0
               ? 0
               : std::hypot(way[kBlock * body], way[kBlock * body + 1]) + radius_[c][i] * std::abs(rotation(way, body));
  };
  for (std::size_t i = 0; reach == Reach::farthest && i < shapes.size(); ++i) farthest = std::max(farthest, travel(i));
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Shape& s = shapes[i];
    const Pose& pose = at.at(s.body);
    const bool disc = s.corners.empty();
    Vector2d low = pose.x + pose.turn(disc ? s.centre : s.corners[0]), high = low;
    for (const Vector2d& corner : s.corners) {
      const Vector2d p = pose.x + pose.turn(corner);
      low = low.cwiseMin(p), high = high.cwiseMax(p);
    }
    const double grow = std::max(farthest, travel(i)) + (disc ? s.radius : 0) + kSlack * radius_[c][i];
    boxes_.push_back({s.body, disc, low.array() - grow, high.array() + grow});
    widths_.push_back((high - low).maxCoeff() + 2 * grow);
  }
}

bool BroadPhase::find(int collision, Terms& terms) {
  const auto c = static_cast<std::size_t>(collision);
  const Collision& of = system_.scene().collisions[c];
  auto next = static_cast<std::size_t>(system_.pairs()[c]);
  const auto end = static_cast<std::size_t>(system_.pairs()[c + 1]);
  bool fits = true;
  for (int i = 0; fits && i < static_cast<int>(boxes_.size()); ++i) {
    meet(i);
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

void BroadPhase::sort_into_cells() {
  const std::size_t n = boxes_.size();
  cells_.clear(), large_.clear(), seen_.assign(n, -1);
  std::fill(start_.begin(), start_.end(), 0);
  if (n == 0) return;
  std::nth_element(widths_.begin(), widths_.begin() + static_cast<std::ptrdiff_t>(n / 2), widths_.end());
  const double width = widths_[n / 2];
  const auto each_cell = [&](const Cells& cells, auto&& what) {
    for (auto x = cells.x0; x <= cells.x1; ++x)
      for (auto y = cells.y0; y <= cells.y1; ++y) what(slot(x, y));
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Box& box = boxes_[i];
    Cells cells{cell_of(box.low.x(), width), cell_of(box.high.x(), width), cell_of(box.low.y(), width),
                cell_of(box.high.y(), width)};
    if (cells.count() > kLarge) {
      large_.push_back(static_cast<int>(i));
      cells = {0, -1, 0, -1};
    }
    cells_.push_back(cells);
    each_cell(cells, [&](std::size_t s) { ++start_[s + 1]; });
  }
  for (std::size_t s = 1; s < start_.size(); ++s) start_[s] += start_[s - 1];
  member_.resize(static_cast<std::size_t>(start_.back()));
  for (std::size_t i = n; i-- > 0;)  // from behind, each slot's end moves down to its start
    each_cell(cells_[i],
              [&](std::size_t s) { member_[static_cast<std::size_t>(--start_[s + 1])] = static_cast<int>(i); });
  std::rotate(start_.begin(), start_.begin() + 1, start_.end());
  start_.back() = static_cast<int>(member_.size());
}

std::size_t BroadPhase::slot(std::int64_t x, std::int64_t y) const {
  const auto mix =
      static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15U ^ static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FU;
  return static_cast<std::size_t>(mix ^ (mix >> 32)) & (start_.size() - 2);
}

void BroadPhase::meet(int i) {
  const Box& box = boxes_[static_cast<std::size_t>(i)];
  near_.clear();
  const auto look = [&](int j) {
    const Box& other = boxes_[static_cast<std::size_t>(j)];
    int& seen = seen_[static_cast<std::size_t>(j)];
    if (j <= i || seen == i || other.body == box.body) return;
    seen = i;
    if ((box.low.array() > other.high.array()).any() || (other.low.array() > box.high.array()).any()) return;
    if (box.disc && other.disc) {
      const double sum = (box.high.x() - box.low.x() + other.high.x() - other.low.x()) / 2;
      if ((box.low + box.high - other.low - other.high).squaredNorm() / 4 > sum * sum * (1 + kSlack)) return;
    }
    near_.push_back(j);
  };
  const Cells& cells = cells_[static_cast<std::size_t>(i)];
  if (cells.x1 < cells.x0) {  // a large one
    for (int j = i + 1; j < static_cast<int>(boxes_.size()); ++j) look(j);
    return;
  }
  for (auto x = cells.x0; x <= cells.x1; ++x)
    for (auto y = cells.y0; y <= cells.y1; ++y) {
      const std::size_t s = slot(x, y);
      for (int k = start_[s]; k < start_[s + 1]; ++k) look(member_[static_cast<std::size_t>(k)]);
    }
  for (const int j : large_) look(j);
  std::sort(near_.begin(), near_.end());
}

}  // namespace orthant
