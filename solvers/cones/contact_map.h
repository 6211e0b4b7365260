// solvers/cones/contact_map.h — equations F(z, w) = 0 of one contact, and their generalized derivatives.
//
//   Each map vanishes exactly where the block's law holds, and gives matrices with  dF = E dz + H dw.  Numbers are
//   those of the scaled form (cone_form.h), so that ρ = 1 suits; ρ_n, ρ_T differ where the block's own numbers say so.
//   natural          F = z − P_K(z − ρ û)
//                      DP the derivative of P_K, G that of û:  E = I − DP,  H = ρ DP G
//   alart-curnier    p = clamp(z_n − ρ_n w_n, lo, hi),  F_n = z_n − p,  F_T = z_T − P_disc(μ p)(z_T − ρ_T w_T)
//   jean-moreau      the same with the disc of radius μ z_n
//   fischer-burmeister (one friction a block)  x = (μ z_n, z_T),  y = (w_n/μ + ‖w_T‖, w_T),  F = x + y − (x∘x + y∘y)^½
//                      over the Jordan algebra of the second-order cone; μ = 0 and rows without friction: scalar
//   Sources: Alart & Curnier (1991); Jean & Moreau (1987); Fukushima, Luo & Tseng, SIAM J. Optim. 12 (2002); De Saxcé
//   & Feng (1998).
#pragma once

#include <orthant/core/lcp/cones/contact.h>

namespace orthant {

enum class ContactMap { natural, alart_curnier, jean_moreau, fischer_burmeister };

/// F (m), E, H (m × m by columns) of a block; z, w: m numbers. rho_n, rho_t > 0.
/// Returns true where dF = dz: an open contact, which the rest of the system does not need to know.
bool evaluate_map(ContactMap map, const cones::Blocks& blocks, const cones::Block& block, const double* z,
                  const double* w, double rho_n, double rho_t, double* F, double* E, double* H);

}  // namespace orthant
