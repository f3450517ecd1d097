// Eigen's types and settings for the files behind solve.h. One file per decomposition: Eigen's templates cost each compilation memory and
// time. All matrices have a largest size, so that none asks for memory.
#ifndef IQFOC_BASE_SOLVE_EIGEN_HPP
#define IQFOC_BASE_SOLVE_EIGEN_HPP

#include "solve.h"

// Sums in the order that is written, the same with SSE, NEON and WebAssembly; at these orders SIMD gains nothing.
#define EIGEN_DONT_VECTORIZE
#define EIGEN_NO_MALLOC
// What Eigen has under a licence other than its own MPL is refused by its headers.
#define EIGEN_MPL2_ONLY
#include <Eigen/Core>

using position = Eigen::Index;
template <typename number, int most>
using matrix = Eigen::Matrix<number, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, most, most>;
template <typename number, int most>
using columns = Eigen::Matrix<number, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;
using general = matrix<double, SOLVE_GENERAL_MOST>;

#endif
