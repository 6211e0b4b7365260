// Values as TOML writes them: numbers, lists, names, quaternions.
#pragma once

#include <orthant/core/mechanics/models/model.h>
#include <orthant/core/support/options.h>

#include <Eigen/Geometry>

#include <cmath>

namespace orthant::models {

inline std::string number(double x) {
  std::string text = detail::text_of(x == 0 ? 0.0 : x);                                    // no −0
  if (std::abs(x) >= 1e15 && text.find_first_of(".e") == std::string::npos) text += ".0";  // no integer of TOML's
  return text;
}
template <class X> std::string list(const Eigen::MatrixBase<X>& x) {
  std::string all = "[";
  for (Eigen::Index i = 0; i < x.size(); ++i) all += (i > 0 ? ", " : "") + number(x(i));
  return all + "]";
}
inline std::string list(const std::vector<Vector3d>& points) {
  std::string all = "[";
  for (std::size_t i = 0; i < points.size(); ++i) all += (i > 0 ? ", " : "") + list(points[i]);
  return all + "]";
}
inline std::string in_quotes(const std::string& text) { return '"' + text + '"'; }
inline std::string pair_of(const std::string& a, const std::string& b) {
  return "[" + in_quotes(a) + ", " + in_quotes(b) + "]";
}

/// (w, x, y, z), w ≥ 0.
inline Eigen::Vector4d quaternion_of(const Matrix3d& R) {
  Eigen::Quaterniond q = Eigen::Quaterniond(R).normalized();
  if (q.w() < 0) q.coeffs() *= -1;
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace orthant::models
