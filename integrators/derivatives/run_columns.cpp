#include <orthant/integrators/derivatives/run_columns.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace orthant {

RunSteps::RunSteps(const Clock& clock) : step(clock.step), duration(clock.duration), every(clock.every) {
  whole = static_cast<long>(std::floor(duration / step * (1 + 1e-12) + 1e-9));
  rest = duration - static_cast<double>(whole) * step;
  total = whole + (whole == 0 || rest > 1e-9 * step ? 1 : 0);
}

ColumnSlopes::ColumnSlopes(const System& system, std::vector<RunColumn> columns)
    : system_(system), columns_(std::move(columns)), at_(Terms(system).at) {
  for (const RunColumn& column : columns_) {
    const bool state = column.kind == RunColumn::Kind::state;
    if (column.place < 0 || column.place >= (state ? 2 * system.dof() : system.listed()))
      throw std::invalid_argument("column of a run: place must be 0 to " +
                                  std::to_string((state ? 2 * system.dof() : system.listed()) - 1));
    any_gap_ = any_gap_ || column.kind == RunColumn::Kind::gap;
    any_impulse_ = any_impulse_ || column.kind == RunColumn::Kind::normal || column.kind == RunColumn::Kind::tangent;
  }
}

void ColumnSlopes::set_up(const State& x) {
  if (any_gap_) set_poses(system_, x.t, x.q, at_);
}

double ColumnSlopes::value(std::size_t i, const State& x) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::gap) return gap_of(system_, {}, static_cast<int>(column.place), at_);
  if (column.kind != RunColumn::Kind::state) return 0;
  return column.place < system_.dof() ? x.q[column.place] : x.v[column.place - system_.dof()];
}

double ColumnSlopes::push(std::size_t i, const ParameterChange& parameter, const double* q, const double* v) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::state)
    return column.place < system_.dof() ? q[column.place] : v[column.place - system_.dof()];
  if (column.kind != RunColumn::Kind::gap) return 0;
  const Contact& contact = system_.scene().contacts[static_cast<std::size_t>(column.place)];
  return apply(std::visit([&](const auto& c) { return c.rows(at_).normal; }, contact), q) + by_parameter(i, parameter);
}

void ColumnSlopes::pull(std::size_t i, double weight, double* q, double* v) const {
  const RunColumn& column = columns_[i];
  if (column.kind == RunColumn::Kind::state)
    (column.place < system_.dof() ? q[column.place] : v[column.place - system_.dof()]) += weight;
  if (column.kind != RunColumn::Kind::gap) return;
  const Contact& contact = system_.scene().contacts[static_cast<std::size_t>(column.place)];
  apply_transposed(std::visit([&](const auto& c) { return c.rows(at_).normal; }, contact), weight, q);
}

double ColumnSlopes::by_parameter(std::size_t i, const ParameterChange& parameter) const {
  const RunColumn& column = columns_[i];
  const auto& changed = parameter.contacts;
  if (column.kind != RunColumn::Kind::gap || std::find(changed.begin(), changed.end(), column.place) == changed.end())
    return 0;
  return parameter.derivative<1>(
      [&](const System& s, std::array<double, 1>& x) { x[0] = gap_of(s, {}, static_cast<int>(column.place), at_); })[0];
}

}  // namespace orthant
