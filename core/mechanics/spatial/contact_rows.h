// core/mechanics/spatial/contact_rows.h — rows of a closed contact in space: the normal, and two tangents for a disc.
//
//   (n, t1, t2) orthonormal in the world, t1 = perpendicular(n). Friction is isotropic: the choice of t1 changes
//   nothing.
#pragma once

#include <orthant/core/mechanics/planar/contact_law.h>
#include <orthant/core/mechanics/spatial/geometry.h>

#include <array>

namespace orthant {

/// Two tangential numbers, along t1 and t2.
struct Tangents {
  double first = 0, second = 0;
  friend Tangents operator+(Tangents x, Tangents y) { return {x.first + y.first, x.second + y.second}; }
  friend Tangents operator-(Tangents x, Tangents y) { return {x.first - y.first, x.second - y.second}; }
  friend Tangents operator*(double by, Tangents x) { return {by * x.first, by * x.second}; }
  Tangents& operator+=(Tangents y) { return *this = *this + y; }
  friend bool operator==(const Tangents&, const Tangents&) = default;
};

template <> struct TangentOf<Spatial> { using type = Tangents; };

template <> struct ContactRowsOf<Spatial> {
  RowOf<Spatial> normal;                   // rate of the gap [m/s]
  std::array<RowOf<Spatial>, 2> tangents;  // of slip [m/s]
};

inline Tangents slip_rate(const ContactRowsOf<Spatial>& rows, const double* v) {
  return {apply(rows.tangents[0], v), apply(rows.tangents[1], v)};
}
inline double size_of(const Tangents& slip) { return std::hypot(slip.first, slip.second); }
inline double mu_at(const ContactLaw& law, const Tangents& slip) { return law.mu_at(size_of(slip)); }
inline double inner(const Tangents& one, const Tangents& other) {
  return one.first * other.first + one.second * other.second;
}
inline const RowOf<Spatial>& row_of_tangent(const ContactRowsOf<Spatial>& rows, std::size_t i) {
  return rows.tangents[i];
}
inline double tangent_part(const Tangents& slip, std::size_t i) { return i == 0 ? slip.first : slip.second; }

namespace spatial {

using ContactRows = ContactRowsOf<Spatial>;

/// Of a contact with the normal n from b to a, which touches at r_a from a's centre and r_b from b's.
inline ContactRows contact_rows(const Kinematics& k, BodyId a, BodyId b, const Vector3d& n, const Vector3d& r_a,
                                const Vector3d& r_b) {
  const Vector3d t = perpendicular(n);
  return {pair_row(k, a, b, n, r_a, r_b), {pair_row(k, a, b, t, r_a, r_b), pair_row(k, a, b, n.cross(t), r_a, r_b)}};
}

}  // namespace spatial
}  // namespace orthant
