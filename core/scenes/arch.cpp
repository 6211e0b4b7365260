#include <orthant/core/scenes/arch.h>

#include <cmath>
#include <numbers>

namespace orthant {
namespace {

constexpr double kPi = std::numbers::pi;

/// max_β H_β − H_s over joints apart by `angle`, per γ: > 0, it falls.
double excess(double t, double angle) {
  const double in = 1 - t / 2, out = 1 + t / 2;
  const double area = (out * out - in * in) / 2, third = (out * out * out - in * in * in) / 3;
  double most = 0;
  for (double beta = angle; beta < kPi / 2 - angle / 2; beta += angle)
    most = std::max(most,
                    (area * beta * in * std::sin(beta) - third * (1 - std::cos(beta))) / (out - in * std::cos(beta)));
  return most - (area * kPi / 2 - third / out);
}

}  // namespace

double Arch::least_thickness() const {
  double low = 1e-3, high = 1;
  for (int i = 0; i < 60; ++i) (excess((low + high) / 2, kPi / voussoirs) > 0 ? low : high) = (low + high) / 2;
  return high;
}

Scene arch(const Arch& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 1, s.step = 1e-3;
  const double in = 1 - p.thickness / 2, out = 1 + p.thickness / 2, angle = kPi / p.voussoirs;
  const double mass = (out * out - in * in) * angle / 2;
  const double centre =
      (out * out * out - in * in * in) / 3 * 2 * std::sin(angle / 2) / mass;  // from the arch's centre
  const double inertia = (out * out * out * out - in * in * in * in) * angle / 4 - mass * centre * centre;
  // In a voussoir's frame the radius through its centre is x, so the arch's centre is at (−centre, 0).
  const auto face = [&](double radius, double side) {  // a point of the joint face at ∓angle/2
    return Vector2d(radius * std::cos(angle / 2) - centre, side * radius * std::sin(angle / 2));
  };
  const ContactLaw law{.mu = p.mu};
  for (int i = 0; i < p.voussoirs; ++i) {
    const double at = (i + 0.5) * angle;
    s.body({.mass = mass, .inertia = inertia, .position = centre * Vector2d(std::cos(at), std::sin(at)), .angle = at});
  }
  const Vector2d normal(-std::sin(angle / 2), std::cos(angle / 2));  // of the face at +angle/2, outwards
  for (int i = 0; i < p.voussoirs; ++i)
    for (const double radius : {in, out}) {
      const Vector2d corner = face(radius, -1);
      if (i == 0)
        s.contact(CornerWall{"", i, corner, kGround, {0, 0}, {0, 1}, law});
      else
        s.contact(CornerWall{"", i, corner, i - 1, face(1, 1), normal, law});
    }
  for (const double radius : {in, out})
    s.contact(CornerWall{"", p.voussoirs - 1, face(radius, 1), kGround, {0, 0}, {0, 1}, law});
  return s;
}

}  // namespace orthant
