#include <orthant/integrators/derivatives/spatial_force_slopes.h>

#include <algorithm>

namespace orthant {

namespace {

constexpr std::size_t kForceEntries = 2 * Spatial::kVelocities;

/// Its damping coefficient at the moment.
double damping_of(const spatial::Spring& spring, const SpringStateOf<Spatial>& there) {
  return std::visit(
      [&](const auto& s) {
        return std::is_same_v<std::remove_cvref_t<decltype(s)>, spatial::Drag> ? there.damping : s.damping;
      },
      spring);
}
double stiffness_of(const spatial::Spring& spring) {
  return std::visit([](const auto& s) { return static_cast<double>(s.stiffness); }, spring);
}

/// Twelve entries of r, those of the row's bodies. Returns the row.
RowOf<Spatial> force_in_step(const spatial::Spring& spring, const KinematicsOf<Spatial>& at, const ForceShare& share,
                             const Eigen::VectorXd& v, const Eigen::VectorXd& w, double* to) {
  const auto there = std::visit([&](const auto& s) { return s.evaluate(at, v.data()); }, spring);
  const double weight =
      share.stiffness_weight * stiffness_of(spring) + share.damping_weight * damping_of(spring, there);
  const double force =
      share.duration * there.tension + weight * (apply(there.row, w.data()) - apply(there.row, v.data()));
  const auto entries = entries_of(there.row);
  for (std::size_t k = 0; k < kForceEntries; ++k) to[k] = force * entries[k];
  return there.row;
}

/// By v: along the row, but of drag also through its coefficient.
void append_velocity_slopes(const spatial::Spring& spring, const KinematicsOf<Spatial>& at, const ForceShare& share,
                            const Eigen::VectorXd& v, const Eigen::VectorXd& w, std::vector<Slope>& by_velocity) {
  const auto there = std::visit([&](const auto& s) { return s.evaluate(at, v.data()); }, spring);
  const RowOf<Spatial>& row = there.row;
  const auto* drag = std::get_if<spatial::Drag>(&spring);
  if (drag != nullptr && drag->quadratic > 0) {
    constexpr double kPart = 1e-3;  // of the speed: c₂ |u| changes within it smoothly
    const double step = kPart * (there.damping - drag->damping) / drag->quadratic;
    if (step > 0) {
      Eigen::VectorXd moved = v;
      std::array<std::array<double, kForceEntries>, 4> values{};
      for (int c = 0; c < Spatial::kVelocities; ++c) {
        const Eigen::Index by = Spatial::kVelocities * row.a + c;
        constexpr int kPlaces[] = {-2, -1, 1, 2};
        for (std::size_t k = 0; k < 4; ++k) {
          moved[by] = v[by] + kPlaces[k] * step;
          force_in_step(spring, at, share, moved, w, values[k].data());
        }
        moved[by] = v[by];
        for (std::size_t i = 0; i < kForceEntries; ++i)
          if (const Eigen::Index of = place_of_entry(row, i); of >= 0)
            by_velocity.push_back(
                {of, by, (values[0][i] - 8 * values[1][i] + 8 * values[2][i] - values[3][i]) / (12 * step)});
      }
      return;
    }
  }
  const double weight =
      share.stiffness_weight * stiffness_of(spring) + share.damping_weight * damping_of(spring, there);
  const double by_rate = share.duration * damping_of(spring, there) - weight;
  if (by_rate == 0) return;
  each_entry(row, [&](Eigen::Index place, double j) {
    each_entry(row, [&](Eigen::Index other, double l) { by_velocity.push_back({place, other, j * by_rate * l}); });
  });
}

}  // namespace

void append_added_mass(const SystemOf<Spatial>& system, const TermsOf<Spatial>& terms, const ForceShare& share,
                       std::vector<Slope>& added) {
  const auto& springs = system.scene().springs;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const double weight = share.stiffness_weight * stiffness_of(springs[i]) +
                          share.damping_weight * damping_of(springs[i], terms.springs[i]);
    const RowOf<Spatial>& row = terms.springs[i].row;
    each_entry(row, [&](Eigen::Index place, double j) {
      each_entry(row, [&](Eigen::Index other, double l) { added.push_back({place, other, weight * j * l}); });
    });
  }
}

