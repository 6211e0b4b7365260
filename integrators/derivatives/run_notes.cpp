#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/run_notes.h>

#include <algorithm>
#include <iterator>

namespace orthant {

void note_degenerate(double t, const std::vector<int>& some, const std::vector<int>& others,
                     std::vector<DegenerateStep>& steps) {
  DegenerateStep one{t, {}};
  std::ranges::set_union(some, others, std::back_inserter(one.contacts));
  if (!one.contacts.empty()) steps.push_back(std::move(one));
}

void RunNotes::note_spent(int friction, double t) {
  const auto [place, is_new] = spent_.emplace(friction, t);
  if (!is_new) place->second = std::min(place->second, t);
}

template <class Space> void RunNotes::append_words(const SystemOf<Space>& system, const std::vector<RunColumn>& columns,
                                                   std::vector<std::string>& warnings) const {
  const auto in = [](long steps) { return "in " + std::to_string(steps) + " steps "; };
  const long of_motion = shared_[static_cast<std::size_t>(Sharing::motion)];
  const long of_impulses = of_motion + shared_[static_cast<std::size_t>(Sharing::impulses)];
  if (of_motion > 0)
    warnings.push_back(in(of_motion) +
                       "contacts that slide share a load which rigid bodies leave open: the run and its derivatives "
                       "depend on the shares, which the solver chose");
  if (of_impulses > 0 && std::ranges::any_of(columns, &RunColumn::impulse))
    warnings.push_back(
        in(of_impulses) +
        "contacts share their impulses by the solver's choice: the derivatives are those of even shares, "
        "only sums are determined");
  for (const auto& [friction, t] : spent_)
    warnings.push_back("from t = " + detail::text_of(t) + " s the friction '" +
                       system.scene().frictions[static_cast<std::size_t>(friction)].name +
                       "' holds its joint with its whole bound: on one side of a change it slips, or other frictions "
                       "take its part; derivatives are those of a bound that is kept");
  if (frozen_ > 0)
    warnings.push_back(
        in(frozen_) +
        "the position stage of rattle froze its rows at an iterate: the derivatives miss how these move, "
        "a part of the order of the step");
  for (const int contact : jumping_) {
    const auto along = [contact](const RunColumn& c) {
      return c.place == contact && (c.kind == RunColumn::Kind::tangent || c.kind == RunColumn::Kind::across);
    };
    if (std::ranges::none_of(columns, along)) continue;
    const auto& name =
        std::visit([](const auto& c) -> const std::string& { return c.name; }, system.scene().contacts[at(contact)]);
    warnings.push_back("impulse_t1 and impulse_t2 of the contact '" + name +
                       "' have no derivative: two components of its normal are as small, where the tangents jump to "
                       "other axes as it turns; the numbers are those along the tangents of this run");
  }
}

template void RunNotes::append_words(const SystemOf<Planar>&, const std::vector<RunColumn>&,
                                     std::vector<std::string>&) const;
template void RunNotes::append_words(const SystemOf<Spatial>&, const std::vector<RunColumn>&,
                                     std::vector<std::string>&) const;

}  // namespace orthant
