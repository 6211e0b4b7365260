#include <orthant/core/support/options.h>
#include <orthant/integrators/fixed_step/two_level.h>
#include <orthant/integrators/step/projection.h>
#include <orthant/integrators/step/underflow.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kOfPlaces = 1e-14, kOfGaps = 10;  // roundings of places; of gaps, in those
constexpr double kSteady = 0.25;  // of an approach: what changes it by more in a step is not followed within it

}  // namespace

template <class Space>
TwoLevelOf<Space>::TwoLevelOf(const System& system, std::string_view name, const Capabilities& can)
    : IntegratorOf<Space>(system, name, can),
      start_(system),
      end_(system),
      q_end_(system.coordinates()),
      basic_(system),
      geometric_(system),
      far_(system.assembly()),
      path_(system.assembly()),
      force_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()),
      has_rows_(static_cast<std::size_t>(system.contacts())),
      broad_phase_(system),
      tunnelling_(system),
      positions_(system),
      velocities_(system),
      shown_(&velocities_),
      free_(system.dof()) {
  velocities_.let_friction_win();
  if (geometric_.possible()) added_.setZero(system.dof());
  targets_.reserve(has_rows_.size()), carrying_.reserve(has_rows_.size());
}

template <class Space> void TwoLevelOf<Space>::remember(CheckpointData& memory) {
  memory(positions_, velocities_, q_frozen_, off_before_, part_);
  basic_.forget();
}

template <class Space> void TwoLevelOf<Space>::begin() {
  velocities_.clear();
  shown_ = &velocities_;
  why_.clear();
}

template <class Space>
bool TwoLevelOf<Space>::factorize(Terms& terms, double stiffness_weight, double damping_weight, StepReport& report) {
  evaluate_joint_rows(system_, terms);
  stiffness_weight_ = stiffness_weight, damping_weight_ = damping_weight;
  return basic_.factorize(system_, terms, stiffness_weight, damping_weight, stiffened_ ? &added_ : nullptr) ||
         fail(report, Status::numerical_error, "the joints' matrix is not finite");
}

template <class Space>
bool TwoLevelOf<Space>::reach(double h, const State& x, Eigen::VectorXd& path, Solver& solver, StepReport& report) {
  constexpr int kIterations = 50;
  constexpr double kRounded = 1e3;  // of rounding: heavy bodies on light ones magnify it, no iterate comes nearer
  move<Space>(x.q, path, q_end_);
  const double unit = system_.length_unit();
  far_.measure([&](Index i) {
    return std::max(largest_coordinate<Space>(x.q, i, unit), largest_coordinate<Space>(q_end_, i, unit));
  });
  if (broad_phase_.any()) {  // contacts add to the path no more than the longest: bodies do not overlap deeper
    set_poses(system_, x.t + h, q_end_, end_.at);
    if (!path.allFinite()) return fail(report, Status::numerical_error, "the motion is not finite");
    if (!broad_phase_.find(2 * path, end_, BroadPhaseOf<Space>::Reach::farthest))
      return fail(report, Status::numerical_error, broad_phase_.why());
    start_.pairs = end_.pairs;
  }
  start_.closed.clear();
  std::fill(has_rows_.begin(), has_rows_.end(), false);
  std::fill(impulses_.begin(), impulses_.end(), Impulse{});
  const bool resists = !system_.scene().frictions.empty();
  bool joins = resists;  // its rows have to be built once
  bool solved = false;
  positions_.resist(h * h / 2), velocities_.resist(h);
  positions_.clear(), positions_.anchor(x.t, x.q);
  free_ = path;  // p without what the contacts add
  froze_again_ = false;
  int stalls = 0;
  double before = kInf, accuracy = 0;  // [m] of the problem solved last: gaps cannot be had better
  Mismatch left;
  for (int i = 0; i < kIterations;) {
    move<Space>(x.q, path, q_end_);
    set_poses(system_, x.t + h, q_end_, end_.at);
    evaluate_joint_residual(system_, end_);
    evaluate_gaps(system_, end_);
    const std::size_t known = start_.closed.size();
    bool more = close_gaps() || joins;
    joins = false;
    i += !more;  // rows that join are as many as the contacts at the most
    left = mismatch(accuracy, start_.closed.size());
    if (more ? solved && mismatch(accuracy, known).none && touch_only(known) : left.none) return true;
    if (!more && left.relative > before / 2) {
      if (++stalls > 2 && left.relative <= kRounded) return true;
      if (!freeze_here(stalls > 2, report)) return false;
      more = true;
    }
    before = left.relative;

    if (rate_.size() > 0) {
      rate_ = -end_.phi;
      basic_.add_rates(rate_.data(), free_.data());
    }
    const bool rows = resists || !start_.closed.empty();
    if (rows) {
      newtons_law(system_.laws(), start_, x.v, targets_);  // for the slip that chooses μ
      for (std::size_t k = 0; k < targets_.size(); ++k) {
        const ClosedContact& c = start_.closed[k];
        targets_[k].normal = apply(c.rows.normal, path.data()) - end_.gap[c.contact];  // g_N + W_N (p⁺ − p) ≥ 0
        targets_[k].tangent = h * belt_of(system_.law(c.contact), c.rows);
      }
      if (more)
        positions_.formulate(start_, basic_, targets_, free_, rate_);
      else
        positions_.retarget(targets_, free_, rate_);
      if (!solve(positions_, solver, report)) return false;
      solved = true;
      accuracy = positions_.solution().residual;
    }
    path = free_;
    if (rows) positions_.advance(path, impulses_);
  }
  return fail(report, Status::numerical_error,
              "the position stage does not converge: joints and gaps are left at " + detail::text_of(left.size) + " m");
}

