#include <orthant/core/support/options.h>
#include <orthant/integrators/step/turn_watch.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

/// ` of joint "name"`, of the one that leaves this angle free.
std::string joint_of(const spatial::Scene& scene, const spatial::Angle& angle) {
  for (const spatial::Joint& joint : scene.joints) {
    const std::string name = std::visit(
        [&](const auto& j) -> std::string {
          if constexpr (requires { j.angle(); })
            if (j.a == angle.a && j.b == angle.b && j.axis_a == angle.axis_a) return j.name;
          return {};
        },
        joint);
    if (!name.empty()) return " of joint \"" + name + "\"";
  }
  return {};
}

}  // namespace

TurnWatch::TurnWatch(const SystemOf<Spatial>& system, double most) : system_(system), most_(most) {
  for (const spatial::Spring& spring : system.scene().springs)
    if (const auto* one = std::get_if<spatial::JointSpring>(&spring); one != nullptr && one->stiffness > 0)
      add("spring \"" + one->name + "\"", one->of, one->rest);
  for (const spatial::Contact& contact : system.scene().contacts)
    if (const auto* one = std::get_if<spatial::Limit>(&contact))
      add("limit \"" + one->name + "\"", one->of, one->bound + one->beyond);
}

void TurnWatch::add(std::string name, const spatial::Coordinate& of, double middle) {
  const auto* angle = std::get_if<spatial::Angle>(&of.kind());
  if (angle == nullptr) return;
  turns_.push_back({"angle" + joint_of(system_.scene(), *angle) + ", which " + name + " reads,", *angle, middle});
}

bool TurnWatch::follow(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  if (empty()) return true;
  set_poses(system_, t, q, at_);
  const double h = any_ ? t - t_ : 0;
  why_.clear();
  for (Turn& turn : turns_) {
    const double wrapped = turn.angle.value(at_), rate = apply(turn.angle.row(at_), v.data());
    const double fastest = std::max(std::abs(turn.rate), std::abs(rate));
    const double expected = any_ ? turn.value + h * (turn.rate + rate) / 2 : wrapped;
    turn.value = expected + std::remainder(wrapped - expected, 2 * std::numbers::pi), turn.rate = rate;
    if (any_ && h * fastest > most_)
      why_ = "the " + turn.name + " turns by up to " + detail::text_of(h * fastest) +
             " rad in one step, to t = " + detail::text_of(t) +
             " s, so that its turns cannot be told: must be a smaller step";
    else if (!(std::abs(turn.value - turn.middle) < std::numbers::pi))
      why_ = "the " + turn.name + " has turned to " + detail::text_of(turn.value) +
             " rad at t = " + detail::text_of(t) + " s, half a turn or more from " + detail::text_of(turn.middle) +
             ": in space angles are known up to full turns, so that it cannot tell this from the other side";
    if (!why_.empty()) break;
  }
  any_ = true, t_ = t;
  return why_.empty();
}

}  // namespace orthant
