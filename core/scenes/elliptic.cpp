#include <orthant/core/scenes/elliptic.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

constexpr std::size_t kSteps = 10;

}  // namespace

double agm(double a, double b) {
  for (std::size_t n = 0; n < kSteps; ++n) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return a;
}

double quarter_period(double k_prime) { return std::numbers::pi / (2 * agm(1, k_prime)); }

double amplitude(double u, double k_prime) {
  std::array<double, kSteps> ratio{};  // c_n / a_n
  double a = 1, b = k_prime, scale = 1;
  for (double& r : ratio) {
    const double mean = (a + b) / 2, c = (a - b) / 2;
    b = std::sqrt(a * b);
    a = mean;
    r = c / a;
    scale *= 2;
  }
  double phi = scale * a * u;
  for (std::size_t n = kSteps; n-- > 0;) phi = (phi + std::asin(ratio[n] * std::sin(phi))) / 2;
  return phi;
}

double elliptic_integral(double phi, double k_prime) {
  const double s = std::sin(phi), k2 = 1 - k_prime * k_prime;
  const double slope_at_end = std::sqrt(1 - k2 * s * s);  // dam/du is no less before
  double u = phi;
  for (int i = 0; i < 60; ++i) {
    const double am = amplitude(u, k_prime), sine = std::sin(am);
    const double step = (phi - am) / std::max(std::sqrt(1 - k2 * sine * sine), slope_at_end);
    u += step;
    if (!(std::abs(step) > 1e-16 * u)) break;
  }
  return u;
}

}  // namespace orthant
