#include <orthant/core/lcp/files/io.h>
#include <orthant/core/lcp/files/io_fclib.h>

#include <orthant/core/lcp/files/hdf5_image.h>
#include <orthant/core/lcp/files/hdf5_input.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// One file's datasets, by path; every complaint names both.
class Reader : public Hdf5Input {
 public:
  using Hdf5Input::Hdf5Input;

  int whole(const std::string& path) const {
    const auto values = integers(path);
    if (values.size() != 1) refuse(path, "has " + std::to_string(values.size()) + " entries: must have 1");
    return values.front();
  }
  Vector vector(const std::string& path, Index n) const {
    const auto values = numbers(path);
    if (static_cast<Index>(values.size()) != n)
      refuse(path, "has " + std::to_string(values.size()) + " entries: must have " + std::to_string(n));
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values[i]))
        refuse(path + "[" + std::to_string(i) + "]", "= " + detail::text_of(values[i]) + ": must be finite");
    return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
  }
  /// Empty where there is none: words are no reason to lose a problem.
  std::string words(const std::string& path) const try {
    return has(path) ? text(path) : std::string();
  } catch (const std::runtime_error&) {
    return {};
  }

  Sparse matrix(const std::string& path) const {
    const int m = whole(path + "/m"), n = whole(path + "/n"), nz = whole(path + "/nz");
    const std::string sizes = std::to_string(m) + " x " + std::to_string(n);
    if (m < 0 || n < 0) refuse(path, "is " + sizes + ": sizes must be >= 0");
    if (static_cast<std::uintmax_t>(std::max(m, n)) > most_numbers())
      refuse(path, "is " + sizes + ": must not be larger than a file of this size can be");
    if (nz < -2) refuse(path + "/nz", "= " + std::to_string(nz) + ": must be >= 0, -1 (columns) or -2 (rows)");
    std::vector<int> p = integers(path + "/p"), i = integers(path + "/i");
    const Vector x = vector(path + "/x", static_cast<Index>(i.size()));
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int column, std::size_t k) {
      if (row < 0 || row >= m || column < 0 || column >= n)
        refuse(path, "has an entry at (" + std::to_string(row) + ", " + std::to_string(column) + "): must be within " +
                         sizes);
      entries.emplace_back(row, column, x[static_cast<Index>(k)]);
    };
    if (nz >= 0) {
      const auto count = static_cast<std::size_t>(nz);
      if (p.size() < count || i.size() < count)
        refuse(path + "/nz", "= " + std::to_string(nz) + ": must not exceed the lengths of p and i");
      for (std::size_t k = 0; k < count; ++k) add(i[k], p[k], k);
    } else {
      const auto outer = static_cast<std::size_t>(nz == -1 ? n : m);
      if (p.size() != outer + 1 || p.front() != 0 || !std::is_sorted(p.begin(), p.end()) ||
          static_cast<std::size_t>(p.back()) > i.size())
        refuse(path + "/p", "must ascend from 0 to the number of entries, one more than there are " +
                                std::string(nz == -1 ? "columns" : "rows"));
      for (std::size_t o = 0; o < outer; ++o)
        for (auto k = static_cast<std::size_t>(p[o]); k < static_cast<std::size_t>(p[o + 1]); ++k)
          nz == -1 ? add(i[k], static_cast<int>(o), k) : add(static_cast<int>(o), i[k], k);
    }
    Sparse A(m, n);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }
};

bool is_diagonal(const Sparse& A) {
  for (Index i = 0; i < A.outerSize(); ++i)
    for (Sparse::InnerIterator it(A, i); it; ++it)
      if (it.col() != i && it.value() != 0) return false;
  return true;
}

std::string size_of(const Sparse& A) { return std::to_string(A.rows()) + " x " + std::to_string(A.cols()); }

/// Returns the rows of the contacts; those of λ stand behind them.
Index read_local(const Reader& in, const std::string& group, Lcp& problem) {
  const Sparse W = in.matrix(group + "/W");
  const Index n = W.rows();
  if (W.cols() != n) in.refuse(group + "/W", "is " + size_of(W) + ": must be square");
  const Vector q = in.vector(group + "/vectors/q", n);
  if (!in.has(group + "/V")) {
    if (in.has(group + "/R")) in.refuse(group + "/R", "stands without V: must have it");
    problem.A = RowSparse::from(W), problem.b = q;
    return n;
  }
  const Sparse V = in.matrix(group + "/V");
  const Index m = V.cols();
  if (V.rows() != n) in.refuse(group + "/V", "is " + size_of(V) + ": must have " + std::to_string(n) + " rows, as W");
  Sparse R(m, m);
  if (in.has(group + "/R")) R = in.matrix(group + "/R");
  if (R.rows() != m || R.cols() != m)
    in.refuse(group + "/R", "is " + size_of(R) + ": must be square, with " + std::to_string(m) + " columns, as V");
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&entries](const Sparse& M, Index row, Index column, bool transposed) {
    for (Index i = 0; i < M.outerSize(); ++i)
      for (Sparse::InnerIterator it(M, i); it; ++it)
        entries.emplace_back(static_cast<int>(row + (transposed ? it.col() : it.row())),
                             static_cast<int>(column + (transposed ? it.row() : it.col())), it.value());
  };
  add(W, 0, 0, false), add(V, 0, n, false), add(V, n, 0, true), add(R, n, n, false);
  Sparse A(n + m, n + m);
  A.setFromTriplets(entries.begin(), entries.end());
  problem.A = RowSparse::from(A);
  problem.b.resize(n + m);
  problem.b.head(n) = q;
  problem.b.tail(m) =
      in.has(group + "/vectors/s") ? in.vector(group + "/vectors/s", m) : Vector(Eigen::VectorXd::Zero(m));
  return n;
}

