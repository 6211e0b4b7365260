#include <orthant/solvers/cones/facets.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

const Lcp& FacetForm::linear(const Lcp& p, int sides, const std::vector<double>& angle, bool circumscribed) {
  if (sides < 3) throw std::invalid_argument("facets = " + std::to_string(sides) + ": must be at least 3");
  const Index n = p.size();
  sides_ = sides;
  const double strength = circumscribed ? 1 / std::cos(M_PI / sides) : 1;
  row_.assign(at(n), 0);
  discs_.clear();
  for (std::size_t k = 0; k < p.friction.size(); ++k) {
    const Friction& f = p.friction[k];
    if (f.rows == 1) continue;
    const double first = discs_.size() < angle.size() ? angle[discs_.size()] : 0.0;
    discs_.push_back({.friction = static_cast<Index>(k), .angle = first});
    for (Index r = f.first; r < f.first + f.rows; ++r) row_[at(r)] = -1;
  }
  Index kept = 0;
  for (Index& row : row_)
    if (row == 0) row = kept++;
  const Index size = kept + static_cast<Index>(discs_.size()) * (sides + 1);
  linear_.lo = Eigen::VectorXd::Zero(size), linear_.hi = Eigen::VectorXd::Constant(size, kInf);
  // z = B y: one entry a kept row, two a β.
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  std::vector<Eigen::Triplet<double>> B, own;
  for (Index i = 0; i < n; ++i)
    if (row_[at(i)] >= 0) {
      B.emplace_back(static_cast<int>(i), static_cast<int>(row_[at(i)]), 1.0);
      linear_.lo[row_[at(i)]] = p.lo[i], linear_.hi[row_[at(i)]] = p.hi[i];
    }
  Index next = kept;
  for (Disc& disc : discs_) {
    const Friction& f = p.friction[at(disc.friction)];
    disc.first = next;
    const auto lambda = static_cast<int>(next + sides);
    for (int k = 0; k < sides; ++k) {
      const double theta = disc.angle + 2 * M_PI * k / sides;
      const auto beta = static_cast<int>(next + k);
      B.emplace_back(static_cast<int>(f.first), beta, std::cos(theta));
      B.emplace_back(static_cast<int>(f.first) + 1, beta, std::sin(theta));
      own.emplace_back(beta, lambda, 1.0), own.emplace_back(lambda, beta, -1.0);
    }
    own.emplace_back(lambda, static_cast<int>(row_[at(f.normal)]), strength * f.mu);
    next += sides + 1;
  }
  linear_.friction.clear();
  for (const Friction& f : p.friction)
    if (f.rows == 1)
      linear_.friction.push_back({.normal = row_[at(f.normal)], .first = row_[at(f.first)], .rows = 1, .mu = f.mu});
  Sparse map(n, size), rest(size, size);
  map.setFromTriplets(B.begin(), B.end()), rest.setFromTriplets(own.begin(), own.end());
  RowSparse formed;
  const Sparse A = rows_of(p.A, formed)->view();
  const Sparse whole = Sparse(Sparse(map.transpose()) * Sparse(A * map)) + rest;
  if (std::holds_alternative<DenseMatrix>(p.A))
    linear_.A = DenseMatrix(Eigen::MatrixXd(whole));
  else
    linear_.A = RowSparse::from(whole);
  linear_.b = Eigen::VectorXd(map.transpose() * p.b);
  return linear_;
}

void FacetForm::restore(const Lcp& p, const Vector& y, Vector& z) const {
  z.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) z[i] = row_[at(i)] >= 0 ? y[row_[at(i)]] : 0;
  for (const Disc& disc : discs_) {
    const Friction& f = p.friction[at(disc.friction)];
    for (int k = 0; k < sides_; ++k) {
      const double theta = disc.angle + 2 * M_PI * k / sides_;
      z[f.first] += y[disc.first + k] * std::cos(theta), z[f.first + 1] += y[disc.first + k] * std::sin(theta);
    }
  }
}

Index FacetForm::row_of(const Lcp& p, Index linear_row) const {
  if (linear_row < 0) return -1;
  for (const Disc& disc : discs_)
    if (linear_row >= disc.first && linear_row <= disc.first + sides_) return p.friction[at(disc.friction)].first;
  return std::find(row_.begin(), row_.end(), linear_row) - row_.begin();
}

void FacetForm::restore_certificate(const Lcp& p, const Vector& linear_u, Vector& u) const {
  u.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) u[i] = row_[at(i)] >= 0 ? linear_u[row_[at(i)]] : 0;
}

