#include <orthant/solvers/cones/cone_system.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/linear_algebra/dense_lu.h>
#include <orthant/solvers/linear_algebra/sparse_budget.h>

#include <klu.h>
#include <umfpack.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

// Measured: dense 0.017 ns n³; UMFPACK 20 µs and 30 ns a nonzero, where not much fills in.
bool factorized_dense(double n, double nonzeros) { return n * n * n <= 1.2e6 + 1800 * nonzeros; }
constexpr double kFullSystem = 0.4;  // share of nonzeros from which it always is dense, up to kDenseFullSystem rows
constexpr int kDenseFullSystem = 1500;
// Operations of a factorization up to which KLU's, column by column, is the faster one: a half to a fifth of the time.
constexpr double kKluOperations = 2e7;
constexpr double kKluThreshold = 0.01;  // of its pivots, over the largest of their column
// ‖M x − b‖∞ / ‖b‖∞ above which factors with the pivots of an earlier matrix are made again with pivots of their own.
constexpr double kKluResidual = 1e-6;

}  // namespace

/// The matrix by rows, which is its transpose by columns, and its factors.
struct ConeSystem::Work {
  std::vector<int> start, column;
  std::vector<double> value;
  std::vector<int> place, row;  // of each row of the form, or −1; the form's rows that are in it
  std::vector<double> sums, rhs, x;
  std::vector<char> met;
  std::vector<int> columns;
  DenseLu<double> dense;
  enum class By { dense, klu, umfpack } by = By::dense;
  klu_common klu{};
  klu_symbolic* klu_analysis = nullptr;
  klu_numeric* klu_factors = nullptr;
  bool pivots_are_older = false;  // than the matrix: of KLU's factors
  void *symbolic = nullptr, *numeric = nullptr;
  std::vector<int> analysed_start, analysed_column;
  const Budget* budget = nullptr;
  double control[UMFPACK_CONTROL] = {}, info[UMFPACK_INFO] = {};

  Work() {
    umfpack_di_defaults(control);
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;  // the pattern is
    control[UMFPACK_IRSTEP] = 0;                             // Newton's next step corrects
    klu_defaults(&klu);
    klu.tol = kKluThreshold, klu.btf = 0, klu.scale = 2;  // contacts are coupled; scaled by the largest
  }
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  ~Work() { release(); }
  void release() {
    klu_free_numeric(&klu_factors, &klu), klu_free_symbolic(&klu_analysis, &klu);
    umfpack_di_free_numeric(&numeric), umfpack_di_free_symbolic(&symbolic);
  }

  bool factorize() {
    const auto n = static_cast<int>(row.size());
    count_factorization(n);
    const auto nonzeros = static_cast<double>(value.size());
    if (factorized_dense(n, nonzeros) || (n <= kDenseFullSystem && nonzeros > kFullSystem * n * n)) {
      by = By::dense;
      double* const M = dense.reset(n);
      std::fill(M, M + at(n) * at(n), 0.0);
      for (int i = 0; i < n; ++i)
        for (int k = start[at(i)]; k < start[at(i) + 1]; ++k) M[at(i) + at(n) * at(column[at(k)])] = value[at(k)];
      return dense.factorize(0.0) == n;
    }
    if ((klu_analysis == nullptr && symbolic == nullptr) || analysed_start != start || analysed_column != column) {
      if (!analyse(n)) return false;
    }
    return by == By::klu ? factorize_by_klu(klu_factors != nullptr) : factorize_by_umfpack();
  }
  bool analyse(int n) {
    release();
    analysed_start = start, analysed_column = column;
    by = By::klu;
    if (!affords_ordering(budget, n, start.data(), column.data())) return false;
    klu_analysis = klu_analyze(n, start.data(), column.data(), &klu);
    if (klu_analysis == nullptr) return false;
    if (budget != nullptr && !budget->affords(klu_analysis->est_flops)) return release(), false;
    if (klu_analysis->est_flops <= kKluOperations) return true;
    by = By::umfpack;
    if (!affords_ordering(budget, n, start.data(), column.data(), kUmfpackOrderings)) return release(), false;
    klu_free_symbolic(&klu_analysis, &klu);
    return umfpack_di_symbolic(n, n, start.data(), column.data(), value.data(), &symbolic, control, info) == UMFPACK_OK;
  }
  bool factorize_by_klu(bool same_pivots) {
    pivots_are_older = same_pivots &&
                       klu_refactor(start.data(), column.data(), value.data(), klu_analysis, klu_factors, &klu) != 0 &&
                       klu.status == KLU_OK;
    if (pivots_are_older) return true;
    klu_free_numeric(&klu_factors, &klu);
    klu_factors = klu_factor(start.data(), column.data(), value.data(), klu_analysis, &klu);
    return klu_factors != nullptr && klu.status == KLU_OK;
  }
  bool factorize_by_umfpack() {
    umfpack_di_free_numeric(&numeric);
    return umfpack_di_numeric(start.data(), column.data(), value.data(), symbolic, &numeric, control, info) ==
           UMFPACK_OK;
  }

