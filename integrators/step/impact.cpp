#include <orthant/core/support/kept_memory.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/step/impact.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kTie = 1e-9;  // of the fastest approach: as fast
constexpr int kMostInTurn = 1000;
constexpr double kLeft = 1e-10;                 // of the first approach: the rest of an infinite sequence
constexpr double kRateRounding = 16 * 0x1p-53;  // of the terms of a rate

/// Σ |J_k v_k| of one row.
template <class Space> double terms_of_rate(const RowOf<Space>& row, const Eigen::VectorXd& v) {
  constexpr int n = Space::kVelocities;
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    if (row.a >= 0) sum += std::abs(row.ja[static_cast<std::size_t>(k)] * v[n * row.a + k]);
    if (row.b >= 0) sum += std::abs(row.jb[static_cast<std::size_t>(k)] * v[n * row.b + k]);
  }
  return sum;
}

}  // namespace

template <class Space> ImpactOf<Space>::ImpactOf(const System& system, Form form)
    : system_(system),
      restitution_(system.scene().restitution),
      impacts_(system.scene().impacts),
      form_(form),
      formulation_(system, form),
      sum_(has_law() || system.contacts() <= kKeptRows ? static_cast<std::size_t>(system.contacts()) : 0),
      one_(sum_),
      v_(system.dof()),
      rate_(system.joint_rows()),
      joint_sum_(rate_.size()) {
  struck_.closed.reserve(sum_.size());
  targets_.reserve(sum_.size());
  approach_.reserve(sum_.size());
}

template <class Space> bool ImpactOf<Space>::act(const BasicSystem& basic, Solver& solver, StepReport& report) {
  newtons_law(system_.laws(), struck_, v_, targets_);
  if (form_ == Form::full)  // impulses of contacts leave the joints' rates as they are
    for (Index i = 0; i < rate_.size(); ++i) rate_[i] = apply(struck_.G[static_cast<std::size_t>(i)], v_.data());
  const bool phases = restitution_ == Restitution::poisson;
  if (phases)
    for (RateTarget& w : targets_) w.normal = 0, w.tangent = belt_of(w);
  formulation_.formulate(struck_, basic, targets_, v_, rate_);
  if (!solve(solver, report)) return false;
  if (!phases) return true;
  for (RateTarget& w : targets_) w.tangent = belt_of(w) - w.law->e_t * w.slip;
  formulation_.retarget(targets_, v_, rate_);
  formulation_.release(one_);
  return solve(solver, report);
}

template <class Space> bool ImpactOf<Space>::solve(Solver& solver, StepReport& report) {
  if (!formulation_.solve(solver, report)) {
    why_ = formulation_.contradiction();
    why_ = why_.empty() ? "an impact was not solved" : "in an impact " + why_;
    return false;
  }
  formulation_.advance(v_, one_);
  if (form_ == Form::full) joint_sum_ += formulation_.solution().z.head(joint_sum_.size());
  for (const auto& c : struck_.closed) {
    const auto i = static_cast<std::size_t>(c.contact);
    sum_[i].normal += one_[i].normal, sum_[i].tangent += one_[i].tangent;
  }
  return true;
}

template <class Space> bool ImpactOf<Space>::one_by_one(const Terms& terms, const BasicSystem& basic,
                                                        const std::vector<char>* may, double first, Solver& solver,
                                                        StepReport& report) {
  for (int impacts = 0;; ++impacts) {
    approach_.clear();
    for (const auto& c : terms.closed) {
      const double approach = -apply(c.rows.normal, v_.data());
      const bool rounding = approach > 0 && approach <= kRateRounding * terms_of_rate(c.rows.normal, v_);
      approach_.push_back(may != nullptr && !(*may)[at(c.contact)] ? kInf : rounding ? 0 : approach);
    }
    double fastest = 0;
    for (const double approach : approach_)
      if (approach < kInf) fastest = std::max(fastest, approach);
    if (fastest <= kLeft * first) return true;
    if (may != nullptr && impacts == kMostInTurn) return true;
    if (impacts == kMostImpacts) {
      report.status = Status::iteration_limit;
      why_ = "impacts one after the other do not end: after " + std::to_string(impacts) +
             " contacts still approach at " + detail::text_of(fastest) + " m/s";
      return false;
    }
    struck_.closed.clear();
    for (std::size_t k = 0; k < approach_.size(); ++k)
      if (approach_[k] >= (1 - kTie) * fastest) struck_.closed.push_back(terms.closed[k]);
    if (!act(basic, solver, report)) return false;
  }
}

template <class Space> void ImpactOf<Space>::begin(const Terms& terms, const Eigen::VectorXd& v) {
  sum_.assign(static_cast<std::size_t>(system_.contacts()), Impulse{});
  one_.resize(sum_.size());
  joint_sum_.setZero();
  v_ = v;
  struck_.pairs = terms.pairs;
  struck_.at.pose = terms.at.pose, struck_.at.t = terms.at.t;
  struck_.G = terms.G, struck_.joint_rate = terms.joint_rate;
}

template <class Space> bool ImpactOf<Space>::strike_in_turn(const Terms& terms, const BasicSystem& basic,
                                                            const std::vector<char>& in_turn, Eigen::VectorXd& v,
                                                            Solver& solver, StepReport& report) {
  why_.clear();
  double first = 0;
  for (const auto& c : terms.closed)
    if (in_turn[at(c.contact)]) first = std::max(first, -apply(c.rows.normal, v.data()));
  any_ = first > kRestSpeed * system_.length_unit();
  if (!any_) return true;
  begin(terms, v);
  if (!one_by_one(terms, basic, &in_turn, first, solver, report)) return false;
  v = v_;
  return true;
}

