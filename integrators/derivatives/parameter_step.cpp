#include <orthant/core/mechanics/dynamics/each_joint.h>
#include <orthant/integrators/derivatives/parameter_step.h>
#include <orthant/integrators/derivatives/spatial_row_slope.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <variant>
#include <vector>

namespace orthant {

namespace {

/// What differs in one element, of four scenes.
template <class Space> class Samples {
 public:
  explicit Samples(const ParameterChangeOf<Space>& change) : change_(change) {}

  /// f(system, values) appends to values.
  template <class F> void take(F&& f) {
    for (std::size_t k = 0; k < 4; ++k) {
      values_[k].clear();
      f(*change_.at[k], values_[k]);
    }
    const auto& w = change_.weights;
    double most = 0, differs = 0, size = 0;
    for (std::size_t i = 0; i < values_[0].size(); ++i) {
      const double x[] = {values_[0][i], values_[1][i], values_[2][i], values_[3][i]};
      for (const double one : x) size = std::max(size, std::abs(one));
      if (x[0] == x[1] && x[1] == x[2] && x[2] == x[3]) continue;
      const double fine = (w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]) / change_.step;
      const double rough = change_.side == 0 ? (x[2] - x[1]) / (2 * change_.step)
                                             : change_.side * (-1.5 * x[0] + 2 * x[1] - 0.5 * x[2]) / change_.step;
      most = std::max(most, std::abs(fine)), differs = std::max(differs, std::abs(fine - rough));
    }
    const double rounding = 0x1p-52 * size / change_.step;
    if (!(most > 16 * rounding)) {  // it does not change at all, or by less than it is rounded
      lost_ = lost_ || most > 0;
      return;
    }
    resolved_ = true;
    const double other = std::max(0.0, differs - 16 * rounding) / most;
    worst_.truncation = std::max(worst_.truncation, std::pow(other, change_.side == 0 ? 2 : 1.5));
    worst_.rounding = std::max(worst_.rounding, rounding / most);
  }
  /// Nothing changes by more than rounding, but something may: the step is lost in it.
  StepError worst() const { return lost_ && !resolved_ ? StepError{worst_.truncation, 1} : worst_; }

 private:
  const ParameterChangeOf<Space>& change_;
  StepError worst_;
  bool lost_ = false, resolved_ = false;
  std::array<std::vector<double>, 4> values_;
};

template <class Space> struct PairSamples {
  explicit PairSamples(const ParameterChangeOf<Space>& of) : change(of) {}
  template <class F> void take(F&& f) {
    std::vector<double> one, other;
    f(*change.at[0], one), f(*change.at[2], other);
    same = same && one == other;
  }
  const ParameterChangeOf<Space>& change;
  bool same = true;
};

template <class Space> void append(const RowOf<Space>& row, std::vector<double>& to) {
  for (const double j : row.ja) to.push_back(row.a >= 0 ? j : 0);
  for (const double j : row.jb) to.push_back(row.b >= 0 ? j : 0);
}

void append(const Eigen::VectorXd& x, std::vector<double>& to) { to.insert(to.end(), x.begin(), x.end()); }

// Each appends all that counts of one element.
template <class Space>
void append_joint(const SystemOf<Space>& s, int joint, const KinematicsOf<Space>& at, std::vector<double>& to) {
  std::visit(
      [&](const auto& j) {
        std::vector<RowOf<Space>> rows(static_cast<std::size_t>(rows_of_joint(j)));
        std::vector<double> phi(rows.size()), rate(rows.size());
        j.rows(at, rows.data()), j.residual(at, phi.data());
        if constexpr (requires(double* r) { j.rate(at, r); }) j.rate(at, rate.data());
        for (std::size_t i = 0; i < rows.size(); ++i) {
          append(rows[i], to);
          to.push_back(phi[i]), to.push_back(rate[i]);
        }
      },
      s.scene().joints[static_cast<std::size_t>(joint)]);
}
template <class Space> void append_spring(const SystemOf<Space>& s, int spring, const KinematicsOf<Space>& at,
                                          const Eigen::VectorXd& v, std::vector<double>& to) {
  std::visit(
      [&](const auto& one) {
        const auto there = one.evaluate(at, v.data());
        append(there.row, to);
        to.push_back(there.tension), to.push_back(one.stiffness), to.push_back(one.damping);
      },
      s.scene().springs[static_cast<std::size_t>(spring)]);
}
template <class Space>
void append_load(const SystemOf<Space>& s, int load, const KinematicsOf<Space>& at, std::vector<double>& to) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(s.dof());
  s.scene().loads[static_cast<std::size_t>(load)].add(at, at.t, f.data());
  append(f, to);
}
template <class Space>
void append_friction(const SystemOf<Space>& s, int friction, const KinematicsOf<Space>& at, std::vector<double>& to) {
  append(s.scene().frictions[static_cast<std::size_t>(friction)].of.row(at), to);
}
void append_contact(const System& /*base*/, const System& s, int contact, const Kinematics& at,
                    std::vector<double>& to) {
  const ContactRows rows =
      std::visit([&](const auto& one) { return one.rows(at); }, s.scene().contacts[static_cast<std::size_t>(contact)]);
  append(rows.normal, to), append(rows.tangent, to);
  to.push_back(gap_of(s, {}, contact, at));
}
/// By the first tangent's axis of `base`, as derivatives have it: it jumps where two components of a normal are equal.
void append_contact(const SystemOf<Spatial>& base, const SystemOf<Spatial>& s, int contact,
                    const KinematicsOf<Spatial>& at, std::vector<double>& to) {
  const Vector3d axis = tangent_axis(base, contact, at);
  const SurfaceRows rows = surface_rows(s, contact, at, &axis);
  for (const auto& row : rows.rows) append(row, to);
  to.insert(to.end(), rows.belt.begin(), rows.belt.end());
  to.push_back(gap_of(s, {}, contact, at));
}