Index read_global(const Reader& in, const std::string& group, ContactProblem& p) {
  const Sparse M = in.matrix(group + "/M"), H = in.matrix(group + "/H");
  const Index m = M.rows();
  if (M.cols() != m) in.refuse(group + "/M", "is " + size_of(M) + ": must be square");
  if (H.rows() != m) in.refuse(group + "/H", "is " + size_of(H) + ": must have " + std::to_string(m) + " rows, as M");
  const Vector f = in.vector(group + "/vectors/f", m), w = in.vector(group + "/vectors/w", H.cols());
  Sparse J = H.transpose();
  Eigen::VectorXd b = w;
  if (in.has(group + "/G")) {
    const Sparse G = in.matrix(group + "/G");
    if (G.rows() != m) in.refuse(group + "/G", "is " + size_of(G) + ": must have " + std::to_string(m) + " rows, as M");
    Sparse both(H.cols() + G.cols(), m);
    both.topRows(H.cols()) = J, both.bottomRows(G.cols()) = Sparse(G.transpose());
    J = both;
    b.conservativeResize(J.rows());
    b.tail(G.cols()) = in.vector(group + "/vectors/b", G.cols());
  }
  p.global = {.mass = RowSparse::from(M), .jacobian = RowSparse::from(J), .force = f, .offset = b};
  if (is_diagonal(M)) {
    Delassus A{RowSparse::from(J), Eigen::VectorXd(M.diagonal().cwiseInverse()), {}};
    for (Index i = 0; i < m; ++i)
      if (!(A.inverse_mass[i] > 0 && A.inverse_mass[i] < kInf))
        in.refuse(group + "/M", "has " + detail::text_of(M.coeff(i, i)) + " on its diagonal, row " + std::to_string(i) +
                                    ": must be > 0");
    p.problem.b = b + J * Eigen::VectorXd(A.inverse_mass.cwiseProduct(f));
    p.problem.A = std::move(A);
    return H.cols();
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> symmetric(Eigen::SparseMatrix<double>(M) +
                                                                     Eigen::SparseMatrix<double>(M.transpose()));
  if (symmetric.info() != Eigen::Success || symmetric.vectorD().minCoeff() <= 0)
    in.refuse(group + "/M", "has a symmetric part that is not positive definite: must have one that is");
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{Eigen::SparseMatrix<double>(M)};
  if (lu.info() != Eigen::Success) in.refuse(group + "/M", "is singular: must have an inverse");
  const Eigen::SparseMatrix<double> X = lu.solve(Eigen::SparseMatrix<double>(J.transpose()));
  p.problem.A = RowSparse::from(Sparse(J * X));
  p.problem.b = b + J * Eigen::VectorXd(lu.solve(Eigen::VectorXd(f)));
  return H.cols();
}

/// z of the group `solution`, where the file has one that fits.
void read_solution(const Reader& in, Index contact_rows, ContactProblem& p) try {
  if (!in.has("solution/r")) return;
  const Index n = p.problem.size();
  const Vector r = in.vector("solution/r", contact_rows);
  if (n > contact_rows && !in.has("solution/l")) return;
  Vector l;
  if (n > contact_rows) l = in.vector("solution/l", n - contact_rows);
  p.solution.resize(n);
  p.solution.head(contact_rows) = r, p.solution.tail(n - contact_rows) = l;
} catch (const std::runtime_error& e) {
  p.unfit = e.what();
}

void write_matrix(Hdf5Image& out, const std::string& path, const RowSparse& A) {
  out.group(path);
  out.whole(path + "/m", static_cast<int>(A.rows)), out.whole(path + "/n", static_cast<int>(A.cols));
  out.whole(path + "/nzmax", static_cast<int>(A.value.size())), out.whole(path + "/nz", -2);
  out.numbers(path + "/p", A.start), out.numbers(path + "/i", A.column), out.numbers(path + "/x", A.value);
}

/// J M⁻¹Jᵀ as its parts; none where it is not of this kind, or without a mass matrix (M⁻¹ with zeros).
std::optional<GlobalForm> global_form(const Lcp& p) {
  const auto* delassus = std::get_if<Delassus>(&p.A);
  if (delassus == nullptr || delassus->regularization.size() != 0 ||
      (delassus->inverse_mass.size() != 0 && delassus->inverse_mass.minCoeff() <= 0))
    return std::nullopt;
  const Index m = delassus->W.cols;
  Sparse M(m, m);
  for (Index i = 0; i < m; ++i) M.insert(i, i) = 1 / delassus->inverse_mass[i];
  return GlobalForm{RowSparse::from(M), delassus->W, Eigen::VectorXd::Zero(m), p.b};
}

[[noreturn]] void refuse_to_write(Index row, const std::string& rule) {
  throw std::invalid_argument("row " + std::to_string(row) + ": must be " + rule);
}

/// μ of each contact, then its μ_r; throws unless the rows are those of contacts in order, free ones behind.
std::array<std::vector<double>, 2> coefficients(const ContactProblem& p) {
  const Index d = p.dimension, n = p.problem.size();
  if (d != 2 && d != 3 && d != 5)
    throw std::invalid_argument("dimension = " + std::to_string(d) + ": must be 2, 3 or 5");
  if (p.contacts < 0 || p.contacts * d > n)
    throw std::invalid_argument("contacts = " + std::to_string(p.contacts) + ": must give at most " +
                                std::to_string(n) + " rows, " + std::to_string(d) + " each");
  std::vector<const Friction*> of(static_cast<std::size_t>(n), nullptr);
  for (const Friction& f : p.problem.friction)
    for (Index r = 0; r < f.rows; ++r) of[static_cast<std::size_t>(f.first + r)] = &f;
  std::array<std::vector<double>, 2> mu;
  for (Index row = 0; row < n; ++row) {
    const Friction* f = of[static_cast<std::size_t>(row)];
    const bool contact = row < d * p.contacts, normal = contact && row % d == 0;
    const double lo = p.problem.lo[row], hi = p.problem.hi[row];
    if (normal && (f != nullptr || lo != 0 || hi != kInf)) refuse_to_write(row, "a normal row, [0, inf)");
    if (contact && row % d == 1 && (f == nullptr || f->normal != row - 1 || f->rows != (d == 2 ? 1 : 2)))
      refuse_to_write(row,
                      d == 2 ? "friction of the normal row before it" : "a disc of the normal row before it, two rows");
    if (contact && row % d == 3 && (f == nullptr || f->normal != row - 3 || f->rows != 2))
      refuse_to_write(row, "a disc of rolling moments of the contact's normal row, two rows");
    if (!contact && (f != nullptr || lo != -kInf || hi != kInf)) refuse_to_write(row, "free, behind the contacts");
    if (contact && row % d == 1) mu[0].push_back(f->mu);
    if (contact && row % d == 3) mu[1].push_back(f->mu);
  }
  return mu;
}

}  // namespace

