#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/scene/expose.h>
#include <orthant/core/support/disjoint_sets.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
System::System(Scene scene) : scene_(std::move(scene)) {
  check(scene_);
  if (scene_.assemble) scene_ = assembled(scene_);
  expose(scene_);
  DisjointSets groups(scene_.bodies.size());
  const auto join = [&](BodyId a, BodyId b) {  // the ground connects nothing
    if (a >= 0 && b >= 0) groups.join(a, b);
  };
  const auto connect = [&](const auto& element) {
    const auto [a, b] = bodies_of(element);
    join(a, b);
  };
  for (const Joint& joint : scene_.joints) std::visit(connect, joint);
  for (const Spring& spring : scene_.springs) std::visit(connect, spring);
  assembly_ = groups.first();
  for (const Contact& contact : scene_.contacts) std::visit(connect, contact);
  for (const JointFriction& friction : scene_.frictions) connect(friction);
  for (const Collision& collision : scene_.collisions) {
    BodyId last = kGround;
    for (const Shape& shape : collision.shapes) {
      join(last, shape.body);
      if (shape.body >= 0) last = shape.body;
    }
  }
  cluster_ = groups.first();
  mass_.resize(dof());
  weight_.setZero(dof());
  for (int i = 0; i < bodies(); ++i) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(i)];
    block(mass_, i) << body.mass, body.mass, body.inertia;
    translation(weight_, i) = body.mass * scene_.gravity;
  }
  inverse_mass_ = mass_.cwiseInverse();
  for (const Joint& joint : scene_.joints) {
    first_row_.push_back(joint_rows_);
    joint_rows_ += row_count(joint);
    driven_ = driven_ || orthant::driven(joint);
    if (const auto* drive = std::get_if<Drive>(&joint)) {
      const std::vector<double>& times = drive->law.table.times();
      breakpoints_.insert(breakpoints_.end(), times.begin(), times.end());
      if (drive->law.amplitude != 0) swing_ = std::max(swing_, std::abs(drive->law.omega));
    }
  }
  for (const Contact& contact : scene_.contacts)
    laws_.push_back(std::visit([](const auto& c) { return c.law; }, contact));
  for (const Collision& c : scene_.collisions) {
    const auto shapes = static_cast<double>(c.shapes.size());
    const double most =
        std::ceil(std::min(c.neighbours * shapes, shapes * (shapes - 1)));  // all pairs, two points each
    if (most > 1e8) throw std::invalid_argument("collision \"" + c.name + "\": too many neighbours and shapes");
    pairs_.push_back(pairs_.back() + static_cast<int>(most));
    laws_.resize(static_cast<std::size_t>(contacts()), c.law);
  }
  for (const Load& load : scene_.loads) {
    breakpoints_.insert(breakpoints_.end(), load.breakpoints.begin(), load.breakpoints.end());
    swing_ = std::max(swing_, load.omega);
  }
  std::sort(breakpoints_.begin(), breakpoints_.end());
}

double System::next_breakpoint(double t) const {
  const auto next = std::upper_bound(breakpoints_.begin(), breakpoints_.end(), t);
  return next == breakpoints_.end() ? std::numeric_limits<double>::infinity() : *next;
}

State System::initial_state() const {
  State x{.t = 0, .q = Eigen::VectorXd(dof()), .v = Eigen::VectorXd(dof())};
  for (int i = 0; i < bodies(); ++i) {
    const Body& body = scene_.bodies[static_cast<std::size_t>(i)];
    block(x.q, i) << body.position, body.angle;
    block(x.v, i) << body.velocity, body.omega;
  }
  return x;
}

double energy(const System& system, const State& state) {
  double sum = 0.5 * state.v.dot(system.mass().cwiseProduct(state.v)) - system.weight().dot(state.q);
  if (system.scene().springs.empty()) return sum;
  Kinematics at;
  set_poses(system, state.t, state.q, at);
  for (const Spring& spring : system.scene().springs)
    sum += std::visit([&](const auto& s) { return s.evaluate(at, state.v.data()).energy; }, spring);
  return sum;
}

}  // namespace orthant
