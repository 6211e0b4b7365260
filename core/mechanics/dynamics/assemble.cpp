#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/support/options.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kMostTurn = 0.5;  // [rad] of a body in one step, at the most
constexpr double kClosed = 1e-13;  // of 1 m + the largest coordinate: rounding

class Assembly {
 public:
  explicit Assembly(const System& system)
      : system_(system), terms_(system), start_(system.initial_state()), root_(system.mass().cwiseSqrt()) {
    for (std::size_t i = 0; i < system.scene().contacts.size(); ++i)
      if (std::holds_alternative<Journal>(system.scene().contacts[i])) journals_.push_back(static_cast<int>(i));
    held_.assign(journals_.size(), false);
  }

  /// q: from the scene's start to the nearest place that closes all. False: not found.
  bool find(Eigen::VectorXd& q) {
    constexpr int kNear = 200, kAnyhow = 200;
    q = start_.q;
    for (int i = 0; i < kNear; ++i)
      if (step(q, true)) return true;
    q = start_.q;
    for (int i = 0; i < kAnyhow; ++i)
      if (step(q, false)) return true;
    evaluate(q);
    return off() <= 1e3 * zero(q);
  }

  /// In words: the joint with the largest residual at the last q.
  std::string off_most_words() const {
    double most = 0;
    std::string words;
    std::size_t row = 0;
    for (const Joint& joint : system_.scene().joints)
      for (int k = 0; k < row_count(joint); ++k, ++row)
        if (const double off = std::abs(terms_.phi[static_cast<Index>(row)]); !(off <= most)) {
          most = off;
          words = "joint \"" + std::visit([](const auto& j) { return j.name; }, joint) + "\" is off by " +
                  detail::text_of(off) + " m or rad";
        }
    for (const int j : journals_)
      if (-terms_.gap[j] > most) {
        most = -terms_.gap[j];
        words = "journal \"" + name_of(j) + "\" is off by " + detail::text_of(most) + " m";
      }
    return words;
  }

 private:
  std::string name_of(int contact) const {
    const Contact& named = system_.scene().contacts[static_cast<std::size_t>(contact)];
    return std::visit([](const auto& c) { return c.name; }, named);
  }
  void evaluate(const Eigen::VectorXd& q) {
    set_poses(system_, start_.t, q, terms_.at);
    evaluate_joint_residual(system_, terms_);
    evaluate_joint_rows(system_, terms_);
    evaluate_gaps(system_, terms_);
    evaluate_closed(system_, journals_, terms_);
  }
  double zero(const Eigen::VectorXd& q) const { return kClosed * (1 + q.lpNorm<Eigen::Infinity>()); }
  double off() const {
    double most = terms_.phi.size() > 0 ? terms_.phi.lpNorm<Eigen::Infinity>() : 0;
    for (const int j : journals_) most = std::max(most, -terms_.gap[j]);
    return most;
  }

  /// One step of q; near: to the place nearest to the start, else to the nearest at all. True: it is there.
  bool step(Eigen::VectorXd& q, bool near) {
    evaluate(q);
    const bool closed = off() <= zero(q);
    std::vector<std::size_t> taking_part;
    for (std::size_t k = 0; k < journals_.size(); ++k)
      if (held_[k] || terms_.gap[journals_[k]] < 0) taking_part.push_back(k);
    const Index joints = terms_.phi.size(), rows = joints + static_cast<Index>(taking_part.size());
    if (rows == 0) return true;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(system_.dof(), rows);
    Eigen::VectorXd missing(rows);
    for (Index i = 0; i < joints; ++i) {
      apply_transposed(terms_.G[static_cast<std::size_t>(i)], 1.0, J.col(i).data());
      missing[i] = -terms_.phi[i];
    }
    for (Index i = joints; i < rows; ++i) {
      const std::size_t k = taking_part[static_cast<std::size_t>(i - joints)];
      apply_transposed(terms_.closed[k].rows.normal, 1.0, J.col(i).data());
      missing[i] = -terms_.gap[journals_[k]];
    }
    J = root_.cwiseInverse().asDiagonal() * J;
    const Eigen::VectorXd length = J.colwise().norm().transpose().cwiseMax(1e-300);
    J = J * length.cwiseInverse().asDiagonal();
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> A(J.transpose());
    const Eigen::VectorXd back =
        near ? Eigen::VectorXd(root_.cwiseProduct(between(q, start_.q))) : Eigen::VectorXd::Zero(q.size());
    const Eigen::VectorXd pushed = A.solve(missing.cwiseQuotient(length) - J.transpose() * back);
    const Eigen::VectorXd forces = A.transpose().solve(pushed);
    for (Index i = joints; i < rows; ++i) held_[taking_part[static_cast<std::size_t>(i - joints)]] = forces[i] > 0;
    Eigen::VectorXd step = root_.cwiseInverse().cwiseProduct(back + pushed);
    if (const double turn = largest_rotation(step); turn > kMostTurn) step *= kMostTurn / turn;
    if (closed && (!near || step.lpNorm<Eigen::Infinity>() <= 1e-9 * (1 + q.lpNorm<Eigen::Infinity>()))) return true;
    move(q, step);
    return false;
  }

  const System& system_;
  Terms terms_;
  State start_;
  Eigen::VectorXd root_;  // √M
  std::vector<int> journals_;
  std::vector<bool> held_;  // at the bearing
};

}  // namespace

Scene assembled(const Scene& scene) {
  Scene moved = scene;
  moved.assemble = false;
  const System system(moved);
  Assembly assembly(system);
  Eigen::VectorXd q;
  if (!assembly.find(q))
    throw std::invalid_argument("assemble = true: " + assembly.off_most_words() +
                                " at the best place found: must be reachable from where the scene puts its bodies");
  for (std::size_t i = 0; i < moved.bodies.size(); ++i) {
    const auto body = static_cast<BodyId>(i);
    moved.bodies[i].position = translation(q, body), moved.bodies[i].angle = rotation(q, body);
  }
  return moved;
}

OffMost off_most(const System& system, double t, const Eigen::VectorXd& q) {
  Terms terms(system);
  set_poses(system, t, q, terms.at);
  evaluate_joint_residual(system, terms);
  OffMost most;
  Index row = 0;
  for (const Joint& joint : system.scene().joints)
    for (int k = 0; k < row_count(joint); ++k, ++row)
      if (const double off = std::abs(terms.phi[row]); off > most.off)
        most = {off, std::visit([](const auto& j) { return j.name; }, joint)};
  return most;
}

}  // namespace orthant
