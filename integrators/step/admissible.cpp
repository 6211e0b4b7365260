#include <orthant/core/support/options.h>
#include <orthant/integrators/step/admissible.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace orthant {
namespace {

constexpr double kDeepClearance = 0.5, kDeepBody = 0.1;  // of a contact's length: reported
constexpr double kOutOfClearance = 10, kIntoBody = 0.5;  // likewise: the run ends
constexpr double kLook = 0.05;                           // likewise, of driven scenes: a jam is searched for
constexpr double kWays = 3;                              // ways of a step that a scheme of fixed step may overlap by
constexpr double kDefect = 0.05, kMostDefect = 1;        // of the energy's scale: reported; the run ends
constexpr double kGrown = 1.2;                           // of the overlap at the last look: looked at again
constexpr long kLooks = 256;                             // steps after which it is looked at in any case
constexpr double kRounded = 1e-12;                       // of the energies that differences are taken of
constexpr double kOfPlaces = 1e-15;                      // of the coordinates: their rounding
constexpr double kSoon = 1e-3;                           // of the time: a jam that near explains a failed step
constexpr double kCrossing = 1e-4;                       // [s] the longest of a scheme that divides its step

/// Half the distance of the nearest parallel lines that have the polygon between them.
double half_width(const Polygon& corners) {
  double least = kInf;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    double high = 0;
    const Vector2d normal = outward(corners, i);
    for (const Vector2d& corner : corners) high = std::max(high, std::abs(normal.dot(corner - corners[i])));
    least = std::min(least, high / 2);
  }
  return least;
}

/// overlap and length: numbers as texts [m, rad].
std::string words_of(const std::string& contact, const std::string& overlap, OverlapScale scale,
                     const std::string& length) {
  if (scale == OverlapScale::angle) return "the limit of contact " + contact + " is exceeded by " + overlap + " rad";
  return "bodies overlap by " + overlap + " m at contact " + contact + ", where " +
         (scale == OverlapScale::clearance ? "the clearance is " : "the thinner body's half width is ") + length + " m";
}

struct Walled {  // a contact with a wall: its normal at the start, in the world
  int contact;
  Vector2d normal;
  double gap;
};

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

MotionWatch::MotionWatch(const Integrator& integrator, const State& start, const Eigen::VectorXd& gaps)
    : integrator_(integrator), system_(integrator.system()), terms_(system_) {
  const Scene& scene = system_.scene();
  if (WorkMeter::needed(system_)) meter_.emplace(system_);
  every_ = meter_ ? 1 : scene.springs.empty() ? 8 : 16;
  const auto keeps = [](const ContactLaw& law) { return !law.frictional() && law.e == 1; };
  const auto damped = [](const Spring& spring) {
    return std::visit([](const auto& s) { return s.damping != 0; }, spring);
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
    kick_ = 2 * deepest * terms_.f.lpNorm<1>();
  }
}

/// Lengths of listed contacts, the smallest clearance and the overlap that no look is needed for.
void MotionWatch::measure_lengths(const Eigen::VectorXd& gaps) {
  const Scene& scene = system_.scene();
  floor_ = gaps.head(system_.listed()).cwiseMin(0);
  double far = 0;
  for (const Body& body : scene.bodies) far = std::max(far, body.position.norm());
  const auto body_size = [&](BodyId b) {  // radius of gyration
    return b < 0 ? kInf : std::sqrt(scene.bodies[at(b)].inertia / scene.bodies[at(b)].mass);
  };
  std::map<std::pair<BodyId, BodyId>, std::vector<Walled>> walls;
  for (int i = 0; i < system_.listed(); ++i) {
    const Contact& contact = scene.contacts[at(i)];
    const auto [a, b] = std::visit([](const auto& c) { return bodies_of(c); }, contact);
    Length& of = lengths_.emplace_back(Length{std::min(body_size(a), body_size(b))});
    const auto turned = [&, b = b](const Vector2d& n) {
      const double angle = b < 0 ? 0 : scene.bodies[at(b)].angle;
      return Pose{{0, 0}, angle, std::cos(angle), std::sin(angle)}.turn(n);
    };
    if (const auto* journal = std::get_if<Journal>(&contact)) {
      of = {journal->radius_b - journal->radius_a, OverlapScale::clearance};
    } else if (const auto* d = std::get_if<DiscDisc>(&contact)) {
      of.size = std::min(d->radius_a, d->radius_b);
    } else if (const auto* w = std::get_if<DiscWall>(&contact)) {
      of.size = w->radius;
      walls[{a, b}].push_back({i, turned(w->normal), gaps[i]});
    } else if (const auto* c = std::get_if<CornerWall>(&contact)) {
      walls[{a, b}].push_back({i, turned(c->normal), gaps[i]});
    } else if (const auto* p = std::get_if<DiscPolygon>(&contact)) {
      of.size = std::min(p->radius, half_width(p->corners));
    } else if (const auto* pp = std::get_if<PolygonPolygon>(&contact)) {
      of.size = std::min(half_width(pp->corners_a), half_width(pp->corners_b));
    } else if (const auto* limit = std::get_if<Limit>(&contact)) {
      if (std::holds_alternative<Angle>(limit->of.kind())) of = {1, OverlapScale::angle};
    }
  }
  constexpr std::size_t kMostWalls = 64;
  constexpr double kOpposite = -0.999, kNoPlay = 1e-12;  // less is rounding of the places
  for (const auto& [pair, group] : walls) {
    if (group.size() > kMostWalls) continue;
    for (const Walled& one : group)
      for (const Walled& other : group) {
        const double play = (one.gap + other.gap) / 2;  // on either side, wherever the body is between them
        if (one.normal.dot(other.normal) > kOpposite || !(play > kNoPlay * (far + lengths_[at(one.contact)].size)))
          continue;
        for (const int c : {one.contact, other.contact})
          if (play < lengths_[at(c)].size) lengths_[at(c)] = {play, OverlapScale::clearance};
      }
  }
  for (const Length& of : lengths_)
    if (of.clearance()) motion_.smallest_clearance = std::min(motion_.smallest_clearance, of.size);
  for (const Collision& c : scene.collisions) {
    double least = kInf;
    for (const Shape& s : c.shapes) least = std::min(least, s.corners.empty() ? s.radius : half_width(s.corners));
    widths_.push_back(least);
  }
  const auto quick = [&](const Length& of) {
    quick_ = std::min(quick_, of.size * (system_.driven() ? kLook : of.clearance() ? kDeepClearance : kDeepBody));
  };
  for (const Length& of : lengths_) quick(of);
  for (const double width : widths_) quick({width});
}

