// Hessenberg form and eigenvalues of a general matrix, the latter by the real Schur form, without eigenvectors (solve.h).
#include "solve_eigen.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

// Those of the 2x2 block of a Schur form at i, which are a conjugate pair.
static void put_pair(const general &t, position i, double *re, double *im)
{
    const double p = 0.5 * (t(i, i) - t(i + 1, i + 1));
    const double largest = std::fmax(std::fabs(p), std::fmax(std::fabs(t(i + 1, i)), std::fabs(t(i, i + 1))));
    const double lower = t(i + 1, i) / largest;
    const double upper = t(i, i + 1) / largest;
    const double half = p / largest;
    const double z = largest * std::sqrt(std::fabs(half * half + lower * upper));
    re[i] = t(i + 1, i + 1) + p;
    re[i + 1] = re[i];
    im[i] = z;
    im[i + 1] = -z;
}

bool solve_eigenvalues(size_t order, const double *a, double *re, double *im)
{
    const position n = static_cast<position>(order);
    const Eigen::Map<const general> given(a, n, n);
    if (order == 0 || order > SOLVE_GENERAL_MOST || !given.allFinite()) {
        return order == 0;
    }
    const double scale = given.cwiseAbs().maxCoeff();
    if (scale == 0.0) {
        std::fill_n(re, order, 0.0);
        std::fill_n(im, order, 0.0);
        return true;
    }
    const Eigen::HessenbergDecomposition<general> hessenberg(given / scale);
    const general h = hessenberg.matrixH();
    Eigen::RealSchur<general> schur(n);
    schur.computeFromHessenberg(h, h, false); // without vectors: the second is not read
    if (schur.info() != Eigen::Success) {
        return false;
    }
    const general t = schur.matrixT() * scale;
    if (!t.allFinite()) {
        return false;
    }
    for (position i = 0; i < n; i++) {
        if (i + 1 < n && t(i + 1, i) != 0.0) {
            put_pair(t, i, re, im);
            i++;
        } else {
            re[i] = t(i, i);
            im[i] = 0.0;
        }
    }
    return true;
}

bool solve_hessenberg(size_t order, double *a, double *q)
{
    const position n = static_cast<position>(order);
    Eigen::Map<general> given(a, n, n);
    if (order == 0 || order > SOLVE_GENERAL_MOST || !given.allFinite()) {
        return order == 0;
    }
    const Eigen::HessenbergDecomposition<general> hessenberg(given);
    // One reflection after the other: matrixQ() brings the templates of large matrices, which take seconds to compile.
    const general &packed = hessenberg.packedMatrix();
    Eigen::Map<general> out(q, n, n);
    columns<double, SOLVE_GENERAL_MOST> room(n);
    out.setIdentity();
    for (position k = n - 2; k >= 0; k--) {
        const position rest = n - 1 - k;
        out.bottomRightCorner(rest, rest)
            .applyHouseholderOnTheLeft(packed.col(k).tail(rest - 1), hessenberg.householderCoefficients()(k),
                                       room.data());
    }
    given = hessenberg.matrixH();
    return true;
}