template <class Space, class Samples> void take_elements(const ParameterChangeOf<Space>& change,
                                                         const KinematicsOf<Space>& at, const Eigen::VectorXd& v,
                                                         Samples& samples) {
  using Of = SystemOf<Space>;
  for (const int i : change.joints)
    samples.take([&](const Of& s, std::vector<double>& to) { append_joint(s, i, at, to); });
  for (const int i : change.springs)
    samples.take([&](const Of& s, std::vector<double>& to) { append_spring(s, i, at, v, to); });
  for (const int i : change.frictions)
    samples.take([&](const Of& s, std::vector<double>& to) { append_friction(s, i, at, to); });
  for (const int i : change.loads)
    samples.take([&](const Of& s, std::vector<double>& to) { append_load(s, i, at, to); });
}

/// Whether its rows and gap are those of one formula at values nearby, not those of another corner.
bool of_one_formula(const Contact& contact) {
  return std::visit(
      [](const auto& one) {
        using Kind = std::remove_cvref_t<decltype(one)>;
        return std::is_same_v<Kind, CornerWall> || std::is_same_v<Kind, DiscWall> || std::is_same_v<Kind, DiscDisc> ||
               std::is_same_v<Kind, Journal> || std::is_same_v<Kind, Limit>;
      },
      contact);
}
bool of_one_formula(const spatial::Contact& /*contact*/) { return true; }

constexpr double kSampleTimes[] = {0, 0.381966, 1};  // of the duration

/// [m] Of a pin in a hole, that starts in the middle as a rule, where its contact has no direction. 0: no such contact.
double clearance_of(const Contact& contact) {
  const auto* hole = std::get_if<Journal>(&contact);
  return hole != nullptr ? hole->radius_b - hole->radius_a : 0;
}
double clearance_of(const spatial::Contact& contact) {
  if (const auto* c = std::get_if<spatial::Socket>(&contact)) return c->radius_b - c->radius_a;
  if (const auto* c = std::get_if<spatial::PinBush>(&contact)) return c->radius_b - c->radius_a;
  if (const auto* c = std::get_if<spatial::SphereBush>(&contact)) return c->radius_b - c->radius_a;
  return 0;
}

