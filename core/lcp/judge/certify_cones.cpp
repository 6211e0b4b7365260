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

/// y ← A x, or |A| x for x ≥ 0 (of an operator |W| M⁻¹|W|ᵀ x, which is no less).
template <bool kAbsolute, class Number>
void cone_product(const Matrix& A, const std::vector<Number>& x, std::vector<Number>& y) {
  const auto of = [](double a) { return kAbsolute ? std::abs(a) : a; };
  y.assign(x.size(), 0);
  if (for_each_entry(A, [&](Index i, Index j, double a) { y[at(i)] += of(a) * x[at(j)]; })) return;
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  std::vector<Number> inner(at(W.cols), 0);
  const auto each = [&W = W](const auto& use) {
    for (Index i = 0; i < W.rows; ++i) W.for_each_in_row(i, [&](Index k, double w) { use(at(i), at(k), w); });
  };
  each([&](std::size_t i, std::size_t k, double w) { inner[k] += of(w) * x[i]; });
  for (std::size_t k = 0; k < inner.size(); ++k) inner[k] *= inverse_mass[static_cast<Index>(k)];
  each([&](std::size_t i, std::size_t k, double w) { y[i] += of(w) * inner[k]; });
  for (Index i = 0; i < regularization.size(); ++i) y[at(i)] += regularization[i] * x[at(i)];
}

/// Per block: the first of the blocks that A couples with it.
std::vector<int> coupled_blocks(const Matrix& A, const cones::Blocks& blocks) {
  std::vector<int> root(at(blocks.size())), of(at(order(A)));
  std::iota(root.begin(), root.end(), 0);
  for (int b = 0; b < blocks.size(); ++b)
    for (const int row : blocks.rows(blocks[b])) of[at(row)] = b;
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
  for (int b = 0; b < blocks.size(); ++b) root[at(b)] = find(b);
  return root;
}

double bound_near_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

double residual_ratio(double residual, double size) { return residual == 0 ? 0 : residual / size; }

/// Norm over the rows of a block of x_i times scale_i.
template <class Values> double block_norm(std::span<const int> rows, const Values& x, const Vector& scale) {
  double sum = 0;
  for (const int row : rows) {
    const double value = static_cast<double>(x[at(row)]) * scale[row];
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

bool ConeJudge::passes(const Lcp& problem, double tolerance, Solution& s) {
  const Index n = problem.size();
  blocks_.load(problem);
  blocks_.scale(problem.A, d_);
  blocks_.apply(d_);
  std::vector<ConeLong> x(at(n)), w;
  std::vector<double> size(at(n)), terms, data(at(n)), from_bounds, largest(at(n)), unknown;
  bool bounded = false;
  for (Index i = 0; i < n; ++i) {
    const double z = s.z[i], lo = problem.lo[i], hi = problem.hi[i];
    x[at(i)] = z, size[at(i)] = std::abs(z);
    data[at(i)] = std::abs(detail::on_bound(z, lo, hi) ? z : bound_near_zero(lo, hi));
    bounded = bounded || data[at(i)] > 0;
  }
  cone_product<false>(problem.A, x, w);
  cone_product<true>(problem.A, size, terms);
  if (bounded)
    cone_product<true>(problem.A, data, from_bounds);
  else
    from_bounds.assign(at(n), 0);
  double checksum = 0, size_of_w = 0;
  for (Index i = 0; i < n; ++i) {
    w[at(i)] += problem.b[i];
    s.w[i] = static_cast<double>(w[at(i)]);
    terms[at(i)] += std::abs(problem.b[i]), from_bounds[at(i)] += std::abs(problem.b[i]);
    checksum += 0.0 * s.w[i] + 0.0 * s.z[i] + 0.0 * terms[at(i)];
    size_of_w = std::max(size_of_w, terms[at(i)]);
  }
  s.residual = kInf, s.rounding = kEpsilon * size_of_w;
  unknown_ = !(checksum == 0.0), rounded_ = false;
  reached_ = kInf;
  if (unknown_) return false;

  const std::vector<int> part = coupled_blocks(problem.A, blocks_);
  std::vector<double> beta(at(blocks_.size()), 0), most(at(blocks_.size()), 0);
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    double& of_part = beta[at(part[at(c)])];
    of_part = std::max(of_part, block_norm(rows, from_bounds, d_));
    for (const int row : rows) most[at(part[at(c)])] = std::max(most[at(part[at(c)])], size[at(row)] / d_[row]);
  }
  for (int c = 0; c < blocks_.size(); ++c)
    for (const int row : blocks_.rows(blocks_[c])) largest[at(row)] = most[at(part[at(c)])] * d_[row];
  cone_product<true>(problem.A, largest, unknown);
  for (Index i = 0; i < n; ++i) unknown[at(i)] += std::abs(problem.b[i]);

  std::vector<double> block_z(at(blocks_.most_rows())), block_w(at(blocks_.most_rows()));
  s.residual = 0, reached_ = 0;
  bool passes = true;
  for (int c = 0; c < blocks_.size(); ++c) {
    const auto rows = blocks_.rows(blocks_[c]);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      block_z[r] = s.z[rows[r]] / d_[rows[r]];
      block_w[r] = static_cast<double>(w[at(rows[r])]) * d_[rows[r]];
    }
    const double e = blocks_.residual(blocks_[c], block_z.data(), block_w.data());
    double square = 0;
    for (const double each : std::span(block_z).first(rows.size())) square += each * each;
    const double lost = 4 * kEpsilon * std::sqrt(square);  // of e, by the subtraction in (1)
    s.residual = std::max(s.residual, e / d_[rows[0]]);
    const double scale = beta[at(part[at(c)])], own = std::min(scale, block_norm(rows, terms, d_));
    const double noise = kEpsilon * block_norm(rows, unknown, d_);
    unknown_ = unknown_ || !(noise <= kKnownRounding * scale);
    rounded_ = rounded_ || !(e + lost <= tolerance * own);
    if (!(e <= kRoundingsOfCone * noise)) {
      passes = passes && e <= tolerance * own;
      reached_ = std::max(reached_, own > 0 ? e / own : kInf);
    }
  }
  return passes && !unknown_;
}

}  // namespace orthant
