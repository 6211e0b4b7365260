#include <orthant/integrators/step/rank_deficiency.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// Impulses so large that they move next to nothing.
bool strained(const StepProblem& problem, const Vector& z) {
  constexpr double kMuch = 1e8;
  if (!problem.dense() || problem.contacts().size() < 2) return false;
  const double limit = kMuch * problem.b().lpNorm<Eigen::Infinity>();
  bool any = false;
  problem.each_contact(
      [&](Index i, Index, Index, const StepProblem::Contact&) { any = any || problem.entry(i, i) * z[i] > limit; });
  return any;
}

}  // namespace

RankDeficiency::RankDeficiency(const System& system, Form form) : system_(system) {
  const auto contacts = static_cast<std::size_t>(system.contacts());
  held_.reserve(contacts);
  if (form == Form::full && system.joint_rows() > 0 && contacts > 0) immobility_.emplace(system);
}

bool RankDeficiency::stand() {
  if (stands_) return true;
  if (anchor_ == nullptr) return false;
  if (!immobility_) immobility_.emplace(system_);
  return stands_ = immobility_->stand(anchor_t_, *anchor_, terms_->pairs);
}

/// A drive may move an open contact inwards, or a closed one only in the first part of the step, and back. rate: [m/s]
/// of the gap at the anchor.
bool RankDeficiency::pressed(const StepProblem::Contact& c, double rate) {
  constexpr double kBent = 0.1;  // of the change of the rate until the middle: what the rate there leaves out
  if (!(ahead_ > 0)) return true;
  const double gap = immobility_->gap(c.index);
  stands_ = false;
  if (!immobility_->stand(*terms_)) return true;
  const Immobility::Verdict middle = immobility_->judge(terms_->closed[c.closed].rows.normal);
  if (!stand() || !middle.immobile) return true;
  return gap + ahead_ * middle.rate < -ahead_ * kBent * std::abs(middle.rate - rate);
}

Held RankDeficiency::judge(const StepProblem::Contact& c, const ContactRows& rows, bool frictional) {
  const Immobility::Verdict normal = immobility_->judge(rows.normal);
  if (normal.immobile) return normal.rate < 0 && pressed(c, normal.rate) ? Held::inwards : Held::normal;
  if (!frictional) return Held::nowhere;
  const Immobility::Verdict tangent = immobility_->judge(rows.tangent);  // one that is driven keeps its slip
  return tangent.immobile && tangent.rate == 0 ? Held::tangent : Held::nowhere;
}

bool RankDeficiency::find(const StepProblem& problem) {
  if (system_.joint_rows() == 0 || problem.no_normal() >= 0) return false;
  const bool full = problem.form() == Form::full;
  if (full && !problem.contacts().empty() && !stand()) return false;
  const Eigen::VectorXd& inverse_mass = system_.inverse_mass();
  problem.each_contact([&](Index i, Index edge, Index tangent, const StepProblem::Contact& c) {
    const ContactRows& rows = terms_->closed[c.closed].rows;
    const auto looks = [&](const Row& row, double effective) {
      return Immobility::suspicious(row, effective, inverse_mass);
    };
    const bool frictional = edge >= 0 || tangent >= 0;
    bool suspicious = full;
    if (!full) {
      const double one = problem.entry(i, i), other = edge >= 0 ? problem.entry(edge, edge) : 0,
                   both = edge >= 0 ? problem.entry(i, edge) : 0;
      suspicious = looks(rows.normal, edge >= 0 ? (one + 2 * both + other) / 4 : one) ||
                   (edge >= 0 && looks(rows.tangent, (one - 2 * both + other) / (4 * c.mu * c.mu))) ||
                   (tangent >= 0 && looks(rows.tangent, problem.entry(tangent, tangent)));
      if (!suspicious || !stand()) return;
    }
    const ContactRows there = immobility_->rows(c.index);
    if (full && !looks(there.normal, immobility_->effective(there.normal)) &&
        !(frictional && looks(there.tangent, immobility_->effective(there.tangent))))
      return;
    const Held held = judge(c, there, frictional);
    if (held == Held::nowhere) return;
    held_.resize(terms_->closed.size(), Held::nowhere);
    held_[c.closed] = held;
  });
  return !held_.empty();
}

