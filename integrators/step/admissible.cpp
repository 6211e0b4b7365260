#include <orthant/core/support/options.h>
#include <orthant/integrators/step/admissible.h>
#include <orthant/integrators/step/width.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace orthant {
namespace {

constexpr double kDeepClearance = 0.5, kDeepBody = 0.1;       // of a contact's length: reported
constexpr double kOutOfClearance = 10, kIntoBody = 0.5;       // likewise: the run ends
constexpr double kLook = 0.05;                                // likewise, of driven scenes: a jam is searched for
constexpr double kLookInSpace = 1e-3, kLookOfPrecise = 1e-5;  // there the step shows it of single contacts only
constexpr double kWays = 3;                        // ways of a step that a scheme of fixed step may overlap by
constexpr double kDefect = 0.05, kMostDefect = 1;  // of the energy's scale: reported; the run ends
constexpr double kGrown = 1.2;                     // of the overlap at the last look: looked at again
constexpr long kLooks = 256;                       // steps after which it is looked at in any case
constexpr double kRounded = 1e-12;                 // of the energies that differences are taken of
constexpr double kPlaceRounding = 1e-15;           // of the coordinates: their rounding
constexpr double kSoon = 1e-3;                     // of the time: a jam that near explains a failed step
constexpr double kCrossing = 1e-4;                 // [s] the longest of a scheme that divides its step

template <class Space> double look_at(const IntegratorOf<Space>& integrator) {
  if (kPlanar<Space>) return kLook;
  return integrator.controls_step() ? kLookOfPrecise : kLookInSpace;
}

/// overlap and length: numbers as texts [m, rad].
std::string words_of(const std::string& contact, const std::string& overlap, OverlapScale scale,
                     const std::string& length) {
  if (scale == OverlapScale::angle) return "the limit of contact " + contact + " is exceeded by " + overlap + " rad";
  if (scale == OverlapScale::length)
    return "the limit of contact " + contact + " is exceeded by " + overlap + " m, where a body's half width is " +
           length + " m";
  return "bodies overlap by " + overlap + " m at contact " + contact + ", where " +
         (scale == OverlapScale::clearance ? "the clearance is " : "the thinner body's half width is ") + length + " m";
}

/// [m] Root mean square distance of the masses from the axis, or from the centre.
double gyration(const Body& b) { return std::sqrt(b.inertia / b.mass); }
double gyration(const spatial::Body& b) { return std::sqrt(b.inertia.trace() / (2 * b.mass)); }

template <class Space> struct Walled {  // a contact with a wall: its normal at the start, in the world
  int contact;
  typename Space::Vector normal;
  double gap;
};

/// The length of a contact that has one of its own, and the normal of its wall.
template <class Vector> struct Measured {
  double size = kInf;  // infinity: none of its own
  OverlapScale scale = OverlapScale::body;
  std::optional<Vector> wall = {};  // in b's frame
};
Measured<Vector2d> measured(const Contact& contact) {
  if (const auto* journal = std::get_if<Journal>(&contact))
    return {journal->radius_b - journal->radius_a, OverlapScale::clearance};
  if (const auto* d = std::get_if<DiscDisc>(&contact)) return {std::min(d->radius_a, d->radius_b)};
  if (const auto* w = std::get_if<DiscWall>(&contact)) return {w->radius, OverlapScale::body, w->normal};
  if (const auto* c = std::get_if<CornerWall>(&contact)) return {kInf, OverlapScale::body, c->normal};
  if (const auto* p = std::get_if<DiscPolygon>(&contact)) return {std::min(p->radius, width_of(p->corners) / 2)};
  if (const auto* pp = std::get_if<PolygonPolygon>(&contact))
    return {std::min(width_of(pp->corners_a), width_of(pp->corners_b)) / 2};
  if (const auto* limit = std::get_if<Limit>(&contact))
    return std::holds_alternative<Angle>(limit->of.kind()) ? Measured<Vector2d>{1, OverlapScale::angle}
                                                           : Measured<Vector2d>{kInf, OverlapScale::length};
  return {};
}
Measured<Vector3d> measured(const spatial::Contact& contact) {
  if (const auto* socket = std::get_if<spatial::Socket>(&contact))
    return {socket->radius_b - socket->radius_a, OverlapScale::clearance};
  if (const auto* pin = std::get_if<spatial::PinBush>(&contact))
    return {pin->radius_b - pin->radius_a, OverlapScale::clearance};
  if (const auto* ball = std::get_if<spatial::SphereBush>(&contact))
    return {ball->radius_b - ball->radius_a, OverlapScale::clearance};
  if (const auto* s = std::get_if<spatial::SphereSphere>(&contact)) return {std::min(s->radius_a, s->radius_b)};
  if (const auto* s = std::get_if<spatial::SpherePlane>(&contact))
    return {s->radius > 0 ? s->radius : kInf, OverlapScale::body, s->normal};
  if (const auto* e = std::get_if<spatial::EllipsoidPlane>(&contact)) return {e->semi_axes.minCoeff()};
  if (const auto* limit = std::get_if<spatial::Limit>(&contact))
    return limit->of.angle() ? Measured<Vector3d>{1, OverlapScale::angle}
                             : Measured<Vector3d>{kInf, OverlapScale::length};
  if (const auto* teeth = std::get_if<spatial::Backlash>(&contact)) {
    const double most = teeth->play > 0 ? teeth->play : std::min(teeth->gear.period(), 1.0);
    return {most, teeth->gear.second.angle() ? OverlapScale::angle : OverlapScale::length};
  }
  return {};
}

Vector2d turned(const Scene& scene, BodyId b, const Vector2d& n) {
  const double angle = b < 0 ? 0 : scene.bodies[at(b)].angle;
  return Pose{{0, 0}, angle, std::cos(angle), std::sin(angle)}.turn(n);
}
Vector3d turned(const spatial::Scene& scene, BodyId b, const Vector3d& n) {
  return b < 0 ? n : Vector3d(quaternions::matrix_of(scene.bodies[at(b)].orientation) * n);
}

}  // namespace

