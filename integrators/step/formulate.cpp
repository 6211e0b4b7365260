#include <orthant/integrators/step/formulate.h>
#include <orthant/integrators/step/jam.h>

namespace orthant {
namespace {

constexpr std::size_t kShared = 100;     // rows beyond the largest island's, from which on threads gain
constexpr std::size_t kFormedRows = 64;  // up to here a dense A is cheaper than applying the operator again and again

/// J_i M⁻¹ J_jᵀ of two rows.
double coupling(const Row& i, const Row& j, const Eigen::VectorXd& inverse_mass) {
  double sum = 0;
  const auto add = [&](BodyId body, const std::array<double, 3>& u, BodyId other, const std::array<double, 3>& v) {
    if (body < 0 || body != other) return;
    for (std::size_t k = 0; k < 3; ++k) sum += u[k] * inverse_mass[3 * body + static_cast<Index>(k)] * v[k];
  };
  add(i.a, i.ja, j.a, j.ja), add(i.a, i.ja, j.b, j.jb), add(i.b, i.jb, j.a, j.ja), add(i.b, i.jb, j.b, j.jb);
  return sum;
}

/// W from its rows.
void fill_delassus(const std::vector<Row>& rows, Index dof, Delassus& A) {
  RowSparse& W = A.W;
  W.rows = static_cast<Index>(rows.size()), W.cols = dof;
  W.start.assign(1, 0), W.column.clear(), W.value.clear();
  const auto push = [&](BodyId body, const std::array<double, 3>& j) {
    for (int k = 0; body >= 0 && k < 3; ++k)
      W.column.push_back(3 * body + k), W.value.push_back(j[static_cast<std::size_t>(k)]);
  };
  for (const Row& row : rows) {  // columns ascend within a row
    if (row.a < row.b)
      push(row.a, row.ja), push(row.b, row.jb);
    else
      push(row.b, row.jb), push(row.a, row.ja);
    W.start.push_back(static_cast<int>(W.column.size()));
  }
}

bool zero(const Row& row) {
  constexpr std::array<double, 3> none{};
  return row.ja == none && row.jb == none;
}

/// A journal whose centre is the bearing's has no normal and its whole clearance: it cannot touch there.
bool centred_journal(const Scene& scene, int contact) {
  const auto c = static_cast<std::size_t>(contact);
  return c < scene.contacts.size() && std::holds_alternative<Journal>(scene.contacts[c]);
}

/// n + μ t of a contact.
Row edge(const ContactRows& rows, double mu) {
  Row row = rows.normal;
  for (std::size_t k = 0; k < 3; ++k) row.ja[k] += mu * rows.tangent.ja[k], row.jb[k] += mu * rows.tangent.jb[k];
  return row;
}

}  // namespace

void newtons_law(const std::vector<ContactLaw>& laws, const Terms& terms, const Eigen::VectorXd& v,
                 std::vector<Wanted>& wanted) {
  wanted.clear();
  for (const ClosedContact& c : terms.closed) {
    const ContactLaw& law = laws[static_cast<std::size_t>(c.contact)];
    const double slip = law.frictional() ? apply(c.rows.tangent, v.data()) - law.belt : 0;
    const double approach = apply(c.rows.normal, v.data());
    wanted.push_back({-law.e * approach, law.belt - law.e_t * slip, slip, &law, approach});
    wanted.back().slip_before = wanted.back().free_slip = slip, wanted.back().free = approach;
  }
}

void restrict_to_strikes(std::vector<Wanted>& wanted) {
  for (Wanted& w : wanted)
    if (!(-w.approach > kRestSpeed + std::abs(w.free - w.approach))) w.tangent = w.law->belt;
}

Formulation::Formulation(const System& system, Form form, Cone cone)
    : system_(system), form_(form), cone_(cone), inverse_mass_(system.inverse_mass()), islands_(system) {
  const auto contacts = static_cast<std::size_t>(system.contacts());
  const auto most = 2 * contacts + system.scene().frictions.size() +
                    static_cast<std::size_t>(form == Form::full ? system.joint_rows() : 0);
  const bool diagonal = system.scene().springs.empty() && (form == Form::full || system.joint_rows() == 0);
  // What a step can need at the most is taken now where it is little; else memory grows with the contacts that close.
  rows_.reserve(most);
  contacts_.reserve(contacts);
  lcp_.friction.reserve(contacts);
  const auto size = static_cast<Index>(most);
  lcp_.b.resize(size), lcp_.lo.resize(size), lcp_.hi.resize(size);
  if (diagonal && most > kFormedRows) {
    lcp_.A.emplace<Delassus>().inverse_mass = inverse_mass_;
  } else if (most <= kFormedRows) {
    std::get<DenseMatrix>(lcp_.A).resize(size, size);
    columns_.resize(system.dof(), size);
  }
  lcp_.b.resize(0);
  add_bench();
  outcomes_.reserve(most);
  for (Vector* each : {&found_.z, &found_.w}) each->resize(size);
  place_.resize(most), friction_of_.resize(most), places_.resize(contacts), held_.reserve(contacts);
  if (form == Form::full && system.joint_rows() > 0 && contacts > 0) immobility_.emplace(system);
}

void Formulation::formulate(const Terms& terms, const BasicSystem& basic, const std::vector<Wanted>& wanted,
                            const Eigen::VectorXd& v_free, const Eigen::VectorXd& joint_rate) {
  const bool resists = duration_ > 0 && !system_.scene().frictions.empty();
  if (wanted.empty() && !resists &&
      (form_ == Form::reduced || system_.joint_rows() == 0)) {  // most steps of most scenes
    rows_.clear(), contacts_.clear(), clear();
    blank_ = -1;
    return;
  }
  terms_ = &terms, stands_ = false;
  held_.clear();
  collect(terms, wanted);
  fill(basic);
  if (find_immobile(terms)) collect(terms, wanted), fill(basic);
  retarget(wanted, v_free, joint_rate);
}

void Formulation::fill(const BasicSystem& basic) {
  islands_.sort(rows_);
  if (auto* delassus = std::get_if<Delassus>(&lcp_.A)) {
    delassus->inverse_mass = inverse_mass_ = basic.inverse_mass();
    fill_delassus(rows_, system_.dof(), *delassus);
  } else {
    fill_dense(basic, std::get<DenseMatrix>(lcp_.A));
  }
}

/// Rows with their bounds: joints, then all normals and all tangents (coulomb) or each contact's edges (relaxed), then
/// joint friction.
void Formulation::collect(const Terms& terms, const std::vector<Wanted>& wanted) {
  rows_.clear(), contacts_.clear();
  lcp_.friction.clear();
  if (form_ == Form::full) rows_.insert(rows_.end(), terms.G.begin(), terms.G.end());
  blank_ = -1, pairs_ = &terms.pairs, collected_ = wanted.size();
  const auto joints = static_cast<Index>(rows_.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const ClosedContact& c = terms.closed[k];
    places_[k] = {};
    if (zero(c.rows.normal)) {
      if (centred_journal(system_.scene(), c.contact)) continue;
      blank_ = c.contact;
    }
    if (held(k) == Held::normal) continue;
    const bool slips = wanted[k].law->frictional() && held(k) == Held::nowhere;
    const double mu = slips ? wanted[k].law->mu_at(wanted[k].slip) : 0;
    contacts_.push_back({c.contact, k, wanted[k].law, mu, wanted[k].slip, slips && cone_ == Cone::coulomb});
    const bool edges = cone_ == Cone::relaxed && mu > 0;
    places_[k].normal = static_cast<Index>(rows_.size());
    rows_.push_back(edges ? edge(c.rows, mu) : c.rows.normal);
    if (edges) rows_.push_back(edge(c.rows, -mu));
    if (held(k) == Held::inwards) contacts_.back().jammed = &c.rows.normal, rows_.back().ja = rows_.back().jb = {};
  }
  const auto unilateral = static_cast<Index>(rows_.size()) - joints;
  if (cone_ == Cone::coulomb)
    for (const Contact& c : contacts_) {
      if (!c.frictional) continue;
      Place& place = places_[c.closed];
      place.tangent = static_cast<Index>(rows_.size());
      lcp_.friction.push_back({.normal = place.normal, .first = place.tangent, .mu = c.mu});
      rows_.push_back(terms.closed[c.closed].rows.tangent);
    }
  const auto resisted = static_cast<Index>(rows_.size());
  if (duration_ > 0)
    for (const JointFriction& f : system_.scene().frictions) rows_.push_back(f.of.row(terms.at));
  const auto n = static_cast<Index>(rows_.size());
  lcp_.lo.resize(n), lcp_.hi.resize(n);
  lcp_.lo.setConstant(-kInf), lcp_.hi.setConstant(kInf);
  lcp_.lo.segment(joints, unilateral).setZero();
  for (Index i = resisted; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i - resisted);
    lcp_.hi[i] = duration_ * system_.scene().frictions[k].bound_at(loads_ != nullptr ? (*loads_)[k] : 0);
    lcp_.lo[i] = -lcp_.hi[i];
  }
}

