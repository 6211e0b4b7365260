// Rank deficiency of a step's problem: contacts, and combinations of them, that joints immobilise; what its proofs mean
// then.
#include <orthant/core/support/options.h>
#include <orthant/integrators/step/formulate.h>
#include <orthant/integrators/step/jam.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kPart = 1e-6;  // of a proof's largest entry: the row takes part

}  // namespace

/// f(place of the normal's row, of the second edge or −1, of the tangent or −1, contact).
template <class F> void Formulation::each_row(F&& f) const {
  Index i = form_ == Form::full ? system_.joint_rows() : 0;
  for (const Contact& c : contacts_) {
    const bool two = cone_ == Cone::relaxed && c.mu > 0;
    f(i, two ? i + 1 : -1, places_[c.closed].tangent, c);
    i += two ? 2 : 1;
  }
}

bool Formulation::stand(const std::vector<Pair>& pairs) {
  if (stands_) return true;
  if (anchor_ == nullptr) return false;
  if (!immobility_) immobility_.emplace(system_);
  return stands_ = immobility_->stand(anchor_t_, *anchor_, pairs);
}

Formulation::Held Formulation::judge(const ContactRows& rows, bool frictional) {
  const Immobility::Verdict normal = immobility_->judge(rows.normal);
  if (normal.immobile) return normal.rate < 0 ? Held::inwards : Held::normal;
  if (!frictional) return Held::nowhere;
  const Immobility::Verdict tangent = immobility_->judge(rows.tangent);  // one that is driven keeps its slip
  return tangent.immobile && tangent.rate == 0 ? Held::tangent : Held::nowhere;
}

bool Formulation::find_immobile(const Terms& terms) {
  if (system_.joint_rows() == 0 || blank_ >= 0) return false;
  const bool full = form_ == Form::full;
  if (full && !contacts_.empty() && !stand(terms.pairs)) return false;
  const auto* A = std::get_if<DenseMatrix>(&lcp_.A);
  const Eigen::VectorXd& inverse_mass = system_.inverse_mass();
  each_row([&](Index i, Index edge, Index tangent, const Contact& c) {
    const ContactRows& rows = terms.closed[c.closed].rows;
    const auto looks = [&](const Row& row, double effective) {
      return Immobility::suspicious(row, effective, inverse_mass);
    };
    const bool frictional = edge >= 0 || tangent >= 0;
    bool suspicious = full;
    if (!full) {
      const double one = (*A)(i, i), other = edge >= 0 ? (*A)(edge, edge) : 0, both = edge >= 0 ? (*A)(i, edge) : 0;
      suspicious = looks(rows.normal, edge >= 0 ? (one + 2 * both + other) / 4 : one) ||
                   (edge >= 0 && looks(rows.tangent, (one - 2 * both + other) / (4 * c.mu * c.mu))) ||
                   (tangent >= 0 && looks(rows.tangent, (*A)(tangent, tangent)));
      if (!suspicious || !stand(terms.pairs)) return;
    }
    const ContactRows there = immobility_->rows(c.index);
    if (full && !looks(there.normal, immobility_->effective(there.normal)) &&
        !(frictional && looks(there.tangent, immobility_->effective(there.tangent))))
      return;
    const Held held = judge(there, frictional);
    if (held == Held::nowhere) return;
    held_.resize(terms.closed.size(), Held::nowhere);
    held_[c.closed] = held;
  });
  return !held_.empty();
}

/// Of the contacts' impulses u, by the problem's own rows, of joints on the step's way and contacts at its end maybe,
/// and where the joints hold: levers differ by what the step turns.
Immobility::Verdict Formulation::judge(const Vector& u, bool tangents) {
  const auto judge_rows = [&](const auto& rows_of) {
    immobility_->begin();
    each_row([&](Index i, Index edge, Index, const Contact& c) {
      const ContactRows rows = rows_of(c);
      immobility_->add(rows.normal, u[i] + (edge >= 0 ? u[edge] : 0));
      if (edge >= 0 && tangents) immobility_->add(rows.tangent, c.mu * (u[i] - u[edge]));
    });
    return immobility_->judge();
  };
  const Immobility::Verdict verdict = judge_rows([&](const Contact& c) { return immobility_->rows(c.index); });
  stands_ = false;
  if (verdict.immobile || !immobility_->stand(*terms_)) return verdict;
  return judge_rows([&](const Contact& c) { return terms_->closed[c.closed].rows; });
}

/// Impulses so large that they move next to nothing.
bool Formulation::strained() const {
  constexpr double kMuch = 1e8;
  const auto* A = std::get_if<DenseMatrix>(&lcp_.A);
  if (A == nullptr || contacts_.size() < 2) return false;
  const double limit = kMuch * lcp_.b.lpNorm<Eigen::Infinity>();
  bool any = false;
  each_row([&](Index i, Index, Index, const Contact&) { any = any || (*A)(i, i) * solution_.z[i] > limit; });
  return any;
}

