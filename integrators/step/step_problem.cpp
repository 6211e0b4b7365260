#include <orthant/core/support/kept_memory.h>
#include <orthant/integrators/step/step_problem.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace orthant {
namespace {

/// A journal whose centre is the bearing's has no normal and its whole clearance: it cannot touch there.
bool centred_journal(const Scene& scene, int contact) {
  const auto c = static_cast<std::size_t>(contact);
  return c < scene.contacts.size() && std::holds_alternative<Journal>(scene.contacts[c]);
}
bool centred_journal(const spatial::Scene& scene, int contact) {
  const auto c = static_cast<std::size_t>(contact);
  return c < scene.contacts.size() && std::holds_alternative<spatial::Socket>(scene.contacts[c]);
}

/// μ times the unit vector of edge j of n, the first one along `along`, as parts along the two tangents.
Tangents edge_of(double mu, const Tangents& along, Index j, Index n) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(n);
  const double c = mu * std::cos(angle), s = mu * std::sin(angle);
  return {c * along.first - s * along.second, s * along.first + c * along.second};
}
/// The direction of a slip; any, where there is none.
Tangents direction_of_slip(const Tangents& slip) {
  const double size = size_of(slip);
  return size > kStickSpeed ? Tangents{slip.first / size, slip.second / size} : Tangents{1, 0};
}

/// Velocities that normal impulses begin, by a few Jacobi iterations without friction and joints: a contact that does
/// not slip yet takes its direction from them, as it turns with the scene and depends on no order.
Eigen::VectorXd begun_by_normals(const SystemOf<Spatial>& system, const TermsOf<Spatial>& terms,
                                 const std::vector<RateTargetOf<Spatial>>& targets) {
  constexpr int kSweeps = 4;
  constexpr double kDamping = 0.5;
  const Eigen::VectorXd& inverse_mass = system.inverse_mass();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(system.dof()), v = force;
  std::vector<double> impulse(targets.size()), own(targets.size());
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const RowOf<Spatial>& N = terms.closed[k].rows.normal;
    own[k] = coupling(N, N, inverse_mass);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (!(own[k] > 0)) continue;
      const RowOf<Spatial>& N = terms.closed[k].rows.normal;
      const double rate = targets[k].free + apply(N, v.data());
      const double next = std::max(0.0, impulse[k] - kDamping * rate / own[k]);
      apply_transposed(N, next - impulse[k], force.data());
      impulse[k] = next;
    }
    v = inverse_mass.cwiseProduct(force);
  }
  return v;
}

/// z or w at the tangent rows from `first` on.
template <class Space> Tangent<Space> tangent_at(const Vector& x, Index first) {
  if constexpr (kPlanar<Space>)
    return x[first];
  else
    return {x[first], x[first + 1]};
}

}  // namespace

template <class Space> StepProblemOf<Space>::StepProblemOf(const System& system, Form form, Cone cone)
    : system_(system),
      form_(form),
      cone_(cone),
      most_((cone == Cone::coulomb || kPlanar<Space> ? 1 + Space::kTangents : kEdges) * system.contacts() +
            std::ssize(system.scene().frictions) + joint_rows() +
            3 * system.laws().contacts_with([](const ContactLaw& law) { return law.surface.turns(); })),
      matrix_(system, system.scene().springs.empty() && (form == Form::full || system.joint_rows() == 0), most_,
              lcp_.A) {
  const auto contacts = static_cast<std::size_t>(system.contacts());
  // What a step can need at the most is taken now where it is little; else memory grows with the contacts that close.
  if (most_ > kKeptRows) return;
  rows_.reserve(static_cast<std::size_t>(most_));
  contacts_.reserve(contacts);
  lcp_.friction.reserve(contacts);
  lcp_.b.resize(most_), lcp_.lo.resize(most_), lcp_.hi.resize(most_);
  lcp_.b.resize(0);
  places_.resize(contacts);
}

