#include <orthant/core/mechanics/dynamics/sparse_schur.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthant {
namespace {

constexpr std::size_t kMostEntries = 32;   // of S a row, on average
constexpr double kShift = 1e-8;            // of S_ii: most of the digits are left to the rows, enough to the shift
constexpr double kExplained = 1e-6;        // pivots of dependent rows: the shift times what rows they depend on
constexpr double kRounding = 4e-16;        // of the largest term of c − G x
constexpr double kNothing = 30 * 2.2e-16;  // of a combination of rows, by the length of its coefficients: dependent
constexpr double kGood = 1e-6;             // of the largest term: a solution, though rounds no longer improve it
constexpr double kDiverged = 1e12;         // of the least square: after the last digit rounding grows
constexpr int kRounds = 500, kPatience = 60;

double weighted_length(const std::vector<double>& v, const std::vector<double>& weight) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) sum += weight[i] * v[i] * v[i];
  return std::sqrt(sum);
}

/// fᵀ M⁻¹ f.
double square_of(const Eigen::VectorXd& force, const Eigen::VectorXd& inverse_mass) {
  return force.dot(inverse_mass.cwiseProduct(force));
}

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

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
      share_(start_.size() - 1),
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
  dependent_ = false;
  if (!factor_.factorize(columns(), 0)) return false;
  factor_.pivot_shares(diagonal_, share_);
  independence_ = std::min(1.0, *std::min_element(share_.begin(), share_.end()));
  rank_ = static_cast<int>(G_.size());
  return independence_ > dependent;
}

template <class Space> bool SparseSchurOf<Space>::factorize_dependent() {
  rank_ = 0, independence_ = 1;
  blank_.clear();
  for (std::size_t j = 0; j < G_.size(); ++j) {
    if (diagonal_[j] == 0) diagonal_[j] = 1, --rank_, blank_.push_back(j);
    value_[static_cast<std::size_t>(start_[j + 1]) - 1] = (1 + kShift) * diagonal_[j];
  }
  if (!factor_.factorize(columns(), 0)) return false;
  factor_.pivot_shares(diagonal_, share_);
  dependent_ = true;
  for (const double share : share_)
    if (share > kExplained) ++rank_, independence_ = std::min(independence_, share);
  for (auto* rows : {&residual_, &direction_, &image_, &answer_}) rows->resize(G_.size());
  return true;
}

template <class Space> void SparseSchurOf<Space>::solve(const double* f, const double* c, double* x, double* lambda) {
  x_ = inverse_mass_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(f, inverse_mass_.size()));
  std::copy_n(c, wanted_.size(), wanted_.begin());                                       // c may be lambda
  for (std::size_t i = 0; dependent_ && i < blank_.size(); ++i) wanted_[blank_[i]] = 0;  // they have no say
  std::fill_n(lambda, wanted_.size(), 0.0);
  if (!(dependent_ ? conjugate_residuals(lambda) : two_rounds(lambda))) {
    x_.setConstant(std::nan(""));
    std::fill_n(lambda, wanted_.size(), std::nan(""));
  }
  std::copy_n(x_.data(), x_.size(), x);
}

/// The second one takes out what rounding has left of c − G x, above all of long chains.
template <class Space> bool SparseSchurOf<Space>::two_rounds(double* lambda) {
  for (int round = 0; round < 2; ++round) {
    set_missing();
    if (!factor_.solve(missing_)) return false;
    for (std::size_t i = 0; i < G_.size(); ++i) {
      lambda[i] += missing_[i];
      apply_impulse(G_[i], missing_[i], inverse_mass_, x_);
    }
  }
  return true;
}

