#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace orthant {
namespace {

using ConeLong = long double;
using detail::kEpsilon;
constexpr double kRoundingsOfCone = 20;  // units in the last place that are noise
constexpr double kKnownRounding = 1e-6;  // ε t_c relative to β above which a w is unknown

/// y ← A x, or |A| x for x ≥ 0 (of an operator |W| M⁻¹|W|ᵀ x, which is no less; without R they may be the same vector).
template <bool kAbsolute, class Number>
void cone_product(const Matrix& A, const std::vector<Number>& x, std::vector<Number>& y) {
  const auto of = [](double a) { return kAbsolute ? std::abs(a) : a; };
  if (!std::holds_alternative<Delassus>(A)) {
    y.assign(x.size(), 0);
    for_each_entry(A, [&](Index i, Index j, double a) { y[at(i)] += of(a) * x[at(j)]; });
    return;
  }
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  std::vector<Number> inner(at(W.cols), 0);
  const auto each = [&W = W](const auto& use) {
    for (Index i = 0; i < W.rows; ++i) W.for_each_in_row(i, [&](Index k, double w) { use(at(i), at(k), w); });
  };
  each([&](std::size_t i, std::size_t k, double w) { inner[k] += of(w) * x[i]; });
  for (std::size_t k = 0; k < inner.size(); ++k) inner[k] *= inverse_mass[static_cast<Index>(k)];
  y.assign(x.size(), 0);
  each([&](std::size_t i, std::size_t k, double w) { y[i] += of(w) * inner[k]; });
  for (Index i = 0; i < regularization.size(); ++i) y[at(i)] += regularization[i] * x[at(i)];
}

/// A z, |A||z| and |A| d of an operator, in two passes over its entries: as cone_product() has them.
template <class Use> void operator_products(const Delassus& A, const double* z, const double* d, const Use& use) {
  const auto& [W, inverse_mass, regularization] = A;
  std::vector<ConeLong> inner(at(W.cols), 0);
  std::vector<double> size(at(W.cols), 0), scale(at(W.cols), 0);
  for (Index i = 0; i < W.rows; ++i)
    W.for_each_in_row(i, [&](Index k, double w) {
      inner[at(k)] += w * static_cast<ConeLong>(z[i]);
      size[at(k)] += std::abs(w) * std::abs(z[i]), scale[at(k)] += std::abs(w) * d[i];
    });
  for (Index k = 0; k < W.cols; ++k)
    inner[at(k)] *= inverse_mass[k], size[at(k)] *= inverse_mass[k], scale[at(k)] *= inverse_mass[k];
  for (Index i = 0; i < W.rows; ++i) {
    ConeLong w_i = 0;
    double terms = 0, unknown = 0;
    W.for_each_in_row(i, [&](Index k, double w) {
      w_i += w * inner[at(k)], terms += std::abs(w) * size[at(k)], unknown += std::abs(w) * scale[at(k)];
    });
    if (regularization.size() > 0) {
      w_i += regularization[i] * static_cast<ConeLong>(z[i]);
      terms += regularization[i] * std::abs(z[i]), unknown += regularization[i] * d[i];
    }
    use(i, w_i, terms, unknown);
  }
}

double bound_near_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

double residual_ratio(double residual, double size) { return residual == 0 ? 0 : residual / size; }

/// Norm over the rows of a block of x_i times scale_i.
double block_norm(std::span<const int> rows, const double* x, const Vector& scale) {
  double sum = 0;
  for (const int row : rows) {
    const double value = x[row] * scale[row];
    sum += value * value;
  }
  return std::sqrt(sum);
}

}  // namespace

ConeResiduals cone_residuals(const Lcp& problem, const Vector& z) {
  const Index n = problem.size();
  std::vector<ConeLong> x(at(n)), w;
  for (Index i = 0; i < n; ++i) x[at(i)] = z[i];
  cone_product<false>(problem.A, x, w);
  cones::Blocks blocks;
  Vector d;
  ConeResiduals result;
  blocks.load(problem);
  for (const bool scaled : {false, true}) {
    if (scaled)
      blocks.scale(problem.A, d), blocks.apply(d);
    else
      d = Eigen::VectorXd::Ones(n);
    std::vector<double> block_z(at(blocks.most_rows())), block_w(at(blocks.most_rows()));
    double sum = 0, data = 0;
    for (int c = 0; c < blocks.size(); ++c) {
      const auto rows = blocks.rows(blocks[c]);
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const Index i = rows[r];
        block_z[r] = z[i] / d[i];
        block_w[r] = static_cast<double>(w[at(i)] + problem.b[i]) * d[i];
        data += problem.b[i] * d[i] * (problem.b[i] * d[i]);
      }
      const double e = blocks.residual(blocks[c], block_z.data(), block_w.data());
      sum += e * e;
    }
    (scaled ? result.scale_free : result.natural) = residual_ratio(std::sqrt(sum), std::sqrt(data));
  }
  return result;
}

