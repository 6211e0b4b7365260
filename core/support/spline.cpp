#include <orthant/core/support/spline.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace orthant {

Spline::Spline(std::vector<double> times, std::vector<double> values)
    : t_(std::move(times)), y_(std::move(values)), slope_(y_.size()) {
  const auto finite = [](double x) { return std::isfinite(x); };
  if (t_.empty()) throw std::invalid_argument("times = []: must be at least one time");
  if (t_.size() != y_.size()) throw std::invalid_argument("times: must be as many as values");
  if (!std::all_of(t_.begin(), t_.end(), finite)) throw std::invalid_argument("times: must be finite");
  if (!std::all_of(y_.begin(), y_.end(), finite)) throw std::invalid_argument("values: must be finite");
  if (std::adjacent_find(t_.begin(), t_.end(), std::greater_equal<>()) != t_.end())
    throw std::invalid_argument("times: must be ascending");
  const std::size_t n = t_.size();
  std::vector<double> above(n);  // the factor's upper diagonal, from forward elimination
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = 1 / (t_[i] - t_[i - 1]), right = 1 / (t_[i + 1] - t_[i]);
    const double b = 3 * ((y_[i] - y_[i - 1]) * left * left + (y_[i + 1] - y_[i]) * right * right);
    const double pivot = 2 * (left + right) - left * above[i - 1];
    above[i] = right / pivot;
    slope_[i] = (b - left * slope_[i - 1]) / pivot;
  }
  for (std::size_t i = n; i-- > 1;) slope_[i - 1] -= above[i - 1] * slope_[i];
  if (!std::isfinite(t_.back() - t_.front())) throw std::invalid_argument("times: must span a finite time");
  for (const double t : t_)
    if (!std::isfinite(acceleration(t)))  // where a slope or a curvature is not
      throw std::invalid_argument("times: must be so far apart that the values' slopes and curvatures are finite");
}

double Spline::at(double t, int derivative) const {
  if (t_.empty()) return 0;
  const auto i = static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin());
  if (i == 0 || i == t_.size()) return derivative > 0 ? 0 : i == 0 ? y_.front() : y_.back();
  const double h = t_[i] - t_[i - 1], x = t - t_[i - 1], m0 = slope_[i - 1], m1 = slope_[i];
  const double mean = (y_[i] - y_[i - 1]) / h;
  const double c2 = (3 * mean - 2 * m0 - m1) / h, c3 = (m0 + m1 - 2 * mean) / (h * h);
  if (derivative == 0) return y_[i - 1] + x * (m0 + x * (c2 + x * c3));
  return derivative == 1 ? m0 + x * (2 * c2 + x * 3 * c3) : 2 * c2 + 6 * c3 * x;
}

}  // namespace orthant
