// PETSc SNESVI: reduced-space active-set Newton and semismooth Newton, sparse LU in every iteration; boxes.
#include <petscsnes.h>

#include "driver.h"

#include <memory>

using namespace rival;

namespace {

void must(PetscErrorCode error) {
  if (error != 0) throw std::runtime_error("PETSc error " + std::to_string(error));
}

struct State {
  Mat A = nullptr, J = nullptr;  // the semismooth method scales the Jacobian in place
  Vec b = nullptr, x = nullptr, residual = nullptr, lo = nullptr, hi = nullptr;
  SNES snes = nullptr;
  PetscErrorCode error = 0;
};

PetscErrorCode function(SNES, Vec x, Vec f, void* context) {
  const auto* s = static_cast<const State*>(context);
  return MatMultAdd(s->A, x, s->b, f);
}
PetscErrorCode jacobian(SNES, Vec, Mat, Mat J, void* context) {
  return MatCopy(static_cast<const State*>(context)->A, J, SAME_NONZERO_PATTERN);
}

Vec vector(const std::vector<double>& values) {
  Vec v = nullptr;
  must(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(values.size()), &v));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = std::isinf(values[i]) ? (values[i] > 0 ? PETSC_INFINITY : PETSC_NINFINITY) : values[i];
    must(VecSetValue(v, static_cast<PetscInt>(i), x, INSERT_VALUES));
  }
  must(VecAssemblyBegin(v)), must(VecAssemblyEnd(v));
  return v;
}

Method method(const char* name, SNESType type) {
  return {name, "boxes", [=](const Problem& p, double tolerance) -> Work {
            if (p.value.size() > 30000000) throw Unsupported("more than 30 million entries");
            auto s = std::make_shared<State>();
            const auto n = static_cast<PetscInt>(p.n);
            std::vector<PetscInt> count;
            for (std::size_t i = 0; i < p.b.size(); ++i)
              count.push_back(static_cast<PetscInt>(p.start[i + 1] - p.start[i]) + 1);
            must(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, count.data(), &s->A));
            for (PetscInt i = 0; i < n; ++i) {
              must(MatSetValue(s->A, i, i, 0, ADD_VALUES));  // the place must be there
              for (auto k = p.start[static_cast<std::size_t>(i)]; k < p.start[static_cast<std::size_t>(i) + 1]; ++k)
                must(MatSetValue(s->A, i, p.column[static_cast<std::size_t>(k)], p.value[static_cast<std::size_t>(k)],
                                 ADD_VALUES));
            }
            must(MatAssemblyBegin(s->A, MAT_FINAL_ASSEMBLY)), must(MatAssemblyEnd(s->A, MAT_FINAL_ASSEMBLY));
            must(MatDuplicate(s->A, MAT_COPY_VALUES, &s->J));
            s->b = vector(p.b), s->lo = vector(p.lo), s->hi = vector(p.hi);
            must(VecDuplicate(s->b, &s->x)), must(VecDuplicate(s->b, &s->residual));
            must(SNESCreate(PETSC_COMM_SELF, &s->snes));
            must(SNESSetType(s->snes, type));
            must(SNESSetFunction(s->snes, s->residual, function, s.get()));
            must(SNESSetJacobian(s->snes, s->J, s->J, jacobian, s.get()));
            must(SNESVISetVariableBounds(s->snes, s->lo, s->hi));
            must(SNESSetTolerances(s->snes, tolerance, 0, 0, 1000, 100000));
            KSP linear = nullptr;
            PC factors = nullptr;
            must(SNESGetKSP(s->snes, &linear)), must(KSPSetType(linear, KSPPREONLY));
            must(KSPGetPC(linear, &factors)), must(PCSetType(factors, PCLU));
            return {[s] { must(VecSet(s->x, 0)); }, [s] { s->error = SNESSolve(s->snes, nullptr, s->x); },
                    [s] {
                      SNESConvergedReason reason{};
                      PetscInt iterations = 0, size = 0;
                      must(SNESGetConvergedReason(s->snes, &reason)),
                          must(SNESGetIterationNumber(s->snes, &iterations));
                      must(VecGetSize(s->x, &size));
                      const double* z = nullptr;
                      must(VecGetArrayRead(s->x, &z));
                      return Answer{s->error == 0 && reason > 0,
                                    static_cast<int>(iterations),
                                    SNESConvergedReasons[reason],
                                    {z, z + size}};
                    }};
          }};
}

}  // namespace

int main(int argc, char** argv) {
  int nothing = 1;  // its options are not on this command line
  if (PetscInitialize(&nothing, &argv, nullptr, nullptr) != 0) return 1;
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  return drive(argc, argv, {method("vinewton-rsls", SNESVINEWTONRSLS), method("vinewton-ssls", SNESVINEWTONSSLS)});
}
