// solvers/distributed/distributed_newton.h — active-set and semismooth Newton methods on distributed rows.
//
//   reduced-space   primal-dual active set: each iteration takes the Newton step of its choice of sides
//                   (active_block.h) and moves every row with a wrong sign. After `patience` iterations in which the
//                   number of wrong rows did not fall below its least, only the last wrong row of all ranks moves
//                   (Murty's rule), until it does: finite for P-matrices. A block that cannot be solved: semismooth
//                   goes on from there.
//   semismooth      Newton on the Fischer-Burmeister function Φ, V d = −Φ with V = diag(da) + diag(db) A; a d that is
//                   no descent of ½‖Φ‖² is replaced by −VᵀΦ; nonmonotone Armijo line search. Near the end the active
//                   rows are identified and solved for.
//   Cold, both start from A z = −b cut to the bounds: where A is an M-matrix, rows then leave in large blocks.
//   Linear systems: krylov.h. Each iterate, cut to the bounds, is shown to the distributed judge; it alone accepts.
//   Equal bits for equal data, options and number of ranks; another number of ranks adds up in another order.
//   Cost an iteration: a preconditioner and 5 to 20 of its applications; two reductions each for conjugate gradients.
//   Source: Hintermüller, Ito & Kunisch, SIAM J. Optim. 13 (2002) 865-888; Júdice & Pires, Computers & Operations
//   Research 21 (1994) 587-596; De Luca, Facchinei & Kanzow, Math. Programming 75 (1996) 407-439; Benson & Munson,
//   Optimization Methods and Software 21 (2006) 1-15 (both methods over PETSc).
#pragma once

#include <orthant/solvers/budget.h>
#include <orthant/solvers/distributed/active_block.h>
#include <orthant/solvers/distributed/distributed_judge.h>
#include <orthant/solvers/iteration_log.h>

#include <array>
#include <string_view>

namespace orthant::distributed {

struct NewtonOptions {
  enum class Method { reduced_space, semismooth };
  double tolerance = 1e-10;  // accepted residual relative to the data, as certify() measures it
  int max_iterations = 500;
  Method method = Method::reduced_space;
  KspName ksp = KspName::automatic;  // krylov.h
  PcName pc = PcName::automatic;
  int patience = 10;
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_iterations", max_iterations, 1, 1000000);
    v("method", method, std::array<std::string_view, 2>{"reduced-space", "semismooth"});
    v("ksp", ksp, std::array<std::string_view, 5>{"auto", "cg", "minres", "gmres", "bcgs"});
    v("pc", pc,
      std::array<std::string_view, 7>{"auto", "jacobi", "bjacobi", "additive-schwarz", "gamg", "hypre", "lu"});
    v("patience", patience, 0, 1000);
  }
};

/// Every rank has the same but z and w.
struct NewtonSolution {
  Status status = Status::not_run;
  double residual = kInf;  // as Solution::residual
  Miss miss;               // row of the whole problem
  int iterations = 0;
  long krylov_iterations = 0, preconditioners = 0;
  int rounds = 0;      // of the last judge
  std::string reason;  // why a linear system could not be solved; else empty
  Vector z, w;         // m, own rows
};

class DistributedNewton {
 public:
  /// The problem must outlive it. Collective, as solve().
  DistributedNewton(const DistributedLcp& problem, const NewtonOptions& options);

  /// From the next solve on. All ranks set a limit, or none [s]; the first to reach it ends the run of all.
  void set_time_limit(double seconds) { time_limit_ = seconds; }
  /// A flag that another thread may raise; all ranks set one, or none. Null: none.
  void set_cancel(const std::atomic<bool>* cancel) { cancel_ = cancel; }
  /// Where this rank writes the iterations; null: nowhere.
  void set_log(IterationLog* log) { log_ = log; }

  /// `warm`: s.z, m finite entries, is the start. Statuses solved and rounded are the distributed judge's; the others
  /// say how the run ended: iteration_limit, time_limit, cancelled, stalled, numerical_error.
  void solve(NewtonSolution& s, bool warm = false);

 private:
  Claim reduced_space(NewtonSolution& s);
  Claim semismooth(NewtonSolution& s);
  bool stop() const;  // on all ranks together
  Claim interrupted() const;
  void start(NewtonSolution& s, bool warm);
  /// z cut to the bounds before the judge; kept in s where it is the best so far. True: an answer.
  bool accepted(const Vector& z, NewtonSolution& s);
  void log(int iteration, double merit, double step, const std::string& event) {
    if (log_ != nullptr) log_->push_back({iteration, merit, step, event});
  }
  // semismooth
  double merit(Vector& z);  // ½‖Φ‖² over all ranks; fills w_, phi_, da_, db_
  bool direction();         // direction_, gradient_
  void descend();           // direction_ ← −gradient_, of a useful length
  bool search(double limit, double& now, double& length);
  bool polish(double& now, NewtonSolution& s);
  double dot(const Vector& x, const Vector& y) const;

  const DistributedLcp& problem_;
  NewtonOptions options_;
  Budget budget_;
  double time_limit_ = kInf;
  const std::atomic<bool>* cancel_ = nullptr;
  IterationLog* log_ = nullptr;
  DistributedJudge judge_;
  Krylov krylov_, krylov_of_v_;
  ActiveBlock block_;
  Vector cut_, z_, trial_, w_, phi_, da_, db_, direction_, gradient_, product_;
  Verdict best_;
  OwnedMat v_;
};

}  // namespace orthant::distributed
