// solvers/cones/cone_newton.h — semismooth Newton for one proximal problem of friction discs.
//
//   Finds z with −û(w) in the normal cone of K at z, w = (A + α I) z + q − α y, in the scaled form (cone_form.h); y is
//   the centre, α = 0 the problem itself. Each step solves the linear system of cone_system.h with E, H of a map
//   (contact_map.h).
//   Search: the first of the steps t = 1, ½, ¼ with ‖F(z + t dz)‖ ≤ (1 − 1e-4 t) max of the last five ‖F‖
//   (nonmonotone), else the shortest of them. Shorter steps are not tried: where contacts change between stick and
//   slip, a short step does not leave the current pieces of the map, and many rank-deficient piles are then not solved
//   (measured:
//   12 halvings leave 6 of 109 problems above 1e-8, 2 halvings none).
//   The result is the best z of all steps.
//   Sources: Alart & Curnier, Comput. Methods Appl. Mech. Engrg. 92 (1991); Grippo, Lampariello & Lucidi, SIAM J.
//   Numer. Anal. 23 (1986).
#pragma once

#include <orthant/solvers/budget.h>
#include <orthant/solvers/cones/cone_system.h>
#include <orthant/solvers/cones/contact_map.h>

namespace orthant {

class ConeNewton {
 public:
  /// Both must outlive the solves.
  void load(const ConeForm& form, const Budget* budget);

  struct Task {
    ContactMap map = ContactMap::alart_curnier;
    double alpha = 0;
    double tolerance = 0;  // of ‖F‖
    int max_steps = 30;
  };
  struct Outcome {
    int steps = 0;
    double norm = kInf;  // ‖F‖ of the z returned
    bool converged = false;
  };
  Outcome solve(const Task& task, const Vector& centre, Vector& z);

 private:
  double evaluate(const Task& task, const Vector& centre, const Vector& z);

  const ConeForm* form_ = nullptr;
  const Budget* budget_ = nullptr;
  Vector w_, trial_, best_, rho_n_, rho_t_;
  ConeSystem system_;
};

}  // namespace orthant
