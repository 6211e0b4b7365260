// Slopes of all equations of a step of rattle: see rattle_linearization.h.
#include <orthant/integrators/derivatives/rattle_linearization.h>

namespace orthant {

void RattleLinearization::linearize() {
  const double h = step_->h;
  for (auto* slopes : {&of_q_, &of_v_, &of_u_, &of_end_, &of_free_}) slopes->clear();
  append_force_slopes(system_, start_, {h / 2, 0, h / 2}, step_->before.v, kick_, 0, of_q_, of_v_);
  append_force_slopes(system_, end_, {h / 2, 0, 0}, u_, none_, at_.r4, of_end_, of_u_);
  linearize_joints();
  linearize_contacts();
  linearize_frictions();
}

void RattleLinearization::linearize_joints() {
  const auto& joints = system_.scene().joints;
  const Index rows = system_.joint_rows();
  for (std::size_t j = 0; j < joints.size(); ++j)
    slopes_of(joints[j], start_.at, slopes_.data() + system_.first_row(j));
  for (Index i = 0; i < rows; ++i) {
    for (const Slope& s : slopes_[at(i)]) of_q_.push_back({s.of, s.by, -lambda_1_[i] * s.value});
    each_entry(end_.G[at(i)], [&](Index place, double j) { of_q_.push_back({at_.r2 + i, place, j}); });
  }
  for (std::size_t j = 0; j < joints.size(); ++j) slopes_of(joints[j], end_.at, slopes_.data() + system_.first_row(j));
  for (Index i = 0; i < rows; ++i)
    for (const Slope& s : slopes_[at(i)]) {
      of_end_.push_back({at_.r4 + s.of, s.by, -lambda_free_[i] * s.value});
      of_end_.push_back({at_.r5 + i, s.by, free_[s.of] * s.value});
      if (velocity_.rows == 0) continue;
      of_end_.push_back({at_.r7 + s.of, s.by, -lambda_push_[i] * s.value});
      of_end_.push_back({at_.r8 + i, s.by, pushed_[s.of] * s.value});
    }
}

void RattleLinearization::linearize_contacts() {
  const RattleTrace& step = *step_;
  const double h = step.h;
  std::array<RowSlope, 2> start, end;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const auto& contact = system_.scene().contacts[static_cast<std::size_t>(step.contacts[k].contact)];
    slopes_of(contact, start_.at, start);
    slopes_of(contact, end_.at, end);
    for (const std::size_t part : {std::size_t{0}, std::size_t{1}}) {
      const Index position = (part == 0 ? position_.normal : position_.tangent)[k];
      const Index velocity = (part == 0 ? velocity_.normal : velocity_.tangent)[k];
      if (position >= 0) {
        const double carried = position_.z[position] / h;
        for (const Slope& s : start[part]) {
          of_q_.push_back({s.of, s.by, -carried * s.value});
          if (part == 1) of_q_.push_back({at_.w1 + position, s.by, h * u_[s.of] * s.value});
        }
        if (part == 0)
          each_entry(end_.closed[k].rows.normal, [&](Index place, double j) {
            of_q_.push_back({at_.w1 + position, place, j});
          });
        const bool back = step.contacts[k].rebounds;
        for (const Slope& s : (back ? start : end)[part])
          (back ? of_q_ : of_end_).push_back({at_.r4 + s.of, s.by, carried * s.value});
      }
      if (velocity < 0) continue;
      for (const Slope& s : end[part]) {
        of_end_.push_back({at_.r7 + s.of, s.by, -velocity_.z[velocity] * s.value});
        of_end_.push_back({at_.w2 + velocity, s.by, new_[s.of] * s.value});
      }
    }
    linearize_targets(k, start, end);
  }
}

void RattleLinearization::linearize_targets(std::size_t k, const std::array<RowSlope, 2>& at_start,
                                            const std::array<RowSlope, 2>& at_end) {
  const RattleTrace::Contact& contact = step_->contacts[k];
  const ContactLaw& law = system_.law(contact.contact);
  const Eigen::VectorXd& v = step_->before.v;
  const auto add_rate = [&](std::vector<Slope>& to, Index row, double by, const Row& of) {
    if (by != 0) each_entry(of, [&](Index place, double j) { to.push_back({at_.w2 + row, place, by * j}); });
  };
  const auto add_back = [&](std::size_t part, Index row, double e) {  // e J(q) v
    if (e == 0) return;
    const ContactRows& rows = start_.closed[k].rows;
    for (const Slope& s : at_start[part]) of_q_.push_back({at_.w2 + row, s.by, e * v[s.of] * s.value});
    add_rate(of_v_, row, e, part == 0 ? rows.normal : rows.tangent);
  };
  if (const Index row = velocity_.tangent[k]; row >= 0 && contact.strikes) add_back(1, row, law.e_t);
  const Index row = velocity_.normal[k];
  if (row < 0) return;
  if (!contact.at_surface) return add_back(0, row, law.e);
  double square = 0;
  const double speed = speed_at_surface(k, square);
  if (!(square > 0)) return;  // it stops short of the surface: no rebound
  const Row& normal = end_.closed[k].rows.normal;
  const double before = apply(normal, v.data()), ahead = apply(normal, u_.data());
  const double change = apply(normal, free_.data()) - before, by = -law.e / speed;  // of half the square
  add_rate(of_v_, row, by * (before - ahead), normal);
  add_rate(of_u_, row, by * change, normal);
  add_rate(of_free_, row, by * ahead, normal);
  for (const Slope& s : at_end[0])
    of_end_.push_back(
        {at_.w2 + row, s.by, by * s.value * (before * v[s.of] + (free_[s.of] - v[s.of]) * ahead + change * u_[s.of])});
}

void RattleLinearization::linearize_frictions() {
  const auto& frictions = system_.scene().frictions;
  const double h = step_->h;
  RowSlope slope;
  for (std::size_t i = 0; i < frictions.size(); ++i) {
    const Index one = position_.first_friction + static_cast<Index>(i),
                two = velocity_.first_friction + static_cast<Index>(i);
    const double carried = position_.z[one] / h;
    slope_of(frictions[i].of, start_.at, slope);
    for (const Slope& s : slope) {
      of_q_.push_back({s.of, s.by, -carried * s.value});
      of_q_.push_back({at_.w1 + one, s.by, h * u_[s.of] * s.value});
    }
    slope_of(frictions[i].of, end_.at, slope);
    for (const Slope& s : slope) {
      of_end_.push_back({at_.r4 + s.of, s.by, carried * s.value});
      of_end_.push_back({at_.r7 + s.of, s.by, -velocity_.z[two] * s.value});
      of_end_.push_back({at_.w2 + two, s.by, new_[s.of] * s.value});
    }
  }
}

}  // namespace orthant
