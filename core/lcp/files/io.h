// core/lcp/files/io.h — problem files: Matrix Market for matrices and vectors, JSON for whole problems.
//
//   JSON problem file (UTF-8, one object):
//     format    "orthant-lcp"          version   1
//     A         {"storage": "dense",    "n": 2, "rows": [[2, 1], [1, 2]]}
//            or {"storage": "sparse",   "n": 2, "start": [0, 1, 2], "column": [0, 1], "value": [2, 2]}       by rows
//            or {"storage": "delassus", "W": {"rows", "cols", "start", "column", "value"},
//                "inverse_mass": […], "regularization": […]}                                A = W M⁻¹ Wᵀ + R
//     b         n numbers              lo, hi    n numbers, "inf" or "-inf"; absent: 0 and ∞, of friction rows −∞ and ∞
//     friction  [{"row": 1, "normal": 0, "mu": 0.3}]; may be absent         note   any text; may be absent
//               a disc of two rows: {"first": 1, "rows": 2, "normal": 0, "mu": 0.3}
//   Numbers are written so that they read back bit for bit.
// Everything wrong throws std::runtime_error, one line: file, field, value, rule.
#pragma once

#include <orthant/core/lcp/problem.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace orthant {

/// Of a problem's file [bytes], unless largest_input() is another (core/support/file.h).
inline constexpr std::uintmax_t kLargestProblem = std::uintmax_t{4} << 30;

/// A square matrix: array format becomes dense, coordinate format sparse storage. real, integer or double; general,
/// symmetric or skew-symmetric. Entries that occur twice are added, as the format's libraries do.
Matrix read_matrix_market(const std::filesystem::path& file);

/// One column (or one row).
Vector read_matrix_market_vector(const std::filesystem::path& file);

void write_matrix_market(const std::filesystem::path& file, const Matrix& A);
void write_matrix_market(const std::filesystem::path& file, const Vector& x);

Lcp read_problem(const std::filesystem::path& file);
Lcp parse_problem(std::string_view json, const std::string& name = "problem");

/// Whole or not at all (core/support/file.h).
void write_problem(const std::filesystem::path& file, const Lcp& problem, std::string_view note = {});
std::string to_json(const Lcp& problem, std::string_view note = {});

}  // namespace orthant
