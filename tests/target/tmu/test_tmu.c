/*
 * The option of port/c2000/iqfoc_tmu.h: the library's sine, cosine and division with models of the TMU that are wrong by as much as the
 * header allows.
 */
#include "iqfoc/iq24_math.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>

#include "iq24_samples.h"
#include "model.h"
#include "unity.h"

#define TAU  6.28318530717958647693
#define SEED 20261126u

void setUp(void)
{
    model_added_lsb = 0.0;
    model_added_part = 0.0;
    fesetround(FE_TONEAREST);
}

void tearDown(void)
{
    fesetround(FE_TONEAREST);
}

static double worst_error(void)
{
    double worst = 0.0;
    for (int32_t angle = 0; angle < IQ24_ONE; angle += IQFOC_TEST_STRIDE) {
        const iq24_sincos_t got = iq24_sincos(angle);
        worst = fmax(worst, fabs((double)got.sin - sin(TAU * angle / IQ24_ONE) * IQ24_ONE));
        worst = fmax(worst, fabs((double)got.cos - cos(TAU * angle / IQ24_ONE) * IQ24_ONE));
    }
    return worst;
}

static void every_angle_is_within_the_bound(void)
{
    const double added[] = {0.0, 1.0, -1.0, 3.0};
    for (int k = 0; k < 4; k++) {
        model_added_lsb = added[k];
        const double worst = worst_error();
        const double e = fabs(model_added_lsb) + 0.5;
        TEST_ASSERT_TRUE(worst <= e + 0.5);
        TEST_ASSERT_TRUE(worst > fabs(model_added_lsb)); /* the sweep sees the error */
    }
}

static void whole_turns_drop_out(void)
{
    iq24_random_t random = {SEED};
    for (int32_t k = 0; k < 100000; k++) {
        const iq24_t turns = iq24_random_any(&random);
        const iq24_sincos_t got = iq24_sincos(turns);
        const iq24_sincos_t same = iq24_sincos(turns & (IQ24_ONE - 1));
        TEST_ASSERT_EQUAL_INT32(same.sin, got.sin);
        TEST_ASSERT_EQUAL_INT32(same.cos, got.cos);
    }
}

static void quarter_turns_are_exact(void)
{
    const iq24_t sine[] = {0, IQ24_ONE, 0, -IQ24_ONE};
    for (int32_t k = 0; k < 4; k++) {
        const iq24_sincos_t got = iq24_sincos(k * (IQ24_ONE / 4));
        TEST_ASSERT_EQUAL_INT32(sine[k], got.sin);
        TEST_ASSERT_EQUAL_INT32(sine[(k + 1) % 4], got.cos);
    }
}

static void a_sine_beyond_one_is_held(void)
{
    model_added_lsb = 8.0;
    TEST_ASSERT_EQUAL_INT32(1 << 30, iq24_sincos_q30_inline(IQ24_ONE / 4).sin);
    TEST_ASSERT_EQUAL_INT32(1 << 30, iq24_sincos_q30_inline(0).cos);
    model_added_lsb = -8.0;
    TEST_ASSERT_EQUAL_INT32(-(1 << 30), iq24_sincos_q30_inline(3 * (IQ24_ONE / 4)).sin);
    TEST_ASSERT_EQUAL_INT32(-(1 << 30), iq24_sincos_q30_inline(IQ24_ONE / 2).cos);
}

/* a / b to nearest, ties away from zero, by a 64-bit division. */
static iq24_t reference_div(iq24_t a, iq24_t b)
{
    const int64_t n = a < 0 ? -(int64_t)a : a;
    const int64_t d = b < 0 ? -(int64_t)b : b;
    const bool negative = (a < 0) != (b < 0);
    if (d == 0) {
        return a == 0 ? 0 : negative ? IQ24_MIN : IQ24_MAX;
    }
    const int64_t quotient = (2 * n * IQ24_ONE + d) / (2 * d);
    return iq24_sat(negative ? -quotient : quotient);
}

/* How many of the quotients differ from the exact ones. */
static int32_t wrong_quotients(int32_t drawn)
{
    int32_t wrong = 0;
    iq24_t extremes[IQ24_EXTREMES];
    const int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            wrong += iq24_div(extremes[i], extremes[j]) != reference_div(extremes[i], extremes[j]);
        }
    }
    iq24_random_t random = {SEED};
    for (int32_t k = 0; k < drawn / IQFOC_TEST_STRIDE; k++) {
        const iq24_t a = iq24_random_magnitude(&random);
        const iq24_t b = iq24_random_magnitude(&random);
        /* Any two, next to the limit of saturation, next to a tie. */
        const iq24_t edge = iq24_sat((int64_t)b * 128 + (int32_t)(iq24_random_bits(&random) % 7) - 3);
        const iq24_t product = iq24_mul_round(a, b);
        wrong += iq24_div(a, b) != reference_div(a, b);
        wrong += iq24_div(edge, b) != reference_div(edge, b);
        wrong += iq24_div(product, b) != reference_div(product, b);
    }
    return wrong;
}

static void quotients_are_exact_in_every_rounding_mode(void)
{
    const int modes[] = {FE_TONEAREST, FE_TOWARDZERO, FE_DOWNWARD, FE_UPWARD};
    const double parts[] = {0.0, 0.99 / 524288.0, -0.99 / 524288.0};
    for (int mode = 0; mode < 4; mode++) {
        for (int k = 0; k < 3; k++) {
            model_added_part = parts[k];
            fesetround(modes[mode]);
            const int32_t wrong = wrong_quotients(300000);
            fesetround(FE_TONEAREST);
            TEST_ASSERT_EQUAL_INT32(0, wrong);
        }
    }
}

static void a_division_beyond_its_error_is_noticed(void)
{
    /* Too small only: one that is too large leaves a rest below 0, which no conversion to an integer holds. */
    model_added_part = -1.0 / 16384.0;
    TEST_ASSERT_GREATER_THAN_INT32(0, wrong_quotients(100000));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_angle_is_within_the_bound);
    RUN_TEST(whole_turns_drop_out);
    RUN_TEST(quarter_turns_are_exact);
    RUN_TEST(a_sine_beyond_one_is_held);
    RUN_TEST(quotients_are_exact_in_every_rounding_mode);
    RUN_TEST(a_division_beyond_its_error_is_noticed);
    return UNITY_END();
}
