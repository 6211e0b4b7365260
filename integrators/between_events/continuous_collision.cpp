#include <orthant/integrators/between_events/continuous_collision.h>
#include <orthant/integrators/step/width.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kBend = 0.25;         // [rad] in an interval that a polynomial stands for: errs by 5e-9 of the radius
constexpr double kThinPart = 1.0 / 8;  // of the thinner shape, likewise: what moves in such an interval
constexpr double kMisfit = 1e-10;      // of the size: edges smaller than that are not looked for
constexpr double kSmooth = 1e-3;       // of the motion: a smaller misfit means a polynomial that errs by 1e-9 of it
constexpr double kPassable = 0.25;     // of the size: what moves no farther does not come out on the other side
constexpr double kShort = 1e-13;       // of the step: no shorter intervals
constexpr int kKnots = 20000;          // of one contact and step: some 30 around each edge near zero
constexpr int kMostKnots = 2000000;    // likewise of a custom contact: its whole way by its length

double outermost(const Polygon& corners, const Vector2d& from) {
  double most = 0;
  for (const Vector2d& corner : corners) most = std::max(most, (corner - from).norm());
  return most;
}

Vector2d middle_of(const Polygon& corners) {
  Vector2d sum(0, 0);
  for (const Vector2d& corner : corners) sum += corner;
  return sum / static_cast<double>(corners.size());
}

/// The most that all of `y` lies beyond one face of `x` [m].
double beyond(const Pose& x, const Polygon& of_x, const Pose& y, const Polygon& of_y) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < of_x.size(); ++i) {
    const Vector2d n = x.turn(outward(of_x, i)), in_y = y.turn_back(n);
    double least = std::numeric_limits<double>::infinity();
    for (const Vector2d& corner : of_y) least = std::min(least, in_y.dot(corner));
    most = std::max(most, n.dot(y.x - x.x - x.turn(of_x[i])) + least);
  }
  return most;
}

/// Of the centres of two bodies, in places or velocities.
Vector2d apart(const Eigen::VectorXd& x, BodyId a, BodyId b) {
  Vector2d d(0, 0);
  if (a >= 0) d += translation(x, a);
  if (b >= 0) d -= translation(x, b);
  return d;
}

/// The most |rate| of Hermite's polynomial of degree 5 in a step of s, by its Bernstein coefficients.
template <class Vectors> double fastest(const Vectors& q, const Vectors& v, const Vectors& a, double s) {
  const auto& [q0, q1] = q;
  const auto& [v0, v1] = v;
  const auto& [a0, a1] = a;
  const auto size = [](const auto& x) {
    if constexpr (requires { x.squaredNorm(); })
      return x.squaredNorm();
    else
      return x * x;
  };
  using Value = std::decay_t<decltype(q0)>;
  const Value early = v0 + s / 4 * a0, late = v1 - s / 4 * a1;
  const Value middle = 5 / s * (q1 - q0) - 2 * (v0 + v1) - s / 4 * (a0 - a1);
  return std::sqrt(std::max({size(v0), size(early), size(middle), size(late), size(v1)}));
}

}  // namespace

ContinuousCollision::ContinuousCollision(const System& system)
    : system_(system), v_(Eigen::VectorXd::Zero(system.dof())), acceleration_(v_) {
  for (const Contact& contact : system.scene().contacts) shapes_.push_back(shape_of(contact));
  at_.pose.resize(static_cast<std::size_t>(system.bodies()) + 1);
  at_.twist.resize(at_.pose.size());
}

