// core/mechanics/dynamics/schur.h — Schur complement of few joint rows: S = G M⁻¹ Gᵀ = L D Lᵀ, L with unit diagonal.
//
//   M x − Gᵀ λ = f,  G x = c:   S λ = c − G M⁻¹ f,  x = M⁻¹ f + (M⁻¹ Gᵀ) λ
// Cost: n³/6 multiplications and n divisions for the factorization, n² multiplications for each solve.
// Rows are processed in pairs, because most planar joints have two rows and SIMD instructions multiply two numbers at
// once. An odd last row is paired with a row of zeros. Pairs without a common body, such as every second joint of a
// chain, come first: their operations do not depend on each other. Up to kUnrolled rows, in space up to twice as many,
// loop lengths are compile-time constants. Beyond, each pair's row of S begins at the first pair that has a body in
// common with it (an envelope).
#pragma once

#include <orthant/core/mechanics/planar/geometry.h>
#include <orthant/core/support/simd2.h>

#include <array>
#include <span>

namespace orthant {

template <class Space> class SchurOf {
 public:
  using Row = RowOf<Space>;
  static constexpr int kUnrolled = 8;

  /// `rows` states which two bodies each row acts on. These stay the same in all factorizations.
  SchurOf(const Eigen::VectorXd& inverse_mass, std::span<const Row> rows);

  /// Used from the next factorization on.
  void set_inverse_mass(const Eigen::VectorXd& inverse_mass);

  /// False: some pivot D_i is at most `dependent` times S_ii (a ratio that neither masses nor units change), or not
  /// finite.
  bool factorize(std::span<const Row> G, double dependent);

  void solve(const double* f, const double* c, double* x, double* lambda) const;
  /// G (v + x) = c: x, the change of velocities v, without a pass over the rows for G v.
  void solve_change(const double* f, const double* v, const double* c, double* x, double* lambda) const;
  /// Adds to x the solution for f = 0.
  void add_rates(const double* c, double* x) const;
  /// f = rowᵀ, c = 0.
  void solve_row(const Row& row, double* x) const;

  /// The least D_i / S_ii of the last factorization, in (0, 1].
  double independence() const;
  bool finite() const;  // the S of the last factorization, where that gave up on it

 private:
  static constexpr std::size_t kN = Space::kVelocities;
  using Entries = typename Row::Entries;
  using Part = Entries Row::*;
  struct PairOnBody {
    int pair, at, row;           // where it stands here; where its row begins in S; its first row in G
    std::array<Part, 2> parts;   // of its rows, that are on the body, or none
    std::array<Simd2, kN> g, x;  // those parts; times M⁻¹
  };
  struct OnBody {  // pairs from `begin` up to `end` act on the coordinates from `first` on
    int first, begin, end;
    Entries inverse_mass;
  };
  void put_apart_first(std::span<const Row> rows);
  template <class F> decltype(auto) with_pairs(F&& f) const;
  template <class N> bool factorize_pairs(N n, double dependent);
  template <class N> void solve_pairs(N n) const;
  void set_rates(const double* c) const;
  void subtract_rates(const OnBody& body, const Entries& v) const;
  void add_solution(double* x) const;
  void store_forces(double* lambda) const;
  std::span<const PairOnBody> on(const OnBody& b) const {
    return {on_bodies_.data() + b.begin, on_bodies_.data() + b.end};
  }

  int rows_, pairs_, apart_ = 0;  // pairs that come first and have no body in common
  std::vector<int> order_;        // the first row in G of each pair
  std::vector<int> first_;        // the first pair with a body in common with it, or itself: no fill before it
  Eigen::VectorXd inverse_mass_;
  std::vector<PairOnBody> on_bodies_;  // by bodies, pairs ascending; those on the ground have none
  std::vector<OnBody> bodies_;         // ascending
  // Pairs × 2 pairs by rows. S = K B Kᵀ, B of pairs' own l D lᵀ: S_ii and l on the diagonal, below it K = L l⁻¹.
  std::vector<Simd2> S_;
  std::vector<double> pivot_, inverse_pivot_;  // D_i, 1 / D_i
  mutable std::vector<Simd2> lambda_;          // pairs
};
extern template class SchurOf<Planar>;
extern template class SchurOf<Spatial>;
using Schur = SchurOf<Planar>;

}  // namespace orthant
