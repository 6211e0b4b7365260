#include <orthant/integrators/step/contact_guess.h>

#include <algorithm>
#include <utility>

namespace orthant {

template <class Space> void ContactGuess<Space>::carry(const StepProblemOf<Space>& problem, std::span<const Pair> pairs,
                                                       int listed, Index rows, Vector& z) {
  is_.clear();
  const bool fits = z.size() == rows_ && !was_.empty();
  if (rows >= kCarried)
    for (const auto& c : problem.contacts()) {
      const Pair contact =
          c.index < listed ? Pair{.collision = -1, .a = c.index} : pairs[static_cast<std::size_t>(c.index - listed)];
      const Index normals = problem.has_edges(c) ? StepProblemOf<Space>::kEdges : 1;
      is_.push_back({contact, static_cast<int>(problem.normal_row(c.closed)), static_cast<int>(normals),
                     static_cast<int>(problem.tangent_row(c.closed))});
    }
  if (fits && !is_.empty()) {
    old_ = z;
    z.resize(rows);
    z.setZero();
    const Index joints = problem.joint_rows();
    z.head(joints) = old_.head(joints);
    auto was = was_.begin();
    for (const Known& now : is_) {
      while (was != was_.end() && was->contact < now.contact) ++was;
      if (was == was_.end()) break;
      if (was->contact != now.contact) continue;
      const int normals = std::min(now.normals, was->normals);
      z.segment(now.normal, normals) = old_.segment(was->normal, normals);
      if (now.tangent >= 0 && was->tangent >= 0)
        z.template segment<Space::kTangents>(now.tangent) = old_.template segment<Space::kTangents>(was->tangent);
    }
  }
  was_.swap(is_);
  rows_ = rows;
}

template class ContactGuess<Planar>;
template class ContactGuess<Spatial>;

}  // namespace orthant