template <class Space> bool StepProblemOf<Space>::empty(std::size_t closed) const {
  return closed == 0 && joint_rows() == 0 && !(duration_ > 0 && !system_.scene().frictions.empty());
}

template <class Space> void StepProblemOf<Space>::respond(const BasicSystem& basic) {
  formed_ = false;
  matrix_.respond(basic, rows_);
}

template <class Space> const Lcp& StepProblemOf<Space>::whole() const {
  if (formed_ || size() == 0) return lcp_;
  matrix_.fill(rows_, lcp_.A);
  formed_ = true;
  return lcp_;
}

/// Rows with their bounds: joints, then all normals and all tangents (coulomb) or each contact's edges (relaxed), then
/// joint friction.
template <class Space> void StepProblemOf<Space>::collect(const Terms& terms, const std::vector<RateTarget>& targets,
                                                          std::span<const Held> held_ones) {
  const auto held = [&](std::size_t k) { return k < held_ones.size() ? held_ones[k] : Held::nowhere; };
  rows_.begin(!matrix_.dense() && cone_ == Cone::coulomb && held_ones.empty() && targets.size() >= kReferred);
  contacts_.clear();
  if (places_.size() < targets.size()) places_.resize(targets.size());
  lcp_.friction.clear();
  if (form_ == Form::full)
    for (const Row& row : terms.G) rows_.keep(row);  // the projection changes G before the step ends
  no_normal_ = -1, collected_ = targets.size(), formed_ = false;
  const auto joints = static_cast<Index>(rows_.size());
  [[maybe_unused]] Eigen::VectorXd begun;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const auto& c = terms.closed[k];
    places_[k] = {};
    if (zero(c.rows.normal)) {
      if (centred_journal(system_.scene(), c.contact)) continue;
      no_normal_ = c.contact;
    }
    if (held(k) == Held::normal) continue;
    const bool slips = targets[k].law->frictional() && held(k) == Held::nowhere;
    const double mu = slips ? mu_at(*targets[k].law, targets[k].slip) : 0;
    contacts_.push_back({c.contact, static_cast<std::uint32_t>(k), targets[k].law, mu, targets[k].slip,
                         slips && cone_ == Cone::coulomb});
    const bool edges = cone_ == Cone::relaxed && mu > 0;
    places_[k].normal = static_cast<int>(rows_.size());
    if constexpr (kPlanar<Space>) {
      if (edges)
        rows_.keep(combined(c.rows.normal, mu, c.rows.tangent)),
            rows_.keep(combined(c.rows.normal, -mu, c.rows.tangent));
      else
        rows_.add(c.rows.normal);
    } else if (edges) {
      Contact& contact = contacts_.back();
      Tangents slip = targets[k].free_slip;
      if (!(size_of(slip) > kStickSpeed)) {
        if (begun.size() == 0) begun = begun_by_normals(system_, terms, targets);
        slip = slip_rate(c.rows, begun.data());
      }
      contact.slip = direction_of_slip(slip);
      for (Index j = 0; j < kEdges; ++j) {
        const auto [one, other] = edge_of(mu, contact.slip, j, kEdges);
        rows_.keep(combined(combined(c.rows.normal, one, c.rows.tangents[0]), other, c.rows.tangents[1]));
      }
    } else {
      rows_.add(c.rows.normal);
    }
    if (held(k) == Held::inwards)
      contacts_.back().jammed = &c.rows.normal, rows_.last_kept() = blank(rows_.last_kept());
  }
  const auto unilateral = static_cast<Index>(rows_.size()) - joints;
  if (cone_ == Cone::coulomb)
    for (const Contact& c : contacts_) {
      if (!c.frictional) continue;
      Place& place = places_[c.closed];
      place.tangent = static_cast<int>(rows_.size());
      lcp_.friction.push_back({.normal = place.normal, .first = place.tangent, .rows = Space::kTangents, .mu = c.mu});
      for (std::size_t i = 0; i < Space::kTangents; ++i) rows_.add(row_of_tangent(terms.closed[c.closed].rows, i));
    }
  turning_ = static_cast<Index>(rows_.size());
  if constexpr (!kPlanar<Space>) add_turning(terms);
  resisted_ = static_cast<Index>(rows_.size());
  if (duration_ > 0)
    for (const auto& f : system_.scene().frictions) rows_.keep(f.of.row(terms.at));
  rows_.end();
  const auto n = static_cast<Index>(rows_.size());
  lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.lo.setConstant(-kInf), lcp_.hi.setConstant(kInf);
  lcp_.lo.segment(joints, unilateral).setZero();
  for (Index i = resisted_; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i - resisted_);
    lcp_.hi[i] = duration_ * system_.scene().frictions[k].bound_at(loads_ != nullptr ? (*loads_)[k] : 0);
    lcp_.lo[i] = -lcp_.hi[i];
  }
}

