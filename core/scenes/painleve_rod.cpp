#include <orthant/core/scenes/painleve_rod.h>

#include <cmath>

namespace orthant {

double PainleveRod::A() const {
  const double c = std::cos(angle), s = std::sin(angle);
  return 1 + 3 * c * c - 3 * mu * s * c;
}

double PainleveRod::b() const { return omega * omega * std::sin(angle) - g; }

std::vector<double> PainleveRod::forces() const {
  std::vector<double> found;
  if (b() >= 0) found.push_back(0);
  if (A() * b() < 0) found.push_back(-b() / A());
  return found;
}

Scene painleve_rod(const PainleveRod& p) {
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.01, s.step = 1e-4;
  const double c = std::cos(p.angle), up = std::sin(p.angle);
  const auto rod = s.body({.name = "rod",
                           .inertia = 1.0 / 3,
                           .position = {0, up},
                           .angle = p.angle,
                           .velocity = {-p.slide - p.omega * up, p.omega * c},
                           .omega = p.omega});
  s.contact(CornerWall{"floor", rod, {-1, 0}, kGround, {0, 0}, {0, 1}, {.mu = p.mu}});
  return s;
}

}  // namespace orthant
