// Loads and springs of a planar scene file.
#include "reader.h"

namespace orthant::scene_file {

namespace {

double cosine(double amplitude, double omega, double phase, double t) {
  return amplitude * std::cos(omega * t + phase);
}

/// Linear between the points, constant outside.
double interpolate(const std::vector<double>& times, const std::vector<double>& values, double t) {
  const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  if (next == 0) return values.front();
  if (next == times.size()) return values.back();
  const double s = (t - times[next - 1]) / (times[next] - times[next - 1]);
  return (1 - s) * values[next - 1] + s * values[next];
}

}  // namespace

void Reader::friction(Fields& f) {
  JointFriction friction;
  f.maybe("name", friction.name);
  friction.of = coordinate(f);
  f.maybe("mu", friction.mu), f.maybe("radius", friction.radius);
  if (!f.maybe("bound", friction.bound) && !friction.loaded()) f.miss("bound");
  if (friction.loaded())
    for (const Joint& one : scene_.joints)
      if (std::visit([](const auto& j) { return j.name; }, one) == f.table()["joint"].value_or(std::string()))
        friction.joint = static_cast<int>(&one - scene_.joints.data());
  scene_.friction(friction);
}

void Reader::spring(Fields& f) {
  std::string type, name;
  f.need("type", type), f.maybe("name", name);
  if (type == "point") {
    PointSpring s{.name = name};
    points_of(f, s), f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
    if (!f.maybe("rest", s.rest)) s.rest = initial_length(s);
    scene_.spring(s);
  } else if (type == "torsion") {
    TorsionSpring s{.name = name};
    bodies_of(f, s), f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
    if (!f.maybe("rest", s.rest)) s.rest = initial_angle(s.a, s.b);
    scene_.spring(s);
  } else if (type == "joint") {
    JointSpring s{.name = name, .of = coordinate(f)};
    f.maybe("stiffness", s.stiffness), f.maybe("damping", s.damping);
    if (!f.maybe("rest", s.rest)) s.rest = s.of.value(initial_);
    scene_.spring(s);
  } else {
    f.refuse("type", *f.table().get("type"), "point, torsion or joint");
  }
}

void Reader::load(Fields& f) {
  Load l;
  f.maybe("name", l.name);
  l.body = body_of(f), f.maybe("point", l.point), f.maybe("force", l.force), f.maybe("torque", l.torque);
  if (const toml::table* table = f.inner("factor")) {
    Fields g = f.fields("factor", *table);
    set_factor(g, l.factor, l.breakpoints, l.omega);
    g.done();
  }
  scene_.load(l);
}

void Reader::set_factor(Fields& f, std::function<double(double)>& factor, std::vector<double>& breakpoints,
                        double& swing) {
  std::string type;
  f.need("type", type);
  if (type == "cosine") {
    double amplitude = 1, omega = 0, phase = 0;
    f.maybe("amplitude", amplitude), f.need("omega", omega), f.maybe("phase", phase);
    factor = [=](double t) { return cosine(amplitude, omega, phase, t); };
    swing = std::abs(omega);
    return;
  }
  if (type != "table" && type != "spline") f.refuse("type", *f.table().get("type"), "cosine, table or spline");
  const auto [times, values] = points_in_time(f);
  breakpoints = times;
  if (type == "spline") {
    try {
      factor = [spline = Spline(times, values)](double t) { return spline.value(t); };
    } catch (const std::invalid_argument& error) {
      f.fail(f.table(), error.what());
    }
    return;
  }
  factor = [times = times, values = values](double t) { return interpolate(times, values, t); };
}

std::pair<std::vector<double>, std::vector<double>> Reader::points_in_time(Fields& f) {
  std::vector<double> times, values;
  f.need("times", times), f.need("values", values);
  const toml::node& written = *f.table().get("times");
  if (times.empty()) f.refuse("times", written, "at least one time");
  if (times.size() != values.size()) f.refuse("times", written, "as many as values");
  if (std::adjacent_find(times.begin(), times.end(), std::greater_equal<>()) != times.end())
    f.refuse("times", written, "ascending");
  return {times, values};
}

}  // namespace orthant::scene_file
