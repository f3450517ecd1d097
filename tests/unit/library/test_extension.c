/*
 * The firmware's corrections against the same models in double, at the ends of the stated ranges and beyond, and that
 * each value outside its range is refused.
 */
#include "iqfoc/extension.h"
#include "iqfoc/extension_params.h"
#include "iqfoc/transform.h"
#include "reference.h"

#include <stddef.h>

#define DRAWS 300000
#define SEED  UINT64_C(20191204)

static const iqfoc_extension_t none = IQFOC_EXTENSION_NONE;

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_extension_t drawn(uint64_t *seed)
{
    const iqfoc_extension_t x = {
        {random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0), random_iq24(seed, -1.0, 1.0)},
        {random_iq24(seed, 0.5, 2.0), random_iq24(seed, 0.5, 2.0), random_iq24(seed, 0.5, 2.0)},
        random_iq24(seed, -0.5, 0.5),
        random_iq24(seed, -8.0, 8.0),
        random_iq24(seed, 0.5, 2.0),
        random_iq24(seed, -0.25, 0.25),
        random_iq24(seed, 0.0, 127.0),
        random_iq24(seed, 0.0, 4.0)};
    return x;
}

static iqfoc_abc_t phases(uint64_t *seed, double reach)
{
    const iqfoc_abc_t i = {random_iq24(seed, -reach, reach), random_iq24(seed, -reach, reach),
                           random_iq24(seed, -reach, reach)};
    return i;
}

static double held(double x, double limit)
{
    return fmax(-limit, fmin(limit, x));
}

static double lost(const iqfoc_extension_t *x, double i)
{
    return to_double(x->v_dead) * held(i * to_double(x->knee_inverse), 1.0);
}

static void test_nothing_found_changes_nothing(void)
{
    uint64_t seed = SEED;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_extension_check(&none));
    for (int32_t n = 0; n < 1000; n++) {
        const iqfoc_abc_t i = phases(&seed, 15.0);
        iqfoc_sample_t sample = {.i = i,
                                 .theta = random_iq24(&seed, 0.0, 1.0),
                                 .speed = random_iq24(&seed, -0.3, 0.3),
                                 .u_dc = IQ24(0.9)};
        iqfoc_duties_t duties = {{IQ24(0.2), IQ24(0.9), IQ24(0.5)}, IQ24_ONE};
        const iqfoc_sample_t before = sample;
        const iqfoc_ab_t u = {random_iq24(&seed, -1.0, 1.0), random_iq24(&seed, -1.0, 1.0)};
        const iqfoc_ab_t acting = iqfoc_extension_acting(&none, u, iqfoc_clarke3(i));
        iqfoc_extension_sample(&none, &sample);
        iqfoc_extension_compensate(&none, &duties, i, IQ24(1.1));
        TEST_ASSERT_EQUAL_MEMORY(&before.i, &sample.i, sizeof sample.i);
        TEST_ASSERT_EQUAL_INT32(before.theta, sample.theta);
        TEST_ASSERT_EQUAL_INT32(before.u_dc, sample.u_dc);
        TEST_ASSERT_EQUAL_INT32(u.alpha, acting.alpha);
        TEST_ASSERT_EQUAL_INT32(u.beta, acting.beta);
        TEST_ASSERT_EQUAL_INT32(IQ24(0.2), duties.high.a);
        TEST_ASSERT_EQUAL_INT32(IQ24(0.9), duties.high.b);
        TEST_ASSERT_EQUAL_INT32(IQ24(0.5), duties.high.c);
    }
}

static void test_samples(void)
{
    uint64_t seed = SEED;
    worst current = {"true current", 0.0};
    worst angle = {"true angle", 0.0};
    worst link = {"true DC link", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const iqfoc_extension_t x = drawn(&seed);
        iqfoc_sample_t sample = {.i = phases(&seed, n % 4 == 0 ? 31.0 : 2.0),
                                 .theta = random_iq24(&seed, 0.0, 1.0),
                                 .speed = random_iq24(&seed, -1.0, 1.0),
                                 .u_dc = random_iq24(&seed, 0.5, 1.5)};
        const iqfoc_sample_t before = sample;
        iqfoc_extension_sample(&x, &sample);
        worst_add(&current, sample.i.b,
                  held((to_double(before.i.b) - to_double(x.i_offset.b)) * to_double(x.i_gain_inverse.b),
                       to_double(IQ24(15.9))));
        worst_add(&angle, sample.theta,
                  to_double(before.theta) - to_double(x.theta_0) -
                      to_double(x.theta_delay) * to_double(before.speed));
        worst_add(&link, sample.u_dc, to_double(before.u_dc) * to_double(x.k_u));
    }
    worst_check(&current, 0.5);
    worst_check(&angle, 0.5);
    worst_check(&link, 0.5);
}

