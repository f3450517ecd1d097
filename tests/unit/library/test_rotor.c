/*
 * Rotor movement: every argument against the closed forms in double (series where those subtract nearly equal
 * numbers).
 */
#include "bits.h"

#include "iqfoc/rotor.h"

#include <string.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/* (2 sin(p/2) - p cos(p/2))/p^2, by its series where the numerator cancels. */
static double s2_of(double p)
{
    if (fabs(p) > 0.05) {
        return (2.0 * sin(p / 2.0) - p * cos(p / 2.0)) / (p * p);
    }
    return p / 12.0 * (1.0 - p * p / 40.0 * (1.0 - p * p / 112.0));
}

static double s1_of(double p)
{
    return p == 0.0 ? 1.0 : sin(p / 2.0) / (p / 2.0);
}

static void test_every_speed(void)
{
    worst s1 = {"s1, all speeds", 0.0};
    worst s2 = {"s2, all speeds", 0.0};
    worst phi = {"phi, all speeds", 0.0};
    worst phi_s1 = {"phi s1, all speeds", 0.0};
    worst phi_s2 = {"phi s2, all speeds", 0.0};
    worst gain = {"steady gain, all speeds", 0.0};
    for (int32_t x = -IQFOC_ROTOR_SPEED_MAX; x <= IQFOC_ROTOR_SPEED_MAX; x += IQFOC_TEST_STRIDE) {
        const double p = TWO_PI * to_double(x);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(x);
        worst_add(&s1, rotor.s1, s1_of(p));
        worst_add(&s2, rotor.s2, s2_of(p));
        worst_add(&phi, rotor.phi, p);
        worst_add(&phi_s1, rotor.phi_s1, 2.0 * sin(p / 2.0));
        worst_add(&phi_s2, rotor.phi_s2, p * s2_of(p));
        worst_add(&gain, iqfoc_rotor_steady_gain(x), s1_of(p) + 2.0 * tan(p / 2.0) * s2_of(p));
    }
    worst_check(&s1, 0.51);
    worst_check(&s2, 0.51);
    worst_check(&phi, 0.51);
    worst_check(&phi_s1, 0.55);
    worst_check(&phi_s2, 0.6);
    worst_check(&gain, 0.8);
}

static void test_standstill_and_symmetry(void)
{
    const iqfoc_rotor_t still = iqfoc_rotor_from_speed(0);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, still.s1);
    TEST_ASSERT_EQUAL_INT32(0, still.s2);
    TEST_ASSERT_EQUAL_INT32(0, still.phi);
    TEST_ASSERT_EQUAL_INT32(0, still.phi_s1);
    TEST_ASSERT_EQUAL_INT32(0, still.phi_s2);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, iqfoc_rotor_steady_gain(0));
    for (int32_t x = 0; x <= IQFOC_ROTOR_SPEED_MAX; x += 101) {
        const iqfoc_rotor_t forward = iqfoc_rotor_from_speed(x);
        const iqfoc_rotor_t reverse = iqfoc_rotor_from_speed(-x);
        TEST_ASSERT_EQUAL_INT32(forward.s1, reverse.s1);
        TEST_ASSERT_INT32_WITHIN(1, forward.s2, -reverse.s2);
        TEST_ASSERT_INT32_WITHIN(1, forward.phi, -reverse.phi);
        TEST_ASSERT_INT32_WITHIN(1, forward.phi_s1, -reverse.phi_s1);
        TEST_ASSERT_EQUAL_INT32(forward.phi_s2, reverse.phi_s2);
        TEST_ASSERT_EQUAL_INT32(iqfoc_rotor_steady_gain(x), iqfoc_rotor_steady_gain(-x));
    }
}

static void test_faster_than_the_limit_is_the_limit(void)
{
    const iqfoc_rotor_t limit = iqfoc_rotor_from_speed(IQFOC_ROTOR_SPEED_MAX);
    const int32_t beyond[] = {IQFOC_ROTOR_SPEED_MAX + 1, IQ24_ONE, IQ24_MAX};
    for (int32_t k = 0; k < 3; k++) {
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(beyond[k]);
        TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_SPEED_MAX, rotor.speed);
        TEST_ASSERT_EQUAL_INT32(limit.s1, rotor.s1);
        TEST_ASSERT_EQUAL_INT32(limit.s2, rotor.s2);
        TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_SPEED_MAX, iqfoc_rotor_from_speed(-beyond[k]).speed);
    }
    TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_SPEED_MAX, iqfoc_rotor_from_speed(IQ24_MIN).speed);
    TEST_ASSERT_EQUAL_INT32(iqfoc_rotor_steady_gain(IQFOC_ROTOR_SPEED_MAX),
                            iqfoc_rotor_steady_gain(IQ24_MIN));
}

static void test_six_step_gain_is_the_papers(void)
{
    /* 6 sqrt(3)/pi^2 at a sixth of a turn, 2016 (9); the argument is a third of an LSB off a sixth. */
    const double paper = 6.0 * sqrt(3.0) / (TWO_PI * TWO_PI / 4.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, paper, to_double(iqfoc_rotor_steady_gain(IQ24(1.0 / 6.0))));
}

