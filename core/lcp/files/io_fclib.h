// core/lcp/files/io_fclib.h — FCLIB contact problems: HDF5 files that many solvers of the field share.
//
//   local    u = W r + V λ + q,  Vᵀr + R λ + s = 0                      group fclib_local:  W, V, R, vectors/q, s, mu
//   global   M v = H r + G λ + f,  u = Hᵀv + w,  Gᵀv + b = 0           group fclib_global: M, H, G, vectors/f, w, b, mu
//   Contact k has d = spacedim entries in r and u: d k the normal one, then one (d = 2) or two (d = 3) tangential ones:
//     0 ≤ u_n ⊥ r_n ≥ 0,   −u_t in the normal cone of { ‖r_t‖ ≤ μ r_n } at r_t.
//   Groups fclib_local_rolling and fclib_global_rolling, d = 5, vectors/mu_r: two rolling moments more, likewise
//     −u_m in the normal cone of { ‖r_m‖ ≤ μ_r r_n } at r_m.
//   Read as a problem with A = W, b = q; a global one by eliminating v. Further unknowns λ stand behind the contacts'
//   rows as free rows: A = (W V; Vᵀ R), b = (q, s), or
//     A = J M⁻¹Jᵀ, b = (w, b) + J M⁻¹f, J = (H G)ᵀ: a Delassus operator where M is diagonal, else multiplied out.
//   W and M need not be symmetric (implicit gyroscopic terms); the symmetric part of M is positive definite.
//   Matrices: nz ≥ 0 triplets (row i, column p), −1 compressed columns, −2 compressed rows; entries that occur twice
//   add. Group solution, written and read where it is there: r, u, of global problems l (λ), v; residual_scale_free,
//   residual_natural (judge/certify_cones.h). A solution that does not fit is left out, with the reason.
//   Source: Acary & Brémond & Huber et al., FCLIB: a collection of discrete 3D frictional contact problems (2014).
// Everything wrong throws std::runtime_error, one line: file, dataset, value, rule.
#pragma once

#include <orthant/core/lcp/solution.h>

#include <filesystem>
#include <optional>
#include <string>

namespace orthant {

/// A global problem as its file has it.
struct GlobalForm {
  RowSparse mass, jacobian;  // M (m x m); J = (H G)ᵀ, a row each row of the problem
  Vector force, offset;      // f (m); (w, b)
};

struct ContactProblem {
  Lcp problem;
  int dimension = 2;  // rows a contact: 2 in the plane, 3 in space, 5 in space with rolling resistance
  Index contacts = 0;
  std::string title, description;
  Vector solution;    // z of the file, all rows; empty: none
  std::string unfit;  // why the file's solution was left out; empty: it was not
  std::optional<GlobalForm> global;

  /// v = M⁻¹(f + Jᵀz) of a global problem; empty for local problems. One factorization of M.
  Vector velocity(const Vector& z) const;
};

ContactProblem read_fclib(const std::filesystem::path& file);

/// Global where `global` is there (written as it is: it must be of this problem), or where A is a Delassus operator
/// without regularization and with M⁻¹ > 0; else local, with A's entries multiplied out. Whole or not at all
/// (core/support/file.h). The problem's rows are a normal row 0 ≤ z, then its friction, an interval (dimension 2), a
/// disc (3) or two discs (5), contact by contact; free rows may stand behind them. Throws std::invalid_argument where
/// they are not. With a solution also the group of that name.
void write_fclib(const std::filesystem::path& file, const ContactProblem& contact_problem,
                 const Solution* solution = nullptr);

}  // namespace orthant