static void test_a_mean_is_corrected_only_where_there_is_one(void)
{
    iqfoc_extension_t x = none;
    x.i_offset.a = IQ24(0.25);
    iqfoc_sample_t sample = {.i_mean = {IQ24(1.0), 0, 0}};
    iqfoc_extension_sample(&x, &sample);
    TEST_ASSERT_EQUAL_INT32(IQ24(1.0), sample.i_mean.a);
    sample.has_mean = true;
    iqfoc_extension_sample(&x, &sample);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.75), sample.i_mean.a);
}

static void test_voltages(void)
{
    uint64_t seed = SEED + 1;
    worst leg = {"voltage that a leg loses", 0.0};
    worst acting = {"acting voltage", 0.0};
    worst duty = {"compensated duty", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const iqfoc_extension_t x = drawn(&seed);
        /* Near the knee, where the law is steep, and far from it. */
        const double reach = n % 2 == 0 ? fmin(1.0 / fmax(to_double(x.knee_inverse), 0.02), 40.0) : 40.0;
        const iqfoc_ab_t u = {random_iq24(&seed, -16.0, 16.0), random_iq24(&seed, -16.0, 16.0)};
        const iqfoc_ab_t i = {random_iq24(&seed, -reach, reach), random_iq24(&seed, -reach, reach)};
        const iqfoc_abc_t i_abc = iqfoc_clarke_inverse(i);
        const iqfoc_abc_t got = iqfoc_extension_lost(&x, i_abc);
        const double want[3] = {lost(&x, to_double(i_abc.a)), lost(&x, to_double(i_abc.b)),
                                lost(&x, to_double(i_abc.c))};
        const iqfoc_ab_t acts = iqfoc_extension_acting(&x, u, i);
        worst_add(&leg, got.a, want[0]);
        worst_add(&leg, got.c, want[2]);
        worst_add(&acting, acts.alpha,
                  to_double(x.k_u) * to_double(u.alpha) - (2.0 * want[0] - want[1] - want[2]) / 3.0);
        worst_add(&acting, acts.beta, to_double(x.k_u) * to_double(u.beta) - (want[1] - want[2]) / sqrt(3.0));
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        const iqfoc_duties_t before = {
            {random_iq24(&seed, 0.001, 0.999), random_iq24(&seed, 0.001, 0.999), IQ24(0.5)}, IQ24_ONE};
        iqfoc_duties_t duties = before;
        iqfoc_extension_compensate(&x, &duties, i_abc, inverse);
        worst_add(&duty, duties.high.a,
                  fmax(0.0, fmin(1.0, to_double(before.high.a) + want[0] * to_double(inverse))));
        TEST_ASSERT_TRUE(duties.high.b >= 0 && duties.high.b <= IQ24_ONE);
    }
    worst_check(&leg, 0.63);
    worst_check(&acting, 1.6);
    worst_check(&duty, 1.8);
}

/* Compensation and loss are each other's inverse while no leg is at its end: what is commanded acts. */
static void test_compensated_duties_make_the_commanded_voltage(void)
{
    iqfoc_extension_t x = none;
    x.v_dead = IQ24(0.006);
    x.knee_inverse = IQ24(14.0);
    uint64_t seed = SEED + 2;
    for (int32_t n = 0; n < 10000; n++) {
        const iqfoc_abc_t i =
            iqfoc_clarke_inverse((iqfoc_ab_t){random_iq24(&seed, -1.0, 1.0), random_iq24(&seed, -1.0, 1.0)});
        const iqfoc_ab_t u = {random_iq24(&seed, -0.3, 0.3), random_iq24(&seed, -0.3, 0.3)};
        iqfoc_duties_t duties = iqfoc_modulate(u, IQ24_ONE, IQ24_ONE);
        iqfoc_extension_compensate(&x, &duties, i, IQ24_ONE);
        const iqfoc_abc_t loss = iqfoc_extension_lost(&x, i);
        const iqfoc_abc_t legs = {duties.high.a - loss.a, duties.high.b - loss.b, duties.high.c - loss.c};
        const iqfoc_ab_t acts = iqfoc_clarke3(legs);
        TEST_ASSERT_INT32_WITHIN(8, u.alpha, acts.alpha);
        TEST_ASSERT_INT32_WITHIN(8, u.beta, acts.beta);
    }
}

static void test_a_leg_that_does_not_switch_is_left_alone(void)
{
    iqfoc_extension_t x = none;
    x.v_dead = IQ24(0.1);
    iqfoc_duties_t duties = {{0, IQ24_ONE, IQ24(0.95)}, IQ24_ONE};
    const iqfoc_abc_t i = {IQ24(1.0), IQ24(-1.0), IQ24(1.0)};
    iqfoc_extension_compensate(&x, &duties, i, IQ24_ONE);
    TEST_ASSERT_EQUAL_INT32(0, duties.high.a);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, duties.high.b);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, duties.high.c);
}

