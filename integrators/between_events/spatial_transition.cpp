#include <orthant/integrators/between_events/spatial_transition.h>
#include <orthant/integrators/between_events/transition_words.h>
#include <orthant/solvers/pivoting/enumerate.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {

SpatialTransition::SpatialTransition(const SystemOf<Spatial>& system)
    : system_(system), equations_(system, 3 * system.scene().contacts.size()) {}

/// Contacts that joints immobilise are no candidates: no force moves them, and they go where the joints take them.
void SpatialTransition::leave_out_immobile(SpatialMotion& motion) {
  if (candidates.empty() || system_.joint_rows() == 0) return;
  contacts_.clear(), equations_.clear();
  for (const Candidate& c : candidates) contacts_.push_back(c.contact);
  evaluate_closed(system_, contacts_, motion.terms());
  const auto& closed = motion.terms().closed;
  for (const auto& c : closed) equations_.add(c.rows.normal, c.rows.normal, 0);
  equations_.assemble(motion.basic(), motion.free());
  std::size_t i = 0;
  std::erase_if(candidates, [&](const Candidate&) {
    const auto row = static_cast<Index>(i);
    return immobile(closed[i++].rows.normal, equations_.A(row, row), system_.inverse_mass());
  });
}

/// Rows: the normals of all candidates, then the tangents of those with friction that do not slide.
void SpatialTransition::formulate(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  contacts_.clear(), rows_.clear(), equations_.clear(), lcp_.friction.clear();
  for (const Candidate& c : candidates) contacts_.push_back(c.contact);
  evaluate_closed(system_, contacts_, motion.terms());
  std::vector<RowOf<Spatial>> tangents;
  std::vector<SpatialMotion::Bias> biases;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    const ContactRowsOf<Spatial>& rows = motion.terms().closed[i].rows;
    rows_.push_back(rows), biases.push_back(motion.bias(c.contact, q, v));
    RowOf<Spatial> force = rows.normal;
    if (c.slides) {
      const Tangents along = along_tangents(rows, c.direction);
      const double mu = system_.law(c.contact).mu;
      force = combined(force, -mu * along.first, rows.tangents[0]);
      force = combined(force, -mu * along.second, rows.tangents[1]);
    }
    equations_.add(rows.normal, force, biases[i].normal);
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const double mu = static_friction(system_.law(candidates[i].contact));
    if (candidates[i].slides || mu <= 0) continue;
    lcp_.friction.push_back({.normal = static_cast<Index>(i), .first = equations_.size(), .rows = 2, .mu = mu});
    for (std::size_t k = 0; k < 2; ++k) {
      equations_.add(rows_[i].tangents[k], rows_[i].tangents[k], tangent_part(biases[i].tangent, k));
      tangents.push_back(rows_[i].tangents[k]);
    }
  }
  equations_.assemble(motion.basic(), motion.free());
  const Index n = equations_.size(), normals = static_cast<Index>(candidates.size());
  for (Index i = normals; i < n; ++i) {
    const RowOf<Spatial>& row = tangents[static_cast<std::size_t>(i - normals)];
    if (!immobile(row, equations_.A(i, i), system_.inverse_mass())) continue;
    const double free = coupling(row, row, system_.inverse_mass());
    equations_.A.row(i).setZero(), equations_.A.col(i).setZero();
    equations_.A(i, i) = free > 0 ? free : 1, equations_.b[i] = 0;
  }
  as<DenseMatrix>(lcp_.A) = equations_.A;
  lcp_.b = equations_.b;
  lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.hi.setConstant(kInf), lcp_.lo.setConstant(-kInf);
  lcp_.lo.head(normals).setZero();
}

/// More than one solution, or none, is possible already for one contact by itself.
bool SpatialTransition::doubtful() const {
  for (Index i = 0; i < static_cast<Index>(candidates.size()); ++i)
    if (equations_.A(i, i) <= 0) return true;
  return std::ranges::any_of(lcp_.friction, [&](const Friction& f) {
    return equations_.A(f.normal, f.normal) <= f.mu * equations_.A.row(f.normal).segment(f.first, 2).norm();
  });
}

