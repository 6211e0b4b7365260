// experiments/studies/motion_storm/judge.h — a random scene, planar or spatial, by every integrator, judged by
// independent code.
//
//   A run that ends `solved` is at fault when
//     nan           a number in it is not finite
//     joints        a joint is off by more than 1e-6 of the size; fixed steps: than h v more
//     penetration   a contact is deeper than at the start by more than 1e-7 of the size (event-driven), 1e-4 (adaptive;
//                   a tenth of a journal's clearance at the most; where it crosses events to first order, as much
//                   deeper as it warns of, 1e-3 at the most), 3 h v (fixed steps, where they do not warn of it)
//     passage       two shapes pass through each other by a fifth of the thinner one, and the run reports fewer
//                   passages
//     energy        energy rises above its least value so far by more than 1e-6 (event-driven), 1e-3
//                   (adaptive), 5 % (fixed steps) of its scale, beyond the work of loads and belts and the rises that
//                   the run reports (fixed steps: the defect, too, that it warns of), where nothing overlaps at the
//                   start. With drives: points move 100 times as fast as drives, gravity, springs and the start can
//                   make them, and not in two other schemes (of fixed step: with a 32nd of it)
//                   or in the other precise one
//     output step   the motion depends on the output step (a quarter of the duration instead of a 140th)
//     twin          the twin's motion is another one, as far as it goes, or the twin is infeasible
//     astray        it is off the reference's motion by more than 5 % of the size and what friction is left open
//                   (shared_load.h) can make, a quarter, a 32nd and a 256th of the step do not help (the last does not
//                   even halve it), two others of fixed step come to that motion, no two contacts strike one after the
//                   other within the shortest of these steps, and the run does not warn that its energy is off. Not
//                   where shapes overlap at the start, nor of schemes with another law: of friction, anitescu-potra,
//                   and paoli-schatzman in impacts, where a contact has restitution, too; of impacts, stewart-trinkle
//                   and anitescu-potra where a contact opens at the start as another strikes. adaptive: by more than
//                   below, where two of fixed step are nearer to the reference, and at rtol = 1e-9, too
//   any run when it is
//     infeasible    ended so, or by "Painlevé" where that is not possible (painleve.h), and a second integrator goes on
//                   admissibly past that time (one of fixed step with a quarter of its step, too); not where an impact
//                   without a solution is proved (painleve.h)
//     late          more than `grace` seconds of the processor past its limit
//     crashed       ended by an exception or a signal
//   With fixed steps, joints, penetration, energy, twin and astray count only where a quarter of the step (energy:
//   and a 32nd) shows them, too, at more than half the size: else they are the step's error. Output step, twin and
//   astray count only in motions that are well conditioned: a reference (event-driven, else adaptive) without crossed
//   crowds, in which points are at most 100 times as fast as expected (a wedge that closes magnifies without bound),
//   and whose masses, gravity and speeds are off by 1e-9, and places by 1e-10 m, is off by less than 1e-5.
//   Allowed are 1e-6 (event-driven), 1e-3 (adaptive), each with ten times what the nudge makes, or ten times the most
//   that nudges of 1e-9 to 1e-7 (precise ones: 5e-10 to 1e-8), both ways, make with the scheme itself (event-driven:
//   and a tighter tolerance), the square of a step's way (fixed steps) and what friction that the model leaves open
//   can make there (shared_load.h). Crowds that event-driven crosses are held to the limits of adaptive. Twin and
//   astray (in space: and output step) do not count where Painlevé's paradox is possible in the motion: the model has
//   several motions there.
//   Energy below 1e-8 J/kg is neglected.
//   Gaps, joints, energy, rows of constraints, start and mass in the plane are computed here (measure.h,
//   closed_rows.h).
//   Taken from Orthant are:
//     status, why            the claim that is judged. "Painlevé" in words only selects a claim that painleve.h proves.
//     warnings of overlaps,  silence is the fault. A warning excuses no more than its own figure says: 1.1 times the
//     passages and energy    overlap, as many passages, twice the defect, each rise with the largest rise.
//     impulses               bounds of the work of belts and of the friction left open (shared_load.h). Both only widen
//                            an allowance, and only with belts, or where friction is not determined.
//     times of events        of the reference, only to excuse schemes of fixed step that merge impacts (astray), and in
//                            shared_load.h. The reference itself is confirmed by two other schemes.
//     crossings              choose the wider limits of adaptive. The run warns of each.
//     the manifold's verbs,  in space only: states along a way, masses and axes of bodies, the start, rows of closed
//     masses, rows           contacts. Gaps, joints and energy are computed here, and unit tests of the rows compare
//                            them with differences of gaps.
#pragma once

#include "experiments/studies/motion_storm/space.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace orthant::motion_storm {

enum class Result {
  solved,
  refused,  // not taken by the scheme
  stopped,  // not solved, and said so
  nan,
  joints,
  penetration,
  passage,
  energy,
  infeasible,
  output_step,
  twin,
  astray,
  late,
  crashed
};
inline constexpr std::array<std::string_view, 14> kResults{
    "solved", "refused",    "stopped",     "nan",  "joints", "penetration", "passage",
    "energy", "infeasible", "output step", "twin", "astray", "late",        "crashed"};
inline bool fault(Result r) { return r > Result::stopped; }

struct Verdict {
  std::string integrator;
  Result result = Result::solved;
  std::string why;
};

struct Limits {
  double time = 1;   // [s] of a run
  double grace = 1;  // [s] beyond it
};

/// One verdict an integrator, in the order given; `number` chooses the twin.
std::vector<Verdict> judge(const Scene& scene, const std::vector<std::string>& integrators, std::uint64_t number,
                           const Limits& limits);
std::vector<Verdict> judge(const spatial::Scene& scene, const std::vector<std::string>& integrators,
                           std::uint64_t number, const Limits& limits);

/// Every integrator of the registry, for scenes of this dimension.
template <class Space = Planar> std::vector<std::string> all_integrators();

}  // namespace orthant::motion_storm