Vector ContactProblem::velocity(const Vector& z) const {
  if (!global) return {};
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu{Eigen::SparseMatrix<double>(global->mass.view())};
  return Eigen::VectorXd(lu.solve(Eigen::VectorXd(global->force + Sparse(global->jacobian.view()).transpose() * z)));
}

ContactProblem read_fclib(const std::filesystem::path& file) {
  const Reader in(file);
  ContactProblem p;
  std::string group;
  for (const char* known : {"fclib_local", "fclib_global", "fclib_local_rolling", "fclib_global_rolling"}) {
    if (!in.has(known)) continue;
    if (!group.empty()) in.refuse("the file", "must have one problem: has " + group + " and " + known);
    group = known;
  }
  if (group.empty())
    in.refuse("the file", "must have one group, fclib_local or fclib_global, each perhaps with _rolling behind it");
  const bool local = group.starts_with("fclib_local"), rolling = group.ends_with("_rolling");
  p.dimension = in.whole(group + "/spacedim");
  if (rolling ? p.dimension != 5 : p.dimension != 2 && p.dimension != 3)
    in.refuse(group + "/spacedim", "= " + std::to_string(p.dimension) + ": must be " + (rolling ? "5" : "2 or 3"));
  p.title = in.words(group + "/info/title"), p.description = in.words(group + "/info/description");
  const Index rows = local ? read_local(in, group, p.problem) : read_global(in, group, p);
  if (rows % p.dimension != 0)
    in.refuse(group, "has " + std::to_string(rows) +
                         " contact rows: must be a multiple of spacedim = " + std::to_string(p.dimension));
  p.contacts = rows / p.dimension;
  const Index n = p.problem.size();
  p.problem.lo = Eigen::VectorXd::Constant(n, -kInf), p.problem.hi = Eigen::VectorXd::Constant(n, kInf);
  const auto coefficient = [&](const char* name) {
    const Vector mu = in.vector(group + "/vectors/" + name, p.contacts);
    for (Index k = 0; k < p.contacts; ++k)
      if (mu[k] < 0)
        in.refuse(group + "/vectors/" + name + "[" + std::to_string(k) + "]",
                  "= " + detail::text_of(mu[k]) + ": must be >= 0");
    return mu;
  };
  const Vector mu = coefficient("mu"), mu_r = rolling ? coefficient("mu_r") : Vector();
  for (Index k = 0; k < p.contacts; ++k) {
    const Index normal = p.dimension * k;
    p.problem.lo[normal] = 0;
    p.problem.friction.push_back({normal, normal + 1, p.dimension == 2 ? 1 : 2, mu[k]});
    if (rolling) p.problem.friction.push_back({normal, normal + 3, 2, mu_r[k]});
  }
  check(p.problem);
  read_solution(in, rows, p);
  return p;
}