/// Whether the certificate stands against rounding of the problem, and what contradicts.
SpatialTransition::Proof SpatialTransition::proof() const {
  constexpr double kProof = 1e-8, kStill = 1e-9;
  const Vector& u = solution_.certificate;
  if (solution_.status != Status::infeasible || u.size() != lcp_.size() ||
      lcp_.b.dot(u) >= -kProof * lcp_.b.lpNorm<Eigen::Infinity>() * u.lpNorm<1>())
    return Proof::none;
  const double moved = (equations_.A.transpose() * u).lpNorm<Eigen::Infinity>();
  const double most = (equations_.A.cwiseAbs().transpose() * u.cwiseAbs()).lpNorm<Eigen::Infinity>();
  return moved <= kStill * most ? Proof::immobile : Proof::paradox;
}

/// All forces of a single contact without slip.
std::vector<Vector> SpatialTransition::all_of_one() const {
  constexpr int kDirections = 720, kBisections = 60;
  const Eigen::Matrix3d A = equations_.A;
  const Vector3d b = lcp_.b;
  const double mu = lcp_.friction[0].mu;
  std::vector<Vector> found;
  if (b[0] >= 0) found.push_back(Vector::Zero(3));
  const Vector3d stick = A.fullPivLu().solve(-b);
  if (stick[0] > 0 && stick.tail<2>().norm() <= mu * stick[0]) found.push_back(stick);
  const auto across = [&](double angle) {
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle)), change = b.tail<2>(),
                                                               by = A.block<2, 1>(1, 0) - mu * A.block<2, 2>(1, 1) * d;
    const Eigen::Vector2d w = change * (A(0, 0) - mu * A.block<1, 2>(0, 1).dot(d)) - b[0] * by;
    return d.x() * w.y() - d.y() * w.x();
  };
  for (int k = 0; k < kDirections; ++k) {
    double low = 2 * std::numbers::pi * k / kDirections, high = 2 * std::numbers::pi * (k + 1) / kDirections;
    const double start = across(low);
    if (start * across(high) > 0 || across(high) == 0) continue;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = (low + high) / 2;
      (start * across(middle) > 0 ? low : high) = middle;
    }
    const Eigen::Vector2d d(std::cos(high), std::sin(high));
    const double push = -b[0] / (A(0, 0) - mu * A.block<1, 2>(0, 1).dot(d));
    const Eigen::Vector2d w = b.tail<2>() + push * (A.block<2, 1>(1, 0) - mu * A.block<2, 2>(1, 1) * d);
    if (push > 0 && w.dot(d) > 0) found.push_back(Vector3d(push, -mu * push * d.x(), -mu * push * d.y()));
  }
  return found;
}

/// All solutions with different accelerations. False: they are not looked for.
bool SpatialTransition::find_all(const Eigen::VectorXd& free, std::vector<Vector>& different) const {
  constexpr Index kMostRows = 12;
  std::vector<Vector> found;
  if (lcp_.friction.empty() && lcp_.size() <= kMostRows && finite(lcp_)) {
    const SolutionSet set = enumerate_solutions(lcp_);
    found = set.isolated;
    for (const SolutionFace& face : set.faces) found.insert(found.end(), face.vertices.begin(), face.vertices.end());
  } else if (candidates.size() == 1 && lcp_.size() == 3 && finite(lcp_)) {
    found = all_of_one();
  } else {
    return false;
  }
  different = with_different_accelerations(found, equations_, lcp_.b, free);
  return true;
}