/// Of the contacts' impulses u, by the problem's own rows, of joints on the step's way and contacts at its end maybe,
/// and where the joints hold: levers differ by what the step turns.
Immobility::Verdict RankDeficiency::judge(const StepProblem& problem, const Vector& u, bool tangents) {
  const auto judge_rows = [&](const auto& rows_of) {
    immobility_->begin();
    problem.each_contact([&](Index i, Index edge, Index, const StepProblem::Contact& c) {
      const ContactRows rows = rows_of(c);
      immobility_->add(rows.normal, u[i] + (edge >= 0 ? u[edge] : 0));
      if (edge >= 0 && tangents) immobility_->add(rows.tangent, c.mu * (u[i] - u[edge]));
    });
    return immobility_->judge();
  };
  const Immobility::Verdict verdict =
      judge_rows([&](const StepProblem::Contact& c) { return immobility_->rows(c.index); });
  stands_ = false;
  if (verdict.immobile || !immobility_->stand(*terms_)) return verdict;
  return judge_rows([&](const StepProblem::Contact& c) { return terms_->closed[c.closed].rows; });
}

bool RankDeficiency::give_way(StepProblem& problem, const Solution& solution, bool solved, StepReport& report) {
  const Status status = solution.status;
  if (status == Status::time_limit || status == Status::cancelled || status == Status::unsupported) return false;
  const bool claimed = !solved && status == Status::infeasible;
  const Vector& hint = solution.certificate.size() > 0 ? solution.certificate : solution.ray;
  const Vector& u = !solved && hint.size() == problem.size() ? hint : solution.z;
  if ((solved && !strained(problem, solution.z)) || u.size() != problem.size() || !u.allFinite()) return false;
  double part = 0;  // of the contacts
  bool jammed = false;
  const double most = u.lpNorm<Eigen::Infinity>();
  problem.each_contact([&](Index i, Index edge, Index, const StepProblem::Contact& c) {
    const double own = std::max(std::abs(u[i]), edge >= 0 ? std::abs(u[edge]) : 0);
    part = std::max(part, own), jammed = jammed || (c.jammed != nullptr && own > kPartOfProof * most);
  });
  if (jammed || !(part > kPartOfProof * most) || terms_ == nullptr || !stand()) return false;
  direction_.resize(u.size());
  direction_.setZero();  // what friction does is no part of a combination that contradicts itself
  problem.each_contact([&](Index i, Index edge, Index, const StepProblem::Contact&) {
    direction_[i] = std::max(0.0, u[i]);
    if (edge >= 0) direction_[edge] = std::max(0.0, u[edge]);
  });
  const Immobility::Verdict verdict = judge(problem, direction_);
  if (verdict.immobile && verdict.rate < 0) {
    if (claimed && lifts(problem, direction_)) relaxed_ = true, report.status = Status::stalled;
    return false;
  }
  if (problem.form() == Form::full) direction_.head(system_.joint_rows()) = immobility_->loads();
  if (verdict.immobile && relax(problem, direction_)) return true;
  if (claimed) undecided_ = true, report.status = Status::numerical_error;
  return false;
}

/// Whether drives contradict u only through slip: relaxed cones ask a contact that slides to open, and of contacts on
/// both sides of a body to open both.
bool RankDeficiency::lifts(const StepProblem& problem, const Vector& u) {
  bool any = false;
  problem.each_contact(
      [&](Index i, Index edge, Index, const StepProblem::Contact&) { any = any || (edge >= 0 && u[i] != u[edge]); });
  if (!any) return false;
  stands_ = false;
  if (!stand()) return false;
  const Immobility::Verdict normals = judge(problem, u, false);
  return !(normals.immobile && normals.rate < 0);
}

/// The targets of what u combines give way by as much as its rates are inconsistent: those that restitution asks for
/// first.
bool RankDeficiency::relax(StepProblem& problem, const Vector& u) {
  constexpr double kSlack = 1e-12;  // of what the combination's rate is summed of: solvers meet no tie
  double missing = -u.dot(problem.b()), rebound = 0, square = 0;
  const double sum = u.cwiseAbs().dot(problem.b().cwiseAbs());
  problem.each_contact([&](Index i, Index edge, Index, const StepProblem::Contact& c) {
    for (const Index row : {i, edge})
      if (row >= 0 && u[row] > 0) rebound += u[row] * c.rebound, square += u[row] * u[row];
  });
  missing += kSlack * sum;
  if (!(missing > 0) || !(square > 0) || !std::isfinite(missing)) return false;
  const double share = rebound > 0 ? std::min(1.0, missing / rebound) : 0;
  missing -= share * rebound;
  Index next = problem.joint_rows();
  for (StepProblem::Contact& c : problem.contacts()) {
    const Index last = next + (problem.has_edges(c) ? 2 : 1);
    double most = 0;
    for (; next < last; ++next) {
      most = std::max(most, u[next]);
      if (u[next] > 0) problem.give(next, share * c.rebound + missing * u[next] / square);
    }
    if (most > 0) c.rebound *= 1 - share;
  }
  return true;
}

}  // namespace orthant