bool Admissibility::deep() const {
  return max_overlap > (overlap_scale == OverlapScale::clearance ? kDeepClearance : kDeepBody) * overlap_length;
}

bool Admissibility::energy_off() const { return energy_defect > kDefect * energy_scale; }

std::vector<std::string> warnings_of(const Admissibility& motion) {
  std::vector<std::string> all;
  const auto text = [](double x) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", x);
    return std::string(digits);
  };
  if (motion.deep())
    all.push_back(words_of(motion.overlap_contact, "up to " + text(motion.max_overlap), motion.overlap_scale,
                           text(motion.overlap_length)) +
                  " (t = " + text(motion.overlap_time) + " s): a smaller step overlaps less");
  if (motion.energy_off())
    all.push_back("the energy is off by up to " + text(motion.energy_defect) + " J (t = " +
                  text(motion.energy_defect_time) + " s), " + text(100 * motion.energy_defect / motion.energy_scale) +
                  " % of what was put in or released: a smaller step errs less");
  return all;
}

template <class Space> MotionWatchOf<Space>::MotionWatchOf(const IntegratorOf<Space>& integrator, const State& start,
                                                           const Eigen::VectorXd& gaps)
    : integrator_(integrator), system_(integrator.system()), terms_(system_) {
  const auto& scene = system_.scene();
  if (has_work(system_)) meter_.emplace(system_);
  every_ = meter_ ? 1 : scene.springs.empty() ? 8 : 16;
  const auto keeps = [](const ContactLaw& law) { return !law.frictional() && law.e == 1; };
  const auto damped = [](const auto& spring) {
    return std::visit(
        [](const auto& s) {
          if constexpr (requires { s.quadratic; })
            return true;
          else
            return s.damping != 0;
        },
        spring);
  };
  conserves_ = std::ranges::all_of(system_.laws(), keeps) && std::ranges::none_of(scene.springs, damped) &&
               scene.frictions.empty();
  measure_lengths(gaps);
  start_kinetic_ = peak_kinetic_ = start.v.dot(system_.mass().cwiseProduct(start.v)) / 2;
  start_potential_ = least_potential_ = potential(start);
  start_energy_ = start_kinetic_ + start_potential_;
  const double deepest = floor_.size() > 0 ? -floor_.minCoeff() : 0;
  if (deepest > 0) {  // taking that back is work, against forces whose size is known
    set_poses(system_, start.t, start.q, terms_.at);
    evaluate_forces(system_, start.t, start.v, terms_);
    kick_ = 2 * deepest * terms_.f.template lpNorm<1>();
  }
}

