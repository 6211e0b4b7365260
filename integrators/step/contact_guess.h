// integrators/step/contact_guess.h — warm start from contact to contact: impulses of the last problem as a first guess.
//
//   A contact is known by its number in the scene, a searched one by its pair of shapes and point (pair.h). Where
//   contacts come and go, the rows of a problem stand in other places than those of the last one: each contact's
//   normal and sliding impulses, and those of joints, are carried to its new rows. New contacts and rolling friction
//   begin at 0. Tangents follow the normal (contact_rows.h), so a tangential impulse keeps its parts along them.
//   Only from kCarried rows on: smaller problems start from the last z if it has their size, else from 0.
// Cost: O(contacts), 48 B a contact.
#pragma once

#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/step/step_problem.h>

#include <span>
#include <vector>

namespace orthant {

template <class Space> class ContactGuess {
 public:
  static constexpr Index kCarried = 1000;

  /// z, of the last problem, becomes the guess for this one, whose rows have been collected.
  void carry(const StepProblemOf<Space>& problem, std::span<const Pair> pairs, int listed, Index rows, Vector& z);
  void remember(CheckpointData& memory) { memory(was_, rows_); }

 private:
  struct Known {
    Pair contact;  // a listed one: {−1, its number}
    int normal = -1, normals = 1, tangent = -1;
  };
  std::vector<Known> was_, is_;
  Index rows_ = 0;  // of the last problem
  Vector old_;
};
extern template class ContactGuess<Planar>;
extern template class ContactGuess<Spatial>;

}  // namespace orthant
