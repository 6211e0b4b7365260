// integrators/step/magnitudes.h — magnitudes of the numbers from which the motion of a body is computed.
//
//   Rounding of the largest number affects all numbers that are computed from it, and no others. So the limits of zero
//   and of errors are set by groups of bodies: a body 10 km away changes nothing here. For positions a group is
//   connected by joints and springs (System::assembly()). For velocities, which impacts transmit, contacts connect, too
//   (System::cluster()).
// Cost: O(bodies).
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace orthant {

/// Whether all entries are numbers: x − x is 0 of those alone. Half the time of Eigen's allFinite(), twice a step.
inline bool finite(const Eigen::VectorXd& x) { return (x - x).sum() == 0; }

class Magnitudes {
 public:
  /// groups: System's, which must outlive this.
  explicit Magnitudes(const std::vector<int>& groups) : first_(groups), of_(groups.size()) {}

  /// size(i) ≥ 0 of each body i: keeps the largest of each group, where its first body is.
  template <class Size> void measure(Size&& size) {
    std::size_t group = 0;
    double most = 0;  // of the group at hand: neighbours mostly share theirs
    for (std::size_t i = 0; i < of_.size(); ++i) {
      const double own = size(static_cast<Eigen::Index>(i));
      if (const auto first = static_cast<std::size_t>(first_[i]); first != group)
        of_[group] = most, group = first, most = first < i ? of_[first] : 0;
      most = std::max(most, own);
    }
    if (!of_.empty()) of_[group] = most;
  }

  double of(BodyId body) const {
    return body < 0 ? 0 : of_[static_cast<std::size_t>(first_[static_cast<std::size_t>(body)])];
  }
  double of(BodyId a, BodyId b) const { return std::max(of(a), of(b)); }
  template <class Space> double of(const RowOf<Space>& row) const { return of(row.a, row.b); }
  double of_entry(Eigen::Index i) const { return of(body_of_entry(i)); }  // of a dof
  double largest() const { return of_.empty() ? 0 : *std::max_element(of_.begin(), of_.end()); }

 private:
  const std::vector<int>& first_;
  std::vector<double> of_;  // of groups, at their first bodies; 0 elsewhere
};

}  // namespace orthant
