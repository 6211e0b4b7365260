// solvers/cones/operator_sweeps.h — block Gauss-Seidel on an operator that is never formed, in domains for threads.
//
//   The sweeps of cone_sweeps.h for A' = D (W M⁻¹ Wᵀ + R) D. The state u = M⁻¹ Wᵀ z follows each change of z:
//     q_c = w_c − A'_cc z'_c,  w_c = D (W_c u + R z + b);   u ← u + M⁻¹ W_cᵀ Δz_c.
//   About 170 B a contact besides the problem, and 72 products a sweep and contact of two bodies, where the formed A'
//   takes 1.2 kB and some hundred. u is summed up again every kFresh sweeps, lest rounding pile up.
//   Order: colours of domains (sweep_domains.h), contacts of a domain one after the other. Every result has the same
//   bits with any number of threads.
#pragma once

#include <orthant/solvers/cones/contact_solve.h>
#include <orthant/solvers/cones/sweep_domains.h>
#include <orthant/solvers/thread_team.h>

#include <vector>

namespace orthant {

class OperatorSweeps {
 public:
  /// A form whose operator is not formed; it must outlive the sweeps. `team`: null for the caller's thread alone.
  void load(const ConeForm& form, ThreadTeam* team = nullptr);
  /// Frees what load() and start() have filled.
  void release();
  /// State of this z, the start of the sweeps.
  void start(const Vector& z);
  /// One sweep, as ConeSweeps::sweep().
  double sweep(Vector& z, double omega = 1, bool backward = false);
  /// ‖(e_c)‖ / ‖q'‖ of the z last swept: the scale-free residual, without a product with A.
  double residual(const Vector& z) const;
  /// u of the z last swept. Who moves z along a line may move it likewise.
  Vector& state() { return state_; }
  /// The next sweep begins by start(): what was noted of the state before it is no longer so to rounding.
  bool stale() const { return since_fresh_ >= kFresh; }

 private:
  static constexpr int kFresh = 64;

  struct Lines;  // rows of W that a block of three has
  void find_own(int c);
  double sweep_domain(int domain, Vector& z, double omega, bool backward);
  double solve_block(int c, Vector& z, double omega);
  void rates(int c, const double* z, double* w) const;
  void push(int c, const double* change);
  template <class Work> void each_domain(bool backward, const Work& work);

  const ConeForm* form_ = nullptr;
  ThreadTeam* team_ = nullptr;
  ThreadTeam alone_{1};
  SweepDomains domains_;
  std::vector<double> own_;  // A'_cc by columns, one after another
  std::vector<int> place_;   // per block, its own_
  std::vector<char> alike_;  // per block: three rows with entries in the same columns
  Vector state_;
  mutable std::vector<double> part_;  // per domain
  int since_fresh_ = 0;
};

}  // namespace orthant