/// [m] From b's centre, or its axis, to a's centre, in the world, of such a contact.
template <class Space>
typename Space::Vector offset_of(const typename ElementsOf<Space>::Contact& contact, const KinematicsOf<Space>& at) {
  return std::visit(
      [&](const auto& c) -> typename Space::Vector {
        if constexpr (requires { c.across(at); })
          return c.across(at);
        else if constexpr (requires { c.centre_a, c.centre_b; })
          return at.at(c.a).x + at.at(c.a).turn(c.centre_a) - at.at(c.b).x - at.at(c.b).turn(c.centre_b);
        else
          return Space::Vector::Zero();
      },
      contact);
}

/// all: also contacts that may be those of another corner at values nearby.
template <class Space, class Samples> void take_all(const ParameterChangeOf<Space>& change,
                                                    const SystemOf<Space>& system, double duration, bool all,
                                                    Samples& samples) {
  using Of = SystemOf<Space>;
  const State start = system.initial_state();
  KinematicsOf<Space> at = TermsOf<Space>(system).at;
  for (const double part : kSampleTimes) {
    set_poses(system, start.t + part * duration, start.q, at);
    take_elements(change, at, start.v, samples);
  }
  set_poses(system, start.t, start.q, at);
  for (const int i : change.contacts) {
    const auto& contact = system.scene().contacts[static_cast<std::size_t>(i)];
    if (!all && !of_one_formula(contact)) continue;
    const double clearance = clearance_of(contact);
    if (!(clearance > 0)) {
      samples.take([&](const Of& s, std::vector<double>& to) { append_contact(system, s, i, at, to); });
      continue;
    }
    const auto [a, b] = std::visit([](const auto& c) { return bodies_of(c); }, contact);
    for (const double side : {1.0, -1.0}) {  // near the surface
      Eigen::VectorXd away = Eigen::VectorXd::Zero(system.dof()), q;
      set_poses(system, start.t, start.q, at);
      typename Space::Vector way = -offset_of<Space>(contact, at);  // wherever the start has them
      way[0] += side * 0.6 * clearance, way[1] += side * 0.8 * clearance;
      if constexpr (!kPlanar<Space>) way[2] += side * 0.3 * clearance;
      away.segment(Space::kVelocities * (a >= 0 ? a : b), way.size()) = a >= 0 ? way : -way;
      move<Space>(start.q, away, q);
      set_poses(system, start.t, q, at);
      samples.take([&](const Of& s, std::vector<double>& to) { append_contact(system, s, i, at, to); });
    }
    set_poses(system, start.t, start.q, at);
  }
  samples.take([](const Of& s, std::vector<double>& to) { append(s.weight(), to); });
  if constexpr (kPlanar<Space>) {
    samples.take([](const Of& s, std::vector<double>& to) { append(s.mass(), to); });
    samples.take([](const Of& s, std::vector<double>& to) { append(s.initial_state().q, to); });
    samples.take([](const Of& s, std::vector<double>& to) { append(s.initial_state().v, to); });
  } else {
    for (int i = 0; i < system.bodies(); ++i) {
      const auto body = static_cast<std::size_t>(i);
      samples.take([&](const Of& s, std::vector<double>& to) { to.push_back(s.scene().bodies[body].mass); });
      samples.take([&](const Of& s, std::vector<double>& to) {
        const Eigen::Matrix3d tensor = tensor_in_axes(system, s, i);
        to.insert(to.end(), tensor.data(), tensor.data() + 9);
      });
    }
    samples.take([&](const Of& s, std::vector<double>& to) { append(start_in_axes(system, s).q, to); });
    samples.take([&](const Of& s, std::vector<double>& to) { append(start_in_axes(system, s).v, to); });
  }
}

}  // namespace

template <class Space>
StepError error_of_step(const ParameterChangeOf<Space>& change, const SystemOf<Space>& system, double duration) {
  Samples<Space> samples(change);
  take_all(change, system, duration, false, samples);
  return samples.worst();
}

template <class Space> bool same_samples(const ParameterChangeOf<Space>& change, const SystemOf<Space>& system) {
  PairSamples<Space> samples(change);
  take_all(change, system, 1, true, samples);
  return samples.same;
}

