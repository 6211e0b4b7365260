#include <orthant/solvers/pivoting/normal_path.h>

#include <cmath>
#include <limits>

namespace orthant {
namespace {

using std::abs, std::ilogb, std::ldexp;  // those of Float256 are found by its namespace

template <class T> const T kEps = std::numeric_limits<T>::epsilon();
template <class T> const T kPivot = std::is_same_v<T, double>        ? T(0x1p-36)
                                    : std::is_same_v<T, long double> ? T(0x1p-47)
                                                                     : T(0x1p-192);  // relative to its column
// What refinement changes shows how far rounding reaches, that of the data included: an entry of the entering column no
// larger than kPivotNoise of it is a zero, as cancellation leaves it in the degenerate problems of contact mechanics;
// ratios that differ by no more than kTie of it are tied.
constexpr int kPivotNoise = 1024, kTie = 256;
constexpr std::size_t kRoom = 2000000;  // numbers kept of a path

}  // namespace

template <class T> void NormalPath<T>::load(const Columns& M, const Vector& q, const Vector& lo, const Vector& hi,
                                            Storage storage, const Budget& budget) {
  M_ = &M;
  n_ = M.size();
  const std::size_t n = at(n_);
  basis_.reset(n_, storage, 64, &budget);
  row_.assign(n, T(1));
  col_.assign(n, T(1));
  // Middle of the exponents of each column, then of each row, where they span many orders.
  low_.assign(n, 0), high_.assign(n, 0);
  int least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
  for (const double value : M.value)
    if (value != 0) least = std::min(least, ilogb(value)), most = std::max(most, ilogb(value));
  for (int sweep = 0; sweep < 8 && most > least && most - least > 24; ++sweep) {
    auto& scale = sweep % 2 == 0 ? col_ : row_;
    std::fill(low_.begin(), low_.end(), std::numeric_limits<int>::max());
    std::fill(high_.begin(), high_.end(), std::numeric_limits<int>::min());
    for (Index j = 0; j < n_; ++j)
      M.each(j, [&](Index i, double value) {
        if (value == 0) return;
        const std::size_t k = at(sweep % 2 == 0 ? j : i);
        const int exponent = ilogb(static_cast<T>(value) * row_[at(i)] * col_[at(j)]);
        low_[k] = std::min(low_[k], exponent), high_[k] = std::max(high_[k], exponent);
      });
    for (std::size_t k = 0; k < n; ++k)
      if (low_[k] <= high_[k]) scale[k] = ldexp(scale[k], -(low_[k] + high_[k]) / 2);
  }
  q_.resize(n), lo_.resize(n), hi_.resize(n), r_.resize(n), right_.resize(n), tilted_right_.resize(n);
  for (Index i = 0; i < n_; ++i) {
    q_[at(i)] = static_cast<T>(q[i]) * row_[at(i)];
    lo_[at(i)] = static_cast<T>(lo[i]) / col_[at(i)];
    hi_[at(i)] = static_cast<T>(hi[i]) / col_[at(i)];
  }
  code_.resize(n), side_.resize(n), long_.resize(n);
  for (auto* v : {&a_, &b_, &d_, &error_, &rhs_, &correction_}) v->resize(n_);
  pivots_ = 0;
  t_ = 0;
}

template <class T> template <class Use> void NormalPath<T>::column(int code, const Use& use) const {
  const Index i = index_of(code);
  switch (kind_of(code)) {
    case 0:
      M_->each(i, [&](Index k, double value) { use(k, static_cast<T>(value) * row_[at(k)] * col_[at(i)]); });
      break;
    case 1:
      use(i, T(-1));
      break;
    case 2:
      use(i, T(1));
      break;
    default:
      for (Index k = 0; k < n_; ++k) use(k, r_[at(k)]);
  }
}

template <class T> bool NormalPath<T>::factorize() {
  return basis_.factorize([this](Index k, const auto& add) { column(code_[at(k)], add); });
}

// One variable of each row by side_, free ones first: dependent ones are then found among the others. Dependent z go
// to their bound; false when a free one is among them.
template <class T> bool NormalPath<T>::choose_basis() {
  for (;;) {
    std::size_t place = 0;
    for (int kind = 0; kind < 2; ++kind)
      for (Index i = 0; i < n_; ++i) {
        const bool free = lo_[at(i)] == -kInf && hi_[at(i)] == kInf;
        if (free != (kind == 0)) continue;
        const Index offset = side_[at(i)] == Side::lower ? n_ : side_[at(i)] == Side::upper ? 2 * n_ : 0;
        code_[place++] = static_cast<int>(i + offset);
      }
    if (factorize()) return true;
    if (basis_.missing().empty()) return false;
    for (const auto& [position, row] : basis_.missing()) {
      const int code = code_[at(position)];
      const std::size_t i = at(index_of(code));
      if (kind_of(code) != 0 || (lo_[i] == -kInf && hi_[i] == kInf)) return false;
      side_[i] = a_[static_cast<Index>(i)] - lo_[i] <= hi_[i] - a_[static_cast<Index>(i)] ? Side::lower : Side::upper;
    }
  }
}

template <class T> bool NormalPath<T>::start(const Vector& x) {
  for (Index i = 0; i < n_; ++i) {
    const std::size_t k = at(i);
    const double z = std::clamp(x[i], static_cast<double>(lo_[k] * col_[k]), static_cast<double>(hi_[k] * col_[k]));
    side_[k] = x[i] < z || (x[i] == z && lo_[k] * col_[k] == x[i])   ? Side::lower
               : x[i] > z || (x[i] == z && hi_[k] * col_[k] == x[i]) ? Side::upper
                                                                     : Side::inside;
    a_[i] = static_cast<T>(z) / col_[k];
    d_[i] = abs(static_cast<T>(x[i]) - static_cast<T>(z)) * row_[k];  // w or v
  }
  if (!choose_basis()) return false;
  std::fill(right_.begin(), right_.end(), T(0));
  for (Index i = 0; i < n_; ++i) {
    const std::size_t k = at(i);
    const T z = side_[k] == Side::inside ? a_[i] : bound(i);
    if (z != 0) column(static_cast<int>(i), [&](Index row, T value) { right_[at(row)] += value * z; });
    if (side_[k] == Side::lower) right_[k] -= d_[i];
    if (side_[k] == Side::upper) right_[k] += d_[i];
    rhs_[i] = z;
  }
  for (std::size_t k = 0; k < at(n_); ++k) r_[k] = right_[k] + q_[k];
  for (Index k = 0; k < n_; ++k) {
    const int code = code_[at(k)];
    correction_[k] = kind_of(code) == 0 ? rhs_[code] : d_[index_of(code)];
  }
  a_ = correction_;
  error_ = kEps<T> * a_.cwiseAbs();
  perturb();
  return true;
}

template <class T> bool NormalPath<T>::start_on_ray(const Vector& cover) {
  for (Index i = 0; i < n_; ++i) {
    const std::size_t k = at(i);
    side_[k] = lo_[k] != -kInf ? Side::lower : hi_[k] != kInf ? Side::upper : Side::inside;
    a_[i] = 0;
  }
  if (!choose_basis()) return false;
  for (std::size_t k = 0; k < at(n_); ++k) right_[k] = -q_[k], r_[k] = 0;
  std::fill(tilted_right_.begin(), tilted_right_.end(), T(0));
  if (!recompute(false)) return false;
  const auto d = [&](Index i) { return cover.size() > i ? static_cast<T>(cover[i]) : T(1); };
  T z0 = 0;
  for (Index k = 0; k < n_; ++k)
    if (kind_of(code_[at(k)]) != 0) z0 = std::max(z0, -a_[k] / d(index_of(code_[at(k)])));
  for (Index k = 0; k < n_; ++k) {
    const int code = code_[at(k)], i = index_of(code);
    if (kind_of(code) == 0) continue;
    a_[k] += d(i) * z0;
    error_[k] += kEps<T> * d(i) * z0;
    r_[at(i)] = kind_of(code) == 1 ? -d(i) * z0 : d(i) * z0;
  }
  for (std::size_t k = 0; k < at(n_); ++k) right_[k] = r_[k] - q_[k];
  perturb();
  return true;
}

// b into the feasible side of each basic value's bounds; free ones have none to tie with.
template <class T> void NormalPath<T>::perturb() {
  std::minstd_rand random(1 + tie_breaker_);
  std::fill(tilted_right_.begin(), tilted_right_.end(), T(0));
  for (Index k = 0; k < n_; ++k) {
    const int code = code_[at(k)];
    const T size = T(1) + static_cast<T>(random() % 65536) / T(65536);
    const bool free = lower(code) == -kInf && upper(code) == kInf;
    b_[k] = free ? T(0) : a_[k] - lower(code) <= upper(code) - a_[k] ? size : -size;
    column(code, [&](Index row, T value) { tilted_right_[at(row)] += value * b_[k]; });
  }
  entering_ = t_code();
  sign_ = 1;
}

// The factors and both parts of the basic values again.
template <class T> bool NormalPath<T>::recompute(bool with_t) {
  if (!factorize()) return false;
  a_.setZero();
  for (int round = 0; round < 3; ++round) refine_values(with_t);
  for (Index k = 0; k < n_; ++k) b_[k] = tilted_right_[at(k)];
  basis_.solve(b_);
  return a_.allFinite();
}

// long_ ← long_ − value · column.
template <class T> void NormalPath<T>::subtract(int code, T value) {
  if (value == T(0)) return;
  column(code, [&](Index row, T entry) { long_[at(row)] -= static_cast<Sum>(entry) * value; });
}

// values ← values + B⁻¹ (long_ − B values): the correction tells how wrong they were.
template <class T> void NormalPath<T>::refine(Values& values) {
  for (Index k = 0; k < n_; ++k) subtract(code_[at(k)], values[k]);
  for (Index k = 0; k < n_; ++k) correction_[k] = static_cast<T>(long_[at(k)]);
  basis_.solve(correction_);
  values += correction_;
}

template <class T> void NormalPath<T>::refine_values(bool with_t) {
  for (std::size_t k = 0; k < at(n_); ++k) long_[k] = with_t ? right_[k] : -q_[k];
  for (Index i = 0; i < n_; ++i)
    if (side_[at(i)] != Side::inside) subtract(static_cast<int>(i), bound(i));
  refine(a_);
  error_ = kEps<T> * a_.cwiseAbs() + correction_.cwiseAbs();
}

// The entering column in terms of the basis.
template <class T> bool NormalPath<T>::solve_entering() {
  std::fill(long_.begin(), long_.end(), Sum(0));
  d_.setZero();
  column(entering_, [this](Index row, T value) { d_[row] += value, long_[at(row)] += value; });
  basis_.solve(d_);
  refine(d_);
  for (Index k = 0; k < n_; ++k)
    if (abs(d_[k]) <= kPivotNoise * abs(correction_[k])) d_[k] = 0;
  return d_.allFinite();
}

// Position that blocks, −1: nothing, −2: the entering variable's own range. step + tilt ε: how far it goes.
template <class T> int NormalPath<T>::ratio_test(int entering, T sign, T& step, T& tilt) {
  const T tiny = kPivot<T> * d_.cwiseAbs().maxCoeff();
  T limit = kInf;
  tied_.clear();
  const auto slack = [&](Index k, T slope) {  // toward the bound it moves to
    const int code = code_[at(k)];
    return slope > 0 ? a_[k] - lower(code) : upper(code) - a_[k];
  };
  for (Index k = 0; k < n_; ++k) {
    const T slope = sign * d_[k];
    if (!(abs(slope) > tiny)) continue;
    const T room = slack(k, slope);
    if (room == T(kInf)) continue;
    limit = std::min(limit, (std::max(room, T(0)) + kTie * error_[k]) / abs(slope));
    tied_.push_back(static_cast<int>(k));
  }
  const T range = kind_of(entering) == 3 ? T(1) : upper(entering) - lower(entering);
  step = kInf;
  int best = -1;
  for (const int k : tied_) {
    const T slope = sign * d_[k], ratio = std::max(slack(k, slope), T(0)) / abs(slope);
    if (ratio > limit) continue;
    const T lean = b_[k] / slope;
    if (code_[at(k)] == t_code()) {
      best = k, step = ratio, tilt = lean;
      break;
    }
    if (best < 0 || lean < tilt) best = k, step = ratio, tilt = lean;
  }
  if (range < kInf && (best < 0 || range <= step)) {
    step = range, tilt = 0;
    return -2;
  }
  return best;
}

template <class T> typename NormalPath<T>::End NormalPath<T>::follow(int max_pivots,
                                                                     const std::function<bool(double)>& stop,
                                                                     PathPoints* points) {
  if (points != nullptr) {
    points->clear();
    record(*points);
  }
  const auto finished = [&] {
    t_ = 1;
    return recompute(false) ? End::solved : End::singular;
  };
  for (;;) {
    if (pivots_ >= max_pivots) return End::limit;
    if (stop(static_cast<double>(t_))) return End::stopped;
    if (!solve_entering()) return End::singular;
    T step = 0, tilt = 0;
    const int k = ratio_test(entering_, sign_, step, tilt);
    if (k == -1) return End::ray;
    ++pivots_;
    const T blur = k >= 0 ? error_[k] / abs(d_[k]) : T(0);
    error_ += blur * d_.cwiseAbs() + kEps<T> * (a_.cwiseAbs() + step * d_.cwiseAbs());
    a_ -= (sign_ * step) * d_;
    b_ -= (sign_ * tilt) * d_;
    const int i = index_of(entering_);
    if (k == -2) {
      if (entering_ == t_code()) return finished();
      side_[at(i)] = sign_ > 0 ? Side::upper : Side::lower;
      entering_ = static_cast<int>(sign_ > 0 ? 2 * n_ : n_) + i;
      sign_ = 1;
      continue;
    }
    const int leaving = code_[at(k)];
    const bool down = sign_ * d_[k] > 0;
    const T origin = kind_of(entering_) == 0 ? bound(i) : T(0);
    a_[k] = origin + sign_ * step;
    b_[k] = sign_ * tilt;
    error_[k] = blur + kEps<T> * abs(a_[k]);
    code_[at(k)] = entering_;
    if (kind_of(entering_) == 0) side_[at(i)] = Side::inside;
    const int l = index_of(leaving), kind = kind_of(leaving);
    if (kind == 0) side_[at(l)] = down ? Side::lower : Side::upper;
    if (leaving == t_code()) return finished();
    if (basis_.replace(k, d_)) {
      refine_values(true);
    } else if (!recompute(true)) {
      return End::singular;
    }
    for (Index p = 0; p < n_; ++p)
      if (code_[at(p)] == t_code()) t_ = a_[p];
    if (points != nullptr) record(*points);
    entering_ = kind == 0 ? static_cast<int>(down ? n_ : 2 * n_) + l : l;
    sign_ = kind == 2 ? T(-1) : T(1);
  }
}

template <class T> void NormalPath<T>::point(Vector& z, Vector& x) const {
  z.resize(n_), x.resize(n_);
  for (Index i = 0; i < n_; ++i)
    z[i] = side_[at(i)] == Side::inside ? 0.0 : static_cast<double>(bound(i) * col_[at(i)]);
  x = z;
  for (Index k = 0; k < n_; ++k) {
    const int code = code_[at(k)], i = index_of(code);
    const std::size_t s = at(i);
    if (kind_of(code) == 0)
      z[i] = x[i] = static_cast<double>(std::clamp(a_[k], lo_[s], hi_[s]) * col_[s]);
    else if (kind_of(code) == 1)
      x[i] = z[i] - static_cast<double>(std::max(a_[k], T(0)) / row_[s]);
    else if (kind_of(code) == 2)
      x[i] = z[i] + static_cast<double>(std::max(a_[k], T(0)) / row_[s]);
  }
}

template <class T> void NormalPath<T>::direction(Vector& dz) const {
  dz.resize(n_);
  dz.setZero();
  for (Index k = 0; k < n_; ++k)
    if (const int code = code_[at(k)]; kind_of(code) == 0)
      dz[code] = static_cast<double>(-sign_ * d_[k] * col_[at(code)]);
  if (kind_of(entering_) == 0) dz[entering_] = static_cast<double>(sign_ * col_[at(entering_)]);
}

template <class T> void NormalPath<T>::record(PathPoints& points) const {
  const std::size_t n = at(n_), count = points.t.size();
  if ((count + 1) * n > kRoom && count > 2) {  // every second one goes
    for (std::size_t p = 1; 2 * p < count; ++p) {
      points.t[p] = points.t[2 * p];
      std::copy_n(points.x.begin() + static_cast<std::ptrdiff_t>(2 * p * n), n,
                  points.x.begin() + static_cast<std::ptrdiff_t>(p * n));
    }
    points.t.resize((count + 1) / 2);
    points.x.resize(points.t.size() * n);
  }
  Vector z, x;
  point(z, x);
  points.t.push_back(static_cast<double>(t_));
  points.x.insert(points.x.end(), x.data(), x.data() + n_);
}

template class NormalPath<double>;
template class NormalPath<long double>;
template class NormalPath<detail::Float256>;

}  // namespace orthant