/// Rolling friction bounds the moment across the normal by a disc, spinning friction the one along it. [N m s]
template <class Space> void StepProblemOf<Space>::add_turning([[maybe_unused]] const Terms& terms) {
  if constexpr (!kPlanar<Space>) {
    turn_targets_.clear();
    for (const Contact& c : contacts_) {
      const SurfaceLaw& law = c.law->surface;
      if (!law.turns() || c.jammed != nullptr) continue;
      const Row& normal = terms.closed[c.closed].rows.normal;
      const Vector3d n = spatial::direction_of(normal), t = spatial::perpendicular(n);
      const Vector3d turn = terms.at.at(normal.b).turn(law.omega);
      const auto add = [&](const Vector3d& axis) {
        rows_.keep(spatial::turn_row(terms.at, normal.a, normal.b, axis));
        turn_targets_.push_back(turn.dot(axis));
      };
      const Index at = places_[c.closed].normal;
      if (law.rolling > 0) {
        lcp_.friction.push_back(
            {.normal = at, .first = static_cast<Index>(rows_.size()), .rows = 2, .mu = law.rolling});
        add(t), add(n.cross(t));
      }
      if (law.spinning > 0) {
        lcp_.friction.push_back(
            {.normal = at, .first = static_cast<Index>(rows_.size()), .rows = 1, .mu = law.spinning});
        add(n);
      }
    }
  }
}

template <class Space> void StepProblemOf<Space>::retarget(const std::vector<RateTarget>& targets,
                                                           const Eigen::VectorXd& v_free,
                                                           const Eigen::VectorXd& joint_rate) {
  lcp_.b.resize(static_cast<Index>(rows_.size()));
  dropped_ = false;
  Index i = 0;
  const auto hold_against = [&](double target) {
    lcp_.b[i] = apply(rows_[static_cast<std::size_t>(i)], v_free.data()) - target;
    ++i;
  };
  if (form_ == Form::full)
    for (const double target : joint_rate) hold_against(target);
  for (Contact& c : contacts_) {
    const RateTarget& want = targets[c.closed];
    c.rebound = std::max(0.0, want.normal) - std::max(0.0, std::min(want.least, want.normal));
    double plastic = std::min(want.normal, 0.0);
    if (want.least > -kInf) plastic = std::min(plastic, want.least);
    if (want.plastic != kInf) plastic = std::min(want.plastic, 0.0);
    c.elastic = want.normal - plastic;
    c.elastic_along = want.tangent - belt_of(want);
    if (c.jammed != nullptr) {  // where it comes open all the same no impulse is wanted
      const double rate = apply(*c.jammed, v_free.data()) - want.normal;
      lcp_.b[i++] = rate < 0 ? rate : 1;
      continue;
    }
    const double mu = cone_ == Cone::relaxed ? c.mu : 0;
    if constexpr (kPlanar<Space>) {
      hold_against(want.normal + mu * want.tangent);
      if (mu > 0) hold_against(want.normal - mu * want.tangent);
    } else if (mu > 0) {
      for (Index j = 0; j < kEdges; ++j)
        hold_against(want.normal + inner(edge_of(mu, c.slip, j, kEdges), want.tangent));
    } else {
      hold_against(want.normal);
    }
  }
  for (const Contact& c : contacts_)
    if (c.frictional)
      for (std::size_t k = 0; k < Space::kTangents; ++k) hold_against(tangent_part(targets[c.closed].tangent, k));
  if constexpr (!kPlanar<Space>)
    for (const double target : turn_targets_) hold_against(target);
  while (i < lcp_.b.size()) hold_against(0);
}

