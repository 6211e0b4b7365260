// integrators/between_events/continuous_collision.h — continuous collision detection: closing gaps within a step of any
// length.
//
//   Known are q, v, a at both ends of a step; in between, q is the Hermite polynomial of degree 5. The Bernstein form
//   of its rate bounds the speeds in the step. The gap of two shapes then changes no faster than
//     L = |ẋ_a − ẋ_b| + |ω_a| r_a + |ω_b| r_b                                                                (1)
//   with r the farthest point of a shape from its body's centre. So the gap is above (g_0 + g_1 − L τ) / 2 in an
//   interval of length τ (conservative advancement); where that is positive there is no contact. Other intervals are
//   halved, left half first, until no body turns by more than 1/4 rad. There the gap's own polynomial of degree 5
//   decides (first_crossing.h): of two circles (discs, journals, spans) that of the squared distance; of polygons and
//   custom contacts only in intervals whose rates show no edge near zero (misfit ≤ 1e-10 of the size).
//   Half-planes fixed in turning bodies: r is the distance of the point. A custom contact has no bound (1): all of its
//   step is divided, and at its length().
//   Limit: shallower than the polynomials' error, some 1e-8 of the motion within a step, a graze is overlooked.
// Cost: O(1) a contact where (1) rules it out; else O(log) intervals around a contact, each with one gap and its rates.
// Source: Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems (1996), ch. 2; Zhang, Redon, Lee & Kim,
// Continuous collision detection for articulated models using Taylor models and temporal culling (2007).
#pragma once

#include <orthant/integrators/between_events/contact_watch.h>

namespace orthant {

class ContinuousCollision {
 public:
  explicit ContinuousCollision(const System& system);

  struct Sample {  // of a gap [m], with its rates
    double gap = 0, rate = 0, acceleration = 0;
  };

  /// The step from a, at t, to b, s [s] later. Both must outlive the calls below.
  void begin(double t, double s, const MotionPoint& a, const MotionPoint& b);
  /// Of a listed contact, at x ∈ [0, 1] of the step.
  Sample sample(int contact, double x);
  /// Where its gap first falls below −slack, or below a negative gap at the start by that. first, last: at the ends.
  std::optional<Sign> first(int contact, const Sample& first, const Sample& last, double slack);
  /// A look at the speeds alone, which may be up to `faster` times those of the polynomial: true where the contact
  /// stays open, and where a few gaps in the step show all that happens (its bodies do not turn by much, nor pass by).
  bool plain(int contact, double faster);
  /// [s] in which no two shapes pass through each other that have these gaps, at the velocities v; on ≥ 1/4 of their
  /// size.
  double stride(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& gaps);

 private:
  enum class Course { straight, smooth, round, edged, custom };
  struct Shape {
    Course course = Course::smooth;
    BodyId a = kGround, b = kGround;
    double arm_a = 0, arm_b = 0;          // [m] r in (1)
    bool wall_a = false, wall_b = false;  // a half-plane or axis: r grows with the distance
    double size = 0;                      // [m] the thinner shape's; of circles the distance of centres that touch
    double side = 1;                      // of circles: −1 when one is inside the other
    Vector2d centre_a{0, 0}, centre_b{0, 0};
    const Polygon *corners_a = nullptr, *corners_b = nullptr;  // of two polygons
    double reach_a = 0, reach_b = 0;                           // [m] of those, from centre_a and centre_b
    const DiscPolygon* covered = nullptr;  // a polygon with neighbours: the gap jumps where a face's free part ends
  };
  struct Knot {
    double x = 0;
    Sample of;         // what the polynomial goes through: a gap, or of circles the squares' difference
    double clear = 0;  // [m] no more than the shapes' distance
  };
  struct Search {
    const Shape& shape;
    int contact;
    double fast, turn;           // [m/s] L, [rad/s]
    double slack, shift, small;  // of Knot::of
    int left;                    // knots
  };

  Shape shape_of(const Contact& contact) const;
  std::pair<double, double> pace(const Shape& shape) const;
  template <class Turning>
  static std::pair<double, double> pace(const Shape& shape, double along, double far, const Turning& turning);
  void place(BodyId body, double x);
  Knot knot(const Shape& shape, int contact, double x);
  double clear(const Shape& shape, double gap) const;
  std::optional<Sign> search(Search& s, const Knot& low, const Knot& high);

  const System& system_;
  std::vector<Shape> shapes_;
  const MotionPoint *a_ = nullptr, *b_ = nullptr;
  double t_ = 0, s_ = 0;
  Kinematics at_;
  Eigen::VectorXd v_, acceleration_;  // of the two bodies placed
};

}  // namespace orthant