template <class Space> bool ImpactOf<Space>::strike(const Terms& terms, const BasicSystem& basic,
                                                    const Eigen::VectorXd& before, std::vector<RateTarget>& targets,
                                                    Eigen::VectorXd& v, Solver& solver, StepReport& report) {
  any_ = false;
  why_.clear();
  double first = 0;
  for (const RateTarget& w : targets) first = std::max(first, -w.approach);
  if (!has_law() || first <= kRestSpeed * system_.length_unit()) return true;
  any_ = true;
  begin(terms, before);
  struck_.closed = terms.closed;
  const bool struck = impacts_ == Impacts::simultaneous ? act(basic, solver, report)
                                                        : one_by_one(terms, basic, nullptr, first, solver, report);
  if (!struck) return false;
  v += v_ - before;
  // What struck keeps the rate that its impulse left. What approached and got none only may not approach: which of two
  // copies of a contact has the impulse is the solver's choice, and no other than the one law holds.
  for (std::size_t k = 0; k < targets.size(); ++k) {
    RateTarget& w = targets[k];
    if (sum_[static_cast<std::size_t>(terms.closed[k].contact)].normal > 0)
      w.normal = std::max({0.0, apply(terms.closed[k].rows.normal, v_.data()), w.least});
    else if (w.approach < 0)
      w.normal = std::max(0.0, w.least);
  }
  return true;
}

template <class Space> void ImpactOf<Space>::add_to(std::vector<Impulse>& impulses) const {
  if (!any_) return;
  for (std::size_t i = 0; i < sum_.size(); ++i)
    impulses[i].normal += sum_[i].normal, impulses[i].tangent += sum_[i].tangent;
}

template <class Space> void ImpactOf<Space>::add_joints_to(Eigen::VectorXd& impulses) const {
  if (any_) impulses += joint_sum_;
}

template <class Space> void note_forces(const TermsOf<Space>& terms, const Eigen::VectorXd& v_free,
                                        std::vector<RateTargetOf<Space>>& targets) {
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto& rows = terms.closed[k].rows;
    auto& w = targets[k];
    w.free = apply(rows.normal, v_free.data());
    if (w.law->frictional()) w.free_slip = slip_rate(rows, v_free.data()) - belt_of(*w.law, rows);
  }
}

template <class Space> double energy_rise(const SystemOf<Space>& system, const TermsOf<Space>& terms,
                                          const std::vector<RateTargetOf<Space>>& targets, const Eigen::VectorXd& v,
                                          const std::vector<ImpulseOf<Space>>& impulses, double small,
                                          std::vector<ContactWork>* taken) {
  double sum = 0, exchanged = 0, forced = 0;
  bool counts = false;
  const std::size_t before = taken != nullptr ? taken->size() : 0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto& w = targets[k];
    const int contact = terms.closed[k].contact;
    const auto& impulse = impulses[static_cast<std::size_t>(contact)];
    if (impulse.normal == 0) continue;
    const bool pushed = w.least >= w.normal;
    if (pushed) small = std::max(small, kOtherRows);
    counts = counts || small > kSameRows || w.approach < -kRestSpeed * w.law->unit;
    const auto& rows = terms.closed[k].rows;
    double work = 0;
    const auto add = [&](double by, double after, double free, double was) {
      work += by * (after + free) / 2;
      exchanged += std::abs(by) * (std::abs(after) + std::abs(free)) / 2;
      forced += std::abs(by) * std::abs(free - was);
    };
    add(impulse.normal, apply(rows.normal, v.data()), w.free, w.approach);
    if (impulse.tangent != Tangent<Space>{}) {
      const auto slip = slip_rate(rows, v.data()) - belt_of(*w.law, rows);
      for (std::size_t i = 0; i < Space::kTangents; ++i)
        add(tangent_part(impulse.tangent, i), tangent_part(slip, i), tangent_part(w.free_slip, i),
            tangent_part(w.slip_before, i));
    }
    sum += work;
    if (!pushed || taken == nullptr) continue;
    const Pair key = contact < system.listed() ? Pair{-1, contact, 0, 0}
                                               : terms.pairs[static_cast<std::size_t>(contact - system.listed())];
    while (next < before && (*taken)[next].contact < key) ++next;
    if (next < before && (*taken)[next].contact == key) sum += (*taken)[next].work;
    if (work < 0) taken->push_back({key, work});
  }
  if (taken != nullptr) taken->erase(taken->begin(), taken->begin() + static_cast<std::ptrdiff_t>(before));
  const bool rises = counts && sum > forced && sum > small * exchanged &&
                     sum > std::max(kSameRows, small / 10) / 2 * v.dot(system.mass().cwiseProduct(v));
  return rises ? sum : 0;
}

#define ORTHANT_IMPACT(Space)                                                                                         \
  template class ImpactOf<Space>;                                                                                     \
  template void note_forces(const TermsOf<Space>&, const Eigen::VectorXd&, std::vector<RateTargetOf<Space>>&);        \
  template double energy_rise(const SystemOf<Space>&, const TermsOf<Space>&, const std::vector<RateTargetOf<Space>>&, \
                              const Eigen::VectorXd&, const std::vector<ImpulseOf<Space>>&, double,                   \
                              std::vector<ContactWork>*);
ORTHANT_IMPACT(Planar)
ORTHANT_IMPACT(Spatial)
#undef ORTHANT_IMPACT

}  // namespace orthant
