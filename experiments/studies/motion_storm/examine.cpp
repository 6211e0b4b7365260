#include "experiments/studies/motion_storm/examine.h"

#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>

namespace orthant::motion_storm {
namespace {

using Worst = Figures::Worst;

template <class Element> std::string name_of(const Element& element) {
  return std::visit([](const auto& x) { return std::string(x.name); }, element);
}

std::string at_time(double t) { return " at t = " + detail::text_of(t); }

/// [J] of bounds of the work of moments and of forces that turn with their body: they have no potential.
double bound_of_loads(const Scene& /*scene*/, const State& /*from*/, const State& /*to*/) { return 0; }
double bound_of_loads(const spatial::Scene& scene, const State& from, const State& to) {
  double work = 0;
  for (const spatial::Load& l : scene.loads) {
    const bool turns = l.frame == spatial::Frame::body;
    const double moment = l.moment.norm() + (turns ? l.force.norm() * l.point.norm() : 0);
    const double force = turns ? l.force.norm() : 0;
    // Impacts between the rows may make speeds larger than at both ends: then the way says more.
    const double time = to.t - from.t;
    const Eigen::VectorXd way = 1.1 * between<Spatial>(from.q, to.q);
    work += moment * std::max({time * turning_of<Spatial>(from, l.body), time * turning_of<Spatial>(to, l.body),
                               rotation<Spatial>(way, l.body).norm()}) +
            force * std::max({time * speed_of<Spatial>(from, l.body), time * speed_of<Spatial>(to, l.body),
                              translation<Spatial>(way, l.body).norm()});
  }
  return work;
}

/// q, a part s of the straight way from one state to another.
template <class Space> Eigen::VectorXd between_states(const State& from, const State& to, double s) {
  if constexpr (kPlanar<Space>) {
    return (1 - s) * from.q + s * to.q;
  } else {
    Eigen::VectorXd q;
    move<Space>(from.q, s * between<Space>(from.q, to.q), q);
    return q;
  }
}

/// [m, rad] A journal's clearance, or that of a ball in a socket or a pin in a bush; infinity.
double clearance_of(const Contact& contact) {
  const auto* journal = std::get_if<Journal>(&contact);
  return journal != nullptr ? journal->radius_b - journal->radius_a : kInf;
}
double clearance_of(const spatial::Contact& contact) {
  if (const auto* c = std::get_if<spatial::Socket>(&contact)) return c->radius_b - c->radius_a;
  if (const auto* c = std::get_if<spatial::PinBush>(&contact)) return c->radius_b - c->radius_a;
  if (const auto* c = std::get_if<spatial::SphereBush>(&contact)) return c->radius_b - c->radius_a;
  return kInf;
}
bool limits_angle(const Contact& contact) {
  const auto* limit = std::get_if<Limit>(&contact);
  return limit != nullptr && is_angle(limit->of);
}
bool limits_angle(const spatial::Contact& contact) {
  if (const auto* teeth = std::get_if<spatial::Backlash>(&contact)) return teeth->gear.second.angle();
  const auto* limit = std::get_if<spatial::Limit>(&contact);
  return limit != nullptr && is_angle(limit->of);
}
/// One of two points of a pair, of which the first stands for both.
bool second_point(const Contact& contact) {
  const auto* pair = std::get_if<PolygonPolygon>(&contact);
  return pair != nullptr && pair->point != 0;
}
bool second_point(const spatial::Contact& /*contact*/) { return false; }

/// The figures of one trace; each function goes once over its rows.
template <class Space> class Examination {
  using Scene = SceneOf<Space>;

 public:
  Examination(const Scene& scene, const Trace& trace, const Allowance& allowed, double until)
      : scene_(scene), trace_(trace), allowed_(allowed), measure_(scene) {
    while (count_ < trace.rows.size() && trace.rows[count_].t <= until) ++count_;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) reach_.push_back(measure_.reach(static_cast<BodyId>(b)));
  }

  Figures figures() {
    for (std::size_t r = 0; r < count_; ++r) f_.finite = f_.finite && row(r).q.allFinite() && row(r).v.allFinite();
    if (!f_.finite || count_ == 0) return f_;
    scales();
    joints();
    contacts();
    energy();
    return f_;
  }

 private:
  const State& row(std::size_t r) const { return trace_.rows[r]; }

  double point_speed(const State& x, BodyId b) const {
    return b < 0 ? 0 : speed_of<Space>(x, b) + reach_[static_cast<std::size_t>(b)] * turning(x, b);
  }

  static double turning(const State& x, BodyId b) { return b < 0 ? 0 : turning_of<Space>(x, b); }

