// integrators/event_driven/dormand_prince.h — Runge–Kutta method of order 8 (Dormand & Prince), explicit, for motion:
// q' = v, v' = a(t, q, v).
//
//   a_i = a(t + c_i h, q_i, v_i), i = 1..12, with differences d_i = a_i − a_1:
//     v_i = v + h (c_i a_1 + Σ_{j<i} a_ij d_j),   q_i = q + h c_i v + h² (c_i²/2 a_1 + Σ_{j<i} ā_ij d_j),   Ā = A A
//   and likewise the results with b and b̄ = bᵀ A. This is the method applied to (q, v), written so that only what
//   changes within the step is multiplied by coefficients (which reach 43): the rounding error is small where h is.
//   Error estimate from embedded methods of order 5 and 3:  e_5 = h Σ ê_i k_i,  e_3 = h (Σ b_i k_i − Σ b̂_i k_i),
//   error = |e_5|² / √(|e_5|² + |e_3|²/100)  in the mean square of the entries, each over its tolerance; it goes with
//   h⁸.
//   12 evaluations of a step, the first of which the step before has made already.
//   Source: Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (1993), II.5, II.10; coefficients of
//   their code DOP853.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace orthant {

namespace dormand_prince {

inline constexpr std::size_t kStages = 12;
using Stages = std::array<double, kStages>;
using Table = std::array<Stages, kStages>;

// clang-format off
inline constexpr Stages kC = {
    0, 0.0526001519587677318785587544488, 0.0789002279381515978178381316732, 0.118350341907227396726757197510,
    0.281649658092772603273242802490, 1.0 / 3, 0.25, 4.0 / 13, 127.0 / 195, 0.6, 6.0 / 7, 1};
inline constexpr Table kA = {{
    {},
    {5.26001519587677318785587544488e-2},
    {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
    {2.95875854768068491816892993775e-2, 0, 8.87627564304205475450678981324e-2},
    {2.41365134159266685502369798665e-1, 0, -8.84549479328286085344864962717e-1, 9.24834003261792003115737966543e-1},
    {1.0 / 27, 0, 0, 1.70828608729473871279604482173e-1, 1.25467687566822425016691814123e-1},
    {3.7109375e-2, 0, 0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2},
    {3.70920001185047927108779319836e-2, 0, 0, 1.70383925712239993810214054705e-1, 1.07262030446373284651809199168e-1,
     -1.53194377486244017527936158236e-2, 8.27378916381402288758473766002e-3},
    {6.24110958716075717114429577812e-1, 0, 0, -3.36089262944694129406857109825, -8.68219346841726006818189891453e-1,
     27.5920996994467083049415600797, 20.1540675504778934086186788979, -43.4898841810699588477366255144},
    {4.77662536438264365890433908527e-1, 0, 0, -2.48811461997166764192642586468, -5.90290826836842996371446475743e-1,
     21.2300514481811942347288949897, 15.2792336328824235832596922938, -33.2882109689848629194453265587,
     -2.03312017085086261358222928593e-2},
    {-9.3714243008598732571704021658e-1, 0, 0, 5.18637242884406370830023853209, 1.09143734899672957818500254654,
     -8.14978701074692612513997267357, -18.5200656599969598641566180701, 22.7394870993505042818970056734,
     2.49360555267965238987089396762, -3.0467644718982195003823669022},
    {2.27331014751653820792359768449, 0, 0, -10.5344954667372501984066689879, -2.00087205822486249909675718444,
     -17.9589318631187989172765950534, 27.9488845294199600508499808837, -2.85899827713502369474065508674,
     -8.87285693353062954433549289258, 12.3605671757943030647266201528, 6.43392746015763530355970484046e-1}}};
inline constexpr Stages kB = {
    5.42937341165687622380535766363e-2, 0, 0, 0, 0, 4.45031289275240888144113950566, 1.89151789931450038304281599044,
    -5.8012039600105847814672114227, 3.1116436695781989440891606237e-1, -1.52160949662516078556178806805e-1,
    2.01365400804030348374776537501e-1, 4.47106157277725905176885569043e-2};
inline constexpr Stages kE = {
    0.1312004499419488073250102996e-1, 0, 0, 0, 0, -0.1225156446376204440720569753e+1,
    -0.4957589496572501915214079952, 0.1664377182454986536961530415e+1, -0.3503288487499736816886487290,
    0.3341791187130174790297318841, 0.8192320648511571246570742613e-1, -0.2235530786388629525884427845e-1};
inline constexpr Stages kEmbedded3 = {0.244094488188976377952755905512, 0, 0, 0, 0, 0, 0, 0,
                                0.733846688281611857341361741547, 0, 0, 0.220588235294117647058823529412e-1};
// clang-format on

/// wᵀ A
constexpr Stages through(const Stages& w) {
  Stages sum{};
  for (std::size_t i = 0; i < kStages; ++i)
    for (std::size_t j = 0; j < i; ++j) sum[j] += w[i] * kA[i][j];
  return sum;
}
constexpr Table squared() {
  Table table{};
  for (std::size_t i = 0; i < kStages; ++i) table[i] = through(kA[i]);
  return table;
}
constexpr Stages difference(Stages a, const Stages& b) {
  for (std::size_t i = 0; i < kStages; ++i) a[i] -= b[i];
  return a;
}
inline constexpr Table kA2 = squared();
inline constexpr Stages kB2 = through(kB), kE2 = through(kE);
inline constexpr Stages kE3 = difference(kB, kEmbedded3), kE32 = through(kE3);

}  // namespace dormand_prince

class DormandPrince {
 public:
  static constexpr double kErrorOrder = 8;  // of error() in h

