// core/lcp/files/io_fclib.h — FCLIB contact problems: HDF5 files that many solvers of the field share.
//
//   local    u = W r + q                                               group fclib_local:  W, vectors/q, mu
//   global   M v = H r + G λ + f,  u = Hᵀv + w,  Gᵀv + b = 0           group fclib_global: M, H, G, vectors/f, w, b, mu
//   Contact k has d = spacedim entries in r and u: d k the normal one, then one (d = 2) or two (d = 3) tangential ones:
//     0 ≤ u_n ⊥ r_n ≥ 0,   −u_t in the normal cone of { |r_t| ≤ μ r_n } at r_t.
//   Read as a problem with A = W, b = q; a global one by eliminating v, G's rows behind the contacts' as free rows:
//     A = J M⁻¹Jᵀ, b = (w, b) + J M⁻¹f, J = (H G)ᵀ: a Delassus operator where M is diagonal, else multiplied out.
//   In 2-D that is the problem itself. In 3-D each tangential row has bounds of its own, ∓μ z_n: a pyramid around the
//   cone, whose corners allow √2 μ. Its solution may slide where the cone's would not; none of it is hidden by a
//   status.
//   V, R and s of local problems (further unknowns) are not of this kind and are refused.
//   Matrices: nz ≥ 0 triplets (row i, column p), −1 compressed columns, −2 compressed rows.
//   Source: Acary & Brémond & Huber et al., FCLIB: a collection of discrete 3D frictional contact problems (2014).
// Everything wrong throws std::runtime_error, one line: file, dataset, value, rule.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <filesystem>
#include <string>

namespace orthant {

struct ContactProblem {
  Lcp problem;
  int dimension = 2;  // of space: 2 or 3 rows a contact
  Index contacts = 0;
  std::string title, description;
};

ContactProblem read_fclib(const std::filesystem::path& file);

/// Local, with A's entries multiplied out, or global where A is a Delassus operator without regularization and with
/// M⁻¹ > 0. Whole or not at all (core/support/file.h). The problem's rows are a normal row 0 ≤ z, then d − 1 friction
/// rows of it, contact by contact; a global one may have free rows behind them. Throws std::invalid_argument where they
/// are not.
void write_fclib(const std::filesystem::path& file, const ContactProblem& contact_problem);

}  // namespace orthant
