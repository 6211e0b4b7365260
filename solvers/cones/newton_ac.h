// solvers/cones/newton_ac.h — semismooth Newton on friction discs: Alart-Curnier, Jean-Moreau, natural map or
// Fischer-Burmeister.
//
//   Newton steps on the problem itself (cone_newton.h) from block sweeps' z. Ten steps at a time with A + α I around
//   the z that they begin at, α = 1e-10: with redundant contacts A and Newton's matrix are singular. α grows a
//   hundredfold where ten steps do not halve the residual, up to 0.1, and falls to a tenth where they do.
//   Quadratic where it converges; `prox` is the safer one.
//   Source: Alart & Curnier (1991); Hüeber, Stadler & Wohlmuth, SIAM J. Sci. Comput. 30 (2008).
#pragma once

#include <orthant/solvers/cones/cone_newton.h>
#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_sweeps.h>

#include <array>
#include <string_view>

namespace orthant {

struct NewtonAcOptions {
  double tolerance = 1e-10;  // accepted residual, as certify() measures it
  int max_steps = 200;       // Newton steps
  int sweeps = 20;           // of block Gauss-Seidel before them
  ContactMap map = ContactMap::alart_curnier;
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_steps", max_steps, 1, 1000000), v("sweeps", sweeps, 0, 1000000);
    using namespace std::string_view_literals;
    v("map", map, std::array{"natural"sv, "alart-curnier"sv, "jean-moreau"sv, "fischer-burmeister"sv});
  }
};

class NewtonAc final : public ConeSolver {
 public:
  using Options = NewtonAcOptions;
  explicit NewtonAc(const Options& options = {}) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ConeNewton newton_;
  Vector centre_;
  ConeSweeps sweeps_;
};

}  // namespace orthant
