/* The functions that use Eigen and KissFFT (base/solve.h, base/fourier.h) against sums written out here. */
#include "base/fourier.h"
#include "base/solve.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/* A fixed sequence between -1 and 1. */
static double draw(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 8388608.0 - 1.0;
}

enum { STRIDE = SOLVE_ORDER_MOST + 3 };

/* B B^T + 1, of well-separated pivots. */
static void positive(size_t n, unsigned seed, double h[SOLVE_ORDER_MOST * STRIDE])
{
    static double b[SOLVE_ORDER_MOST][SOLVE_ORDER_MOST];
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            b[i][j] = draw(&seed);
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            h[i * STRIDE + j] = i == j ? 1.0 : 0.0;
            for (size_t k = 0; k < n; k++) {
                h[i * STRIDE + j] += b[i][k] * b[j][k];
            }
        }
    }
}

static void test_positive_systems_of_every_order(void)
{
    static double h[SOLVE_ORDER_MOST * STRIDE];
    static double inverse[SOLVE_ORDER_MOST * STRIDE];
    for (size_t n = 1; n <= SOLVE_ORDER_MOST; n++) {
        double b[SOLVE_ORDER_MOST];
        double x[SOLVE_ORDER_MOST];
        unsigned seed = (unsigned)n;
        positive(n, seed, h);
        for (size_t i = 0; i < n; i++) {
            b[i] = draw(&seed);
        }
        TEST_ASSERT_TRUE(solve_positive(n, STRIDE, h, b, x));
        TEST_ASSERT_TRUE(solve_inverse(n, STRIDE, h, inverse));
        for (size_t i = 0; i < n; i++) {
            double left = 0.0;
            double by_inverse = 0.0;
            for (size_t j = 0; j < n; j++) {
                left += h[i * STRIDE + j] * x[j];
                by_inverse += inverse[i * STRIDE + j] * b[j];
                TEST_ASSERT_TRUE(inverse[i * STRIDE + j] == inverse[j * STRIDE + i]);
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-11, b[i], left);
            TEST_ASSERT_DOUBLE_WITHIN(1e-11, x[i], by_inverse);
        }
    }
}

/* Inside its edges, and what holds one at an edge is that it would go on: nothing else is a lowest point of a parabola. */
static void lowest(size_t n, const double *h, const double *b, const double *low, const double *high,
                   const double *x)
{
    for (size_t i = 0; i < n; i++) {
        double up = b[i];
        for (size_t j = 0; j < n; j++) {
            up -= h[i * STRIDE + j] * x[j];
        }
        TEST_ASSERT_TRUE(x[i] >= low[i] && x[i] <= high[i]);
        if (x[i] > low[i]) {
            TEST_ASSERT_TRUE(up > -1e-8);
        }
        if (x[i] < high[i]) {
            TEST_ASSERT_TRUE(up < 1e-8);
        }
    }
}

static void test_the_lowest_point_within_edges(void)
{
    static double h[SOLVE_ORDER_MOST * STRIDE];
    size_t at_edges = 0;
    for (unsigned k = 0; k < 2000; k++) {
        const size_t n = 1 + k % 24;
        unsigned seed = 777u + k;
        double b[SOLVE_ORDER_MOST];
        double low[SOLVE_ORDER_MOST];
        double high[SOLVE_ORDER_MOST];
        double x[SOLVE_ORDER_MOST];
        double free_x[SOLVE_ORDER_MOST];
        positive(n, k, h);
        for (size_t i = 0; i < n; i++) {
            b[i] = 10.0 * draw(&seed);
            low[i] = draw(&seed) < -0.5 ? -INFINITY : 0.5 * (draw(&seed) - 1.0);
            high[i] = draw(&seed) < -0.5 ? INFINITY : 0.5 * (draw(&seed) + 1.0);
        }
        TEST_ASSERT_TRUE(solve_within(n, STRIDE, h, b, low, high, x));
        lowest(n, h, b, low, high, x);
        for (size_t i = 0; i < n; i++) {
            at_edges += x[i] == low[i] || x[i] == high[i] ? 1 : 0;
            low[i] = -INFINITY;
            high[i] = INFINITY;
        }
        TEST_ASSERT_TRUE(solve_within(n, STRIDE, h, b, low, high, x));
        TEST_ASSERT_TRUE(solve_positive(n, STRIDE, h, b, free_x));
        TEST_ASSERT_EQUAL_DOUBLE_ARRAY(free_x, x, n);
    }
    TEST_ASSERT_TRUE(at_edges > 5000);
}