template <class Space> void TwoLevelOf<Space>::freeze_poses(bool swings) {
  if (q_frozen_.size() == 0) {
    q_frozen_ = q_end_;
    off_before_ = q_end_.head(system_.dof());  // no part of it counts yet
  }
  off_ = between<Space>(q_frozen_, q_end_);
  off_before_ -= off_;
  const double moved = off_before_.squaredNorm();
  if (!swings || !(moved > 0))
    part_ = 1;
  else
    part_ = std::clamp(part_ * (off_before_ + off_).dot(off_before_) / moved, 1.0 / 64, 1.0);
  off_before_ = off_;
  move<Space>(q_frozen_, part_ * off_);
  if (part_ < 1) set_poses(system_, start_.at.t, q_frozen_, start_.at);
}

template <class Space> bool TwoLevelOf<Space>::freeze_here(bool swings, StepReport& report) {
  froze_again_ = true;
  start_.at.pose = end_.at.pose, start_.at.t = end_.at.t;
  freeze_poses(swings);
  start_.closed.swap(end_.closed);
  start_.closed.clear();
  for (const ClosedContact& c : end_.closed) add_closed_as(system_, c.contact, end_, start_);
  return factorize(start_, stiffness_weight_, damping_weight_, report);
}

template <class Space> bool TwoLevelOf<Space>::close_gaps() {
  const double unit = system_.length_unit(), zero = touching(far_.largest()) / unit;
  bool more = false;
  for (int i = 0; i < system_.contacts(); ++i) {
    if (!(end_.gap[i] <= zero) || has_rows_[static_cast<std::size_t>(i)]) continue;
    const auto [a, b] = bodies_of(system_, end_.pairs, i);
    if (end_.gap[i] > touching(far_.of(a, b)) * (system_.law(i).unit / unit)) continue;
    add_closed_as(system_, i, end_, start_);
    has_rows_[static_cast<std::size_t>(i)] = more = true;
  }
  return more;
}

template <class Space> double TwoLevelOf<Space>::rounding_of(const RowOf<Space>& row) const {
  const double unit = system_.length_unit();
  if (unit == 1) return kOfPlaces * (1 + far_.of(row));
  return kOfPlaces * unit_of(row, unit) * (1 + far_.of(row) / unit);
}

template <class Space>
typename TwoLevelOf<Space>::Mismatch TwoLevelOf<Space>::mismatch(double accuracy, std::size_t count) const {
  Mismatch m;
  const auto note = [&](double off, double rounding, double allowed) {
    m.size = std::max(m.size, off), m.relative = std::max(m.relative, off / rounding);
    if (!(off <= allowed)) m.none = false;  // NaN too
  };
  for (Index i = 0; i < end_.phi.size(); ++i) {
    const double rounding = rounding_of(start_.G[static_cast<std::size_t>(i)]);
    note(std::abs(end_.phi[i]), rounding, rounding);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (positions_.immobile(k)) continue;  // its gap is what the joints make it
    const ClosedContact& c = start_.closed[k];
    const double gap = end_.gap[c.contact], rounding = rounding_of(c.rows.normal);
    note(impulses_[static_cast<std::size_t>(c.contact)].normal > 0 ? std::abs(gap) : -gap, rounding,
         kOfGaps * rounding + 2 * accuracy);
  }
  return m;
}

template <class Space> bool TwoLevelOf<Space>::touch_only(std::size_t known) const {
  for (std::size_t k = known; k < start_.closed.size(); ++k) {
    const ClosedContact& c = start_.closed[k];
    if (end_.gap[c.contact] < -kOfGaps * rounding_of(c.rows.normal)) return false;
  }
  return true;
}

template <class Space> bool TwoLevelOf<Space>::solve(Formulation& formulation, Solver& solver, StepReport& report) {
  if (formulation.size() > 0) shown_ = &formulation;
  if (formulation.solve(solver, report, pool())) return true;
  why_ = formulation.contradiction();
  return false;
}

