#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace orthant {

namespace {

constexpr double kParted = 1e-6;  // of the largest rate: more is not rounding

void check_part(const char* part, Index size, Index n) {
  if (size != 0 && size != n)
    throw std::invalid_argument("perturbation: " + std::string(part) + " has " + std::to_string(size) +
                                " entries: must be " + std::to_string(n) + ", or none");
}

Vector diagonal_times(const Vector& diagonal, const Eigen::VectorXd& x) { return Vector(diagonal.cwiseProduct(x)); }

}  // namespace

Vector multiply_change(const Matrix& A, const Matrix& change, const Vector& x) {
  const auto* of = std::get_if<Delassus>(&A);
  const auto* parts = std::get_if<Delassus>(&change);
  if (of == nullptr || parts == nullptr) {
    Vector y, scratch;
    if (order(change) != x.size())
      throw std::invalid_argument("perturbation: A has " + std::to_string(order(change)) + " rows: must be " +
                                  std::to_string(x.size()));
    multiply(change, x, y, scratch);
    return y;
  }
  const Eigen::VectorXd along = of->W.view().transpose() * x;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  if (parts->W.rows > 0) {
    if (parts->W.rows != of->W.rows || parts->W.cols != of->W.cols)
      throw std::invalid_argument("perturbation: W is " + std::to_string(parts->W.rows) + " x " +
                                  std::to_string(parts->W.cols) + ": must be as the problem's");
    y += parts->W.view() * Eigen::VectorXd(of->inverse_mass.cwiseProduct(along));
    y += of->W.view() * Eigen::VectorXd(of->inverse_mass.cwiseProduct(parts->W.view().transpose() * x));
  }
  check_part("inverse_mass", parts->inverse_mass.size(), of->W.cols);
  check_part("regularization", parts->regularization.size(), x.size());
  if (parts->inverse_mass.size() > 0) y += of->W.view() * Eigen::VectorXd(parts->inverse_mass.cwiseProduct(along));
  if (parts->regularization.size() > 0) y += parts->regularization.cwiseProduct(x);
  return y;
}

Sensitivity::Sensitivity(const Lcp& problem, const Solution& solution) : problem_(problem), z_(solution.z) {
  check(problem);
  if (!has_answer(solution.status) || solution.z.size() != problem.size() || solution.w.size() != problem.size())
    throw std::invalid_argument("sensitivity: the solution is " + std::string(name(solution.status)) +
                                ": must be solved or rounded, of this problem");
  pattern_ = ActivePattern(problem, solution);
  system_.factorize(problem_.A, pattern_.E, pattern_.P, pattern_.D);
  report_.unknowns = pattern_.D.size();
  report_.reciprocal_condition = system_.reciprocal_condition();
  report_.redundant = system_.singular();
  report_.weakly_active = pattern_.weak;
  report_.threshold = pattern_.threshold;
  report_.margin = pattern_.margin;
  double least = kInf;
  auto weak = pattern_.weak.begin();
  for (Index i = 0; i < problem.size(); ++i) {
    if (weak != pattern_.weak.end() && weak->row == i) {
      ++weak;
      continue;
    }
    if (pattern_.margin[i] < least) least = pattern_.margin[i], report_.nearest = i;
  }
}

Vector Sensitivity::times(const Vector& x) const {
  Vector y, scratch;
  multiply(problem_.A, x, y, scratch);
  return y;
}

Eigen::VectorXd Sensitivity::transposed(const Eigen::VectorXd& x) const { return multiply_transposed(problem_.A, x); }

SolutionTangent Sensitivity::tangent(const Perturbation& change, Eigen::VectorXd& at_rest) const {
  const Index n = problem_.size();
  check_part("b", change.b.size(), n), check_part("lo", change.lo.size(), n), check_part("hi", change.hi.size(), n);
  check_part("mu", change.mu.size(), static_cast<Index>(problem_.friction.size()));
  at_rest.setZero(n);  // ẇ₀
  if (change.b.size() > 0) at_rest = change.b;
  if (change.A) at_rest += multiply_change(problem_.A, *change.A, z_);
  Eigen::VectorXd p;
  pattern_.held(change.lo, change.hi, change.mu, p);
  Eigen::VectorXd w = at_rest;
  if (!p.isZero(0)) w += times(p);
  Eigen::VectorXd y = pattern_.P.transpose() * w;
  y = -y;
  SolutionTangent t;
  t.parted = system_.solve(y);
  t.consistent = t.parted <= kParted;
  t.z = p + pattern_.E * y;
  t.w = times(t.z) + at_rest;
  return t;
}

SolutionTangent Sensitivity::jvp(const Perturbation& change) const {
  Eigen::VectorXd at_rest;
  return tangent(change, at_rest);
}

