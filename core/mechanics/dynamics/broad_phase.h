// core/mechanics/dynamics/broad_phase.h — broad phase of collision detection: candidate pairs of shapes within a step.
//
//   Each shape has an axis-aligned box, enlarged by the distance that the shape may travel in the step. A uniform grid
//   has cells as wide as the median box. Each cell lists the shapes with boxes that overlap it. Two shapes are a
//   candidate pair if they share a cell and their boxes overlap (discs and spheres: if they overlap themselves).
//   The cells are hashed into a table of fixed size, so that the extent of the scene has no cost. A shape that covers
//   more than kLarge cells is compared with all other shapes instead.
//   Candidates are sorted as the listed pairs are. The result of a step does not depend on the grid.
// Cost: O(shapes + candidates) if sizes differ by no more than about a factor of ten; a larger shape costs O(shapes).
// Memory is allocated once. It grows in a step with more near pairs than any step before.
// Source: Ericson, Real-Time Collision Detection (2005), ch. 7.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>

#include <array>
#include <cstdint>
#include <span>

namespace orthant {

template <class Space> class BroadPhaseOf {
 public:
  explicit BroadPhaseOf(const SystemOf<Space>& system);

  bool any() const { return !system_.scene().collisions.empty(); }

  enum class Reach { own, farthest };

  /// Sets terms.pairs: all that can touch while no body moves farther from the poses terms.at than `way`, a velocity
  /// times a time [m, rad] whose entries may have either sign. Reach::farthest: any shape moves as far as the one that
  /// moves the farthest.
  /// False: there are more than the scene has room for, see why().
  bool find(const Eigen::VectorXd& way, TermsOf<Space>& terms, Reach reach = Reach::own);

  std::string why() const { return why_; }

 private:
  struct Box {
    BodyId body;
    bool round;  // a disc or a sphere
    typename Space::Vector low, high;
  };
  using Cell = std::array<std::int64_t, Space::kTranslations>;
  struct Cells {
    Cell low, high;
    double count() const {
      double product = 1;
      for (std::size_t k = 0; k < low.size(); ++k) product *= static_cast<double>(high[k] - low[k]) + 1;
      return product;
    }
  };
  bool find(int collision, TermsOf<Space>& terms);
  void set_boxes(int collision, const KinematicsOf<Space>& at, const Eigen::VectorXd& way, Reach reach);
  void sort_into_cells();
  template <class What> static void each_cell(const Cells& cells, What&& what);
  std::size_t slot(const Cell& cell) const;
  /// The cells of shape i, into near_: the shapes behind it that its box meets, ascending.
  void meet(int i, int collision);

  const SystemOf<Space>& system_;
  std::vector<std::vector<std::pair<BodyId, BodyId>>> apart_;  // of each collision, smaller first, sorted
  std::vector<std::vector<double>> radius_;                    // [m] of each shape about its body's centre
  std::vector<Box> boxes_;
  std::vector<double> widths_;
  std::vector<Cells> cells_;
  std::vector<int> start_, member_;  // of each slot of the table, the shapes in it
  std::vector<int> large_;           // shapes of too many cells
  std::vector<int> seen_, near_;
  std::string why_;
};
extern template class BroadPhaseOf<Planar>;
extern template class BroadPhaseOf<Spatial>;
using BroadPhase = BroadPhaseOf<Planar>;

/// Values, one per contact of the system, from the pairs `was` to the pairs `is`; a new pair's is T{}. `old` is
/// scratch.
template <class T, class Space> void carry(const SystemOf<Space>& system, std::span<const Pair> was,
                                           std::span<const Pair> is, std::vector<T>& values, std::vector<T>& old) {
  old.assign(values.begin() + system.listed(), values.end());
  std::size_t k = 0;
  for (std::size_t i = 0; i < is.size(); ++i) {
    while (k < was.size() && (was[k].none() || was[k] < is[i])) ++k;
    const bool same = !is[i].none() && k < was.size() && was[k] == is[i];
    values[static_cast<std::size_t>(system.listed()) + i] = same ? old[k] : T{};
  }
}

}  // namespace orthant
