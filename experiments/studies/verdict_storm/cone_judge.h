// experiments/studies/verdict_storm/cone_judge.h — a further judge, of problems with friction discs, in 60 digits.
//
//   Written apart from core/lcp/judge/certify_cones.cpp: its inequality per contact (that header's (1), (2)), with sums
//   in 60 digits, and the nearest point of the cone from the sorted slopes instead of an iteration.
#pragma once

#include "experiments/studies/verdict_storm/exact_judge.h"

namespace orthant {

/// claimed: solved or rounded. error: the largest e_c / min(β, s_c).
Finding examine_cones(const Lcp& problem, const Vector& z, double tolerance, Status claimed);

}  // namespace orthant