template <class Space> bool StepProblemOf<Space>::drop_restitution() {
  bool any = false;
  dropped_ = true;
  Index i = joint_rows();
  for (Contact& c : contacts_) {
    any = any || c.elastic > 0 || c.elastic_along != Tangent<Space>{};
    if (c.jammed != nullptr) {
      ++i;
    } else if (!has_edges(c)) {
      give(i++, c.elastic);
    } else if constexpr (kPlanar<Space>) {
      give(i++, c.elastic + c.mu * c.elastic_along), give(i++, c.elastic - c.mu * c.elastic_along);
    } else {
      for (Index j = 0; j < kEdges; ++j)
        give(i++, c.elastic + inner(edge_of(c.mu, c.slip, j, kEdges), c.elastic_along));
    }
    for (std::size_t k = 0; c.frictional && k < Space::kTangents; ++k)
      give(places_[c.closed].tangent + static_cast<Index>(k), tangent_part(c.elastic_along, k));
    c.rebound = c.elastic = 0, c.elastic_along = {};
  }
  return any;
}

template <class Space> void StepProblemOf<Space>::release(const std::vector<Impulse>& stored) {
  Index i = joint_rows();
  for (const Contact& c : contacts_)  // a solver may leave −ε for 0
    lcp_.lo[i++] = c.law->e * std::max(0.0, stored[static_cast<std::size_t>(c.index)].normal);
}

template <class Space> void StepProblemOf<Space>::bind() {
  lcp_.lo.setConstant(-kInf), lcp_.hi.setConstant(kInf);
  lcp_.friction.clear();
}

/// Of the first tangent row of a contact; tangent rows stand one after the other.
template <class Space> const Friction* StepProblemOf<Space>::friction_of(int row) const {
  if (lcp_.friction.empty()) return nullptr;
  if constexpr (!kPlanar<Space>) {
    const auto& all = lcp_.friction;
    const auto found = std::ranges::lower_bound(all, row, {}, [](const Friction& f) { return f.first; });
    return found != all.end() && found->first == row ? &*found : nullptr;
  }
  const Index k = row - lcp_.friction.front().first;
  if (k < 0 || k >= Space::kTangents * std::ssize(lcp_.friction) || k % Space::kTangents != 0) return nullptr;
  return &lcp_.friction[static_cast<std::size_t>(k / Space::kTangents)];
}

template <class Space> const Lcp& StepProblemOf<Space>::cut(std::span<const int> rows, Block& block) const {
  const auto n = static_cast<Index>(rows.size());
  const bool applied = rows.size() > StepMatrixOf<Space>::kFormedRows && !dense();
  Lcp& part = applied ? block.large : block.small;
  part.b.resize(n), part.lo.resize(n), part.hi.resize(n);
  part.friction.clear();
  if (block.place.size() < rows_.size()) block.place.resize(rows_.size());
  for (Index i = 0; i < n; ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    block.place[static_cast<std::size_t>(row)] = static_cast<int>(i);
    part.b[i] = lcp_.b[row], part.lo[i] = lcp_.lo[row], part.hi[i] = lcp_.hi[row];
    if (const Friction* f = friction_of(row))  // its normal came before
      part.friction.push_back(
          {.normal = block.place[static_cast<std::size_t>(f->normal)], .first = i, .rows = f->rows, .mu = f->mu});
  }
  matrix_.cut(rows_, rows, block.columns, part.A);
  return part;
}

