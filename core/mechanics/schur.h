// core/mechanics/schur.h — few joint rows eliminated onto S = G M⁻¹ Gᵀ, diagonal M:  S = L D Lᵀ, L with unit diagonal.
//
//   M x − Gᵀ λ = f,  G x = c:   S λ = c − G M⁻¹ f,  x = M⁻¹ f + (M⁻¹ Gᵀ) λ
// n³/6 multiplications and n divisions, n² a solve. Up to kUnrolled rows the compiler knows the loops' lengths and keeps
// the factor in registers: the six rows of a slider-crank take two thirds of the time that loops of any length take.
#pragma once

#include <orthant/core/mechanics/geometry.h>

#include <span>

namespace orthant {

class Schur {
 public:
  static constexpr int kUnrolled = 8;

  /// `rows`: with the bodies that all later ones have.
  Schur(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows);

  /// False: some pivot D_i is at most `dependent` times S_ii (a ratio that neither masses nor units change), or not finite.
  bool factorize(std::span<const Row> G, double dependent);

  void solve(const double* f, const double* c, double* x, double* lambda) const;
  /// f = 0.
  void solve_rates(const double* c, double* x, double* lambda) const;

  /// The least D_i / S_ii of the last factorization, in (0, 1].
  double independence() const;
  bool finite() const;  // the S of the last factorization, where that gave up on it

 private:
  struct Shared {  // rows i ≥ j meet in a body: S_ij += g · h, places of three numbers each
    int at, g, h;
  };
  struct Side {  // of a row: where its three numbers are, and the first coordinate of their body
    int row, at, first;
  };
  template <class N> bool factorize_rows(N n, double dependent);
  template <class N> void solve_rows(N n, double* x, double* lambda) const;

  int n_;
  Eigen::VectorXd inverse_mass_;
  std::vector<Side> sides_;             // those not on the ground
  std::vector<double> g_, h_, weight_;  // 6 n: the rows of G, of G M⁻¹, and M⁻¹ (0 for the ground)
  std::vector<Shared> shared_;
  std::vector<double> S_;                      // n × n by rows: S_ii, below the diagonal L
  std::vector<double> pivot_, inverse_pivot_;  // D_i, 1 / D_i
};

}  // namespace orthant
