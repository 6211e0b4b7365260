#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/scene/expose.h>
#include <orthant/core/support/disjoint_sets.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

void prepare(Scene& scene, Examined examined) {
  if (examined == Examined::no) check(scene);
  if (scene.assemble) scene = assembled(scene);
  expose(scene);
}
void prepare(spatial::Scene& scene, Examined examined) {
  if (examined == Examined::no) spatial::check(scene);
  if (scene.assemble) scene = assembled(scene);
  for (spatial::Body& body : scene.bodies) {
    body.axes = spatial::principal(body.inertia).axes;
    body.to_axes = quaternions::matrix_of(body.axes).transpose();
  }
  for (spatial::Collision& collision : scene.collisions) spatial::set_hulls(collision);
}

/// Contacts of a shape that is near one other.
int most_points(const Collision& /*c*/) { return 1; }  // `neighbours` counts the two points of polygons as two

void set_mass(Eigen::VectorXd& mass, int i, const Body& body) { block(mass, i) << body.mass, body.mass, body.inertia; }
void set_mass(Eigen::VectorXd& mass, int i, const spatial::Body& body) {
  translation<Spatial>(mass, i).setConstant(body.mass);
  rotation<Spatial>(mass, i) = spatial::principal(body.inertia).moments;
}

void set_start(State& x, int i, const Body& body) {
  block(x.q, i) << body.position, body.angle;
  block(x.v, i) << body.velocity, body.omega;
}
void set_start(State& x, int i, const spatial::Body& body) {
  place_of<Spatial>(x.q, i) = body.position;
  quaternion(x.q, i) = quaternions::product(body.orientation.normalized(), body.axes);
  translation<Spatial>(x.v, i) = body.velocity;
  rotation<Spatial>(x.v, i) = quaternions::matrix_of(quaternion(x.q, i)).transpose() * body.omega;
}

}  // namespace

template <class Space> SystemOf<Space>::SystemOf(Scene scene, Examined examined) : scene_(std::move(scene)) {
  prepare(scene_, examined);
  DisjointSets groups(scene_.bodies.size());
  const auto join = [&](BodyId a, BodyId b) {  // the ground connects nothing
    if (a >= 0 && b >= 0) groups.join(a, b);
  };
  const auto connect = [&](const auto& element) {
    const auto [a, b] = bodies_of(element);
    join(a, b);
  };
  for (const auto& joint : scene_.joints) std::visit(connect, joint);
  for (const auto& spring : scene_.springs) std::visit(connect, spring);
  assembly_ = groups.first();
  for (const auto& contact : scene_.contacts) std::visit(connect, contact);
  for (const auto& friction : scene_.frictions) connect(friction);
  for (const auto& collision : scene_.collisions) {
    BodyId last = kGround;
    for (const auto& shape : collision.shapes) {
      join(last, shape.body);
      if (shape.body >= 0) last = shape.body;
    }
  }
  cluster_ = groups.first();
  mass_.resize(dof());
  weight_.setZero(dof());
  for (int i = 0; i < bodies(); ++i) {
    const auto& body = scene_.bodies[static_cast<std::size_t>(i)];
    set_mass(mass_, i, body);
    translation<Space>(weight_, i) = body.mass * scene_.gravity;
  }
  inverse_mass_ = mass_.cwiseInverse();
  for (const auto& joint : scene_.joints) {
    first_row_.push_back(joint_rows_);
    joint_rows_ += row_count(joint);
    driven_ = driven_ || orthant::driven(joint);
    if (const auto* drive = std::get_if<typename ElementsOf<Space>::Drive>(&joint)) {
      const std::vector<double>& times = drive->law.table.times();
      breakpoints_.insert(breakpoints_.end(), times.begin(), times.end());
      if (drive->law.amplitude != 0) swing_ = std::max(swing_, std::abs(drive->law.omega));
    }
  }
  for (const auto& contact : scene_.contacts) laws_.push_back(std::visit([](const auto& c) { return c.law; }, contact));
  for (const auto& c : scene_.collisions) {
    const auto shapes = static_cast<double>(c.shapes.size());
    const double pairs = std::min(c.neighbours * shapes, kPlanar<Space> ? shapes * (shapes - 1)  // of two points each
                                                                        : shapes * (shapes - 1) / 2);
    const double most = std::ceil(pairs * most_points(c));
    if (most > 1e8) throw std::invalid_argument("collision \"" + c.name + "\": too many neighbours and shapes");
    pairs_.push_back(pairs_.back() + static_cast<int>(most));
    laws_.resize(static_cast<std::size_t>(contacts()), c.law);
  }
  for (const auto& load : scene_.loads) {
    breakpoints_.insert(breakpoints_.end(), load.breakpoints.begin(), load.breakpoints.end());
    swing_ = std::max(swing_, load.omega);
  }
  std::sort(breakpoints_.begin(), breakpoints_.end());
}

template <class Space> double SystemOf<Space>::next_breakpoint(double t) const {
  const auto next = std::upper_bound(breakpoints_.begin(), breakpoints_.end(), t);
  return next == breakpoints_.end() ? std::numeric_limits<double>::infinity() : *next;
}

template <class Space> State SystemOf<Space>::initial_state() const {
  State x{.t = 0, .q = Eigen::VectorXd(coordinates()), .v = Eigen::VectorXd(dof())};
  for (int i = 0; i < bodies(); ++i) set_start(x, i, scene_.bodies[static_cast<std::size_t>(i)]);
  return x;
}

template <class Space> double potential_of_weight(const SystemOf<Space>& system, const Eigen::VectorXd& q) {
  if constexpr (kPlanar<Space>) {
    return -system.weight().dot(q);
  } else {
    double sum = 0;
    for (int i = 0; i < system.bodies(); ++i) sum -= translation<Space>(system.weight(), i).dot(place_of<Space>(q, i));
    return sum;
  }
}

template <class Space> double energy(const SystemOf<Space>& system, const State& state) {
  const double kinetic = 0.5 * state.v.dot(system.mass().cwiseProduct(state.v));
  double sum = kinetic + potential_of_weight(system, state.q);
  if (system.scene().springs.empty()) return sum;
  KinematicsOf<Space> at;
  set_poses(system, state.t, state.q, at);
  for (const auto& spring : system.scene().springs)
    sum += std::visit([&](const auto& s) { return s.evaluate(at, state.v.data()).energy; }, spring);
  return sum;
}

template class SystemOf<Planar>;
template class SystemOf<Spatial>;
template double potential_of_weight(const SystemOf<Planar>&, const Eigen::VectorXd&);
template double potential_of_weight(const SystemOf<Spatial>&, const Eigen::VectorXd&);
template double energy(const SystemOf<Planar>&, const State&);
template double energy(const SystemOf<Spatial>&, const State&);

}  // namespace orthant
