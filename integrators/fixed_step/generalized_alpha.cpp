#include <orthant/core/support/options.h>
#include <orthant/integrators/fixed_step/generalized_alpha.h>

#include <algorithm>

namespace orthant {

template <class Space> GeneralizedAlphaOf<Space>::GeneralizedAlphaOf(const System& system, const Options& options)
    : TwoLevelOf<Space>(system, kName, kCan),
      alpha_m_((2 * options.rho_inf - 1) / (options.rho_inf + 1)),
      alpha_f_(options.rho_inf / (options.rho_inf + 1)),
      gamma_(0.5 + alpha_f_ - alpha_m_),
      beta_((gamma_ + 0.5) * (gamma_ + 0.5) / 4) {
  for (Eigen::VectorXd* v : {&s_, &a_, &s_new_, &path_, &change_, &v_, &path_known_, &v_known_})
    v->setZero(system.dof());
}

template <class Space> StepReport GeneralizedAlphaOf<Space>::step(double h, Solver& solver, State& x) {
  StepReport report = StepReport::solved();
  begin();
  if (!start(x, report) || !flow(h, x, solver, report)) return report;
  hand_over(x);
  if (!strike(h, v_, solver, report)) return report;
  arrive(h, v_, x, report);
  if (report.status != Status::solved) return report;
  a_ = ((1 - alpha_f_) * s_new_ + alpha_f_ * s_ - alpha_m_ * a_) / (1 - alpha_m_);
  s_.swap(s_new_);
  q_last_ = x.q, v_last_ = x.v;
  return report;
}

template <class Space> bool GeneralizedAlphaOf<Space>::start(const State& x, StepReport& report) {
  if (q_last_.size() > 0 && x.q == q_last_ && x.v == v_last_) return true;
  set_poses(system_, x.t, x.q, start_.at);
  set_twists(system_, x.v, start_.at);
  evaluate_forces(system_, x.t, x.v, start_);
  add_gyroscopic(system_, x.v, start_.f);
  stiffened_ = false;
  if (!factorize(start_, 0, 0, report)) return false;
  start_.closed.clear();
  evaluate_biases(system_, start_);
  rate_ = -start_.joint_bias;
  basic_.solve(start_.f.data(), rate_.data(), s_.data(), lambda_.data());
  a_ = s_;
  q_last_.resize(0);  // until a step has come from here
  return true;
}

template <class Space>
bool GeneralizedAlphaOf<Space>::flow(double h, const State& x, Solver& solver, StepReport& report) {
  constexpr int kPasses = 100;
  constexpr double kEnough = 1e-13, kSlow = 0.25;
  constexpr double kNearly = 1e-10;  // rounding of the joints, where light bodies magnify it: no pass comes nearer
  // a⁺ = known + share s⁺
  const double share = (1 - alpha_f_) / (1 - alpha_m_), by_s = h * gamma_ * share, by_s2 = h * h * beta_ * share;
  const double keep_s = alpha_f_ / (1 - alpha_m_), keep_a = alpha_m_ / (1 - alpha_m_);
  v_known_ = x.v + h * (1 - gamma_) * a_ + h * gamma_ * (keep_s * s_ - keep_a * a_);
  path_known_ = h * x.v + h * h * (0.5 - beta_) * a_ + h * h * beta_ * (keep_s * s_ - keep_a * a_);
  s_new_ = s_;
  move<Space>(x.q, path_known_, q_end_), move<Space>(q_end_, by_s2 * s_new_);
  set_poses(system_, x.t + h, q_end_, start_.at);
  if (!system_.scene().springs.empty()) evaluate_forces(system_, x.t + h, x.v, start_);  // their rows, there
  if (!factorize(start_, by_s2, by_s, report)) return false;
  double before = kInf;
  bool swings = false;
  for (int pass = 0; pass < kPasses; ++pass) {
    path_ = path_known_ + by_s2 * s_new_;
    v_ = v_known_ + by_s * s_new_;
    if (!reach(h, x, path_, solver, report)) return false;
    evaluate_forces(system_, x.t + h, v_, end_);
    add_gyroscopic(system_, v_, end_.f);
    if (!factorize(end_, by_s2, by_s, report)) return false;
    force_ = end_.f - system_.mass().cwiseProduct(s_new_);
    for (Index i = 0; i < rate_.size(); ++i) rate_[i] = end_.missing_rate(i, v_) / by_s;
    basic_.solve(force_.data(), rate_.data(), change_.data(), lambda_.data());
    if constexpr (kPlanar<Space>)
      if (geometric_.possible()) {
        added_.setZero();
        stiffened_ = geometric_.raise(end_, lambda_.data(), 1, by_s2, kSlow, added_);
      }
    s_new_ += change_;
    v_ += by_s * change_;
    const double unit = system_.length_unit();
    far_.measure([&](Index i) {
      return largest_coordinate<Space>(x.q, i, unit) +
             by_s2 * (kPlanar<Space> ? largest_coordinate<Space>(s_new_, i, unit) : largest_entry<Space>(s_new_, i));
    });
    double moved = 0;  // over what is known of a coordinate
    for (Index i = 0; i < change_.size(); ++i)
      moved = std::max(moved, by_s2 * std::abs(change_[i]) / (is_rotation<Space>(i) ? 1 : unit) /
                                  (1 + far_.of(body_of_entry<Space>(i)) / unit));
    if (moved <= kEnough || (moved <= kNearly && moved >= before)) return true;
    std::swap(start_.at, end_.at);  // the next pass freezes its rows where basic_ is factorized
    swings = swings || moved > before / 2;
    freeze_poses(swings);
    before = moved;
  }
  const double turn = h * largest_rotation<Space>(v_);
  return fail(report, Status::numerical_error,
              "the smooth motion does not converge in " + std::to_string(kPasses) +
                  " passes: the last one moved q by " +
                  detail::text_of(by_s2 * change_.template lpNorm<Eigen::Infinity>()) +
                  " m or rad, in a step in which bodies turn by up to " + detail::text_of(turn) +
                  " rad: a shorter step converges faster");
}

template class GeneralizedAlphaOf<Planar>;
template class GeneralizedAlphaOf<Spatial>;

}  // namespace orthant