static void test_any_current_is_allowed(void)
{
    iqfoc_extension_t x = none;
    x.v_dead = IQ24(-0.25);
    const iqfoc_abc_t ends = {IQ24_MAX, IQ24_MIN, 0};
    const iqfoc_abc_t got = iqfoc_extension_lost(&x, ends);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25), got.a);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.25), got.b);
    TEST_ASSERT_EQUAL_INT32(0, got.c);
}

static void test_saturation_in_the_predictors_coefficients(void)
{
    uint64_t seed = SEED + 3;
    worst k = {"k_u per unit of it", 0.0};
    /* Without current nothing changes. */
    const iqfoc_extension_t any = drawn(&seed);
    const iqfoc_predictor_t given = {IQ24(7.3), IQ24(0.4), IQ24(3.1)};
    const iqfoc_ab_t no_current = {0, 0};
    const iqfoc_predictor_t same = iqfoc_extension_saturate(&any, &given, no_current);
    TEST_ASSERT_EQUAL_INT32(given.k_u, same.k_u);
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const iqfoc_extension_t x = drawn(&seed);
        const iqfoc_predictor_t at_zero = {random_iq24(&seed, 1.0, 8.0), random_iq24(&seed, 0.0, 0.5),
                                           random_iq24(&seed, 0.0, 4.0)};
        const iqfoc_ab_t i = {random_iq24(&seed, -5.0, 5.0), random_iq24(&seed, -5.0, 5.0)};
        const double square = to_double(i.alpha) * to_double(i.alpha) + to_double(i.beta) * to_double(i.beta);
        const double factor = 1.0 + fmin(1.0, to_double(x.saturation) * square);
        const iqfoc_predictor_t p = iqfoc_extension_saturate(&x, &at_zero, i);
        const double off_lsb = fabs((double)p.k_u - to_double(at_zero.k_u) * factor * 16777216.0) - 0.5;
        k.lsb = fmax(k.lsb, off_lsb / to_double(at_zero.k_u));
        TEST_ASSERT_TRUE(p.k_r >= at_zero.k_r && p.k_r <= IQ24_ONE);
        TEST_ASSERT_TRUE(p.k_psi >= at_zero.k_psi && p.k_psi <= IQ24(8.0));
    }
    worst_check(&k, 2.3);
}

static iqfoc_error_t check_with(size_t offset, iq24_t value)
{
    iqfoc_extension_t x = none;
    *(iq24_t *)(void *)((char *)&x + offset) = value;
    return iqfoc_extension_check(&x);
}

static void test_refusals(void)
{
    static const struct {
        size_t offset;
        iq24_t low, high;
        iqfoc_error_t error;
    } range[] = {
        {offsetof(iqfoc_extension_t, i_offset.a), -IQ24_ONE, IQ24_ONE, IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, i_offset.b), -IQ24_ONE, IQ24_ONE, IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, i_offset.c), -IQ24_ONE, IQ24_ONE, IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, i_gain_inverse.a), IQ24(0.5), IQ24(2.0), IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, i_gain_inverse.b), IQ24(0.5), IQ24(2.0), IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, i_gain_inverse.c), IQ24(0.5), IQ24(2.0), IQFOC_ERROR_CURRENT_SENSOR},
        {offsetof(iqfoc_extension_t, theta_0), IQ24(-0.5), IQ24(0.5), IQFOC_ERROR_ANGLE},
        {offsetof(iqfoc_extension_t, theta_delay), IQ24(-8.0), IQ24(8.0), IQFOC_ERROR_ANGLE},
        {offsetof(iqfoc_extension_t, k_u), IQ24(0.5), IQ24(2.0), IQFOC_ERROR_VOLTAGE},
        {offsetof(iqfoc_extension_t, v_dead), IQ24(-0.25), IQ24(0.25), IQFOC_ERROR_VOLTAGE},
        {offsetof(iqfoc_extension_t, knee_inverse), 0, IQ24(127.0), IQFOC_ERROR_VOLTAGE},
        {offsetof(iqfoc_extension_t, saturation), 0, IQ24(4.0), IQFOC_ERROR_SATURATION},
    };
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_extension_check(NULL));
    for (size_t n = 0; n < sizeof range / sizeof range[0]; n++) {
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, check_with(range[n].offset, range[n].low));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, check_with(range[n].offset, range[n].high));
        TEST_ASSERT_EQUAL_INT(range[n].error, check_with(range[n].offset, range[n].low - 1));
        TEST_ASSERT_EQUAL_INT(range[n].error, check_with(range[n].offset, range[n].high + 1));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nothing_found_changes_nothing);
    RUN_TEST(test_samples);
    RUN_TEST(test_a_mean_is_corrected_only_where_there_is_one);
    RUN_TEST(test_voltages);
    RUN_TEST(test_compensated_duties_make_the_commanded_voltage);
    RUN_TEST(test_a_leg_that_does_not_switch_is_left_alone);
    RUN_TEST(test_any_current_is_allowed);
    RUN_TEST(test_saturation_in_the_predictors_coefficients);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