/// Lengths of listed contacts, the smallest clearance and the overlap that no look is needed for.
template <class Space> void MotionWatchOf<Space>::measure_lengths(const Eigen::VectorXd& gaps) {
  const auto& scene = system_.scene();
  floor_ = gaps.head(system_.listed()).cwiseMin(0);
  double far = 0;
  for (const auto& body : scene.bodies) far = std::max(far, body.position.norm());
  const auto body_size = [&](BodyId b) { return b < 0 ? kInf : gyration(scene.bodies[at(b)]); };
  std::map<std::pair<BodyId, BodyId>, std::vector<Walled<Space>>> walls;
  for (int i = 0; i < system_.listed(); ++i) {
    const auto& contact = scene.contacts[at(i)];
    const auto [a, b] = std::visit([](const auto& c) { return bodies_of(c); }, contact);
    const auto of = measured(contact);
    lengths_.push_back({of.size < kInf ? of.size : std::min(body_size(a), body_size(b)), of.scale});
    if (of.wall) walls[{a, b}].push_back({i, turned(scene, b, *of.wall), gaps[i]});
  }
  constexpr std::size_t kMostWalls = 64;
  constexpr double kOpposite = -0.999, kNoPlay = 1e-12;  // less is rounding of the places
  for (const auto& [pair, group] : walls) {
    if (group.size() > kMostWalls) continue;
    for (const auto& one : group)
      for (const auto& other : group) {
        const double play = (one.gap + other.gap) / 2;  // on either side, wherever the body is between them
        if (one.normal.dot(other.normal) > kOpposite || !(play > kNoPlay * (far + lengths_[at(one.contact)].size)))
          continue;
        for (const int c : {one.contact, other.contact})
          if (play < lengths_[at(c)].size) lengths_[at(c)] = {play, OverlapScale::clearance};
      }
  }
  for (const Length& of : lengths_)
    if (of.clearance()) motion_.smallest_clearance = std::min(motion_.smallest_clearance, of.size);
  for (const auto& c : scene.collisions) {
    double least = kInf;
    for (const auto& shape : c.shapes) least = std::min(least, width_of(shape) / 2);
    widths_.push_back(least);
  }
  const auto quick = [&](const Length& of) {
    quick_ = std::min(quick_, of.size * (system_.driven() ? look_at<Space>(integrator_)
                                         : of.clearance() ? kDeepClearance
                                                          : kDeepBody));
  };
  for (const Length& of : lengths_) quick(of);
  for (const double width : widths_) quick({width});
}

template <class Space> typename MotionWatchOf<Space>::Length MotionWatchOf<Space>::length(int contact) const {
  if (contact < system_.listed()) return lengths_[at(contact)];
  const Pair& pair = integrator_.pairs()[at(contact - system_.listed())];
  return pair.none() ? Length{} : Length{widths_[at(pair.collision)]};
}

template <class Space> double MotionWatchOf<Space>::potential(const State& x) {
  double sum = potential_of_weight(system_, x.q);
  if (system_.scene().springs.empty()) return sum;
  set_poses(system_, x.t, x.q, terms_.at);
  for (const auto& spring : system_.scene().springs)
    sum += std::visit([&](const auto& s) { return s.evaluate(terms_.at, x.v.data()).energy; }, spring);
  return sum;
}

