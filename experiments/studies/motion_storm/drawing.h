// experiments/studies/motion_storm/drawing.h — random numbers, masses and contact laws of one random scene.
#pragma once

#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/mechanics/planar/contact_law.h>

#include <cmath>
#include <initializer_list>

namespace orthant::motion_storm {

class Drawing {
 public:
  explicit Drawing(Random& random_) : random(random_) {}

  double pick(std::initializer_list<double> values) {
    return values.begin()[random.integer(0, static_cast<int>(values.size()) - 1)];
  }
  bool chance(double probability) { return random.uniform() < probability; }
  double log_uniform(double lo, double hi) { return std::exp(random.uniform(std::log(lo), std::log(hi))); }
  double mass() {  // [kg] 1, or within the scene's range of masses
    return mass_range_ == 1 ? 1 : log_uniform(1, mass_range_) / std::sqrt(mass_range_);
  }
  ContactLaw law() {  // the scene's, or in one of four scenes one of its own
    if (own_laws_) return {.mu = pick({0, 0, 0.1, 0.3, 0.7, 1.5}), .e = pick({0, 0, 0.2, 0.6, 1})};
    return law_;
  }

  Random& random;

 protected:
  void draw_ranges() {
    mass_range_ = pick({1, 1, 1, 10, 100, 1e3, 1e4, 1e6});
    own_laws_ = chance(0.25);
    law_ = {.mu = pick({0, 0, 0, 0.1, 0.3, 0.5, 0.8, 1, 2}), .e = pick({0, 0, 0, 0.3, 0.5, 0.8, 1})};
  }

 private:
  double mass_range_ = 1;  // the largest ratio of two masses
  bool own_laws_ = false;
  ContactLaw law_;
};

}  // namespace orthant::motion_storm
