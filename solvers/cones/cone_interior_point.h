// solvers/cones/cone_interior_point.h — interior-point on friction discs: Nesterov-Todd steps on Coulomb's law itself.
//
//   In self-dual coordinates x = (μ z_n, z_T), y = (w_n/μ + ‖w_T‖, w_T) = Y(w) a contact is  K ∋ x ⊥ y ∈ K, K the
//   second-order cone. The method follows  x∘y = τ e, y = Y(A z + q)  with τ → 0, y an unknown of its own:
//     T² S dz + Y'(w) dw = T L_λ⁻¹ (σ τ e − λ∘λ − (T dx_a)∘(T⁻¹ dy_a)) − (Y(w) − y),   dw = A dz,  S = diag(μ, 1, 1)
//   with the Nesterov-Todd scaling T x = T⁻¹ y = λ; (dx_a, dy_a) the predictor (σ = 0), σ = (τ_a/τ)³ (Mehrotra),
//   τ the mean of xᵀy. Steps go 0.9 + 0.09 α of the way to the boundary. Rows without friction are cones of one row,
//   free rows equations.
//   Iterates of this law get caught at the cone's boundary at 1e-6 … 1e-8: from 1e-3 on, each time that the residual is
//   a thirtieth, z is tried as the start of at most six proximal steps (proximal.h), which end exactly. Where other
//   methods follow (auto), a try goes on only while less than four Newton steps suffice for each: where they do not,
//   the contacts' states are not yet known.
//   One friction disc or interval a normal row, no boxes.
//   Source: Acary, Armand, Nguyen & Shpakovych, Second-order cone programming for frictional contact mechanics using
//   interior point algorithm, Optim. Methods Softw. (2024); Andersen, Dahl & Vandenberghe, CVXOPT (2013): scaling.
#pragma once

#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_system.h>
#include <orthant/solvers/cones/proximal.h>

#include <functional>

namespace orthant {

/// The iteration by itself, for solvers that put several together.
class InteriorCones {
 public:
  InteriorCones();
  ~InteriorCones();
  /// False: it cannot take the problem. All must outlive the iterations.
  bool load(const ConeForm& form, const Budget* budget, ProximalPoint& point);

  struct Watch {
    std::function<bool(const Vector& z)> finished;  // polled with each z; true ends the iteration
    std::function<double()> residual;               // of the z last polled
    std::function<void(int steps, double residual, double step, const char* event)> log;
  };
  /// At most `most` iterations from the interior: z on entry counts for nothing. `insist`: tries are as long as can be,
  /// and where an iterate is caught at the boundary, up to 40 proximal steps from it are the end.
  Claim iterate(Vector& z, int most, bool insist, const Watch& watch);

 private:
  struct Work;
  bool try_out(const Vector& z, int most, bool patient, const Watch& watch);
  const ConeForm* form_ = nullptr;
  const Budget* budget_ = nullptr;
  ProximalPoint* point_ = nullptr;
  ConeSystem system_;
  std::unique_ptr<Work> work_;
};

class ConeInteriorPoint final : public ConeSolver {
 public:
  struct Options {
    double tolerance = 1e-10;
    int max_iterations = 200;
  };
  explicit ConeInteriorPoint(const Options& options) : options_(options) {}
  std::string why_not(const Lcp& problem) const override;

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  InteriorCones interior_;
  ProximalPoint point_;
};

}  // namespace orthant
