#include "experiments/studies/motion_storm/shared_load.h"

#include "experiments/studies/motion_storm/closed_terms.h"
#include "experiments/studies/motion_storm/measure.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::motion_storm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kClosed = 1e-6;   // [m] gap of a contact that carries
constexpr double kSticks = 1e-6;   // [m/s] slip
constexpr double kRounded = 1e-7;  // relative: entries and pivots that count as zero
constexpr double kNoSlip = std::numeric_limits<double>::quiet_NaN();

class SharedLoad {
 public:
  explicit SharedLoad(const Scene& scene) : system_(scene) {}

  /// max σμ − min σμ of the contacts whose shares are open at x, and which coordinates move with them; 0: none.
  /// `gap` [m]: contacts no farther open carry.
  double range(const State& x, double gap, VectorXd& moves) {
    collect(x, gap);
    double low = kInf, high = -kInf;
    if (constraints_.empty() || slides_ == 0) return 0;
    const Eigen::Index dof = system_.dof(), n = static_cast<Eigen::Index>(constraints_.size());
    const VectorXd root = system_.inverse_mass().cwiseSqrt();
    MatrixXd C(n, dof), H(dof, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      C.row(i) = root.cwiseProduct(constraints_[k]), H.col(i) = root.cwiseProduct(forces_[k]);
      const double scale = C.row(i).norm();
      if (scale > 0) C.row(i) /= scale, H.col(i) /= scale;
    }
    Eigen::FullPivLU<MatrixXd> lu(C * H);
    lu.setThreshold(kRounded);
    if (lu.isInvertible()) return 0;
    MatrixXd Z = lu.kernel();
    for (Eigen::Index j = 0; j < Z.cols(); ++j) Z.col(j).normalize();
    moves = (H * Z).rowwise().norm();
    if (moves.maxCoeff() < kRounded) return 0;
    for (std::size_t k = 0; k < signed_mu_.size(); ++k)
      if (!std::isnan(signed_mu_[k]) && Z.row(static_cast<Eigen::Index>(k)).norm() > kRounded)
        low = std::min(low, signed_mu_[k]), high = std::max(high, signed_mu_[k]);
    return std::max(0.0, high - low);
  }

 private:
  void collect(const State& x, double gap) {
    const Terms terms = closed_terms(system_, x, gap);
    constraints_.clear(), forces_.clear(), signed_mu_.clear();
    slides_ = 0;
    const auto add = [&](const VectorXd& constraint, const VectorXd& force, double signed_mu) {
      constraints_.push_back(constraint), forces_.push_back(force), signed_mu_.push_back(signed_mu);
    };
    for (const Row& row : terms.G) add(dense(row, system_.dof()), dense(row, system_.dof()), kNoSlip);
    for (const ClosedContact& c : terms.closed) {
      const ContactLaw& law = system_.law(c.contact);
      const VectorXd N = dense(c.rows.normal, system_.dof()), T = dense(c.rows.tangent, system_.dof());
      const double slip = T.dot(x.v) - law.belt, mu = std::max(law.mu, law.mu_static);
      const bool stuck = mu > 0 && std::abs(slip) < kSticks;
      const double signed_mu = stuck || mu == 0 ? 0 : std::copysign(mu, slip);
      add(N, N - signed_mu * T, stuck ? kNoSlip : signed_mu);
      if (stuck) add(T, T, kNoSlip);
      slides_ += signed_mu != 0;
    }
  }

  System system_;
  std::vector<VectorXd> constraints_, forces_;
  std::vector<double> signed_mu_;  // NaN (kNoSlip): no sliding contact
  int slides_ = 0;
};

/// The state at the last impact before row r, from there back as in free flight; [m] the error of gaps by that, at the
/// most. Null: there was none since the row before.
const Event* last_impact(const Scene& scene, const Measure& measure, const Trace& trace, std::size_t r, State& at,
                         double& error) {
  const Event* last = nullptr;
  for (const Event& e : trace.events)
    if (e.kind == EventKind::impact && r > 0 && e.t > trace.rows[r - 1].t && e.t <= trace.rows[r].t) last = &e;
  if (last == nullptr) return nullptr;
  at = trace.rows[r];
  const double since = at.t - last->t;
  at.q -= since * at.v;
  double acceleration = scene.gravity.norm();
  for (Eigen::Index b = 0; 3 * b < at.v.size(); ++b)
    acceleration += measure.reach(static_cast<BodyId>(b)) * at.v[3 * b + 2] * at.v[3 * b + 2];
  error = acceleration * since * since;
  return last;
}

}  // namespace

double friction_left_open(const Scene& scene, const Trace& trace, double size) {
  SharedLoad shared(scene);
  const Measure measure(scene);
  double sum = 0;
  VectorXd moves;
  for (std::size_t r = 0; r < trace.rows.size(); ++r) {
    if (!(trace.pressed[r] > 0)) continue;
    double range = shared.range(trace.rows[r], kClosed, moves);
    State struck;
    double error = 0;
    if (range == 0 && last_impact(scene, measure, trace, r, struck, error) != nullptr)
      range = shared.range(struck, kClosed + error, moves);
    double compliance = 0;  // [1/(N s)] of the motion that goes farthest: sizes/s, rad/s
    for (std::size_t b = 0; range > 0 && b < scene.bodies.size(); ++b) {
      const Body& body = scene.bodies[b];
      const auto at = static_cast<Eigen::Index>(3 * b);
      if (moves.segment<2>(at).norm() > kRounded) compliance = std::max(compliance, 1 / (body.mass * size));
      if (moves[at + 2] > kRounded)
        compliance = std::max(compliance, measure.reach(static_cast<BodyId>(b)) / body.inertia);
    }
    sum += range * trace.pressed[r] * compliance * (trace.end() - trace.rows[r].t);
  }
  return sum;
}

}  // namespace orthant::motion_storm