void write_fclib(const std::filesystem::path& file, const ContactProblem& p, const Solution* solution) {
  check(p.problem);
  const std::optional<GlobalForm> made = p.global ? std::nullopt : global_form(p.problem);
  const GlobalForm* const global = p.global ? &*p.global : made ? &*made : nullptr;
  if (global != nullptr && global->jacobian.rows != p.problem.size())
    throw std::invalid_argument("global: has " + std::to_string(global->jacobian.rows) + " rows, the problem " +
                                std::to_string(p.problem.size()));
  const auto [mu, mu_r] = coefficients(p);
  const Index n = p.problem.size(), rows = p.dimension * p.contacts;
  Hdf5Image out;
  const std::string group =
      std::string(global != nullptr ? "fclib_global" : "fclib_local") + (p.dimension == 5 ? "_rolling" : "");
  out.group(group), out.group(group + "/vectors"), out.group(group + "/info");
  out.whole(group + "/spacedim", p.dimension);
  out.numbers(group + "/vectors/mu", mu);
  if (p.dimension == 5) out.numbers(group + "/vectors/mu_r", mu_r);
  out.text(group + "/info/title", p.title), out.text(group + "/info/description", p.description);
  out.text(group + "/info/math_info", "");
  const auto vector = [&](const std::string& path, const Eigen::VectorXd& x) {
    out.numbers(path, std::span(x.data(), static_cast<std::size_t>(x.size())));
  };
  if (global != nullptr) {
    const Sparse J = global->jacobian.view();
    write_matrix(out, group + "/M", global->mass);
    write_matrix(out, group + "/H", RowSparse::from(Sparse(Sparse(J.topRows(rows)).transpose())));
    vector(group + "/vectors/f", global->force), vector(group + "/vectors/w", global->offset.head(rows));
    if (rows < n) {
      write_matrix(out, group + "/G", RowSparse::from(Sparse(Sparse(J.bottomRows(n - rows)).transpose())));
      vector(group + "/vectors/b", global->offset.tail(n - rows));
    }
  } else {
    RowSparse formed;
    const Sparse A = rows_of(p.problem.A, formed)->view();
    if (rows == n) {
      write_matrix(out, group + "/W", RowSparse::from(A));
    } else {
      const Index m = n - rows;
      const Sparse contacts = A.topRows(rows), others = A.bottomRows(m);
      const Sparse V = contacts.rightCols(m);
      if (!Sparse(Sparse(V.transpose()) - Sparse(others.leftCols(rows))).coeffs().isZero(0))
        refuse_to_write(rows, "coupled with the contacts symmetrically, as FCLIB's V and its transpose");
      write_matrix(out, group + "/W", RowSparse::from(Sparse(contacts.leftCols(rows))));
      write_matrix(out, group + "/V", RowSparse::from(V));
      write_matrix(out, group + "/R", RowSparse::from(Sparse(others.rightCols(m))));
      vector(group + "/vectors/s", p.problem.b.tail(m));
    }
    vector(group + "/vectors/q", p.problem.b.head(rows));
  }
  if (solution != nullptr) {
    const ConeResiduals residuals = cone_residuals(p.problem, solution->z);
    out.group("solution");
    vector("solution/r", solution->z.head(rows)), vector("solution/u", solution->w.head(rows));
    if (rows < n) vector("solution/l", solution->z.tail(n - rows));
    if (const Vector v = p.velocity(solution->z); v.size() > 0) vector("solution/v", v);
    const auto number = [&](const char* name, double value) {
      out.numbers(std::string("solution/") + name, std::span<const double>(&value, 1));
    };
    number("residual_scale_free", residuals.scale_free), number("residual_natural", residuals.natural);
  }
  write_whole(file, out.bytes());
}

}  // namespace orthant
