// integrators/event_driven/chart_runge_kutta.h — Runge–Kutta method of order 8 (Dormand & Prince) in charts of the
// rotations.
//
//   Within a step from (q, v) the coordinates are q exp φ (move(), blocks.h), and the method is applied to (φ, v):
//     φ' = v of translations,  φ' = J⁻¹(φ) ω of rotations,  v' = a(t, q exp φ, v),  φ = 0 at first,
//     J⁻¹(φ) ω = ω + ½ φ × ω + c φ × (φ × ω),   c = 1/|φ|² − (1 + cos |φ|) / (2 |φ| sin |φ|),
//   ω in the body's axes. The chart is new in each step: quaternions keep their length, and φ stays far from 2π.
//   Differences to the first stage are summed, not the stages: rounding is small where the step is.
//   Error estimate: that of dormand_prince.h, which has the coefficients.
//   Between the ends of a step (extend(), 3 more evaluations), x ∈ [0, 1] of it, to order 7:
//     y = y₀ + x (F₀ + x̄ (F₁ + x (F₂ + x̄ (F₃ + x (F₄ + x̄ (F₅ + x F₆)))))),   x̄ = 1 − x,
//     F₀ = y₁ − y₀,  F₁ = h k₁ − F₀,  F₂ = 2 F₀ − h (k₁ + k_end),  F₃ … F₆ = h Σ D_ij k_j over all 16 stages.
// Source: Munthe-Kaas, Applied Numerical Mathematics 29 (1999) 115-127; Solà, Deray & Atchuthan, A micro Lie theory for
// state estimation in robotics (2018), eq. 144; Hairer, Nørsett & Wanner (1993), II.5, II.10.
#pragma once

#include <orthant/core/mechanics/blocks.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

namespace orthant {

namespace dormand_prince {

inline constexpr std::size_t kAllStages = 16;  // 12, the end, and three more
using AllStages = std::array<double, kAllStages>;

// clang-format off
inline constexpr std::array<double, 3> kMoreC = {0.1, 0.2, 7.0 / 9};
inline constexpr std::array<AllStages, 3> kMoreA = {{
    {0.056167502283047954, 0, 0, 0, 0, 0, 0.25350021021662483, -0.2462390374708025, -0.12419142326381637,
     0.15329179827876568, 0.00820105229563469, 0.007567897660545699, -0.008298},
    {0.03183464816350214, 0, 0, 0, 0, 0.028300909672366776, 0.053541988307438566, -0.05492374857139099, 0, 0,
     -0.00010834732869724932, 0.0003825710908356584, -0.00034046500868740456, 0.1413124436746325},
    {-0.42889630158379194, 0, 0, 0, 0, -4.697621415361164, 7.683421196062599, 4.06898981839711, 0.3567271874552811, 0,
     0, 0, -0.0013990241651590145, 2.9475147891527724, -9.15095847217987}}};
inline constexpr std::array<AllStages, 4> kD = {{
    {-8.428938276109013, 0, 0, 0, 0, 0.5667149535193777, -3.0689499459498917, 2.38466765651207, 2.117034582445028,
     -0.871391583777973, 2.2404374302607883, 0.6315787787694688, -0.08899033645133331, 18.148505520854727,
     -9.194632392478356, -4.436036387594894},
    {10.427508642579134, 0, 0, 0, 0, 242.28349177525817, 165.20045171727028, -374.5467547226902, -22.113666853125306,
     7.733432668472264, -30.674084731089398, -9.332130526430229, 15.697238121770845, -31.139403219565178,
     -9.35292435884448, 35.81684148639408},
    {19.985053242002433, 0, 0, 0, 0, -387.0373087493518, -189.17813819516758, 527.8081592054236, -11.57390253995963,
     6.8812326946963, -1.0006050966910838, 0.7777137798053443, -2.778205752353508, -60.19669523126412,
     84.32040550667716, 11.99229113618279},
    {-25.69393346270375, 0, 0, 0, 0, -154.18974869023643, -231.5293791760455, 357.6391179106141, 93.40532418362432,
     -37.45832313645163, 104.0996495089623, 29.8402934266605, -43.53345659001114, 96.32455395918828,
     -39.17726167561544, -149.72683625798564}}};
// clang-format on

}  // namespace dormand_prince

/// The continuous extension of a step, of any number of quantities with the derivatives k_j: see chart_runge_kutta.h.
class ContinuousExtension {
 public:
  /// first: k₁; d: k_j − k₁, a column each; change: y₁ − y₀.
  void fit(double h, const Eigen::VectorXd& first, const Eigen::MatrixXd& d, const Eigen::VectorXd& change) {
    using namespace dormand_prince;
    F_[0] = change;
    F_[1] = h * first - change;
    F_[2] = 2 * change - h * (2 * first + d.col(kStages));
    for (std::size_t i = 0; i < kD.size(); ++i) {
      double sum = 0;
      F_[3 + i].setZero(first.size());
      for (std::size_t j = 0; j < kAllStages; ++j) {
        sum += kD[i][j];
        if (j > 0 && kD[i][j] != 0) F_[3 + i] += kD[i][j] * d.col(static_cast<Eigen::Index>(j));
      }
      F_[3 + i] = h * (F_[3 + i] + sum * first);
    }
  }
  /// y − y₀ at x ∈ [0, 1].
  void at(double x, Eigen::VectorXd& y) const {
    y = x * F_[6];
    for (std::size_t i = 6; i-- > 0;) y = (i % 2 == 1 ? 1 - x : x) * (F_[i] + y);
  }

