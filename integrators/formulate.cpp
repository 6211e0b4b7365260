#include <orthant/integrators/formulate.h>

namespace orthant {
namespace {

constexpr std::size_t kFormedRows = 64;  // up to here a dense A is cheaper than applying the operator again and again

}  // namespace

Formulation::Formulation(const System& system, Form form) : system_(system), form_(form) {
  const auto contacts = system.scene().contacts.size();
  const auto most = 2 * contacts + static_cast<std::size_t>(form == Form::full ? system.joint_rows() : 0);
  const bool diagonal = system.scene().springs.empty() && (form == Form::full || system.joint_rows() == 0);
  // What a step can need at the most is taken now where it is little; else memory grows with the contacts that close.
  rows_.reserve(most);
  lcp_.friction.reserve(contacts);
  const auto size = static_cast<Index>(most);
  slip_.resize(static_cast<Index>(contacts));
  target_.resize(size), lcp_.b.resize(size), lcp_.lo.resize(size), lcp_.hi.resize(size);
  if (diagonal && most > kFormedRows) {
    lcp_.A.emplace<Delassus>().inverse_mass = system.inverse_mass();
  } else if (most <= kFormedRows) {
    std::get<DenseMatrix>(lcp_.A).resize(size, size);
    columns_.resize(system.dof(), size);
  }
  lcp_.b.resize(0);
}

void Formulation::formulate(const Terms& terms, const BasicSystem& basic, const Eigen::VectorXd& v,
                            const Eigen::VectorXd& v_free, const Eigen::VectorXd& joint_rate) {
  collect(terms, v, joint_rate);
  const auto n = static_cast<Index>(rows_.size());
  lcp_.b.resize(n);
  for (Index i = 0; i < n; ++i) lcp_.b[i] = apply(rows_[static_cast<std::size_t>(i)], v_free.data()) - target_[i];
  if (auto* delassus = std::get_if<Delassus>(&lcp_.A))
    fill_delassus(*delassus);
  else
    fill_dense(basic, std::get<DenseMatrix>(lcp_.A));
}

/// Rows in the order joints, normals, tangents, with their targets and bounds.
void Formulation::collect(const Terms& terms, const Eigen::VectorXd& v, const Eigen::VectorXd& joint_rate) {
  rows_.clear();
  lcp_.friction.clear();
  const auto joints = form_ == Form::full ? terms.G.size() : 0;
  const auto contacts = terms.closed.size();
  std::size_t tangents = 0;
  for (const ClosedContact& c : terms.closed) tangents += system_.law(c.contact).frictional();
  const auto n = static_cast<Index>(joints + contacts + tangents);
  target_.resize(n), lcp_.lo.resize(n), lcp_.hi.resize(n), slip_.resize(static_cast<Index>(tangents));
  lcp_.lo.setConstant(-kInf), lcp_.hi.setConstant(kInf);

  rows_.insert(rows_.end(), terms.G.begin(), terms.G.begin() + static_cast<std::ptrdiff_t>(joints));
  if (joints > 0) target_.head(static_cast<Index>(joints)) = joint_rate;
  for (const ClosedContact& c : terms.closed) {
    const auto i = static_cast<Index>(rows_.size());
    target_[i] = -system_.law(c.contact).e * apply(c.rows.normal, v.data());
    lcp_.lo[i] = 0;
    rows_.push_back(c.rows.normal);
  }
  for (std::size_t k = 0; k < contacts; ++k) {
    const ClosedContact& c = terms.closed[k];
    const ContactLaw& law = system_.law(c.contact);
    if (!law.frictional()) continue;
    const auto i = static_cast<Index>(rows_.size());
    const double slip = apply(c.rows.tangent, v.data()) - law.belt;
    slip_[static_cast<Index>(lcp_.friction.size())] = slip;
    target_[i] = law.belt - law.e_t * slip;
    lcp_.friction.push_back({i, static_cast<Index>(joints + k), law.mu_at(slip)});
    rows_.push_back(c.rows.tangent);
  }
}

bool Formulation::hold(const Terms& terms, const Solution& solution) {
  bool any = false;
  const Index first = lcp_.size() - slip_.size(), normals = first - static_cast<Index>(terms.closed.size());
  for (Index k = 0; k < slip_.size(); ++k) {
    Friction& friction = lcp_.friction[static_cast<std::size_t>(k)];
    const ContactLaw& law = system_.law(terms.closed[static_cast<std::size_t>(friction.normal - normals)].contact);
    if (law.mu_static <= friction.mu || solution.w[first + k] * slip_[k] >= 0) continue;
    friction.mu = law.mu_static;
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

void Formulation::fill_delassus(Delassus& A) {
  RowSparse& W = A.W;
  W.rows = static_cast<Index>(rows_.size()), W.cols = system_.dof();
  W.start.assign(1, 0), W.column.clear(), W.value.clear();
  const auto push = [&](BodyId body, const std::array<double, 3>& j) {
    for (int k = 0; body >= 0 && k < 3; ++k)
      W.column.push_back(3 * body + k), W.value.push_back(j[static_cast<std::size_t>(k)]);
  };
  for (const Row& row : rows_) {  // columns ascend within a row
    if (row.a < row.b)
      push(row.a, row.ja), push(row.b, row.jb);
    else
      push(row.b, row.jb), push(row.a, row.ja);
    W.start.push_back(static_cast<int>(W.column.size()));
  }
}

void Formulation::advance(const Terms& terms, const Vector& z, Eigen::VectorXd& v,
                          std::vector<Impulse>& impulses) const {
  std::fill(impulses.begin(), impulses.end(), Impulse{});
  if (rows_.empty()) return;
  if (std::holds_alternative<DenseMatrix>(lcp_.A)) {
    v.noalias() += columns_ * z;
  } else {
    const Eigen::VectorXd& inverse_mass = system_.inverse_mass();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double impulse = z[static_cast<Index>(i)];
      const auto add = [&](BodyId body, const std::array<double, 3>& j) {
        for (int k = 0; body >= 0 && k < 3; ++k)
          v[3 * body + k] += inverse_mass[3 * body + k] * j[static_cast<std::size_t>(k)] * impulse;
      };
      add(rows_[i].a, rows_[i].ja), add(rows_[i].b, rows_[i].jb);
    }
  }
  auto i = static_cast<Index>(form_ == Form::full ? terms.G.size() : 0);
  for (const ClosedContact& c : terms.closed) impulses[static_cast<std::size_t>(c.contact)].normal = z[i++];
  for (const ClosedContact& c : terms.closed)
    if (system_.law(c.contact).frictional()) impulses[static_cast<std::size_t>(c.contact)].tangent = z[i++];
}

}  // namespace orthant