ContinuousCollision::Shape ContinuousCollision::shape_of(const Contact& contact) const {
  Shape s;
  const auto circles = [&](const Vector2d& centre_a, const Vector2d& centre_b, double size, double side) {
    s.centre_a = centre_a, s.centre_b = centre_b, s.size = size, s.side = side;
    s.arm_a = centre_a.norm(), s.arm_b = centre_b.norm();
    s.course = size > 0 ? Course::round : Course::edged;
  };
  const auto against_wall = [&](const Vector2d& point) {
    s.arm_a = s.arm_b = point.norm(), s.wall_b = true;
    if (s.b < 0 && s.arm_a == 0) s.course = Course::straight;
  };
  const auto look = [&](const auto& c) {
    using Kind = std::decay_t<decltype(c)>;
    std::tie(s.a, s.b) = bodies_of(c);
    if constexpr (std::is_same_v<Kind, CornerWall>) {
      against_wall(c.point);
    } else if constexpr (std::is_same_v<Kind, DiscWall>) {
      against_wall(c.centre);
    } else if constexpr (std::is_same_v<Kind, DiscDisc>) {
      circles(c.centre_a, c.centre_b, c.radius_a + c.radius_b, 1);
    } else if constexpr (std::is_same_v<Kind, Journal>) {
      circles(c.centre_a, c.centre_b, c.radius_b - c.radius_a, -1);
    } else if constexpr (std::is_same_v<Kind, DiscPolygon>) {
      s.course = Course::edged;
      s.arm_a = c.centre.norm(), s.arm_b = outermost(c.corners, {0, 0});
      s.size = std::min(2 * c.radius, width_of(c.corners));
      if (c.exposed) s.covered = &c;
    } else if constexpr (std::is_same_v<Kind, PolygonPolygon>) {
      s.course = Course::edged;
      s.arm_a = outermost(c.corners_a, {0, 0}), s.arm_b = outermost(c.corners_b, {0, 0});
      s.size = std::min(width_of(c.corners_a), width_of(c.corners_b));
      s.corners_a = &c.corners_a, s.corners_b = &c.corners_b;
      s.centre_a = middle_of(c.corners_a), s.centre_b = middle_of(c.corners_b);
      s.reach_a = outermost(c.corners_a, s.centre_a), s.reach_b = outermost(c.corners_b, s.centre_b);
    } else if constexpr (std::is_same_v<Kind, Limit>) {
      if (const auto* slide = std::get_if<Slide>(&c.of.kind()))
        s.arm_a = s.arm_b = slide->point_b.norm(), s.wall_a = true;
      else if (const auto* span = std::get_if<Span>(&c.of.kind()))
        circles(span->point_a, span->point_b, c.bound, c.side == Limit::Side::lower ? 1 : -1);
      else
        s.course = Course::straight;
    } else {
      s.course = Course::custom;
      if constexpr (requires { c.length(); }) s.size = c.length();
    }
  };
  std::visit(look, contact);
  return s;
}

void ContinuousCollision::begin(double t, double s, const MotionPoint& a, const MotionPoint& b) {
  t_ = t, s_ = s, a_ = &a, b_ = &b;
}

/// L of (1) [m/s], and the larger |ω| of bodies whose turning bends the gap's course [rad/s].
std::pair<double, double> ContinuousCollision::pace(const Shape& shape) const {
  using Values = std::pair<double, double>;
  using Vectors = std::pair<Vector2d, Vector2d>;
  const auto turning = [&](BodyId body) {
    const Index i = kBlock * body + 2;
    return fastest(Values{a_->q[i], b_->q[i]}, Values{a_->v[i], b_->v[i]}, Values{a_->a[i], b_->a[i]}, s_);
  };
  const auto between = [&](auto member) {
    return Vectors{apart(a_->*member, shape.a, shape.b), apart(b_->*member, shape.a, shape.b)};
  };
  const Vectors d = between(&MotionPoint::q);
  const double along = fastest(d, between(&MotionPoint::v), between(&MotionPoint::a), s_);
  return pace(shape, along, (d.first.norm() + d.second.norm() + along * s_) / 2, turning);
}

/// Likewise, of the centres' speed against each other and their distance; turning(body): |ω|.
template <class Turning> std::pair<double, double> ContinuousCollision::pace(const Shape& shape, double along,
                                                                             double far, const Turning& turning) {
  const bool custom = shape.course == Course::custom;
  const auto one = [&](BodyId body, double arm, bool wall) {
    return body >= 0 && (arm > 0 || wall || custom) ? turning(body) : 0.0;
  };
  const double turn_a = one(shape.a, shape.arm_a, shape.wall_a), turn_b = one(shape.b, shape.arm_b, shape.wall_b);
  const double arm_a = shape.arm_a + (shape.wall_a ? far : 0), arm_b = shape.arm_b + (shape.wall_b ? far : 0);
  return {along + turn_a * arm_a + turn_b * arm_b, std::max(turn_a, turn_b)};
}

