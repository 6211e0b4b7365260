#include <orthant/integrators/derivatives/lyapunov.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kRank = 1e-10;  // of joint rows, relative
constexpr double kLost = 1e-11;  // of a column of length 1: the differences of the tangents round it off

/// Directions (q̇, v̇) that the joints leave, orthonormal and mixed: the first ones have parts of all.
Eigen::MatrixXd free_directions(const System& system) {
  const Eigen::Index dof = system.dof();
  Terms terms(system);
  const State start = system.initial_state();
  set_poses(system, start.t, start.q, terms.at);
  evaluate_joint_rows(system, terms);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(system.joint_rows(), dof);
  for (Eigen::Index i = 0; i < G.rows(); ++i)
    each_entry(terms.G[static_cast<std::size_t>(i)], [&](Eigen::Index place, double value) { G(i, place) += value; });
  Eigen::MatrixXd kernel = Eigen::MatrixXd::Identity(dof, dof);
  if (G.rows() > 0) {
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(G.transpose());
    qr.setThreshold(kRank);
    kernel = Eigen::MatrixXd(qr.householderQ()).rightCols(dof - qr.rank());
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * dof, 2 * kernel.cols());
  all.topLeftCorner(dof, kernel.cols()) = kernel;
  all.bottomRightCorner(dof, kernel.cols()) = kernel;
  Eigen::MatrixXd mix(all.cols(), all.cols());
  for (Eigen::Index i = 0; i < mix.rows(); ++i)
    for (Eigen::Index j = 0; j < mix.cols(); ++j)
      mix(i, j) = std::cos(static_cast<double>(1 + i * i + 3 * j + 2 * i * j));
  return all * Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(mix).householderQ());
}

}  // namespace

Lyapunov lyapunov_exponents(const System& system, const EventDrivenOptions& options, Solver& solver,
                            const LyapunovClock& clock, const std::atomic<bool>* cancel) {
  if (!(clock.transient >= 0) || !std::isfinite(clock.transient))
    throw std::invalid_argument("transient: must be >= 0 and finite");
  if (!(clock.every > 0) || !(clock.every <= clock.duration))
    throw std::invalid_argument("every: must be > 0, and the duration at most");
  const Eigen::MatrixXd directions = free_directions(system);
  if (clock.count < 1 || clock.count > directions.cols())
    throw std::invalid_argument("count: must be 1 ... " + std::to_string(directions.cols()) +
                                ", twice the scene's degrees of freedom");
  const Eigen::Index dof = system.dof(), count = clock.count;
  std::vector<RunParameter> columns;  // their starts are replaced by `directions`
  for (Eigen::Index i = 0; i < count; ++i) columns.push_back({"direction", 0, {}, i});

  Lyapunov result;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count), late = sum;
  double begun = kInf, half = kInf, last = 0;
  Eigen::MatrixXd both(2 * dof, count);
  const auto orthonormalize = [&](const State& x, Eigen::MatrixXd& dq, Eigen::MatrixXd& dv) {
    if (x.t == system.initial_state().t) {
      dq = directions.topLeftCorner(dof, count), dv = directions.bottomLeftCorner(dof, count);
      if (clock.transient == 0) begun = x.t;
      return;
    }
    both << dq, dv;
    for (Eigen::Index i = 0; i < count; ++i) {  // Gram and Schmidt, twice
      for (int pass = 0; pass < 2; ++pass)
        for (Eigen::Index j = 0; j < i; ++j) both.col(i) -= both.col(j).dot(both.col(i)) * both.col(j);
      const double length = both.col(i).norm();
      const double grown = length > kLost ? std::log(length) : -kInf;
      if (x.t > begun) sum[i] += grown;
      if (x.t > half) late[i] += grown;
      both.col(i) *= length > kLost ? 1 / length : 0;
    }
    dq = both.topRows(dof), dv = both.bottomRows(dof);
    last = x.t;
    const double after = x.t - system.initial_state().t - clock.transient;
    if (begun == kInf && after >= -1e-9 * clock.every) begun = x.t;
    if (half == kInf && begun < kInf && x.t - begun >= clock.duration / 2) half = x.t;
  };
  const MotionTangent motion = differentiate_motion(system, columns, options, solver, clock.transient + clock.duration,
                                                    clock.every, orthonormalize, cancel);
  result.status = motion.status, result.why = motion.why, result.final = motion.final, result.none = motion.none;
  result.exponents = sum / (last - begun), result.last_half = late / (last - half);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return result.exponents[a] > result.exponents[b]; });
  result.exponents = result.exponents(order).eval(), result.last_half = result.last_half(order).eval();
  return result;
}

}  // namespace orthant
