// Steps of an EventDriven integrator on trial: their error, singular poses, normals that jump, the landing on an event.
#include <orthant/integrators/event_driven/event_driven.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

constexpr double kSingular = 1e-2;  // independence of the joint rows below which a pose counts as next to singular
constexpr double kNearest = 1e-4;   // likewise: a state is better found from both sides
constexpr double kBlurred = 1e-6;   // likewise: but not from steps with a stage as near as this
constexpr double kTurned = 1e-7;    // of the speeds that make up a gap's rate: its normal has jumped
constexpr double kJump = 1e-4;      // of the largest normal force: more within the rounding of the time is a jump
constexpr double kFarBack = 1e5;    // instants before a jump from which a step may go across it: some 1e-10 of the time
constexpr double kShortest = 8;     // roundings of the time: no shorter step tells when
constexpr double kBehind = 1e4;     // roundings of a gap: how far behind the place where its normal jumps
constexpr double kSumsShare = 1e3;  // of rtol: error allowed to the work, of its sum
constexpr double kLeastSumsShare = 1e-9;  // likewise, at the least
constexpr double kMuch = 1e9;             // more of an error than any step is allowed
constexpr double kFewStages = 0.467;      // of a step: the widest interval without a stage of the method is around it
constexpr double kSmallTurn = 0.1;  // [rad] of a body in a step whose stages are near enough to project them there

}  // namespace

/// Of a step of s from now_, to trial_, over what is allowed. Next to a singular pose what stages are off the joints by
/// rounding shows in accelerations by 1/δ³: no reason to divide the step further, which would only look closer.
double EventDriven::error_of_step(double s) {
  if (!try_step(s)) return kInf;
  if (turns(s)) return kMuch;
  double error = rk_.error(s, scale_.q, scale_.v);
  if (joints_.least_independence >= kSingular || joints_.rank < system_.joint_rows()) {
    error = std::max(error, kProjectedShare * projected_);
    if (!(error <= 1) || !carries_) return error;
    return std::max(error, flow_.error(s, std::max(kLeastSumsShare, kSumsShare * options_.rtol)));
  }
  return error / std::max(1.0, 1e-16 * std::pow(joints_.least_independence, -1.5) / options_.rtol);
}

/// What rounding of the coordinates makes of the accelerations at now_: no step is held to less. Far from the origin
/// that is much where a contact's normal hangs on a small clearance.
void EventDriven::measure_noise() {
  if (now_.independence < kSingular) return;
  stage_.q = now_.q;
  for (Index i = 0; i < stage_.q.size(); ++i) stage_.q[i] *= 1 + (i % 2 == 0 ? 2 : -2) * kRounding;
  const double t = start_ + elapsed_;
  if (!motion_.accelerations(t, stage_.q, now_.v, scale_.noise)) return scale_.noise.setZero(), flow_.forget_noise();
  force_.setZero();
  add_flow(meter_ ? motion_.power(t, now_.v, scale_.noise) : 0, force_);
  flow_.measure_noise(force_, meter_ ? motion_.power_of(atol_, now_.a) : 0);
  scale_.noise = (scale_.noise - now_.a).cwiseAbs();
}

/// Forces of the last accelerations, and this power: adds them to zeros.
template <class To> void EventDriven::add_flow(double power, To& to) const {
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i) {
    const Index first = 2 * motion_.lasting()[i];
    to[first] = motion_.normal_force(i), to[first + 1] = motion_.tangent_force(i);
  }
  to[to.size() - 1] = power;
}

/// Likewise those at p: force_.
void EventDriven::flow_at(const Point& p) {
  force_.setZero();
  for (const int c : motion_.lasting()) force_[2 * c] = p.w.normal[c], force_[2 * c + 1] = p.w.tangent[c];
  force_[force_.size() - 1] = p.power;
}

/// When a singular pose is met, if it is in this step or soon after: δ, the root of the joint rows' independence, goes
/// linearly to zero there and up again.
std::optional<double> EventDriven::pose_in(double s) const {
  const double here = std::sqrt(now_.independence), there = std::sqrt(trial_.independence);
  const double least = std::sqrt(joints_.least_independence);
  if (joints_.least_independence >= kSingular || joints_.rank < system_.joint_rows()) return {};
  if (least < there && least < here / 2) return s * here / (here + there);
  if (there < here) return s * here / (here - there);
  return {};
}

/// No step that is gone on from begins or ends next to a singular pose: it ends before, or passes over it with the pose
/// where stages are few. True: the call ends too early for that.
bool EventDriven::pass_over(double& s, double rest) {
  const double first = s;
  std::optional<double> pose = pose_in(s);
  for (int i = 0; i < 8 && pose; ++i) {
    const double clear = 0.4 * h_, across = *pose / kFewStages;
    if (s <= *pose - clear || std::abs(s - across) <= 0.06 * across) return false;
    const double wish = std::min(rest, across <= 1.1 * h_ ? across : *pose - clear);
    if (wish == rest && s == rest) return true;
    s = wish;
    if (error_of_step(s) > 1)
      h_ *= 0.7;
    else
      pose = pose_in(s);
  }
  if (pose) error_of_step(s = first);
  return false;
}

