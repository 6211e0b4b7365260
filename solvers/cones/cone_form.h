// solvers/cones/cone_form.h — scaled form of a problem with friction discs: contacts one after another, units removed.
//
//   Rows are put in the order of the blocks (core/lcp/cones/contact.h), so that block c holds begin(c) ≤ i < begin(c +
//   1), normal first, and scaled by D:
//     z' = D⁻¹z,  w' = D w,  A' = D A D,  q' = D q,  μ'_j = μ_j d_n / d_{T_j}.
//   Then A' has diagonal blocks of mean 1, and ρ = 1 is a step that suits every contact.
//   An operator A = W M⁻¹ Wᵀ + R is formed, some 1.2 kB a contact of a pile, or stays as it is (operand()): then A is
//   empty, and methods that read its entries cannot be used.
#pragma once

#include <orthant/core/lcp/cones/contact.h>

#include <span>
#include <utility>
#include <vector>

namespace orthant {

class ConeForm {
 public:
  /// Products up to which an operator's entries are formed; beyond it load() says false.
  static constexpr double kFormed = 2e8;

  bool load(const Lcp& problem);
  /// The same, an operator left unformed. The problem must outlive the uses of operand().
  void load_unformed(const Lcp& problem);
  bool formed() const { return operand_ == nullptr; }
  const Delassus& operand() const { return *operand_; }
  /// The operator whose entries were formed; null: the problem has entries. As long as the problem lives.
  const Delassus* source() const { return source_; }
  /// Of the problem, one a row here; D, one a row of the problem.
  const std::vector<int>& rows_of_problem() const { return all_.rows(); }
  const Vector& scale() const { return d_; }

  Index size() const { return q.size(); }
  int blocks() const { return all_.size(); }
  const cones::Block& block(int c) const { return all_[c]; }
  int begin(int c) const { return all_[c].start; }
  const cones::Blocks& all() const { return all_; }
  /// Rows of the problem that block c stands for; their d.
  std::span<const int> rows(int c) const { return all_.rows(all_[c]); }
  double scale_of(int row_of_problem) const { return d_[row_of_problem]; }
  /// The block of a row of a formed problem.
  int block_of(int row) const { return of_[at(row)]; }

  /// ‖(e_c)‖ / ‖q'‖ for w = A z + q: the scale-free residual.
  double residual(const Vector& z, const Vector& w) const;
  /// w ← A z + q.
  void apply(const Vector& z, Vector& w) const;

  void to_scaled(const Vector& z, Vector& scaled) const;
  void from_scaled(const Vector& scaled, Vector& z) const;

  RowSparse A;
  Vector q, diagonal;
  double norm_q = 0;

 private:
  void order(const Lcp& problem);
  cones::Blocks all_;
  const Delassus *operand_ = nullptr, *source_ = nullptr;
  std::vector<int> of_;  // the block, per row here
  Vector d_;             // per row of the problem
  // Scratch: per row of the problem, its row here; an operator's entries; a row.
  std::vector<int> place_;
  RowSparse formed_;
  std::vector<std::pair<int, double>> line_;
  mutable Vector unscaled_, product_, inner_;  // of an operator's products
};

}  // namespace orthant
