/*
 * The cycle's arithmetic in its own formats, against double: sine and cosine in Q30, inverse Park, prediction and
 * mean by them, PI and decoupling in one sum.
 */
#include "iqfoc/current_control.h"
#include "iqfoc/cycle_steps.h"
#include "iqfoc/iq24_sincos.h"
#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"

#include "reference.h"

#include <complex.h>
#include <stdbool.h>
#include <stdlib.h>

#ifndef IQFOC_TEST_STRIDE
#define IQFOC_TEST_STRIDE 1
#endif

static uint64_t state = 20190416;

void setUp(void)
{
}

void tearDown(void)
{
}

static iq24_t within(double limit)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return to_iq24(((double)(state >> 11) / 9007199254740992.0 * 2.0 - 1.0) * limit);
}

static double complex of_ab(iqfoc_ab_t x)
{
    return to_double(x.alpha) + I * to_double(x.beta);
}

static double complex of_dq(iqfoc_dq_t x)
{
    return to_double(x.d) + I * to_double(x.q);
}

/* e^(j theta) as the sine and cosine in Q30 have it. */
static double complex of_q30(iq24_sincos_t q30)
{
    return (double)q30.cos / 1073741824.0 + I * ((double)q30.sin / 1073741824.0);
}

static double larger_part(double complex off)
{
    return fmax(fabs(creal(off)), fabs(cimag(off))) * 16777216.0;
}

/* The bound, and that it is not more than twice what is seen. */
static void expect_close(const char *what, double seen, double bound)
{
    printf("  %-34s %.3f LSB, bound %.3f\n", what, seen, bound);
    TEST_ASSERT_TRUE_MESSAGE(seen <= bound, what);
    TEST_ASSERT_TRUE_MESSAGE(IQFOC_TEST_STRIDE > 1 || 2.0 * seen >= bound, what);
}

static void test_sine_and_cosine(void)
{
    double largest = 0.0;
    for (int32_t k = 0; k < IQ24_ONE; k += IQFOC_TEST_STRIDE) {
        const double complex off = of_q30(iq24_sincos_q30_inline(k)) - cexp(I * TWO_PI * to_double(k));
        largest = fmax(largest, larger_part(off));
    }
    expect_close("sine and cosine in Q30", largest, 0.03);
}

static void test_the_rest(void)
{
    double park = 0.0;
    double prediction = 0.0;
    double mean = 0.0;
    double control = 0.0;
    for (int32_t n = 0; n < 300000 / IQFOC_TEST_STRIDE; n++) {
        const iq24_sincos_t q30 = iq24_sincos_q30_inline(within(0.5));
        const double complex turn = of_q30(q30);
        const iqfoc_dq_t u_dq = {within(45.0), within(45.0)};
        park = fmax(park, larger_part(of_ab(iqfoc_park_inverse_q30(u_dq, q30)) - of_dq(u_dq) * turn));
        const iqfoc_dq_t near_dq = {within(31.9), within(31.9)};
        const iqfoc_ab_t shifted = iqfoc_park_inverse_q30(near_dq, q30);
        const iqfoc_ab_t high = iqfoc_park_inverse_high(near_dq, q30);
        TEST_ASSERT_TRUE(shifted.alpha == high.alpha && shifted.beta == high.beta);
        const iqfoc_methods_t pi = {.control = IQFOC_CONTROL_PI};
        const iqfoc_ab_t volt = {within(11.4), within(11.4)};
        const iq24_t inverse = within(0.76) + IQ24(1.25);
        const iqfoc_ab_t relative = iqfoc_cycle_relative(pi, volt, inverse);
        TEST_ASSERT_EQUAL_INT32(iq24_mul_trunc(volt.alpha, inverse), relative.alpha);
        TEST_ASSERT_EQUAL_INT32(iq24_mul_trunc(volt.beta, inverse), relative.beta);

        const iqfoc_predictor_t p = {within(8.0) + IQ24(8.0), within(0.5) + IQ24(0.5), IQ24(1.0)};
        const iqfoc_ab_t i = {within(21.3), within(21.3)};
        const iqfoc_ab_t u = {within(2.0), within(2.0)};
        const int32_t w_q26 = 4 * within(13.9);
        const double w = (double)w_q26 / 67108864.0;
        const iqfoc_ab_t next = iqfoc_predictor_step_q30(&p, i, u, w_q26, q30);
        const double complex should =
            (1.0 - to_double(p.k_r)) * of_ab(i) + to_double(p.k_u) * of_ab(u) - I * w * turn;
        prediction = fmax(prediction, larger_part(of_ab(next) - should));

        const int32_t s1_q30 = 64 * (within(0.08) + IQ24(0.915));
        const int32_t s2_q30 = 64 * within(0.156);
        const double s1 = (double)s1_q30 / 1073741824.0;
        const double s2 = (double)s2_q30 / 1073741824.0;
        const iqfoc_ab_t end = {within(51.0), within(51.0)};
        const double complex v = s1 * (of_ab(i) + of_ab(end)) / 2.0 - I * s2 * (of_ab(end) - of_ab(i));
        const double complex seen = of_dq(iqfoc_mean_current_seen_q30(i, end, w_q26, s1_q30, s2_q30, q30));
        mean = fmax(mean, larger_part(seen - (v * conj(turn) - w * s2)));

        const iqfoc_current_control_gains_t g = {.kp_d = within(0.3) + IQ24(0.3),
                                                 .kp_q = within(0.3) + IQ24(0.3),
                                                 .x_d = within(2.0) + IQ24(2.0),
                                                 .x_q = within(2.0) + IQ24(2.0),
                                                 .emf = within(4.0) + IQ24(4.0)};
        const iqfoc_dq_t ref = {within(1.0), within(1.0)};
        const iqfoc_dq_t is = {within(1.0), within(1.0)};
        const iq24_t speed = within(1.0 / 3.0);
        iqfoc_current_control_t c = {iq24_acc_mul(within(1.0), IQ24_ONE),
                                     iq24_acc_mul(within(1.0), IQ24_ONE)};
        const double complex integral =
            ldexp((double)c.integral_d, -48) + I * ldexp((double)c.integral_q, -48);
        const double complex e = of_dq(ref) - of_dq(is);
        const double x = to_double(speed);
        const double d = to_double(g.kp_d) * creal(e) - x * to_double(g.x_q) * to_double(is.q);
        const double q =
            to_double(g.kp_q) * cimag(e) + x * (to_double(g.x_d) * to_double(is.d) + to_double(g.emf));
        const iqfoc_dq_t got = iqfoc_current_control_voltage(&c, &g, ref, is, speed);
        control = fmax(control, larger_part(of_dq(got) - integral - d - I * q));
    }
    expect_close("inverse Park", park, 1.0);
    expect_close("prediction", prediction, 2.0);
    expect_close("mean seen from the rotor", mean, 3.2);
    expect_close("PI and decoupling", control, 2.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sine_and_cosine);
    RUN_TEST(test_the_rest);
    return UNITY_END();
}