void Formulation::retarget(const std::vector<Wanted>& wanted, const Eigen::VectorXd& v_free,
                           const Eigen::VectorXd& joint_rate) {
  lcp_.b.resize(static_cast<Index>(rows_.size()));
  Index i = 0;
  const auto hold_against = [&](double target) {
    lcp_.b[i] = apply(rows_[static_cast<std::size_t>(i)], v_free.data()) - target;
    ++i;
  };
  if (form_ == Form::full)
    for (const double target : joint_rate) hold_against(target);
  for (Contact& c : contacts_) {
    const Wanted& want = wanted[c.closed];
    c.rebound = std::max(0.0, want.normal) - std::max(0.0, std::min(want.least, want.normal));
    if (c.jammed != nullptr) {  // where it comes open all the same no impulse is wanted
      const double rate = apply(*c.jammed, v_free.data()) - want.normal;
      lcp_.b[i++] = rate < 0 ? rate : 1;
      continue;
    }
    const double mu = cone_ == Cone::relaxed ? c.mu : 0;
    hold_against(want.normal + mu * want.tangent);
    if (mu > 0) hold_against(want.normal - mu * want.tangent);
  }
  for (const Contact& c : contacts_)
    if (c.frictional) hold_against(wanted[c.closed].tangent);
  while (i < lcp_.b.size()) hold_against(0);
}