namespace {

/// Of the first row that is not finite, in z or else in w.
Miss not_finite(const Solution& s) {
  for (const Vector* x : {&s.z, &s.w})
    for (Index i = 0; i < x->size(); ++i)
      if (!std::isfinite((*x)[i])) return {i, Miss::Against::inside, kInf, 0, 0};
  return {};
}

/// Where a block's z is: of a contact with friction its cone.
Miss::Against place_of(const Lcp& problem, const Vector& z, std::span<const int> rows) {
  const int i = rows[0];
  if (rows.size() > 1) return Miss::Against::cone;
  return z[i] <= problem.lo[i]   ? Miss::Against::lower
         : z[i] >= problem.hi[i] ? Miss::Against::upper
                                 : Miss::Against::inside;
}

}  // namespace

bool ConeJudge::passes(const Lcp& problem, double tolerance, Solution& s) {
  blocks_.load(problem);
  blocks_.scale(problem.A, d_);
  blocks_.apply(d_);
  rounded_ = false;
  if (unknown_ = !sum(problem, s); unknown_) {
    s.miss = not_finite(s);
    return false;
  }
  find_residuals(s);
  return surely_solved(problem, tolerance) || weigh(problem, tolerance, s);
}

/// w, its terms, and their bound by the largest z'. False where they are not finite.
bool ConeJudge::sum(const Lcp& problem, Solution& s) {
  const Index n = problem.size();
  double largest = 0;
  for (Index i = 0; i < n; ++i) largest = std::max(largest, std::abs(s.z[i]) / d_[i]);
  terms_.resize(at(n)), unknown_terms_.resize(at(n));
  const double* const z = s.z.data();
  const double* const d = d_.data();
  double checksum = 0, size_of_w = 0;
  const auto take = [&](Index i, ConeLong w, double terms, double unknown) {
    const double b = std::abs(problem.b[i]);
    s.w[i] = static_cast<double>(w + problem.b[i]);
    terms_[at(i)] = terms + b, unknown_terms_[at(i)] = b + largest * unknown;
    checksum += 0.0 * s.w[i] + 0.0 * z[i] + 0.0 * terms_[at(i)];
    size_of_w = std::max(size_of_w, terms_[at(i)]);
  };
  if (const auto* delassus = std::get_if<Delassus>(&problem.A)) {
    operator_products(*delassus, z, d, take);
  } else {
    w_.resize(at(n));
    for (Index i = 0; i < n; ++i) w_[at(i)] = 0, terms_[at(i)] = unknown_terms_[at(i)] = 0;
    for_each_entry(problem.A, [&](Index i, Index j, double a) {
      w_[at(i)] += static_cast<ConeLong>(a) * z[j];
      terms_[at(i)] += std::abs(a) * std::abs(z[j]), unknown_terms_[at(i)] += std::abs(a) * d[j];
    });
    for (Index i = 0; i < n; ++i) take(i, w_[at(i)], terms_[at(i)], unknown_terms_[at(i)]);
  }
  s.residual = kInf, s.rounding = kEpsilon * size_of_w;
  return checksum == 0.0;
}

/// (1) and what its subtraction loses, per block.
void ConeJudge::find_residuals(Solution& s) {
  block_z_.resize(at(blocks_.most_rows())), block_w_.resize(at(blocks_.most_rows()));
  e_.resize(at(blocks_.size())), lost_.resize(at(blocks_.size()));
  s.residual = 0;
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    double square = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      block_z_[r] = s.z[rows[r]] / d_[rows[r]];
      block_w_[r] = s.w[rows[r]] * d_[rows[r]];
      square += block_z_[r] * block_z_[r];
    }
    e_[at(c)] = blocks_.residual(blocks_[c], block_z_.data(), block_w_.data());
    lost_[at(c)] = 4 * kEpsilon * std::sqrt(square);
    s.residual = std::max(s.residual, e_[at(c)] / d_[rows[0]]);
  }
}

/// Solved with ‖q'_c‖ in place of β and s_c, which are no less, and the largest z' of all blocks for that of the
/// coupled ones.
bool ConeJudge::surely_solved(const Lcp& problem, double tolerance) const {
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    const double own = block_norm(rows, problem.b.data(), d_);
    if (!(e_[at(c)] + lost_[at(c)] <= tolerance * own)) return false;
    if (!(kEpsilon * block_norm(rows, unknown_terms_.data(), d_) <= kKnownRounding * own)) return false;
  }
  return true;
}

