// Parameters in the equations of a step of rattle: see rattle_linearization.h.
#include <orthant/integrators/derivatives/rattle_linearization.h>

#include <algorithm>

namespace orthant {

namespace {

/// (Jᵀ)_p impulse, from the entries' derivatives.
void add_push(const Row& row, const double* six, double impulse, Index out, SparsePart& part) {
  if (impulse == 0) return;
  for (int i = 0; i < 6; ++i)
    if (const BodyId body = i < 3 ? row.a : row.b; body >= 0)
      part.emplace_back(out + kBlock * body + i % 3, impulse * six[i]);
}

/// J_p v.
double rate_by(const Row& row, const double* six, const Eigen::VectorXd& v) {
  double sum = 0;
  for (int i = 0; i < 6; ++i)
    if (const BodyId body = i < 3 ? row.a : row.b; body >= 0) sum += six[i] * v[kBlock * body + i % 3];
  return sum;
}

void put_entries(const Row& row, double* six) {
  const auto entries = entries_of(row);
  std::copy(entries.begin(), entries.end(), six);
}

}  // namespace

void RattleLinearization::part_of(const ParameterChange& parameter, StepPart& part) {
  part.step.clear(), part.projection.clear();
  if (!parameter.of_scene()) return;
  const double h = step_->h;
  for (Index i = 0; i < parameter.mass.size(); ++i)
    if (const double by = parameter.mass[i]; by != 0) {
      part.step.emplace_back(i, by * kick_[i]);
      part.step.emplace_back(at_.r4 + i, by * (free_[i] - u_[i]));
      part.step.emplace_back(at_.r7 + i, by * pushed_[i]);
    }
  append_force_parts(parameter, system_, start_, {h / 2, 0, h / 2}, step_->before.v, kick_, 0, part.step);
  append_force_parts(parameter, system_, end_, {h / 2, 0, 0}, u_, none_, at_.r4, part.step);
  contact_parts(parameter, part.step);
  joint_parts(parameter, part.step);
  friction_parts(parameter, part.step);
}

void RattleLinearization::contact_parts(const ParameterChange& parameter, SparsePart& part) {
  const RattleTrace& step = *step_;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    for (const ParameterChange::Law& d : parameter.laws)
      if (d.contact == step.contacts[k].contact) law_part(d, k, part);
    if (std::ranges::find(parameter.contacts, step.contacts[k].contact) != parameter.contacts.end())
      moved_contact_part(parameter, k, part);
  }
  for (const Stage* stage : {&position_, &velocity_}) {
    const Index place = (stage == &position_ ? at_.w1 : at_.w2) + 2 * stage->rows;
    for (std::size_t f = 0; f < stage->mu_of.size(); ++f)
      for (const ParameterChange::Law& d : parameter.laws)
        if (d.contact == stage->mu_of[f].first)
          part.emplace_back(place + static_cast<Index>(f), stage->mu_of[f].second ? d.mu_static : d.mu);
  }
}

void RattleLinearization::law_part(const ParameterChange::Law& d, std::size_t k, SparsePart& part) {
  const RattleTrace::Contact& contact = step_->contacts[k];
  const ContactLaw& law = system_.law(d.contact);
  const Eigen::VectorXd& v = step_->before.v;
  const ContactRows& rows = start_.closed[k].rows;
  double square = 0;
  if (const Index i = velocity_.normal[k]; i >= 0 && d.e != 0)
    part.emplace_back(at_.w2 + i,
                      d.e * (contact.at_surface ? -speed_at_surface(k, square) : apply(rows.normal, v.data())));
  if (const Index i = position_.tangent[k]; i >= 0 && d.belt != 0) part.emplace_back(at_.w1 + i, -step_->h * d.belt);
  const Index i = velocity_.tangent[k];
  if (i < 0) return;
  double by = -d.belt;
  if (contact.strikes) by += d.e_t * (apply(rows.tangent, v.data()) - law.belt) - law.e_t * d.belt;
  if (by != 0) part.emplace_back(at_.w2 + i, by);
}

