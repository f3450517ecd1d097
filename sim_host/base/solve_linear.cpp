// A general system of equations by Eigen's LU decomposition (solve.h).
#include "solve_eigen.hpp"

#include <Eigen/LU>

bool solve_linear(size_t order, const double *a, double *b)
{
    const position n = static_cast<position>(order);
    if (order > SOLVE_GENERAL_MOST) {
        return false;
    }
    const Eigen::PartialPivLU<general> lu(Eigen::Map<const general>(a, n, n));
    Eigen::Map<columns<double, SOLVE_GENERAL_MOST>> x(b, n);
    x = lu.solve(x).eval();
    return x.allFinite();
}