 private:
  std::array<Eigen::VectorXd, 7> F_;
};

class ChartRungeKutta {
 public:
  static constexpr double kErrorOrder = DormandPrince::kErrorOrder;

  explicit ChartRungeKutta(Eigen::Index dof)
      : d_path_(dof, dormand_prince::kAllStages),
        d_v_(dof, dormand_prince::kAllStages),
        path_(dof),
        rate_(dof),
        v_(dof),
        a_(dof),
        sum_(dof) {}

  /// J⁻¹(φ) ω.
  static Vector3d rotation_rate(const Vector3d& phi, const Vector3d& omega) {
    const double square = phi.squaredNorm(), angle = std::sqrt(square);
    const double c = square < 1e-4 ? 1.0 / 12 + square / 720 + square * square / 30240
                                   : 1 / square - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
    const Vector3d across = phi.cross(omega);
    return omega + across / 2 + c * phi.cross(across);
  }
  /// φ' of all bodies.
  static void rate(const Eigen::VectorXd& path, const Eigen::VectorXd& v, Eigen::VectorXd& to) {
    to = v;
    for (Eigen::Index i = 0; i < v.size() / Spatial::kVelocities; ++i)
      rotation<Spatial>(to, i) = rotation_rate(rotation<Spatial>(path, i), rotation<Spatial>(v, i));
  }

  /// As DormandPrince::step(); q has a spatial block per body, v, `first` and the result of acceleration() too. seen(i)
  /// is called after the evaluation of stage i = 1 … 11.
  template <class Acceleration, class Seen> bool step(Acceleration&& acceleration, double t, const Eigen::VectorXd& q,
                                                      const Eigen::VectorXd& v, const Eigen::VectorXd& first, double h,
                                                      Eigen::VectorXd& q_next, Eigen::VectorXd& v_next, Seen&& seen) {
    using namespace dormand_prince;
    const auto reach = [&](double c, const Stages& weights, std::size_t stages, Eigen::VectorXd& v_new) {
      combine(d_path_, weights, stages);
      path_ = h * (c * v + sum_);
      combine(d_v_, weights, stages);
      v_new = v + h * (c * first + sum_);
    };
    for (std::size_t i = 1; i < kStages; ++i) {
      reach(kC[i], kA[i], i, v_);
      move<Spatial>(q, path_, q_);
      if (!acceleration(t + kC[i] * h, q_, v_, a_)) return false;
      rate(path_, v_, rate_);
      d_path_.col(static_cast<Eigen::Index>(i)) = rate_ - v;
      d_v_.col(static_cast<Eigen::Index>(i)) = a_ - first;
      seen(i);
    }
    reach(1, kB, kStages, v_next);
    move<Spatial>(q, path_, q_next);
    return path_.allFinite() && v_next.allFinite();
  }