namespace {

/// Entries of the pyramids' matrix: it cannot be interrupted while it is formed.
double entries(const Lcp& p, int sides) {
  Eigen::VectorXd width = Eigen::VectorXd::Ones(p.size());
  for (const Friction& f : p.friction)
    if (f.rows > 1) width.segment(f.first, f.rows).setConstant(sides);
  if (std::holds_alternative<DenseMatrix>(p.A)) return std::pow(width.sum(), 2);
  RowSparse formed;
  const auto A = rows_of(p.A, formed)->view();
  double sum = 0;
  for (Index i = 0; i < A.outerSize(); ++i)
    for (decltype(A)::InnerIterator it(A, i); it; ++it) sum += width[it.row()] * width[it.col()];
  return sum;
}

/// Root of the angle between a corner and its slip, as a function of the corner's, by regula falsi (Illinois).
class SlipAngle {
 public:
  explicit SlipAngle(int sides) : sides_(sides) {}
  /// [rad] The turn of a corner that stands at `at`, `off` behind its slip.
  double turn(double at, double off) {
    End& here = off > 0 ? below_ : above_;
    End& there = off > 0 ? above_ : below_;
    if (here.known && last_ == (off > 0)) there.off /= 2;
    last_ = off > 0;
    here = {at, off, true};
    // The other contacts turn, too, and a polygon is its own neighbour: not every bracket holds a root.
    const double width = above_.at - below_.at;
    there.known = there.known && width > kNarrow * std::abs(off) && width < 2 * M_PI / sides_;
    return there.known ? (there.at - at) * off / (off - there.off) : off;
  }

 private:
  struct End {
    double at = 0, off = 0;  // [rad]
    bool known = false;
  };
  static constexpr double kNarrow = 1e-3;
  int sides_;
  End below_, above_;
  bool last_ = false;
};

}  // namespace

std::string Facets::why_not(const Lcp& problem) const {
  constexpr double kLarge = 1e6;  // entries: from here on three sides stand for all; only limits of size differ
  FacetForm form;
  if (method_.why_not(form.linear(problem, entries(problem, sides_) > kLarge ? 3 : sides_)).empty()) return {};
  Lcp without = problem;
  std::erase_if(without.friction, [](const Friction& f) { return f.rows > 1; });
  if (std::string own = method_.why_not(without); !own.empty()) return own;
  for (const Friction& f : problem.friction)  // the pyramid's own rows have names that the caller does not know
    if (f.rows > 1)
      return "rows " + std::to_string(f.first) + " and " + std::to_string(f.first + 1) +
             " are a friction disc: must be friction intervals, since the method takes no pyramid in place of a disc";
  return {};
}

Claim Facets::run(const Lcp& problem, Solution& s, Start /*start*/) {
  constexpr double kSlides = 1e-10;   // relative to the largest w
  constexpr double kOnEdge = 1e-9;    // [rad] from a corner
  constexpr double kOperations = 50;  // of an entry of the pyramid's matrix: to form it, and to begin with it
  std::vector<double> angle;
  for (const Friction& f : problem.friction)
    if (f.rows > 1) angle.push_back(0);
  std::vector<SlipAngle> slips(angle.size(), SlipAngle(sides_));
  Claim claim = Claim::stalled;
  Vector best = s.z;
  double least = kInf;
  const double cost = budget().timed() ? kOperations * entries(problem, sides_) : 0;
  for (int turn = 0; turn <= turns_; ++turn) {
    if (!budget().affords(cost)) {
      if (turn == 0) claim = Claim::time_limit;
      break;
    }
    const Lcp& linear = form_.linear(problem, sides_, angle);
    method_.set_time_limit(budget().remaining());
    method_.solve(linear, linear_);
    claim = handed_on(linear_, s);
    s.ray.resize(0), s.certificate.resize(0), s.cells.clear();  // of the pyramid
    s.iterations += linear_.iterations;
    if (claim != Claim::candidate) break;
    form_.restore(problem, linear_.z, s.z);
    const bool accepted = passes(problem, s);
    log(turn, s.residual, 0, turn == 0 ? "pyramid" : "turned");
    if (s.residual < least) least = s.residual, best = s.z;
    if (accepted || budget().exhausted()) break;
    std::size_t k = 0;
    for (const Friction& f : problem.friction) {
      if (f.rows == 1) continue;
      // A contact that sticks now keeps its corner: turned back it might slide again.
      const double slip = std::hypot(s.w[f.first], s.w[f.first + 1]);
      if (slip > kSlides * s.w.lpNorm<Eigen::Infinity>()) {
        const auto from_corner = [&](double y, double x) {
          return std::remainder(std::atan2(y, x) - angle[k], 2 * M_PI / sides_);
        };
        // Where an edge carries the friction the slip is square to it, wherever the friction is on it.
        const double friction = from_corner(s.z[f.first + 1], s.z[f.first]);
        angle[k] += slips[k].turn(
            angle[k], std::abs(friction) > kOnEdge ? friction : from_corner(-s.w[f.first + 1], -s.w[f.first]));
      } else {
        slips[k] = SlipAngle(sides_);
      }
      ++k;
    }
  }
  if (least < kInf) s.z = best;
  return claim;
}

}  // namespace orthant
