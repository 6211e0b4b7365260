#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/system.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/mechanics/scene/expose.h>
#include <orthant/core/support/disjoint_sets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

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
    body.principal = body.to_axes == spatial::Matrix3d::Identity();
  }
  for (spatial::Joint& joint : scene.joints)
    std::visit(
        [](auto& j) {
          if constexpr (requires { j.across; }) {
            const Vector3d& axis = spatial::axis_of(j);
            if (!spatial::square_to(axis, j.across)) j.across = spatial::perpendicular(axis);
          }
        },
        joint);
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

/// The farthest point of an element, or its radius, in a body's frame. [m]
template <class Element> double extent(const Element& e) {
  double most = 0;
  const auto take = [&](const Polygon& points) {
    for (const Vector2d& p : points) most = std::max(most, p.lpNorm<Eigen::Infinity>());
  };
  if constexpr (requires { e.of.kind(); }) most = std::visit([](const auto& c) { return extent(c); }, e.of.kind());
  if constexpr (requires { e.point_a.norm(); }) take({e.point_a, e.point_b});
  if constexpr (requires { e.centre_a.norm(); }) take({e.centre_a, e.centre_b});
  if constexpr (requires { e.centre.norm(); }) take({e.centre});
  if constexpr (requires { e.wall_point.norm(); }) take({e.wall_point});
  if constexpr (requires { e.point.norm(); }) take({e.point});
  if constexpr (requires { e.corners_a.size(); }) take(e.corners_a), take(e.corners_b);
  if constexpr (requires { e.corners.size(); }) take(e.corners);
  if constexpr (requires { e.points.size(); }) take(e.points);
  if constexpr (requires { e.radius_a; }) most = std::max({most, e.radius_a, e.radius_b});
  if constexpr (std::is_same_v<Element, Shape>)
    most = std::max(most, e.corners.empty() ? e.radius : 0);
  else if constexpr (requires { e.radius; })
    most = std::max(most, e.radius);
  return most;
}

/// See length_unit(). Custom elements have lengths of their own, which nobody knows here.
double unit_of(const Scene& scene) {
  constexpr double kSmall = 0x1p-6;  // [m]
  double size = 0;
  bool custom = false;
  const auto take = [&](const auto& element) { size = std::max(size, extent(element)); };
  const auto each = [&](const auto& elements) {
    for (const auto& one : elements) {
      std::visit(take, one);
      custom = custom || std::visit(
                             [](const auto& e) {
                               using E = std::decay_t<decltype(e)>;
                               return std::is_same_v<E, CustomJoint> || std::is_same_v<E, CustomContact>;
                             },
                             one);
    }
  };
  for (const Body& body : scene.bodies) size = std::max(size, body.position.lpNorm<Eigen::Infinity>());
  each(scene.joints), each(scene.contacts), each(scene.springs);
  for (const Load& load : scene.loads) take(load);
  for (const Collision& collision : scene.collisions)
    for (const auto& shape : collision.shapes) take(shape);
  return custom || !(size > 0 && size < kSmall) ? 1 : std::exp2(std::floor(std::log2(size)));
}
double unit_of(const spatial::Scene& /*scene*/) { return 1; }

/// Of a contact's speeds: 1 of an angle's.
double unit_of(const Contact& contact, double length) {
  const auto* limit = std::get_if<Limit>(&contact);
  return limit != nullptr && std::holds_alternative<Angle>(limit->of) ? 1 : length;
}
double unit_of(const spatial::Contact& /*contact*/, double /*length*/) { return 1; }

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
  length_unit_ = unit_of(scene_);
  for (const auto& contact : scene_.contacts) {
    ContactLaw law = std::visit([](const auto& c) { return c.law; }, contact);
    law.unit = unit_of(contact, length_unit_);
    laws_.add(law);
  }
  for (const auto& c : scene_.collisions) {
    const auto shapes = static_cast<double>(c.shapes.size());
    const double pairs = std::min(c.neighbours * shapes, kPlanar<Space> ? shapes * (shapes - 1)  // of two points each
                                                                        : shapes * (shapes - 1) / 2);
    const double most = std::ceil(pairs * most_points(c));
    if (most > 1e8) throw std::invalid_argument("collision \"" + c.name + "\": too many neighbours and shapes");
    pairs_.push_back(pairs_.back() + static_cast<int>(most));
    ContactLaw law = c.law;
    law.unit = length_unit_;
    laws_.add_many(law, static_cast<int>(most));
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
