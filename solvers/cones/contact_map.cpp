#include <orthant/solvers/cones/contact_map.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace orthant {
namespace {

using cones::Block, cones::Blocks, cones::Part;

/// Scratch of one block, as large as the largest seen.
double* map_scratch(std::size_t count) {
  static thread_local std::vector<double> numbers;
  if (numbers.size() < count) numbers.resize(count);
  return numbers.data();
}

double map_length(const double* t, int rows) { return rows == 1 ? std::abs(t[0]) : std::hypot(t[0], t[1]); }

bool natural_map(const Blocks& blocks, const Block& b, const double* z, const double* w, double rho, double* F,
                 double* E, double* H) {
  const int m = b.rows;
  double* const x = map_scratch(at(2 * m + m * m));
  double* const P = x + m;
  double* const D = P + m;
  blocks.correct(b, w, x);
  for (int r = 0; r < m; ++r) x[r] = z[r] - rho * x[r];
  blocks.project(b, x, P, D);
  bool open = true;
  for (int k = 0; k < m * m; ++k) open = open && D[k] == 0;
  for (int r = 0; r < m; ++r) F[r] = z[r] - P[r];
  // H = ρ D G, G = I + e_n Σ μ ŵ_Tᵀ
  for (int c = 0; c < m; ++c)
    for (int r = 0; r < m; ++r) H[r + m * c] = rho * D[r + m * c], E[r + m * c] = (r == c ? 1.0 : 0.0) - D[r + m * c];
  for (const Part& p : blocks.parts(b)) {
    const double s = map_length(w + p.place, p.rows);
    if (!(s > 0)) continue;
    for (int c = p.place; c < p.place + p.rows; ++c)
      for (int r = 0; r < m; ++r) H[r + m * c] += rho * D[r] * (p.mu * w[c] / s);
  }
  return open;
}

bool alart_curnier_map(const Blocks& blocks, const Block& b, const double* z, const double* w, double rho_n,
                       double rho_t, bool jean_moreau, double* F, double* E, double* H) {
  const int m = b.rows;
  std::fill(E, E + m * m, 0.0), std::fill(H, H + m * m, 0.0);
  const double x_n = z[0] - rho_n * w[0], p_n = std::clamp(x_n, b.lo, b.hi);
  const bool clamped = x_n <= b.lo || x_n >= b.hi;
  F[0] = z[0] - p_n;
  if (clamped)
    E[0] = 1;
  else
    H[0] = rho_n;
  const double pressure = std::max(jean_moreau ? z[0] : p_n, 0.0);
  bool open = clamped;
  for (const Part& p : blocks.parts(b)) {
    const double radius = p.mu * pressure;
    std::array<double, 2> x{};
    for (int r = 0; r < p.rows; ++r) x[at(r)] = z[p.place + r] - rho_t * w[p.place + r];
    const double s = map_length(x.data(), p.rows);
    for (int r = 0; r < p.rows; ++r) {
      const int i = p.place + r;
      if (s <= radius && radius > 0) {
        F[i] = rho_t * w[i], H[i + m * i] = rho_t, open = false;
        continue;
      }
      const double direction = s > 0 ? x[at(r)] / s : 0;
      F[i] = z[i] - radius * direction;
      E[i + m * i] += 1;
      if (!(radius > 0)) {
        // d radius is one-sided at 0; with a pressure that may rise it counts
      } else {
        for (int c = 0; c < p.rows; ++c) {
          const double k = radius / s * ((r == c ? 1.0 : 0.0) - direction * x[at(c)] / s);
          E[i + m * (p.place + c)] -= k, H[i + m * (p.place + c)] += rho_t * k;
        }
      }
      if (jean_moreau ? z[0] > 0 : !clamped) {
        E[i] -= p.mu * direction;
        if (!jean_moreau) H[i] += p.mu * direction * rho_n;
        open = false;
      }
    }
  }
  return open;
}

/// Scalar Fischer-Burmeister of x ≥ 0 ⊥ y ≥ 0.
double scalar_map(double x, double y, double& dx, double& dy) {
  const double root = std::hypot(x, y);
  dx = root > 0 ? 1 - x / root : 1 - std::sqrt(0.5), dy = root > 0 ? 1 - y / root : 1 - std::sqrt(0.5);
  return x + y - root;
}

bool fischer_burmeister_map(const Block& b, const double* z, const double* w, double mu, double* F, double* E,
                            double* H) {
  const int m = b.rows, t = m - 1;
  std::fill(E, E + m * m, 0.0), std::fill(H, H + m * m, 0.0);
  std::array<double, 3> x{}, y{}, v{}, root{};
  const double slip = map_length(w + 1, t);
  x[0] = mu * z[0], y[0] = w[0] / mu + slip;
  for (int r = 1; r < m; ++r) x[at(r)] = z[r], y[at(r)] = w[r];
  double norm = 0;
  for (int r = 0; r < m; ++r) v[0] += x[at(r)] * x[at(r)] + y[at(r)] * y[at(r)];
  for (int r = 1; r < m; ++r) {
    v[at(r)] = 2 * (x[0] * x[at(r)] + y[0] * y[at(r)]);
    norm += v[at(r)] * v[at(r)];
  }
  norm = std::sqrt(norm);
  const double smooth = 1e-24 * v[0] + 1e-300;  // the limits where L_z is singular
  const double high = std::sqrt(v[0] + norm + smooth), low = std::sqrt(std::max(v[0] - norm, 0.0) + smooth);
  root[0] = 0.5 * (high + low);
  for (int r = 1; r < m; ++r) root[at(r)] = norm > 0 ? 0.5 * (high - low) * v[at(r)] / norm : 0;
  for (int r = 0; r < m; ++r) F[r] = x[at(r)] + y[at(r)] - root[at(r)];
  // L⁻¹ of the arrow matrix of (a, s): with δ = a² − ‖s‖²: (a c − s·d, −s (a c − s·d)/a·… ) solved column by column
  const double a = root[0], delta = high * low;
  const auto solve = [&](const std::array<double, 3>& rhs) {
    std::array<double, 3> out{};
    double sd = 0;
    for (int r = 1; r < m; ++r) sd += root[at(r)] * rhs[at(r)];
    out[0] = (a * rhs[0] - sd) / delta;
    for (int r = 1; r < m; ++r) out[at(r)] = (rhs[at(r)] - root[at(r)] * out[0]) / a;
    return out;
  };
  for (int c = 0; c < m; ++c) {
    std::array<double, 3> column_x{}, column_y{};  // L_x e_c, L_y e_c
    if (c == 0) {
      column_x = x, column_y = y;
    } else {
      column_x[0] = x[at(c)], column_x[at(c)] = x[0], column_y[0] = y[at(c)], column_y[at(c)] = y[0];
    }
    const auto sx = solve(column_x), sy = solve(column_y);
    for (int r = 0; r < m; ++r) {
      const double identity = r == c ? 1.0 : 0.0;
      E[r + m * c] = (identity - sx[at(r)]) * (c == 0 ? mu : 1.0);
      H[r + m * c] = identity - sy[at(r)];
    }
  }
  // dy = Y dw, Y = (1/μ, ŵ_Tᵀ; 0, I)
  for (int r = 0; r < m; ++r) {
    const double first = H[r];
    H[r] = first / mu;
    for (int c = 1; c < m; ++c) H[r + m * c] += slip > 0 ? first * w[c] / slip : 0;
  }
  return false;
}

}  // namespace

bool evaluate_map(ContactMap map, const Blocks& blocks, const Block& b, const double* z, const double* w, double rho_n,
                  double rho_t, double* F, double* E, double* H) {
  if (map == ContactMap::natural) return natural_map(blocks, b, z, w, rho_n, F, E, H);
  if (map == ContactMap::fischer_burmeister && b.lo == 0 && b.hi == kInf) {
    if (b.parts == 0) {
      F[0] = scalar_map(z[0], w[0], E[0], H[0]);
      return false;
    }
    const Part& p = blocks.parts(b)[0];
    if (b.parts == 1 && p.mu > 0) return fischer_burmeister_map(b, z, w, p.mu, F, E, H);
  }
  return alart_curnier_map(blocks, b, z, w, rho_n, rho_t, map == ContactMap::jean_moreau, F, E, H);
}

}  // namespace orthant
