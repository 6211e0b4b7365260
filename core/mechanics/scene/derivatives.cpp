#include <orthant/core/mechanics/scene/derivatives.h>

#include <cmath>
#include <cstdio>
#include <functional>

namespace orthant {
namespace {

constexpr double kDifference = 1e-7;  // [unit, rad, s]
constexpr double kAgree = 1e-4;

/// The functions to be differentiated, of a joint or a contact.
struct Subject {
  BodyId a, b;
  int rows, values;  // values: rows whose integral `value` is known, the first ones
  const char *value_name, *row_names[2];
  std::function<void(const Kinematics&, double*)> value;
  std::function<void(const Kinematics&, Row*)> row;
  std::function<void(const Kinematics&, double*)> rate, bias;  // rate may be absent
  double unit = 1;                                             // [m] see unit_of()

  std::string row_name(int i) const { return row_names[0] ? row_names[i] : "rows[" + std::to_string(i) + "]"; }
};

/// Differences are good for six digits or so.
std::string six_digits(double x) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", x);
  return digits;
}

void turn(Kinematics& k, BodyId body, const Vector2d& by, double angle) {
  Pose& p = k.pose[static_cast<std::size_t>(body)];
  const double theta = p.theta + angle;
  p = {p.x + by, theta, std::cos(theta), std::sin(theta)};
}

std::string compare(const Subject& s, const Kinematics& k) {
  const auto size = static_cast<std::size_t>(s.rows);
  std::vector<Row> rows(size), ahead(size), behind(size);
  std::vector<double> plus(size), minus(size);
  s.row(k, rows.data());
  std::vector<double> unit(kBlock * (k.pose.size() - 1), 0.0), v = unit;

  for (int i = 0; i < s.rows; ++i)  // whom a row acts on
    for (const BodyId body : {rows[static_cast<std::size_t>(i)].a, rows[static_cast<std::size_t>(i)].b})
      if (body != kGround && body != s.a && body != s.b)
        return s.row_name(i) + " acts on body " + std::to_string(body) + ": must act on the two bodies of its own";

  for (const BodyId body : {s.a, s.b})
    for (int c = 0; body != kGround && c < kBlock; ++c) {
      const std::size_t place = kBlock * static_cast<std::size_t>(body) + static_cast<std::size_t>(c);
      const auto moved = [&](double by, std::vector<double>& value) {
        Kinematics there = k;
        turn(there, body, c == 2 ? Vector2d(0, 0) : by * s.unit * Vector2d::Unit(c), c == 2 ? by : 0);
        s.value(there, value.data());
      };
      moved(kDifference, plus), moved(-kDifference, minus);
      unit[place] = 1;
      for (std::size_t i = 0; i < static_cast<std::size_t>(s.values); ++i) {
        const double by_differences = (plus[i] - minus[i]) / (2 * kDifference * (c == 2 ? 1 : s.unit)),
                     given = apply(rows[i], unit.data());
        if (!(std::abs(by_differences - given) <= kAgree * (1 + std::abs(by_differences))))
          return s.row_name(static_cast<int>(i)) + " by the " +
                 (c == 0   ? "x"
                  : c == 1 ? "y"
                           : "angle") +
                 " of body " + std::to_string(body) + " is " + six_digits(given) + ": differences of " + s.value_name +
                 " give " + six_digits(by_differences);
      }
      unit[place] = 0;
    }

  Kinematics moving = k;
  moving.twist.assign(k.pose.size(), {});
  for (std::size_t i = 0; i + 1 < k.pose.size(); ++i) {
    const auto x = static_cast<double>(i);
    moving.twist[i] = {s.unit * Vector2d(std::cos(1 + x), std::sin(2 + x)), 1.3 + 0.4 * std::cos(3 * x)};
    double* const vi = v.data() + kBlock * i;
    vi[0] = moving.twist[i].v.x(), vi[1] = moving.twist[i].v.y(), vi[2] = moving.twist[i].omega;
  }
  const auto after = [&](double time, std::vector<Row>& row, std::vector<double>& value, std::vector<double>& rate) {
    Kinematics there = moving;
    there.t += time;
    Kinematics still = k;
    still.t += time;
    s.value(still, value.data());
    for (const BodyId body : {s.a, s.b})
      if (body != kGround) turn(there, body, time * moving.rate(body).v, time * moving.rate(body).omega);
    s.row(there, row.data());
    if (s.rate) s.rate(there, rate.data());
  };
  std::vector<double> rate(size), rate_ahead(size), rate_behind(size), bias(size);
  after(kDifference, ahead, plus, rate_ahead), after(-kDifference, behind, minus, rate_behind);
  s.bias(moving, bias.data());
  if (s.rate) s.rate(moving, rate.data());
  for (std::size_t i = 0; i < size; ++i) {
    const double speed = std::abs(apply(rows[i], v.data()));
    if (i < static_cast<std::size_t>(s.values)) {
      const double by_differences = -(plus[i] - minus[i]) / (2 * kDifference);
      if (!(std::abs(by_differences - rate[i]) <= kAgree * (1 + std::abs(by_differences))))
        return "rate[" + std::to_string(i) + "] is " + six_digits(rate[i]) + ": differences of " + s.value_name +
               " in time give " + six_digits(by_differences);
    }
    const double by_differences =
        (apply(ahead[i], v.data()) - apply(behind[i], v.data()) - (rate_ahead[i] - rate_behind[i])) / (2 * kDifference);
    if (!(std::abs(by_differences - bias[i]) <= kAgree * (1 + std::abs(by_differences) + speed)))
      return "bias of " + s.row_name(static_cast<int>(i)) + " is " + six_digits(bias[i]) +
             ": differences of the row give " + six_digits(by_differences);
  }
  return {};
}

/// [m] Differences are small next to it: the bodies' distance, at most 1, and large next to the rounding of places.
double unit_of(const Pose& a, const Pose& b) {
  const double apart = (a.x - b.x).norm(), far = std::max(a.x.norm(), b.x.norm());
  return far > 0 ? std::min(1.0, std::max(apart, 1e-3 * far)) : 1;
}

/// At the given poses and two others near them; empty as soon as all is right at one of them.
std::string compare_around(const Subject& s, const Kinematics& poses) {
  std::string wrong;
  const double apart = (poses.at(s.a).x - poses.at(s.b).x).norm();
  for (int place = 0; place < 3; ++place) {
    Kinematics k = poses;
    k.twist.assign(k.pose.size(), {});
    for (const BodyId body : {s.a, s.b})
      if (body != kGround && place > 0)
        turn(k, body, 0.01 * apart * Vector2d(std::cos(place + body), std::sin(place + body)),
             0.1 * place + 0.05 * body);
    wrong = compare(s, k);
    if (wrong.empty()) break;
  }
  return wrong;
}

}  // namespace

