// core/mechanics/spatial/gear.h — gears and racks: two coordinates in a fixed ratio.
//
//   Φ = c₂ − ratio c₁ − offset = 0   [rad or m], 1 row;  c₁, c₂: an Angle or a Slide
//   scene.joint(Gear("gears", shaft.angle(), wheel.angle(), -20.0 / 60));      // outer teeth, 20 on 60, axes parallel
//   scene.joint(Gear("rack", pinion.angle(), rail.displacement(), 0.05));      // ratio: the pinion's radius [m/rad]
// Angles are known up to turns. Of two the ratio is a quotient p/q of whole numbers, and of the residual's values,
// which differ by 2π/q, the one nearest to 0 is taken. An angle and a slide: they differ by 2π |ratio|, or by 2π.
// A row has two bodies (rows.h): both coordinates together act on at most two bodies and the ground. Gears on a
// carrier that moves (planetary, differential) have three, and cannot be written so.
#pragma once

#include <orthant/core/mechanics/spatial/coordinate.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace orthant::spatial {

/// The smallest q ≤ 1000 for which q x is a whole number up to rounding; 0: there is none.
inline int whole_multiple(double x) {
  for (int q = 1; q <= 1000; ++q)
    if (std::abs(q * x - std::round(q * x)) <= 1e-13 * q * (1 + std::abs(x))) return q;
  return 0;
}

struct Gear {
  static constexpr int kRows = 1;
  std::string name;
  Coordinate first, second;
  double ratio = 1;   // ≠ 0; of two angles a quotient of whole numbers
  double offset = 0;  // [rad or m]
  BodyId a = kGround, b = kGround;

  /// Throws std::invalid_argument for a distance, a ratio of 0 or not finite, of two angles one that is no quotient of
  /// whole numbers up to 1000, and for no body or three besides the ground.
  Gear(std::string name_, const Coordinate& first_, const Coordinate& second_, double ratio_, double offset_ = 0)
      : name(std::move(name_)), first(first_), second(second_), ratio(ratio_), offset(offset_) {
    if (!std::isfinite(ratio) || ratio == 0) throw std::invalid_argument("ratio: must be finite and not 0");
    for (const Coordinate* c : {&first, &second}) {
      if (std::holds_alternative<Span>(c->kind()))
        throw std::invalid_argument("coordinates: must be an angle or a displacement each");
      std::visit([&](const auto& of) { add(of.a), add(of.b); }, c->kind());
    }
    if (a == kGround) throw std::invalid_argument("acts on no body: must act on one or two besides the ground");
    if (first.angle() && second.angle()) {
      const int q = whole_multiple(ratio);
      if (q == 0)
        throw std::invalid_argument("ratio: must be a quotient of whole numbers up to 1000, such as numbers of teeth");
      period_ = 2 * std::numbers::pi / q;
    } else if (first.angle() || second.angle()) {
      period_ = 2 * std::numbers::pi * (first.angle() ? std::abs(ratio) : 1);
    }
  }

  /// [rad] What residuals of two angles, or of an angle and a slide, are known up to; infinity of two slides.
  double period() const { return period_; }
  /// c₂ − ratio c₁.
  double value(const Kinematics& k) const { return second.value(k) - ratio * first.value(k); }
  void residual(const Kinematics& k, double* phi) const {
    phi[0] = value(k) - offset;
    if (std::isfinite(period_)) phi[0] = std::remainder(phi[0], period_);
  }
  void rows(const Kinematics& k, Row* G) const {
    G[0] = Row{a, b, {}, {}};
    add_to(G[0], 1, second.row(k)), add_to(G[0], -ratio, first.row(k));
  }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = second.bias(k) - ratio * first.bias(k); }

 private:
  void add(BodyId body) {
    if (body == kGround || body == a || body == b) return;
    if (a != kGround && b != kGround)
      throw std::invalid_argument("acts on three bodies: must act on two at the most besides the ground");
    (a == kGround ? a : b) = body;
  }
  double period_ = std::numeric_limits<double>::infinity();
};

}  // namespace orthant::spatial
