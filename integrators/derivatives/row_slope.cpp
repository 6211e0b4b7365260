#include <orthant/integrators/derivatives/row_slope.h>

#include <cmath>

namespace orthant {

namespace {

enum class Bend {
  none,    // the row is constant
  turned,  // affine in sine and cosine of the angles, independent of the places
  placed,  // likewise, and affine in the places
  curved
};

constexpr double kSlopeStep = 3e-6;  // [m, rad]

Pose quarter_turned(const Pose& p, double sign) { return {p.x, p.theta, -sign * p.s, sign * p.c}; }
Pose shifted(const Pose& p, int coordinate, double by) {
  if (coordinate < 2) {
    Pose moved = p;
    moved.x[coordinate] += by;
    return moved;
  }
  const double c = std::cos(by), s = std::sin(by);
  return {p.x, p.theta + by, c * p.c - s * p.s, s * p.c + c * p.s};
}

/// rows(k, Row*) fills n rows, all on the bodies a and b, in either order.
template <std::size_t n, class F>
void find_slopes(Kinematics& at, BodyId a, BodyId b, Bend bend, F&& rows, RowSlope* slopes) {
  for (std::size_t i = 0; i < n; ++i) slopes[i].count = 0;
  if (bend == Bend::none) return;
  std::array<Row, n> ahead, behind, far_ahead, far_behind;
  for (const BodyId body : {a, b}) {
    if (body < 0) continue;
    Pose& pose = at.pose[static_cast<std::size_t>(body)];
    const Pose kept = pose;
    const auto look = [&](const Pose& there, std::array<Row, n>& to) { pose = there, rows(at, to.data()); };
    const auto put = [&](int c, auto&& slope) {  // slope(row, entries of a or of b, k)
      for (std::size_t i = 0; i < n; ++i)
        for (const bool second : {false, true}) {
          const BodyId of = second ? ahead[i].b : ahead[i].a;
          for (std::size_t k = 0; k < 3 && of >= 0; ++k)
            slopes[i].add(kBlock * of + static_cast<Eigen::Index>(k), kBlock * body + c,
                          slope(i, second ? &Row::jb : &Row::ja, k));
        }
    };
    const auto half_difference = [&](std::size_t i, Row::Entries Row::*j, std::size_t k) {
      return ((ahead[i].*j)[k] - (behind[i].*j)[k]) / 2;
    };
    const auto fourth_order = [&](std::size_t i, Row::Entries Row::*j, std::size_t k) {
      return (8 * ((ahead[i].*j)[k] - (behind[i].*j)[k]) - ((far_ahead[i].*j)[k] - (far_behind[i].*j)[k])) /
             (12 * kSlopeStep);
    };
    for (int c = bend == Bend::turned ? 2 : 0; c < 3; ++c) {
      if (bend == Bend::curved) {
        look(shifted(kept, c, kSlopeStep), ahead), look(shifted(kept, c, -kSlopeStep), behind);
        look(shifted(kept, c, 2 * kSlopeStep), far_ahead), look(shifted(kept, c, -2 * kSlopeStep), far_behind);
        put(c, fourth_order);
      } else {
        look(c < 2 ? shifted(kept, c, 1) : quarter_turned(kept, 1), ahead);
        look(c < 2 ? shifted(kept, c, -1) : quarter_turned(kept, -1), behind);
        put(c, half_difference);
      }
    }
    pose = kept;
  }
}

/// A pin's rows depend on the arms alone: the most frequent joint by far.
void pin_slopes(const Kinematics& at, BodyId body, const Vector2d& point, double sign, RowSlope* slopes) {
  if (body < 0) return;
  const Vector2d r = at.at(body).turn(point);
  const Eigen::Index turn = kBlock * body + 2;
  slopes[0].add(turn, turn, -sign * r.x()), slopes[1].add(turn, turn, -sign * r.y());
}

/// The rows along and across d = P_a − P_b, of points that lie radius_a and radius_b further in from P_a and P_b:
///   n = d / |d|, ∂n = (∂d − n n · ∂d) / |d|;  j_a = (n, r_a × n), j_b = −(n, r_b × n), likewise across
void line_slopes(const Kinematics& at, const Span& of, double radius_a, double radius_b, RowSlope& along,
                 RowSlope* across) {
  const Vector2d arm_a = at.at(of.a).turn(of.point_a), arm_b = at.at(of.b).turn(of.point_b);
  const Vector2d d = at.at(of.a).x + arm_a - at.at(of.b).x - arm_b;
  const double length = d.norm();
  along.count = 0;
  if (across != nullptr) across->count = 0;
  if (!(length > 0)) return;
  const Vector2d n = d / length, r_a = arm_a - radius_a * n, r_b = arm_b + radius_b * n;
  for (const bool second : {false, true}) {
    const BodyId body = second ? of.b : of.a;
    for (int c = 0; c < 3 && body >= 0; ++c) {
      const Vector2d moves = c < 2 ? Vector2d::Unit(c) : perp(second ? arm_b : arm_a);  // of the body's point
      const Vector2d d_d = second ? Vector2d(-moves) : moves, d_n = (d_d - n * n.dot(d_d)) / length;
      const Vector2d turned = c == 2 ? moves : Vector2d(0, 0);  // of its arm
      const Vector2d d_a = (second ? Vector2d(0, 0) : turned) - radius_a * d_n;
      const Vector2d d_b = (second ? turned : Vector2d(0, 0)) + radius_b * d_n;
      const Eigen::Index by = kBlock * body + c;
      const auto put = [&](RowSlope& slope, const Vector2d& u, const Vector2d& d_u) {
        if (of.a >= 0) {
          slope.add(kBlock * of.a, by, d_u.x()), slope.add(kBlock * of.a + 1, by, d_u.y());
          slope.add(kBlock * of.a + 2, by, cross(d_a, u) + cross(r_a, d_u));
        }
        if (of.b >= 0) {
          slope.add(kBlock * of.b, by, -d_u.x()), slope.add(kBlock * of.b + 1, by, -d_u.y());
          slope.add(kBlock * of.b + 2, by, -cross(d_b, u) - cross(r_b, d_u));
        }
      };
      put(along, n, d_n);
      if (across != nullptr) put(*across, tangent_of(n), tangent_of(d_n));
    }
  }
}

Bend bend_of(const Slide& slide) { return slide.a < 0 ? Bend::turned : Bend::placed; }
Bend bend_of(const Coordinate& c) {
  if (const auto* slide = std::get_if<Slide>(&c.kind())) return bend_of(*slide);
  return std::holds_alternative<Angle>(c.kind()) ? Bend::none : Bend::curved;
}
Bend bend_of(const Fixed& /*joint*/) { return Bend::turned; }
Bend bend_of(const Prismatic& joint) { return joint.a < 0 ? Bend::turned : Bend::placed; }
Bend bend_of(const CustomJoint& /*joint*/) { return Bend::curved; }
Bend bend_of(const CornerWall& contact) { return contact.b < 0 ? Bend::turned : Bend::placed; }
Bend bend_of(const DiscWall& contact) { return contact.b < 0 ? Bend::turned : Bend::placed; }
Bend bend_of(const Limit& contact) { return bend_of(contact.of); }
template <class Other> Bend bend_of(const Other& /*contact*/) { return Bend::curved; }

}  // namespace

void slopes_of(const Joint& joint, Kinematics& at, RowSlope* slopes) {
  std::visit(
      [&](const auto& j) {
        const auto [a, b] = bodies_of(j);
        const auto rows = [&](const Kinematics& k, Row* G) { j.rows(k, G); };
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(j)>, Revolute>) {
          slopes[0].count = slopes[1].count = 0;
          pin_slopes(at, j.a, j.point_a, 1, slopes), pin_slopes(at, j.b, j.point_b, -1, slopes);
        } else if constexpr (std::is_same_v<std::remove_cvref_t<decltype(j)>, Distance>) {
          line_slopes(at, {j.a, j.b, j.point_a, j.point_b}, 0, 0, slopes[0], nullptr);
        } else if constexpr (std::is_same_v<std::remove_cvref_t<decltype(j)>, Drive>) {
          slope_of(j.of, at, slopes[0]);
        } else if constexpr (requires { j.row_count(); }) {
          for (int i = 0; i < j.row_count(); ++i) {  // a custom joint may have any number
            std::vector<Row> all(static_cast<std::size_t>(j.row_count()));
            const auto one = [&](const Kinematics& k, Row* G) {
              j.rows(k, all.data());
              *G = all[static_cast<std::size_t>(i)];
            };
            find_slopes<1>(at, a, b, bend_of(j), one, slopes + i);
          }
        } else {
          find_slopes<static_cast<std::size_t>(std::remove_cvref_t<decltype(j)>::kRows)>(at, a, b, bend_of(j), rows,
                                                                                         slopes);
        }
      },
      joint);
}