  void scales() {
    f_.size = *std::max_element(reach_.begin(), reach_.end());
    for (std::size_t r = 0; r < count_; ++r)
      for (BodyId b = 0; b < static_cast<BodyId>(reach_.size()); ++b) {
        f_.size = std::max(f_.size, (place_of<Space>(row(r).q, b) - place_of<Space>(row(0).q, b)).norm());
        f_.speed = std::max(f_.speed, point_speed(row(r), b));
      }
  }

  void joints() {
    for (const auto& joint : scene_.joints)
      for (std::size_t r = 0; r < count_; ++r)
        if (const double off = measure_.residual(joint, row(r).t, row(r).q); off > f_.joint.value)
          f_.joint = {off, "joint \"" + name_of(joint) + "\" is off by " + detail::text_of(off) + at_time(row(r).t)};
  }

  /// [m, rad] What a contact may be deeper than at the start. A scheme of fixed step meets a contact up to a step late
  /// and loses up to h v more where it corrects velocities only, so three steps' way of its points count, with what
  /// gravity adds; a clearance makes no difference to that.
  double allowed(BodyId a, BodyId b, double clearance) const {
    double fast = 0;
    for (std::size_t r = 0; r < count_; ++r) fast = std::max(fast, point_speed(row(r), a) + point_speed(row(r), b));
    const double most = allowed_.share * f_.size + 3 * allowed_.step * (fast + allowed_.step * scene_.gravity.norm());
    return allowed_.step == 0 ? std::min(most, clearance / 10 + 1e-6 * f_.size) + left_by_crossings(f_.size) : most;
  }
  /// [m, rad] Within a crossing of first order a contact may be as deep as the run warns that crossings leave.
  double left_by_crossings(double size) const {
    return trace_.run.crossings > 0 && allowed_.step == 0 ? std::min(trace_.run.error_estimate, 1e-3 * size) : 0;
  }
  double allowed_angle(BodyId a, BodyId b) const {
    double turn = 0;
    for (std::size_t r = 0; r < count_; ++r) turn = std::max(turn, turning(row(r), a) + turning(row(r), b));
    return allowed_.share + left_by_crossings(1) +
           3 * allowed_.step * (turn + allowed_.step * scene_.gravity.norm() / f_.size);
  }

  void contacts() {
    for (const auto& contact : scene_.contacts) {
      if (second_point(contact)) continue;
      const auto [a, b] = measure_.pair(contact);
      const double limit = limits_angle(contact) ? allowed_angle(a, b) : allowed(a, b, clearance_of(contact));
      touch("contact \"" + name_of(contact) + '"', a, b, limit, measure_.width(contact),
            [&](const Eigen::VectorXd& q) { return measure_.gap(contact, q); });
    }
    if constexpr (!kPlanar<Space>) {
      for (const spatial::Collision& c : scene_.collisions)
        for (std::size_t i = 0; i < c.shapes.size(); ++i)
          for (std::size_t j = i + 1; j < c.shapes.size(); ++j) {
            const spatial::Shape &x = c.shapes[i], &y = c.shapes[j];
            if (x.body != y.body)
              touch("collision \"" + c.name + "\" of shapes " + std::to_string(i) + " and " + std::to_string(j), x.body,
                    y.body, allowed(x.body, y.body, kInf), measure_.width(x, y),
                    [&](const Eigen::VectorXd& q) { return measure_.gap(x, y, q); });
          }
    }
  }

  template <class Gap>
  void touch(const std::string& who, BodyId a, BodyId b, double limit, double width, const Gap& gap) {
    std::vector<double> gaps;
    for (std::size_t r = 0; r < count_; ++r) gaps.push_back(gap(row(r).q));
    const double start = std::min(gaps[0], 0.0);
    f_.overlap = std::max(f_.overlap, -start);
    for (std::size_t r = 0; r < count_; ++r) {
      const double deep = start - gaps[r];
      if (!(deep > 0) || deep / limit <= f_.depth_share.value) continue;
      f_.depth_share = {deep / limit, ""};
      f_.depth = {deep, who + " is " + detail::text_of(deep) + " deep, " + detail::text_of(limit) + " allowed," +
                            at_time(row(r).t)};
    }
    if (width < 1e9) passages(who, a, b, width, gap, gaps);
  }