/// [J] of the velocities that the applied forces, and rounding of the places, give within h: no scheme knows an energy
/// better.
template <class Space> double MotionWatchOf<Space>::kick(const State& x, double h) {
  if (integrator_.controls_step()) h = std::min(h, kCrossing);
  double mass = 0;
  for (const auto& body : system_.scene().bodies) mass += body.mass;
  const double rounding = kPlaceRounding * x.q.template lpNorm<Eigen::Infinity>() / h;  // [m/s]
  set_poses(system_, x.t, x.q, terms_.at);
  evaluate_forces(system_, x.t, x.v, terms_);
  return h * h / 2 * terms_.f.dot(system_.inverse_mass().cwiseProduct(terms_.f)) + mass / 2 * rounding * rounding;
}

/// [m/s, rad/s] Of a contact's surfaces at the end of a step, with what the step's impulses took from it.
template <class Space> double MotionWatchOf<Space>::surface_speed(const State& x, int contact) {
  set_poses(system_, x.t, x.q, terms_.at);
  terms_.pairs.assign(integrator_.pairs().begin(), integrator_.pairs().end());
  terms_.closed.clear();
  add_closed(system_, contact, terms_);
  const auto& impulse = integrator_.impulses()[at(contact)];
  const auto along = [&](const RowOf<Space>& row, double by) {
    return std::abs(apply(row, x.v.data())) + coupling(row, row, system_.inverse_mass()) * std::abs(by);
  };
  const ContactRowsOf<Space>& rows = terms_.closed[0].rows;
  double speed = along(rows.normal, impulse.normal);
  for (std::size_t k = 0; k < Space::kTangents; ++k)
    speed += along(row_of_tangent(rows, k), tangent_part(impulse.tangent, k));
  return speed;
}

template <class Space> bool MotionWatchOf<Space>::end(Status status, std::string why) {
  status_ = status, why_ = std::move(why);
  return false;
}

template <class Space> std::optional<Jam> MotionWatchOf<Space>::jam(const State& x, double until) {
  if (!search_) search_ = std::make_unique<JamSearchOf<Space>>(system_);
  auto found = search_->find(x, until);
  const State start = system_.initial_state();
  if (!found || found->since > start.t) return found;
  // None was found near x, not even at the start, where there is one: x may be astray.
  return search_->find(start, until);
}

template <class Space> bool MotionWatchOf<Space>::fits(double t, Eigen::VectorXd q) {
  if (!search_) search_ = std::make_unique<JamSearchOf<Space>>(system_);
  return search_->fits(t, q);
}

template <class Space> bool MotionWatchOf<Space>::admits(const State& before, const State& after, double h,
                                                         const StepReport& report, bool last) {
  if (report.penetration > quick_ && !looks_fine(before, after, h)) return false;
  if (meter_) {
    const double work = report.work ? *report.work
                                    : meter_->over_step(before, after, integrator_.impulses(), integrator_.frictions(),
                                                        integrator_.pairs());
    motion_.work += work, effort_ += std::max(std::abs(work), report.effort);
  }
  if (system_.scene().springs.empty()) least_potential_ = std::min(least_potential_, report.least_weight);
  const bool regular = ++steps_ % every_ == 0 || last;
  return (!regular && report.lcp_solves < 2) || balances(after, h, regular);
}

