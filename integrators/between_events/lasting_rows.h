// integrators/between_events/lasting_rows.h — rows of the lasting contacts: finds them among the closed contacts.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

namespace orthant {

/// Calls act(i, rows) for each lasting contact, i its place in `lasting`. `closed`: these contacts or more; both
/// ascending. False: one is missing, as its gap is NaN.
template <class Space, class Act>
bool for_each_lasting(const std::vector<ClosedContactOf<Space>>& closed, const std::vector<int>& lasting, Act&& act) {
  auto at = closed.begin();
  for (std::size_t i = 0; i < lasting.size(); ++i, ++at) {
    while (at != closed.end() && at->contact != lasting[i]) ++at;
    if (at == closed.end()) return false;
    act(i, at->rows);
  }
  return true;
}

}  // namespace orthant