  /// Between rows the way is taken as straight, as schemes of fixed step take it; of the others it is curved, or bent
  /// by an impact: that may be off by half the way between two rows.
  template <class Gap> void passages(const std::string& who, BodyId a, BodyId b, double width, const Gap& gap_at,
                                     const std::vector<double>& gaps) {
    for (std::size_t r = 0; r + 1 < count_; ++r) {
      const State &from = row(r), &to = row(r + 1);
      const double way = (to.t - from.t) * (std::max(point_speed(from, a), point_speed(to, a)) +
                                            std::max(point_speed(from, b), point_speed(to, b)));
      const double slack = allowed_.step > 0 ? 0 : 0.6 * way;
      const double ends = std::min({gaps[r], gaps[r + 1], 0.0});
      if (std::min(gaps[r], gaps[r + 1]) > way || way < width / 5 + slack) continue;
      const int parts = std::clamp(static_cast<int>(16 * way / width), 4, 200);
      bool passes = false;
      for (int i = 1; i < parts; ++i) {
        const double s = static_cast<double>(i) / parts;
        const double gap = gap_at(between_states<Space>(from, to, s)), share = (ends - gap - slack) / width;
        passes = passes || share > kPassed;
        if (share > f_.passed.value)
          f_.passed = {share, who + ": " + detail::text_of(-gap) + " m deep on the way between two rows, " +
                                  detail::text_of(-ends) + " at them," + at_time(to.t)};
      }
      passing_.resize(count_, false);
      f_.passages += passes && !passing_[r];  // several pairs in one step: one, as the run counts them
      passing_[r] = passing_[r] || passes;
    }
  }

  /// Energy less work must not grow: its rise above the least value so far, beyond what the run reports: rises of
  /// impacts, and of schemes of fixed step the defect of its own balance, where it warns of that. Of fixed steps, and
  /// of runs with crossings of first order, the largest of three rows counts: velocities that are differences of
  /// places, or lie between those of a crossing's ends, have less in the row of an impact.
  void energy() {
    const auto& motion = trace_.run.motion;
    const double warned = allowed_.step > 0 && motion.energy_off() ? motion.energy_defect : 0;
    const double rises = std::max(static_cast<double>(trace_.run.energy_rises) * trace_.run.max_energy_rise, warned);
    double least = kInf, kinetic = 0, low = kInf, high = -kInf;
    const std::size_t window = allowed_.step > 0 || trace_.run.crossings > 0 ? 3 : 1;
    std::vector<double> last(window);
    double loads = 0;
    for (std::size_t r = 0; r < count_; ++r) {
      const double T = measure_.kinetic(row(r).v), V = measure_.potential(row(r).q), E = T + V - trace_.belt[r] - loads;
      if (r + 1 < count_) loads += bound_of_loads(scene_, row(r), row(r + 1));
      kinetic = std::max(kinetic, T), low = std::min(low, V), high = std::max(high, V);
      last[r % window] = E;
      if (r + 1 >= window) least = std::min(least, *std::max_element(last.begin(), last.end()));
      if (const double gain = E - least - rises; gain > f_.gain.value)
        f_.gain = {gain, "energy rises by " + detail::text_of(gain) + " J up to t = " + detail::text_of(row(r).t)};
    }
    f_.energy = kinetic + high - low;
  }

  const Scene& scene_;
  const Trace& trace_;
  const Allowance& allowed_;
  MeasureOf<Space> measure_;
  std::size_t count_ = 0;
  std::vector<double> reach_;
  std::vector<bool> passing_;  // in the interval after each row
  Figures f_;
};

}  // namespace

Figures examine(const Scene& scene, const Trace& trace, const Allowance& allowed, double until) {
  return Examination<Planar>(scene, trace, allowed, until).figures();
}
Figures examine(const spatial::Scene& scene, const Trace& trace, const Allowance& allowed, double until) {
  return Examination<Spatial>(scene, trace, allowed, until).figures();
}

template <class Space> double difference(const std::vector<State>& a, const std::vector<State>& b, double size) {
  const auto& coarse = a.size() < b.size() ? a : b;
  const auto& fine = a.size() < b.size() ? b : a;
  double most = 0;
  std::size_t k = 0;
  for (const State& x : coarse) {
    const double slack = 1e-9 * (coarse.back().t + 1e-9);
    while (k < fine.size() && fine[k].t < x.t - slack) ++k;
    if (k == fine.size()) break;
    if (fine[k].t > x.t + slack) continue;
    for (Eigen::Index i = 0; i < x.q.size() / Space::kCoordinates; ++i) {
      most = std::max(
          most, (place_of<Space>(x.q, i) - place_of<Space>(fine[k].q, i)).template lpNorm<Eigen::Infinity>() / size);
      if constexpr (kPlanar<Space>)
        most = std::max(most, std::abs(x.q[3 * i + 2] - fine[k].q[3 * i + 2]));
      else
        most = std::max(most, quaternions::turn_between(quaternion(x.q, i), quaternion(fine[k].q, i)).norm());
    }
  }
  return most;
}
template double difference<Planar>(const std::vector<State>&, const std::vector<State>&, double);
template double difference<Spatial>(const std::vector<State>&, const std::vector<State>&, double);

}  // namespace orthant::motion_storm
