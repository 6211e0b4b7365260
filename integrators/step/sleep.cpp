#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/integrators/step/sleep.h>

#include <algorithm>

namespace orthant {

Sleep::Sleep(const System& system, const SleepOptions& options)
    : options_(options),
      system_(system),
      islands_(system),
      island_(static_cast<std::size_t>(system.bodies())),
      rest_(island_.size()),
      least_(island_.size()),
      force_(static_cast<std::size_t>(system.contacts())),
      f_(system.dof()),
      v_free_(system.dof()) {
  rows_.reserve(force_.size());
}

int Sleep::sleeping() const {
  return static_cast<int>(std::count_if(island_.begin(), island_.end(), [](int island) { return island > 0; }));
}

bool Sleep::sleeps(std::size_t contact) const {
  const auto [a, b] = bodies_of(system_, pairs_, static_cast<int>(contact));
  return asleep(a) || asleep(b);
}

void Sleep::wake(int island) {
  for (std::size_t b = 0; b < island_.size(); ++b)
    if (island_[b] == island) island_[b] = 0, rest_[b] = 0;
}

void Sleep::begin(const State& x, const Terms& terms, Eigen::VectorXd& v_free) {
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
    const auto was = block(f_, b);
    if ((block(terms.f, b) - was).lpNorm<Eigen::Infinity>() > kSameLoad * was.lpNorm<Eigen::Infinity>())
      wake(island_[static_cast<std::size_t>(b)]);
  }
  for (BodyId b = 0; b < system_.bodies(); ++b)
    if (asleep(b)) block(v_free, b).setZero();
}

bool Sleep::disturbed(Terms& terms, std::vector<RateTarget>& targets, Eigen::VectorXd& v_free) {
  if (!on()) return false;
  bool any = false;
  const auto disturb = [&](BodyId by, BodyId body) {
    if (by < 0 || asleep(by) || !asleep(body)) return;
    wake(island_[static_cast<std::size_t>(body)]);
    any = true;
  };
  for (const ClosedContact& c : terms.closed)
    disturb(c.rows.normal.a, c.rows.normal.b), disturb(c.rows.normal.b, c.rows.normal.a);
  if (any) {
    for (BodyId b = 0; b < system_.bodies(); ++b)
      if (!asleep(b)) block(v_free, b) = block(v_free_, b);
    return true;
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < terms.closed.size(); ++k) {
    const Row& row = terms.closed[k].rows.normal;
    if (asleep(row.a) || asleep(row.b)) continue;
    terms.closed[kept] = terms.closed[k], targets[kept] = targets[k];
    ++kept;
  }
  terms.closed.resize(kept), targets.resize(kept);
  return false;
}

void Sleep::hold(double h, std::vector<Impulse>& impulses) const {
  if (!on()) return;
  for (std::size_t c = 0; c < force_.size(); ++c)
    if (sleeps(c)) impulses[c] = {h * force_[c].normal, h * force_[c].tangent};
}

void Sleep::end(double h, const Terms& terms, const std::vector<Impulse>& impulses, State& x) {
  if (!on()) return;
  for (std::size_t c = 0; c < force_.size(); ++c)
    if (!sleeps(c)) force_[c] = {impulses[c].normal / h, impulses[c].tangent / h};
  rows_.clear();
  for (BodyId b = 0; b < system_.bodies(); ++b) {
    const bool slow = block(x.v, b).lpNorm<Eigen::Infinity>() <= options_.speed;
    double& rest = rest_[static_cast<std::size_t>(b)];
    rest = slow ? rest + h : 0;
  }
  for (const ClosedContact& c : terms.closed) {
    const Row& row = c.rows.normal;
    rows_.push_back(row);
    for (const BodyId body : {row.a, row.b})
      if (body >= 0 && system_.law(c.contact).belt != 0) rest_[static_cast<std::size_t>(body)] = 0;
  }
  for (const Joint& joint : system_.scene().joints)
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
    block(f_, b) = block(terms.f, b);
    block(x.v, b).setZero();
    any = true;
  }
  if (any) islands_so_far_ += system_.bodies();
  last_q_ = x.q, last_v_ = x.v;
}

}  // namespace orthant
