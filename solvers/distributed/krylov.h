// solvers/distributed/krylov.h — Krylov method with preconditioner of PETSc for one matrix after another.
//
//   B x = r to ‖r − B x‖₂ ≤ rtol ‖r‖₂. Automatic choice, the next one where one fails:
//     up to 1000 rows   LU of the whole matrix on each rank (UMFPACK)
//     B = Bᵀ            conjugate gradients, algebraic multigrid (hypre's BoomerAMG, else GAMG)
//     else              GMRES(100) with the same;  LU (UMFPACK on one rank, MUMPS on several) up to 200 000 rows
//   The next matrix begins with what has succeeded.
//   PETSc's options database may change both, with the prefix orthant_, as in the variable PETSC_OPTIONS:
//     -orthant_pc_hypre_boomeramg_strong_threshold 0.5
//   Source: Saad, Iterative Methods for Sparse Linear Systems (2003); Henson & Yang, Appl. Numer. Math. 41 (2002).
#pragma once

#include <orthant/solvers/distributed/petsc_objects.h>

#include <functional>
#include <vector>

namespace orthant::distributed {

enum class KspName { automatic, cg, minres, gmres, bcgs };
enum class PcName { automatic, jacobi, bjacobi, additive_schwarz, gamg, hypre, lu };

class Krylov {
 public:
  /// `stop` is polled every ten iterations, on all ranks together; where it says true, solve() ends with false.
  Krylov(MPI_Comm comm, KspName ksp, PcName pc, bool symmetric, std::function<bool()> stop);

  /// Rows up to which LU is tried where the methods before fail.
  void set_most_direct(PetscInt rows) { most_direct_ = rows; }
  /// The matrix of the solves that follow. It must outlive them.
  void load(Mat B);
  /// Collective. False: no method of the list reaches rtol, x is not to be used; why() in words.
  bool solve(Vec r, Vec x, double rtol);
  long iterations() const { return iterations_; }            // of all solves
  long preconditioners() const { return preconditioners_; }  // set up
  const std::string& why() const { return why_; }
  /// "cg, hypre" of the last solve.
  std::string words() const;

 private:
  struct Pair {
    const char *ksp, *pc;
  };
  void set_up();
  bool attempt(Vec r, Vec x, double rtol);
  static PetscErrorCode converged(KSP, PetscInt, PetscReal, KSPConvergedReason*, void*);

  MPI_Comm comm_;
  std::vector<Pair> small_, large_;
  std::size_t of_small_ = 0, of_large_ = 0;  // the first that has not failed
  std::function<bool()> stop_;
  Mat matrix_ = nullptr;
  bool is_small_ = false, is_set_up_ = false, stopped_ = false;
  PetscInt rows_ = 0, most_direct_ = 200000;
  OwnedKsp ksp_;
  void* default_test_ = nullptr;
  long iterations_ = 0, preconditioners_ = 0;
  std::string why_;
};

}  // namespace orthant::distributed
