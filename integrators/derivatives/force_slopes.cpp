#include <orthant/integrators/derivatives/force_slopes.h>

namespace orthant {

void append_force_slopes(const System& system, Terms& terms, const ForceShare& share, const Eigen::VectorXd& v,
                         const Eigen::VectorXd& change, Eigen::Index out, std::vector<Slope>& by_pose,
                         std::vector<Slope>& by_velocity) {
  const auto& scene = system.scene();
  const double tau = share.duration;
  RowSlope slope;
  for (std::size_t i = 0; i < scene.springs.size(); ++i) {
    const Row& row = terms.springs[i].row;
    const double k = std::visit([](const auto& s) { return s.stiffness; }, scene.springs[i]);
    const double c = std::visit([](const auto& s) { return s.damping; }, scene.springs[i]);
    const double weight = share.stiffness_weight * k + share.damping_weight * c;
    slope_of(scene.springs[i], terms.at, slope);
    const double s = tau * terms.springs[i].tension + weight * apply(row, change.data());  // r has s rowᵀ
    // ṙ = ṡ rowᵀ + s rowᵀ˙,  ṡ = τ k row q̇ + row˙ (τ c v + weight change) + (τ c − weight) row v̇
    for (const Slope& d : slope) {
      by_pose.push_back({out + d.of, d.by, s * d.value});
      const double of_s = d.value * (tau * c * v[d.of] + weight * change[d.of]);
      each_entry(row, [&](Eigen::Index place, double j) { by_pose.push_back({out + place, d.by, j * of_s}); });
    }
    const double by_rate = tau * c - weight;
    each_entry(row, [&](Eigen::Index place, double j) {
      each_entry(row, [&](Eigen::Index other, double l) {
        by_pose.push_back({out + place, other, j * tau * k * l});
        if (by_rate != 0) by_velocity.push_back({out + place, other, j * by_rate * l});
      });
    });
  }
  for (const Load& load : scene.loads) {
    const double scale = load.factor ? load.factor(terms.at.t) : 1.0;
    const double slope_of_torque = scale * cross(perp(terms.at.at(load.body).turn(load.point)), load.force);
    const Eigen::Index turn = kBlock * load.body + 2;
    if (slope_of_torque != 0) by_pose.push_back({out + turn, turn, -tau * slope_of_torque});
  }
}

void append_force_parts(const ParameterChange& parameter, const System& system, const Terms& terms,
                        const ForceShare& share, const Eigen::VectorXd& v, const Eigen::VectorXd& change,
                        Eigen::Index out, SparsePart& part) {
  const double tau = share.duration;
  for (Eigen::Index i = 0; i < parameter.weight.size(); ++i)
    if (parameter.weight[i] != 0) part.emplace_back(out + i, -tau * parameter.weight[i]);
  for (const int spring : parameter.springs) {
    const auto i = static_cast<std::size_t>(spring);
    const auto d = parameter.derivative<6>([&](const System& s, std::array<double, 6>& x) {
      std::visit(
          [&](const auto& other) {
            const SpringState there = other.evaluate(terms.at, v.data());
            const double weight = share.stiffness_weight * other.stiffness + share.damping_weight * other.damping;
            const auto entries = entries_of(there.row);
            const double force = tau * there.tension + weight * apply(there.row, change.data());
            for (std::size_t k = 0; k < 6; ++k) x[k] = force * entries[k];
          },
          s.scene().springs[i]);
    });
    const Row& row = terms.springs[i].row;
    for (int k = 0; k < 6; ++k)
      if (const BodyId body = k < 3 ? row.a : row.b; body >= 0)
        part.emplace_back(out + kBlock * body + k % 3, d[static_cast<std::size_t>(k)]);
  }
  std::vector<double> f;
  for (const int load : parameter.loads) {
    const auto i = static_cast<std::size_t>(load);
    const BodyId body = system.scene().loads[i].body;
    f.resize(static_cast<std::size_t>(system.dof()));
    const auto d = parameter.derivative<3>([&](const System& s, std::array<double, 3>& x) {
      double* const there = f.data() + kBlock * body;
      there[0] = there[1] = there[2] = 0;
      s.scene().loads[i].add(terms.at, terms.at.t, f.data());
      x = {there[0], there[1], there[2]};
    });
    for (int k = 0; k < 3; ++k) part.emplace_back(out + kBlock * body + k, -tau * d[static_cast<std::size_t>(k)]);
  }
}

}  // namespace orthant
