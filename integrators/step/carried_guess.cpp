#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/carried_guess.h>

#include <algorithm>

namespace orthant {
void CarriedGuess::fit(const StepProblemOf<Spatial>& problem, const TermsOf<Spatial>& terms, Eigen::Index listed,
                       Vector& z) {
  now_.clear();
  problem.each_contact([&](Index normal, Index edge, Index tangent, const StepProblemOf<Spatial>::Contact& c) {
    if (edge >= 0) return;  // relaxed: its edges turn with its slip
    const auto pair = static_cast<std::size_t>(c.index - listed);
    const Pair key = c.index < listed ? Pair{.collision = -1, .a = c.index} : terms.pairs[pair];
    now_.push_back({key, static_cast<int>(normal), static_cast<int>(tangent)});
  });
  if (!std::ranges::is_sorted(now_)) std::ranges::sort(now_);
  const auto n = static_cast<Index>(problem.rows().size());
  if (z.size() != n || now_ != last_) {
    was_ = z;
    z.resize(n), z.setZero();
    const Index joints = std::min(problem.joint_rows(), was_.size());
    z.head(joints) = was_.head(joints);
    const auto take = [&](int to, int from, int rows) {
      for (int k = 0; k < rows && from + k < was_.size(); ++k) z[to + k] = was_[from + k];
    };
    auto before = last_.begin();
    for (const Place& place : now_) {
      while (before != last_.end() && before->key < place.key) ++before;
      if (before == last_.end()) break;
      if (before->key != place.key) continue;
      take(place.normal, before->normal, 1);
      if (place.tangent >= 0 && before->tangent >= 0) take(place.tangent, before->tangent, Spatial::kTangents);
    }
  }
  last_.swap(now_);
  if (last_.size() > at(kKeptRows)) free_memory(now_, was_);
}

}  // namespace orthant