bool Formulation::give_way(bool solved, StepReport& report) {
  const Status status = solution_.status;
  if (status == Status::time_limit || status == Status::cancelled || status == Status::unsupported) return false;
  const bool claimed = !solved && status == Status::infeasible;
  const Vector& hint = solution_.certificate.size() > 0 ? solution_.certificate : solution_.ray;
  const Vector& u = !solved && hint.size() == lcp_.size() ? hint : solution_.z;
  if ((solved && !strained()) || u.size() != lcp_.size() || !u.allFinite()) return false;
  double part = 0;  // of the contacts
  bool jammed = false;
  const double most = u.lpNorm<Eigen::Infinity>();
  each_row([&](Index i, Index edge, Index, const Contact& c) {
    const double own = std::max(std::abs(u[i]), edge >= 0 ? std::abs(u[edge]) : 0);
    part = std::max(part, own), jammed = jammed || (c.jammed != nullptr && own > kPart * most);
  });
  if (jammed || !(part > kPart * most) || terms_ == nullptr || !stand(terms_->pairs)) return false;
  direction_.resize(u.size());
  direction_.setZero();  // what friction does is no part of a combination that contradicts itself
  each_row([&](Index i, Index edge, Index, const Contact&) {
    direction_[i] = std::max(0.0, u[i]);
    if (edge >= 0) direction_[edge] = std::max(0.0, u[edge]);
  });
  const Immobility::Verdict verdict = judge(direction_);
  if (verdict.immobile && verdict.rate < 0) {
    if (claimed && lifts(direction_)) relaxed_ = true, report.status = Status::stalled;
    return false;
  }
  if (form_ == Form::full) direction_.head(system_.joint_rows()) = immobility_->loads();
  if (verdict.immobile && relax(direction_)) return true;
  if (claimed) undecided_ = true, report.status = Status::numerical_error;
  return false;
}

/// Whether drives contradict u only through slip: relaxed cones ask a contact that slides to open, and of contacts on
/// both sides of a body to open both.
bool Formulation::lifts(const Vector& u) {
  bool any = false;
  each_row([&](Index i, Index edge, Index, const Contact&) { any = any || (edge >= 0 && u[i] != u[edge]); });
  if (!any) return false;
  stands_ = false;
  if (!stand(terms_->pairs)) return false;
  const Immobility::Verdict normals = judge(u, false);
  return !(normals.immobile && normals.rate < 0);
}

/// The targets of what u combines give way by as much as its rates are inconsistent: those that restitution asks for
/// first.
bool Formulation::relax(const Vector& u) {
  constexpr double kSlack = 1e-12;  // of what the combination's rate is summed of: solvers meet no tie
  double missing = -u.dot(lcp_.b), rebound = 0, square = 0;
  const double sum = u.cwiseAbs().dot(lcp_.b.cwiseAbs());
  each_row([&](Index i, Index edge, Index, const Contact& c) {
    for (const Index row : {i, edge})
      if (row >= 0 && u[row] > 0) rebound += u[row] * c.rebound, square += u[row] * u[row];
  });
  missing += kSlack * sum;
  if (!(missing > 0) || !(square > 0) || !std::isfinite(missing)) return false;
  const double share = rebound > 0 ? std::min(1.0, missing / rebound) : 0;
  missing -= share * rebound;
  Index next = form_ == Form::full ? system_.joint_rows() : 0;
  for (Contact& c : contacts_) {
    const Index last = next + (cone_ == Cone::relaxed && c.mu > 0 ? 2 : 1);
    double most = 0;
    for (; next < last; ++next) {
      most = std::max(most, u[next]);
      if (u[next] > 0) lcp_.b[next] += share * c.rebound + missing * u[next] / square;
    }
    if (most > 0) c.rebound *= 1 - share;
  }
  return true;
}

std::string Formulation::contradiction() const {
  const std::string when = anchor_ != nullptr ? " at t = " + detail::text_of(anchor_t_) + " s" : "";
  if (blank_ >= 0)
    return "contact " + contact_name(system_, *pairs_, blank_) +
           " has no normal: its centres, or points, are in one place";
  const auto& u = solution_.certificate;
  const Status status = solution_.status;
  if (status == Status::time_limit || status == Status::cancelled) return {};
  if (status != Status::infeasible || u.size() != lcp_.size())
    return "the solver ends the step's problem of " + std::to_string(lcp_.size()) + " rows as " +
           std::string(name(status)) + when + ", with a residual of " + detail::text_of(solution_.residual) +
           (solution_.miss.row >= 0 ? "; " + orthant::why(solution_) : "") + ": try another solver or a shorter step";
  const double least = kPart * u.lpNorm<Eigen::Infinity>();
  Jam jam;
  each_row([&](Index i, Index edge, Index, const Contact& c) {
    if (std::abs(u[i]) > least || (edge >= 0 && std::abs(u[edge]) > least))
      jam.contacts.push_back(contact_name(system_, *pairs_, c.index));
  });
  jam.joints = jam.contacts.empty();
  if ((undecided_ || relaxed_) && !jam.joints) {
    std::string names;
    for (const std::string& name : jam.contacts) names += (names.empty() ? "" : ", ") + name;
    if (relaxed_)
      return "the relaxed friction cones of contacts " + names + " have no common velocity" + when +
             ": a contact that slides must open in this scheme; a shorter step, or a scheme with Coulomb's law, "
             "goes on";
    return "rounding leaves undecided whether a motion satisfies contacts " + names +
           (system_.joint_rows() > 0 ? " together with the joints" : " together");
  }
  return words(jam);
}

}  // namespace orthant