  /// Computes the coefficients that at() needs. `seen` gets stages 12 … 15, too.
  template <class Acceleration, class Seen> bool extend(Acceleration&& acceleration, double t, const Eigen::VectorXd& q,
                                                        const Eigen::VectorXd& v, const Eigen::VectorXd& first,
                                                        double h, const Eigen::VectorXd& v_next, Seen&& seen) {
    using namespace dormand_prince;
    end_path_ = path_, v_ = v_next;
    const auto evaluate = [&](std::size_t i, double c) {
      move<Spatial>(q, path_, q_);
      if (!acceleration(t + c * h, q_, v_, a_)) return false;
      rate(path_, v_, rate_);
      d_path_.col(static_cast<Eigen::Index>(i)) = rate_ - v;
      d_v_.col(static_cast<Eigen::Index>(i)) = a_ - first;
      seen(i);
      return true;
    };
    if (!evaluate(kStages, 1)) return false;
    for (std::size_t i = 0; i < kMoreC.size(); ++i) {
      combine(d_path_, kMoreA[i], kStages + 1 + i);
      path_ = h * (kMoreC[i] * v + sum_);
      combine(d_v_, kMoreA[i], kStages + 1 + i);
      v_ = v + h * (kMoreC[i] * first + sum_);
      if (!evaluate(kStages + 1 + i, kMoreC[i])) return false;
    }
    path_ = end_path_;
    along_path_.fit(h, v, d_path_, path_);
    along_v_.fit(h, first, d_v_, v_next - v);
    return true;
  }
  /// φ and v − v₀ at x ∈ [0, 1] of the step that was extended.
  void at(double x, Eigen::VectorXd& path, Eigen::VectorXd& v_change) const {
    along_path_.at(x, path), along_v_.at(x, v_change);
  }

  /// Of the last step, each entry over its scale; accepted when ≤ 1.
  double error(double h, const Eigen::VectorXd& path_scale, const Eigen::VectorXd& v_scale) {
    using namespace dormand_prince;
    const auto square = [&](const Stages& weights) {
      combine(d_path_, weights, kStages);
      const double in_path = sum_.cwiseQuotient(path_scale).squaredNorm();
      combine(d_v_, weights, kStages);
      return in_path + sum_.cwiseQuotient(v_scale).squaredNorm();
    };
    const double fifth = square(kE), third = square(kE3);
    if (fifth == 0) return 0;
    return std::abs(h) * fifth / std::sqrt((fifth + 0.01 * third) * 2 * static_cast<double>(path_scale.size()));
  }

  /// φ at the end of the last step.
  const Eigen::VectorXd& path() const { return path_; }

 private:
  using Stages = dormand_prince::Stages;

  template <class Weights> void combine(const Eigen::MatrixXd& d, const Weights& weights, std::size_t stages) {
    sum_.setZero();
    for (std::size_t i = 1; i < stages; ++i)
      if (weights[i] != 0) sum_ += weights[i] * d.col(static_cast<Eigen::Index>(i));
  }

  Eigen::MatrixXd d_path_, d_v_;  // of each stage, less those of the first
  Eigen::VectorXd path_, rate_, v_, a_, sum_, q_, end_path_;
  ContinuousExtension along_path_, along_v_;
};

}  // namespace orthant
