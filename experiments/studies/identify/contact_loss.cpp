#include "experiments/studies/identify/contact_loss.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/nearby_motion.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace orthant {

namespace {

constexpr std::array<int, 4> kPlaces{-2, -1, 1, 2};  // differences of fourth order
constexpr std::array<double, 4> kWeights{1. / 12, -8. / 12, 8. / 12, -1. / 12};

constexpr double kPrecision = 1e-13;  // of a root
constexpr int kMostPasses = 100;

struct Moment {
  double t = 0;
  Eigen::VectorXd q, v;
};

/// N of one set of modes: at a moment, and a while after it.
class NormalForce {
 public:
  NormalForce(const System& system, const std::vector<ContactMode>& modes) : motion_(system), near_(system) {
    motion_.modes = modes, motion_.modes_changed(), near_.set_modes(modes);
    a_.setZero(system.dof());
  }
  Moment after(const Moment& from, double length) {
    Moment x = from;
    if (length <= 0) return x;
    if (!near_.move(x.t, length, x.q, x.v)) throw std::runtime_error("the motion on the guide is not finite");
    x.t += length;
    return x;
  }
  double at(const Moment& x) {
    if (!motion_.accelerations(x.t, x.q, x.v, a_)) throw std::runtime_error("the forces of the guide are not finite");
    double sum = 0;
    for (std::size_t i = 0; i < motion_.lasting().size(); ++i) sum += motion_.normal_force(i);
    return sum;
  }
  /// Along the motion [N/s].
  double rate(const Moment& x) {
    at(x);
    const Eigen::VectorXd a = a_;
    const double s = 1e-4 / (1 + std::max(x.v.lpNorm<Eigen::Infinity>(), std::sqrt(a.lpNorm<Eigen::Infinity>())));
    double sum = 0;
    for (std::size_t k = 0; k < kPlaces.size(); ++k) {
      const double d = kPlaces[k] * s;
      sum += kWeights[k] * at({x.t + d, x.q + d * x.v + d * d / 2 * a, x.v + d * a});
    }
    return sum / s;
  }

 private:
  ContactMotion motion_;
  NearbyMotion near_;
  Eigen::VectorXd a_;
};

/// t* within [0, length] after a moment, where the rate changes its sign from − to +: two chords, then a bisection, to
/// 1e-9 of the length, since N changes by the square of the error.
double time_of_least(NormalForce& force, const Moment& from, double length) {
  double low = 0, high = length, at_low = force.rate(from), at_high = force.rate(force.after(from, length));
  for (int pass = 0; pass < 60 && high - low > 1e-9 * length; ++pass) {
    const double chord = low - at_low * (high - low) / (at_high - at_low), edge = 1e-3 * (high - low);
    const double s = pass % 3 == 2 ? (low + high) / 2 : std::clamp(chord, low + edge, high - edge);
    const double rate = force.rate(force.after(from, s));
    (rate < 0 ? low : high) = s, (rate < 0 ? at_low : at_high) = rate;
  }
  return std::abs(at_low) < std::abs(at_high) ? low : high;
}

[[noreturn]] void refuse(double low, double high) {
  throw std::invalid_argument("crank speeds " + std::to_string(low) + " and " + std::to_string(high) +
                              " rad/s: contact must be kept at the first and lost at the second");
}

struct Found {  // a minimum of N
  Moment from;
  double later = 0, force = kInf;  // [s] after it
  std::vector<ContactMode> modes;
  bool smooth = false;  // N is stationary there
};

/// open_end: the motion goes on as it does there, or a contact is released, behind which N goes on falling. Where the
/// arc is left it is one Runge–Kutta step: exact where F is near 0, since N is least soon after the release then.
void keep_least(const System& system, const Arc& arc, bool open_end, bool released, Found& least) {
  constexpr double kBehind = 1e-3, kFarther = 1.25, kFarthest = 1e3;  // times the arc's length
  constexpr double kSameForce = 1e-12;                                // [N] rounding
  NormalForce force(system, arc.modes);
  const Moment begin{arc.start, arc.q0, arc.v0};
  const auto keep = [&](double later, bool smooth) {  // of two at the same place, an end and a minimum, the latter
    const double value = force.at(force.after(begin, later));
    if (value < least.force + (smooth ? kSameForce : -kSameForce)) least = {begin, later, value, arc.modes, smooth};
  };
  keep(0, false), keep(arc.length, false);
  double end = open_end ? (1 + kBehind) * arc.length : arc.length;
  if (force.rate(begin) >= 0) return;
  for (; force.rate(force.after(begin, end)) <= 0; end *= kFarther) {
    if (!released) return;
    if (end > kFarthest * arc.length) throw std::runtime_error("the force of the guide has no least value");
  }
  keep(time_of_least(force, begin, end), true);
}

}  // namespace

