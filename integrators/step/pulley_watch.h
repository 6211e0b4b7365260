// integrators/step/pulley_watch.h — singular direction of a taut rope, whose end has run into its pulley, or of a
// joint's distance that has become 0.
//
//   A rope over pulleys (relation.h) pulls its end P towards the pulley A along (A − P) / |A − P|. At P = A the model
//   has no direction. A direction that turns by more than a right angle in a step, in which the rope pulls, has passed
//   that place. Slack ropes may. The step is that of the scheme: event-driven and adaptive watch their inner steps, as
//   an end may swing about its pulley by any angle between two outputs. Schemes whose rows are those of a predicted
//   place keep the direction of the step's start where a taut rope's end is predicted beyond its pulley
//   (gap_stepping.h): else the end would stop there as if at a wall, and never pass.
//   A relation holds a distance on both sides, slack or not. There it also counts as lost where the distance
//   would have gone through 0 within the step at its rate before, and grows after it: the end was thrown back.
// Cost: nothing if a scene has neither; else one row per rope, or distance, and step.
#pragma once

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/planar/relation.h>
#include <orthant/integrators/integrator.h>
#include <orthant/integrators/step/jam.h>

#include <string>
#include <variant>
#include <vector>

namespace orthant {

/// Numbers of the scene's contacts that are ropes over pulleys.
inline std::vector<int> ropes_over_pulleys(const Scene& scene) {
  std::vector<int> ropes;
  for (std::size_t i = 0; i < scene.contacts.size(); ++i) {
    const auto* custom = std::get_if<CustomContact>(&scene.contacts[i]);
    if (custom != nullptr && !custom->law.frictional() && custom->length() < kInf) ropes.push_back(static_cast<int>(i));
  }
  return ropes;
}
inline std::vector<int> ropes_over_pulleys(const spatial::Scene& /*scene*/) { return {}; }

/// Whether a body's part of the row has turned by more than a right angle.
inline bool turned_back(const Row& one, const Row& other) {
  return one.ja[0] * other.ja[0] + one.ja[1] * other.ja[1] < 0 || one.jb[0] * other.jb[0] + one.jb[1] * other.jb[1] < 0;
}

/// A distance that a relation holds.
struct JointDistance {
  std::string joint;
  Coordinate of;
};
inline std::vector<JointDistance> distances_of_joints(const Scene& scene) {
  std::vector<JointDistance> all;
  const auto add = [&](const std::string& joint, const Coordinate& of) {
    if (std::holds_alternative<Span>(of.kind())) all.push_back({joint, of});
  };
  for (const Joint& joint : scene.joints) {
    const auto* custom = std::get_if<CustomJoint>(&joint);
    const auto* relation = custom != nullptr ? custom->target<Relation>() : nullptr;
    if (relation == nullptr) continue;
    for (const CoordinateTerm& term : relation->sum.terms()) add(custom->name, term.of);
  }
  return all;
}

class PulleyWatch {
 public:
  PulleyWatch(const Integrator& integrator, const State& start)
      : integrator_(integrator),
        ropes_(ropes_over_pulleys(system().scene())),
        distances_(distances_of_joints(system().scene())) {
    directions_.resize(kEntries * (ropes_.size() + distances_.size()));
    lengths_.resize(2 * distances_.size());
    if (empty()) return;
    terms_ = Terms(system());
    turned(
        start.t, start.q, [](int) { return true; }, directions_);
    lost(start, false);
  }
  bool empty() const { return ropes_.empty() && distances_.empty(); }

  /// After a step to x. False: why().
  bool admits(const State& x) {
    if (empty()) return true;
    return admits(x, [&](int i) { return integrator_.impulses()[static_cast<std::size_t>(i)].normal > 0; });
  }
  /// Likewise, with the contacts that pull.
  template <class Pulls> bool admits(const State& x, const Pulls& pulls) {
    if (empty()) return true;
    const bool turns = turned(x.t, x.q, pulls, directions_);
    return !lost(x, true) && !turns;
  }
  /// Directions at x, whatever they were.
  void follow(const State& x) {
    if (empty()) return;
    turned(
        x.t, x.q, [](int) { return false; }, directions_);
    lost(x, false);
  }

