#include <orthant/core/mechanics/spatial/pin_bush.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant::spatial {
namespace {

/// φ of the farthest (sign = 1) or nearest (−1) point; d_e, d_f ≥ 0.
double extreme_angle(double d_e, double d_f, double r, double c, double sign) {
  constexpr int kIterations = 60;
  const double bend = sign * r * (1 - c * c);
  double low = 0, high = std::numbers::pi / 2, phi = d_e > 0 || d_f > 0 ? std::atan2(c * d_f, d_e) : 0;
  for (int i = 0; i < kIterations; ++i) {
    const double sine = std::sin(phi), cosine = std::cos(phi);
    const double value = d_e * sine - c * d_f * cosine + bend * sine * cosine;
    const double slope = d_e * cosine + c * d_f * sine + bend * (cosine * cosine - sine * sine);
    if (value == 0 && slope >= 0) break;
    (value < 0 || slope < 0 ? low : high) = phi;
    double next = slope > 0 ? phi - value / slope : high;
    if (!(next > low && next < high)) next = (low + high) / 2;
    const double change = std::abs(next - phi);
    phi = next;
    if (change < 1e-15) break;
  }
  return phi;
}

}  // namespace

PinBush::Rim PinBush::rim(const Kinematics& k) const {
  const Vector3d u_a = k.at(a).turn(axis_a), u_b = k.at(b).turn(axis_b);
  const Vector3d c_a = k.at(a).x + k.at(a).turn(centre_a), c_b = k.at(b).x + k.at(b).turn(centre_b);
  const Vector3d &u = rim_of_pin ? u_a : u_b, &w = rim_of_pin ? u_b : u_a;
  const Vector3d centre = (rim_of_pin ? c_a : c_b) + along * u, from = rim_of_pin ? c_b : c_a;
  const double r = rim_of_pin ? radius_a : radius_b;
  const Vector3d across = w.cross(u);
  // Below this tilt the rim is a circle to rounding, and its direction is lost in it.
  constexpr double kTilt = 1e-8;
  const Vector3d e = across.norm() > kTilt ? Vector3d((across - across.dot(w) * w).normalized()) : perpendicular(w);
  const Vector3d f = w.cross(e);
  const Vector3d way = centre - from, in_rim = u.cross(e);  // of the circle's plane, with e
  const double c = in_rim.dot(f);                           // < 0 where the axes are opposite
  const double d_e = way.dot(e), d_f = way.dot(f);
  const double sign = rim_of_pin ? 1 : -1;
  const double phi = extreme_angle(std::abs(d_e), std::abs(d_f), r, std::abs(c), sign);
  const double by_e = std::copysign(sign * r * std::cos(phi), sign * d_e);
  const double by_f = std::copysign(r * std::sin(phi), sign * d_f * (c < 0 ? -1 : 1));
  const Vector3d point = centre + by_e * e + by_f * in_rim;
  const Vector3d p = point - from, square = p - p.dot(w) * w;
  // An axis that passes outside of the bush's rim is beyond it by its distance.
  const bool beyond = !rim_of_pin && d_e * d_e * c * c + d_f * d_f > r * r * c * c;
  const double distance = beyond ? -square.norm() : square.norm();
  return {point, distance != 0 ? Vector3d(square / distance) : e, distance};
}

}  // namespace orthant::spatial
