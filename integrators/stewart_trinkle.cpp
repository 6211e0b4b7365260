#include <orthant/integrators/stewart_trinkle.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// Σ |J_k| |v_k| of one row [m/s].
double speed_along(const Row& row, const double* v) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (row.a >= 0) sum += std::abs(row.ja[k] * v[static_cast<std::size_t>(3 * row.a) + k]);
    if (row.b >= 0) sum += std::abs(row.jb[k] * v[static_cast<std::size_t>(3 * row.b) + k]);
  }
  return sum;
}

}  // namespace

void StewartTrinkle::close(double h, const State& x) {
  if (cone_ == Cone::coulomb)
    close_at_end_of_flight(h, x, nearly(h, x), [](const ClosedContact&) { return true; });
  else
    close_at_end_of_flight(h, x, kInf, [&](const ClosedContact& c) {
      const ContactLaw& law = system_.law(c.contact);
      const double slip = apply(c.rows.tangent, v_new_.data()) - law.belt;
      return terms_.gap[c.contact] <= nearly(h, x) + h * law.mu_at(slip) * std::abs(slip);
    });
  constexpr double kPace = 0.25;  // at which penetration is pushed out at the most, see the header
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const Row& normal = terms_.closed[k].rows.normal;
    const double pace = kPace * (speed_along(normal, x.v.data()) + speed_along(normal, v_new_.data()));
    const double approach = std::min(closing(terms_.closed[k], h), pace);
    const bool rebounds = system_.law(terms_.closed[k].contact).e > 0;
    wanted_[k].normal = rebounds ? std::max(wanted_[k].normal, approach) : approach;
    wanted_[k].least = approach;
  }
}

}  // namespace orthant
