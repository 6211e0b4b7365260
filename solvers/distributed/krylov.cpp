#include <orthant/solvers/distributed/krylov.h>

#include <cmath>
#include <string_view>

namespace orthant::distributed {
namespace {

constexpr PetscInt kSmallBlock = 1000;     // rows up to which LU is taken at once
constexpr PetscInt kMostIterations = 500;  // iterations of a solve
#ifdef PETSC_HAVE_HYPRE
constexpr const char* kAlgebraicMultigrid = PCHYPRE;
#else
constexpr const char* kAlgebraicMultigrid = PCGAMG;
#endif

const char* name_of(KspName ksp, bool symmetric) {
  switch (ksp) {
    case KspName::cg:
      return KSPCG;
    case KspName::minres:
      return KSPMINRES;
    case KspName::gmres:
      return KSPGMRES;
    case KspName::bcgs:
      return KSPBCGS;
    default:
      return symmetric ? KSPCG : KSPGMRES;
  }
}

const char* name_of(PcName pc) {
  switch (pc) {
    case PcName::jacobi:
      return PCJACOBI;
    case PcName::bjacobi:
      return PCBJACOBI;
    case PcName::additive_schwarz:
      return PCASM;
    case PcName::gamg:
      return PCGAMG;
    case PcName::lu:
      return PCLU;
    default:
      return kAlgebraicMultigrid;
  }
}

}  // namespace

Krylov::Krylov(MPI_Comm comm, KspName ksp, PcName pc, bool symmetric, std::function<bool()> stop)
    : comm_(comm), stop_(std::move(stop)) {
  large_.push_back({name_of(ksp, symmetric), name_of(pc)});
  if (ksp == KspName::automatic && symmetric) large_.push_back({KSPGMRES, name_of(pc)});
  if (pc == PcName::automatic) {
    large_.push_back({KSPGMRES, PCLU});
    small_.push_back({KSPGMRES, PCLU});
  } else {
    small_ = large_;
  }
}

void Krylov::load(Mat B) {
  matrix_ = B;
  PetscInt columns = 0;
  require(MatGetSize(B, &rows_, &columns));
  is_small_ = rows_ <= kSmallBlock;
  is_set_up_ = false;
}

std::string Krylov::words() const {
  const auto& list = is_small_ ? small_ : large_;
  const auto index = is_small_ ? of_small_ : of_large_;
  return index < list.size() ? std::string(list[index].ksp) + ", " + list[index].pc : "";
}

PetscErrorCode Krylov::converged(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason* reason,
                                 void* context) {
  auto& self = *static_cast<Krylov*>(context);
  const PetscErrorCode code = KSPConvergedDefault(ksp, iteration, norm, reason, self.default_test_);
  if (code != 0 || *reason != KSP_CONVERGED_ITERATING || iteration == 0 || iteration % 10 != 0 || !self.stop_)
    return code;
  if (self.stop_()) self.stopped_ = true, *reason = KSP_DIVERGED_ITS;
  return 0;
}

void Krylov::set_up() {
  const auto [ksp, pc] = is_small_ ? small_[of_small_] : large_[of_large_];
  require(KSPCreate(comm_, ksp_.out()));
  require(KSPSetOptionsPrefix(ksp_, "orthant_"));
  require(KSPSetOperators(ksp_, matrix_, matrix_));
  require(KSPSetType(ksp_, ksp));
  const std::string_view type = ksp;
  if (type == KSPGMRES) {
    require(KSPGMRESSetRestart(ksp_, 100));
    require(KSPSetPCSide(ksp_, PC_RIGHT));
  }
  if (type == KSPCG) require(KSPSetNormType(ksp_, KSP_NORM_UNPRECONDITIONED));
  PC object = nullptr;
  require(KSPGetPC(ksp_, &object));
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  const bool lu = std::string_view(pc) == PCLU, everywhere = lu && is_small_ && ranks > 1;
  require(PCSetType(object, everywhere ? PCREDUNDANT : pc));
  if (everywhere) {
    KSP inner = nullptr;
    require(PCRedundantGetKSP(object, &inner));
    require(KSPGetPC(inner, &object));
    require(PCSetType(object, PCLU));
  }
  if (lu) require(PCFactorSetMatSolverType(object, ranks == 1 || everywhere ? MATSOLVERUMFPACK : MATSOLVERMUMPS));
  if (std::string_view(pc) == PCASM) require(PCASMSetOverlap(object, 1));
  require(KSPConvergedDefaultCreate(&default_test_));
  require(KSPSetConvergenceTest(ksp_, converged, this, [](void* context) {
    return KSPConvergedDefaultDestroy(static_cast<Krylov*>(context)->default_test_);
  }));
  require(KSPSetFromOptions(ksp_));
  ++preconditioners_;
  is_set_up_ = true;
}

bool Krylov::attempt(Vec r, Vec x, double rtol) {
  if (!is_set_up_) set_up();
  require(KSPSetTolerances(ksp_, rtol, 1e-300, 1e10, kMostIterations));
  require(KSPSolve(ksp_, r, x));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  require(KSPGetConvergedReason(ksp_, &reason));
  require(KSPGetIterationNumber(ksp_, &iterations));
  iterations_ += iterations;
  PetscReal size = 0;
  require(VecNorm(x, NORM_INFINITY, &size));
  why_ = words() + ": " + KSPConvergedReasons[reason];
  return reason > 0 && std::isfinite(size);
}

bool Krylov::solve(Vec r, Vec x, double rtol) {
  const auto& list = is_small_ ? small_ : large_;
  std::size_t& index = is_small_ ? of_small_ : of_large_;
  stopped_ = false;
  const auto tried_from = index;
  for (; index < list.size(); ++index, is_set_up_ = false) {
    if (!is_small_ && std::string_view(list[index].pc) == PCLU && rows_ > most_direct_ && index > 0) break;
    try {
      if (attempt(r, x, rtol)) return true;
    } catch (const PetscError& error) {
      why_ = words() + ": " + error.what();
    }
    if (stopped_) break;
  }
  index = std::min(tried_from, list.size() - 1);  // another matrix may be one that it can
  is_set_up_ = false;
  return false;
}

}  // namespace orthant::distributed
