#include <orthant/core/lcp/problems/contact_piles.h>

#include <Eigen/Geometry>

#include <cmath>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

constexpr double kStep = 1e-3, kFall = 9.81;  // s, m/s²

using Point = Eigen::Vector3d;

// Boxes and the points where they touch, then all rows at once.
class Builder {
 public:
  explicit Builder(const ContactPile& pile) : pile_(pile), freedoms_(pile.spatial ? 6 : 3) {
    if (!(pile.mu >= 0) || !(pile.mass_ratio > 0) || !std::isfinite(pile.slope))
      throw std::invalid_argument("pile: mu = " + std::to_string(pile.mu) + ", mass_ratio = " +
                                  std::to_string(pile.mass_ratio) + ": mu must be ≥ 0, mass_ratio > 0, slope finite");
  }

  /// A box of the given edges (x, y, z; m) and mass; its number.
  int box(const Point& centre, const Point& edges, double mass) {
    const Point squares = edges.cwiseProduct(edges);
    const double along_y = mass * (squares.x() + squares.z()) / 12;
    for (int k = 0; k < (pile_.spatial ? 3 : 2); ++k) inverse_mass_.push_back(1 / mass);
    if (pile_.spatial) inverse_mass_.push_back(12 / (mass * (squares.y() + squares.z())));
    inverse_mass_.push_back(1 / along_y);
    if (pile_.spatial) inverse_mass_.push_back(12 / (mass * (squares.x() + squares.y())));
    centres_.push_back(centre);
    return static_cast<int>(centres_.size()) - 1;
  }

  /// `above` rests at a point on `below`, −1: the ground.
  void contact(int above, int below, const Point& point) {
    const int normal = direction(above, below, point, Point::UnitZ());
    if (pile_.mu == 0) return;
    const bool disc = pile_.spatial && pile_.discs;
    for (int k = 0; k < (pile_.spatial ? 2 : 1); ++k) {
      const int row = direction(above, below, point, Point::Unit(k));
      if (k == 0 || !disc) friction_.push_back({.normal = normal, .first = row, .rows = disc ? 2 : 1, .mu = pile_.mu});
    }
  }
  /// At the corners of a horizontal rectangle, or its two ends in the plane.
  void face(int above, int below, const Point& centre, double x, double y) {
    for (const double i : {-0.5, 0.5})
      for (const double j : {-0.5, 0.5})
        if (pile_.spatial || j < 0) contact(above, below, centre + Point(i * x, pile_.spatial ? j * y : 0, 0));
  }

  Lcp problem() {
    const auto coordinates = static_cast<Index>(inverse_mass_.size());
    Eigen::SparseMatrix<double, Eigen::RowMajor> W(rows_, coordinates);
    W.setFromTriplets(entries_.begin(), entries_.end());
    Delassus A{RowSparse::from(W), Eigen::Map<Eigen::VectorXd>(inverse_mass_.data(), coordinates), {}};
    Eigen::VectorXd v = Eigen::VectorXd::Zero(coordinates);
    for (Index k = 0; k < coordinates; k += freedoms_) {
      v[k] = kStep * kFall * std::sin(pile_.slope);
      v[k + (pile_.spatial ? 2 : 1)] = -kStep * kFall * std::cos(pile_.slope);
    }
    Lcp p = Lcp::standard(std::move(A), Vector(W * v));
    p.friction = std::move(friction_);
    for (const Friction& f : p.friction) p.lo.segment(f.first, f.rows).setConstant(-kInf);
    return p;
  }

 private:
  // The row of the relative velocity along d: planar coordinates (x, z, rotation about −y), spatial (x, y, z,
  // rotations).
  int direction(int above, int below, const Point& point, const Point& d) {
    const int row = rows_++;
    for (const auto& [body, sign] : {std::pair{above, 1.0}, std::pair{below, -1.0}}) {
      if (body < 0) continue;
      const Point moment = (point - centres_[static_cast<std::size_t>(body)]).cross(d);
      const int first = freedoms_ * body;
      const auto add = [&, s = sign](int k, double value) {
        if (value != 0) entries_.emplace_back(row, first + k, s * value);
      };
      if (pile_.spatial) {
        for (int k = 0; k < 3; ++k) add(k, d[k]), add(3 + k, moment[k]);
      } else {
        add(0, d.x()), add(1, d.z()), add(2, -moment.y());
      }
    }
    return row;
  }

  ContactPile pile_;
  int freedoms_, rows_ = 0;
  std::vector<double> inverse_mass_;
  std::vector<Point> centres_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<Friction> friction_;
};

void require(const char* what, Index value) {
  if (value < 1) throw std::invalid_argument(std::string(what) + " = " + std::to_string(value) + ": must be ≥ 1");
}

}  // namespace

Lcp box_column(Index boxes, const ContactPile& pile) {
  require("boxes", boxes);
  Builder builder(pile);
  for (Index k = 0; k < boxes; ++k) {
    const double share = boxes > 1 ? static_cast<double>(k) / static_cast<double>(boxes - 1) : 0;
    const double height = static_cast<double>(k);
    const int box = builder.box({0, 0, height + 0.5}, {1, 1, 1}, std::pow(pile.mass_ratio, share));
    builder.face(box, box - 1, {0, 0, height}, 1, 1);
  }
  return builder.problem();
}

Lcp loaded_table(Index legs, const ContactPile& pile) {
  require("legs", legs);
  Builder builder(pile);
  const int plate = builder.box({0, 0, 1}, {4, 4, 0.2}, 1);
  const auto place = [legs](Index i) {
    return legs > 1 ? -1.9 + 3.8 * static_cast<double>(i) / static_cast<double>(legs - 1) : 0.0;
  };
  for (Index i = 0; i < legs; ++i)
    for (Index j = 0; j < (pile.spatial ? legs : 1); ++j)
      builder.contact(plate, -1, {place(i), pile.spatial ? place(j) : 0, 0});
  for (const double x : {-0.75, 0.5}) {
    const int load = builder.box({x, 0, 1.6}, {1, 1, 1}, pile.mass_ratio);
    builder.face(load, plate, {x, 0, 1.1}, 1, 1);
  }
  return builder.problem();
}

Lcp brick_wall(Index courses, const ContactPile& pile) {
  require("courses", courses);
  if (pile.spatial) throw std::invalid_argument("spatial = true: brick walls are planar");
  Builder builder(pile);
  std::vector<int> below, course;
  for (Index k = 0; k < courses; ++k) {
    const double z = static_cast<double>(k);
    const double share = courses > 1 ? z / static_cast<double>(courses - 1) : 0;
    course.clear();
    for (Index i = 0; i < courses - k; ++i) {
      const double x = 2.1 * static_cast<double>(i) + 1.05 * z;  // joints of 0.1 m
      course.push_back(builder.box({x, 0, z + 0.5}, {2, 1, 1}, std::pow(pile.mass_ratio, share)));
      if (k == 0) {
        builder.face(course.back(), -1, {x, 0, 0}, 2, 1);
        continue;
      }
      const auto left = static_cast<std::size_t>(i);
      builder.face(course.back(), below[left], {x - 0.525, 0, z}, 0.95, 1);
      builder.face(course.back(), below[left + 1], {x + 0.525, 0, z}, 0.95, 1);
    }
    below.swap(course);
  }
  return builder.problem();
}

}  // namespace orthant
