// integrators/event_driven/stage_quadrature.h — contact impulses and work of a Runge–Kutta step, as integrals over its
// stages, and their error.
//
//   ∫ f dt = s (f_1 + Σ b_i (f_i − f_1)),  f: the forces [N] and the power [W] at the stages of dormand_prince.h; error
//   by the embedded methods there.
//   The error of a step is not that of q and v alone: a body that sticks to a belt, or that a drive moves, goes on the
//   same way though a force on it jumps within the step (a spring passes through the length zero). Impulses and work
//   show it. They are held to a share of what the run has summed up so far, and of what f would sum up in that time,
//   and to no less than rounding of f.
#pragma once

#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

#include <algorithm>

namespace orthant {

class StageQuadrature {
 public:
  using Index = Eigen::Index;

  /// size: numbers in f; the last is the power.
  explicit StageQuadrature(Index size, std::size_t stages = dormand_prince::kStages)
      : d_(Eigen::MatrixXd::Zero(size, static_cast<Index>(stages))),
        first_(Eigen::VectorXd::Zero(size)),
        mean_(first_),
        fifth_(first_),
        third_(first_),
        noise_(first_) {}

  // --- A step --------------------------------------------------------------------------------------------------------

  void begin(const Eigen::VectorXd& first) { first_ = first; }  // f at the start of the step
  /// write(column): adds f at a stage, the first of which has the number 1, to zeros.
  template <class Write> void note(std::size_t stage, Write&& write) {
    auto column = d_.col(static_cast<Index>(stage));
    column.setZero();
    write(column);
    column -= first_;
  }
  /// All stages are noted.
  void end() {
    mean_ = first_;
    add(dormand_prince::kB, mean_);
  }
  void nothing() { mean_.setZero(); }                    // the step is none
  const Eigen::VectorXd& mean() const { return mean_; }  // of f in the step
  double at_stage(std::size_t stage, Index i) const { return first_[i] + d_(i, static_cast<Index>(stage)); }
  const Eigen::MatrixXd& differences() const { return d_; }  // f_i − f_1, a column each; the first is not used

  // --- Its error -----------------------------------------------------------------------------------------------------

  /// What a change of the coordinates by rounding makes of f at the start of the step: here it is `f`.
  void measure_noise(const Eigen::VectorXd& f) { noise_ = (f - first_).cwiseAbs(); }
  void forget_noise() { noise_.setZero(); }

  /// Of the step of s [s]: the largest error over what is allowed. share: of the sums of impulses and of work so far.
  double error(double s, double share) {
    fifth_.setZero(), third_.setZero();
    add(dormand_prince::kE, fifth_), add(dormand_prince::kE3, third_);
    const Index forces = d_.rows() - 1;
    const auto largest = [&](Index from, Index count) {
      if (count == 0) return 0.0;
      return std::max(first_.segment(from, count).cwiseAbs().maxCoeff(),
                      d_.block(from, 0, count, kStages).cwiseAbs().maxCoeff());
    };
    const double length = std::max(s, time_);
    const double impulses = impulse_ + length * largest(0, forces), work = work_ + length * largest(forces, 1);
    double most = 0;
    for (Index i = 0; i <= forces; ++i) {
      const double e = fifth_[i] * fifth_[i];
      if (e == 0) continue;
      const double allowed = share * (i < forces ? impulses : work) + s * kNoise * noise_[i];
      most = std::max(most, s * e / std::sqrt(e + 0.01 * third_[i] * third_[i]) / allowed);
    }
    return most;
  }

  /// The step of s [s] is taken.
  void take(double s) {
    const Index forces = mean_.size() - 1;
    time_ += s, impulse_ += s * mean_.head(forces).cwiseAbs().sum(), work_ += s * std::abs(mean_[forces]);
  }
  void restart() { time_ = impulse_ = work_ = 0, forget_noise(); }
  void remember(CheckpointData& memory) { memory(time_, impulse_, work_); }

 private:
  static constexpr double kNoise = 10;
  static constexpr Index kStages = dormand_prince::kStages;

  void add(const dormand_prince::Stages& weights, Eigen::VectorXd& sum) const {
    for (std::size_t i = 1; i < dormand_prince::kStages; ++i)
      if (weights[i] != 0) sum += weights[i] * d_.col(static_cast<Index>(i));
  }

  Eigen::MatrixXd d_;
  Eigen::VectorXd first_, mean_, fifth_, third_, noise_;
  double time_ = 0, impulse_ = 0, work_ = 0;  // [s, N s, J] summed up so far
};

}  // namespace orthant