  bool solve() {
    x = rhs;
    const auto n = static_cast<int>(row.size());
    if (by == By::dense) {
      dense.solve(x.data());
    } else if (by == By::umfpack) {
      if (umfpack_di_solve(UMFPACK_At, start.data(), column.data(), value.data(), x.data(), rhs.data(), numeric,
                           control, info) != UMFPACK_OK)
        return false;
    } else {
      klu_tsolve(klu_analysis, klu_factors, n, 1, x.data(), &klu);
      if (pivots_are_older && !fits()) {
        if (!factorize_by_klu(false)) return false;
        x = rhs;
        klu_tsolve(klu_analysis, klu_factors, n, 1, x.data(), &klu);
      }
    }
    return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
  }
  /// ‖M x − rhs‖∞ ≤ kKluResidual ‖rhs‖∞; false where x is not finite.
  bool fits() const {
    double largest = 0, miss = 0;
    for (std::size_t i = 0; i < rhs.size(); ++i) {
      double sum = -rhs[i];
      for (int k = start[i]; k < start[i + 1]; ++k) sum += value[at(k)] * x[at(column[at(k)])];
      if (!(std::abs(sum) < HUGE_VAL)) return false;
      miss = std::max(miss, std::abs(sum)), largest = std::max(largest, std::abs(rhs[i]));
    }
    return miss <= kKluResidual * largest;
  }
};

ConeSystem::ConeSystem() : work_(std::make_unique<Work>()) {}
ConeSystem::~ConeSystem() = default;

void ConeSystem::load(const ConeForm& form, const Budget* budget) {
  form_ = &form;
  work_->budget = budget;
  std::size_t total = 0;
  place_.clear();
  for (int c = 0; c < form.blocks(); ++c) {
    place_.push_back(total);
    total += at(form.block(c).rows * form.block(c).rows);
  }
  E_.resize(total), H_.resize(total);
  open.assign(at(form.blocks()), 0);
  F.resize(form.size()), dz.resize(form.size());
}

bool ConeSystem::solve(double alpha) {
  Work& s = *work_;
  if (keep_) {
    for (std::size_t k = 0; k < s.row.size(); ++k) s.rhs[k] = -F[s.row[k]];
    if (!s.solve()) return false;
    for (std::size_t k = 0; k < s.row.size(); ++k) dz[s.row[k]] = s.x[k];
    return true;
  }
  const Index n = form_->size();
  s.place.assign(at(n), -1), s.row.clear();
  for (int c = 0; c < form_->blocks(); ++c) {
    if (open[at(c)]) continue;
    const cones::Block& b = form_->block(c);
    for (int r = b.start; r < b.start + b.rows; ++r)
      s.place[at(r)] = static_cast<int>(s.row.size()), s.row.push_back(r);
  }
  dz = -F;
  if (s.row.empty()) return true;
  s.start.assign(1, 0), s.column.clear(), s.value.clear(), s.rhs.clear();
  s.met.assign(at(n), 0), s.sums.resize(at(n) * at(form_->all().most_rows()));
  const RowSparse& A = form_->A;
  for (int c = 0; c < form_->blocks(); ++c) {
    if (open[at(c)]) continue;
    const cones::Block& b = form_->block(c);
    const int m = b.rows;
    const double* const own_E = E_of(c);
    const double* const own_H = H_of(c);
    s.columns.clear();
    const auto touch = [&](int j) {
      if (s.met[at(j)]) return;
      s.met[at(j)] = 1, s.columns.push_back(j);
      std::fill_n(s.sums.begin() + static_cast<std::ptrdiff_t>(m) * j, m, 0.0);
    };
    for (int r = 0; r < m; ++r) touch(b.start + r);
    for (int k = 0; k < m; ++k) {
      const auto row = at(b.start + k);
      for (std::size_t e = at(A.start[row]); e < at(A.start[row + 1]); ++e) {
        const int j = A.column[e];
        touch(j);
        double* const sum = s.sums.data() + at(m) * at(j);
        for (int r = 0; r < m; ++r) sum[r] += own_H[r + m * k] * A.value[e];
      }
      double* const own = s.sums.data() + at(m) * row;
      for (int r = 0; r < m; ++r) own[r] += alpha * own_H[r + m * k] + own_E[r + m * k];
    }
    std::sort(s.columns.begin(), s.columns.end());
    for (int r = 0; r < m; ++r) {
      double rhs = -F[b.start + r];
      for (const int j : s.columns) {
        const double value = s.sums[at(m) * at(j) + at(r)];
        if (s.place[at(j)] < 0)
          rhs -= value * dz[j];
        else
          s.column.push_back(s.place[at(j)]), s.value.push_back(value);
      }
      s.rhs.push_back(rhs);
      s.start.push_back(static_cast<int>(s.value.size()));
    }
    for (const int j : s.columns) s.met[at(j)] = 0;
  }
  if (!s.factorize() || !s.solve()) return false;
  for (std::size_t k = 0; k < s.row.size(); ++k) dz[s.row[k]] = s.x[k];
  return true;
}

}  // namespace orthant
