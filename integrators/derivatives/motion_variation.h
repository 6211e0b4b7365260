// integrators/derivatives/motion_variation.h — variations along one event-driven motion: arcs, and the events between.
//
//   What motion_tangent.h says in formulas, for all parameters of one motion.
#pragma once

#include <orthant/integrators/derivatives/begun_friction.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/derivatives/nearby_motion.h>

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace orthant {

/// One parameter's change: of the scene, along with the state or by itself, or of the state alone.
struct VariedDirection {
  ParameterChange change;
  NearbyMotion* base = nullptr;
  std::array<std::unique_ptr<NearbyMotion>, 4> near;  // null: the scene stays as it is
  double way = 1e-4;                                  // [m, rad] of differences along the state alone
  double far = 3e-3;                                  // [m, rad] along with the parameter, at most

  /// f(nearby motion, q, v), of any number of values: its derivative along (dq, dv) and the parameter.
  template <class F> Eigen::VectorXd derivative(const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                                const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, F&& f) const {
    const double fast = speed(dq, dv, v);
    if (change.of_scene() && change.step * fast <= far)
      return sum(change.places, change.weights, change.step, true, q, v, dq, dv, f);
    constexpr std::array<int, 4> kPlaces{-2, -1, 1, 2};
    constexpr std::array<double, 4> kWeights{1. / 12, -8. / 12, 8. / 12, -1. / 12};
    Eigen::VectorXd all = sum(kPlaces, kWeights, way / std::max(fast, 1e-300), false, q, v, dq, dv, f);
    if (!change.of_scene()) return all;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(q.size());
    return all + sum(change.places, change.weights, change.step, true, q, v, none, none, f);
  }
  /// Of the state, by the step of differences.
  double moved(const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, const Eigen::VectorXd& v) const {
    const double fast = speed(dq, dv, v);
    return change.of_scene() && change.step * fast <= far ? change.step : way / std::max(fast, 1e-300);
  }

 private:
  static double speed(const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, const Eigen::VectorXd& v) {
    return std::max(dq.lpNorm<Eigen::Infinity>(), dv.lpNorm<Eigen::Infinity>() / (1 + v.lpNorm<Eigen::Infinity>()));
  }
  template <class F> Eigen::VectorXd sum(const std::array<int, 4>& places, const std::array<double, 4>& weights,
                                         double step, bool of_scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                         const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, F&& f) const {
    Eigen::VectorXd total, at_q, at_v;
    for (std::size_t k = 0; k < 4; ++k) {
      at_q = q + places[k] * step * dq, at_v = v + places[k] * step * dv;
      const Eigen::VectorXd value = f(of_scene ? *near[k] : *base, at_q, at_v);
      if (k == 0) total.setZero(value.size());
      total += weights[k] * value;
    }
    return total / step;
  }
};

class MotionVariation {
 public:
  MotionVariation(const System& system, const std::vector<RunParameter>& parameters, double duration,
                  const EventDrivenOptions& options, MotionTangent& result);

  /// The start as the scene gives it, projected onto the joints.
  void begin(const State& given);
  /// Over an arc, after what happened at its start. events: of the stride that it is of.
  void pass(const Arc& arc, std::span<const Event> events);

 private:
  enum class Guard { gap, slip, room };
  struct Crossing {
    std::vector<Struck> struck;
    Guard kind = Guard::gap;
    std::vector<int> guards;  // contacts
    std::vector<int> sides;   // of rooms: the sense of the friction force
    bool plastic = false;     // an accumulation
  };

  struct HeldFriction {  // of a contact that an impact leaves without a slip [N s]
    int contact;
    double tangent, bound;
  };

  struct ClosedContact {  // at the start
    Struck contact;
    bool begins = false;  // to slide, from rest
    bool grips = false;   // holds against a force
    double fall = 0;      // [m/s²] of its gap, all of them open
    bool turns = false;   // its direction or its arm, with the motion
  };
  struct StartChange {                    // by one parameter: the names of contacts
    std::string contacts;                 // all that change
    std::string opened, sunk, gripped;    // by gaps; those that hold among them
    std::string rising, falling, tilted;  // by rates; those that begin to slide on a body which tilts
    bool turns = false;                   // some that open or sink
    bool slides = false, begins = false;  // some of them
    bool redundant = false;               // no motion closes all gaps again
  };

  template <class F> void each(F&& f) {
    for (std::size_t j = 0; j < directions_.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      f(directions_[j], result_.q.col(column), result_.v.col(column));
    }
  }
  template <class Out, class F> void map(VariedDirection& d, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                         const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, Out& to_q, Out& to_v,
                                         F&& f);

  MotionVariation(const System& system, const std::vector<RunParameter>& parameters,
                  std::vector<ParameterChange> changes, const EventDrivenOptions& options, MotionTangent& result);

  void start(const Arc& first);
  void follow(const Arc& arc);
  void note_one_sided(const std::vector<Struck>& closed, const Arc& first);
  std::vector<ClosedContact> look_at(const std::vector<Struck>& closed, const Arc& first);
  std::vector<Struck> relieved_by(const std::vector<Struck>& closed, const Arc& first);
  StartChange change_of_start(const VariedDirection& d, const Eigen::VectorXd& dq, const Eigen::VectorXd& dv,
                              const std::vector<ClosedContact>& closed, const std::vector<Struck>& relieved);
  void say(const std::string& parameter, const StartChange& change, bool damped);
  bool parts_redundant(const std::vector<Struck>& closed, const std::vector<double>& gaps);
  bool touch_one_body(int one, int other) const;  // two contacts
  bool begins_from_rest(int contact, const Arc& first);
  void note_first_slips(const Arc& first);
  void list(std::string& names, int contact) const;
  void cross(const Arc& after);
  void strikes(const Arc& after, Crossing& crossing);
  bool stops(int contact, const Arc& after);
  bool varies_e_t(int contact) const;  // a direction changes it
  void check_held(const std::vector<HeldFriction>& held);
  void slips(const Arc& after, Crossing& crossing);
  bool jumps(const Arc& after);
  void cross_knot(const Arc& after);
  void watch_grazes(const Arc& arc, std::span<const Event> at_end);
  void reset(const Crossing& crossing, const Arc& after);
  bool parts_struck(const VariedDirection& d, const Eigen::VectorXd& dq, const Eigen::VectorXd& dv,
                    std::span<const double> missed) const;
  std::string names_of(const std::vector<Struck>& contacts) const;
  void check_reset(const Crossing& crossing, const Arc& after);
  double change_of_time(VariedDirection& d, const Crossing& crossing, const Eigen::VectorXd& rate,
                        const Eigen::VectorXd& dq, const Eigen::VectorXd& dv, double& change);
  Eigen::VectorXd rates(const Crossing& crossing);
  double least_rate(const Crossing& crossing, std::size_t guard);
  void none(const std::string& why);
  std::string name(int contact) const;
  double now() const { return before_.start + before_.length; }
  double just_before() const { return now() - 8 * kRounding * (std::abs(now()) + before_.length); }  // a load's jump

  const System& system_;
  EventDrivenOptions options_;
  NearbyMotion base_;
  BegunFriction begins_;
  std::vector<int> at_rest_;  // contacts of an arc, whose friction begins, that do not slip
  MotionTangent& result_;
  std::vector<VariedDirection> directions_;
  std::vector<std::string> names_;  // of the parameters
  Arc before_;
  bool begun_ = false;
  std::vector<double> struck_at_;  // [s] of each contact, the last impact
  std::vector<Event> events_;      // since before_
};

/// f(nearby motion, q, v) changes q and v: the derivative of what they become.
template <class Out, class F> void MotionVariation::map(VariedDirection& d, const Eigen::VectorXd& q,
                                                        const Eigen::VectorXd& v, const Eigen::VectorXd& dq,
                                                        const Eigen::VectorXd& dv, Out& to_q, Out& to_v, F&& f) {
  const Eigen::VectorXd x =
      d.derivative(q, v, dq, dv, [&](NearbyMotion& near, Eigen::VectorXd& at_q, Eigen::VectorXd& at_v) {
        f(near, at_q, at_v);
        Eigen::VectorXd both(at_q.size() + at_v.size());
        both << at_q, at_v;
        return both;
      });
  to_q = x.head(q.size()), to_v = x.tail(q.size());
}

}  // namespace orthant
