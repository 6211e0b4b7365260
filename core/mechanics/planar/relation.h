// core/mechanics/planar/relation.h — linear relations between coordinates: gears, racks, coupled angles, pulleys.
//
//   c(q) = Σ_k factor_k c_k(q),   c_k: an Angle, Slide or Span
//   Relation        joint:    Φ = c − offset = 0                                  1 row
//   RelationLimit   contact:  lower: g = c − bound,  upper: g = bound − c ≥ 0     no friction
//
//   scene.joint(Relation{"gears", {{2, Angle{kGround, pinion}}, {1, Angle{kGround, wheel}}}});          2 θ_p + θ_w = 0
//   scene.contact(RelationLimit{"rope", {{1, Span{kGround, a, {-1, 3}}}, {1, Span{kGround, b, {1, 3}}}}, …});
//
// A row has two bodies (rows.h): all coordinates together act on at most two bodies and the ground. A planetary
// gear whose carrier moves has three, and cannot be written so. Both are custom kinds: other scenes cost nothing more.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>
#include <orthant/core/mechanics/planar/coordinate.h>
#include <orthant/core/mechanics/planar/limit.h>
#include <orthant/core/support/options.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace orthant {

struct CoordinateTerm {
  double factor = 1;  // ≠ 0
  Coordinate of;
};

/// Σ factor c, with its two bodies.
class CoordinateSum {
 public:
  static constexpr double kMost = 1e100;  // of factors, sums, offsets and bounds; squares are finite

  /// Throws std::invalid_argument for no term, a factor of 0 or beyond 1e±100, no body or three besides the ground.
  explicit CoordinateSum(std::vector<CoordinateTerm> terms) : terms_(std::move(terms)) {
    if (terms_.empty()) throw std::invalid_argument("terms = []: must have at least one");
    for (const CoordinateTerm& term : terms_) {
      if (const double size = std::abs(term.factor); !(size >= 1 / kMost && size <= kMost))
        throw std::invalid_argument("terms: factor = " + detail::text_of(term.factor) +
                                    ": must be finite and not 0, of a size from 1e-100 to 1e100");
      const auto [one, other] = bodies_of(term);
      add(one), add(other);
    }
    if (a_ == kGround) throw std::invalid_argument("terms: act on no body: must act on one or two besides the ground");
  }

  BodyId a() const { return a_; }
  BodyId b() const { return b_; }
  const std::vector<CoordinateTerm>& terms() const { return terms_; }

  double value(const Kinematics& k) const {
    double sum = 0;
    for (const CoordinateTerm& term : terms_) sum += term.factor * term.of.value(k);
    return sum;
  }
  Row row(const Kinematics& k) const {
    Row sum{a_, b_, {}, {}};
    for (const CoordinateTerm& term : terms_) add_to(sum, term.factor, term.of.row(k));
    return sum;
  }
  double bias(const Kinematics& k) const {
    double sum = 0;
    for (const CoordinateTerm& term : terms_) sum += term.factor * term.of.bias(k);
    return sum;
  }
  /// What is wrong, in words: a distance that starts as 0; a sum, or the value of this field, that is too large. Empty:
  /// nothing.
  std::string wrong(const Kinematics& start, const char* field, double value_of_field) const {
    for (std::size_t i = 0; i < terms_.size(); ++i)
      if (std::holds_alternative<Span>(terms_[i].of.kind()) && terms_[i].of.value(start) == 0)
        return "terms[" + std::to_string(i) + "]: a distance starts as 0: must be > 0, it has no direction there";
    const auto beyond = [](const std::string& what, double size) {
      return std::abs(size) <= kMost ? "" : what + " = " + detail::text_of(size) + ": must be between -1e100 and 1e100";
    };
    if (std::string words = beyond(field, value_of_field); !words.empty()) return words;
    return beyond("terms: their sum at the start", value(start));
  }

 private:
  void add(BodyId body) {
    if (body == kGround || body == a_ || body == b_) return;
    if (a_ != kGround && b_ != kGround)
      throw std::invalid_argument("terms: act on three bodies: must act on two at the most besides the ground");
    (a_ == kGround ? a_ : b_) = body;
  }

  std::vector<CoordinateTerm> terms_;
  BodyId a_ = kGround, b_ = kGround;
};

struct Relation {
  static constexpr int kRows = 1;
  std::string name;
  CoordinateSum sum;
  double offset = 0;  // [rad or m]
  BodyId a = sum.a(), b = sum.b();

  Relation(std::string name_, std::vector<CoordinateTerm> terms, double offset_ = 0)
      : name(std::move(name_)), sum(std::move(terms)), offset(offset_) {}
  void residual(const Kinematics& k, double* phi) const { phi[0] = sum.value(k) - offset; }
  void rows(const Kinematics& k, Row* G) const { G[0] = sum.row(k); }
  void bias(const Kinematics& k, double* Gdot_v) const { Gdot_v[0] = sum.bias(k); }
  std::string wrong(const Kinematics& start) const { return sum.wrong(start, "offset", offset); }
};

struct RelationLimit {
  std::string name;
  CoordinateSum sum;
  Limit::Side side = Limit::Side::upper;
  double bound = 0;  // [rad or m]
  ContactLaw law;    // frictionless
  BodyId a = sum.a(), b = sum.b();

  RelationLimit(std::string name_, std::vector<CoordinateTerm> terms, Limit::Side side_, double bound_, double e = 0)
      : name(std::move(name_)), sum(std::move(terms)), side(side_), bound(bound_) {
    law.e = e;
  }
  double gap(const Kinematics& k) const { return sign() * (sum.value(k) - bound); }
  ContactRows rows(const Kinematics& k) const {
    const Row row = sum.row(k);
    return {scaled(row, sign()), blank(row)};
  }
  ContactBias bias(const Kinematics& k) const { return {sign() * sum.bias(k), 0}; }
  std::string wrong(const Kinematics& start) const { return sum.wrong(start, "bound", bound); }
  /// A rope's direction changes over its length.
  double length() const {
    for (const CoordinateTerm& term : sum.terms())
      if (std::holds_alternative<Span>(term.of.kind()) && bound > 0) return bound / 4;
    return std::numeric_limits<double>::infinity();
  }

 private:
  double sign() const { return side == Limit::Side::lower ? 1 : -1; }
};

}  // namespace orthant
