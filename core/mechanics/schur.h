// core/mechanics/schur.h — few joint rows eliminated onto S = G M⁻¹ Gᵀ, diagonal M:  S = L D Lᵀ, L with unit diagonal.
//
//   M x − Gᵀ λ = f,  G x = c:   S λ = c − G M⁻¹ f,  x = M⁻¹ f + (M⁻¹ Gᵀ) λ
// n³/6 multiplications and n divisions, n² a solve. Up to kUnrolled rows the compiler knows the loops' lengths and keeps
// the factor in registers: the six rows of a slider-crank take two thirds of the time that loops of any length take.
#pragma once

#include <orthant/core/mechanics/geometry.h>

#include <array>
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
  struct Side {               // a row's part on one body
    int row, which;           // which: 0 its ja, 1 its jb
    std::array<double, 3> h;  // that part, times M⁻¹
    const double* part(std::span<const Row> G) const {
      const Row& r = G[static_cast<std::size_t>(row)];
      return which == 0 ? r.ja.data() : r.jb.data();
    }
  };
  struct OnBody {  // the sides from `begin` (to where the next body's begin) act on the coordinates from `first` on
    int first, begin;
    std::array<double, 3> inverse_mass;
  };
  template <class N> bool factorize_rows(N n, double dependent);
  template <class N> void solve_rows(N n, double* lambda) const;
  void add_rows(const double* lambda, double* x) const;
  /// use(body, its sides) for every body that has any.
  template <class Sides, class Use> void each_body(Sides& sides, Use&& use) const;

  int n_;
  Eigen::VectorXd inverse_mass_;
  std::vector<Side> sides_;  // by bodies, rows ascending; those on the ground have none
  std::vector<OnBody> bodies_;
  std::vector<int> place_;  // of S_ij in S_, for each two sides of one body, in the order of assembly
  std::vector<double> S_;   // n × n by rows: S_ii, below the diagonal L
  std::vector<double> pivot_, inverse_pivot_;  // D_i, 1 / D_i
};

}  // namespace orthant