void append_force_slopes(const SystemOf<Spatial>& system, TermsOf<Spatial>& terms, const ForceShare& share,
                         const Eigen::VectorXd& v, const Eigen::VectorXd& w, std::vector<Slope>& by_pose,
                         std::vector<Slope>& by_velocity) {
  const auto& scene = system.scene();
  for (const auto& spring : scene.springs) {
    append_velocity_slopes(spring, terms.at, share, v, w, by_velocity);
    PoseDifferences::Values here{};
    const RowOf<Spatial> row = force_in_step(spring, terms.at, share, v, w, here.data());
    PoseDifferences::each(
        terms.at, row.a, row.b, kForceEntries,
        [&](const KinematicsOf<Spatial>& k, PoseDifferences::Values& values) {
          force_in_step(spring, k, share, v, w, values.data());
        },
        [&](Eigen::Index by, const PoseDifferences::Values& slope) {
          for (std::size_t k = 0; k < kForceEntries; ++k)
            if (const Eigen::Index of = place_of_entry(row, k); of >= 0 && slope[k] != 0)
              by_pose.push_back({of, by, slope[k]});
        });
  }
  Eigen::VectorXd f = Eigen::VectorXd::Zero(system.dof());
  for (const auto& load : scene.loads) {
    double* const there = f.data() + Spatial::kVelocities * load.body;
    PoseDifferences::each(
        terms.at, load.body, kGround, Spatial::kVelocities,
        [&](const KinematicsOf<Spatial>& k, PoseDifferences::Values& values) {
          std::fill(there, there + Spatial::kVelocities, 0.0);
          load.add(k, k.t, f.data());
          std::copy(there, there + Spatial::kVelocities, values.begin());
        },
        [&](Eigen::Index by, const PoseDifferences::Values& slope) {
          for (int k = 0; k < Spatial::kVelocities; ++k)
            if (const double value = slope[static_cast<std::size_t>(k)]; value != 0)
              by_pose.push_back({Spatial::kVelocities * load.body + k, by, -share.duration * value});
        });
  }
}

void append_force_parts(const ParameterChangeOf<Spatial>& parameter, const SystemOf<Spatial>& system,
                        const TermsOf<Spatial>& terms, const ForceShare& share, const Eigen::VectorXd& v,
                        const Eigen::VectorXd& w, SparsePart& part) {
  for (Eigen::Index i = 0; i < parameter.weight.size(); ++i)
    if (parameter.weight[i] != 0) part.emplace_back(i, -share.duration * parameter.weight[i]);
  for (const int spring : parameter.springs) {
    const auto i = static_cast<std::size_t>(spring);
    const auto d =
        parameter.derivative<kForceEntries>([&](const SystemOf<Spatial>& s, std::array<double, kForceEntries>& x) {
          force_in_step(s.scene().springs[i], terms.at, share, v, w, x.data());
        });
    for (std::size_t k = 0; k < kForceEntries; ++k)
      if (const Eigen::Index place = place_of_entry(terms.springs[i].row, k); place >= 0)
        part.emplace_back(place, d[k]);
  }
  Eigen::VectorXd f = Eigen::VectorXd::Zero(system.dof());
  for (const int load : parameter.loads) {
    const auto i = static_cast<std::size_t>(load);
    const Eigen::Index first = Spatial::kVelocities * static_cast<Eigen::Index>(system.scene().loads[i].body);
    const auto d = parameter.derivative<6>([&](const SystemOf<Spatial>& s, std::array<double, 6>& x) {
      f.segment<6>(first).setZero();
      s.scene().loads[i].add(terms.at, terms.at.t, f.data());
      std::copy_n(f.data() + first, 6, x.begin());
    });
    for (Eigen::Index k = 0; k < 6; ++k) part.emplace_back(first + k, -share.duration * d[static_cast<std::size_t>(k)]);
  }
}

}  // namespace orthant
