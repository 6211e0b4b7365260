#include <orthant/solvers/registry.h>

#include <orthant/core/support/options.h>
#include <orthant/core/support/registered.h>
#include <orthant/solvers/active_set/block_pivot.h>
#include <orthant/solvers/active_set/interior_point.h>
#include <orthant/solvers/active_set/multigrid.h>
#include <orthant/solvers/active_set/newton_fb.h>
#include <orthant/solvers/active_set/newton_min.h>
#include <orthant/solvers/automatic.h>
#include <orthant/solvers/cones/newton_ac.h>
#include <orthant/solvers/cones/proximal.h>
#include <orthant/solvers/external/ipopt.h>
#include <orthant/solvers/external/nlopt.h>
#include <orthant/solvers/first_order/admm.h>
#include <orthant/solvers/first_order/apgd.h>
#include <orthant/solvers/first_order/jacobi.h>
#include <orthant/solvers/first_order/mprgp.h>
#include <orthant/solvers/first_order/nncg.h>
#include <orthant/solvers/first_order/pgs.h>
#include <orthant/solvers/first_order/psor.h>
#include <orthant/solvers/first_order/sgs.h>
#include <orthant/solvers/pivoting/dantzig.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/pivoting/lemke.h>
#include <orthant/solvers/pivoting/lemke_howson.h>
#include <orthant/solvers/pivoting/murty.h>
#include <orthant/solvers/pivoting/path.h>

#include <stdexcept>

namespace orthant {

namespace {

template <class S> std::vector<OptionEntry> options() { return list_options<SolverOptions<typename S::Options>>(); }

const SolverEntry kSolvers[] = {
    {"auto", "looks at the problem, picks solvers in turn, seeks proofs; its log says which and why",
     &make_with_options<Automatic>, &options<Automatic>},
    {"lemke",
     "lexicographic Lemke pivoting, dense tableau or revised and sparse; friction; rescue up to exact arithmetic",
     &make_with_options<Lemke>, &options<Lemke>},
    {"path", "Newton steps by pivotal paths on the normal map, dense and sparse; boxes, free rows, restarts",
     &make_with_options<Path>, &options<Path>},
    {"pgs", "projected Gauss-Seidel sweeps, friction rows included; positive diagonal", &make_with_options<Pgs>,
     &options<Pgs>},
    {"psor", "projected Gauss-Seidel with over-relaxation found on the way; positive diagonal",
     &make_with_options<Psor>, &options<Psor>},
    {"sgs", "projected Gauss-Seidel sweeps forward and backward; positive diagonal", &make_with_options<Sgs>,
     &options<Sgs>},
    {"jacobi", "projected Jacobi, damped by l1 row sums or as specified; positive diagonal", &make_with_options<Jacobi>,
     &options<Jacobi>},
    {"nncg", "nonsmooth nonlinear conjugate gradients over Gauss-Seidel sweeps; positive diagonal",
     &make_with_options<Nncg>, &options<Nncg>},
    {"apgd", "accelerated projected gradient, adaptive step and restarts; symmetric semidefinite",
     &make_with_options<Apgd>, &options<Apgd>},
    {"mprgp", "conjugate gradients with proportioning and gradient projections; symmetric semidefinite",
     &make_with_options<Mprgp>, &options<Mprgp>},
    {"admm", "operator splitting, one factorization a penalty, unsymmetric too; semidefinite", &make_with_options<Admm>,
     &options<Admm>},
    {"dantzig", "principal pivoting with a driving variable; finite for monotone problems, boxes and free rows",
     &make_with_options<Dantzig>, &options<Dantzig>},
    {"murty", "principal pivoting by the least index; finite for P-matrices, boxes and free rows",
     &make_with_options<Murty>, &options<Murty>},
    {"block-pivot", "block principal pivoting, dense and sparse; P-matrices, boxes and free rows",
     &make_with_options<BlockPivot>, &options<BlockPivot>},
    {"multigrid",
     "sweeps and truncated algebraic multigrid, nothing is factorized; sparse M-matrices, boxes and free rows",
     &make_with_options<Multigrid>, &options<Multigrid>},
    {"newton-min", "semismooth Newton on the minimum map, dense and sparse; line search, Levenberg-Marquardt",
     &make_with_options<NewtonMin>, &options<NewtonMin>},
    {"newton-fb", "semismooth Newton on Fischer-Burmeister, dense and sparse; line search, Levenberg-Marquardt",
     &make_with_options<NewtonFb>, &options<NewtonFb>},
    {"newton-ac",
     "semismooth Newton on contacts: Alart-Curnier, Jean-Moreau, natural map, Fischer-Burmeister; friction discs",
     &make_with_options<NewtonAc>, &options<NewtonAc>},
    {"prox", "proximal point with Newton on contacts inside; friction discs, redundant contacts, unsymmetric too",
     &make_with_options<Proximal>, &options<Proximal>},
    {"interior-point",
     "predictor-corrector, then the exact active set; dense and sparse, monotone; boxes and free rows",
     &make_with_options<InteriorPoint>, &options<InteriorPoint>},
    {"ipopt", "quadratic programs by Ipopt's interior-point method, polished; boxes, free rows, friction; sparse",
     &make_with_options<IpoptSolver>, &options<IpoptSolver>},
    {"nlopt",
     "quadratic form or Fischer-Burmeister merit by NLopt's gradient methods, polished; small or well conditioned",
     &make_with_options<NloptSolver>, &options<NloptSolver>},
    {"lemke-howson", "equilibria of bimatrix games [0, A; B^T, 0] with costs > 0", &make_with_options<LemkeHowson>,
     &options<LemkeHowson>},
    {"enumerate", "every choice of sides, exact, at most 2^20 of them; the oracle of the tests",
     &make_with_options<Enumerate>, &options<Enumerate>},
};

/// The built-in ones, then those that were registered.
std::vector<SolverEntry>& solver_rows() {
  static std::vector<SolverEntry> rows(std::begin(kSolvers), std::end(kSolvers));
  return rows;
}

}  // namespace

std::span<const SolverEntry> solvers() { return solver_rows(); }

void register_solver(SolverEntry entry) {
  entry.name = registered_name("solver", entry.name, solvers());
  entry.summary = kept_text(entry.summary);
  solver_rows().push_back(std::move(entry));
}

std::unique_ptr<Solver> make_solver(std::string_view spec) {
  const auto [name, text] = Spec::parse(spec);
  std::string names;
  for (const SolverEntry& entry : solvers()) {
    if (entry.name == name) return entry.make(text);
    names += (names.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("solver '" + shortened(name) + "': must be one of " + names);
}

}  // namespace orthant