/* ---- To the bit: the polynomials that interpolate at the Chebyshev nodes of v in [0, 1/9] ---- */

enum { MOST_TERMS = 10 };

static double s1_by_v(double v)
{
    return s1_of(TWO_PI * sqrt(v));
}

/* By its series, where nothing cancels: sum of (-1)^n (1/(2 n + 1) - 1) p^(2 n - 2)/(4^n (2 n)!) times 2 pi. */
static double s2_over_x_by_v(double v)
{
    double power = 1.0;
    double sum = 0.0;
    for (int n = 1; n <= 15; n++) {
        power *= -1.0 / (4.0 * (2 * n - 1) * (2 * n));
        sum += (1.0 / (2 * n + 1) - 1.0) * power;
        power *= TWO_PI * TWO_PI * v;
    }
    return TWO_PI * sum;
}

/* Sines rounded from a wider format, so that their last bit is everywhere the same. */
static double gain_by_v(double v)
{
    const double h = TWO_PI / 2.0 * sqrt(v);
    return (double)sinl((long double)h) * (double)tanl((long double)h) / (h * h);
}

/*
 * Coefficients in Q`bits` of the polynomial in w = scale v through the function at the nodes, by Chebyshev's sums.
 * The last decimals of the ten terms of the gain are those of double precision: the operations are those of
 * tools/derive_rotor.py, in its order.
 */
static void interpolated(double (*function)(double), int terms, double scale, int bits, int32_t *coefficient)
{
    const double pi = TWO_PI / 2.0;
    const double v_max = 1.0 / 9.0;
    const double slope = 2.0 / (scale * v_max); /* t = slope w - 1 is -1 ... 1 */
    double result[MOST_TERMS] = {0.0};
    double before[MOST_TERMS] = {1.0};
    double now[MOST_TERMS] = {-1.0, slope};
    for (int j = 0; j < terms; j++) {
        double sum = 0.0;
        for (int k = 0; k < terms; k++) {
            const double node = (double)cosl((long double)(pi * (k + 0.5) / terms));
            sum += function(v_max * (node + 1.0) / 2.0) *
                   (double)cosl((long double)(j * pi * (k + 0.5) / terms));
        }
        const double c = sum * 2.0 / terms;
        double after[MOST_TERMS];
        for (int k = 0; k < MOST_TERMS; k++) {
            result[k] += (j == 0 ? c / 2.0 : c) * before[k];
            after[k] = 2.0 * (-now[k] + (k > 0 ? slope * now[k - 1] : 0.0)) - before[k];
        }
        memcpy(before, now, sizeof before);
        memcpy(now, after, sizeof now);
    }
    for (int k = 0; k < terms; k++) {
        coefficient[k] = (int32_t)lround(ldexp(result[k], bits));
    }
}

/* Horner's rule by high words. */
static int64_t polynomial(const int32_t *coefficient, int terms, int64_t v)
{
    int64_t p = coefficient[terms - 1];
    for (int k = terms - 2; k >= 0; k--) {
        p = coefficient[k] + bits_high(p, v);
    }
    return p;
}

static void test_to_the_bit(void)
{
    int32_t p1[5];
    int32_t p2[5];
    int32_t p3[10];
    interpolated(s1_by_v, 5, 1.0, 30, p1);
    interpolated(s2_over_x_by_v, 5, 1.0, 30, p2);
    interpolated(gain_by_v, 10, 4.0, 27, p3);
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_INT32(p1[k], iqfoc_rotor_poly[k][0]);
        TEST_ASSERT_EQUAL_INT32(p2[k], iqfoc_rotor_poly[k][1]);
    }
    const int64_t two_pi_q28 = llround(ldexp(TWO_PI, 28));
    uint64_t seed = 1;
    for (int n = 0; n < 200000 / IQFOC_TEST_STRIDE; n++) {
        const int64_t x = bits_random(&seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        const int64_t v = bits_high(256 * x, 256 * x);
        const int64_t s1 = polynomial(p1, 5, v);
        const int64_t s2_over_x = polynomial(p2, 5, v);
        const iqfoc_rotor_t got = iqfoc_rotor_from_speed((iq24_t)x);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(s1, 6), got.s1);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(bits_high(256 * x, s2_over_x), 6), got.s2);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(bits_high(256 * x, two_pi_q28), 4), got.phi);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(x * bits_floor(s1 * two_pi_q28, 1 << 30), 28), got.phi_s1);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(bits_high(v, bits_floor(s2_over_x * two_pi_q28, 1 << 30)), 4),
                                got.phi_s2);
        if (IQFOC_TEST_STRIDE == 1) { /* another machine's sine may end in another digit */
            TEST_ASSERT_EQUAL_INT64(bits_nearest(polynomial(p3, 10, 4 * v), 3),
                                    iqfoc_rotor_steady_gain((iq24_t)x));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_to_the_bit);
    RUN_TEST(test_every_speed);
    RUN_TEST(test_standstill_and_symmetry);
    RUN_TEST(test_faster_than_the_limit_is_the_limit);
    RUN_TEST(test_six_step_gain_is_the_papers);
    return UNITY_END();
}
