#include <orthant/core/mechanics/dynamics/sparse_schur.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthant {
namespace {

constexpr std::size_t kMostEntries = 32;  // of S a row, on average

}  // namespace

template <class Space>
std::unique_ptr<SparseSchurOf<Space>> SparseSchurOf<Space>::of(std::span<const Row> rows, int bodies) {
  std::vector<std::vector<int>> on(static_cast<std::size_t>(bodies));  // the rows of each body, ascending
  std::vector<int> start{0}, index;
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const auto first = static_cast<std::ptrdiff_t>(index.size());
    for (const int body : {rows[j].a, rows[j].b}) {
      if (body < 0) continue;
      std::vector<int>& others = on[static_cast<std::size_t>(body)];
      if (others.empty() || others.back() != static_cast<int>(j)) others.push_back(static_cast<int>(j));
      index.insert(index.end(), others.begin(), others.end());
      if (index.size() > kMostEntries * rows.size()) return nullptr;
    }
    std::sort(index.begin() + first, index.end());
    index.erase(std::unique(index.begin() + first, index.end()), index.end());
    start.push_back(static_cast<int>(index.size()));
  }
  std::unique_ptr<SparseSchurOf> schur(new SparseSchurOf(std::move(start), std::move(index)));
  return schur->factor_.analyse(schur->columns()) ? std::move(schur) : nullptr;
}

template <class Space> SparseSchurOf<Space>::SparseSchurOf(std::vector<int> start, std::vector<int> index)
    : start_(std::move(start)),
      index_(std::move(index)),
      value_(index_.size()),
      diagonal_(start_.size() - 1),
      wanted_(start_.size() - 1),
      missing_(start_.size() - 1) {}

template <class Space>
bool SparseSchurOf<Space>::factorize(std::span<const Row> G, const Eigen::VectorXd& inverse_mass, double dependent) {
  G_.assign(G.begin(), G.end());
  inverse_mass_ = inverse_mass;
  for (std::size_t j = 0; j < G_.size(); ++j) {
    const auto end = static_cast<std::size_t>(start_[j + 1]);
    for (auto k = static_cast<std::size_t>(start_[j]); k < end; ++k)
      value_[k] = coupling(G_[static_cast<std::size_t>(index_[k])], G_[j], inverse_mass_);
    diagonal_[j] = value_[end - 1];
  }
  independence_ = factor_.factorize(columns(), 0) ? factor_.least_pivot_share(diagonal_) : 0;
  return independence_ > dependent;
}

template <class Space> void SparseSchurOf<Space>::solve(const double* f, const double* c, double* x, double* lambda) {
  x_ = inverse_mass_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(f, inverse_mass_.size()));
  std::copy_n(c, wanted_.size(), wanted_.begin());  // c may be lambda
  std::fill_n(lambda, wanted_.size(), 0.0);
  // The second round takes out what rounding has left of c − G x, above all of long chains.
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < G_.size(); ++i) missing_[i] = wanted_[i] - apply(G_[i], x_.data());
    if (!factor_.solve(missing_)) std::fill(missing_.begin(), missing_.end(), std::nan(""));  // no memory: no result
    for (std::size_t i = 0; i < G_.size(); ++i) {
      lambda[i] += missing_[i];
      apply_impulse(G_[i], missing_[i], inverse_mass_, x_);
    }
  }
  std::copy_n(x_.data(), x_.size(), x);
}

template class SparseSchurOf<Planar>;
template class SparseSchurOf<Spatial>;

}  // namespace orthant
