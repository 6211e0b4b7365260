// integrators/derivatives/begun_friction.h — friction that a parameter gives to contacts without any: μ → 0+.
//
//   In this limit such contacts slide as without friction, and λ_T = −σ μ λ_N acts against the slip, σ its sign.
//   Where the slip changes its sign λ_T jumps by 2 μ λ_N → 0: no saltation, but another σ from there on.
#pragma once

#include <orthant/integrators/between_events/arc_interpolant.h>
#include <orthant/integrators/derivatives/nearby_motion.h>

#include <vector>

namespace orthant {

class BegunFriction {
 public:
  /// Of the contacts with a flag (begun_frictions()), or of none. `base`: the motion without their friction.
  BegunFriction(const System& system, NearbyMotion& base, std::vector<char> contacts);

  bool of(int contact) const { return !contacts_.empty() && contacts_[static_cast<std::size_t>(contact)] != 0; }

  /// The sign of the contact's slip; 0: there is none.
  int sense(int contact, double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v);

  /// The arc in pieces, one behind the other, in which the modes of these contacts have one σ each. First and last
  /// piece have the arc's ends. σ = 0: the contact does not slip in it, its number is in `at_rest`.
  const std::vector<Arc>& pieces(const Arc& arc, std::vector<int>& at_rest);

 private:
  struct Sample {
    double t = 0;
    Eigen::VectorXd q, v;
  };
  /// Where the slip changes its sign between two samples, by halving.
  Sample turn(int contact, const Sample& from, const Sample& to);
  Sample moved(const Sample& from, double duration);

  const System& system_;
  NearbyMotion& base_;
  std::vector<char> contacts_;
  std::vector<Arc> pieces_;
};

}  // namespace orthant
