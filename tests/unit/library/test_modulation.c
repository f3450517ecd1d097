/* Modulation: duties that make the requested voltage, limits that keep its angle, and six-step over all 2^24 angles. */
#include "iqfoc/modulation.h"
#include "iqfoc/transform.h"
#include "reference.h"

#include <stdbool.h>

#define DRAWS 400000
#define SEED  UINT64_C(314159)

void setUp(void)
{
}

void tearDown(void)
{
}

static double largest(double a, double b, double c)
{
    return fmax(a, fmax(b, c));
}

static double smallest(double a, double b, double c)
{
    return fmin(a, fmin(b, c));
}

static void test_duties_within_the_hexagon(void)
{
    uint64_t seed = SEED;
    worst duty = {"duty", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        const iqfoc_ab_t u = {random_iq24(&seed, -0.7, 0.7), random_iq24(&seed, -0.7, 0.7)};
        const iq24_t inverse = random_iq24(&seed, 0.7, 2.0);
        const double alpha = to_double(u.alpha) * to_double(inverse);
        const double beta = to_double(u.beta) * to_double(inverse);
        const double a = alpha;
        const double b = -alpha / 2.0 + sqrt(3.0) / 2.0 * beta;
        const double c = -alpha / 2.0 - sqrt(3.0) / 2.0 * beta;
        const double high = largest(a, b, c);
        const double low = smallest(a, b, c);
        if (high - low > 1.0 - 1e-6) {
            continue;
        }
        const iqfoc_duties_t duties = iqfoc_modulate(u, inverse, IQ24_ONE);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE, duties.scale);
        worst_add(&duty, duties.high.a, a + 0.5 - (high + low) / 2.0);
        worst_add(&duty, duties.high.b, b + 0.5 - (high + low) / 2.0);
        worst_add(&duty, duties.high.c, c + 0.5 - (high + low) / 2.0);
    }
    worst_check(&duty, 3.0);
}

static void test_limit_keeps_the_angle(void)
{
    uint64_t seed = SEED + 1;
    worst scale_error = {"scale", 0.0};
    double largest_share = 0.0;
    for (int32_t n = 0; n < DRAWS; n++) {
        const double reach = n % 3 == 0 ? 22.6 : 2.0;
        const iqfoc_ab_t u = {random_iq24(&seed, -reach, reach), random_iq24(&seed, -reach, reach)};
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        const iq24_t span_max = random_iq24(&seed, 0.5, 1.0);
        const double alpha = to_double(u.alpha) * to_double(inverse);
        const double beta = to_double(u.beta) * to_double(inverse);
        const double b = -alpha / 2.0 + sqrt(3.0) / 2.0 * beta;
        const double c = -alpha / 2.0 - sqrt(3.0) / 2.0 * beta;
        const double high = largest(alpha, b, c);
        const double low = smallest(alpha, b, c);
        const double want = to_double(span_max) / (high - low);
        const iqfoc_duties_t d = iqfoc_modulate(u, inverse, span_max);
        if (want >= 1.0 - 1e-6) {
            continue;
        }
        TEST_ASSERT_TRUE(d.scale < IQ24_ONE);
        worst_add(&scale_error, d.scale, want);
        /* What the legs make, leg to leg, is the voltage asked for times one factor: its angle is kept. */
        const double shift = 0.5 - want * (high + low) / 2.0;
        worst duty = {"", 0.0};
        worst_add(&duty, d.high.a, want * alpha + shift);
        worst_add(&duty, d.high.b, want * b + shift);
        worst_add(&duty, d.high.c, want * c + shift);
        const double share = duty.lsb / (4.0 + 1.5 * hypot(alpha, beta));
        largest_share = share > largest_share ? share : largest_share;
    }
    worst_check(&scale_error, 7.0);
    printf("  duty, shortened: %.2f of the stated bound\n", largest_share);
    TEST_ASSERT_TRUE(largest_share <= 1.0 && largest_share > 0.5);
}

/* Everywhere within the stated range, at its ends and around the hexagon's border: legs in [0, 1], span
 * within its limit. */
