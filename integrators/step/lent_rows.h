// integrators/step/lent_rows.h — rows of closed contacts that are freed while their problem is solved: W has them.
//
// In problems of many contacts the rows in the terms (360 B a contact) and the operator's W (444 B) have the same
// numbers. A solver needs W alone, and 300 B a contact of its own. So the terms lend their rows: they keep 56 B a
// contact meanwhile, and get every bit back from W.
#pragma once

#include <orthant/core/lcp/matrix.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/support/kept_memory.h>

#include <vector>

namespace orthant {

class LentRows {
 public:
  using ClosedContact = ClosedContactOf<Spatial>;

  /// Notes what W does not have, and frees `closed`.
  void take(std::vector<ClosedContact>& closed);
  /// normal_row(k), tangent_row(k): of closed contact k, its rows in W.
  template <class Rows> void give_back(const RowSparse& W, const Rows& rows, std::vector<ClosedContact>& closed) {
    closed.reserve(places_);
    const auto row = [&W](const Rest& rest, Index i) {
      return row_from(rest.a, rest.b, W.value.data() + W.start[at(i)]);
    };
    for (std::size_t k = 0; k < rest_.size(); ++k) {
      const Rest& rest = rest_[k];
      const Index normal = rows.normal_row(k), tangent = rows.tangent_row(k);
      closed.push_back(
          {rest.contact, {row(rest, normal), {row(rest, tangent), row(rest, tangent + 1)}, rest.point, rest.belt}});
    }
    free_memory(rest_);
  }

 private:
  /// The row of these bodies whose entries append_to() has left at `value`. Those of the ground are 0.
  static RowOf<Spatial> row_from(BodyId a, BodyId b, const double* value);

  struct Rest {
    int contact;
    BodyId a, b;
    Vector3d point;
    Tangents belt;
  };
  std::vector<Rest> rest_;
  std::size_t places_ = 0;  // that `closed` had reserved
};

}  // namespace orthant
