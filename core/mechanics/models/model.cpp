#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/model.h>
#include <orthant/core/mechanics/spatial/inertia.h>
#include <orthant/core/support/options.h>

#include <cmath>

namespace orthant::models {

void ModelOptions::set(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos)
    throw std::invalid_argument("option model." + shortened(text) + ": must have the form model.KEY=VALUE");
  const std::string_view key = text.substr(0, equals);
  std::string_view value = text.substr(equals + 1);
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  const std::string name = "model." + shortened(key);
  const auto number = [&] {
    const double x = detail::parse_number<double>(name, value);
    if (!std::isfinite(x))
      throw std::invalid_argument("option " + name + " = " + shortened(value) + ": must be finite");
    return x;
  };
  const auto choice = [&](const char* first, const char* second) {
    if (value != first && value != second)
      throw std::invalid_argument("option " + name + " = '" + shortened(value) + "': must be one of " + first + ", " +
                                  second);
    return value == second;
  };
  if (key == "base") {
    base = choice("fixed", "free") ? Base::free : Base::fixed;
  } else if (key == "fixed_joints") {
    fixed_joints = choice("merge", "keep") ? FixedJoints::keep : FixedJoints::merge;
  } else if (key == "folder") {
    folder = value;
  } else if (key == "floor") {
    floor = number();
  } else if (key == "mu") {
    mu = number();
    if (!(mu >= 0 && mu <= 1e6))
      throw std::invalid_argument("option " + name + " = " + shortened(value) + ": must be in [0, 1e6]");
  } else if (key.starts_with("at.")) {
    if (!at.emplace(key.substr(3), number()).second) throw std::invalid_argument("option " + name + ": is given twice");
  } else {
    throw std::invalid_argument("unknown option " + name +
                                ": must be one of model.base, model.fixed_joints, model.folder, model.floor, "
                                "model.mu, model.at.JOINT");
  }
}

void check_inertia(const XmlElement& element, const Matrix3d& inertia) {
  const Vector3d J = spatial::principal(inertia).moments;
  const auto text = [](const Vector3d& x) {
    return detail::text_of(x.x()) + ", " + detail::text_of(x.y()) + ", " + detail::text_of(x.z());
  };
  if (!(J.minCoeff() > 0)) refuse(element, "principal moments of inertia (" + text(J) + "): must be > 0");
  if (2 * J.maxCoeff() > J.sum() + 1e-9 * J.maxCoeff())
    refuse(element, "principal moments of inertia (" + text(J) +
                        "): must be those of a body, no one larger than the sum of the others");
}

void add_mass(ModelLink& link, double mass, const Vector3d& centre, const Matrix3d& inertia) {
  if (!(mass > 0)) return;
  const double all = link.mass + mass;
  const Vector3d c = (link.mass * link.centre + mass * centre) / all;
  const auto moved = [&](double m, const Vector3d& from) {  // the parallel axis theorem
    const Vector3d d = from - c;
    return Matrix3d(m * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose()));
  };
  link.inertia = Matrix3d(link.inertia + moved(link.mass, link.centre) + inertia + moved(mass, centre));
  link.centre = c, link.mass = all;
}

}  // namespace orthant::models
