// core/mechanics/spatial/limit.h — joint limit: a bound on a relative coordinate, as a contact; stops and ropes.
//   lower: g = c − bound,   upper: g = bound − c   [rad or m]. No friction. An upper bound on a Span is a rope.
//   An angle c is taken within half a turn of bound + beyond. Where a joint has two bounds that is the middle between
//   them, so that it may turn by almost a full turn. One bound alone is its own middle.
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>
#include <orthant/core/mechanics/spatial/coordinate.h>

#include <string>

namespace orthant::spatial {

struct Limit {
  enum class Side { lower, upper };
  std::string name;
  Coordinate of;
  Side side = Side::lower;
  double bound = 0;   // [rad or m]
  ContactLaw law;     // frictionless
  double beyond = 0;  // [rad] middle − bound, of an angle

  double gap(const Kinematics& k) const { return sign() * (off(of, k, bound + beyond) + beyond); }
  ContactRows rows(const Kinematics& k) const {
    const Row row = of.row(k);
    return {scaled(row, sign()), {blank(row), blank(row)}};
  }

 private:
  double sign() const { return side == Side::lower ? 1 : -1; }
};

}  // namespace orthant::spatial
