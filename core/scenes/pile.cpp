#include <orthant/core/scenes/pile.h>

#include <cmath>
#include <numbers>

namespace orthant {

Scene pile(const Pile& p) {
  const auto pattern = [](int i, double ratio) { return std::fmod(ratio * i, 1.0) - 0.5; };  // in [−½, ½)
  const int columns = std::max(1, static_cast<int>(std::sqrt(p.discs)));
  const double apart = 2.2 * p.radius;
  const ContactLaw law{.mu = p.mu, .e = p.e};
  Scene s;
  s.gravity = {0, -p.g};
  s.duration = 0.5, s.step = 1e-3;
  Collision all{.name = "discs", .shapes = {}, .law = law};
  for (int i = 0; i < p.discs; ++i) {
    const double radius = p.radius * (1 - 0.1 * (pattern(i, std::numbers::phi) + 0.5));
    const double mass = std::numbers::pi * radius * radius;
    const Vector2d place{(i % columns + 0.5) * apart + 0.15 * p.radius * pattern(i, std::numbers::sqrt2),
                         (i / columns + 0.5) * apart};  // NOLINT(bugprone-integer-division): a row
    const BodyId disc = s.body({.mass = mass, .inertia = mass * radius * radius / 2, .position = place});
    all.shapes.push_back({disc, {0, 0}, radius, {}});
    s.contact(DiscWall{"", disc, {0, 0}, radius, kGround, {0, 0}, {0, 1}, law});
    s.contact(DiscWall{"", disc, {0, 0}, radius, kGround, {0, 0}, {1, 0}, law});
    s.contact(DiscWall{"", disc, {0, 0}, radius, kGround, {columns * apart, 0}, {-1, 0}, law});
  }
  s.collision(all);
  return s;
}

}  // namespace orthant