template <class Space> bool MotionWatchOf<Space>::looks_fine(const State& before, const State& after, double h) {
  const Eigen::VectorXd& gaps = integrator_.gaps();
  double worst = 0, share = 0;  // o / L; in units of what ends a run
  int deepest = -1;
  for (int i = 0; i < gaps.size(); ++i) {
    const double over = (i < system_.listed() ? floor_[i] : 0) - gaps[i];
    if (!(over > 0)) continue;
    const Length of = length(i);
    const double part = over / of.size / (of.clearance() ? kOutOfClearance : kIntoBody);
    if (part > share) share = part, worst = over, deepest = i;
  }
  if (deepest < 0) return true;
  const Length of = length(deepest);
  if (worst * motion_.overlap_length > motion_.max_overlap * of.size || motion_.max_overlap == 0) {
    motion_.max_overlap = worst, motion_.overlap_length = of.size, motion_.overlap_time = after.t;
    motion_.overlap_contact = contact_name<Space>(system_, integrator_.pairs(), deepest);
    motion_.overlap_scale = of.scale;
  }
  if (system_.driven() && worst > look_at<Space>(integrator_) * of.size &&
      (worst > kGrown * looked_ || steps_ >= looked_at_ + kLooks)) {
    looked_ = worst, looked_at_ = steps_;
    if (!fits(after.t, after.q))
      if (const auto found = jam(before, after.t)) return end(Status::infeasible, words(*found));
  }
  const bool fixed = !integrator_.controls_step();
  if (fixed && of.clearance()) fastest_ = std::max(fastest_, surface_speed(after, deepest));
  if (share <= 1) return true;
  double v = fastest_;
  if (fixed && !of.clearance()) {
    peak_kinetic_ = std::max(peak_kinetic_, after.v.dot(system_.mass().cwiseProduct(after.v)) / 2);
    const auto [a, b] = bodies_of(system_, {integrator_.pairs().begin(), integrator_.pairs().end()}, deepest);
    double light = kInf;
    for (const BodyId body : {a, b})
      if (body >= 0) light = std::min(light, system_.scene().bodies[at(body)].mass);
    v = std::sqrt(2 * peak_kinetic_ / light);
  }
  if (fixed && worst <= kWays * h * v) return true;
  return end(
      Status::numerical_error,
      words_of(motion_.overlap_contact, detail::text_of(worst), of.scale, detail::text_of(of.size)) + since(after.t));
}

template <class Space> double MotionWatchOf<Space>::Rise::add(double D) {
  const double rise = D - lowest;
  lowest = std::min(lowest, std::max({D, last[0], last[1]}));  // an impact may take two steps, and dip between them
  last[1] = last[0], last[0] = D;
  return rise;
}

template <class Space> bool MotionWatchOf<Space>::balances(const State& after, double h, bool regular) {
  const double kinetic = after.v.dot(system_.mass().cwiseProduct(after.v)) / 2, now = potential(after);
  peak_kinetic_ = std::max(peak_kinetic_, kinetic), least_potential_ = std::min(least_potential_, now);
  const double D = kinetic + now - motion_.work - start_energy_;
  const double ends = !regular ? 0 : conserves_ ? std::abs(D) : rise_.add(D), rise = std::max(between_.add(D), ends);
  motion_.energy_scale = start_kinetic_ + start_potential_ - least_potential_ + effort_ + kick_;
  if (rise > motion_.energy_defect)
    motion_.energy_defect = rise, motion_.energy_defect_time = after.t;
  else if (!(ends > kMostDefect * motion_.energy_scale))
    return !std::isnan(rise) || end(Status::numerical_error, "the energy is NaN");
  if (rise <= kDefect * motion_.energy_scale) return true;
  motion_.energy_scale -= kick_;
  kick_ = std::max(kick_, kick(after, h) + kRounded * (std::abs(start_potential_) + std::abs(now)));
  motion_.energy_scale += kick_;
  if (ends <= kMostDefect * motion_.energy_scale || (conserves_ && D < 0)) return true;
  return end(Status::numerical_error,
             "the energy rose by " + detail::text_of(ends) + " J, which nothing in the scene put in" + since(after.t));
}

template <class Space> bool MotionWatchOf<Space>::explains(const State& x, double h, Status status) {
  if (status == Status::time_limit || status == Status::cancelled) return false;
  if (!system_.driven()) return false;
  // It may begin at the very end of the step, by rounding; friction may hold the mechanism somewhat before.
  const double soon = std::max(3 * h, kSoon * x.t);
  const auto found = jam(x, x.t + soon);
  if (!found) return false;
  return !end(Status::infeasible, words(*found));
}

template <class Space> void MotionWatchOf<Space>::remember(CheckpointData& memory) {
  memory(motion_, looked_, steps_, looked_at_, start_energy_, start_kinetic_, start_potential_, least_potential_,
         peak_kinetic_, fastest_, effort_, rise_.lowest, rise_.last, between_.lowest, between_.last, kick_, floor_);
  if (meter_) meter_->forget();
}

template class MotionWatchOf<Planar>;
template class MotionWatchOf<Spatial>;

}  // namespace orthant