void slopes_of(const Contact& contact, Kinematics& at, std::array<RowSlope, 2>& slopes) {
  if (const auto* discs = std::get_if<DiscDisc>(&contact))
    return line_slopes(at, {discs->a, discs->b, discs->centre_a, discs->centre_b}, discs->radius_a, discs->radius_b,
                       slopes[0], &slopes[1]);
  if (const auto* hole = std::get_if<Journal>(&contact)) {  // discs with a negative radius, rows of the opposite sign
    line_slopes(at, {hole->a, hole->b, hole->centre_a, hole->centre_b}, -hole->radius_a, hole->radius_b, slopes[0],
                &slopes[1]);
    for (RowSlope& slope : slopes)
      for (std::size_t i = 0; i < slope.count; ++i) slope.entries[i].value *= -1;
    return;
  }
  std::visit(
      [&](const auto& c) {
        const auto [a, b] = bodies_of(c);
        const auto rows = [&](const Kinematics& k, Row* G) {
          const ContactRows both = c.rows(k);
          G[0] = both.normal, G[1] = both.tangent;
        };
        find_slopes<2>(at, a, b, bend_of(c), rows, slopes.data());
      },
      contact);
}

void slope_of(const Coordinate& coordinate, Kinematics& at, RowSlope& slope) {
  if (const auto* span = std::get_if<Span>(&coordinate.kind())) return line_slopes(at, *span, 0, 0, slope, nullptr);
  const auto [a, b] = std::visit([](const auto& c) { return std::pair{c.a, c.b}; }, coordinate.kind());
  find_slopes<1>(
      at, a, b, bend_of(coordinate), [&](const Kinematics& k, Row* G) { *G = coordinate.row(k); }, &slope);
}

void slope_of(const Spring& spring, Kinematics& at, RowSlope& slope) {
  std::visit(
      [&](const auto& s) {
        if constexpr (requires { s.of; }) {
          slope_of(s.of, at, slope);
        } else if constexpr (requires { s.point_a; }) {
          slope_of(Span{s.a, s.b, s.point_a, s.point_b}, at, slope);
        } else {
          slope_of(Angle{s.b, s.a}, at, slope);
        }
      },
      spring);
}

}  // namespace orthant
