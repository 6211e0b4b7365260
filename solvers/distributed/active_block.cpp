#include <orthant/solvers/distributed/active_block.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant::distributed {

void ActiveBlock::choose() {
  side.resize(at(problem_.rows()));
  for (Index i = 0; i < problem_.rows(); ++i) {
    const double moved = z[i] - w[i] / problem_.scale()[i];
    side[at(i)] = moved <= problem_.lo()[i] ? Side::lower : moved >= problem_.hi()[i] ? Side::upper : Side::inside;
  }
}

bool ActiveBlock::same_choice() const { return extracted_ && of_block_ == side; }

void ActiveBlock::extract() {
  of_block_ = side;
  inside_.clear();
  for (Index i = 0; i < problem_.rows(); ++i)
    if (side[at(i)] == Side::inside) inside_.push_back(static_cast<PetscInt>(problem_.first() + i));
  inside_of_all_ = sum_of_all(problem_.comm(), static_cast<double>(inside_.size()));
  extracted_ = true;
  if (inside_of_all_ == 0) return;
  if (inside_of_all_ == static_cast<double>(problem_.size())) {
    krylov_.load(problem_.matrix());
    return;
  }
  OwnedIs rows;
  require(ISCreateGeneral(problem_.comm(), static_cast<PetscInt>(inside_.size()), inside_.data(), PETSC_USE_POINTER,
                          rows.out()));
  OwnedMat block;
  require(MatCreateSubMatrix(problem_.matrix(), rows, rows, MAT_INITIAL_MATRIX, block.out()));
  block_ = std::move(block);
  krylov_.load(block_);
}

bool ActiveBlock::step(double rtol) {
  const bool changed = any_of_all(problem_.comm(), !same_choice());
  if (changed) extract();
  for (Index i = 0; i < problem_.rows(); ++i)
    if (side[at(i)] != Side::inside) z[i] = side[at(i)] == Side::lower ? problem_.lo()[i] : problem_.hi()[i];
  problem_.residual(z, w);
  if (inside_of_all_ > 0) {
    const auto k = static_cast<Index>(inside_.size());
    right_.resize(k), part_.resize(k);
    for (Index i = 0; i < k; ++i) right_[i] = -w[inside_[at(i)] - problem_.first()], part_[i] = 0;
    const OwnedVec right = view(problem_.comm(), right_, k), part = view(problem_.comm(), part_, k);
    PetscReal size = 0;
    require(VecNorm(right, NORM_INFINITY, &size));
    if (!std::isfinite(size)) return false;
    if (size > 0 && !krylov_.solve(right, part, rtol)) return false;
    for (Index i = 0; i < k; ++i) z[inside_[at(i)] - problem_.first()] += part_[i];
    problem_.residual(z, w);
  }
  size_.resize(problem_.rows());
  for (Index i = 0; i < problem_.rows(); ++i)
    size_[i] = std::abs(problem_.b()[i]) + std::abs(w[i]) + problem_.scale()[i] * std::abs(z[i]);
  return true;
}

Side ActiveBlock::better(Index i) const {
  constexpr double kFew = 64 * std::numeric_limits<double>::epsilon();
  const double lo = problem_.lo()[i], hi = problem_.hi()[i];
  const double w_noise = kFew * size_[i], z_noise = std::min(w_noise / problem_.scale()[i], 1e-10 * std::abs(z[i]));
  if (lo == hi) return Side::lower;
  switch (side[at(i)]) {
    case Side::inside:
      return z[i] < lo - z_noise ? Side::lower : z[i] > hi + z_noise ? Side::upper : Side::inside;
    case Side::lower:
      return w[i] < -w_noise ? Side::inside : Side::lower;
    default:
      return w[i] > w_noise ? Side::inside : Side::upper;
  }
}

}  // namespace orthant::distributed