void RattleLinearization::moved_contact_part(const ParameterChange& parameter, std::size_t k, SparsePart& part) {
  const RattleTrace::Contact& contact = step_->contacts[k];
  const auto index = static_cast<std::size_t>(contact.contact);
  const ContactLaw& law = system_.law(contact.contact);
  const double h = step_->h;
  const auto d = parameter.derivative<25>([&](const System& s, std::array<double, 25>& x) {
    const auto rows_at = [&](const Kinematics& at) {
      return std::visit([&](const auto& c) { return c.rows(at); }, s.scene().contacts[index]);
    };
    const ContactRows here = rows_at(start_.at), there = rows_at(end_.at);
    put_entries(here.normal, x.data()), put_entries(here.tangent, x.data() + 6);
    put_entries(there.normal, x.data() + 12), put_entries(there.tangent, x.data() + 18);
    x[24] = gap_of(s, {}, contact.contact, end_.at);
  });
  const double *const start = d.data(), *const end = d.data() + 12;
  const Eigen::VectorXd& v = step_->before.v;
  for (const int p : {0, 1}) {
    const auto& rows = end_.closed[k].rows;
    const Row& row = p == 0 ? rows.normal : rows.tangent;
    const Index one = (p == 0 ? position_.normal : position_.tangent)[k],
                two = (p == 0 ? velocity_.normal : velocity_.tangent)[k];
    if (one >= 0) {
      const double carried = position_.z[one] / h;
      add_push(row, start + 6 * p, -carried, 0, part);
      part.emplace_back(at_.w1 + one, p == 0 ? d[24] : h * rate_by(row, start + 6 * p, u_));
      add_push(row, (contact.rebounds ? start : end) + 6 * p, carried, at_.r4, part);
    }
    if (two < 0) continue;
    add_push(row, end + 6 * p, -velocity_.z[two], at_.r7, part);
    double rate = rate_by(row, end + 6 * p, new_);
    if (p == 1) {
      if (contact.strikes) rate += law.e_t * rate_by(row, start + 6, v);
    } else if (!contact.at_surface) {
      rate += law.e * rate_by(row, start, v);
    } else {
      double square = 0;
      const double speed = speed_at_surface(k, square);
      const double before = apply(row, v.data()), ahead = apply(row, u_.data());
      const double change = apply(row, free_.data()) - before;
      const double before_by = rate_by(row, end, v), free_by = rate_by(row, end, free_);
      if (square > 0)
        rate -= law.e / speed * (before * before_by + (free_by - before_by) * ahead + change * rate_by(row, end, u_));
    }
    part.emplace_back(at_.w2 + two, rate);
  }
}

void RattleLinearization::joint_parts(const ParameterChange& parameter, SparsePart& part) const {
  std::vector<Row> rows;
  std::vector<double> phi, rate;
  for (const int joint : parameter.joints) {
    const auto j = static_cast<std::size_t>(joint);
    const int first = system_.first_row(j), count = row_count(system_.scene().joints[j]);
    rows.resize(static_cast<std::size_t>(count)), phi.resize(rows.size());
    for (int i = 0; i < count; ++i) {
      const auto one = static_cast<std::size_t>(i);
      const auto d = parameter.derivative<14>([&](const System& s, std::array<double, 14>& x) {
        std::visit(
            [&](const auto& other) {
              other.rows(start_.at, rows.data());
              put_entries(rows[one], x.data());
              other.rows(end_.at, rows.data());
              put_entries(rows[one], x.data() + 6);
              other.residual(end_.at, phi.data());
              rate.assign(rows.size(), 0.0);
              if constexpr (requires(double* r) { other.rate(end_.at, r); }) other.rate(end_.at, rate.data());
              x[12] = phi[one], x[13] = rate[one];
            },
            s.scene().joints[j]);
      });
      const Row& row = end_.G[at(first + i)];
      add_push(row, d.data(), -lambda_1_[first + i], 0, part);
      part.emplace_back(at_.r2 + first + i, d[12]);
      add_push(row, d.data() + 6, -lambda_free_[first + i], at_.r4, part);
      part.emplace_back(at_.r5 + first + i, rate_by(row, d.data() + 6, free_) - d[13]);
      if (velocity_.rows == 0) continue;
      add_push(row, d.data() + 6, -lambda_push_[first + i], at_.r7, part);
      part.emplace_back(at_.r8 + first + i, rate_by(row, d.data() + 6, pushed_));
    }
  }
}

void RattleLinearization::friction_parts(const ParameterChange& parameter, SparsePart& part) const {
  const double h = step_->h;
  for (const auto& [friction, by] : parameter.bounds) {
    part.emplace_back(at_.w1 + position_.rows + position_.first_friction + friction, h * h / 2 * by);
    part.emplace_back(at_.w2 + velocity_.rows + velocity_.first_friction + friction, h * by);
  }
  for (const int friction : parameter.frictions) {
    const auto i = static_cast<std::size_t>(friction);
    const Index one = position_.first_friction + friction, two = velocity_.first_friction + friction;
    const auto d = parameter.derivative<12>([&](const System& s, std::array<double, 12>& x) {
      put_entries(s.scene().frictions[i].of.row(start_.at), x.data());
      put_entries(s.scene().frictions[i].of.row(end_.at), x.data() + 6);
    });
    const Row& row = velocity_.push[at(two)];
    const double carried = position_.z[one] / h;
    add_push(row, d.data(), -carried, 0, part);
    part.emplace_back(at_.w1 + one, h * rate_by(row, d.data(), u_));
    add_push(row, d.data() + 6, carried, at_.r4, part);
    add_push(row, d.data() + 6, -velocity_.z[two], at_.r7, part);
    part.emplace_back(at_.w2 + two, rate_by(row, d.data() + 6, new_));
  }
}

}  // namespace orthant
