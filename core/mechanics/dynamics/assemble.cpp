#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/spatial/alignment.h>
#include <orthant/core/support/options.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kMostTurn = 0.5;  // [rad] of a body in one step, at the most
constexpr double kClosed = 1e-13;  // of 1 m (or length_unit()) + the largest coordinate: rounding

/// In place of equations of right angles, which hold for opposite directions, too, and have no gradient where
/// directions are at right angles that should be parallel: the turn that is missing, where it is large.
void replace_far_turns(const System& /*system*/, Terms& /*terms*/) {}
void replace_far_turns(const SystemOf<Spatial>& system, TermsOf<Spatial>& terms) {
  constexpr double kFarTurn = 1;  // [rad]
  std::size_t row = 0;
  for (const auto& joint : system.scene().joints) {
    spatial::with_alignment(joint, terms.at, [&](const spatial::Alignment& one) {
      if (one.turn.norm() < kFarTurn) return;
      for (int i = 0; i < one.rows; ++i) {
        const std::size_t k = row + static_cast<std::size_t>(one.row + i);
        terms.G[k] = one.rate(terms.at, i), terms.phi[static_cast<Index>(k)] = -one.missing(i);
      }
    });
    row += static_cast<std::size_t>(row_count(joint));
  }
}

/// A joint with clearance.
bool has_clearance(const Contact& contact) { return std::holds_alternative<Journal>(contact); }
bool has_clearance(const spatial::Contact& contact) {
  return std::holds_alternative<spatial::Socket>(contact) || std::holds_alternative<spatial::PinBush>(contact) ||
         std::holds_alternative<spatial::SphereBush>(contact);
}

void put(Body& body, const Eigen::VectorXd& q, BodyId i) {
  body.position = translation(q, i), body.angle = rotation(q, i);
}
void put(spatial::Body& body, const Eigen::VectorXd& q, BodyId i) {
  const Eigen::Vector4d back{body.axes[0], -body.axes[1], -body.axes[2], -body.axes[3]};
  body.position = place_of<Spatial>(q, i);
  body.orientation = quaternions::product(quaternion(q, i), back);
}

