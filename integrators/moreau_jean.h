// integrators/moreau_jean.h — Moreau–Jean θ-stepping at velocity level.
//
//   q_θ = q + θ h v;  f, G, W at (t + θ h, q_θ, v);  closed: g_N(q_θ) ≤ 0
//   M̂ (v⁺ − v) = h f + Gᵀ Λ_G + W_Nᵀ Λ_N + W_Tᵀ Λ_T,    M̂ = M + h²θ² K + hθ C   (springs, dampers: linearly implicit)
//   0 ≤ Λ_N ⊥ γ_N⁺ + e γ_N⁻ ≥ 0,    Λ_T ∈ −μ Λ_N Sgn(γ_T⁺ + e_T γ_T⁻)
//   q⁺ = q + h (θ v⁺ + (1−θ) v)
// Joints, by the option `joints`:
//   none       G v⁺ = 0                      positions drift by O(h) over a fixed time
//   position   G v⁺ = 0, then q⁺ is projected onto Φ = 0 (in the metric of M)
//   symmetric  G (θ v⁺ + (1−θ) v) = 0, then q⁺ and v⁺ are projected onto Φ = 0, G v⁺ = 0. For θ = ½ the smooth motion
//              is of second order; contact impulses act through the constrained inverse and leave G v⁺ as it was.
// Order 1 with impacts. A failed solve leaves the state as it was.
// Source: Moreau, Unilateral contact and dry friction in finite freedom dynamics (1988); Jean, CMAME 177 (1999) 235-257;
// Brogliato & Acary, Numerical Methods for Nonsmooth Dynamical Systems (2008), ch. 10.
#pragma once

#include <orthant/integrators/formulate.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/projection.h>

#include <array>
#include <string_view>

namespace orthant {

enum class Joints { none, position, symmetric };
inline constexpr std::array<std::string_view, 3> kJointsNames = {"none", "position", "symmetric"};
inline constexpr std::array<std::string_view, 2> kFormNames = {"reduced", "full"};

struct MoreauJeanOptions {
  double theta = 0.5;
  Joints joints = Joints::symmetric;
  Form form = Form::reduced;
  template <class V> void visit(V&& v) {
    v("theta", theta, 0.5, 1.0), v("joints", joints, kJointsNames), v("form", form, kFormNames);
  }
};

class MoreauJean final : public Integrator {
 public:
  using Options = MoreauJeanOptions;
  explicit MoreauJean(const System& system, const Options& options = {});
  StepReport step(double h, Solver& solver, State& x) override;
  const Lcp& problem() const override { return formulation_.problem(); }

 private:
  bool free_flight(double h, const State& x);  // v_new_ without contact impulses (full form: without any)
  bool settle(StepReport& report);             // projection; joint residual and penetration at the end

  Options options_;
  Terms terms_;
  BasicSystem basic_;  // of the step: with joints in the reduced form
  Projection projection_;
  Formulation formulation_;
  Solution solution_;
  Eigen::VectorXd q_mid_, q_new_, v_new_, force_, rate_, lambda_;
};

}  // namespace orthant
