// solvers/cones/cone_sweeps.h — block Gauss-Seidel: contact by contact, each solved exactly with the others held.
//
//   Sweep c = 1 … :  q_c = w_c − A_cc z_c,  z_c ← solution of the one contact (contact_solve.h).   O(nnz) a sweep.
//   Converges for diagonally heavy problems; in practice to a moderate accuracy, in a number of sweeps that grows with
//   the height of a pile and its mass ratios.
//   Source: Moreau (1999); Jourdan, Alart & Jean, Comput. Methods Appl. Mech. Engrg. 155 (1998).
#pragma once

#include <orthant/solvers/cones/cone_form.h>
#include <orthant/solvers/cones/contact_solve.h>

namespace orthant {

class ConeSweeps {
 public:
  /// It must outlive the sweeps.
  void load(const ConeForm& form);
  /// One sweep, forward or backward; z ← (1 − ω) z + ω (solution). Returns ‖z_new − z_old‖.
  double sweep(Vector& z, double omega = 1, bool backward = false);

 private:
  void load_others(const cones::Block& block);
  void find_data(int c, const Vector& z, double* q) const;

  const ConeForm* form_ = nullptr;
  std::vector<double> own_;           // A_cc by columns, one after another
  std::vector<int> place_;            // per block, its own_
  std::vector<DiscContact> contact_;  // per block
  // Per block, the other columns that it has entries in: start, column, and as many values as the block has rows.
  std::vector<int> start_, column_;
  std::vector<std::size_t> values_;  // per block, where its values begin
  std::vector<double> value_;
  std::vector<std::size_t> next_;  // scratch: per row of a block, its next entry
};

}  // namespace orthant
