// integrators/derivatives/run_notes.h — what the steps of a run say of its derivatives, in words: warnings.
//
//   Of all steps: those whose impulses are shared; dry frictions in joints that hold with their whole bound; steps of
//   rattle that froze their rows at an iterate; in space contacts whose first tangents jump as their normals turn.
#pragma once

#include <orthant/integrators/derivatives/run_columns.h>

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace orthant {

/// A step in which rows are weakly active: only one-sided derivatives exist from here on. In space also one with a
/// loaded rim parallel to its plane: a tilt moves its points at once, derivatives by what tilts it do not exist.
struct DegenerateStep {
  double t = 0;               // [s] its begin
  std::vector<int> contacts;  // of the scene
};

/// Appends a step where there are any such contacts, of two ascending lists.
void note_degenerate(double t, const std::vector<int>& some, const std::vector<int>& others,
                     std::vector<DegenerateStep>& steps);

class RunNotes {
 public:
  /// linear: a step's linearization; t: its begin [s]. Steps may come in any order.
  template <class Linearization> void take(const Linearization& linear, double t) {
    ++shared_[static_cast<std::size_t>(linear.sharing())];
    for (const int friction : linear.spent()) note_spent(friction, t);
    if constexpr (requires { linear.froze_again(); }) frozen_ += linear.froze_again();
    if constexpr (requires { linear.jumping(); }) jumping_.insert(linear.jumping().begin(), linear.jumping().end());
  }
  /// columns: of the run; shared and jumping impulses count where they are among them.
  template <class Space> void append_words(const SystemOf<Space>& system, const std::vector<RunColumn>& columns,
                                           std::vector<std::string>& warnings) const;

 private:
  void note_spent(int friction, double t);

  std::array<long, 3> shared_{};  // steps by their Sharing
  std::map<int, double> spent_;   // of a friction: the begin of its first step [s]
  long frozen_ = 0;               // steps
  std::set<int> jumping_;         // contacts
};

}  // namespace orthant
