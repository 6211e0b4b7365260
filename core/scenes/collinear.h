// core/scenes/collinear.h — sequential impacts of masses in a row, along one line: exact answer, without a
// complementarity problem.
//
//   The pair that approaches fastest strikes first, by Newton's law:
//     P = (1 + e) (u_i − u_{i+1}) m_i m_{i+1} / (m_i + m_{i+1}),  u_i ← u_i − P / m_i,  u_{i+1} ← u_{i+1} + P / m_{i+1}
//   until none approaches by more than 1e-16 of the first approach. Pairs that approach equally fast and share a mass
//   have no order: the first of the row is taken.
#pragma once

#include <vector>

namespace orthant {

/// `masses` [kg], infinite for a wall; `speeds` [m/s] along the row, as many. Returns the speeds afterwards.
std::vector<double> strike_in_turn(const std::vector<double>& masses, std::vector<double> speeds, double e);

}  // namespace orthant