/// Hands out the state at the call's end, next to a singular pose, without going on from it: it is known to ε/δ² only.
/// Very near, it is better known from both sides.
bool EventDriven::hand_out(double s) {
  lead_.time = s;
  for (const double part : {8, 7, 9}) {
    if (joints_.least_independence >= kNearest) return true;
    const double aside = s / part;
    if (!try_step(s - aside) || joints_.least_independence < kBlurred) continue;
    std::swap(earlier_, trial_);
    if (!try_step(s + aside) || joints_.least_independence < kBlurred) continue;
    interpolate(earlier_, trial_, 2 * aside, 0.5, middle_);
    middle_.v = 15 / (16 * aside) * between(earlier_.q, trial_.q) - 7.0 / 16 * (earlier_.v + trial_.v) +
                aside / 16 * (trial_.a - earlier_.a);  // of the same polynomial as q: near singular poses it is better
    trial_.q = middle_.q, trial_.v = middle_.v;
    trial_residual_ = motion_.residual(start_ + elapsed_ + s, trial_.q, trial_.v);
    return observe(trial_, start_ + elapsed_ + s);
  }
  return try_step(s);
}

double EventDriven::first_guess(double rest) const {
  const double fast = now_.v.norm() > 0 ? now_.q.norm() / now_.v.norm() : kInf;
  const double turn = now_.a.norm() > 0 ? now_.v.norm() / now_.a.norm() : kInf;
  const double guess = 0.05 * std::min(fast, turn);
  return guess > 0 ? std::min(guess, rest) : rest;
}

/// Of the joint rows, where the accelerations were evaluated last. Rows that are redundant everywhere make no singular
/// pose.
double EventDriven::independence() const {
  return motion_.basic().rank() < joints_.rank ? 0 : motion_.basic().independence();
}

bool EventDriven::observe(Point& p, double t) {
  if (!orthant::observe(motion_, t, p)) return false;
  // Next to a singular pose rows that are redundant everywhere look independent, as far as rounding goes.
  const int rank = motion_.basic().rank();
  if (joints_.rank == 0 || (rank > joints_.rank && motion_.basic().independence() >= kSingular)) joints_.rank = rank;
  p.independence = independence();
  if (meter_) p.power = motion_.power(t, p.v, p.a);
  return true;
}

/// trial_, and flow_: the lasting forces' impulses and the work.
bool EventDriven::try_step(double s) {
  flow_at(now_), flow_.begin(force_);
  const double t = start_ + elapsed_;
  const bool close = s * largest_rotation(now_.v) < kSmallTurn;
  double power = 0;
  const auto acceleration = [&](double time, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
    time = std::min(time, stop_);
    bool possible = motion_.accelerations(time, q, v, a);
    if (close && independence() < kSingular) {
      stage_.q = q, stage_.v = v;
      motion_.project(time, stage_.q, stage_.v);
      possible = motion_.accelerations(time, stage_.q, stage_.v, a);
    }
    if (const double here = independence(); here < joints_.least_independence) {
      joints_.least_independence = here;
      if (joints_.rank < system_.joint_rows()) least_q_ = q;
    }
    if (meter_ && possible) power = motion_.power(time, v, a);
    return possible;
  };
  joints_.least_independence = 1;
  const auto note = [&](std::size_t stage) { flow_.note(stage, [&](auto& column) { add_flow(power, column); }); };
  if (!rk_.step(acceleration, t, now_.q, now_.v, now_.a, s, trial_.q, trial_.v, note)) return false;
  flow_.end();
  scale_.q = atol_.array() + options_.rtol * now_.q.array().abs().max(trial_.q.array().abs());
  scale_.v =
      atol_.array() + s * scale_.noise.array() + options_.rtol * now_.v.array().abs().max(trial_.v.array().abs());
  const double end = std::min(t + s, stop_);
  stage_.q = trial_.q, stage_.v = trial_.v;
  trial_residual_ = motion_.project(end, trial_.q, trial_.v);
  projected_ = std::max(((stage_.q - trial_.q).array() / scale_.q.array()).abs().maxCoeff(),
                        ((stage_.v - trial_.v).array() / scale_.v.array()).abs().maxCoeff());
  if (trial_residual_.changed && joints_.least_independence < kSingular) return false;
  return trial_residual_.joint < kInf && observe(trial_, end);
}

