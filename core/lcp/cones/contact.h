// core/lcp/cones/contact.h — contact blocks of a problem with friction discs: a normal row with all its friction rows.
//
//   Block: rows (n, T_1, T_2, …), T_j one or two rows, the set
//     K = {z: lo ≤ z_n ≤ hi,  ‖z_{T_j}‖ ≤ μ_j z_n for all j};   a row without friction is a block by itself.
//   The law of a block (Coulomb with De Saxcé's correction):
//     −û in the normal cone of K at z,   û = w + e_n Σ_j μ_j ‖w_{T_j}‖                                          (1)
//   that is: z_n and w_n complementary, and each friction opposes its slip. It is the same as
//     z = P_K(z − ρ û)  for any ρ > 0.                                                                           (2)
//   Projection P_K(x), with s_j = ‖x_{T_j}‖: a = z_n minimizes (a − x_n)² + Σ_j max(0, s_j − μ_j a)² on [lo, hi]:
//     a = (x_n + Σ_A μ_j s_j) / (1 + Σ_A μ_j²),  A = {j: s_j > μ_j a},  then clamped;
//     z_{T_j} = P_disc(μ_j a)(x_{T_j}).
//   With one disc on [0, ∞) that is P(x) = x in K, 0 in its polar cone, else a = (x_n + μ s)/(1 + μ²).
//   Units: z' = D⁻¹ z, w' = D w with one positive number a row; the numbers of a disc are equal, and so K stays a cone
//   of the same kind, μ'_j = μ_j d_n / d_{T_j}.  scale(): d = (mean |A_ii| of the normal and its first friction)^−½ for
//   these rows, (mean |A_ii|)^−½ for each further friction (moments have another unit than forces). Then A' has unit
//   diagonal blocks on average, and quantities of z', w' do not depend on units.
//   Source: De Saxcé & Feng, Math. Comput. Modelling 28 (1998); Acary, Brémond & Huber, Advanced Topics in Nonsmooth
//   Dynamics (2018), ch. 9.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <array>
#include <span>

namespace orthant::cones {

struct Part {     // friction of a block
  int place = 1;  // of its first row in the block
  int rows = 1;   // 1 or 2
  double mu = 0;
};

struct Block {
  int start = 0;  // of its rows in Blocks::row
  int rows = 1;
  int parts_start = 0, parts = 0;
  double lo = 0, hi = kInf;
};

/// Largest block of the methods with fixed storage: normal, sliding, rolling, spinning (1 + 2 + 2 + 1).
inline constexpr int kMostRows = 6;
inline constexpr int kMostParts = 5;

class Blocks {
 public:
  /// Blocks in the order of their first rows' normals. The μ_j are those of the problem.
  void load(const Lcp& problem);

  /// d of each row for the matrix A.
  void scale(const Matrix& A, Vector& d) const;
  /// μ_j ← μ_j d_n / d_{T_j}; lo, hi ← lo / d_n, hi / d_n.
  void apply(const Vector& d);

  int size() const { return static_cast<int>(blocks_.size()); }
  const Block& operator[](int k) const { return blocks_[static_cast<std::size_t>(k)]; }
  std::span<const int> rows(const Block& b) const { return {row_.data() + b.start, static_cast<std::size_t>(b.rows)}; }
  /// The problem's rows, one block after another.
  const std::vector<int>& rows() const { return row_; }
  int row(Index i) const { return row_[static_cast<std::size_t>(i)]; }
  std::span<const Part> parts(const Block& b) const {
    return {parts_.data() + b.parts_start, static_cast<std::size_t>(b.parts)};
  }
  int most_rows() const { return most_rows_; }

  /// x, z: the block's rows in its own order (normal first). z ← P_K(x); they may be the same.
  void project(const Block& b, const double* x, double* z) const;
  /// Also the derivative, rows × rows by columns: one element of the generalized Jacobian.
  void project(const Block& b, const double* x, double* z, double* derivative) const;
  /// û of w.
  void correct(const Block& b, const double* w, double* corrected) const;
  /// ‖z − P_K(z − û)‖.
  double residual(const Block& b, const double* z, const double* w) const;

 private:
  static double disc_residual(double mu, const double* z, const double* w);
  double normal(const Block& b, const double* x, bool* clamped, double* squares) const;
  std::vector<Block> blocks_;
  std::vector<Part> parts_;
  std::vector<int> row_;
  int most_rows_ = 0;
  std::vector<int> head_, place_, entry_;  // scratch of load()
  std::vector<char> taken_;
};

}  // namespace orthant::cones
