#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/nearby_motion.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kParameterStep = 1e-4;  // of the value
constexpr double kWay = 1e-4;            // [m, rad] of differences along δ, where the parameter leaves the scene alone
constexpr double kTogether = 1e-6;       // of the changes of times: contacts strike together still
constexpr double kSameImpact = 1e-7;     // of v⁺
constexpr double kGraze = 1e-9;          // [m/s]

/// f(nearby motion, q, v) at (q, v) + k ε (dq, dv), k = ±1, ±2: its derivative, of any number of values.
struct Direction {
  ParameterChange change;
  std::array<std::unique_ptr<NearbyMotion>, 4> near;

  double step(const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, const Eigen::VectorXd& v) const {
    if (change.of_scene()) return change.step;
    return kWay / std::max({dq.lpNorm<Eigen::Infinity>(),
                            dv.lpNorm<Eigen::Infinity>() / (1 + v.lpNorm<Eigen::Infinity>()), 1e-300});
  }
  template <class F> Eigen::VectorXd derivative(const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                                const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, F&& f) const {
    constexpr int kPlaces[] = {-2, -1, 1, 2};
    constexpr double kWeights[] = {1, -8, 8, -1};
    const double by = step(dq, dv, v);
    Eigen::VectorXd sum;
    for (std::size_t k = 0; k < 4; ++k) {
      Eigen::VectorXd at_q = q + kPlaces[k] * by * dq, at_v = v + kPlaces[k] * by * dv;
      const Eigen::VectorXd value = f(*near[k], at_q, at_v);
      if (k == 0) sum.setZero(value.size());
      sum += kWeights[k] * value;
    }
    return sum / (12 * by);
  }
};

Eigen::VectorXd both(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  Eigen::VectorXd x(q.size() + v.size());
  x << q, v;
  return x;
}

class Variation {
 public:
  Variation(const System& system, const std::vector<RunParameter>& parameters, MotionTangent& result)
      : system_(system), base_(system), result_(result) {
    const auto count = static_cast<Eigen::Index>(parameters.size());
    result.q.setZero(system.dof(), count), result.v.setZero(system.dof(), count);
    for (const RunParameter& parameter : parameters) {
      Direction direction{changes_of(parameter, system, kParameterStep), {}};
      for (std::size_t k = 0; k < 4; ++k)
        direction.near[k] =
            std::make_unique<NearbyMotion>(direction.change.of_scene() ? *direction.change.at[k] : system);
      directions_.push_back(std::move(direction));
    }
  }

  /// The start, projected onto the joints.
  void begin(const State& given) {
    const std::vector<ContactMode> open(static_cast<std::size_t>(system_.contacts()));
    each([&](Direction& d, auto dq, auto dv) {
      map(d, given.q, given.v, d.change.start_q, d.change.start_v, dq, dv,
          [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
            near.set_modes(open);
            near.project(given.t, q, v);
          });
    });
  }

  /// Over an arc, after what happened at its start.
  void pass(const Arc& arc) {
    if (pending_) cross(arc);
    each([&](Direction& d, auto dq, auto dv) {
      const Eigen::VectorXd from_q = dq, from_v = dv;
      map(d, arc.q0, arc.v0, from_q, from_v, dq, dv, [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
        near.set_modes(arc.modes);
        if (!near.move(arc.start, arc.length, q, v)) throw std::runtime_error("derivatives of a motion: not finite");
      });
    });
    before_ = arc, pending_ = true;
  }
  void note(std::span<const Event> events) { events_.assign(events.begin(), events.end()); }

 private:
  template <class F> void each(F&& f) {
    for (std::size_t j = 0; j < directions_.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      f(directions_[j], result_.q.col(column), result_.v.col(column));
    }
  }
  template <class Out, class F> void map(Direction& d, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                         const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, Out& to_q, Out& to_v,
                                         F&& f) {
    const Eigen::VectorXd x =
        d.derivative(q, v, dq, dv, [&](NearbyMotion& near, Eigen::VectorXd& at_q, Eigen::VectorXd& at_v) {
          f(near, at_q, at_v);
          return both(at_q, at_v);
        });
    to_q = x.head(q.size()), to_v = x.tail(q.size());
  }

  void none(const std::string& why) {
    if (result_.none.empty()) result_.none = "at t = " + detail::text_of(before_.start + before_.length) + " s " + why;
  }
  std::string name(int contact) const {
    return std::visit([](const auto& c) { return "'" + c.name + "'"; },
                      system_.scene().contacts[static_cast<std::size_t>(contact)]);
  }

