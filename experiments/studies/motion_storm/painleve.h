// experiments/studies/motion_storm/painleve.h — test for Painlevé's paradox and for impacts without a solution.
//
//   A = J P Jᵀ, P = M⁻¹ − M⁻¹Gᵀ(G M⁻¹Gᵀ)⁺G M⁻¹: the effect of forces at the closed contacts on their accelerations
//   where the joints hold (⁺: by eigenvalues, dependent rows left out). Contacts that slide with σ_j = ±1, or stick
//   (0): B = A_NN − A_NT diag(σ_j μ_j). Without a paradox B is a P₀ matrix for every σ. A negative principal minor of
//   one of them, beyond rounding, makes it possible. Contacts that joints immobilise (A_ii is rounding of Jᵢ M⁻¹ Jᵢᵀ)
//   do not count.
//   Impacts (jamming): w = A Λ + J u − target with A of normal and tangent rows together, target −e u_N, and
//   belt − e_T (u_T − belt) where a contact strikes. Each closed contact is open, sticks or slides one way or the
//   other: 4ᵏ linear systems. None of them may have a solution with admissible signs, not even to 1e-6 of the fastest
//   rate and the largest impulse. Of a singular system whose equations agree (to as much) all solutions on a line are
//   tried; more of them count as solved.
// Source: Génot & Brogliato, Eur. J. Mech. A/Solids 18 (1999) 653-677.
#pragma once

#include <orthant/core/mechanics/dynamics/system.h>

namespace orthant::motion_storm {

/// Contacts count as closed up to `gap` [m]. Of more than six closed ones only minors of order 1 and 2 are looked at;
/// many: the answer is true without a look.
bool painleve_possible(const Scene& scene, const State& state, double gap, bool many = true);
/// In space σ is a direction: sticking and 16 of each contact, in minors of order 1 and 2; σ along the worst direction.
bool painleve_possible(const spatial::Scene& scene, const State& state, double gap, bool many = true);

/// Whether a contact that slides has B_ii = 0 to 1e-9: there the motion ends with a force without bound (dynamic jam).
bool painleve_begins(const Scene& scene, const State& state, double gap);
bool painleve_begins(const spatial::Scene& scene, const State& state, double gap);

/// Whether it is proved that Newton's law of impact and Coulomb friction leave no velocities after this state. Contacts
/// take part up to `gap` [m]; those with more than 1e-9 m need not. Not proved: other laws of impact, more than five
/// such contacts, contacts that joints immobilise.
bool impact_impossible(const Scene& scene, const State& state, double gap);
/// In space nothing is proved: whether it is possible at all, that is with friction and two closed contacts or more.
bool impact_impossible(const spatial::Scene& scene, const State& state, double gap);

}  // namespace orthant::motion_storm
