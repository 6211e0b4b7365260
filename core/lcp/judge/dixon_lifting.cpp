#include <orthant/core/lcp/judge/dixon_lifting.h>

#include <cstdint>
#include <numeric>
#include <utility>

namespace orthant::exact {
namespace {

constexpr double kMostWork = 5e8;  // products in one elimination or solution: some seconds

using Word = std::uint64_t;
constexpr Word kPrime = 2147483647;  // 2³¹ − 1

Word power(Word base, Word exponent) {
  Word result = 1;
  for (; exponent > 0; exponent >>= 1, base = base * base % kPrime)
    if ((exponent & 1) != 0) result = result * base % kPrime;
  return result;
}
Word inverse(Word x) { return power(x, kPrime - 2); }
Word remainder(const Integer& x) {
  const auto r = static_cast<std::int64_t>(Integer(x % kPrime));  // of x's sign
  return static_cast<Word>(r < 0 ? r + static_cast<std::int64_t>(kPrime) : r);
}

/// The inverse of a matrix that is regular modulo the prime.
std::vector<std::vector<Word>> inverse(const IntegerTable& A) {
  const std::size_t n = A.size();
  std::vector<std::vector<Word>> m(n, std::vector<Word>(2 * n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) m[i][j] = remainder(A[i][j]);
    m[i][n + i] = 1;
  }
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t r = c;
    while (r < n && m[r][c] == 0) ++r;
    if (r == n) return {};
    std::swap(m[c], m[r]);
    const Word unit = inverse(m[c][c]);
    for (Word& x : m[c]) x = x * unit % kPrime;
    for (r = 0; r < n; ++r) {
      if (r == c || m[r][c] == 0) continue;
      const Word factor = kPrime - m[r][c];
      for (std::size_t k = c; k < 2 * n; ++k) m[r][k] = (m[r][k] + factor * m[c][k]) % kPrime;
    }
  }
  for (auto& row : m) row.erase(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(n));
  return m;
}

/// The fractions with numerators and denominator below √(modulus / 2) that are x modulo `modulus`, if they exist.
std::optional<Ratios> reconstruct(const std::vector<Integer>& x, const Integer& modulus) {
  const Integer bound = sqrt(Integer(modulus / 2));
  Ratios result;
  for (const Integer& each : x) {
    Integer y = each * result.denominator % modulus;
    if (y > modulus - bound) y -= modulus;
    if (abs(y) > bound) {  // Euclid's algorithm, half way
      Integer r0 = modulus, r1 = y < 0 ? Integer(y + modulus) : y, t0 = 0, t1 = 1;
      while (r1 > bound) {
        const Integer q = r0 / r1;
        Integer r = r0 - q * r1, t = t0 - q * t1;
        r0 = std::move(r1), r1 = std::move(r);
        t0 = std::move(t1), t1 = std::move(t);
      }
      if (t1 < 0) r1 = -r1, t1 = -t1;
      if (t1.is_zero() || t1 > bound) return std::nullopt;
      for (Integer& before : result.numerators) before *= t1;
      result.denominator *= t1;
      if (result.denominator > bound) return std::nullopt;
      y = r1;
    }
    result.numerators.push_back(y);
  }
  return result;
}

}  // namespace

ModularPivots find_pivots(const IntegerTable& A, std::size_t columns, const std::function<bool()>& stop) {
  std::vector<std::vector<Word>> m;
  std::vector<std::size_t> place(A.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  for (const auto& row : A) {
    m.emplace_back();
    for (const Integer& x : row) m.back().push_back(remainder(x));
  }
  ModularPivots result;
  double work = 0;
  for (std::size_t c = 0; c < columns && result.rows.size() < m.size(); ++c) {
    const std::size_t rank = result.rows.size();
    std::size_t r = rank;
    while (r < m.size() && m[r][c] == 0) ++r;
    if (r == m.size()) continue;
    std::swap(m[rank], m[r]), std::swap(place[rank], place[r]);
    work += static_cast<double>((m.size() - rank) * (columns - c));
    if (work > 4 * kMostWork || (stop && stop())) return {};
    const Word unit = inverse(m[rank][c]);
    for (r = rank + 1; r < m.size(); ++r) {
      if (m[r][c] == 0) continue;
      const Word factor = kPrime - m[r][c] * unit % kPrime;
      for (std::size_t k = c; k < columns; ++k) m[r][k] = (m[r][k] + factor * m[rank][k]) % kPrime;
    }
    result.rows.push_back(place[rank]), result.columns.push_back(c);
  }
  return result;
}

std::optional<Ratios> solve_exactly(const IntegerTable& M, const std::vector<Integer>& right,
                                    const std::function<bool()>& stop) {
  const std::size_t n = M.size();
  if (static_cast<double>(n) * static_cast<double>(n) * static_cast<double>(n) > kMostWork) return std::nullopt;
  const auto inverse_of = inverse(M);
  if (inverse_of.empty()) return std::nullopt;
  std::vector<Integer> x(n, 0), rest = right;
  std::vector<Word> digit(n), modulo(n);
  // Entries that are small: sums in 64 bits.
  std::vector<std::vector<std::int64_t>> few(n < 4096 ? n : 0);
  for (std::size_t i = 0; i < few.size(); ++i)
    for (const Integer& entry : M[i]) {
      if (abs(entry) >= 1 << 20) {
        few.clear();
        break;
      }
      few[i].push_back(static_cast<std::int64_t>(entry));
    }
  Integer modulus = 1;
  double work = 0;
  for (int lifts = 1, look_at = 8;; ++lifts) {
    for (std::size_t i = 0; i < n; ++i) modulo[i] = remainder(rest[i]);
    for (std::size_t i = 0; i < n; ++i) {
      Word sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum = (sum + inverse_of[i][j] * modulo[j]) % kPrime;
      digit[i] = sum;
      x[i] += modulus * sum;
    }
    modulus *= kPrime;
    for (std::size_t i = 0; i < n; ++i) {
      std::int64_t sum = 0;
      for (std::size_t j = 0; j < n && !few.empty(); ++j) sum += few[i][j] * static_cast<std::int64_t>(digit[j]);
      rest[i] -= sum;
      for (std::size_t j = 0; j < n && few.empty(); ++j)
        if (digit[j] != 0 && !M[i][j].is_zero()) rest[i] -= M[i][j] * digit[j];
      rest[i] /= kPrime;
    }
    work += 2 * static_cast<double>(n * n);
    if (work > kMostWork || (stop && stop())) return std::nullopt;
    if (lifts < look_at) continue;
    look_at *= 2;
    const std::optional<Ratios> found = reconstruct(x, modulus);
    bool solves = found.has_value();
    for (std::size_t i = 0; i < n && solves; ++i) {
      Integer sum = -right[i] * found->denominator;
      for (std::size_t j = 0; j < n; ++j) sum += M[i][j] * found->numerators[j];
      solves = sum.is_zero();
    }
    if (solves) return found;
  }
}

}  // namespace orthant::exact
