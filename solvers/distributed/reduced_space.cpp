// Reduced space: primal-dual active set with Murty's rule against cycles, on distributed rows.
#include <orthant/solvers/distributed/distributed_newton.h>

#include <algorithm>
#include <cmath>

namespace orthant::distributed {
namespace {

constexpr double kManyWrong = 1e-3;                                         // of the rows wrong: rough steps show them
constexpr double kRoughStep = 1e-4, kFineStep = 1e-8, kSingleStep = 1e-11;  // ‖residual‖ of a step over that before
constexpr int kIdleSteps = 3;  // in a row that do not halve the residual: rounding is reached

}  // namespace

Claim DistributedNewton::reduced_space(NewtonSolution& s) {
  const MPI_Comm comm = problem_.comm();
  const Index m = problem_.rows();
  double wrong = static_cast<double>(problem_.size()), least = kInf, last_residual = kInf;
  int patience = options_.patience, idle = 0;
  while (s.iterations < options_.max_iterations) {
    ++s.iterations;
    const bool many = wrong > kManyWrong * static_cast<double>(problem_.size());
    if (!block_.step(patience == 0 ? kSingleStep : many ? kRoughStep : kFineStep)) {
      s.reason = krylov_.why();
      return stop() ? interrupted() : Claim::stalled;
    }
    Index own = 0, last = -1;
    for (Index i = 0; i < m; ++i)
      if (block_.better(i) != block_.side[at(i)]) ++own, last = problem_.first() + i;
    wrong = sum_of_all(comm, static_cast<double>(own));
    log(s.iterations, wrong, 0, patience > 0 ? "block" : "single");
    if (accepted(block_.z, s)) return Claim::candidate;
    if (!(s.residual < kInf)) return Claim::stalled;
    if (wrong == 0) {  // the right choice, if there is one: what is left is the linear system
      idle = best_.residual < 0.5 * last_residual ? 0 : idle + 1;
      last_residual = best_.residual;
      if (idle >= kIdleSteps) return Claim::stalled;
    }
    if (stop()) return interrupted();
    if (wrong < least)
      least = wrong, patience = options_.patience;
    else if (wrong > 0)
      patience = std::max(0, patience - 1);
    const auto first_to_move =
        patience > 0 || wrong <= 1 ? Index{0} : static_cast<Index>(largest_of_all(comm, static_cast<double>(last)));
    for (Index i = std::max<Index>(0, first_to_move - problem_.first()); i < m; ++i)
      block_.side[at(i)] = block_.better(i);
  }
  return Claim::iteration_limit;
}

}  // namespace orthant::distributed