void Formulation::release(const std::vector<Impulse>& stored) {
  Index i = form_ == Form::full ? system_.joint_rows() : 0;
  for (const Contact& c : contacts_) lcp_.lo[i++] = c.law->e * stored[static_cast<std::size_t>(c.index)].normal;
}

void Formulation::bind() {
  lcp_.lo.setConstant(-kInf), lcp_.hi.setConstant(kInf);
  lcp_.friction.clear();
}

bool Formulation::solve(Solver& solver, StepReport& report, Crew* crew) {
  if (lcp_.size() == 0) return true;
  if (blank_ >= 0) {
    report.status = Status::numerical_error;
    return false;
  }
  constexpr int kPasses = 10;
  undecided_ = relaxed_ = false;
  for (int pass = 1;; ++pass) {
    const bool solved = solve_once(solver, report, crew) && (!regrade() || solve_once(solver, report, crew));
    if (!give_way(solved, report)) return solved;
    if (pass < kPasses) continue;
    undecided_ = !solved;
    if (undecided_) report.status = Status::numerical_error;
    return solved;
  }
}

bool Formulation::solve_once(Solver& solver, StepReport& report, Crew* crew) {
  if (islands_.count() == 1) {
    solver.solve(lcp_, solution_, Start::warm);
    return report.note(lcp_, solution_);
  }
  const Index n = lcp_.size();
  if (solution_.z.size() != n) solution_.z.resize(n), solution_.z.setZero();
  solution_.w.resize(n), found_.z.resize(n), found_.w.resize(n);
  solution_.residual = 0;
  std::fill(friction_of_.begin(), friction_of_.end(), nullptr);
  for (const Friction& f : lcp_.friction) friction_of_[static_cast<std::size_t>(f.first)] = &f;
  const int count = islands_.count();
  if (outcomes_.size() < static_cast<std::size_t>(count)) outcomes_.resize(static_cast<std::size_t>(count));
  const bool together = worth_sharing(crew);
  if (together) {
    while (benches_.size() < static_cast<std::size_t>(crew->size())) add_bench();
    crew->run(count, solver, [this](int island, Solver& by, int worker) {
      solve_island(island, by, benches_[static_cast<std::size_t>(worker)]);
    });
  }
  Status status = Status::solved;
  for (int island = 0; island < count; ++island) {  // as if one after the other
    if (!together) solve_island(island, solver, benches_[0]);
    const auto rows = islands_.rows(island);
    const Outcome& outcome = outcomes_[static_cast<std::size_t>(island)];
    if (!report.note(static_cast<int>(rows.size()), outcome.status, outcome.residual, outcome.iterations,
                     outcome.miss)) {
      solution_.status = outcome.status, solution_.residual = outcome.residual, solution_.miss = outcome.miss;
      if (outcome.miss.row >= 0) solution_.miss.row = rows[static_cast<std::size_t>(outcome.miss.row)];
      for (const auto& [to, from] :
           {std::pair{&solution_.certificate, &outcome.certificate}, {&solution_.ray, &outcome.ray}}) {
        to->resize(from->size() > 0 ? n : 0);
        to->setZero();
        for (Index i = 0; i < from->size(); ++i) (*to)[rows[static_cast<std::size_t>(i)]] = (*from)[i];
      }
      return false;
    }
    solution_.residual = std::max(solution_.residual, outcome.residual);
    if (outcome.status == Status::rounded) status = Status::rounded;
    for (const int row : rows) solution_.z[row] = found_.z[row], solution_.w[row] = found_.w[row];
  }
  solution_.status = status;  // the judge's, of the islands
  return true;
}