template <class Space> class Assembly {
 public:
  explicit Assembly(const SystemOf<Space>& system)
      : system_(system), terms_(system), start_(system.initial_state()), root_(system.mass().cwiseSqrt()) {
    for (std::size_t i = 0; i < system.scene().contacts.size(); ++i)
      if (has_clearance(system.scene().contacts[i])) clearances_.push_back(static_cast<int>(i));
    held_.assign(clearances_.size(), false);
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
    for (const auto& joint : system_.scene().joints)
      for (int k = 0; k < row_count(joint); ++k, ++row)
        if (const double off = std::abs(terms_.phi[static_cast<Index>(row)]); !(off <= most)) {
          most = off;
          words = "joint \"" + std::visit([](const auto& j) { return j.name; }, joint) + "\" is off by " +
                  detail::text_of(off) + " m or rad";
        }
    for (const int j : clearances_)
      if (-terms_.gap[j] > most) {
        most = -terms_.gap[j];
        words = std::string(kPlanar<Space> ? "journal" : "contact") + " \"" + name_of(j) + "\" is off by " +
                detail::text_of(most) + " m";
      }
    return words;
  }

 private:
  std::string name_of(int contact) const {
    const auto& named = system_.scene().contacts[static_cast<std::size_t>(contact)];
    return std::visit([](const auto& c) { return c.name; }, named);
  }
  void evaluate(const Eigen::VectorXd& q) {
    set_poses(system_, start_.t, q, terms_.at);
    evaluate_joint_residual(system_, terms_);
    evaluate_joint_rows(system_, terms_);
    replace_far_turns(system_, terms_);
    evaluate_gaps(system_, terms_);
    evaluate_closed(system_, clearances_, terms_);
  }
  /// [units of length, rad]
  double zero(const Eigen::VectorXd& q) const { return kClosed * (1 + largest_of_all(q, terms_.unit) / terms_.unit); }
  double off() const {
    double most = 0;
    for (Index i = 0; i < terms_.phi.size(); ++i)
      most = std::max(most, std::abs(terms_.phi[i]) / terms_.unit_of_row(i));
    for (const int j : clearances_) most = std::max(most, -terms_.gap[j] / terms_.unit);
    return most;
  }

  /// One step of q; near: to the place nearest to the start, else to the nearest at all. True: it is there.
  bool step(Eigen::VectorXd& q, bool near) {
    evaluate(q);
    const bool closed = off() <= zero(q);
    std::vector<std::size_t> taking_part;
    for (std::size_t k = 0; k < clearances_.size(); ++k)
      if (held_[k] || terms_.gap[clearances_[k]] < 0) taking_part.push_back(k);
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
      missing[i] = -terms_.gap[clearances_[k]];
    }
    J = root_.cwiseInverse().asDiagonal() * J;
    const Eigen::VectorXd length = J.colwise().norm().transpose().cwiseMax(1e-300);
    J = J * length.cwiseInverse().asDiagonal();
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> A(J.transpose());
    const Eigen::VectorXd back =
        near ? Eigen::VectorXd(root_.cwiseProduct(between<Space>(q, start_.q))) : Eigen::VectorXd::Zero(system_.dof());
    const Eigen::VectorXd pushed = A.solve(missing.cwiseQuotient(length) - J.transpose() * back);
    const Eigen::VectorXd forces = A.transpose().solve(pushed);
    for (Index i = joints; i < rows; ++i) held_[taking_part[static_cast<std::size_t>(i - joints)]] = forces[i] > 0;
    Eigen::VectorXd step = root_.cwiseInverse().cwiseProduct(back + pushed);
    if (const double turn = largest_rotation<Space>(step); turn > kMostTurn) step *= kMostTurn / turn;
    if (closed && (!near || largest_of_all(step, terms_.unit) <= 1e-9 * (terms_.unit + largest_of_all(q, terms_.unit))))
      return true;
    move<Space>(q, step);
    return false;
  }

  const SystemOf<Space>& system_;
  TermsOf<Space> terms_;
  State start_;
  Eigen::VectorXd root_;  // √M
  std::vector<int> clearances_;
  std::vector<bool> held_;  // at the bearing
};

template <class Space> typename SystemOf<Space>::Scene assembly_of(typename SystemOf<Space>::Scene moved) {
  moved.assemble = true;
  check(moved);
  moved.assemble = false;
  const SystemOf<Space> system(moved, Examined::yes);
  Assembly<Space> assembly(system);
  Eigen::VectorXd q;
  if (!assembly.find(q))
    throw std::invalid_argument("assemble = true: " + assembly.off_most_words() +
                                " at the best place found: must be reachable from where the scene puts its bodies");
  moved.bodies = system.scene().bodies;  // with their principal axes
  for (std::size_t i = 0; i < moved.bodies.size(); ++i) put(moved.bodies[i], q, static_cast<BodyId>(i));
  return moved;
}

}  // namespace

Scene assembled(const Scene& scene) { return assembly_of<Planar>(scene); }
spatial::Scene assembled(const spatial::Scene& scene) { return assembly_of<Spatial>(scene); }

template <class Space> OffMost off_most(const SystemOf<Space>& system, double t, const Eigen::VectorXd& q) {
  TermsOf<Space> terms(system);
  set_poses(system, t, q, terms.at);
  evaluate_joint_residual(system, terms);
  OffMost most;
  Index row = 0;
  for (const auto& joint : system.scene().joints)
    for (int k = 0; k < row_count(joint); ++k, ++row)
      if (const double off = std::abs(terms.phi[row]); off > most.off)
        most = {off, std::visit([](const auto& j) { return j.name; }, joint)};
  return most;
}

template OffMost off_most(const SystemOf<Planar>&, double, const Eigen::VectorXd&);
template OffMost off_most(const SystemOf<Spatial>&, double, const Eigen::VectorXd&);

}  // namespace orthant
