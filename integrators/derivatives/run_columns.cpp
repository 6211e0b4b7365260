#include <orthant/integrators/derivatives/run_columns.h>
#include <orthant/integrators/derivatives/spatial_row_slope.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

RunSteps::RunSteps(const Clock& clock) : step(clock.step), duration(clock.duration), every(clock.every) {
  whole = static_cast<long>(std::floor(duration / step * (1 + 1e-12) + 1e-9));
  rest = duration - static_cast<double>(whole) * step;
  total = whole + (whole == 0 || rest > 1e-9 * step ? 1 : 0);
}

double& impulse_of(RunColumn column, ImpulseChange& change) {
  using Kind = RunColumn::Kind;
  return (column.kind == Kind::normal    ? change.normal
          : column.kind == Kind::tangent ? change.tangent
          : column.kind == Kind::across  ? change.across
                                         : change.friction)[column.place];
}

namespace {

constexpr Index kSpatialColumns = 13;  // of a body

/// The change of column `part` of a body as a function of (δφ, δv or δω): 6 numbers, of the place's block of q or v.
struct SpatialColumn {
  Index body, part;
  explicit SpatialColumn(Index place) : body(place / kSpatialColumns), part(place % kSpatialColumns) {}
  bool position() const { return part < 3; }
  bool orientation() const { return part >= 3 && part < 7; }
  bool velocity() const { return part >= 7 && part < 10; }
};

Eigen::Vector4d orientation_of(const SystemOf<Spatial>& system, const State& x, Index body) {
  return quaternions::product(quaternion(x.q, body), quaternions::inverse(system.scene().bodies[at(body)].axes));
}

double value_at(const System& system, const State& x, Index place) {
  return place < system.dof() ? x.q[place] : x.v[place - system.dof()];
}
double value_at(const SystemOf<Spatial>& system, const State& x, Index place) {
  const SpatialColumn c(place);
  if (c.position()) return place_of<Spatial>(x.q, c.body)[c.part];
  if (c.orientation()) return orientation_of(system, x, c.body)[c.part - 3];
  if (c.velocity()) return translation<Spatial>(x.v, c.body)[c.part - 7];
  return (quaternions::matrix_of(quaternion(x.q, c.body)) * rotation<Spatial>(x.v, c.body))[c.part - 10];
}

/// Calls f(entry of q, value, entry of v, value) for what a column of the state changes by; −1: none.
template <class F> void each_slope(const SystemOf<Spatial>& system, const State& x, Index place, F&& f) {
  const SpatialColumn c(place);
  const Index first = Spatial::kVelocities * c.body;
  if (c.position()) return f(first + c.part, 1.0, Index{-1}, 0.0);
  if (c.velocity()) return f(Index{-1}, 0.0, first + c.part - 7, 1.0);
  const Eigen::Vector4d q = quaternion(x.q, c.body);
  const Eigen::Matrix3d R = quaternions::matrix_of(q);
  const Vector3d omega = rotation<Spatial>(x.v, c.body);
  for (Index i = 0; i < 3; ++i) {
    if (c.orientation()) {  // q (0, δφ)/2 axes⁻¹
      Eigen::Vector4d turn = Eigen::Vector4d::Zero();
      turn[i + 1] = 0.5;
      const Eigen::Vector4d back = quaternions::inverse(system.scene().bodies[at(c.body)].axes);
      f(first + 3 + i, quaternions::product(quaternions::product(q, turn), back)[c.part - 3], Index{-1}, 0.0);
    } else {  // R (δφ × ω + δω)
      const Vector3d by_turn = R * Vector3d::Unit(i).cross(omega);
      f(first + 3 + i, by_turn[c.part - 10], first + 3 + i, R(c.part - 10, i));
    }
  }
}

template <class Space> Index places_of_state(const SystemOf<Space>& system) {
  return kPlanar<Space> ? 2 * system.dof() : kSpatialColumns * system.bodies();
}

/// Calls f(place, slope by q there, slope by v there) for each of the energy's: M v, and what weights and springs ask.
template <class Space, class F>
void each_energy_slope(const SystemOf<Space>& system, const KinematicsOf<Space>& at, const State& x, F&& f) {
  for (Index i = 0; i < system.dof(); ++i) f(i, -system.weight()[i], system.mass()[i] * x.v[i]);
  if (system.scene().springs.empty()) return;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(system.dof());
  for (const auto& spring : system.scene().springs) {
    const SpringStateOf<Space> s = std::visit([&](const auto& one) { return one.evaluate(at, rest.data()); }, spring);
    each_entry(s.row, [&](Index place, double j) { f(place, s.tension * j, 0.0); });
  }
}

/// What a parameter changes of the energy of a state.
template <class Space>
double energy_by_parameter(const ParameterChangeOf<Space>& parameter, const KinematicsOf<Space>& at, const State& x) {
  double sum = 0;
  if (parameter.mass.size() > 0) sum += 0.5 * x.v.dot(parameter.mass.cwiseProduct(x.v));
  for (const auto& [body, inertia] : parameter.inertia) {
    const auto& spin = rotation<Spatial>(x.v, body);
    sum += 0.5 * spin.dot(inertia * spin);
  }
  for (Index body = 0; body < std::ssize(parameter.other().scene().bodies) && parameter.weight.size() > 0; ++body)
    sum -= translation<Space>(parameter.weight, body).dot(place_of<Space>(x.q, body));
  for (const int spring : parameter.springs)
    sum += parameter.template derivative<1>([&](const SystemOf<Space>& s, std::array<double, 1>& energy) {
      energy[0] = std::visit([&](const auto& one) { return one.evaluate(at, x.v.data()).energy; },
                             s.scene().springs[static_cast<std::size_t>(spring)]);
    })[0];
  return sum;
}

/// The gap's slopes by the pose. They are the normal row but where the gap's point is neither held by the bodies nor
/// the nearest one: points of a rim next to the lowest one, whose slopes are differences.
template <class Space>
RowOf<Space> gap_row(const SystemOf<Space>& system, int contact, const KinematicsOf<Space>& at, const State& x) {
  const auto& one = system.scene().contacts[static_cast<std::size_t>(contact)];
  RowOf<Space> row = std::visit([&](const auto& c) { return c.rows(at).normal; }, one);
  if constexpr (!kPlanar<Space>) {
    const auto* rim = std::get_if<spatial::RimPlane>(&one);
    if (rim == nullptr || rim->phase == 0) return row;
    const double turning = turning_length(system, contact, at);
    if (turning == 0) return row;
    const double way = PoseDifferences::way_of(turning);
    KinematicsOf<Space> there = at;
    Eigen::VectorXd q, step = Eigen::VectorXd::Zero(system.dof());
    const auto differ = [&](BodyId body, typename RowOf<Space>::Entries& entries) {
      for (std::size_t i = 0; i < entries.size() && body >= 0; ++i) {
        const Index place = Space::kVelocities * Index{body} + static_cast<Index>(i);
        double sum = 0;
        for (const auto& [k, weight] : {std::pair(-2, 1. / 12), {-1, -8. / 12}, {1, 8. / 12}, {2, -1. / 12}}) {
          step[place] = k * way;
          move<Space>(x.q, step, q);
          set_poses(system, x.t, q, there);
          sum += weight * gap_of(system, {}, contact, there);
        }
        step[place] = 0;
        entries[i] = sum / way;
      }
    };
    differ(row.a, row.ja), differ(row.b, row.jb);
  }
  return row;
}

}  // namespace