static void test_what_is_not_positive_is_refused(void)
{
    double x[2];
    const double b[2] = {1.0, 2.0};
    const double alike[4] = {1.0, 1.0 - 1e-7, 1.0 - 1e-7, 1.0}; /* a pivot of 2e-7 */
    const double apart[4] = {1.0, 1.0 - 1e-6, 1.0 - 1e-6, 1.0}; /* a pivot of 2e-6 */
    const double negative[4] = {1.0, 2.0, 2.0, 1.0};
    const double nothing[4] = {1.0, 0.0, 0.0, 0.0};
    const double none[4] = {1.0, NAN, NAN, 1.0};
    TEST_ASSERT_FALSE(solve_positive(2, 2, alike, b, x));
    TEST_ASSERT_TRUE(solve_positive(2, 2, apart, b, x));
    TEST_ASSERT_FALSE(solve_positive(2, 2, negative, b, x));
    TEST_ASSERT_FALSE(solve_positive(2, 2, nothing, b, x));
    TEST_ASSERT_FALSE(solve_positive(2, 2, none, b, x));
    TEST_ASSERT_TRUE(solve_positive(0, 2, none, b, x));

    double factor[4] = {4.0, -1.0, 2.0, 5.0}; /* the upper half is not looked at */
    TEST_ASSERT_TRUE(solve_factor(2, factor));
    TEST_ASSERT_TRUE(factor[0] == 2.0 && factor[1] == -1.0 && factor[2] == 1.0 && factor[3] == 2.0);
    double indefinite[4] = {1.0, 0.0, 2.0, 1.0};
    TEST_ASSERT_FALSE(solve_factor(2, indefinite));
    double nan_factor[4] = {1.0, 0.0, NAN, 1.0};
    TEST_ASSERT_FALSE(solve_factor(2, nan_factor));
}

