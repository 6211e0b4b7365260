// core/mechanics/spatial/backlash.h — gear or rack with backlash, as contacts: its teeth have play and strike each
// other.
//   lower flank: g = play/2 + d,   upper flank: g = play/2 − d,   d = c₂ − ratio c₁ − offset   [rad or m]
//   scene.contact_set(meshing("teeth", Gear({}, pinion.angle(), wheel.angle(), -20.0 / 60), 0.01, {.e = 0.3}));
// The flanks have no friction. Of two angles d is known up to the gear's period (gear.h), so that teeth of which a step
// of fixed length would skip one are not noticed here, but by the integrators (turn_watch.h).
#pragma once

#include <orthant/core/mechanics/spatial/contact_rows.h>
#include <orthant/core/mechanics/spatial/gear.h>
#include <orthant/core/mechanics/spatial/limit.h>

#include <array>
#include <string>

namespace orthant::spatial {

struct Backlash {
  std::string name;
  Gear gear;
  Limit::Side flank = Limit::Side::lower;
  double play = 0;  // [rad or m] of the second coordinate, from flank to flank; ≥ 0, of two angles < gear.period()
  ContactLaw law;   // frictionless

  double gap(const Kinematics& k) const {
    double d = 0;
    gear.residual(k, &d);
    return play / 2 + sign() * d;
  }
  ContactRows rows(const Kinematics& k) const {
    Row row;
    gear.rows(k, &row);
    return {scaled(row, sign()), {blank(row), blank(row)}};
  }
  double bias(const Kinematics& k) const {
    double rate = 0;
    gear.bias(k, &rate);
    return sign() * rate;
  }

 private:
  double sign() const { return flank == Limit::Side::lower ? 1 : -1; }
};

/// Both flanks, NAME_lower and NAME_upper; the names of nameless ones are those of their places.
inline std::array<Backlash, 2> meshing(const std::string& name, const Gear& gear, double play,
                                       const ContactLaw& law = {}) {
  const auto flank = [&](Limit::Side side, const char* suffix) {
    return Backlash{name.empty() ? name : name + suffix, gear, side, play, law};
  };
  return {flank(Limit::Side::lower, "_lower"), flank(Limit::Side::upper, "_upper")};
}

}  // namespace orthant::spatial
