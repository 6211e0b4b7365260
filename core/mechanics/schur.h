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
  /// Adds to x the solution for f = 0.
  void add_rates(const double* c, double* x) const;
  /// f = rowᵀ, c = 0.
  void solve_row(const Row& row, double* x) const;

  /// The least D_i / S_ii of the last factorization, in (0, 1].
  double independence() const;
  bool finite() const;  // the S of the last factorization, where that gave up on it

 private:
  /// The parts of two consecutive rows, or of one and nothing, on one body: joints have most of their rows in twos, and
  /// two numbers are what every processor multiplies at once (a factorization of six rows: 0.7 of the instructions).
  struct Two {
    int row, which;  // the first row; which: 0 its ja, 1 its jb
    bool both;
    Eigen::Array2d x, y, z;  // those parts, times M⁻¹
    const std::array<double, 3>& part(std::span<const Row> G, int k) const {
      const Row& r = G[static_cast<std::size_t>(row + k)];
      return which == 0 ? r.ja : r.jb;
    }
  };
  struct OnBody {  // those from `begin` up to `end` act on the coordinates from `first` on
    int first, begin, end;
    std::array<double, 3> inverse_mass;
  };
  template <class N> bool factorize_rows(N n, double dependent);
  template <class N> void solve_rows(N n, const double* c, double* lambda) const;
  void add_rows(const double* lambda, double* x) const;
  void subtract_rates(const OnBody& body, const double* f) const;
  std::span<Two> on(const OnBody& b) { return {twos_.data() + b.begin, twos_.data() + b.end}; }
  std::span<const Two> on(const OnBody& b) const { return {twos_.data() + b.begin, twos_.data() + b.end}; }

  int n_;
  Eigen::VectorXd inverse_mass_;
  std::vector<Two> twos_;                      // by bodies, rows ascending; those on the ground have none
  std::vector<OnBody> bodies_;                 // ascending
  std::vector<double> S_;                      // n × n by rows, and one place more: S_ii, below the diagonal L
  std::vector<double> pivot_, inverse_pivot_;  // D_i, 1 / D_i
  mutable std::vector<double> lambda_;         // n, and one place more
};

}  // namespace orthant