  explicit DormandPrince(Eigen::Index dof) : d_(dof, dormand_prince::kStages), sum_(dof), q_(dof), v_(dof), a_(dof) {}

  /// (q⁺, v⁺) from (q, v) and their acceleration `first`, each of `dof` entries. acceleration(t, q, v, a) returns false
  /// where there is none, and so does step; seen(i) is called after each.
  template <class Acceleration, class Seen> bool step(Acceleration&& acceleration, double t, const Eigen::VectorXd& q,
                                                      const Eigen::VectorXd& v, const Eigen::VectorXd& first, double h,
                                                      Eigen::VectorXd& q_next, Eigen::VectorXd& v_next, Seen&& seen) {
    const auto move = [&](double c, const Stages& position, const Stages& velocity, std::size_t stages,
                          Eigen::VectorXd& q_new, Eigen::VectorXd& v_new) {
      combine(position, stages);
      q_new = q + (h * c) * v + (h * h) * (c * c / 2 * first + sum_);
      combine(velocity, stages);
      v_new = v + h * (c * first + sum_);
    };
    using namespace dormand_prince;
    for (std::size_t i = 1; i < kStages; ++i) {
      move(kC[i], kA2[i], kA[i], i, q_, v_);
      if (!acceleration(t + kC[i] * h, q_, v_, a_)) return false;
      d_.col(static_cast<Eigen::Index>(i)) = a_ - first;
      seen(i);
    }
    move(1, kB2, kB, kStages, q_next, v_next);
    return q_next.allFinite() && v_next.allFinite();
  }

  /// Of the last step, each entry over its scale; accepted when ≤ 1.
  double error(double h, const Eigen::VectorXd& q_scale, const Eigen::VectorXd& v_scale) {
    using namespace dormand_prince;
    const auto square = [&](const Stages& position, const Stages& velocity) {
      combine(position, kStages);
      const double in_q = h * h * sum_.cwiseQuotient(q_scale).squaredNorm();
      combine(velocity, kStages);
      return in_q + sum_.cwiseQuotient(v_scale).squaredNorm();
    };
    const double fifth = square(kE2, kE), third = square(kE32, kE3);
    if (fifth == 0) return 0;
    return std::abs(h) * fifth / std::sqrt((fifth + 0.01 * third) * 2 * static_cast<double>(q_scale.size()));
  }

 private:
  using Stages = dormand_prince::Stages;

  void combine(const Stages& weights, std::size_t stages) {
    sum_.setZero();
    for (std::size_t i = 1; i < stages; ++i)
      if (weights[i] != 0) sum_ += weights[i] * d_.col(static_cast<Eigen::Index>(i));
  }

  Eigen::MatrixXd d_;
  Eigen::VectorXd sum_, q_, v_, a_;
};

}  // namespace orthant
