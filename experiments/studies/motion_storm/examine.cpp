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

/// The figures of one trace; each function goes once over its rows.
class Examination {
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
    return b < 0 ? 0 : std::hypot(x.v[3 * b], x.v[3 * b + 1]) + reach_[static_cast<std::size_t>(b)] * turning(x, b);
  }

  static double turning(const State& x, BodyId b) { return b < 0 ? 0 : std::abs(x.v[3 * b + 2]); }

  void scales() {
    f_.size = *std::max_element(reach_.begin(), reach_.end());
    for (std::size_t r = 0; r < count_; ++r)
      for (BodyId b = 0; b < static_cast<BodyId>(reach_.size()); ++b) {
        f_.size = std::max(f_.size, (row(r).q.segment<2>(3 * b) - row(0).q.segment<2>(3 * b)).norm());
        f_.speed = std::max(f_.speed, point_speed(row(r), b));
      }
  }

  void joints() {
    for (const Joint& joint : scene_.joints)
      for (std::size_t r = 0; r < count_; ++r)
        if (const double off = measure_.residual(joint, row(r).t, row(r).q); off > f_.joint.value)
          f_.joint = {off, "joint \"" + name_of(joint) + "\" is off by " + detail::text_of(off) + at_time(row(r).t)};
  }

  /// [m, rad] What a contact may be deeper than at the start. A scheme of fixed step meets a contact up to a step late
  /// and loses up to h v more where it corrects velocities only, so three steps' way of its points count, with what
  /// gravity adds; a clearance makes no difference to that.
  double allowed(const Contact& contact) const {
    const auto [a, b] = measure_.pair(contact);
    double fast = 0;
    for (std::size_t r = 0; r < count_; ++r) fast = std::max(fast, point_speed(row(r), a) + point_speed(row(r), b));
    double most = allowed_.share * f_.size + 3 * allowed_.step * (fast + allowed_.step * scene_.gravity.norm());
    if (const auto* journal = std::get_if<Journal>(&contact); journal != nullptr && allowed_.step == 0)
      most = std::min(most, (journal->radius_b - journal->radius_a) / 10 + 1e-6 * f_.size);
    const auto* limit = std::get_if<Limit>(&contact);
    if (limit != nullptr && std::holds_alternative<Angle>(limit->of)) {
      double turn = 0;
      for (std::size_t r = 0; r < count_; ++r) turn = std::max(turn, turning(row(r), a) + turning(row(r), b));
      most = allowed_.share + 3 * allowed_.step * (turn + allowed_.step * scene_.gravity.norm() / f_.size);
    }
    return most;
  }

  void contacts() {
    for (const Contact& contact : scene_.contacts) {
      if (const auto* pair = std::get_if<PolygonPolygon>(&contact); pair != nullptr && pair->point != 0) continue;
      std::vector<double> gaps;
      for (std::size_t r = 0; r < count_; ++r) gaps.push_back(measure_.gap(contact, row(r).q));
      const double start = std::min(gaps[0], 0.0), limit = allowed(contact);
      f_.overlap = std::max(f_.overlap, -start);
      for (std::size_t r = 0; r < count_; ++r) {
        const double deep = start - gaps[r];
        if (!(deep > 0) || deep / limit <= f_.depth_share.value) continue;
        f_.depth_share = {deep / limit, ""};
        f_.depth = {deep, "contact \"" + name_of(contact) + "\" is " + detail::text_of(deep) + " deep, " +
                              detail::text_of(limit) + " allowed," + at_time(row(r).t)};
      }
      if (measure_.width(contact) < 1e9) passages(contact, gaps);
    }
  }

  /// Between rows the way is taken as straight, as schemes of fixed step take it; of the others it is curved, or bent
  /// by an impact: that may be off by half the way between two rows.
  void passages(const Contact& contact, const std::vector<double>& gaps) {
    const auto [a, b] = measure_.pair(contact);
    const double width = measure_.width(contact);
    for (std::size_t r = 0; r + 1 < count_; ++r) {
      const State &from = row(r), &to = row(r + 1);
      const double way = (to.t - from.t) * (std::max(point_speed(from, a), point_speed(to, a)) +
                                            std::max(point_speed(from, b), point_speed(to, b)));
      const double slack = allowed_.step > 0 ? 0 : 0.6 * way;
      const double ends = std::min({gaps[r], gaps[r + 1], 0.0});
      if (std::min(gaps[r], gaps[r + 1]) > way || way < width / 5 + slack) continue;
      const int parts = std::clamp(static_cast<int>(16 * way / width), 4, 200);
      for (int i = 1; i < parts; ++i) {
        const double s = static_cast<double>(i) / parts;
        const double gap = measure_.gap(contact, (1 - s) * from.q + s * to.q), share = (ends - gap - slack) / width;
        if (share > f_.passed.value)
          f_.passed = {share, "contact \"" + name_of(contact) + "\": " + detail::text_of(-gap) +
                                  " m deep on the way between two rows, " + detail::text_of(-ends) + " at them," +
                                  at_time(to.t)};
      }
    }
  }

  /// Energy less work must not grow: its rise above the least value so far, beyond what the run reports: rises of
  /// impacts, and of schemes of fixed step the defect of its own balance, where it warns of that. Of fixed steps the
  /// largest of three rows counts, as velocities that are differences of places have less in the row of an impact.
  void energy() {
    const auto& motion = trace_.run.motion;
    const double warned = allowed_.step > 0 && motion.energy_off() ? motion.energy_defect : 0;
    const double rises = std::max(static_cast<double>(trace_.run.energy_rises) * trace_.run.max_energy_rise, warned);
    double least = kInf, kinetic = 0, low = kInf, high = -kInf;
    const std::size_t window = allowed_.step > 0 ? 3 : 1;
    std::vector<double> last(window);
    for (std::size_t r = 0; r < count_; ++r) {
      const double T = measure_.kinetic(row(r).v), V = measure_.potential(row(r).q), E = T + V - trace_.belt[r];
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
  Measure measure_;
  std::size_t count_ = 0;
  std::vector<double> reach_;
  Figures f_;
};

}  // namespace

Figures examine(const Scene& scene, const Trace& trace, const Allowance& allowed, double until) {
  return Examination(scene, trace, allowed, until).figures();
}

double difference(const std::vector<State>& a, const std::vector<State>& b, double size) {
  const auto& coarse = a.size() < b.size() ? a : b;
  const auto& fine = a.size() < b.size() ? b : a;
  double most = 0;
  std::size_t k = 0;
  for (const State& x : coarse) {
    const double slack = 1e-9 * (coarse.back().t + 1e-9);
    while (k < fine.size() && fine[k].t < x.t - slack) ++k;
    if (k == fine.size()) break;
    if (fine[k].t > x.t + slack) continue;
    for (Eigen::Index i = 0; i < x.q.size(); ++i)
      most = std::max(most, std::abs(x.q[i] - fine[k].q[i]) / (i % 3 == 2 ? 1 : size));
  }
  return most;
}

}  // namespace orthant::motion_storm
