// solvers/cones/proximal.h — proximal point method on contacts with friction discs, semismooth Newton inside.
//
//   Outer iteration k: z_{k+1} solves the problem with A + α I and q − α z_k (cone_newton.h), to a tenth of the
//   residual: what α leaves is mostly more.
//   α from 0.1; a tenth after at most 10 Newton steps, a third after more, five times after a failure; every second
//   failure adds 50 block sweeps. The first z comes from block sweeps.
//   A slow outer step (residual above 0.3 of the last) is prolonged along itself, twice as far each time, while the
//   residual falls.
//   path = true: first Tikhonov's path, centre 0 and α = 1, ½, ¼, … each from the last: of all solutions of a redundant
//   problem it heads for a small one, where friction has room; Newton follows it in a few steps a time.
//   Why: with redundant contacts A is singular, Newton's matrix too; α I makes it regular, and unlike a fixed
//   regularization the outer iteration takes its error away. Coulomb's law is not monotone: no convergence proof.
//   Sources: Rockafellar, SIAM J. Control Optim. 14 (1976); Acary, Brémond & Huber (2018), ch. 9.
#pragma once

#include <orthant/solvers/cones/cone_newton.h>
#include <orthant/solvers/cones/cone_solver.h>
#include <orthant/solvers/cones/cone_sweeps.h>

namespace orthant {

struct ProximalOptions {
  double tolerance = 1e-10;  // accepted residual, as certify() measures it
  int max_outer = 500;       // outer iterations
  int sweeps = 100;          // of block Gauss-Seidel before them
  bool path = false;         // Tikhonov's path first
  template <class V> void visit(V&& v) {
    v("tolerance", tolerance, 0.0, 1.0), v("max_outer", max_outer, 1, 1000000), v("sweeps", sweeps, 0, 1000000);
    v("path", path);
  }
};

/// The iteration by itself, for solvers that put several together.
class ProximalPoint {
 public:
  void load(const ConeForm& form, const Budget* budget) {
    form_ = &form, newton_.load(form, budget), sweeps_.load(form);
  }
  /// Follows Tikhonov's path from z = 0, α ← ratio α, and leaves the best z, where it is better than the z given.
  /// `finished` is polled after each α; true ends the iteration.
  template <class Finished, class Log>
  void follow_path(Vector& z, double ratio, const Finished& finished, const Log& log);
  /// At most `most` outer iterations, each of at most `steps` Newton steps.
  template <class Finished, class Log>
  void iterate(Vector& z, int most, const Finished& finished, const Log& log, int steps = 30);
  ConeSweeps& sweeps() { return sweeps_; }
  ConeNewton& newton() { return newton_; }
  void restart() { alpha_ = 0.1; }

 private:
  double residual(const Vector& z) {
    form_->apply(z, w_);
    return form_->residual(z, w_);
  }
  const ConeForm* form_ = nullptr;
  ConeNewton newton_;
  ConeSweeps sweeps_;
  Vector w_, y_, trial_, best_;
  double alpha_ = 0.1;
};

class Proximal final : public ConeSolver {
 public:
  using Options = ProximalOptions;
  explicit Proximal(const Options& options) : options_(options) {}

 private:
  Claim iterate(Vector& z, int& iterations) override;
  double tolerance() const override { return options_.tolerance; }
  Options options_;
  ProximalPoint point_;
};

template <class Finished, class Log>
void ProximalPoint::follow_path(Vector& z, double ratio, const Finished& finished, const Log& log) {
  constexpr double kLeast = 1e-9;
  const Vector zero = Eigen::VectorXd::Zero(form_->size());
  double least = residual(z);
  y_ = zero;
  int failures = 0;
  for (double alpha = 1; alpha > kLeast && failures < 2; alpha *= ratio) {
    trial_ = y_;
    const auto out =
        newton_.solve({.alpha = alpha, .tolerance = 1e-6 * alpha * form_->norm_q, .max_steps = 40}, zero, trial_);
    const double e = residual(trial_);
    log(out.steps, e, alpha, out.converged ? "path" : "path, not reached");
    if (e < least) least = e, z = trial_, alpha_ = std::max(alpha / 10, 1e-9);
    failures = out.converged ? 0 : failures + 1;
    if (out.converged) y_ = trial_;
    if (finished(trial_)) return;
  }
}

template <class Finished, class Log>
void ProximalPoint::iterate(Vector& z, int most, const Finished& finished, const Log& log, int steps) {
  constexpr double kInner = 0.1;  // of the residual: what an outer step reaches
  double now = residual(z), alpha = alpha_;
  int failures = 0;
  for (int k = 0; k < most; ++k) {
    const double tolerance = std::max(1e-15, kInner * now) * form_->norm_q;
    y_ = z;
    const auto out = newton_.solve({.alpha = alpha, .tolerance = tolerance, .max_steps = steps}, z, y_);
    double next = residual(y_);
    if (out.converged || next < 0.5 * now) {
      if (next > 0.3 * now) {  // slow: the same way farther
        best_ = y_;
        double least = next;
        for (double far = 0.5; far < 1e6; far *= 2) {
          trial_ = y_ + far * (y_ - z);
          const double e = residual(trial_);
          if (e < least)
            least = e, best_ = trial_;
          else if (far >= 2)
            break;
        }
        y_ = best_, next = least;
      }
      z = y_, now = next;
      if (out.converged) alpha = std::max(alpha / (out.steps <= 10 ? 10 : 3), 1e-16);
      failures = 0;
    } else {
      alpha = std::min(5 * alpha, 10.0);
      if (next < now) z = y_, now = next;
      if (++failures % 2 == 0) {
        for (int sweep = 0; sweep < 50; ++sweep) sweeps_.sweep(z);
        now = residual(z);
      }
    }
    log(out.steps, now, alpha, out.converged ? "" : "not reached");
    if (finished(z)) return;
  }
}

}  // namespace orthant
