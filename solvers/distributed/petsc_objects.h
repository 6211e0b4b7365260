// solvers/distributed/petsc_objects.h — PETSc objects with owners, errors as exceptions, PETSc started without side
// effects.
//
//   Methods of this folder are collective: all ranks of the problem's communicator call them together, with equal
//   options. A fault that one rank alone finds is reported to the others, and all throw the same exception
//   (require_everywhere).
#pragma once

#include <petscksp.h>
#include <petscsf.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace orthant::distributed {

/// PETSc or MPI reports an error: its own words.
struct PetscError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws PetscError where `code` is not 0.
void require(PetscErrorCode code);

/// Collective. Throws std::invalid_argument on all ranks, with the words of the lowest rank that has some; empty words
/// mean that all is well.
void require_everywhere(MPI_Comm comm, const std::string& wrong);

/// Starts MPI and PETSc where they do not run yet: no signal handlers, no options from files, no output. Ended at the
/// exit of the process that started them. Without mpirun this process is alone.
void start_petsc();

/// Sole owner of a Mat, Vec, …. out() is for PETSc's functions that create one.
template <class T, PetscErrorCode (*destroy)(T*)> class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    if (this != &other) clear(), object_ = std::exchange(other.object_, nullptr);
    return *this;
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  ~Owned() { clear(); }
  T* out() {
    clear();
    return &object_;
  }
  operator T() const { return object_; }

 private:
  void clear() {
    PetscBool over = PETSC_FALSE;
    if (object_ != nullptr && PetscFinalized(&over) == 0 && over == PETSC_FALSE) destroy(&object_);
    object_ = nullptr;
  }
  T object_ = nullptr;
};
using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedKsp = Owned<KSP, KSPDestroy>;
using OwnedIs = Owned<IS, ISDestroy>;
using OwnedSf = Owned<PetscSF, PetscSFDestroy>;
using OwnedLayout = Owned<PetscLayout, PetscLayoutDestroy>;

/// The same number on all ranks: the sum, the largest, the least.
double sum_of_all(MPI_Comm comm, double x);
double largest_of_all(MPI_Comm comm, double x);
double least_of_all(MPI_Comm comm, double x);
bool any_of_all(MPI_Comm comm, bool x);

}  // namespace orthant::distributed
