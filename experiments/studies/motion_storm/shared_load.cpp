#include "experiments/studies/motion_storm/shared_load.h"

#include "experiments/studies/motion_storm/closed_rows.h"
#include "experiments/studies/motion_storm/measure_of.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>

namespace orthant::motion_storm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kCarrying = 1e-6;  // [m] gap of a contact that carries
constexpr double kSticks = 1e-6;    // [m/s] slip
constexpr double kRounded = 1e-7;   // relative: entries and pivots that count as zero
template <class Space> class SharedLoad {
 public:
  explicit SharedLoad(const SceneOf<Space>& scene) : scene_(scene) {}

  /// The largest |σμ − σ'μ'| of the contacts whose shares are open at x, and the coordinates that move; 0: none.
  /// `gap` [m]: contacts no farther open carry.
  double range(const State& x, double gap, VectorXd& moves) {
    collect(x, gap);
    if (constraints_.empty() || slides_ == 0) return 0;
    const Eigen::Index dof = rows_.dof(), n = static_cast<Eigen::Index>(constraints_.size());
    const VectorXd root = rows_.inverse_mass.cwiseSqrt();
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
    double most = 0;
    const auto open = [&](std::size_t k) {
      return signed_mu_[k] && Z.row(static_cast<Eigen::Index>(k)).norm() > kRounded;
    };
    for (std::size_t k = 0; k < signed_mu_.size(); ++k)
      for (std::size_t i = 0; open(k) && i < k; ++i)
        if (open(i)) most = std::max(most, (*signed_mu_[k] - *signed_mu_[i]).norm());
    return most;
  }

 private:
  void collect(const State& x, double gap) {
    rows_ = closed_rows(scene_, x, gap);
    constraints_.clear(), forces_.clear(), signed_mu_.clear();
    slides_ = 0;
    const auto add = [&](const VectorXd& constraint, const VectorXd& force, std::optional<VectorXd> signed_mu = {}) {
      constraints_.push_back(constraint), forces_.push_back(force), signed_mu_.push_back(std::move(signed_mu));
    };
    for (const VectorXd& row : rows_.joints) add(row, row);
    for (const ClosedContactRows& c : rows_.contacts) {
      const VectorXd &N = c.normal, &slip = c.slip;
      const std::vector<VectorXd>& T = c.tangents;
      const double mu = std::max(c.law.mu, c.law.mu_static);
      const bool stuck = mu > 0 && slip.norm() < kSticks, slides = !(mu <= 0 || stuck);
      VectorXd force = N, signed_mu = VectorXd::Zero(kPlanar<Space> ? 1 : 3);
      for (std::size_t i = 0; slides && i < T.size(); ++i) {
        const double part = mu * slip[static_cast<Eigen::Index>(i)] / slip.norm();
        force -= part * T[i];
        signed_mu += part * c.direction[i];
      }
      stuck ? add(N, N) : add(N, force, signed_mu);
      for (std::size_t i = 0; stuck && i < T.size(); ++i) add(T[i], T[i]);
      slides_ += slides;
    }
  }

  const SceneOf<Space>& scene_;
  ClosedRows rows_;
  std::vector<VectorXd> constraints_, forces_;
  std::vector<std::optional<VectorXd>> signed_mu_;  // along the tangent (in space: in the world); none: does not slide
  int slides_ = 0;
};

/// The state at the last impact before row r, from there back as in free flight; [m] the error of gaps by that, at the
/// most. Null: there was none since the row before.
template <class Space> const Event* last_impact(const SceneOf<Space>& scene, const MeasureOf<Space>& measure,
                                                const Trace& trace, std::size_t r, State& at, double& error) {
  const Event* last = nullptr;
  for (const Event& e : trace.events)
    if (e.kind == EventKind::impact && r > 0 && e.t > trace.rows[r - 1].t && e.t <= trace.rows[r].t) last = &e;
  if (last == nullptr) return nullptr;
  at = trace.rows[r];
  const double since = at.t - last->t;
  move<Space>(at.q, -since * at.v);
  double acceleration = scene.gravity.norm();
  for (Eigen::Index b = 0; b < body_count<Space>(scene); ++b)
    acceleration += measure.reach(static_cast<BodyId>(b)) * std::pow(turning_of<Space>(at, b), 2);
  error = acceleration * since * since;
  return last;
}

double least_inertia(const Scene& scene, const Measure& /*measure*/, std::size_t b) { return scene.bodies[b].inertia; }
double least_inertia(const spatial::Scene& /*scene*/, const SpatialMeasure& measure, std::size_t b) {
  return measure.least_inertia(static_cast<BodyId>(b));
}

template <class Space> double left_open(const SceneOf<Space>& scene, const Trace& trace, double size) {
  constexpr int n = Space::kVelocities, translations = Space::kTranslations;
  SharedLoad<Space> shared(scene);
  const MeasureOf<Space> measure(scene);
  double sum = 0;
  VectorXd moves;
  for (std::size_t r = 0; r < trace.rows.size(); ++r) {
    if (!(trace.pressed[r] > 0)) continue;
    double range = shared.range(trace.rows[r], kCarrying, moves);
    State struck;
    double error = 0;
    const Event* hit = last_impact<Space>(scene, measure, trace, r, struck, error);
    if (range == 0 && hit != nullptr) range = shared.range(struck, kCarrying + error, moves);
    double compliance = 0;  // [1/(N s)] of the motion that goes farthest: sizes/s, rad/s
    for (std::size_t b = 0; range > 0 && b < scene.bodies.size(); ++b) {
      const auto at = static_cast<Eigen::Index>(n * b);
      if (moves.segment<translations>(at).norm() > kRounded)
        compliance = std::max(compliance, 1 / (scene.bodies[b].mass * size));
      if (moves.segment<n - translations>(at + translations).norm() > kRounded)
        compliance = std::max(compliance, measure.reach(static_cast<BodyId>(b)) / least_inertia(scene, measure, b));
    }
    sum += range * trace.pressed[r] * compliance * (trace.end() - (hit != nullptr ? hit->t : trace.rows[r].t));
  }
  return sum;
}

}  // namespace

double friction_left_open(const Scene& scene, const Trace& trace, double size) {
  return left_open<Planar>(scene, trace, size);
}
double friction_left_open(const spatial::Scene& scene, const Trace& trace, double size) {
  return left_open<Spatial>(scene, trace, size);
}

}  // namespace orthant::motion_storm
