#include <orthant/core/mechanics/scene/element_check.h>
#include <orthant/core/mechanics/spatial/alignment.h>
#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/support/disjoint_sets.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <type_traits>

namespace orthant::spatial {
namespace {

constexpr double kRounding = 1e-9;  // of the largest moment of inertia
constexpr double kUnit = ElementCheck<Scene>::kUnit;
constexpr double kSameAxis = 1e-6;  // [rad] between axes that count as parallel
constexpr double kSingular = 1e-3;  // [rad] from parallel: axes that should be at right angles cannot be moved there

/// One element of a scene in space.
class SpatialElement : public ElementCheck<Scene> {
 public:
  using ElementCheck::ElementCheck;

  void law(const ContactLaw& law) const {
    for (const auto& [field, mu] : {std::pair{"mu", law.mu}, std::pair{"mu_static", law.mu_static}})
      friction(field, mu);
    require(law.mu_static == 0 || law.mu_static >= law.mu, "mu_static", law.mu_static, ">= mu = " + text(law.mu));
    require(law.e >= 0 && law.e <= 1, "e_n", law.e, "in [0, 1]");
    require(law.e_t >= -1 && law.e_t <= 1, "e_t", law.e_t, "in [-1, 1]");
    require(law.belt == 0, "belt", law.belt, "0: it is planar only, in space a surface has a velocity and an omega");
    const SurfaceLaw& s = law.surface;
    not_negative("rolling", s.rolling), not_negative("spinning", s.spinning), friction("mu_across", s.mu_across);
    if (s.orthotropic()) require(law.mu > 0, "mu", law.mu, "> 0 where mu_across is");
    if (s.orthotropic() || !s.direction.isZero(0)) unit("direction", s.direction);
    finite("velocity", s.velocity), finite("omega", s.omega), finite("centre", s.centre);
    require(!s.turns() || (scene_.restitution == Restitution::newton && scene_.impacts == Impacts::simultaneous),
            s.rolling > 0 ? "rolling" : "spinning", s.rolling > 0 ? s.rolling : s.spinning,
            "0 where restitution is not newton, or impacts are not simultaneous");
  }
};

void examine(const SpatialElement& e, const Body& b) {
  if (b.name == "ground") e.fail("name", "name = \"ground\": must not be ground, which is always there");
  e.invertible("mass", b.mass);
  e.finite("inertia", b.inertia);
  const double most = b.inertia.cwiseAbs().maxCoeff();
  e.require((b.inertia - b.inertia.transpose()).cwiseAbs().maxCoeff() <= kRounding * most, "inertia",
            b.inertia.reshaped(), "symmetric");
  const Vector3d J = principal(b.inertia).moments;
  e.require(J.minCoeff() >= SpatialElement::kLeastMass, "inertia", J, "positive in its principal axes");
  e.require(2 * J.maxCoeff() <= J.sum() + kRounding * most, "inertia", J,
            "that of a body: no principal moment larger than the sum of the others");
  e.finite("position", b.position), e.unit("orientation", b.orientation);
  e.finite("velocity", b.velocity), e.finite("omega", b.omega);
}

/// Whatever of these fields an element has.
template <class T> void examine_places(const SpatialElement& e, const T& x) {
  e.pair(x.a, x.b);
  if constexpr (requires { x.point_a; }) e.finite("point_a", x.point_a), e.finite("point_b", x.point_b);
  if constexpr (requires { x.axis; }) e.unit("axis", x.axis);
  if constexpr (requires { x.axis_a; }) e.unit("axis_a", x.axis_a), e.unit("axis_b", x.axis_b);
  if constexpr (std::is_same_v<T, SphereBush>) e.unit("axis_b", x.axis_b);
  if constexpr (requires { x.orientation; }) e.unit("orientation", x.orientation);
  if constexpr (requires { x.reference_a; }) {
    const auto square = [&](const char* field, const Vector3d& reference, const Vector3d& axis) {
      if (reference.isZero(0)) return;
      e.unit(field, reference);
      e.require(std::abs(reference.dot(axis)) <= kUnit, field, reference, "at right angles to the axis");
    };
    square("reference_a", x.reference_a, x.axis_a), square("reference_b", x.reference_b, x.axis_b);
  }
}
void examine_coordinate(const SpatialElement& e, const Coordinate& c) {
  std::visit([&](const auto& of) { examine_places(e, of); }, c.kind());
}

/// A plane can only move along itself, and be rougher in a direction that lies in it.
void examine_surface(const SpatialElement& e, const SurfaceLaw& s, const Vector3d& normal) {
  e.require(std::abs(s.velocity.dot(normal)) <= kSameAxis * s.velocity.norm(), "velocity", s.velocity,
            "along the wall: the surface moves along itself");
  e.require(s.omega.cross(normal).norm() <= kSameAxis * s.omega.norm(), "omega", s.omega,
            "along the wall's normal: the surface moves along itself");
  e.require(!s.orthotropic() || s.direction.cross(normal).norm() > kSameAxis, "direction", s.direction,
            "a direction along the wall, not its normal");
}

template <class T> void examine(const SpatialElement& e, const T& x) {
  if constexpr (requires { x.of; })
    examine_coordinate(e, x.of);
  else if constexpr (std::is_same_v<T, Backlash>)
    examine_coordinate(e, x.gear.first), examine_coordinate(e, x.gear.second);
  else
    examine_places(e, x);
  if constexpr (std::is_same_v<T, Distance>) e.positive("length", x.length);
  if constexpr (std::is_same_v<T, Drive>) {
    e.finite("offset", x.law.offset), e.finite("rate", x.law.rate_of_change), e.finite("amplitude", x.law.amplitude);
    e.finite("omega", x.law.omega), e.finite("phase", x.law.phase);
  }
  if constexpr (requires { x.stiffness; }) {
    e.not_negative("stiffness", x.stiffness), e.not_negative("damping", x.damping), e.finite("rest", x.rest);
  }
  if constexpr (std::is_same_v<T, Drag>) {
    e.not_negative("damping", x.damping), e.not_negative("quadratic", x.quadratic), e.finite("point", x.point);
    if (x.a == kGround) e.fail("body", "body = \"ground\": must be a body that moves");
  }
  if constexpr (std::is_same_v<T, JointFriction>) e.not_negative("bound", x.bound);
  if constexpr (requires { x.plane_point; }) {
    e.finite("centre", x.centre), e.finite("plane_point", x.plane_point), e.unit("normal", x.normal);
  }
  if constexpr (requires { x.plane_point, x.law; }) examine_surface(e, x.law.surface, x.normal);
  if constexpr (std::is_same_v<T, SpherePlane>) e.not_negative("radius", x.radius);
  if constexpr (std::is_same_v<T, RimPlane>)
    e.positive("radius", x.radius), e.not_negative("tube", x.tube), e.finite("phase", x.phase);
  if constexpr (std::is_same_v<T, EllipsoidPlane>) {
    e.finite("semi_axes", x.semi_axes);
    e.require(x.semi_axes.minCoeff() > 0, "semi_axes", x.semi_axes, "> 0");
  }
  if constexpr (requires { x.radius_a; }) {
    e.finite("centre_a", x.centre_a), e.finite("centre_b", x.centre_b);
    e.positive("radius_a", x.radius_a), e.positive("radius_b", x.radius_b);
  }
  if constexpr (requires { x.rim_of_pin; }) e.finite("along", x.along);
  if constexpr (std::is_same_v<T, Screw>) {
    e.finite("pitch", x.pitch), e.require(x.pitch != 0, "pitch", x.pitch, "not 0"), e.finite("offset", x.offset);
  }
  if constexpr (std::is_same_v<T, Gear>) {
    examine_coordinate(e, x.first), examine_coordinate(e, x.second);
    e.finite("offset", x.offset);
  }
  if constexpr (std::is_same_v<T, Socket> || std::is_same_v<T, PinBush> || std::is_same_v<T, SphereBush>)
    e.require(x.radius_b > x.radius_a, "radius_b", x.radius_b, "> radius_a = " + e.text(x.radius_a));
  if constexpr (requires { x.law.mu_static; }) e.law(x.law);
  if constexpr (std::is_same_v<T, Limit>) {
    e.finite("bound", x.bound);
    e.require(!x.law.frictional(), "mu", std::max(x.law.mu, x.law.mu_static), "0: a limit has no friction");
  }
  if constexpr (std::is_same_v<T, Backlash>) {
    e.not_negative("play", x.play), e.finite("offset", x.gear.offset);
    e.require(x.play < x.gear.period(), "play", x.play, "< " + e.text(x.gear.period()) + ", from tooth to tooth");
    e.require(!x.law.frictional(), "mu", std::max(x.law.mu, x.law.mu_static), "0: teeth with play have no friction");
  }
}

void examine(const SpatialElement& e, const Load& l) {
  e.exists(l.body);
  if (l.body == kGround) e.fail("body", "body = \"ground\": must be a body that moves");
  e.finite("point", l.point), e.finite("force", l.force), e.finite("moment", l.moment),
      e.not_negative("omega", l.omega);
  for (std::size_t i = 0; i < l.breakpoints.size(); ++i) {
    e.finite("breakpoints", l.breakpoints[i]);
    e.require(i == 0 || l.breakpoints[i - 1] < l.breakpoints[i], "breakpoints", l.breakpoints[i], "ascending");
  }
}

void examine(const SpatialElement& e, const Collision& c) {
  for (std::size_t i = 0; i < c.shapes.size(); ++i) {
    const Shape& s = c.shapes[i];
    const std::string field = "shapes[" + std::to_string(i) + "].";
    e.exists(s.body);
    if (s.corners.empty()) e.fail(field + "corners", field + "corners: must be at least one point");
    for (const Vector3d& corner : s.corners) e.finite(field + "corners", corner);
    if (s.polytope()) {
      e.require(s.radius == 0, field + "radius", s.radius, "0: a polytope is not rounded");
      try {
        static_cast<void>(hull_of(s.corners));
      } catch (const std::invalid_argument& wrong) {
        e.fail(field + "corners", field + "corners: " + wrong.what());
      }
    } else {
      e.positive(field + "radius", s.radius);
      if (s.capsule() && s.corners.front() == s.corners.back())
        e.fail(field + "corners", field + "corners: must be two different points, the ends of a capsule");
    }
  }
  for (const auto& [a, b] : c.apart) e.exists(a), e.exists(b);
  e.law(c.law), e.positive("neighbours", c.neighbours);
  const SurfaceLaw& s = c.law.surface;
  if (s.moves() || s.orthotropic())
    e.fail(s.moves() ? "surface" : "mu_across",
           "surfaces that move, and friction by direction, are for listed contacts: must be left out");
  e.require(c.neighbours <= 1e6, "neighbours", c.neighbours, "<= 1e6");
}

Kinematics at_start(const Scene& scene) {
  Kinematics k;
  k.pose.resize(scene.bodies.size() + 1);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    k.pose[i].x = scene.bodies[i].position, k.pose[i].R = quaternions::matrix_of(scene.bodies[i].orientation);
  return k;
}

/// Whether joints keep directions along `axis` (in the world, at the start) the same in both bodies.
bool keeps(const Scene& scene, const Kinematics& k, BodyId a, BodyId b, const Vector3d& axis) {
  const auto place = [](BodyId body) { return body + 1; };  // the ground's is 0
  DisjointSets same(scene.bodies.size() + 1);
  const auto look = [&](const auto& j) {
    bool holds = requires { j.orientation; };
    if constexpr (requires { j.axis_a, j.reference_a; } || std::is_same_v<std::decay_t<decltype(j)>, PlaneJoint>)
      holds = k.at(j.a).turn(j.axis_a).cross(axis).norm() <= kSameAxis;
    if (holds) same.join(place(j.a), place(j.b));
  };
  for (const Joint& joint : scene.joints) {
    std::visit(
        [&](const auto& j) {
          if constexpr (requires { j.point_a; }) look(j);
        },
        joint);
    if (same.find(place(a)) == same.find(place(b))) return true;
  }
  return false;
}

/// What angles need of the scene around them: joints that keep their axes together, and a start from which what reads
/// them can tell their turns.
void examine_angles(const Scene& scene) {
  const Kinematics k = at_start(scene);
  const auto axis = [&](const SpatialElement& e, const Coordinate& c) {
    const auto* angle = std::get_if<Angle>(&c.kind());
    if (angle != nullptr && !keeps(scene, k, angle->a, angle->b, k.at(angle->a).turn(angle->axis_a)))
      e.fail("of",
             "of = \"angle\": must be about an axis that joints keep together in both bodies (revolute, cylindrical, "
             "screw, planar about it; prismatic, fixed)");
    return angle;
  };
  const auto near = [&](const SpatialElement& e, const Angle& angle, const char* field, double value, double middle) {
    const double start = angle.value(k);
    e.require(std::abs(start - middle) < std::numbers::pi, field, value,
              (value == middle ? std::string("less than half a turn from the angle at the start, ")
                               : "so that the middle of the bounds, " + e.text(middle) +
                                     ", is less than half a turn from the angle at the start, ") +
                  e.text(start));
  };
  for (std::size_t i = 0; i < scene.joints.size(); ++i)
    if (const auto* drive = std::get_if<Drive>(&scene.joints[i])) axis({scene, "joint", i, drive->name}, drive->of);
  for (std::size_t i = 0; i < scene.frictions.size(); ++i)
    axis({scene, "friction", i, scene.frictions[i].name}, scene.frictions[i].of);
  for (std::size_t i = 0; i < scene.springs.size(); ++i)
    if (const auto* spring = std::get_if<JointSpring>(&scene.springs[i])) {
      const SpatialElement e(scene, "spring", i, spring->name);
      const Angle* angle = axis(e, spring->of);
      if (angle != nullptr && spring->stiffness > 0) near(e, *angle, "rest", spring->rest, spring->rest);
    }
  for (std::size_t i = 0; i < scene.contacts.size(); ++i)
    if (const auto* limit = std::get_if<Limit>(&scene.contacts[i])) {
      const SpatialElement e(scene, "contact", i, limit->name);
      const char* field = limit->side == Limit::Side::lower ? "lower" : "upper";
      if (const Angle* angle = axis(e, limit->of)) near(e, *angle, field, limit->bound, limit->bound + limit->beyond);
    }
}

/// The equations of a joint hold for opposite axes, too, and a start beyond a right angle is moved to these: the joint
/// would keep the wrong direction.
void examine_directions(const Scene& scene) {
  if (scene.assemble) return;
  const Kinematics k = at_start(scene);
  for (std::size_t i = 0; i < scene.joints.size(); ++i)
    with_alignment(scene.joints[i], k, [&](const Alignment& joint) {
      constexpr double kDegree = std::numbers::pi / 180;
      const double off = joint.turn.norm();
      const bool universal = std::holds_alternative<Universal>(scene.joints[i]);
      if (!(off > std::numbers::pi / 2 + (universal ? -kSingular : kSameAxis))) return;
      const auto& element = scene.joints[i];
      const SpatialElement e(scene, "joint", i, std::visit([](const auto& j) { return j.name; }, element));
      const std::string degrees = e.text(std::round(off / kDegree * 1e6) / 1e6);
      std::visit(
          [&](const auto& j) {
            if constexpr (requires { j.orientation; })
              e.require(false, "orientation", j.orientation,
                        "that of the bodies at the start, to less than 90 degrees; they are turned by " + degrees +
                            " degrees against it. Set assemble = true to move them");
            if constexpr (std::is_same_v<std::decay_t<decltype(j)>, Universal>)
              e.require(false, "axis_b", j.axis_b,
                        "at right angles to the axis of the first body at the start; it is along it. Set assemble = "
                        "true to turn the bodies");
            else if constexpr (requires { j.axis_a; })
              e.require(false, "axis_b", j.axis_b,
                        "less than 90 degrees from the axis of the first body at the start; it is " + degrees +
                            " degrees off. Reverse an axis, or set assemble = true to turn the bodies");
          },
          element);
    });
}

template <class T> void examine_all(const Scene& scene, std::string_view kind, const std::vector<T>& elements) {
  ElementNames names;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto one = [&](const auto& x) {
      const SpatialElement e(scene, kind, i, x.name);
      names.add(e, x.name);
      examine(e, x);
    };
    if constexpr (requires { elements[i].index(); })
      std::visit(one, elements[i]);
    else
      one(elements[i]);
  }
}

}  // namespace

void check(const Scene& scene) {
  const SpatialElement whole(scene, "", 0, "");
  whole.finite("gravity", scene.gravity);
  whole.positive("duration", scene.duration), whole.positive("step", scene.step);
  if (scene.bodies.empty()) whole.fail("body", "has no bodies: must have at least one");
  examine_all(scene, "body", scene.bodies);
  examine_all(scene, "joint", scene.joints);
  examine_all(scene, "contact", scene.contacts);
  examine_all(scene, "collision", scene.collisions);
  examine_all(scene, "friction", scene.frictions);
  examine_all(scene, "spring", scene.springs);
  examine_all(scene, "load", scene.loads);
  examine_directions(scene);
  examine_angles(scene);
}

}  // namespace orthant::spatial