/// The judge's status, `unsupported` for several solutions; why_ says so in words.
Status SpatialTransition::examine(const Eigen::VectorXd& free) {
  if (has_answer(solution_.status) && !doubtful()) return Status::solved;
  const Proof proved = proof();
  if (proved == Proof::paradox) why_ = kNoAcceleration;
  if (proved == Proof::immobile)
    why_ = contacts_together("no motion satisfies", system_, candidates, solution_.certificate);
  if (proved != Proof::none) return solution_.status;
  std::vector<Vector> all;
  const bool complete = find_all(free, all);
  if (all.size() > 1) {
    why_ = several_in_words(all, candidates.size());
    return Status::unsupported;
  }
  if (has_answer(solution_.status)) return Status::solved;
  if (complete && all.empty()) {
    why_ = kNoAcceleration;
    return Status::infeasible;
  }
  if (complete) {  // the solver missed it
    solution_.z = all.front(), solution_.w = equations_.A * solution_.z + lcp_.b;
    return Status::solved;
  }
  undecided_ = true;
  why_ = solution_.status == Status::infeasible
             ? contacts_together("rounding leaves undecided whether accelerations satisfy", system_, candidates,
                                 solution_.certificate)
             : std::string(kNotSolved);
  return solution_.status == Status::infeasible ? Status::numerical_error : solution_.status;
}

/// [m/s²] what rounding makes of accelerations that are zero.
double SpatialTransition::zero() const {
  return std::max(1e-12 * lcp_.b.lpNorm<Eigen::Infinity>(), 32 * solution_.rounding);
}

/// Contacts whose friction is at its bound slide from now on. True: with another coefficient, to be solved again.
bool SpatialTransition::slide_off() {
  bool again = false;
  const double zero = this->zero();
  for (const Friction& f : lcp_.friction) {
    const Tangents force{solution_.z[f.first], solution_.z[f.first + 1]},
        slip{solution_.w[f.first], solution_.w[f.first + 1]};
    const double slack = f.mu * solution_.z[f.normal] - size_of(force);
    const double stiff = std::max(equations_.A(f.first, f.first), equations_.A(f.first + 1, f.first + 1));
    if (size_of(slip) <= stiff * std::max(slack, 0.0) + zero) continue;
    Candidate& c = candidates[static_cast<std::size_t>(f.normal)];
    c.slides = c.departs = true;
    c.direction = in_world(rows_[static_cast<std::size_t>(f.normal)], slip) / size_of(slip);
    again = again || system_.law(c.contact).mu != f.mu;
  }
  return again;
}

Status SpatialTransition::decide(SpatialMotion& motion, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                 Solver& solver, StepReport& report) {
  lcp_.b.resize(0), why_.clear(), undecided_ = false;
  leave_out_immobile(motion);
  if (!candidates.empty()) {
    do {
      formulate(motion, q, v);
      solver.solve(lcp_, solution_);
      refinement_.improve(lcp_, solution_);
      even_share_.improve(lcp_, std::ssize(candidates), solver, solution_);
      const double velocity_residual = report.lcp_residual;  // that one is in m/s, not m/s²
      report.note(lcp_, solution_);
      report.lcp_residual = velocity_residual;
      report.status = examine(motion.free());
      if (report.status != Status::solved) return report.status;
    } while (slide_off());
  }
  std::fill(motion.modes.begin(), motion.modes.end(), SpatialMode{});
  const double zero = lcp_.size() > 0 ? this->zero() : 0;
  const double most = candidates.empty() ? 0 : solution_.z.head(static_cast<Index>(candidates.size())).maxCoeff();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const Candidate& c = candidates[i];
    const double push = equations_.A(row, row) * solution_.z[row];
    SpatialMode& mode = motion.modes[static_cast<std::size_t>(c.contact)];
    const bool rests = most > 0 && std::abs(solution_.w[row]) <= zero && push >= -zero;  // others bear its load
    mode.lasting = (push > solution_.w[row] && push > zero) || rests;
    if (!mode.lasting) continue;
    mode.slides = c.slides, mode.departs = c.departs, mode.departure = c.direction;
    mode.sticks = !c.slides && static_friction(system_.law(c.contact)) > 0;
    mode.share_normal = std::max(solution_.z[row], kLeastShare * most);
    mode.share_tangent = static_friction(system_.law(c.contact)) * mode.share_normal;
  }
  motion.modes_changed();
  return Status::solved;
}

}  // namespace orthant
