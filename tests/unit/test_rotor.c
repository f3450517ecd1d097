/*
 * Rotor movement: every argument against the closed forms in double (series where those subtract nearly equal
 * numbers).
 */
#include "iqfoc/rotor.h"
#include "reference.h"

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
    for (int32_t x = -IQFOC_ROTOR_TURNS_MAX; x <= IQFOC_ROTOR_TURNS_MAX; x += IQFOC_TEST_STRIDE) {
        const double p = TWO_PI * to_double(x);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(x);
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
    const iqfoc_rotor_t still = iqfoc_rotor_from_turns(0);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, still.s1);
    TEST_ASSERT_EQUAL_INT32(0, still.s2);
    TEST_ASSERT_EQUAL_INT32(0, still.phi);
    TEST_ASSERT_EQUAL_INT32(0, still.phi_s1);
    TEST_ASSERT_EQUAL_INT32(0, still.phi_s2);
    TEST_ASSERT_EQUAL_INT32(IQ24_ONE, iqfoc_rotor_steady_gain(0));
    for (int32_t x = 0; x <= IQFOC_ROTOR_TURNS_MAX; x += 101) {
        const iqfoc_rotor_t forward = iqfoc_rotor_from_turns(x);
        const iqfoc_rotor_t reverse = iqfoc_rotor_from_turns(-x);
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
    const iqfoc_rotor_t limit = iqfoc_rotor_from_turns(IQFOC_ROTOR_TURNS_MAX);
    const int32_t beyond[] = {IQFOC_ROTOR_TURNS_MAX + 1, IQ24_ONE, IQ24_MAX};
    for (int32_t k = 0; k < 3; k++) {
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(beyond[k]);
        TEST_ASSERT_EQUAL_INT32(IQFOC_ROTOR_TURNS_MAX, rotor.turns);
        TEST_ASSERT_EQUAL_INT32(limit.s1, rotor.s1);
        TEST_ASSERT_EQUAL_INT32(limit.s2, rotor.s2);
        TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_TURNS_MAX, iqfoc_rotor_from_turns(-beyond[k]).turns);
    }
    TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_TURNS_MAX, iqfoc_rotor_from_turns(IQ24_MIN).turns);
    TEST_ASSERT_EQUAL_INT32(iqfoc_rotor_steady_gain(IQFOC_ROTOR_TURNS_MAX),
                            iqfoc_rotor_steady_gain(IQ24_MIN));
}

static void test_six_step_gain_is_the_papers(void)
{
    /* 6 sqrt(3)/pi^2 at a sixth of a turn, 2016 (9); the argument is a third of an LSB off a sixth. */
    const double paper = 6.0 * sqrt(3.0) / (TWO_PI * TWO_PI / 4.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, paper, to_double(iqfoc_rotor_steady_gain(IQ24(1.0 / 6.0))));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_speed);
    RUN_TEST(test_standstill_and_symmetry);
    RUN_TEST(test_faster_than_the_limit_is_the_limit);
    RUN_TEST(test_six_step_gain_is_the_papers);
    return UNITY_END();
}
