// Rows of closed contacts that are freed while their problem is solved come back bit for bit.
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/integrators/step/lent_rows.h>

#include <doctest/doctest.h>

#include <cstring>

using namespace orthant;

namespace {

struct Places {  // normals first, then both tangents of each contact
  Index contacts;
  Index normal_row(std::size_t k) const { return static_cast<Index>(k); }
  Index tangent_row(std::size_t k) const { return contacts + 2 * static_cast<Index>(k); }
};

/// Bit for bit; entries of the ground are not read.
bool same(const RowOf<Spatial>& one, const RowOf<Spatial>& other) {
  return one.a == other.a && one.b == other.b &&
         (one.a == kGround || std::memcmp(&one.ja, &other.ja, sizeof one.ja) == 0) &&
         (one.b == kGround || std::memcmp(&one.jb, &other.jb, sizeof one.jb) == 0);
}

}  // namespace

TEST_CASE("rows that W has come back from it, those against the ground and moving surfaces, too") {
  for (const auto bodies : {Pour::Bodies::spheres, Pour::Bodies::mixed}) {
    const SystemOf<Spatial> system(pour({.count = 60, .bodies = bodies, .apart = 1, .spread = 0}));
    TermsOf<Spatial> terms(system);
    const State x = system.initial_state();
    set_poses(system, 0, x.q, terms.at);
    BroadPhaseOf<Spatial> broad(system);
    REQUIRE(broad.find(Eigen::VectorXd::Constant(system.dof(), 1e-3), terms));
    evaluate_gaps(system, terms);
    evaluate_closed(system, 1e-3, terms);
    REQUIRE(terms.closed.size() > 50);
    terms.closed[7].rows.belt = {0.1, 0.2};
    const auto was = terms.closed;
    const Places places{static_cast<Index>(was.size())};
    RowSparse W;
    const auto append = [&W](const RowOf<Spatial>& row) {
      append_to(W.column, W.value, row);
      W.start.push_back(static_cast<int>(W.column.size()));
    };
    for (const auto& c : was) append(c.rows.normal);
    for (const auto& c : was) append(c.rows.tangents[0]), append(c.rows.tangents[1]);
    LentRows lent;
    lent.take(terms.closed);
    CHECK(terms.closed.capacity() == 0);
    lent.give_back(W, places, terms.closed);
    REQUIRE(terms.closed.size() == was.size());
    bool grounded = false;
    for (std::size_t k = 0; k < was.size(); ++k) {
      const auto &one = was[k].rows, &other = terms.closed[k].rows;
      CHECK(was[k].contact == terms.closed[k].contact);
      CHECK(same(one.normal, other.normal));
      for (std::size_t i = 0; i < 2; ++i) CHECK(same(one.tangents[i], other.tangents[i]));
      CHECK(one.point == other.point);
      CHECK(one.belt == other.belt);
      grounded = grounded || one.normal.a == kGround || one.normal.b == kGround;
    }
    CHECK(grounded);
  }
}