bool ContinuousCollision::plain(int contact, double faster) {
  const Shape& shape = shapes_[static_cast<std::size_t>(contact)];
  if (shape.course == Course::straight) return true;
  auto [fast, turn] = pace(shape);
  fast *= faster, turn *= faster;
  if (shape.course == Course::smooth && turn * s_ <= kBend) return true;
  const auto clear_at = [&](double x) {
    place(shape.a, x), place(shape.b, x);
    at_.t = t_ + x * s_;
    const auto gap = [&](const auto& c) { return c.gap(at_); };
    return clear(shape, std::visit(gap, system_.scene().contacts[static_cast<std::size_t>(contact)]));
  };
  return clear_at(0) + clear_at(1) > fast * s_;
}

double ContinuousCollision::stride(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& gaps) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < shapes_.size(); ++c) {
    const Shape& shape = shapes_[c];
    const bool custom = shape.course == Course::custom;
    if (!custom && shape.course != Course::edged && (shape.course != Course::round || shape.side < 0)) continue;
    const auto turning = [&](BodyId body) { return std::abs(rotation(v, body)); };
    const double along = apart(v, shape.a, shape.b).norm(), far = apart(q, shape.a, shape.b).norm();
    const auto [fast, turn] = pace(shape, along, far, turning);
    const double near = kPassable * shape.size, way = custom ? near : std::max(gaps[static_cast<Index>(c)], near);
    if (fast > 0) least = std::min(least, way / fast);
    if (custom && turn > 0) least = std::min(least, kBend / turn);
  }
  return least;
}

/// The body as it is at x of the step.
void ContinuousCollision::place(BodyId body, double x) {
  if (body < 0) return;
  const double y = x * x * x, s = s_;
  std::array<double, kBlock> at{};
  for (Index k = 0; k < kBlock; ++k) {
    const Index i = kBlock * body + k;
    const double v = a_->v[i], a = a_->a[i];
    // What the Taylor polynomial from a lacks at b, of value, rate and second derivative.
    const double p = b_->q[i] - a_->q[i] - s * (v + s / 2 * a), r = s * (b_->v[i] - v - s * a),
                 c = s * s * (b_->a[i] - a);
    const double c3 = 10 * p - 4 * r + c / 2, c4 = -15 * p + 7 * r - c, c5 = 6 * p - 3 * r + c / 2;
    at[static_cast<std::size_t>(k)] = a_->q[i] + s * x * (v + s * x / 2 * a) + y * (c3 + x * (c4 + x * c5));
    v_[i] = v + s * x * a + x * x * (3 * c3 + x * (4 * c4 + x * 5 * c5)) / s;
    acceleration_[i] = a + x * (6 * c3 + x * (12 * c4 + x * 20 * c5)) / (s * s);
  }
  const auto i = static_cast<std::size_t>(body);
  at_.pose[i] = {{at[0], at[1]}, at[2], std::cos(at[2]), std::sin(at[2])};
  at_.twist[i] = twist_of(v_, body);
}