template <class Space> ColumnSlopesOf<Space>::ColumnSlopesOf(const System& system, std::vector<RunColumn> columns)
    : system_(system), columns_(std::move(columns)), at_(TermsOf<Space>(system).at) {
  for (const RunColumn& column : columns_) {
    const Index count = column.kind == RunColumn::Kind::state      ? places_of_state(system)
                        : column.kind == RunColumn::Kind::energy   ? 1
                        : column.kind == RunColumn::Kind::friction ? std::ssize(system.scene().frictions)
                                                                   : system.listed();
    if (column.place < 0 || column.place >= count)
      throw std::invalid_argument("column of a run: place must be 0 to " + std::to_string(count - 1));
    if (column.kind == RunColumn::Kind::across) {
      if (kPlanar<Space>) throw std::invalid_argument("column of a run: impulses across are in space");
      if (system.law(static_cast<int>(column.place)).surface.orthotropic())
        throw std::invalid_argument(
            "column of a run: the second tangent's impulse of a contact with mu_across has no derivative here");
    }
    any_gap_ = any_gap_ || column.kind == RunColumn::Kind::gap;
    any_energy_ = any_energy_ || column.kind == RunColumn::Kind::energy;
    any_impulse_ = any_impulse_ || column.impulse();
  }
}

template <class Space> void ColumnSlopesOf<Space>::set_up(const State& x) {
  if (any_by_parameter()) set_poses(system_, x.t, x.q, at_);
  if (any_energy_ || !kPlanar<Space>) x_ = x;
}