template <class Space> bool StepProblemOf<Space>::regrade(const Vector& z, const Vector& w) {
  constexpr double kBound = 1 - 1e-9;  // of the bound: at it
  const double none = 1e-9 * lcp_.b.lpNorm<Eigen::Infinity>();
  const Index joints = joint_rows();
  bool any = false;
  for (Friction& friction : lcp_.friction) {
    if (!kPlanar<Space> && friction.first >= turning_) break;
    const Contact& c = contacts_[static_cast<std::size_t>(friction.normal - joints)];
    if (c.law->mu_static <= c.law->mu) continue;
    const double pressure = z[friction.normal];
    const bool sticks = friction.mu > c.law->mu;
    // At the bound alone is no slip: of contacts that share a load one may be there by the split that the solver took.
    const auto slip = tangent_at<Space>(w, friction.first), push = tangent_at<Space>(z, friction.first);
    const bool changes = sticks
                             ? size_of(slip) > none && pressure > 0 && size_of(push) >= kBound * friction.mu * pressure
                             : inner(slip, c.slip) < 0;
    if (!changes) continue;
    friction.mu = sticks ? c.law->mu : c.law->mu_static;
    any = true;
  }
  return any;
}

template <class Space> bool StepProblemOf<Space>::lend([[maybe_unused]] ClosedContacts& closed) {
  if constexpr (kPlanar<Space>) return false;
  const auto has_all = [](const Contact& c) { return c.frictional && c.jammed == nullptr; };
  if (!formed_ || !rows_.refers() || size() <= kKeptRows || contacts_.size() != closed.size() ||
      !std::ranges::all_of(contacts_, has_all))
    return false;
  if constexpr (!kPlanar<Space>) lent_.take(closed);
  return true;
}

template <class Space> void StepProblemOf<Space>::take_back([[maybe_unused]] ClosedContacts& closed) {
  if constexpr (!kPlanar<Space>) {
    lent_.give_back(std::get<Delassus>(lcp_.A).W, *this, closed);
    for (std::size_t k = 0; k < closed.size(); ++k) {
      const auto& [normal, tangents, point, belt] = closed[k].rows;
      rows_.move_reference(at(normal_row(k)), normal);
      for (std::size_t i = 0; i < tangents.size(); ++i) rows_.move_reference(at(tangent_row(k)) + i, tangents[i]);
    }
  }
}

template <class Space>
void StepProblemOf<Space>::advance(const Vector& z, Eigen::VectorXd& v, std::vector<Impulse>& impulses) const {
  std::fill(impulses.begin(), impulses.end(), Impulse{});
  if (rows_.empty()) return;
  matrix_.add_response(rows_, z, v);
  Index i = joint_rows();
  for (const Contact& c : contacts_) {
    Impulse& impulse = impulses[static_cast<std::size_t>(c.index)];
    impulse.normal = z[i++];
    if (cone_ == Cone::coulomb || c.mu <= 0) continue;
    if constexpr (kPlanar<Space>) {
      const double other = z[i++];  // of the edge n − μ t
      impulse.tangent = c.mu * (impulse.normal - other);
      impulse.normal += other;
    } else {
      const double first = impulse.normal;
      impulse.tangent = edge_of(first * c.mu, c.slip, 0, kEdges);
      for (Index j = 1; j < kEdges; ++j) {
        const Tangents push = edge_of(z[i] * c.mu, c.slip, j, kEdges);
        impulse.normal += z[i++];
        impulse.tangent.first += push.first, impulse.tangent.second += push.second;
      }
    }
  }
  if (cone_ == Cone::coulomb)
    for (const Contact& c : contacts_)
      if (c.frictional) {
        impulses[static_cast<std::size_t>(c.index)].tangent = tangent_at<Space>(z, i);
        i += Space::kTangents;
      }
}

template class StepProblemOf<Planar>;
template class StepProblemOf<Spatial>;

}  // namespace orthant
