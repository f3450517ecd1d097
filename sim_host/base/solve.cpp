// Eigen behind the C interface of solve.h. All matrices have a largest size, so that none asks for memory.
#include "solve.h"

// Sums in the order that is written, the same with SSE, NEON and WebAssembly; at these orders SIMD gains nothing.
#define EIGEN_DONT_VECTORIZE
#define EIGEN_NO_MALLOC
// What Eigen has under a licence other than its own MPL is refused by its headers.
#define EIGEN_MPL2_ONLY
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>
#include <complex>

// Two columns that share all but a millionth of their variance do the same.
static const double SINGULAR = 1e-6;

using position = Eigen::Index;
template <typename number, int most>
using matrix = Eigen::Matrix<number, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, most, most>;
template <typename number, int most>
using columns = Eigen::Matrix<number, Eigen::Dynamic, 1, Eigen::ColMajor, most, 1>;

using symmetric = matrix<double, SOLVE_ORDER_MOST>;
using scales = columns<double, SOLVE_ORDER_MOST>;
using general = matrix<double, SOLVE_GENERAL_MOST>;
using complex_general = matrix<std::complex<double>, SOLVE_GENERAL_MOST>;
using complex_pair =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 2, Eigen::RowMajor, SOLVE_GENERAL_MOST, 2>;

// Factors h with its diagonal scaled to 1; scale[i] = 1 / sqrt(h_ii).
static bool factor(size_t order, size_t stride, const double *h, double singular, scales &scale, symmetric &a)
{
    const position n = static_cast<position>(order);
    const Eigen::Map<const symmetric, 0, Eigen::OuterStride<>> given(
        h, n, n, Eigen::OuterStride<>(static_cast<position>(stride)));
    scale.resize(n);
    for (position i = 0; i < n; i++) {
        if (!(given(i, i) > 0.0)) {
            return false;
        }
        scale(i) = 1.0 / std::sqrt(given(i, i));
    }
    a.resize(n, n);
    for (position i = 0; i < n; i++) {
        for (position j = 0; j <= i; j++) {
            a(i, j) = given(i, j) * scale(i) * scale(j);
        }
    }
    // In place: the lower half of `a` becomes the factor.
    const Eigen::LLT<Eigen::Ref<symmetric>, Eigen::Lower> cholesky(a);
    if (cholesky.info() != Eigen::Success) {
        return false;
    }
    for (position i = 0; i < n; i++) {
        if (!(a(i, i) * a(i, i) >= singular)) {
            return false;
        }
    }
    return true;
}

bool solve_positive(size_t order, size_t stride, const double *h, const double *b, double *x)
{
    symmetric a;
    scales scale;
    if (order == 0 || order > SOLVE_ORDER_MOST || !factor(order, stride, h, SINGULAR, scale, a)) {
        return order == 0;
    }
    const position n = static_cast<position>(order);
    const Eigen::Map<const scales> right(b, n);
    Eigen::Map<scales> out(x, n);
    scales y = right.cwiseProduct(scale);
    a.triangularView<Eigen::Lower>().solveInPlace(y);
    a.triangularView<Eigen::Lower>().transpose().solveInPlace(y);
    out = y.cwiseProduct(scale);
    return true;
}

static bool inverse_of(size_t order, size_t stride, const double *h, double singular, double *out)
{
    symmetric a;
    scales scale;
    if (order == 0 || order > SOLVE_ORDER_MOST || !factor(order, stride, h, singular, scale, a)) {
        return order == 0;
    }
    const position n = static_cast<position>(order);
    symmetric inverse = symmetric::Identity(n, n);
    a.triangularView<Eigen::Lower>().solveInPlace(inverse);
    for (position i = 0; i < n; i++) {
        for (position j = 0; j <= i; j++) {
            // (L L^T)^-1 from L^-1: the columns below row i.
            const double sum = inverse.col(i).tail(n - i).dot(inverse.col(j).tail(n - i));
            out[static_cast<size_t>(i) * stride + static_cast<size_t>(j)] = sum * scale(i) * scale(j);
            out[static_cast<size_t>(j) * stride + static_cast<size_t>(i)] = sum * scale(i) * scale(j);
        }
    }
    return true;
}

bool solve_inverse(size_t order, size_t stride, const double *h, double *out)
{
    return inverse_of(order, stride, h, SINGULAR, out);
}

bool solve_covariance(size_t order, size_t stride, const double *information, double *out)
{
    return inverse_of(order, stride, information, 0.0, out);
}

bool solve_factor(size_t order, double *a)
{
    const position n = static_cast<position>(order);
    Eigen::Map<general> given(a, n, n);
    if (order > SOLVE_GENERAL_MOST) {
        return false;
    }
    const Eigen::LLT<general, Eigen::Lower> cholesky(given);
    if (cholesky.info() != Eigen::Success) {
        return false;
    }
    given.triangularView<Eigen::Lower>() = cholesky.matrixLLT();
    return given.diagonal().allFinite();
}

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

bool solve_complex_pair(size_t order, const double *a, double *b)
{
    const position n = static_cast<position>(order);
    if (order > SOLVE_GENERAL_MOST) {
        return false;
    }
    // A complex number is laid out as its two parts, in C and in C++.
    const Eigen::Map<const complex_general> given(reinterpret_cast<const std::complex<double> *>(a), n, n);
    Eigen::Map<complex_pair> x(reinterpret_cast<std::complex<double> *>(b), n, 2);
    const Eigen::PartialPivLU<complex_general> lu(given);
    x = lu.solve(x).eval();
    return x.allFinite();
}

bool solve_eigenvalues(size_t order, const double *a, double *re, double *im)
{
    const position n = static_cast<position>(order);
    const Eigen::Map<const general> given(a, n, n);
    if (order > SOLVE_GENERAL_MOST || !given.allFinite()) {
        return false;
    }
    const Eigen::EigenSolver<general> solver(given, false);
    if (solver.info() != Eigen::Success) {
        return false;
    }
    for (position i = 0; i < n; i++) {
        re[i] = solver.eigenvalues()(i).real();
        im[i] = solver.eigenvalues()(i).imag();
    }
    return true;
}

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
