// experiments/studies/verdict_storm/disc_problems.h — random contact problems with friction discs.
//
//   1 to 60 contacts. Solutions planted (open, stick and slip contacts), redundant, degenerate, jammed, badly scaled
//   (units to 1e±12), unsymmetric, rolling; proved infeasible by construction; infeasible or not by a few last
//   digits; nothing known; discs next to intervals, boxes and free rows; operators; contacts that occur twice;
//   numbers from 2^-300 to 2^300; μ = 0 and large. Problem k of a seed is the same on every machine.
#pragma once

#include "experiments/studies/verdict_storm/problems.h"

namespace orthant {

StormProblem disc_problem(std::uint64_t seed, std::uint64_t k);
std::span<const std::string_view> disc_kinds();

/// The same problem in other words: tangent planes turned, contacts in another order, each in another unit (powers of
/// two), one contact twice. z solves p exactly where image(z) solves `problem`, in exact arithmetic; the turn is by an
/// angle with a rational cosine, rounded.
struct Restatement {
  Lcp problem;
  Eigen::MatrixXd of_z;  // image(z) = of_z z
};
/// Of a dense problem: three rows a contact in order, [0, ∞), one disc each.
Restatement restate(const Lcp& p, Random& random);
bool can_be_restated(const Lcp& p);

}  // namespace orthant