MotionWatch::Length MotionWatch::length(int contact) const {
  if (contact < system_.listed()) return lengths_[at(contact)];
  const Pair& pair = integrator_.pairs()[at(contact - system_.listed())];
  return pair.none() ? Length{} : Length{widths_[at(pair.collision)]};
}

double MotionWatch::potential(const State& x) {
  double sum = -system_.weight().dot(x.q);
  if (system_.scene().springs.empty()) return sum;
  set_poses(system_, x.t, x.q, terms_.at);
  for (const Spring& spring : system_.scene().springs)
    sum += std::visit([&](const auto& s) { return s.evaluate(terms_.at, x.v.data()).energy; }, spring);
  return sum;
}

/// [J] of the velocities that the applied forces, and rounding of the places, give within h: no scheme knows an energy
/// better.
double MotionWatch::kick(const State& x, double h) {
  if (integrator_.controls_step()) h = std::min(h, kCrossing);
  double mass = 0;
  for (const Body& body : system_.scene().bodies) mass += body.mass;
  const double rounding = kOfPlaces * x.q.lpNorm<Eigen::Infinity>() / h;  // [m/s]
  set_poses(system_, x.t, x.q, terms_.at);
  evaluate_forces(system_, x.t, x.v, terms_);
  return h * h / 2 * terms_.f.dot(system_.inverse_mass().cwiseProduct(terms_.f)) + mass / 2 * rounding * rounding;
}

/// [m/s, rad/s] Of a contact's surfaces at the end of a step, with what the step's impulses took from it.
double MotionWatch::surface_speed(const State& x, int contact) {
  set_poses(system_, x.t, x.q, terms_.at);
  terms_.pairs.assign(integrator_.pairs().begin(), integrator_.pairs().end());
  terms_.closed.clear();
  add_closed(system_, contact, terms_);
  const Impulse& impulse = integrator_.impulses()[at(contact)];
  const auto along = [&](const Row& row, double by) {
    return std::abs(apply(row, x.v.data())) + coupling(row, row, system_.inverse_mass()) * std::abs(by);
  };
  const ContactRows& rows = terms_.closed[0].rows;
  return along(rows.normal, impulse.normal) + along(rows.tangent, impulse.tangent);
}

bool MotionWatch::end(Status status, std::string why) {
  status_ = status, why_ = std::move(why);
  return false;
}

JamSearch& MotionWatch::search() {
  if (!search_) search_ = std::make_unique<JamSearch>(system_);
  return *search_;
}

bool MotionWatch::admits(const State& before, const State& after, double h, const StepReport& report, bool last) {
  if (report.penetration > quick_ && !looks_fine(before, after, h)) return false;
  if (meter_) {
    const double work = report.work ? *report.work
                                    : meter_->over_step(before, after, integrator_.impulses(), integrator_.frictions(),
                                                        integrator_.pairs());
    motion_.work += work, effort_ += std::abs(work);
  }
  const bool regular = ++steps_ % every_ == 0 || last;
  return (!regular && report.lcp_solves < 2) || balances(after, h, regular);
}

bool MotionWatch::looks_fine(const State& before, const State& after, double h) {
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
    motion_.overlap_contact = contact_name(system_, integrator_.pairs(), deepest);
    motion_.overlap_scale = of.scale;
  }
  if (system_.driven() && worst > kLook * of.size && (worst > kGrown * looked_ || steps_ >= looked_at_ + kLooks)) {
    looked_ = worst, looked_at_ = steps_;
    Eigen::VectorXd q = after.q;
    if (!search().fits(after.t, q))
      if (const auto jam = search().find(before, after.t)) return end(Status::infeasible, words(*jam));
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

double MotionWatch::Rise::add(double D) {
  const double rise = D - lowest;
  lowest = std::min(lowest, std::max({D, last[0], last[1]}));  // an impact may take two steps, and dip between them
  last[1] = last[0], last[0] = D;
  return rise;
}

bool MotionWatch::balances(const State& after, double h, bool regular) {
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

bool MotionWatch::explains(const State& x, double h, Status status) {
  if (status == Status::time_limit || status == Status::cancelled) return false;
  if (!system_.driven()) return false;
  // It may begin at the very end of the step, by rounding; friction may hold the mechanism somewhat before.
  const double soon = std::max(3 * h, kSoon * x.t);
  const auto jam = search().find(x, x.t + soon);
  if (!jam) return false;
  return !end(Status::infeasible, words(*jam));
}

void MotionWatch::remember(Memory& memory) {
  memory(motion_, looked_, steps_, looked_at_, start_energy_, start_kinetic_, start_potential_, least_potential_,
         peak_kinetic_, fastest_, effort_, rise_.lowest, rise_.last, between_.lowest, between_.last, kick_, floor_);
  if (meter_) meter_->forget();
}

}  // namespace orthant
