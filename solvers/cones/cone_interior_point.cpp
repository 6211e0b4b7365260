#include <orthant/solvers/cones/cone_interior_point.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

using ConeMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
using ConeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1>;

/// x0² − ‖x1‖², without cancellation.
double cone_determinant(const ConeVector& x) {
  const double length = x.tail(x.size() - 1).norm();
  return (x[0] - length) * (x[0] + length);
}
ConeVector jordan_product(const ConeVector& x, const ConeVector& y) {  // x∘y
  ConeVector out = x[0] * y + y[0] * x;
  out[0] = x.dot(y);
  return out;
}
ConeVector jordan_divide(const ConeVector& lambda, const ConeVector& rhs) {  // L_λ⁻¹ rhs
  const auto m = lambda.size() - 1;
  ConeVector out(lambda.size());
  out[0] = (lambda[0] * rhs[0] - lambda.tail(m).dot(rhs.tail(m))) / cone_determinant(lambda);
  out.tail(m) = (rhs.tail(m) - out[0] * lambda.tail(m)) / lambda[0];
  return out;
}
/// The largest α ≤ 1 with x + α dx in the cone.
double longest_step(const ConeVector& x, const ConeVector& dx) {
  double alpha = 1;
  if (dx[0] < 0) alpha = std::min(alpha, -x[0] / dx[0]);
  if (x.size() == 1) return alpha;
  const auto m = x.size() - 1;
  const double a = dx[0] * dx[0] - dx.tail(m).squaredNorm(), b = x[0] * dx[0] - x.tail(m).dot(dx.tail(m)),
               c = std::max(cone_determinant(x), 0.0), root = b * b - a * c;
  if (root < 0) return alpha;  // a > 0 and no zero
  const double t = -(b + std::copysign(std::sqrt(root), b));
  for (const double zero : {t / a, c / t})
    if (zero > 0) alpha = std::min(alpha, zero);
  return alpha;
}

struct InteriorCone {
  int start = 0, rows = 1;
  double mu = 1;
  ConeVector x, y, g, miss, dx, dy, lambda;
  ConeMatrix T, inverse_T;

  void scale() {
    const int m = rows;
    T.resize(m, m), inverse_T.resize(m, m);
    const double dx_ = cone_determinant(x), dy_ = cone_determinant(y), beta = std::pow(dy_ / dx_, 0.25);
    if (m == 1) {
      T(0, 0) = std::sqrt(y[0] / x[0]);
    } else {
      ConeVector xb = x / std::sqrt(dx_);
      const ConeVector yb = y / std::sqrt(dy_);
      const double gamma = std::sqrt((1 + xb.dot(yb)) / 2);
      xb.tail(m - 1) = -xb.tail(m - 1);
      const ConeVector w = (yb + xb) / (2 * gamma);
      T(0, 0) = w[0];
      T.block(0, 1, 1, m - 1) = w.tail(m - 1).transpose();
      T.block(1, 0, m - 1, 1) = w.tail(m - 1);
      T.block(1, 1, m - 1, m - 1) =
          ConeMatrix::Identity(m - 1, m - 1) + w.tail(m - 1) * w.tail(m - 1).transpose() / (1 + w[0]);
      T *= beta;
    }
    inverse_T = T.inverse();
    lambda = T * x;
  }
};

// Outer proximal steps of a try and of the last; Newton steps of one of them at which a try ends, or at most.
constexpr int kTryOuter = 6, kLastOuter = 40;
constexpr int kTrySteps = 4, kPatientSteps = 30;

}  // namespace

struct InteriorCones::Work {
  std::vector<InteriorCone> cones;
  std::vector<int> free, dead;  // rows: equations; without friction under μ = 0
  Vector w, trial;
};

InteriorCones::InteriorCones() : work_(std::make_unique<Work>()) {}
InteriorCones::~InteriorCones() = default;

bool InteriorCones::load(const ConeForm& form, const Budget* budget, ProximalPoint& point) {
  form_ = &form, budget_ = budget, point_ = &point;
  bool any = false;
  for (int c = 0; c < form.blocks(); ++c) {
    const cones::Block& b = form.block(c);
    if (b.parts > 1 || b.hi != kInf || (b.lo != 0 && b.lo != -kInf)) return false;
    any = any || b.lo == 0;
  }
  if (any) system_.load(form, budget);
  return any;
}

/// Proximal steps from z. True: finished.
bool InteriorCones::try_out(const Vector& z, int most, bool patient, const Watch& watch) {
  bool end = false;
  int last = 0;  // Newton steps of the last proximal one
  work_->trial = z;
  point_->restart();
  point_->iterate(
      work_->trial, most, [&](const Vector& x) { return (end = watch.finished(x)) || (!patient && last == kTrySteps); },
      [&](int made, double merit, double alpha, const char*) {
        watch.log(made, merit, alpha, "prox");
        last = made;
      },
      patient ? kPatientSteps : kTrySteps);
  return end;
}