std::string wrong_derivative(const Joint& joint, const Kinematics& poses) {
  return std::visit(
      [&](const auto& j) {
        const auto [a, b] = bodies_of(j);
        Subject s{a, b, row_count(joint), row_count(joint), "residual", {}, {}, {}, {}, {}};
        s.unit = unit_of(poses.at(a), poses.at(b));
        s.value = [&](const Kinematics& k, double* x) { j.residual(k, x); };
        s.row = [&](const Kinematics& k, Row* G) { j.rows(k, G); };
        if constexpr (requires(double* x) { j.rate(poses, x); })
          s.rate = [&](const Kinematics& k, double* x) { j.rate(k, x); };
        s.bias = [&](const Kinematics& k, double* x) { j.bias(k, x); };
        return compare_around(s, poses);
      },
      joint);
}

std::string wrong_derivative(const Contact& contact, const Kinematics& poses) {
  return std::visit(
      [&](const auto& c) {
        const auto [a, b] = bodies_of(c);
        Subject s{a, b, 2, 1, "gap", {"rows.normal", "rows.tangent"}, {}, {}, {}, {}};
        s.unit = unit_of(poses.at(a), poses.at(b));
        s.value = [&](const Kinematics& k, double* x) { x[0] = c.gap(k); };
        s.row = [&](const Kinematics& k, Row* G) {
          const ContactRows rows = c.rows(k);
          G[0] = rows.normal, G[1] = rows.tangent;
        };
        s.bias = [&](const Kinematics& k, double* x) {
          const ContactBias bias = c.bias(k);
          x[0] = bias.normal, x[1] = bias.tangent;
        };
        return compare_around(s, poses);
      },
      contact);
}

}  // namespace orthant