Scene slider_on_guide(const GuidedSlider& p, double crank_speed) {
  const SliderCrank of{.mu = p.mu, .e = 0, .clearance = p.clearance};
  Scene s = slider_crank(of);
  const double tilt = -std::asin(p.clearance / of.l2), turn = -crank_speed * of.l1 / (of.l2 * std::cos(tilt));
  const Vector2d rod(of.l2 * std::cos(tilt), of.l2 * std::sin(tilt)), across(-rod.y(), rod.x()), tip(of.l1, 0);
  const Vector2d tip_rate(0, of.l1 * crank_speed);
  s.bodies[0].velocity = tip_rate / 2, s.bodies[0].omega = crank_speed;
  s.bodies[1].position = tip + rod / 2, s.bodies[1].angle = tilt;
  s.bodies[1].velocity = tip_rate + turn / 2 * across, s.bodies[1].omega = turn;
  s.bodies[2].position = {of.l1 + rod.x(), -p.clearance};
  s.bodies[2].velocity = {turn * across.x(), 0};
  return s;
}

double frictionless_contact_loss(double clearance) {
  const SliderCrank p;
  const double weight1 = (p.m1 / 2 + p.m2 + p.m3) * p.g * p.l1, weight2 = (p.m2 / 2 + p.m3) * p.g * p.l2;
  const double m11 = p.J1 + (p.m1 / 4 + p.m2 + p.m3) * p.l1 * p.l1, m22 = p.J2 + (p.m2 / 4 + p.m3) * p.l2 * p.l2;
  struct At {
    double inertia, height;          // [kg m²] of ω₁²/2, [J] of the weights
    double from_weight, from_speed;  // A [N], B [N s²]
  };
  const auto at = [&](double angle) {
    const double s1 = std::sin(angle), c1 = std::cos(angle), s2 = -(clearance + p.l1 * s1) / p.l2;
    const double c2 = std::sqrt(1 - s2 * s2), ratio = -p.l1 * c1 / (p.l2 * c2);  // ω₂ / ω₁
    const double k = (p.m2 / 2 + p.m3) * p.l1 * p.l2, cosine = c1 * c2 + s1 * s2, sine = s1 * c2 - c1 * s2;
    const double m12 = k * cosine;
    const Eigen::Matrix3d of{{m11, m12, -p.l1 * c1}, {m12, m22, -p.l2 * c2}, {p.l1 * c1, p.l2 * c2, 0}};
    const Eigen::Vector3d weight(-weight1 * c1, -weight2 * c2, 0),
        speed(-k * sine * ratio * ratio, k * sine, p.l1 * s1 + p.l2 * s2 * ratio * ratio);
    const auto lu = of.fullPivLu();
    return At{m11 + 2 * m12 * ratio + m22 * ratio * ratio, weight1 * s1 + weight2 * s2, lu.solve(weight)[2],
              lu.solve(speed)[2]};
  };
  const At start = at(0);
  const auto square = [&](double angle) {  // ω₀² at which N(angle) = 0
    const At x = at(angle);
    if (x.from_speed >= 0) return kInf;
    return (2 * (x.height - start.height) - x.inertia * x.from_weight / x.from_speed) / start.inertia;
  };
  constexpr int kGrid = 4000;
  double low = 0, high = 2 * std::numbers::pi, step = high / kGrid, best = 0;
  for (int i = 1; i < kGrid; ++i)
    if (square(i * step) < square(best)) best = i * step;
  low = std::max(best - step, 0.0), high = best + step;
  while (high - low > 1e-9) {
    const double third = (high - low) / 3;
    if (square(low + third) < square(high - third))
      high -= third;
    else
      low += third;
  }
  return std::sqrt(square((low + high) / 2));
}

ContactLoss::ContactLoss(const GuidedSlider& p) : p_(p), solver_(make_solver("auto")) {}