/// Lasting contact i stands for another normal at the end of the trial step than at its start.
bool EventDriven::turned(std::size_t i, double s) const {
  const double scale =
      now_.w.gap_rate_scale[motion_.lasting()[i]] + s * largest_of_all(motion_.free(), system_.length_unit());
  return std::abs(motion_.rate_taken(i)) > options_.atol + std::max(kTurned, 1e3 * options_.rtol) * scale;
}

bool EventDriven::turns(double s) const {
  if (joints_.least_independence < kSingular) return false;  // velocities are not known well enough to tell
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i)
    if (turned(i, s)) return true;
  return false;
}

/// Shortens the step to where contacts turn: freed_.released. The last stages of a step across that place see the other
/// normal, so its velocity and forces are those of the longest step that ends before it. It goes on from somewhat
/// behind the place, where rounding does not choose the normal. False: an earlier event has to be looked at first.
bool EventDriven::find_turn(double& s) {
  double low = 0, high = s;
  const auto instant = [&] { return kShortest * kRounding * (std::abs(start_) + elapsed_ + high); };
  while (high - low > instant()) {
    s = (low + high) / 2;
    if (!try_step(s)) return false;
    (turns(s) ? high : low) = s;
  }
  if (!try_step(s = high) || !turns(s)) return false;
  for (std::size_t i = 0; i < motion_.lasting().size(); ++i) freed_.turned[at(motion_.lasting()[i])] = turned(i, s);
  return end_behind(low, high, s);
}

/// Whether the lasting force of an event jumps across its zero at the end of the step, at s: where a disc rolls off a
/// flat face onto the corner, say, the curvature that the force depends on does. No step lands on such a zero. True:
/// the contact is marked as turned, and the step shortened to end there.
bool EventDriven::find_jump(const Sign& sign, double& s) {
  const bool force = sign.watch == Watch::force || sign.watch == Watch::cone_up || sign.watch == Watch::cone_down;
  const double jump = jump_of_force();
  if (!force || std::abs(value(sign, trial_.w)) <= jump || joints_.least_independence < kSingular) return false;
  const double first = s, instant = kShortest * kRounding * (std::abs(start_) + elapsed_ + s);
  const double low = std::max(0.0, s - instant), high = s + instant;
  const bool before = low > 0 ? try_step(low) && value(sign, trial_.w) > jump : value(sign, now_.w) > jump;
  if (before && try_step(high) && value(sign, trial_.w) < -jump) {
    std::fill(freed_.turned.begin(), freed_.turned.end(), false);
    freed_.turned[at(sign.contact)] = true;
    if (end_behind(low, high, s)) return true;
  }
  try_step(s = first);
  return false;
}

/// [N] A force that differs by more on the two sides of an instant jumps there.
double EventDriven::jump_of_force() const {
  return kJump * std::max(load_, now_.w.normal.size() > 0 ? now_.w.normal.maxCoeff() : 0);
}

/// Whether the last stage of the trial step, whose place is known to the method's error only, sees other forces than
/// the step's end.
bool EventDriven::last_stage_behind() const {
  const double jump = jump_of_force();
  constexpr std::size_t kLast = dormand_prince::kStages - 1;
  return std::ranges::any_of(motion_.lasting(), [&](int c) {
    return std::abs(flow_.at_stage(kLast, 2 * c) - trial_.w.normal[c]) > jump ||
           std::abs(flow_.at_stage(kLast, 2 * c + 1) - trial_.w.tangent[c]) > jump;
  });
}

/// Ends the trial step behind [low, high], within which the contacts of freed_.turned turn, from the state at `low`, or
/// from a little before it where the step's last stage stands behind the jump already.
bool EventDriven::end_behind(double low, double high, double& s) {
  if (low > 0) {
    if (!(error_of_step(low) <= 1) || first_sign(low)) return false;
    const double first = low, instant = high - low;
    for (double back = instant; last_stage_behind() && back <= kFarBack * instant && back < first; back *= 8)
      if (!(error_of_step(low = first - back) <= 1)) return false;
  } else {
    trial_ = now_, trial_residual_ = residual_;
    flow_.nothing();
  }
  double behind = high - low;
  for (const int c : motion_.lasting()) {
    if (!freed_.turned[at(c)]) continue;
    const double speed = std::abs(trial_.w.slip[c] + system_.law(c).belt);
    behind = std::max(behind, std::min(kBehind * gap_zero(c) / speed, kCrowded * options_.crossing));
  }
  move(trial_.q, behind * trial_.v);
  s = low + behind, behind_ = behind;
  return true;
}

double EventDriven::slack(const Sign& sign) const {
  if (sign.watch == Watch::approach) return 2 * speed_zero(now_.w.gap_rate_scale[sign.contact]);
  return sign.watch == Watch::gap ? 2 * gap_zero(sign.contact) : watch_.slack(sign);
}