template <class Space> bool SparseSchurOf<Space>::conjugate_residuals(double* lambda) {
  set_missing();
  const auto largest_term = [&] {  // of c − G x, in the rows' own lengths
    double largest = 0;
    for (std::size_t i = 0; i < G_.size(); ++i) {
      double most = std::abs(wanted_[i]);
      each_entry(G_[i], [&](Eigen::Index place, double entry) { most = std::max(most, std::abs(entry * x_[place])); });
      largest = std::max(largest, most / std::sqrt(diagonal_[i]));
    }
    return largest;
  };
  double scale = largest_term();  // the largest so far
  const auto largest_missing = [&] {
    double most = 0;
    for (std::size_t i = 0; i < G_.size(); ++i) most = std::max(most, std::abs(missing_[i]) / std::sqrt(diagonal_[i]));
    return most;
  };
  const auto precondition = [&](const std::vector<double>& of, std::vector<double>& to) {
    std::copy(of.begin(), of.end(), to.begin());
    return factor_.solve(to);
  };
  if (!std::all_of(missing_.begin(), missing_.end(), [](double r) { return std::isfinite(r); })) return false;
  if (largest_missing() <= kRounding * scale) return true;
  if (!precondition(missing_, residual_)) return false;
  direction_ = residual_;
  set_force(residual_, residual_force_);
  direction_force_ = residual_force_;
  double length = square_of(residual_force_, inverse_mass_), least = length;
  const double root = std::sqrt(static_cast<double>(G_.size()));
  for (int round = 0, improved = 0; round < kRounds && round - improved < kPatience; ++round) {
    // What is left moves nothing: c contradicts itself by that.
    const double nothing = std::max(kNothing * weighted_length(residual_, diagonal_), kRounding * scale * root);
    if (length <= nothing * nothing) return forget_contradiction(lambda);
    velocity_ = inverse_mass_.cwiseProduct(direction_force_);
    for (std::size_t i = 0; i < G_.size(); ++i) image_[i] = apply(G_[i], velocity_.data());
    if (!precondition(image_, answer_)) return false;
    const double along = length / product(image_, answer_);
    for (std::size_t i = 0; i < G_.size(); ++i) lambda[i] += along * direction_[i];
    x_ += along * velocity_;
    set_missing();
    scale = std::max(scale, largest_term());
    if (largest_missing() <= kRounding * scale) return true;

    if (!precondition(missing_, residual_)) return false;
    set_force(residual_, residual_force_);
    const double next = square_of(residual_force_, inverse_mass_), back = next / length;
    length = next;
    if (!std::isfinite(length)) return false;
    if (length < 0.25 * least) least = length, improved = round;
    if (length > kDiverged * least) break;
    for (std::size_t i = 0; i < G_.size(); ++i) direction_[i] = residual_[i] + back * direction_[i];
    direction_force_ = residual_force_ + back * direction_force_;
  }
  return largest_missing() <= kGood * scale && forget_contradiction(lambda);
}

/// The contradiction of c has grown into λ, along what the shift alone leaves of the residual: that part moves nothing.
template <class Space> bool SparseSchurOf<Space>::forget_contradiction(double* lambda) {
  for (std::size_t i = 0; i < G_.size(); ++i) answer_[i] = kShift * diagonal_[i] * residual_[i];
  if (!factor_.solve(answer_)) return false;
  const double length = weighted_length(answer_, diagonal_);
  set_force(answer_, residual_force_);
  // Weak combinations move little, and bear a part of the load.
  if (!(length > 0.5 * weighted_length(residual_, diagonal_)) ||
      !(square_of(residual_force_, inverse_mass_) <= kNothing * kNothing * 1e4 * length * length))
    return true;
  double part = 0;
  for (std::size_t i = 0; i < G_.size(); ++i) part += diagonal_[i] * lambda[i] * (answer_[i] / length);
  for (std::size_t i = 0; i < G_.size(); ++i) lambda[i] -= part * (answer_[i] / length);
  return true;
}

/// c − G x.
template <class Space> void SparseSchurOf<Space>::set_missing() {
  for (std::size_t i = 0; i < G_.size(); ++i) missing_[i] = wanted_[i] - apply(G_[i], x_.data());
}

/// Gᵀ times `rows`.
template <class Space>
void SparseSchurOf<Space>::set_force(const std::vector<double>& rows, Eigen::VectorXd& force) const {
  force.setZero(x_.size());
  for (std::size_t i = 0; i < G_.size(); ++i) apply_transposed(G_[i], rows[i], force.data());
}

template class SparseSchurOf<Planar>;
template class SparseSchurOf<Spatial>;

}  // namespace orthant
