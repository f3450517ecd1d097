// Cholesky decompositions of Eigen behind the C interface of solve.h.
#include "solve_eigen.hpp"

#include <Eigen/Cholesky>

#include <cmath>

// Two columns that share all but a millionth of their variance do the same.
static const double SINGULAR = 1e-6;

using symmetric = matrix<double, SOLVE_ORDER_MOST>;
using scales = columns<double, SOLVE_ORDER_MOST>;

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
    symmetric lower = given; // the type of factor(): its templates once
    const Eigen::LLT<Eigen::Ref<symmetric>, Eigen::Lower> cholesky(lower);
    if (cholesky.info() != Eigen::Success) {
        return false;
    }
    given.triangularView<Eigen::Lower>() = lower;
    return given.diagonal().allFinite();
}