/// The event function; ≥ 0 before the event.
double EventDriven::value(const Sign& sign, const Watched& w) const {
  if (sign.watch != Watch::gap) return watch_.value(sign, w);
  if (overlaps(sign.contact)) return -w.gap[sign.contact];
  return w.gap[sign.contact] - std::min(0.0, now_.w.gap[sign.contact]);
}

/// Whether no force at now_ moves the contact, and the joints' drives do not press it shut.
bool EventDriven::immobile(int contact) {
  if (system_.joint_rows() == 0 || !immobility_.stand(start_ + elapsed_, now_.q)) return false;
  const Immobility::Verdict verdict = immobility_.look(immobility_.rows(contact).normal);
  return verdict.immobile && (verdict.rate >= 0 || turns_back(contact));
}

/// Whether the joints' drives, which alone move the contact, turn from shut to open before the gap has changed by more
/// than rounding.
bool EventDriven::turns_back(int contact) {
  const double now = start_ + elapsed_;
  if (system_.joint_rows() == 0 || !immobility_.stand(now, now_.q)) return false;
  const Immobility::Verdict verdict = immobility_.look(immobility_.rows(contact).normal);
  if (!verdict.immobile || verdict.rate >= 0) return false;
  const double soon = (kStays * gap_zero(contact) + options_.touching) / -verdict.rate;
  return immobility_.stand(now + soon, now_.q) && immobility_.look(immobility_.rows(contact).normal).rate >= 0;
}

/// Whether the contact is closed, to rounding, and does not move in the trial step.
bool EventDriven::stands(int c, double s) const {
  const auto closed = [&](const Point& p) {
    return stays(p.w.gap[c], c) && s * std::abs(p.w.gap_rate[c]) <= kStays * gap_zero(c) + options_.touching;
  };
  return closed(now_) && closed(trial_);
}

std::optional<Sign> EventDriven::first_sign(double s) {
  std::optional<Sign> first;
  if (s <= shortest_step()) return first;
  if (!motion_.lasting().empty() && watch_.look(start_ + elapsed_, s, now_, trial_, stop_)) first = watch_.first();
  sweep_.begin(start_ + elapsed_, s, now_, trial_);
  const auto sample = [](const Watched& w, int c) -> ContinuousCollision::Sample {
    return {w.gap[c], w.gap_rate[c], w.gap_acceleration[c]};
  };
  for (int c = 0; c < system_.contacts(); ++c) {
    if (motion_.modes[at(c)].lasting) continue;
    if (stands(c, s)) continue;
    const auto found =
        overlaps(c) ? end_of_overlap(c, s) : sweep_.first(c, sample(now_.w, c), sample(trial_.w, c), 2 * gap_zero(c));
    if (!found || (first && first->crossing.x <= found->crossing.x)) continue;
    if (stays(now_.w.gap[c], c) && stays(trial_.w.gap[c], c) && immobile(c))
      continue;  // rounding of what the joints hold
    first = found;
  }
  return first;
}

/// Shortens the step to where the function is zero. False: it is not there, it only came near; s is shortened all the
/// same.
bool EventDriven::land(const Sign& sign, double& s) {
  const double tiny = slack(sign) / 2;
  double low = sign.low * s, high = sign.high * s, last_x = 0, last = 0;
  double x = sign.crossing.x * s, slope = sign.crossing.slope / s;
  bool bracketed = sign.high == 1 && value(sign, trial_.w) < 0;
  for (int i = 0; i < 80; ++i) {
    if (!try_step(x)) break;
    s = x;
    const double f = value(sign, trial_.w);
    if (sign.watch == Watch::gap)
      slope = overlaps(sign.contact) ? -trial_.w.gap_rate[sign.contact] : trial_.w.gap_rate[sign.contact];
    else if (sign.watch == Watch::approach)
      slope = trial_.w.gap_acceleration[sign.contact];
    else if (sign.watch == Watch::slip)
      slope = motion_.modes[at(sign.contact)].slip * trial_.w.slip_acceleration[sign.contact];
    else if (i > 0 && x != last_x)
      slope = (f - last) / (x - last_x);
    if (std::abs(f) <= tiny) return true;
    (f > 0 ? low : high) = x;
    bracketed = bracketed || f < 0;
    if (f > 0 && !(slope < 0) && !bracketed) return false;
    last_x = x, last = f;
    double next = x - f / slope;
    if (!(slope < 0) || !(next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - x) <= kRounding * x) break;
    x = next;
  }
  // A gap that jumps: it is closed behind the jump.
  const bool narrow = high - s <= kInstant * kRounding * (std::abs(start_) + elapsed_ + s);
  if (sign.watch == Watch::gap && bracketed && narrow && value(sign, trial_.w) > slack(sign) && try_step(high))
    s = high;
  return true;
}

}  // namespace orthant
