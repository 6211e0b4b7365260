// core/mechanics/spatial/contact_rows.h — rows of a closed contact in space: the normal, and two tangents for a disc.
//
//   (n, t1, t2) orthonormal in the world, t1 = perpendicular(n): where friction is isotropic, the choice of t1 changes
//   nothing.
//   Orthotropic friction, μ along t1 = `direction` and μ' = mu_across along t2: the ellipse (Λ₁/μ)² + (Λ₂/μ')² ≤ Λ_N²
//   with the slip along its normal. Row t2 is scaled by s = μ'/μ: with Λ₂ = s Λ₂' that is the disc of μ for (Λ₁, Λ₂'),
//   and the slip (γ₁, s γ₂) is against it.
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
  friend Tangents operator/(Tangents x, double by) { return {x.first / by, x.second / by}; }
  Tangents& operator+=(Tangents y) { return *this = *this + y; }
  friend bool operator==(const Tangents&, const Tangents&) = default;
};

template <> struct TangentOf<Spatial> { using type = Tangents; };

template <> struct ContactRowsOf<Spatial> {
  RowOf<Spatial> normal;                   // rate of the gap [m/s]
  std::array<RowOf<Spatial>, 2> tangents;  // of slip [m/s]
  Vector3d point{0, 0, 0};                 // [m] on b, in the world
  Tangents belt{};                         // motion of b's surface against b, along the tangents' rows
};

/// The motion of b's surface along the tangents.
inline Tangents belt_of(const ContactLaw& /*law*/, const ContactRowsOf<Spatial>& rows) { return rows.belt; }

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
  return {pair_row(k, a, b, n, r_a, r_b),
          {pair_row(k, a, b, t, r_a, r_b), pair_row(k, a, b, n.cross(t), r_a, r_b)},
          k.at(b).x + r_b};
}

/// The world direction of a row of a contact, from b to a: a unit vector, of scaled tangents times their scale.
inline Vector3d direction_of(const Row& row) {
  return row.a >= 0 ? push_on(row, row.a) : Vector3d(-push_on(row, row.b));
}

/// Turns and scales the tangents of orthotropic friction, and sets what a moving surface does along them.
inline void adapt_to_surface(const ContactLaw& law, const Kinematics& k, ContactRows& rows) {
  const SurfaceLaw& s = law.surface;
  const Pose& on = k.at(rows.normal.b);
  if (s.orthotropic()) {
    constexpr double kAlong = 1e-9;  // of a direction along the normal nothing is left
    const Vector3d d = on.turn(s.direction);
    const Tangents part{d.dot(direction_of(rows.tangents[0])), d.dot(direction_of(rows.tangents[1]))};
    const double size = size_of(part);
    const double cosine = size > kAlong ? part.first / size : 1, sine = size > kAlong ? part.second / size : 0;
    const auto [one, other] = rows.tangents;
    rows.tangents[0] = combined(scaled(one, cosine), sine, other);
    rows.tangents[1] = scaled(combined(scaled(one, -sine), cosine, other), s.mu_across / law.mu);
  }
  if (s.moves()) {
    const Vector3d v = on.turn(s.velocity + s.omega.cross(on.turn_back(rows.point - on.x) - s.centre));
    rows.belt = {v.dot(direction_of(rows.tangents[0])), v.dot(direction_of(rows.tangents[1]))};
  }
}

}  // namespace spatial
}  // namespace orthant
