// solvers/pivoting/normal_path.h — piecewise linear path from any point to a solution of a linear problem, by pivoting.
//
//   Find lo ≤ z ≤ hi and w, v ≥ 0 with M z + q = w − v, w_i > 0 only where z_i = lo_i, v_i > 0 only where z_i = hi_i.
//   Robinson's normal map writes the three as one point x: z = π(x), the projection on [lo, hi], w − v = z − x, so that
//   solutions are the zeros of  M π(x) + q + x − π(x).  At the start its value is r; the path keeps it at (1 − t) r:
//     M z − w + v + r t = r − q,
//   of z_i, w_i, v_i one basic, and t. First t enters; the blocking variable leaves at its bound and its complement
//   enters: w_i after z_i at lo_i, v_i after z_i at hi_i, z_i after either; z_i may run through its whole range at
//   once. t leaves at 1 (solved), or nothing blocks (ray). Free z_i never leave. t may fall below its start, and come
//   back. Two ways to start:
//     from a point    x determines the basis; singular: dependent z_i move to their nearest bound (free ones:
//                     refused).
//     on a ray        z at its bounds, free z solved for, and r = −d z₀ so that w, v ≥ 0: this is Lemke's method.
//   Degeneracy: every basic value is a + b ε with ε → 0 and b random at the start, so that ties of a are broken by b
//   and no basis returns (a lexicographic rule in a random direction). Running error bounds detect a tie.
//   basis.h holds the factors, refactorized every 64 pivots. At each pivot the entering column and the basic values are
//   refined with residuals in long double: in the problems of contact mechanics a basis may be so ill conditioned that
//   the path is lost otherwise.   O(n²) a pivot when dense: four solves, two products with B.
//   T = double, long double or 256 bits (scalars.h). Rows and columns are scaled by powers of 2.
//   Sources: Ralph, Math. Oper. Res. 19 (1994) 352-389; Dirkse & Ferris, Optim. Methods Softw. 5 (1995) 123-156;
//   Cottle, Pang & Stone, The Linear Complementarity Problem (1992), ch. 4.4, 4.9.
#pragma once

#include <orthant/solvers/linear_algebra/basis.h>
#include <orthant/solvers/linear_algebra/columns.h>

#include <functional>
#include <random>
#include <vector>

namespace orthant {

/// Points x(t) of a path, for a search along it; at most `room` numbers, thinned out beyond.
struct PathPoints {
  std::vector<double> t, x;  // x: n numbers a point
  void clear() { t.clear(), x.clear(); }
};

enum class PathEnd { solved, ray, singular, limit, stopped };

template <class T> class NormalPath {  // reuse it: the second problem of a size allocates nothing
 public:
  using End = PathEnd;
  using Storage = BasisStorage;

  /// The problem of the following calls: M and the budget must outlive them. Once that is over, no basis is factorized
  /// any more, as if all were singular.
  void load(const Columns& M, const Vector& q, const Vector& lo, const Vector& hi, Storage storage,
            const Budget& budget);

  /// Sets the random numbers that break ties: another path through the same degenerate vertices.
  void break_ties_by(unsigned seed) { tie_breaker_ = seed; }

  /// From the normal map's point x. False: the basis is singular in free variables.
  bool start(const Vector& x);
  /// On the ray of the covering vector d > 0 (empty: ones).
  bool start_on_ray(const Vector& cover);

  /// To the end; stop(t) is polled at each pivot. `points`, unless null, takes the breakpoints.
  End follow(int max_pivots, const std::function<bool(double)>& stop, PathPoints* points = nullptr);

  int pivots() const { return pivots_; }
  double t() const { return static_cast<double>(t_); }
  /// z and the normal map's x where the path has come to; after `solved`, z is refined with residuals in long double.
  void point(Vector& z, Vector& x) const;
  /// After `ray`: the direction in which z goes to infinity.
  void direction(Vector& dz) const;

 private:
  enum class Side : char { lower, upper, inside };
  using Sum = std::conditional_t<std::is_floating_point_v<T>, long double, T>;
  using Values = Reusable<Eigen::Matrix<T, Eigen::Dynamic, 1>>;  // by position
  int t_code() const { return static_cast<int>(3 * n_); }
  int index_of(int code) const { return code % static_cast<int>(n_); }
  int kind_of(int code) const { return code / static_cast<int>(n_); }  // 0: z, 1: w, 2: v, 3: t
  T bound(Index i) const { return side_[at(i)] == Side::upper ? hi_[at(i)] : lo_[at(i)]; }
  T lower(int code) const { return kind_of(code) == 0 ? lo_[at(code)] : kind_of(code) == 3 ? -kInf : T(0); }
  T upper(int code) const { return kind_of(code) == 0 ? hi_[at(code)] : kind_of(code) == 3 ? T(1) : T(kInf); }
  template <class Use> void column(int code, const Use& use) const;
  bool factorize();
  bool choose_basis();
  void begin(Index n);
  void perturb();
  bool recompute(bool with_t);
  void subtract(int code, T value);
  void refine(Values& values);
  void refine_values(bool with_t);
  bool solve_entering();
  int ratio_test(int entering, T sign, T& step, T& tilt);
  void record(PathPoints& points) const;

  const Columns* M_ = nullptr;
  Index n_ = 0;
  int pivots_ = 0;
  unsigned tie_breaker_ = 0;
  T t_ = 0, sign_ = 1;
  int entering_ = 0;
  Basis<T> basis_;
  std::vector<T> q_, lo_, hi_, row_, col_;       // scaled; row_, col_: the scales
  std::vector<T> r_, right_, tilted_right_;      // r, r − q; what the random part is the solution for
  std::vector<int> code_;                        // by position: which variable is basic
  std::vector<Side> side_;                       // of each z
  Values a_, b_, d_, error_, rhs_, correction_;  // values a + b ε; bounds of a's error
  std::vector<Sum> long_;
  std::vector<int> low_, high_, tied_;
};

extern template class NormalPath<double>;
extern template class NormalPath<long double>;
extern template class NormalPath<detail::Float256>;

}  // namespace orthant
