// solvers/pivoting/principal_pivoting.h — principal pivoting base, shared by dantzig and murty.
//
//   form      friction rows → pure_form.h; A dense; powers of 2 as scales.
//   attempt   load the tableau in the requested precision, let the method pivot, refine z of the basis it ends on.
#pragma once

#include <orthant/core/lcp/pure_form.h>
#include <orthant/core/lcp/solution.h>
#include <orthant/solvers/linear_algebra/refined_basis.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/pivoting/principal_tableau.h>
#include <orthant/solvers/proof/farkas.h>

#include <string>

namespace orthant::detail {

/// Empty where the dense tableau has room for the problem in pure form.
inline std::string too_large(const Lcp& problem) {
  const Index n = problem.size() + static_cast<Index>(problem.friction.size());
  return n <= 10000 ? "" : "n = " + std::to_string(n) + ": the dense tableau takes at most 10000 rows";
}

class PrincipalPivoting {  // reuse it: the second problem of a size allocates nothing
 public:
  /// The problem, its friction rows written as pure ones; both must outlive the attempts.
  void form(const Lcp& problem) {
    given_ = &problem;
    reduced_ = !problem.friction.empty();
    pure_ = reduced_ ? &pyramid_.pure(problem) : &problem;
    A_ = &dense_of(pure_->A, dense_);
    scaling_.fit(*A_);
  }

  /// Precision 0: double, 1: long double, 2: 256 bits. method(tableau) → Claim. Writes z and iterations.
  template <class Method> Claim attempt(int precision, Vector& z, int& iterations, const Method& method) {
    return tableaus_.visit(precision, [&](auto& t) {
      t.load(*A_, *pure_, scaling_.row, scaling_.col);
      const Claim claim = method(t);
      iterations = t.iterations;
      const Index n = pure_->size();
      y_.resize(n);
      for (Index i = 0; i < n; ++i) y_[i] = static_cast<double>(t.z[at(i)]) * scaling_.col[i];
      if (claim == Claim::candidate) refine(t);
      y_ = y_.cwiseMax(pure_->lo).cwiseMin(pure_->hi);
      if (reduced_)
        pyramid_.restore(*given_, y_, z);
      else
        z = y_;
      return claim;
    });
  }

  /// The pure problem's direction as a certificate of the given one.
  void certificate(Vector& direction, Vector& u) const {
    direction.array() *= scaling_.col.array();
    tidy_certificate(*pure_, direction);
    if (reduced_)
      pyramid_.restore_certificate(*given_, direction, u);
    else
      u = direction;
  }

 private:
  template <class T> void refine(const PrincipalTableau<T>& t) {
    auto& inside = basis_.unknown;
    inside.clear();
    for (Index i = 0; i < pure_->size(); ++i)
      if (t.in[at(i)]) inside.push_back(i);
    basis_.equation = inside;
    double* column = basis_.room();
    for (const Index j : inside)
      for (const Index i : inside)
        *column++ =
            static_cast<double>(t.at(static_cast<int>(i), static_cast<int>(j))) * scaling_.col[i] * scaling_.row[j];
    basis_.refine(*A_, pure_->b, scaling_.col, y_);
  }

  const Lcp* given_ = nullptr;
  const Lcp* pure_ = nullptr;
  const DenseMatrix* A_ = nullptr;
  bool reduced_ = false;
  Pyramid pyramid_;
  DenseMatrix dense_;
  Scaling scaling_;
  PrincipalTableaus tableaus_;
  RefinedBasis basis_;
  Vector y_;
};

}  // namespace orthant::detail
