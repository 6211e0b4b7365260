// integrators/formulate.h — one step's complementarity problem at velocity level, and its impulses' effect.
//
//   Unknown impulses z = [Λ_G; Λ_N; Λ_T] of the rows J = [G; W_N; W_T];  w = J v⁺ − target,  v⁺ = v_free + B Jᵀ z:
//     A = J B Jᵀ,  b = J v_free − target,    target: γ_N⁺ ≥ −e γ_N⁻,  γ_T⁺ → −e_T γ_T⁻,  G v⁺ = given.
//   Slip γ_T is against the moving surface. μ is the static one for a contact that sticks at the step's start, and for
//   one whose slip turns round within the step, as it passes through rest (a second solve: see hold).
//   reduced: B is the inverse of the basic system with its joints (block elimination of Λ_G: the Schur complement onto
//            the contacts through one factorization of the saddle matrix); no joint rows in J.
//   full:    B = M̂⁻¹; the joints stay as equality rows.
//   Only closed contacts have rows, and only frictional ones a tangent row. Where B is diagonal and a scene has many
//   contacts, A is kept as a Delassus operator and never formed.
//   Both give the same step. Source: Brogliato & Acary (2008), ch. 10; Glocker, Set-Valued Force Laws (2001).
#pragma once

#include <orthant/core/lcp/problem.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/core/mechanics/basic_system.h>
#include <orthant/integrators/integrator.h>

namespace orthant {

enum class Form { reduced, full };

class Formulation {
 public:
  Formulation(const System& system, Form form);

  /// Builds the problem from terms.closed (and terms.G for the full form). v and v_free: velocities before the step
  /// and after it without the impulses z; joint_rate: the wanted G v⁺ (full form only), joint_rows entries.
  /// `basic` is factorized already, with joints for the reduced and without for the full form.
  void formulate(const Terms& terms, const BasicSystem& basic, const Eigen::VectorXd& v, const Eigen::VectorXd& v_free,
                 const Eigen::VectorXd& joint_rate);

  /// Static friction for contacts whose slip the solution turned round. True: there were some, solve again.
  bool hold(const Terms& terms, const Solution& solution);

  const Lcp& problem() const { return lcp_; }
  void clear() { lcp_.b.resize(0); }  // no problem, until the next is built

  /// v += B Jᵀ z, and the contacts' impulses; those of open contacts are zero.
  void advance(const Terms& terms, const Vector& z, Eigen::VectorXd& v, std::vector<Impulse>& impulses) const;

 private:
  void collect(const Terms& terms, const Eigen::VectorXd& v, const Eigen::VectorXd& joint_rate);
  void fill_dense(const BasicSystem& basic, DenseMatrix& A);
  void fill_delassus(Delassus& A);

  const System& system_;
  Form form_;
  std::vector<Row> rows_;  // J
  Vector target_;          // n
  Vector slip_;            // γ_T⁻ of each tangent row
  DenseMatrix columns_;    // dof × n: B Jᵀ, dense storage only
  Lcp lcp_;
};

}  // namespace orthant
