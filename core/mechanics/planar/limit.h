// core/mechanics/planar/limit.h — joint limit: a bound on a relative coordinate, as a contact; stops and ropes.
//   lower: g = c − bound,   upper: g = bound − c   [rad or m]. No friction. An upper bound on a Span is a rope.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>
#include <orthant/core/mechanics/planar/coordinate.h>

#include <string>

namespace orthant {

struct Limit {
  enum class Side { lower, upper };
  std::string name;
  Coordinate of;
  Side side = Side::lower;
  double bound = 0;  // [rad or m]
  ContactLaw law;    // frictionless

  double gap(const Kinematics& k) const { return sign() * (of.value(k) - bound); }
  ContactRows rows(const Kinematics& k) const {
    const Row row = of.row(k);
    return {scaled(row, sign()), blank(row)};
  }
  ContactBias bias(const Kinematics& k) const { return {sign() * of.bias(k), 0}; }

 private:
  double sign() const { return side == Side::lower ? 1 : -1; }
};

}  // namespace orthant