std::optional<double> ContactLoss::release(double crank_speed) {
  ++runs;
  const System system(slider_on_guide(p_, crank_speed));
  State x = system.initial_state();
  close_joints(system, x);
  EventDriven integrator(system);
  while (x.t < kLongest && x.q[2] < 2 * std::numbers::pi) {
    const StepReport report = integrator.stride(kLongest - x.t, *solver_, x);
    if (report.status != Status::solved) throw std::runtime_error("event-driven: " + integrator.why());
    for (const Event& event : integrator.events())
      if (event.kind == EventKind::release) return event.t;
  }
  return {};
}

LeastForce ContactLoss::least(double crank_speed, bool slope) {
  ++runs;
  const System system(slider_on_guide(p_, crank_speed));
  State x = system.initial_state();
  close_joints(system, x);
  EventDriven integrator(system);
  Found least;
  for (bool released = false; !released && x.t < kLongest && x.q[2] < 2 * std::numbers::pi;) {
    const StepReport report = integrator.stride(kLongest - x.t, *solver_, x);
    if (report.status != Status::solved) throw std::runtime_error("event-driven: " + integrator.why());
    for (const Event& event : integrator.events()) released = released || event.kind == EventKind::release;
    if (integrator.arc().length > 0)
      keep_least(system, integrator.arc(), released || integrator.events().empty(), released, least);
  }
  if (!least.smooth)
    throw std::runtime_error("crank speed " + std::to_string(crank_speed) +
                             " rad/s: the least force of the guide is that of an event or of an end of the motion");
  NormalForce force(system, least.modes);
  const Moment at = force.after(least.from, least.later);
  LeastForce found{at.t, at.q[2], least.force, 0};
  if (!slope) return found;
  ++tangents;
  const RunParameter speed{"crank_speed", crank_speed, [&](double value) { return slider_on_guide(p_, value); }, -1};
  const MotionTangent tangent = differentiate_motion(system, {speed}, {}, *solver_, least.from.t);
  if (tangent.status != Status::solved) throw std::runtime_error("event-driven: " + tangent.why);
  if (!tangent.none.empty()) throw std::runtime_error("no derivative: " + tangent.none);
  const double step = 1e-4 / (tangent.q.lpNorm<Eigen::Infinity>() + tangent.v.lpNorm<Eigen::Infinity>());
  for (std::size_t k = 0; k < kPlaces.size(); ++k) {
    const double d = kPlaces[k] * step;
    const Moment nearby{least.from.t, least.from.q + d * tangent.q.col(0), least.from.v + d * tangent.v.col(0)};
    found.slope += kWeights[k] * force.at(force.after(nearby, least.later)) / step;
  }
  return found;
}

double ContactLoss::by_newton(double low, double high) {
  constexpr double kNoForce = 1e-9;  // [N] else an end of the bracket has been reached
  const double first = low, last = high;
  double x = low;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const LeastForce F = least(x, true);
    (F.force > 0 ? low : high) = x;
    double next = x - F.force / F.slope;
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    const double moved = std::abs(next - x);
    x = next;
    if (moved > kPrecision * x) continue;
    if (std::abs(F.force) > kNoForce) refuse(first, last);
    return x;
  }
  throw std::runtime_error("Newton's method: no root of the least force is found");
}

double ContactLoss::by_chords(double low, double high) {
  double at_low = least(low, false).force, at_high = least(high, false).force, x = low;
  if (!(at_low > 0 && at_high < 0)) refuse(low, high);
  bool low_moved = false, high_moved = false;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    if (high - low <= kPrecision * high) return x;
    const double next = low - at_low * (high - low) / (at_high - at_low), moved = std::abs(next - x);
    x = next;
    if (moved <= kPrecision * x) return x;
    const double force = least(x, false).force;
    if (force > 0) {
      low = x, at_low = force;
      if (low_moved) at_high /= 2;
    } else {
      high = x, at_high = force;
      if (high_moved) at_low /= 2;
    }
    low_moved = force > 0, high_moved = force <= 0;
  }
  throw std::runtime_error("Illinois method: no root of the least force is found");
}

double ContactLoss::by_halving(double low, double high) {
  const double first = low, last = high;
  while (high - low > kPrecision * high) {
    const double x = (low + high) / 2;
    (release(x) ? high : low) = x;
  }
  if (low == first || high == last) refuse(first, last);  // all runs ended alike
  return (low + high) / 2;
}

}  // namespace orthant