/// One function: predictor and corrector share the factorization and all directions.
Claim InteriorCones::iterate(Vector& z, int most, bool insist, const Watch& watch) {
  const ConeForm& f = *form_;
  auto& [cones, free, dead, w, trial] = *work_;
  cones.clear(), free.clear(), dead.clear();
  const double size = f.norm_q > 0 ? f.norm_q / std::sqrt(static_cast<double>(f.blocks())) : 1;
  for (int c = 0; c < f.blocks(); ++c) {
    const cones::Block& b = f.block(c);
    if (b.lo == -kInf) {
      free.push_back(b.start);
      continue;
    }
    const double mu = b.parts > 0 ? f.all().parts(b)[0].mu : 1;
    cones.push_back({.start = b.start, .rows = mu > 0 ? b.rows : 1, .mu = mu > 0 ? mu : 1});
    if (!(mu > 0))
      for (int r = 1; r < b.rows; ++r) dead.push_back(b.start + r);
  }
  z.setZero();
  for (InteriorCone& k : cones) {
    k.x = ConeVector::Zero(k.rows), k.x[0] = size * k.mu;
    k.y = ConeVector::Zero(k.rows), k.y[0] = size / k.mu;
    z[k.start] = k.x[0] / k.mu;
  }
  double next_try = 1e-3;
  for (int iteration = 0; iteration < most && !budget_->exhausted(); ++iteration) {
    f.apply(z, w);
    double gap = 0;
    for (const InteriorCone& k : cones) gap += k.x.dot(k.y);
    const double tau = gap / static_cast<double>(cones.size());
    double affine = 0, sigma = 0;
    for (int c = 0; c < f.blocks(); ++c) {
      const int m = f.block(c).rows;
      std::fill_n(system_.E_of(c), m * m, 0.0), std::fill_n(system_.H_of(c), m * m, 0.0);
      if (f.block(c).lo == -kInf) system_.H_of(c)[0] = 1;
      for (int r = 1; r < m; ++r) system_.E_of(c)[r + m * r] = 1;
    }
    for (const int row : free) system_.F[row] = w[row];
    for (const int row : dead) system_.F[row] = z[row];
    for (InteriorCone& k : cones) {
      k.scale();
      const int c = f.block_of(k.start), m = k.rows, stride = f.block(c).rows;
      const ConeVector slip = w.segment(k.start, m);
      const double length = slip.tail(m - 1).norm();
      k.miss = slip, k.miss[0] = slip[0] / k.mu + length;
      k.miss -= k.y;
      const ConeMatrix theta = k.T * k.T;
      for (int col = 0; col < m; ++col)
        for (int row = 0; row < m; ++row) {
          system_.E_of(c)[row + stride * col] = theta(row, col) * (col == 0 ? k.mu : 1.0);
          const double direction = length > 0 && col > 0 ? slip[col] / length : 0;
          system_.H_of(c)[row + stride * col] = row == 0 ? (col == 0 ? 1 / k.mu : direction) : row == col ? 1.0 : 0.0;
        }
      k.dx = k.dy = ConeVector::Zero(m);
    }
    double step = 0;
    system_.keep_factors(false);
    for (const bool corrector : {false, true}) {
      for (InteriorCone& k : cones) {
        ConeVector rhs = -jordan_product(k.lambda, k.lambda);
        if (corrector) {
          rhs -= jordan_product(ConeVector(k.T * k.dx), ConeVector(k.inverse_T * k.dy));
          rhs[0] += sigma * tau;
        }
        k.g = k.T * jordan_divide(k.lambda, rhs);
        system_.F.segment(k.start, k.rows) = k.miss - k.g;
      }
      if (!system_.solve(0)) return Claim::numerical_error;
      system_.keep_factors(true);
      double alpha = 1;
      for (InteriorCone& k : cones) {
        k.dx = system_.dz.segment(k.start, k.rows);
        k.dx[0] *= k.mu;
        k.dy = k.g - k.T * (k.T * k.dx);
        alpha = std::min({alpha, longest_step(k.x, k.dx), longest_step(k.y, k.dy)});
      }
      if (!corrector) {
        affine = 0;
        for (const InteriorCone& k : cones) affine += (k.x + alpha * k.dx).dot(k.y + alpha * k.dy);
        sigma = std::clamp(std::pow(affine / gap, 3), 1e-8, 1.0);
      }
      step = alpha;
    }
    step *= step < 1 ? 0.9 + 0.09 * step : 0.99;
    z += step * system_.dz;
    for (InteriorCone& k : cones) k.x += step * k.dx, k.y += step * k.dy;
    if (!z.allFinite()) return Claim::numerical_error;
    const bool end = watch.finished(z);
    const double residual = watch.residual();
    watch.log(1, residual, step, "");
    if (end) return Claim::time_limit;
    if (step < 1e-4) return insist && try_out(z, kLastOuter, true, watch) ? Claim::time_limit : Claim::stalled;
    if (residual >= next_try) continue;
    next_try = residual / 30;
    if (try_out(z, kTryOuter, insist, watch)) return Claim::time_limit;
  }
  return Claim::iteration_limit;
}

std::string ConeInteriorPoint::why_not(const Lcp& p) const {
  std::vector<char> met(at(p.size()), 0);
  for (const Friction& f : p.friction)
    if (std::exchange(met[at(f.normal)], 1)) return "row " + std::to_string(f.normal) + " bears more than one friction";
  for (Index i = 0; i < p.size(); ++i)
    if (p.hi[i] != kInf || (p.lo[i] != 0 && p.lo[i] != -kInf))
      return "row " + std::to_string(i) + " is a box: must be [0, inf) or free";
  return ConeSolver::why_not(p);
}

Claim ConeInteriorPoint::iterate(Vector& z, int& iterations) {
  point_.load(form(), &budget());
  if (!interior_.load(form(), &budget(), point_)) return Claim::unsupported;
  const auto note = [&](int steps, double merit, double step, const char* event) {
    iterations += steps;
    log(iterations, merit, step, event);
  };
  return interior_.iterate(
      z, options_.max_iterations, true,
      {.finished = [&](const Vector& x) { return finished(x); }, .residual = [&] { return residual(); }, .log = note});
}

}  // namespace orthant
