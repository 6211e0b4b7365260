#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/lent_rows.h>

#include <algorithm>

namespace orthant {

RowOf<Spatial> LentRows::row_from(BodyId a, BodyId b, const double* value) {
  RowOf<Spatial> row{a, b, {}, {}};
  const auto pull = [&value](BodyId body, RowOf<Spatial>::Entries& j) {
    if (body < 0) return;
    std::copy_n(value, j.size(), j.begin());
    value += j.size();
  };
  if (a < b)
    pull(a, row.ja), pull(b, row.jb);
  else
    pull(b, row.jb), pull(a, row.ja);
  return row;
}

void LentRows::take(std::vector<ClosedContact>& closed) {
  places_ = closed.capacity();
  rest_.reserve(closed.size());
  for (const auto& [contact, rows] : closed)
    rest_.push_back({contact, rows.normal.a, rows.normal.b, rows.point, rows.belt});
  free_memory(closed);
}

}  // namespace orthant
