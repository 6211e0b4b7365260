#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/integrators/step/sleep.h>

#include <algorithm>

namespace orthant {
namespace {

/// b's surface moves against b.
bool surface_moves(const ContactLaw& law) { return law.belt != 0 || law.surface.moves(); }

}  // namespace

template <class Space> SleepOf<Space>::SleepOf(const System& system, const SleepOptions& options)
    : options_(options),
      system_(system),
      islands_(system),
      island_(static_cast<std::size_t>(system.bodies())),
      rest_(island_.size()),
      least_(island_.size()),
      force_(on() ? static_cast<std::size_t>(system.contacts()) : 0),
      f_(system.dof()),
      v_free_(system.dof()) {
  rows_.reserve(force_.size());
}

template <class Space> int SleepOf<Space>::sleeping() const {
  return static_cast<int>(std::count_if(island_.begin(), island_.end(), [](int island) { return island > 0; }));
}

template <class Space> bool SleepOf<Space>::sleeps(std::size_t contact) const {
  const auto [a, b] = bodies_of(system_, pairs_, static_cast<int>(contact));
  return asleep(a) || asleep(b);
}

template <class Space> void SleepOf<Space>::wake(int island) {
  for (std::size_t b = 0; b < island_.size(); ++b)
    if (island_[b] == island) island_[b] = 0, rest_[b] = 0;
}

template <class Space> void SleepOf<Space>::begin(const State& x, const Terms& terms, Eigen::VectorXd& v_free) {
  constexpr double kSameLoad = 1e-9;
  if (!on()) return;
  if (!terms.pairs.empty()) {
    carry<Impulse>(system_, pairs_, terms.pairs, force_, scratch_);
    pairs_ = terms.pairs;
  }
  if (last_q_.size() != x.q.size() || x.q != last_q_ || x.v != last_v_) {
    std::fill(island_.begin(), island_.end(), 0);
    std::fill(rest_.begin(), rest_.end(), 0.0);
  }
  v_free_ = v_free;
  for (BodyId b = 0; b < system_.bodies(); ++b) {
    if (!asleep(b)) continue;
    const auto was = block<Space>(f_, b);
    if ((block<Space>(terms.f, b) - was).template lpNorm<Eigen::Infinity>() >
        kSameLoad * was.template lpNorm<Eigen::Infinity>())
      wake(island_[static_cast<std::size_t>(b)]);
  }
  for (BodyId b = 0; b < system_.bodies(); ++b)
    if (asleep(b)) block<Space>(v_free, b).setZero();
}

template <class Space>
bool SleepOf<Space>::disturbed(Terms& terms, std::vector<RateTargetOf<Space>>& targets, Eigen::VectorXd& v_free) {
  if (!on()) return false;
  bool any = false;
  const auto disturb = [&](BodyId by, BodyId body) {
    if (by < 0 || asleep(by) || !asleep(body)) return;
    wake(island_[static_cast<std::size_t>(body)]);
    any = true;
  };
  for (const ClosedContactOf<Space>& c : terms.closed)
    disturb(c.rows.normal.a, c.rows.normal.b), disturb(c.rows.normal.b, c.rows.normal.a);
  if (any) {
    for (BodyId b = 0; b < system_.bodies(); ++b)
      if (!asleep(b)) block<Space>(v_free, b) = block<Space>(v_free_, b);
    return true;
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < terms.closed.size(); ++k) {
    const RowOf<Space>& row = terms.closed[k].rows.normal;
    if (asleep(row.a) || asleep(row.b)) continue;
    terms.closed[kept] = terms.closed[k], targets[kept] = targets[k];
    ++kept;
  }
  terms.closed.resize(kept), targets.resize(kept);
  return false;
}

template <class Space> void SleepOf<Space>::hold(double h, std::vector<Impulse>& impulses) const {
  if (!on()) return;
  for (std::size_t c = 0; c < force_.size(); ++c)
    if (sleeps(c)) impulses[c] = {h * force_[c].normal, h * force_[c].tangent};
}

template <class Space>
void SleepOf<Space>::end(double h, const Terms& terms, const std::vector<Impulse>& impulses, State& x) {
  if (!on()) return;
  for (std::size_t c = 0; c < force_.size(); ++c)
    if (!sleeps(c)) force_[c] = {impulses[c].normal / h, impulses[c].tangent / h};
  rows_.clear();
  for (BodyId b = 0; b < system_.bodies(); ++b) {
    const double unit = system_.length_unit();
    const double speed = unit == 1 ? block<Space>(x.v, b).template lpNorm<Eigen::Infinity>()
                                   : largest_coordinate<Space>(x.v, b, unit) / unit;
    const bool slow = speed <= options_.speed;
    double& rest = rest_[static_cast<std::size_t>(b)];
    rest = slow ? rest + h : 0;
  }
  for (const ClosedContactOf<Space>& c : terms.closed) {
    const RowOf<Space>& row = c.rows.normal;
    rows_.push_back(row);
    for (const BodyId body : {row.a, row.b})
      if (body >= 0 && surface_moves(system_.law(c.contact))) rest_[static_cast<std::size_t>(body)] = 0;
  }
  for (const auto& joint : system_.scene().joints)
    if (driven(joint)) {
      const auto [a, b] = std::visit([](const auto& j) { return bodies_of(j); }, joint);
      for (const BodyId body : {a, b})
        if (body >= 0) rest_[static_cast<std::size_t>(body)] = 0;
    }
  islands_.sort(rows_);
  std::fill(least_.begin(), least_.end(), kInf);
  for (BodyId b = 0; b < system_.bodies(); ++b) {
    double& least = least_[static_cast<std::size_t>(islands_.root(b))];
    least = std::min(least, rest_[static_cast<std::size_t>(b)]);
  }
  bool any = false;
  for (BodyId b = 0; b < system_.bodies(); ++b) {
    const auto root = islands_.root(b);
    if (asleep(b) || least_[static_cast<std::size_t>(root)] < options_.after) continue;
    island_[static_cast<std::size_t>(b)] = islands_so_far_ + 1 + root;
    block<Space>(f_, b) = block<Space>(terms.f, b);
    block<Space>(x.v, b).setZero();
    any = true;
  }
  if (any) islands_so_far_ += system_.bodies();
  last_q_ = x.q, last_v_ = x.v;
}

template class SleepOf<Planar>;
template class SleepOf<Spatial>;

}  // namespace orthant