ContinuousCollision::Sample ContinuousCollision::sample(int contact, double x) {
  const Shape& shape = shapes_[static_cast<std::size_t>(contact)];
  place(shape.a, x), place(shape.b, x);
  at_.t = t_ + x * s_;
  const auto of = [&](const auto& c) -> Sample {
    const Row row = c.rows(at_).normal;
    return {c.gap(at_), apply(row, v_.data()), apply(row, acceleration_.data()) + c.bias(at_).normal};
  };
  return std::visit(of, system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

double ContinuousCollision::clear(const Shape& shape, double gap) const {
  if (shape.course == Course::custom) return -std::numeric_limits<double>::infinity();
  if (shape.covered != nullptr) return shape.covered->whole_gap(at_);
  if (shape.corners_a == nullptr) return gap;
  const Pose &a = at_.at(shape.a), &b = at_.at(shape.b);
  return std::max(beyond(a, *shape.corners_a, b, *shape.corners_b), beyond(b, *shape.corners_b, a, *shape.corners_a));
}

ContinuousCollision::Knot ContinuousCollision::knot(const Shape& shape, int contact, double x) {
  if (shape.course != Course::round) {
    const Sample of = sample(contact, x);
    return {x, of, clear(shape, of.gap)};
  }
  place(shape.a, x), place(shape.b, x);
  const auto acceleration = [&](BodyId body, const Vector2d& r) -> Vector2d {
    if (body < 0) return {0, 0};
    const double omega = rotation(v_, body);
    return translation(acceleration_, body) + rotation(acceleration_, body) * perp(r) - omega * omega * r;
  };
  const Vector2d r_a = at_.at(shape.a).turn(shape.centre_a), r_b = at_.at(shape.b).turn(shape.centre_b);
  const Vector2d d = at_.at(shape.a).x + r_a - at_.at(shape.b).x - r_b;
  const Vector2d rate = at_.rate(shape.a).at(r_a) - at_.rate(shape.b).at(r_b);
  const Vector2d second = acceleration(shape.a, r_a) - acceleration(shape.b, r_b);
  const double side = shape.side, gap = side * (d.norm() - shape.size);
  return {
      x, {gap * (d.norm() + shape.size), side * 2 * d.dot(rate), side * 2 * (rate.squaredNorm() + d.dot(second))}, gap};
}

std::optional<Sign> ContinuousCollision::first(int contact, const Sample& first, const Sample& last, double slack) {
  const Shape& shape = shapes_[static_cast<std::size_t>(contact)];
  Knot low{0, first, first.gap}, high{1, last, last.gap};
  Search s{shape,
           contact,
           0,
           0,
           slack,
           std::min(0.0, first.gap),
           kMisfit * shape.size,
           shape.course == Course::custom ? kMostKnots : kKnots};
  if (shape.course == Course::straight) {
    low.clear = high.clear = -std::numeric_limits<double>::infinity();
    return search(s, low, high);
  }
  std::tie(s.fast, s.turn) = pace(shape);
  const bool gap_jumps = shape.corners_a != nullptr || shape.covered != nullptr;
  if (!gap_jumps && shape.course != Course::custom && low.clear + high.clear > s.fast * s_) return {};
  if (shape.course == Course::custom) {
    const double size = std::min(shape.size, std::abs(first.gap) + std::abs(last.gap) + s.fast * s_);
    low.clear = high.clear = -std::numeric_limits<double>::infinity(), s.small = kMisfit * size;
  } else if (shape.course == Course::round || gap_jumps) {
    low = knot(shape, contact, 0), high = knot(shape, contact, 1);
    if (shape.course == Course::round) s.slack *= 2 * shape.size, s.shift = std::min(0.0, low.of.gap);
  }
  return search(s, low, high);
}

std::optional<Sign> ContinuousCollision::search(Search& s, const Knot& low, const Knot& high) {
  const double part = high.x - low.x, tau = part * s_, way = s.fast * tau;
  if (low.clear + high.clear > way) return {};
  const Shape& shape = s.shape;
  const bool edged = shape.course == Course::edged || shape.course == Course::custom;
  const bool last = part <= kShort || s.left <= 0;
  if (last || (s.turn * tau <= kBend && (!edged || way <= kThinPart * shape.size))) {
    const Sample &f = low.of, &g = high.of;
    const auto course = quintic(f.gap - s.shift, f.rate, f.acceleration, g.gap - s.shift, g.rate, g.acceleration, tau);
    bool trusted = last || shape.course == Course::straight;
    if (!trusted) {
      const double bend = tau * (g.rate - f.rate - tau / 2 * (f.acceleration + g.acceleration));
      const double rise =
          g.gap - f.gap - tau / 2 * (f.rate + g.rate) - tau * tau / 12 * (f.acceleration - g.acceleration);
      const double misfit = std::abs(bend) + std::abs(rise);
      if (!(*std::min_element(course.begin(), course.end()) <= misfit)) return {};  // not a number: neither
      const double unit = shape.course == Course::round ? 2 * (shape.size + way) : 1;
      trusted = misfit <= (edged ? s.small : kSmooth * way * unit) || way <= s.small;
    }
    if (trusted) {
      const auto found = first_crossing(course, s.slack);
      if (!found) return {};
      Sign sign{Watch::gap, s.contact, {low.x + part * found->x, found->slope / part}};
      sign.low = std::max(0.0, low.x - part), sign.high = std::min(1.0, high.x + part);
      return sign;
    }
  }
  --s.left;
  const Knot middle = knot(shape, s.contact, low.x + part / 2);
  if (!std::isfinite(middle.of.gap)) return {};
  if (auto sign = search(s, low, middle)) return sign;
  return search(s, middle, high);
}

}  // namespace orthant