  /// Whether a failed step of h [s] from x leads an end, as fast as it is, into its pulley: then why() says so.
  bool explains(const State& x, double h) {
    constexpr double kAhead = 2;  // steps
    if (empty() || x.q.size() != x.v.size()) return false;
    for (std::size_t k = 0; k < distances_.size(); ++k)
      if (const double length = lengths_[2 * k], rate = lengths_[2 * k + 1]; length + kAhead * h * rate < 0)
        return explained(distances_[k], x.t - length / rate), true;
    std::vector<double> there = directions_;
    return turned(
        x.t + h, x.q + kAhead * h * x.v, [](int) { return true; }, there);
  }

  const std::string& why() const { return why_; }
  void remember(CheckpointData& memory) { memory(directions_, lengths_, t_); }

 private:
  static constexpr std::size_t kEntries = 4;  // linear parts of a row, of both bodies

  const System& system() const { return integrator_.system(); }

  /// Directions there, and whether one of a contact that `pulls` has turned by more than a right angle.
  template <class Pulls>
  bool turned(double t, const Eigen::VectorXd& q, const Pulls& pulls, std::vector<double>& directions) {
    set_poses(system(), t, q, terms_.at);
    bool any = false;
    for (std::size_t k = 0; k < ropes_.size(); ++k) {
      terms_.closed.clear();
      add_closed(system(), ropes_[k], terms_);
      const Row& row = terms_.closed[0].rows.normal;
      const double now[kEntries] = {row.ja[0], row.ja[1], row.jb[0], row.jb[1]};
      double* last = &directions[kEntries * k];
      const bool back = last[0] * now[0] + last[1] * now[1] < 0 || last[2] * now[2] + last[3] * now[3] < 0;
      std::copy(now, now + kEntries, last);
      if (!back || !pulls(ropes_[k])) continue;
      any = true;
      why_ = "an end of rope \"" +
             std::get<CustomContact>(system().scene().contacts[static_cast<std::size_t>(ropes_[k])]).name +
             "\" has run into its pulley, where the rope has no direction" + since(t);
    }
    return any;
  }

  /// The distances at x and, if `looks`, whether one has gone through 0 since the last state.
  bool lost(const State& x, bool looks) {
    set_poses(system(), x.t, x.q, terms_.at);
    bool any = false;
    for (std::size_t k = 0; k < distances_.size(); ++k) {
      const Row row = distances_[k].of.row(terms_.at);
      const double now[kEntries] = {row.ja[0], row.ja[1], row.jb[0], row.jb[1]};
      double *last = &directions_[kEntries * (ropes_.size() + k)], *length = &lengths_[2 * k];
      const double rate = apply(row, x.v.data());
      const bool back = last[0] * now[0] + last[1] * now[1] < 0 || last[2] * now[2] + last[3] * now[3] < 0;
      const bool thrown = length[0] + (x.t - t_) * length[1] < 0 && rate > 0;
      std::copy(now, now + kEntries, last);
      length[0] = distances_[k].of.value(terms_.at), length[1] = rate;
      if (looks && (back || thrown)) any = true, explained(distances_[k], x.t);
    }
    t_ = x.t;
    return any;
  }
  void explained(const JointDistance& one, double t) {
    why_ = "a distance of joint \"" + one.joint + "\" has become 0, where it has no direction" + since(t);
  }

  const Integrator& integrator_;
  std::vector<int> ropes_;
  std::vector<JointDistance> distances_;
  Terms terms_;
  std::vector<double> directions_, lengths_;  // of distances: value [m] and rate [m/s]
  double t_ = 0;                              // [s] of these
  std::string why_;
};

}  // namespace orthant
