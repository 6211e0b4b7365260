#include <orthant/core/scenes/cross_slope.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace orthant {
namespace {

/// Sliding on a pyramid, piece by piece.
class PyramidSlide {
 public:
  PyramidSlide(const CrossSlope& p, int sides)
      : brake_(p.mu * p.g * std::cos(p.slope)),
        v_(p.speed * std::cos(p.turn), p.speed * std::sin(p.turn)),
        pull_(p.g * std::sin(p.slope) * Vector2d(std::sin(p.turn), -std::cos(p.turn))) {
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      corners_.emplace_back(std::cos(angle), std::sin(angle));
    }
  }

  /// False: it never stops.
  bool run() {
    constexpr int kMostPieces = 1000;
    for (int piece = 0; piece < kMostPieces; ++piece) {
      if (v_.norm() <= kTie) return true;
      const std::size_t corner = least();
      const Vector2d a = pull_ + brake_ * corners_[corner];
      for (const std::size_t other : {corner + 1, corner + corners_.size() - 1}) {
        const std::size_t next = other % corners_.size();
        const Vector2d across = corners_[next] - corners_[corner];
        if (across.dot(v_) > kTie || across.dot(a) >= 0) continue;
        const Vector2d beyond = pull_ + brake_ * corners_[next];
        if (across.dot(beyond) >= 0) return straight(corner, next);
      }
      double until = std::numeric_limits<double>::infinity();
      for (const Vector2d& other : corners_) {
        const double apart = (other - corners_[corner]).dot(v_), rate = (other - corners_[corner]).dot(a);
        if (rate < 0 && apart > kTie) until = std::min(until, -apart / rate);
      }
      if (!std::isfinite(until)) return false;
      advance(a, until);
    }
    return false;
  }

  SlopeStop stop() const { return {time_, {x_.x(), x_.y(), 0}}; }

 private:
  static constexpr double kTie = 1e-13;  // [m/s]

  /// The corner least along the slip; of equal ones the one that the next moment keeps.
  std::size_t least() const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < corners_.size(); ++k) {
      const Vector2d across = corners_[k] - corners_[best];
      const double apart = across.dot(v_);
      if (apart < -kTie || (apart <= kTie && across.dot(pull_ + brake_ * corners_[k]) < 0)) best = k;
    }
    return best;
  }
  void advance(const Vector2d& a, double by) {
    x_ += by * v_ + by * by / 2 * a;
    v_ += by * a;
    time_ += by;
  }
  /// Friction between two corners, such that both stay equal, until the block stops.
  bool straight(std::size_t one, std::size_t other) {
    const Vector2d across = corners_[other] - corners_[one];
    const double share = -across.dot(pull_ + brake_ * corners_[one]) / (brake_ * across.squaredNorm());
    const Vector2d a = pull_ + brake_ * (corners_[one] + share * across), along = v_.normalized();
    if (!(a.dot(along) < 0)) return false;
    advance(a, -v_.norm() / a.dot(along));
    v_.setZero();
    return true;
  }

  double brake_;  // [m/s²]
  Vector2d v_, pull_, x_{0, 0};
  double time_ = 0;
  std::vector<Vector2d> corners_;
};

}  // namespace

spatial::Scene cross_slope(const CrossSlope& p) {
  spatial::Scene s;
  const double pull = p.g * std::sin(p.slope);
  s.gravity = {pull * std::sin(p.turn), -pull * std::cos(p.turn), -p.g * std::cos(p.slope)};
  s.duration = 0.4, s.step = 1e-3;
  const Vector3d start(p.speed * std::cos(p.turn), p.speed * std::sin(p.turn), 0);
  const auto block = s.body({.name = "block", .velocity = start});
  s.contact(spatial::SpherePlane{"slope", block, {0, 0, 0}, 0, kGround, {0, 0, 0}, {0, 0, 1}, {.mu = p.mu}});
  return s;
}

std::optional<SlopeStop> stop_on_slope(const CrossSlope& p) {
  const double k = p.mu / std::tan(p.slope), pull = p.g * std::sin(p.slope), v = p.speed;
  if (!(k > 1)) return {};
  const double down = v * v / (4 * pull * (k * k - 1)), across = 2 * k * v * v / (pull * (4 * k * k - 1));
  const double c = std::cos(p.turn), s = std::sin(p.turn);
  return SlopeStop{v * k / (pull * (k * k - 1)), {across * c + down * s, across * s - down * c, 0}};
}

std::optional<SlopeStop> stop_on_slope(const CrossSlope& p, int sides) {
  if (sides < 3) throw std::invalid_argument("sides = " + std::to_string(sides) + ": must be at least 3");
  PyramidSlide slide(p, sides);
  if (!slide.run()) return {};
  return slide.stop();
}

}  // namespace orthant