bool Formulation::worth_sharing(const Crew* crew) const {
  if (crew == nullptr || crew->size() == 1) return false;
  std::size_t largest = 0;
  for (int island = 0; island < islands_.count(); ++island) largest = std::max(largest, islands_.rows(island).size());
  return rows_.size() - largest >= kShared;
}

void Formulation::add_bench() { benches_.emplace_back().large.A.emplace<Delassus>().inverse_mass = inverse_mass_; }

/// Writes only what belongs to this island.
void Formulation::solve_island(int island, Solver& solver, Bench& bench) {
  const auto rows = islands_.rows(island);
  const Lcp& block = cut_out(rows, bench);
  const Solution& part = solver.solve(block, bench.part, Start::warm);
  Outcome& outcome = outcomes_[static_cast<std::size_t>(island)];
  outcome.status = part.status, outcome.residual = part.residual, outcome.iterations = part.iterations;
  outcome.miss = part.miss;
  outcome.certificate.resize(part.certificate.size());
  outcome.certificate = part.certificate;
  outcome.ray.resize(part.ray.size());
  outcome.ray = part.ray;
  for (Index i = 0; i < block.size(); ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    found_.z[row] = part.z[i], found_.w[row] = part.w[i];
  }
}

/// Rows and columns of one island, its last z as the guess.
const Lcp& Formulation::cut_out(std::span<const int> rows, Bench& bench) {
  const auto n = static_cast<Index>(rows.size());
  const bool applied = rows.size() > kFormedRows && std::holds_alternative<Delassus>(lcp_.A);
  Lcp& block = applied ? bench.large : bench.small;
  Vector& guess = bench.part.z;
  block.b.resize(n), block.lo.resize(n), block.hi.resize(n), guess.resize(n);
  block.friction.clear();
  for (Index i = 0; i < n; ++i) {
    const int row = rows[static_cast<std::size_t>(i)];
    place_[static_cast<std::size_t>(row)] = static_cast<int>(i);
    block.b[i] = lcp_.b[row], block.lo[i] = lcp_.lo[row], block.hi[i] = lcp_.hi[row], guess[i] = solution_.z[row];
    if (const Friction* f = friction_of_[static_cast<std::size_t>(row)])  // its normal came before
      block.friction.push_back({.normal = place_[static_cast<std::size_t>(f->normal)], .first = i, .mu = f->mu});
  }
  const auto at = [&](Index i) -> const Row& {
    return rows_[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])];
  };
  if (auto* delassus = std::get_if<Delassus>(&block.A)) {
    bench.rows.clear();
    for (Index i = 0; i < n; ++i) bench.rows.push_back(at(i));
    delassus->inverse_mass = inverse_mass_;
    fill_delassus(bench.rows, system_.dof(), *delassus);
    return block;
  }
  auto& A = std::get<DenseMatrix>(block.A);
  A.resize(n, n);
  if (const auto* whole = std::get_if<DenseMatrix>(&lcp_.A)) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        A(i, j) = (*whole)(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
  } else {
    for (Index j = 0; j < n; ++j)
      for (Index i = j; i < n; ++i) A(i, j) = A(j, i) = coupling(at(i), at(j), inverse_mass_);
  }
  return block;
}