template <class Space> double ColumnSlopesOf<Space>::value(std::size_t i, const State& x) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::gap) return gap_of(system_, {}, static_cast<int>(column.place), at_);
  if (column.kind == RunColumn::Kind::energy) return energy(system_, x);
  return column.kind == RunColumn::Kind::state ? value_at(system_, x, column.place) : 0;
}

template <class Space> double ColumnSlopesOf<Space>::push(std::size_t i, const ParameterChange& parameter,
                                                          const double* q, const double* v) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::state) {
    if constexpr (kPlanar<Space>) {
      return column.place < system_.dof() ? q[column.place] : v[column.place - system_.dof()];
    } else {
      double sum = 0;
      each_slope(system_, x_, column.place, [&](Index of_q, double by_q, Index of_v, double by_v) {
        if (of_q >= 0) sum += by_q * q[of_q];
        if (of_v >= 0) sum += by_v * v[of_v];
      });
      return sum;
    }
  }
  if (column.kind == RunColumn::Kind::energy) {
    double sum = by_parameter(i, parameter);
    each_energy_slope(system_, at_, x_,
                      [&](Index place, double by_q, double by_v) { sum += by_q * q[place] + by_v * v[place]; });
    return sum;
  }
  if (column.kind != RunColumn::Kind::gap) return 0;
  return apply(gap_row(system_, static_cast<int>(column.place), at_, x_), q) + by_parameter(i, parameter);
}

template <class Space> void ColumnSlopesOf<Space>::pull(std::size_t i, double weight, double* q, double* v) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::state) {
    if constexpr (kPlanar<Space>)
      (column.place < system_.dof() ? q[column.place] : v[column.place - system_.dof()]) += weight;
    else
      each_slope(system_, x_, column.place, [&](Index of_q, double by_q, Index of_v, double by_v) {
        if (of_q >= 0) q[of_q] += weight * by_q;
        if (of_v >= 0) v[of_v] += weight * by_v;
      });
  }
  if (column.kind == RunColumn::Kind::energy)
    each_energy_slope(system_, at_, x_, [&](Index place, double by_q, double by_v) {
      q[place] += weight * by_q, v[place] += weight * by_v;
    });
  if (column.kind != RunColumn::Kind::gap) return;
  apply_transposed(gap_row(system_, static_cast<int>(column.place), at_, x_), weight, q);
}

template <class Space>
double ColumnSlopesOf<Space>::by_parameter(std::size_t i, const ParameterChange& parameter) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::energy) return parameter.of_scene() ? energy_by_parameter(parameter, at_, x_) : 0;
  const auto& changed = parameter.contacts;
  if (column.kind != RunColumn::Kind::gap || std::find(changed.begin(), changed.end(), column.place) == changed.end())
    return 0;
  return parameter.template derivative<1>(
      [&](const System& s, std::array<double, 1>& x) { x[0] = gap_of(s, {}, static_cast<int>(column.place), at_); })[0];
}

template class ColumnSlopesOf<Planar>;
template class ColumnSlopesOf<Spatial>;

}  // namespace orthant
