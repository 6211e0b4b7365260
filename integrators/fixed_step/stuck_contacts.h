// integrators/fixed_step/stuck_contacts.h — static friction from step to step: contacts that stuck keep mu_static.
//
//   A scheme of fixed step chooses μ of a contact by its slip before the step. The rows of the new step have turned by
//   O(h), so a contact that stuck at the end of the step before shows a slip of O(h²) in them, not 0. Which contacts
//   stuck is therefore noted with the rows of the step that made them stick. A body that turns lifts a contact by
//   O(h²): one that is open for a single step keeps its note.
// Cost: nothing where no law has mu_static > mu.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/rate_targets.h>

#include <algorithm>
#include <vector>

namespace orthant {

template <class Space> class StuckContacts {
 public:
  using System = SystemOf<Space>;
  using Terms = TermsOf<Space>;

  explicit StuckContacts(const System& system)
      : listed_(system.scene().contacts.size()),
        stuck_(std::ranges::any_of(system.laws(), [](const ContactLaw& law) { return law.mu_static > law.mu; })
                   ? static_cast<std::size_t>(system.contacts())
                   : 0) {}

  /// Lets the closed contacts that stuck at the end of the step to x keep their static coefficient.
  void choose(const State& x, const Terms& terms, std::vector<RateTargetOf<Space>>& targets) const {
    if (stuck_.empty() || q_.size() != x.q.size() || x.q != q_ || x.v != v_) return;
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (const auto c = static_cast<std::size_t>(terms.closed[k].contact); stuck_[c] && same_pair(c, terms))
        targets[k].slip = {};
  }

  /// Notes which contacts stick in the step that has been solved: v after it, in its own rows.
  void note(const Terms& terms, const std::vector<ImpulseOf<Space>>& impulses, const Eigen::VectorXd& v,
            const System& system) {
    if (stuck_.empty()) return;
    for (std::size_t i = 0; i < stuck_.size(); ++i)
      stuck_[i] = stuck_[i] == kSticks && same_pair(i, terms) ? kStuckBefore : kFree;
    for (const auto& c : terms.closed) {
      const auto i = static_cast<std::size_t>(c.contact);
      const ContactLaw& law = system.law(c.contact);
      if (!law.frictional() || !(impulses[i].normal > 0)) continue;
      const bool sticks = size_of(slip_rate(c.rows, v.data()) - belt_of(law, c.rows)) <= kStickSpeed * law.unit;
      stuck_[i] = sticks ? kSticks : kFree;
    }
    pairs_ = terms.pairs;
  }
  /// The state at the end of that step.
  void end(const State& x) {
    if (!stuck_.empty()) q_ = x.q, v_ = x.v;
  }

  void remember(CheckpointData& memory) { memory(stuck_, pairs_, q_, v_); }

 private:
  bool same_pair(std::size_t contact, const Terms& terms) const {
    if (contact < listed_) return true;
    const std::size_t i = contact - listed_;
    return i < pairs_.size() && i < terms.pairs.size() && pairs_[i] == terms.pairs[i];
  }
  std::size_t listed_;
  static constexpr char kFree = 0, kStuckBefore = 1, kSticks = 2;  // at the end of the step; before: and open in it
  std::vector<char> stuck_;                                        // one a contact; empty: no law distinguishes
  std::vector<Pair> pairs_;
  Eigen::VectorXd q_, v_;
};

}  // namespace orthant