template <class Space> void TwoLevelOf<Space>::hand_over(const State& x) {
  constexpr double kOfPath = 1e-8;
  carrying_.clear();
  path_.measure([&](Index i) {
    if constexpr (kPlanar<Space>)
      return largest_translation(between(x.q, q_end_), i);
    else
      return (place_of<Space>(q_end_, i) - place_of<Space>(x.q, i)).cwiseAbs().maxCoeff();
  });
  for (int i = 0; i < system_.contacts(); ++i) {
    bool touches = impulses_[static_cast<std::size_t>(i)].normal > 0;
    if (!touches && end_.gap[i] < kInf) {  // rounding, of what was far out before, too, does not decide who strikes now
      const auto [a, b] = bodies_of(system_, end_.pairs, i);
      const double near = touching(far_.of(a, b)) + kOfPath * path_.of(a, b);
      touches = end_.gap[i] <= near * (system_.law(i).unit / system_.length_unit());
    }
    if (touches) carrying_.push_back(i);
  }
  start_.closed.clear(), end_.closed.clear();
  if (!carrying_.empty()) set_poses(system_, x.t, x.q, start_.at);
  for (const int contact : carrying_) add_closed_as(system_, contact, end_, start_), add_closed(system_, contact, end_);
  newtons_law(system_.laws(), start_, x.v, targets_);
  restrict_to_strikes(targets_);
  ways_.clear();
  if (!carrying_.empty()) change_ = between<Space>(x.q, q_end_);
  for (const ClosedContact& c : end_.closed) ways_.push_back(-apply(c.rows.normal, change_.data()));
  for (std::size_t k = 0; k < targets_.size(); ++k) {  // the work is that of the rows at the end
    const auto& rows = end_.closed[k].rows;
    targets_[k].approach = apply(rows.normal, x.v.data());
    targets_[k].slip_before = slip_rate(rows, x.v.data()) - belt_of(*targets_[k].law, rows);
    if constexpr (!kPlanar<Space>) {  // the surface's motion along the tangents that P acts along
      targets_[k].tangent = targets_[k].tangent - targets_[k].belt + rows.belt;
      targets_[k].belt = rows.belt;
    }
  }
}

template <class Space> void TwoLevelOf<Space>::strike_at_the_surface(double h) {
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    RateTargetOf<Space>& w = targets_[k];
    if (!(w.normal > 0) || !(w.law->e > 0)) continue;
    const double start = w.normal / w.law->e, before = -w.approach, change = w.free - w.approach;
    const auto steady = [&](double by) { return std::abs(by) <= kSteady * start; };
    if (!(start > kRestSpeed * w.law->unit) || !steady(before - start) || !steady(change) || !(ways_[k] > 0)) continue;
    w.normal = w.law->e * std::sqrt(std::max(0.0, before * before - 2 * change / h * ways_[k]));
  }
}

template <class Space>
bool TwoLevelOf<Space>::strike(double h, Eigen::VectorXd& v, Solver& solver, StepReport& report) {
  note_forces(end_, v, targets_);
  strike_at_the_surface(h);
  velocities_.anchor(end_.at.t, q_end_);
  velocities_.formulate(end_, basic_, targets_, v, rate_);
  if (!solve(velocities_, solver, report)) return false;
  velocities_.advance(v, impulses_);
  for (std::size_t i = 0; i < frictions_.size(); ++i) frictions_[i] = velocities_.joint_friction(i);
  report.note_rise(energy_rise(system_, end_, targets_, v, impulses_, kOtherRows), kInf);
  return true;
}

template <class Space> void TwoLevelOf<Space>::arrive(double h, Eigen::VectorXd& v, State& x, StepReport& report) {
  if (!q_end_.allFinite() || !v.allFinite()) {
    fail(report, Status::numerical_error, "the motion is not finite");
    return;
  }
  report.joint_residual = end_.phi.size() > 0 ? end_.phi.template lpNorm<Eigen::Infinity>() : 0;
  if (!(joints_off(end_, q_end_, far_) <= kJointsHold)) {  // a path as long as one may wish excuses no end of it
    fail(
        report, Status::numerical_error,
        "joints are left at " + detail::text_of(report.joint_residual) + " m or rad by a step of much too long a path");
    return;
  }
  for (Index i = 0; i < rate_.size(); ++i)
    report.joint_rate = std::max(report.joint_rate, std::abs(end_.missing_rate(i, v)));
  gaps_ = end_.gap;
  report.penetration = gaps_.size() > 0 ? std::max(0.0, -gaps_.minCoeff()) : 0.0;
  report.passage = tunnelling_.find(x.q, q_end_, end_);
  x.t += h;
  if constexpr (!kPlanar<Space>) drop_underflow(q_end_), drop_underflow(v);
  x.q.swap(q_end_);
  x.v.swap(v);
}

template class TwoLevelOf<Planar>;
template class TwoLevelOf<Spatial>;

}  // namespace orthant