static void test_duties_in_range(void)
{
    uint64_t seed = SEED + 2;
    const iq24_t inverses[] = {1, IQ24(0.5), IQ24_ONE, IQ24(2.0)};
    const iq24_t spans[] = {1, 2, IQ24(0.5), IQ24_ONE - 1, IQ24_ONE};
    for (int32_t n = 0; n < 2000000; n++) {
        const double angle = TWO_PI * (double)(n % 997) / 997.0;
        const double border = 1.0 / sqrt(3.0) / to_double(inverses[n % 4]);
        const double near = border * (1.0 + 1e-6 * (double)(n % 13 - 6));
        const double far = to_double(random_iq24(&seed, 0.0, 32.0));
        const double length = n % 3 == 0 ? fmin(near, 32.0) : n % 3 == 1 ? 32.0 : far;
        const iqfoc_ab_t u = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
        const iq24_t span_max = spans[n / 4 % 5];
        const iqfoc_duties_t d = iqfoc_modulate(u, inverses[n % 4], span_max);
        const iq24_t high = iq24_max(iq24_max(d.high.a, d.high.b), d.high.c);
        const iq24_t low = iq24_min(iq24_min(d.high.a, d.high.b), d.high.c);
        if (low < 0 || high > IQ24_ONE || high - low > span_max || d.scale < 0 || d.scale > IQ24_ONE) {
            TEST_FAIL_MESSAGE("a duty, the span or the scale out of its range");
        }
    }
}

static void test_six_step_every_angle(void)
{
    for (int32_t angle = 0; angle < IQ24_ONE; angle += IQFOC_TEST_STRIDE) {
        /* Nearest in sixths: |6 angle - k turn| <= half a turn, a tie to the higher. */
        const int64_t six = 6 * (int64_t)angle;
        const int32_t state = iqfoc_six_step_state(angle);
        const int64_t off = six - (int64_t)state * IQ24_ONE;
        const bool nearest = (off >= -IQ24_ONE / 2 && off < IQ24_ONE / 2) ||
                             (state == 0 && off - 6 * (int64_t)IQ24_ONE >= -IQ24_ONE / 2);
        TEST_ASSERT_TRUE(nearest);
        /* The next state is nearest after `remaining` and not one LSB before. */
        const iq24_t forward = iqfoc_six_step_remaining(angle, 1);
        TEST_ASSERT_TRUE(forward > 0 && forward <= IQ24_ONE / 6 + 1);
        if (iqfoc_six_step_state(angle + forward) != (state + 1) % 6 ||
            iqfoc_six_step_state(angle + forward - 1) != state) {
            TEST_FAIL_MESSAGE("remaining angle, forward");
        }
        const iq24_t back = iqfoc_six_step_remaining(angle, -1);
        if (iqfoc_six_step_state(angle - back) != (state + 5) % 6 ||
            iqfoc_six_step_state(angle - back + 1) != state) {
            TEST_FAIL_MESSAGE("remaining angle, backward");
        }
    }
}

static void test_six_step_vectors(void)
{
    worst voltage = {"six-step voltage", 0.0};
    for (int32_t state = 0; state < 6; state++) {
        const iqfoc_duties_t legs = iqfoc_six_step_duties(state);
        const iqfoc_ab_t of_legs = iqfoc_clarke3(legs.high);
        const double angle = TWO_PI * state / 6.0;
        for (int32_t k = 1; k <= 1000; k++) {
            const iq24_t u_dc = k * (IQ24_ONE / 16) + k;
            const iqfoc_ab_t u = iqfoc_six_step_voltage(state, u_dc);
            worst_add(&voltage, u.alpha, 2.0 / 3.0 * cos(angle) * to_double(u_dc));
            worst_add(&voltage, u.beta, 2.0 / 3.0 * sin(angle) * to_double(u_dc));
        }
        TEST_ASSERT_INT32_WITHIN(1, to_iq24(2.0 / 3.0 * cos(angle)), of_legs.alpha);
        TEST_ASSERT_INT32_WITHIN(1, to_iq24(2.0 / 3.0 * sin(angle)), of_legs.beta);
        TEST_ASSERT_EQUAL_INT32(IQ24_ONE, legs.scale);
    }
    worst_check(&voltage, 0.7);
    const iqfoc_duties_t none = iqfoc_six_step_duties(6);
    TEST_ASSERT_EQUAL_INT32(0, none.high.a | none.high.b | none.high.c);
    const iqfoc_ab_t no_voltage = iqfoc_six_step_voltage(-1, IQ24_ONE);
    TEST_ASSERT_EQUAL_INT32(0, no_voltage.alpha | no_voltage.beta);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_duties_within_the_hexagon);
    RUN_TEST(test_limit_keeps_the_angle);
    RUN_TEST(test_duties_in_range);
    RUN_TEST(test_six_step_every_angle);
    RUN_TEST(test_six_step_vectors);
    return UNITY_END();
}