void list_elements(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other, double duration,
                   ParameterChangeOf<Spatial>& change) {
  const State start = system.initial_state();
  const Eigen::VectorXd* const at_start = &start.q;
  Eigen::VectorXd away(system.dof()), v(system.dof()), moved;
  for (Eigen::Index i = 0; i < away.size(); ++i) {  // any that have no symmetry
    const auto k = static_cast<double>(i);
    away[i] = 0.1 * std::sin(1 + 2.3 * k), v[i] = std::cos(2 + 1.7 * k);
  }
  move<Spatial>(start.q, away, moved);
  KinematicsOf<Spatial> at = TermsOf<Spatial>(system).at;
  std::vector<double> one, two;
  const auto list = [&](std::size_t count, std::vector<int>& changed, auto&& append_to, auto&& always) {
    for (int i = 0; i < static_cast<int>(count); ++i) {
      bool differs = always(static_cast<std::size_t>(i));
      for (const Eigen::VectorXd* q : {at_start, static_cast<const Eigen::VectorXd*>(&moved)})
        for (const double part : kSampleTimes) {
          if (differs) break;
          set_poses(system, start.t + part * duration, *q, at);
          one.clear(), two.clear();
          append_to(system, i, one), append_to(other, i, two);
          differs = one != two;
        }
      if (differs) changed.push_back(i);
    }
  };
  const auto never = [](std::size_t /*i*/) { return false; };
  const auto &base = system.scene(), &next = other.scene();
  list(
      base.joints.size(), change.joints, [&](const auto& s, int i, auto& to) { append_joint(s, i, at, to); },
      [&](std::size_t i) {
        const auto *x = std::get_if<spatial::Drive>(&base.joints[i]), *y = std::get_if<spatial::Drive>(&next.joints[i]);
        return x != nullptr && y != nullptr && !(x->law.table.times().empty() && y->law.table.times().empty());
      });
  list(
      base.contacts.size(), change.contacts, [&](const auto& s, int i, auto& to) { append_contact(s, s, i, at, to); },
      never);
  list(
      base.springs.size(), change.springs, [&](const auto& s, int i, auto& to) { append_spring(s, i, at, v, to); },
      never);
  list(
      base.frictions.size(), change.frictions, [&](const auto& s, int i, auto& to) { append_friction(s, i, at, to); },
      never);
  list(
      base.loads.size(), change.loads, [&](const auto& s, int i, auto& to) { append_load(s, i, at, to); },
      [&](std::size_t i) { return base.loads[i].factor || next.loads[i].factor; });
}

Eigen::Matrix3d tensor_in_axes(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other, int body) {
  const auto i = static_cast<std::size_t>(body);
  const Eigen::Matrix3d axes = quaternions::matrix_of(system.scene().bodies[i].axes);
  return axes.transpose() * other.scene().bodies[i].inertia * axes;
}

State start_in_axes(const SystemOf<Spatial>& system, const SystemOf<Spatial>& other) {
  State x = other.initial_state();
  for (int i = 0; i < system.bodies(); ++i) {
    const auto body = static_cast<std::size_t>(i);
    const Eigen::Vector4d here = system.scene().bodies[body].axes, there = other.scene().bodies[body].axes;
    const Eigen::Vector4d between_axes = quaternions::product(quaternions::inverse(there), here);
    quaternion(x.q, i) = quaternions::product(Eigen::Vector4d(quaternion(x.q, i)), between_axes);
    rotation<Spatial>(x.v, i) = quaternions::matrix_of(between_axes).transpose() * Vector3d(rotation<Spatial>(x.v, i));
  }
  return x;
}

#define ORTHANT_PARAMETER_STEPS(Space)                                                               \
  template StepError error_of_step(const ParameterChangeOf<Space>&, const SystemOf<Space>&, double); \
  template bool same_samples(const ParameterChangeOf<Space>&, const SystemOf<Space>&);
ORTHANT_PARAMETER_STEPS(Planar)
ORTHANT_PARAMETER_STEPS(Spatial)
#undef ORTHANT_PARAMETER_STEPS

}  // namespace orthant