/// (2) itself.
bool ConeJudge::weigh(const Lcp& problem, double tolerance, Solution& s) {
  const Index n = problem.size();
  std::vector<double> from_bounds;
  const auto datum = [&](Index i) {
    const double z = s.z[i], lo = problem.lo[i], hi = problem.hi[i];
    return std::abs(detail::on_bound(z, lo, hi) ? z : bound_near_zero(lo, hi));
  };
  bool bounded = false;
  for (Index i = 0; i < n && !bounded; ++i) bounded = datum(i) > 0;
  if (bounded) {
    std::vector<double> data(at(n));
    for (Index i = 0; i < n; ++i) data[at(i)] = datum(i);
    cone_product<true>(problem.A, data, from_bounds);
    for (Index i = 0; i < n; ++i) from_bounds[at(i)] += std::abs(problem.b[i]);
  }
  const double* const own_data = bounded ? from_bounds.data() : problem.b.data();
  couple(problem.A);
  std::vector<double> beta(at(blocks_.size()), 0), most(at(blocks_.size()), 0);
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    double& of_part = beta[at(part_[at(c)])];
    of_part = std::max(of_part, block_norm(rows, own_data, d_));
    for (const int row : rows) most[at(part_[at(c)])] = std::max(most[at(part_[at(c)])], std::abs(s.z[row]) / d_[row]);
  }
  // Of many rows one vector is enough: it is the argument and then the product.
  const auto* const delassus = std::get_if<Delassus>(&problem.A);
  std::vector<double> other;
  std::vector<double>& largest = delassus != nullptr && delassus->regularization.size() == 0 ? unknown_terms_ : other;
  largest.resize(at(n));
  for (int c = 0; c < blocks_.size(); ++c)
    for (const int row : blocks_.rows(blocks_[c])) largest[at(row)] = most[at(part_[at(c)])] * d_[row];
  cone_product<true>(problem.A, largest, unknown_terms_);
  for (Index i = 0; i < n; ++i) unknown_terms_[at(i)] += std::abs(problem.b[i]);
  bool passes = true;
  double worst = 0;
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    const double e = e_[at(c)], scale = beta[at(part_[at(c)])],
                 own = std::min(scale, block_norm(rows, terms_.data(), d_));
    const double noise = kEpsilon * block_norm(rows, unknown_terms_.data(), d_);
    unknown_ = unknown_ || !(noise <= kKnownRounding * scale);
    rounded_ = rounded_ || !(e + lost_[at(c)] <= tolerance * own);
    passes = passes && (e <= kRoundingsOfCone * noise || e <= tolerance * own);
    if (const double miss = e + lost_[at(c)], limit = tolerance * own; miss > limit && miss / limit >= worst) {
      worst = miss / limit;
      s.miss = {rows[0], place_of(problem, s.z, rows), miss / d_[rows[0]], limit / d_[rows[0]], tolerance};
    }
  }
  return passes && !unknown_;
}

/// part_: per block, the first of the blocks that A couples with it.
void ConeJudge::couple(const Matrix& A) {
  std::vector<int>& root = part_;
  std::vector<int> of(at(order(A)));
  root.resize(at(blocks_.size()));
  std::iota(root.begin(), root.end(), 0);
  for (int b = 0; b < blocks_.size(); ++b)
    for (const int row : blocks_.rows(blocks_[b])) of[at(row)] = b;
  const auto find = [&root](int b) {
    while (root[at(b)] != b) b = root[at(b)] = root[at(root[at(b)])];
    return b;
  };
  const auto join = [&](int b, int c) {
    b = find(b), c = find(c);
    root[at(std::max(b, c))] = std::min(b, c);
  };
  for_each_entry(A, [&](Index i, Index j, double a) {
    if (a != 0 && of[at(i)] != of[at(j)]) join(of[at(i)], of[at(j)]);
  });
  if (const auto* delassus = std::get_if<Delassus>(&A)) {
    const RowSparse& W = delassus->W;
    std::vector<int> first(at(W.cols), -1);
    for (Index i = 0; i < W.rows; ++i)
      for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
        int& met = first[at(W.column[k])];
        if (met < 0) met = of[at(i)];
        join(met, of[at(i)]);
      }
  }
  for (int b = 0; b < blocks_.size(); ++b) root[at(b)] = find(b);
}

}  // namespace orthant