DataGradient Sensitivity::vjp(const Vector& g, const Vector& h) const {
  const Index n = problem_.size();
  if (g.size() != n || (h.size() != 0 && h.size() != n))
    throw std::invalid_argument("vjp: g has " + std::to_string(g.size()) + " entries, h " + std::to_string(h.size()) +
                                ": must be " + std::to_string(n) + ", h may have none");
  Eigen::VectorXd a = g;
  if (h.size() > 0) a += transposed(h);
  Eigen::VectorXd lambda = pattern_.E.transpose() * a;
  DataGradient gradient;
  gradient.parted = system_.solve_transposed(lambda);
  gradient.consistent = gradient.parted <= kParted;
  const Eigen::VectorXd spread = pattern_.P * lambda;
  gradient.b = -spread;
  if (h.size() > 0) gradient.b += h;
  pattern_.held_transposed(a - transposed(spread), gradient.lo, gradient.hi, gradient.mu);
  return gradient;
}

SolutionTangent Sensitivity::directional(const Perturbation& change) const {
  Eigen::VectorXd at_rest;
  SolutionTangent t = tangent(change, at_rest);
  const Index m = pattern_.E_weak.cols();
  if (m == 0) return t;
  Eigen::MatrixXd Z(problem_.size(), m), W(problem_.size(), m);  // ż and ẇ of u_j = 1
  for (Index j = 0; j < m; ++j) {
    const Vector direction = Eigen::VectorXd(pattern_.E_weak.col(j));
    Eigen::VectorXd y = pattern_.P.transpose() * times(direction);
    y = -y;
    t.consistent = system_.solve(y) <= kParted && t.consistent;
    const Vector z = direction + pattern_.E * y;
    Z.col(j) = z, W.col(j) = times(z);
  }
  constexpr double kNoise = 1e-12;  // of the terms: dependent rows leave rounding
  const auto clean = [&](const auto& z, const Eigen::VectorXd& w, double at_rest_too) -> Eigen::VectorXd {
    const Eigen::VectorXd size =
        pattern_.P_weak.cwiseAbs().transpose() * (pattern_.weight * z.template lpNorm<Eigen::Infinity>()).eval();
    const Eigen::VectorXd along = pattern_.P_weak.transpose() * w;
    return (along.cwiseAbs().array() <= kNoise * (size.array() + at_rest_too)).select(0.0, along);
  };
  Eigen::MatrixXd S(m, m);
  for (Index j = 0; j < m; ++j) S.col(j) = clean(Z.col(j), W.col(j), 0);
  Lcp small;
  small.A = DenseMatrix(S);
  small.b = clean(t.z, t.w, at_rest.lpNorm<Eigen::Infinity>());
  const double size = small.b.lpNorm<Eigen::Infinity>();
  if (!(size > 0)) return t;
  small.b /= size;
  small.lo = Eigen::VectorXd::Zero(m), small.hi = Eigen::VectorXd::Constant(m, kInf);
  small.friction = pattern_.weak_friction;
  for (const Friction& f : small.friction) small.lo.segment(f.first, f.rows).setConstant(-kInf);
  Solution u;
  if (!has_answer(make_solver("auto")->solve(small, u).status))
    throw std::runtime_error("directional: the problem of the " + std::to_string(m) +
                             " weakly active directions ended as " + std::string(name(u.status)) +
                             (report_.redundant || u.status == Status::infeasible
                                  ? ": the change may part redundant rows, and there is no derivative"
                                  : ""));
  t.z += size * (Z * u.z), t.w += size * (W * u.z);
  return t;
}

Matrix gradient_of_matrix(const Sensitivity& of, const DataGradient& gradient) {
  const Matrix& A = of.problem().A;
  const Vector& z = of.z();
  if (std::holds_alternative<DenseMatrix>(A)) return DenseMatrix(gradient.b * z.transpose());
  const auto on_pattern = [](const RowSparse& like, const auto& entry) {
    RowSparse result = like;
    for (Index i = 0; i < like.rows; ++i)
      for (int k = like.start[at(i)]; k < like.start[at(i) + 1]; ++k)
        result.value[static_cast<std::size_t>(k)] = entry(i, like.column[static_cast<std::size_t>(k)]);
    return result;
  };
  if (const auto* sparse = std::get_if<RowSparse>(&A))
    return on_pattern(*sparse, [&](Index i, Index j) { return gradient.b[i] * z[j]; });
  const auto& parts = std::get<Delassus>(A);
  const Eigen::VectorXd Wz = parts.W.view().transpose() * z, Wb = parts.W.view().transpose() * gradient.b;
  Delassus result;
  result.W = on_pattern(
      parts.W, [&](Index i, Index j) { return parts.inverse_mass[j] * (gradient.b[i] * Wz[j] + z[i] * Wb[j]); });
  result.inverse_mass = diagonal_times(Vector(Wz), Wb);
  result.regularization = diagonal_times(gradient.b, z);
  return result;
}

std::string words_of(const SensitivityReport& report) {
  std::ostringstream text;
  text << report.unknowns << " unknowns, reciprocal condition " << report.reciprocal_condition;
  if (report.redundant) text << "\nredundant rows: z is not unique; derivatives of what is unique (w, velocities) only";
  for (const WeaklyActive& row : report.weakly_active)
    text << "\nrow " << row.row << " is weakly active: " << row.distance << " from its bound, w = " << row.w
         << "; one-sided derivatives only";
  if (report.nearest >= 0)
    text << "\nrow " << report.nearest << " is the nearest to another pattern, by " << report.margin[report.nearest];
  return text.str();
}

}  // namespace orthant
