// core/support/factorization_cost.h — work of a sparse LU factorization, predicted from the pattern.
//
//   Approximate minimum degree of A + Aᵀ (AMD, SuiteSparse) and the counts that its elimination gives: exact without
//   row exchanges, an estimate with them. Costs a thousandth of the factorization where that is long.
//   Source: Amestoy, Davis & Duff, ACM Trans. Math. Softw. 30 (2004), Algorithm 837.
#pragma once

namespace orthant {

/// [1/s] SparseLU, KLU and Cholesky by rows take 1.7e9 to 4e9 of the predicted operations on a core of 2020.
inline constexpr double kOperationsPerSecond = 2e9;

/// Multiplications, subtractions and divisions for n × n compressed columns (or rows); infinity without memory.
double factorization_cost(int n, const int* start, const int* index);

}  // namespace orthant
