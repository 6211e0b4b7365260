// integrators/event_driven/stage_quadrature.h — contact impulses and work of a Runge–Kutta step, as integrals over its
// stages, and their error.
//
//   ∫ f dt = s (f_1 + Σ b_i (f_i − f_1)),  f: the forces [N] and the power [W] at the stages of dormand_prince.h; error
//   by the embedded methods there.
//   The error of a step is not that of q and v alone: a body that sticks to a belt, or that a drive moves, goes on the
//   same way though a force on it jumps within the step (a spring passes through the length zero). The work shows it.
//   It is held to a share of what the run has summed up so far, and of what the power would sum up in that time, and to
//   no less than the effect of rounding and of the velocities' tolerance on the power. A drive without work has only
//   these.
#pragma once

#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/event_driven/dormand_prince.h>

#include <algorithm>

namespace orthant {

/// Part of what joints and contacts take out of a step that counts as its error: stages may miss a kink in them.
inline constexpr double kProjectedShare = 1e-3;

class StageQuadrature {
 public:
  using Index = Eigen::Index;

  /// size: numbers in f; the last is the power.
  explicit StageQuadrature(Index size, std::size_t stages = dormand_prince::kStages)
      : d_(Eigen::MatrixXd::Zero(size, static_cast<Index>(stages))),
        first_(Eigen::VectorXd::Zero(size)),
        mean_(first_) {}

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

  /// f: at the start of the step, the coordinates changed by rounding. tolerance: [W] change of the power by the
  /// tolerance of the velocities.
  void measure_noise(const Eigen::VectorXd& f, double tolerance) {
    noise_ = std::abs(f[f.size() - 1] - first_[f.size() - 1]) + tolerance;
  }
  void forget_noise() { noise_ = 0; }

  /// Of the work in the step of s [s], over what is allowed. share: of the work so far.
  double error(double s, double share) const {
    const Index power = d_.rows() - 1;
    const auto row = d_.row(power).head(kStages);
    double fifth = 0, third = 0;
    for (Index i = 1; i < kStages; ++i)
      fifth += dormand_prince::kE[static_cast<std::size_t>(i)] * row[i],
          third += dormand_prince::kE3[static_cast<std::size_t>(i)] * row[i];
    if (fifth == 0) return 0;
    const double largest = std::max(std::abs(first_[power]), row.cwiseAbs().maxCoeff());
    const double allowed = share * (work_ + std::max(s, time_) * largest) + s * kNoise * noise_;
    return s * fifth * fifth / std::hypot(fifth, 0.1 * third) / allowed;
  }

  /// The step of s [s] is taken.
  void take(double s) { time_ += s, work_ += s * std::abs(mean_[mean_.size() - 1]); }
  void restart() { time_ = work_ = 0, forget_noise(); }
  void remember(CheckpointData& memory) { memory(time_, work_); }

 private:
  static constexpr double kNoise = 10;
  static constexpr Index kStages = dormand_prince::kStages;

  void add(const dormand_prince::Stages& weights, Eigen::VectorXd& sum) const {
    for (std::size_t i = 1; i < dormand_prince::kStages; ++i)
      if (weights[i] != 0) sum += weights[i] * d_.col(static_cast<Index>(i));
  }

  Eigen::MatrixXd d_;
  Eigen::VectorXd first_, mean_;
  double noise_ = 0;            // [W]
  double time_ = 0, work_ = 0;  // [s, J] summed up so far
};

}  // namespace orthant