static void test_general_systems(void)
{
    for (size_t n = 1; n <= SOLVE_GENERAL_MOST; n++) {
        unsigned seed = (unsigned)n;
        double a[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
        double complex z[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
        double complex both[SOLVE_GENERAL_MOST * 2];
        double complex right[SOLVE_GENERAL_MOST * 2];
        double b[SOLVE_GENERAL_MOST];
        double x[SOLVE_GENERAL_MOST];
        for (size_t k = 0; k < n * n; k++) {
            /* The first row's pivot is nothing: rows have to change places. */
            a[k] = k == 0 && n > 1 ? 0.0 : draw(&seed) + (k % (n + 1) == 0 ? 3.0 : 0.0);
            z[k] = a[k] + I * draw(&seed);
        }
        for (size_t k = 0; k < n; k++) {
            b[k] = x[k] = draw(&seed);
            both[2 * k] = right[2 * k] = b[k] + I;
            both[2 * k + 1] = right[2 * k + 1] = 1.0 - I * b[k];
        }
        TEST_ASSERT_TRUE(solve_linear(n, a, x));
        TEST_ASSERT_TRUE(solve_complex_pair(n, (const double *)z, (double *)both));
        for (size_t i = 0; i < n; i++) {
            double complex left[3] = {0.0};
            for (size_t j = 0; j < n; j++) {
                left[0] += a[i * n + j] * x[j];
                left[1] += z[i * n + j] * both[2 * j];
                left[2] += z[i * n + j] * both[2 * j + 1];
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, cabs(left[0] - b[i]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, cabs(left[1] - right[2 * i]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, cabs(left[2] - right[2 * i + 1]));
        }
    }
    const double singular[4] = {1.0, 2.0, 2.0, 4.0};
    double x[2] = {1.0, 1.0};
    TEST_ASSERT_FALSE(solve_linear(2, singular, x));
    const double complex no_inverse[4] = {1.0, I, I, -1.0};
    double complex both[4] = {1.0, 0.0, 0.0, 1.0};
    TEST_ASSERT_FALSE(solve_complex_pair(2, (const double *)no_inverse, (double *)both));
}

/* a = q h q^T, h is zero below its first subdiagonal, q^T q = 1. */
static void test_the_hessenberg_form(void)
{
    for (size_t n = 1; n <= SOLVE_GENERAL_MOST; n++) {
        unsigned seed = (unsigned)n;
        double a[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
        double h[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
        double q[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
        for (size_t k = 0; k < n * n; k++) {
            a[k] = h[k] = draw(&seed);
        }
        TEST_ASSERT_TRUE(solve_hessenberg(n, h, q));
        for (size_t i = 0; i < n; i++) {
            for (size_t j = 0; j < n; j++) {
                double product = 0.0;
                double unit = i == j ? -1.0 : 0.0;
                for (size_t k = 0; k < n; k++) {
                    unit += q[k * n + i] * q[k * n + j];
                    for (size_t m = 0; m < n; m++) {
                        product += q[i * n + k] * h[k * n + m] * q[j * n + m];
                    }
                }
                TEST_ASSERT_DOUBLE_WITHIN(1e-13, a[i * n + j], product);
                TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.0, unit);
                TEST_ASSERT_TRUE(i <= j + 1 || h[i * n + j] == 0.0);
            }
        }
    }
    double q[1];
    double infinite[1] = {INFINITY};
    TEST_ASSERT_FALSE(solve_hessenberg(1, infinite, q));
}

/* The companion matrix of (x - 2)(x + 3)(x^2 - 2 x + 5). */
static void test_eigenvalues_of_a_known_polynomial(void)
{
    const double a[16] = {1.0, 3.0, -17.0, 30.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const double complex expected[4] = {2.0, -3.0, 1.0 + 2.0 * I, 1.0 - 2.0 * I};
    double re[4];
    double im[4];
    TEST_ASSERT_TRUE(solve_eigenvalues(4, a, re, im));
    for (size_t k = 0; k < 4; k++) {
        double nearest = INFINITY;
        for (size_t j = 0; j < 4; j++) {
            nearest = fmin(nearest, cabs(expected[k] - (re[j] + I * im[j])));
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, nearest);
    }
    /* A cycle of n states: the n-th roots of 1, which an unshifted QR step leaves as they are. */
    for (size_t n = 1; n <= SOLVE_GENERAL_MOST; n++) {
        double cycle[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST] = {0.0};
        double x[SOLVE_GENERAL_MOST];
        double y[SOLVE_GENERAL_MOST];
        for (size_t k = 0; k < n; k++) {
            cycle[(k + 1) % n * n + k] = 1.0;
        }
        TEST_ASSERT_TRUE(solve_eigenvalues(n, cycle, x, y));
        for (size_t k = 0; k < n; k++) {
            const double turns = atan2(y[k], x[k]) / 6.283185307179586 * (double)n;
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, 1.0, hypot(x[k], y[k]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, nearbyint(turns), turns);
            for (size_t j = 0; j < k; j++) {
                TEST_ASSERT_TRUE(hypot(x[k] - x[j], y[k] - y[j]) > 0.3);
            }
        }
    }
    double broken[16];
    memcpy(broken, a, sizeof broken);
    broken[5] = NAN;
    TEST_ASSERT_FALSE(solve_eigenvalues(4, broken, re, im));
}

/* Every length that has factors of its own kind, and from one length to another and back with the same factors. */
/* Two columns alike but for a part in 1e10: refused as a system to solve, and yet a covariance. */
static void test_covariance_of_columns_that_are_nearly_one(void)
{
    const double rest = 1e-10;
    const double h[4] = {1.0, 1.0, 1.0, 1.0 + rest};
    double c[4];
    TEST_ASSERT_FALSE(solve_inverse(2, 2, h, c));
    TEST_ASSERT_TRUE(solve_covariance(2, 2, h, c));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 / rest, 1.0 / rest, c[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 / rest, -1.0 / rest, c[1]);
    TEST_ASSERT_FALSE(solve_covariance(2, 2, (const double[4]){1.0, 2.0, 2.0, 1.0}, c));
}

static void test_symmetric_eigenvectors(void)
{
    static double h[SOLVE_ORDER_MOST * STRIDE];
    double a[SOLVE_GENERAL_MOST * SOLVE_GENERAL_MOST];
    double value[SOLVE_GENERAL_MOST];
    const size_t n = 9;
    positive(n, 5, h);
    for (size_t i = 0; i < n * n; i++) {
        a[i] = h[i / n * STRIDE + i % n];
    }
    TEST_ASSERT_TRUE(solve_symmetric(n, a, value));
    for (size_t d = 0; d < n; d++) {
        TEST_ASSERT_TRUE(d == 0 || value[d] >= value[d - 1]);
        for (size_t i = 0; i < n; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < n; j++) {
                sum += h[i * STRIDE + j] * a[j * n + d];
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * value[n - 1], value[d] * a[i * n + d], sum);
        }
    }
    a[0] = NAN;
    TEST_ASSERT_FALSE(solve_symmetric(n, a, value));
}

static void test_transform_against_its_sum(void)
{
    static const size_t lengths[] = {1, 2, 3, 4, 5, 7, 60, 128, 128, 77, 256, 128};
    fourier *f = fourier_new();
    TEST_ASSERT_NOT_NULL(f);
    for (size_t l = 0; l < sizeof lengths / sizeof lengths[0]; l++) {
        const size_t n = lengths[l];
        unsigned seed = (unsigned)l;
        fourier_number from[256];
        fourier_number to[256];
        for (size_t k = 0; k < n; k++) {
            from[k] = (fourier_number){draw(&seed), draw(&seed)};
        }
        fourier_forward(f, n, from, to);
        for (size_t k = 0; k < n; k++) {
            double complex sum = 0.0;
            for (size_t j = 0; j < n; j++) {
                sum += (from[j].re + I * from[j].im) *
                       cexp(-2.0 * I * 3.14159265358979323846 * (double)(j * k % n) / (double)n);
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * (double)n, 0.0, cabs(sum - (to[k].re + I * to[k].im)));
        }
    }
    fourier_free(f);
    fourier_free(NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_positive_systems_of_every_order);
    RUN_TEST(test_the_lowest_point_within_edges);
    RUN_TEST(test_what_is_not_positive_is_refused);
    RUN_TEST(test_general_systems);
    RUN_TEST(test_the_hessenberg_form);
    RUN_TEST(test_eigenvalues_of_a_known_polynomial);
    RUN_TEST(test_covariance_of_columns_that_are_nearly_one);
    RUN_TEST(test_symmetric_eigenvectors);
    RUN_TEST(test_transform_against_its_sum);
    return UNITY_END();
}
