// Eigenvalues and eigenvectors of a symmetric matrix by Eigen (solve.h).
#include "solve_eigen.hpp"

#include <Eigen/Eigenvalues>

bool solve_symmetric(size_t order, double *a, double *values)
{
    const position n = static_cast<position>(order);
    Eigen::Map<general> given(a, n, n);
    if (order == 0 || order > SOLVE_GENERAL_MOST || !given.allFinite()) {
        return false;
    }
    const Eigen::SelfAdjointEigenSolver<general> solver(given);
    if (solver.info() != Eigen::Success) {
        return false;
    }
    given = solver.eigenvectors();
    for (position i = 0; i < n; i++) {
        values[i] = solver.eigenvalues()(i);
    }
    return true;
}