bool Formulation::regrade() {
  constexpr double kBound = 1 - 1e-9;  // of the bound: at it
  const double none = 1e-9 * lcp_.b.lpNorm<Eigen::Infinity>();
  const Index joints = form_ == Form::full ? system_.joint_rows() : 0;
  bool any = false;
  for (Friction& friction : lcp_.friction) {
    const Contact& c = contacts_[static_cast<std::size_t>(friction.normal - joints)];
    if (c.law->mu_static <= c.law->mu) continue;
    const double pressure = solution_.z[friction.normal];
    const bool sticks = friction.mu > c.law->mu;
    // At the bound alone is no slip: of contacts that share a load one may be there by the split that the solver took.
    const bool changes = sticks ? std::abs(solution_.w[friction.first]) > none && pressure > 0 &&
                                      std::abs(solution_.z[friction.first]) >= kBound * friction.mu * pressure
                                : solution_.w[friction.first] * c.slip < 0;
    if (!changes) continue;
    friction.mu = sticks ? c.law->mu : c.law->mu_static;
    any = true;
  }
  return any;
}

void Formulation::fill_dense(const BasicSystem& basic, DenseMatrix& A) {
  const auto n = static_cast<Index>(rows_.size());
  A.resize(n, n);
  columns_.resize(system_.dof(), n);
  for (Index j = 0; j < n; ++j) {
    basic.solve_row(rows_[static_cast<std::size_t>(j)], columns_.col(j).data());
    for (Index i = j; i < n; ++i)  // B is symmetric; one half is computed, so that A is so to the last bit
      A(i, j) = A(j, i) = apply(rows_[static_cast<std::size_t>(i)], columns_.col(j).data());
  }
}

void Formulation::advance(Eigen::VectorXd& v, std::vector<Impulse>& impulses) const {
  std::fill(impulses.begin(), impulses.end(), Impulse{});
  if (rows_.empty()) return;
  const Vector& z = solution_.z;
  if (std::holds_alternative<DenseMatrix>(lcp_.A)) {
    v.noalias() += columns_ * z;
  } else {
    const Eigen::VectorXd& inverse_mass = inverse_mass_;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double impulse = z[static_cast<Index>(i)];
      const auto add = [&](BodyId body, const std::array<double, 3>& j) {
        for (int k = 0; body >= 0 && k < 3; ++k)
          v[3 * body + k] += inverse_mass[3 * body + k] * j[static_cast<std::size_t>(k)] * impulse;
      };
      add(rows_[i].a, rows_[i].ja), add(rows_[i].b, rows_[i].jb);
    }
  }
  Index i = form_ == Form::full ? system_.joint_rows() : 0;
  for (const Contact& c : contacts_) {
    Impulse& impulse = impulses[static_cast<std::size_t>(c.index)];
    impulse.normal = z[i++];
    if (cone_ == Cone::coulomb || c.mu <= 0) continue;
    const double other = z[i++];  // of the edge n − μ t
    impulse.tangent = c.mu * (impulse.normal - other);
    impulse.normal += other;
  }
  if (cone_ == Cone::coulomb)
    for (const Contact& c : contacts_)
      if (c.frictional) impulses[static_cast<std::size_t>(c.index)].tangent = z[i++];
}

}  // namespace orthant