  /// The event between before_ and `after`.
  void cross(const Arc& after) {
    const double t = before_.start + before_.length;
    std::vector<Struck> struck;
    std::vector<int> gaps, slips;
    for (const Event& event : events_)
      if (event.kind == EventKind::impact || event.kind == EventKind::accumulation) {
        const ContactLaw& law = system_.law(event.contact);
        const bool slides = std::abs(event.tangent) >= (1 - 1e-9) * law.mu * event.normal;
        struck.push_back({event.contact, false, law.frictional() && slides ? (event.tangent > 0 ? 1 : -1) : 0,
                          law.frictional() && !slides});
        if (!before_.modes[static_cast<std::size_t>(event.contact)].lasting) gaps.push_back(event.contact);
      }
    const bool plastic =
        std::any_of(events_.begin(), events_.end(), [](const Event& e) { return e.kind == EventKind::accumulation; });
    for (Struck& s : struck) s.plastic = plastic;
    for (std::size_t c = 0; c < after.modes.size(); ++c) {
      const ContactMode &was = before_.modes[c], &is = after.modes[c];
      const auto contact = static_cast<int>(c);
      if (was.lasting && is.lasting && was.slip != 0 && was.slip != is.slip) slips.push_back(contact);
      if (!was.lasting && is.lasting && std::find(gaps.begin(), gaps.end(), contact) == gaps.end() && t > 0)
        none("contact " + name(contact) + " is touched without a velocity (a graze)");
    }
    if (gaps.empty() && slips.empty()) return;  // f is continuous
    check_reset(struck, t, after);
    const EventKind kind = gaps.empty() ? EventKind::slip : plastic ? EventKind::accumulation : EventKind::impact;
    const std::vector<int>& guards = gaps.empty() ? slips : gaps;
    CrossedGuard crossed{t, kind, guards.front(), 0, {}};
    each([&](Direction& d, auto dq, auto dv) {
      const double moves = change_of_time(d, guards, !gaps.empty(), dq, dv, crossed.rate);
      crossed.moves.push_back(moves);
      const Eigen::VectorXd from_q = dq + moves * before_.v1, from_v = dv + moves * before_.a1;
      map(d, before_.q1, before_.v1, from_q, from_v, dq, dv,
          [&](NearbyMotion& near, Eigen::VectorXd& q, Eigen::VectorXd& v) {
            if (!struck.empty()) near.set_modes(before_.modes), near.strike(struck, t, q, v);
            near.set_modes(after.modes);
            near.project(t, q, v);
          });
      dq -= moves * after.v0, dv -= moves * after.a0;
    });
    result_.guards.push_back(std::move(crossed));
  }

  void check_reset(const std::vector<Struck>& struck, double t, const Arc& after) {
    if (struck.empty()) return;
    Eigen::VectorXd q = before_.q1, v = before_.v1;
    base_.set_modes(before_.modes);
    base_.strike(struck, t, q, v);
    base_.set_modes(after.modes);
    base_.project(t, q, v);
    const double off = (v - after.v0).lpNorm<Eigen::Infinity>() / (1 + v.lpNorm<Eigen::Infinity>());
    if (!(off <= kSameImpact))
      throw std::runtime_error("derivatives of a motion: the impact at t = " + detail::text_of(t) +
                               " s is not one by Newton's law on all contacts at once, by " + detail::text_of(off));
  }

  /// δt of (1); of several guards the mean, where they agree.
  double change_of_time(Direction& d, const std::vector<int>& guards, bool gap, const Eigen::VectorXd& dq,
                        const Eigen::VectorXd& dv, double& rate) {
    const double t = before_.start + before_.length;
    double sum = 0, least = kInf, most = -kInf;
    for (const int contact : guards) {
      const auto value = [&](NearbyMotion& near, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
        return Eigen::VectorXd::Constant(1, gap ? near.gap(contact, t, q) : near.slip(contact, t, q, v));
      };
      const double change = d.derivative(before_.q1, before_.v1, dq, dv, value)[0];
      rate = rate_of(contact, gap);
      if (!(std::abs(rate) > kGraze))
        none("contact " + name(contact) + (gap ? " is touched" : " stops") + " at a rate of " + detail::text_of(rate) +
             ": not transversal (a graze)");
      const double moves = rate != 0 ? -change / rate : 0;
      sum += moves, least = std::min(least, moves), most = std::max(most, moves);
    }
    const double size = std::max(std::abs(least), std::abs(most)), way = gap ? std::abs(rate) : 1;
    if (most - least > kTogether * size && (most - least) * way * d.step(dq, dv, before_.v1) > 1e-12)
      none("contacts strike together that a parameter parts");
    return sum / static_cast<double>(guards.size());
  }

  double rate_of(int contact, bool gap) {
    const double t = before_.start + before_.length;
    return gap ? base_.gap_rate(contact, t, before_.q1, before_.v1)
               : base_.slip_rate(contact, t, before_.q1, before_.v1, before_.a1);
  }

  const System& system_;
  NearbyMotion base_;
  MotionTangent& result_;
  std::vector<Direction> directions_;
  Arc before_;
  bool pending_ = false;
  std::vector<Event> events_;
};

}  // namespace

MotionTangent differentiate_motion(const System& system, const std::vector<RunParameter>& parameters,
                                   const EventDrivenOptions& options, Solver& solver, double duration, double every,
                                   const MotionRecorder& record, const std::atomic<bool>* cancel) {
  if (!(duration > 0) || !std::isfinite(duration)) throw std::invalid_argument("duration: must be > 0 and finite");
  if (!(every > 0)) throw std::invalid_argument("every: must be > 0");
  MotionTangent result;
  result.final = system.initial_state();
  State& x = result.final;
  Variation variation(system, parameters, result);
  variation.begin(x);
  EventDriven integrator(system, options);
  if (record) record(x, result.q, result.v);
  for (long row = 1; x.t < duration; ++row) {
    const double end = std::min(static_cast<double>(row) * every, duration);
    while (x.t < end) {
      if (cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
        result.status = Status::cancelled;
        return result;
      }
      const StepReport report = integrator.stride(end - x.t, solver, x);
      if (report.status != Status::solved) {
        result.status = report.status, result.why = integrator.why();
        return result;
      }
      if (report.crossings > 0 && result.none.empty())
        result.none = "at t = " + detail::text_of(x.t) + " s a crowd of events is crossed";
      if (integrator.arc().length > 0) variation.pass(integrator.arc());
      variation.note(integrator.events());
      if (end - x.t <= 1e-15 * end) x.t = end;
    }
    if (record) record(x, result.q, result.v);
  }
  return result;
}

}  // namespace orthant
