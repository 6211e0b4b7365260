#include <orthant/core/support/options.h>
#include <orthant/integrators/step/turn_watch.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace orthant {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi, kFar = std::numeric_limits<double>::infinity();

double value_of(const spatial::Angle& angle, const KinematicsOf<Spatial>& at) { return angle.value(at); }
double value_of(const spatial::Gear& gear, const KinematicsOf<Spatial>& at) {
  double off = 0;
  gear.residual(at, &off);
  return off;
}
RowOf<Spatial> row_of(const spatial::Angle& angle, const KinematicsOf<Spatial>& at) { return angle.row(at); }
RowOf<Spatial> row_of(const spatial::Gear& gear, const KinematicsOf<Spatial>& at) {
  RowOf<Spatial> row;
  gear.rows(at, &row);
  return row;
}

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
    else if (const auto* teeth = std::get_if<spatial::Backlash>(&contact);
             teeth != nullptr && teeth->flank == spatial::Limit::Side::lower && teeth->gear.period() < kFar)
      turns_.push_back({"play of contact \"" + teeth->name + "\"", teeth->gear, 0, teeth->gear.period()});
}

void TurnWatch::add(std::string name, const spatial::Coordinate& of, double middle) {
  const auto* angle = std::get_if<spatial::Angle>(&of.kind());
  if (angle == nullptr) return;
  turns_.push_back(
      {"angle" + joint_of(system_.scene(), *angle) + ", which " + name + " reads,", *angle, middle, kFullTurn});
}

bool TurnWatch::follow(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  if (empty()) return true;
  set_poses(system_, t, q, at_);
  const double h = any_ ? t - t_ : 0;
  why_.clear();
  for (Turn& turn : turns_) {
    const auto [wrapped, rate] = std::visit(
        [&](const auto& of) {
          return std::pair{value_of(of, at_), apply(row_of(of, at_), v.data())};
        },
        turn.of);
    const double fastest = std::max(std::abs(turn.rate), std::abs(rate));
    const double expected = any_ ? turn.value + h * (turn.rate + rate) / 2 : wrapped;
    turn.value = expected + std::remainder(wrapped - expected, turn.period), turn.rate = rate;
    const bool teeth = std::holds_alternative<spatial::Gear>(turn.of);
    const std::string when = " at t = " + detail::text_of(t) + " s", name = "the " + turn.name;
    if (any_ && h * fastest > most_ / kFullTurn * turn.period)
      why_ = name + (teeth ? " changes by up to " : " turns by up to ") + detail::text_of(h * fastest) +
             (teeth ? "" : " rad") + " in one step, to t = " + detail::text_of(t) + " s, so that its " +
             (teeth ? "teeth" : "turns") + " cannot be counted: must be a smaller step";
    else if (!(std::abs(turn.value - turn.middle) < turn.period / 2))
      why_ = teeth
                 ? name + " has changed by " + detail::text_of(turn.value) + when +
                       ", half the way to the next tooth or more: it cannot tell one tooth from the next"
                 : name + " has turned to " + detail::text_of(turn.value) + " rad" + when +
                       ", half a turn or more from " + detail::text_of(turn.middle) +
                       ": in space angles are known up to full turns, so that it cannot tell this from the other side";
    if (!why_.empty()) break;
  }
  any_ = true, t_ = t;
  return why_.empty();
}

}  // namespace orthant
