// integrators/derivatives/step_sensitivity.h — sensitivity of a step's problem, for many directions at once.
//
//   The active set, tangent and adjoint of sensitivity.h. A problem of few rows whose pattern is clear (no row weakly
//   active, the matrix well conditioned) is differentiated by the inverse of its active block B:
//     ż = p − E B⁻¹ Pᵀ (ẇ₀ + A p)
// Any other one goes through Sensitivity, which knows redundant and weakly active rows.
// Blocks are stored by rows: entry (i, j) of direction j at i · count + j.
#pragma once

#include <orthant/integrators/derivatives/row_slope.h>
#include <orthant/solvers/derivatives/sensitivity.h>

#include <optional>
#include <vector>

namespace orthant {

/// Whether the impulses of a step are unique: else contacts share them, by the solver's choice. `motion`: the step
/// itself depends on the shares.
enum class Sharing : unsigned char { unique, impulses, motion };

class StepSensitivity {
 public:
  /// problem.A dense; `solution` has an answer. problem stays where it is.
  void set_up(const Lcp& problem, const Solution& solution);
  /// None, until the next set_up().
  void clear() { weak_.clear(), full_.reset(), problem_ = nullptr; }

  const std::vector<WeaklyActive>& weakly_active() const { return weak_; }
  /// z is not unique: rows hold more than once.
  bool redundant() const { return full_ && full_->report().redundant; }

  /// ż (rows × count) of ẇ at fixed z, of hi with lo = −hi (null: unchanged), and of μ, one row a friction. False: a
  /// direction parts redundant rows, by more than rounding: 1e-12 of the largest ẇ of this object's life, a run.
  bool tangent(const double* w, const double* hi, const double* mu, Index count, double* z);
  /// Adjoints of ẇ, of hi − lo and of μ, of the weights of z. False: z depends on how redundant rows share.
  bool adjoint(const Vector& of_z, double* w, double* hi, double* mu);

 private:
  bool set_up_small(const Solution& solution);
  bool place(const Solution& solution);
  bool invert();
  double A(Index i, Index j) const { return std::get<DenseMatrix>(problem_->A)(i, j); }
  Index rows() const { return problem_->size(); }

  enum class At : signed char { lower, upper, free };
  const Lcp* problem_ = nullptr;
  std::optional<Sensitivity> full_;  // where the small way does not do
  std::vector<WeaklyActive> weak_;
  std::vector<At> at_;                // of each row
  std::vector<double> weight_;        // largest |A_ij| of each row, at least 1
  std::vector<signed char> drags_;    // of each friction: s of z_T = s μ z_N; 0: it follows nothing
  std::vector<double> normal_force_;  // of each friction
  std::vector<Index> free_;           // rows of the unknowns
  std::vector<double> inverse_, block_, sum_, held_;
  double largest_rate_ = 1e-6, largest_weight_ = 1e-6;  // of ẇ, and of the weights of z, in all calls
};

}  // namespace orthant
