/* Start: the stages cycle by cycle, the verdict for every travel of a sensor, and the handover. */
#include "iqfoc/start.h"
#include "iqfoc/transform.h"
#include "reference.h"

#include <stddef.h>

static const iqfoc_start_config_t usual = {IQ24(0.5), 200, 100, IQ24(0.02), 1000};

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_stages(void)
{
    iqfoc_start_t s;
    double theta = 0.25;
    double worst_angle = 0.0;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &usual));
    for (int32_t k = 1; k <= 2600; k++) {
        const iq24_t before = iqfoc_start_theta(&s, IQ24_ONE);
        iqfoc_start_step(&s, IQ24(0.1));
        TEST_ASSERT_EQUAL_INT32(before, s.theta); /* the angle goes on from cycle to cycle without a jump */
        const double i = k <= 200 ? 0.5 * k / 200.0 : 0.5;
        TEST_ASSERT_TRUE(fabs(to_double(s.i_ref.d) - i) * 16777216.0 <= 1.0);
        TEST_ASSERT_EQUAL_INT32(0, s.i_ref.q);
        double speed = 0.0;
        speed = k > 300 && k <= 500 ? -0.25 / 200.0 : speed;
        speed = k > 600 && k <= 1600 ? 0.02 * (k - 600) / 1000.0 : speed;
        speed = k > 1600 ? 0.02 : speed;
        TEST_ASSERT_TRUE(fabs(to_double(s.speed) - speed) * 16777216.0 <= 1.5);
        worst_angle = fmax(worst_angle, fabs(to_double(s.theta) - theta) * 16777216.0 / k);
        theta += speed;
        if (k == 501) {
            TEST_ASSERT_EQUAL_INT32(0, s.theta); /* exactly on phase A */
        }
    }
    TEST_ASSERT_TRUE(worst_angle <= 1.0);
    TEST_ASSERT_EQUAL_INT(IQFOC_START_OPEN_LOOP, s.stage);
    s.done = UINT32_MAX;
    iqfoc_start_step(&s, 0);
    TEST_ASSERT_EQUAL_INT(IQFOC_START_OPEN_LOOP, s.stage);
}

static void test_alignment_alone(void)
{
    const iqfoc_start_config_t config = {IQ24(16.0), 1, 1, 0, 0};
    iqfoc_start_t s;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &config));
    for (int32_t k = 0; k < 20; k++) {
        iqfoc_start_step(&s, k < 2 ? IQ24(0.35) : IQ24(0.1));
    }
    TEST_ASSERT_EQUAL_INT(IQFOC_START_ALIGNED, s.stage);
    TEST_ASSERT_EQUAL_INT(IQFOC_START_GOOD, s.verdict);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.1), s.sensor_zero);
    TEST_ASSERT_EQUAL_INT32(IQ24(16.0), s.i_ref.d);
    TEST_ASSERT_EQUAL_INT32(0, s.theta);
    TEST_ASSERT_EQUAL_INT32(0, s.speed);
}

/* Every way of the sensor, whole turns and wraps of the number included. */
static void test_verdicts(void)
{
    const iqfoc_start_config_t config = {IQ24_ONE, 1, 1, 0, 0};
    for (int32_t way = -512; way < 512; way++) {
        for (int32_t whole = -1; whole <= 1; whole++) {
            const iq24_t before = IQ24(0.77) + whole * 100 * IQ24_ONE;
            const iq24_t after =
                iq24_wrap((int64_t)before + way * (IQ24_ONE / 1024) + whole * 100LL * IQ24_ONE);
            iqfoc_start_t s;
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &config));
            for (int32_t k = 0; k < 5; k++) {
                TEST_ASSERT_EQUAL_INT(k < 4 ? IQFOC_START_NOT_YET : s.verdict, s.verdict);
                iqfoc_start_step(&s, k < 2 ? before : after);
            }
            const iqfoc_start_verdict_t want = way >= -320 && way <= -192 ? IQFOC_START_GOOD
                                               : way >= -64 && way <= 64  ? IQFOC_START_STUCK
                                               : way >= 192 && way <= 320 ? IQFOC_START_REVERSED
                                                                          : IQFOC_START_WRONG_WAY;
            TEST_ASSERT_EQUAL_INT(want, s.verdict);
        }
    }
}

static void test_handover(void)
{
    uint64_t seed = UINT64_C(31);
    worst w = {"handover, per unit of the current", 0.0};
    for (int32_t n = 0; n < 200000; n++) {
        iqfoc_start_t s = {.config = &usual, .theta = random_iq24(&seed, -100.0, 100.0)};
        s.i_ref.d = random_iq24(&seed, 0.0, 16.0);
        const iq24_t theta = random_iq24(&seed, -100.0, 100.0);
        const iqfoc_dq_t got = iqfoc_start_handover(&s, theta);
        const double i = to_double(s.i_ref.d);
        const double angle = TWO_PI * (to_double(s.theta) - to_double(theta));
        const double off = fmax(fabs((double)got.d - i * cos(angle) * 16777216.0),
                                fabs((double)got.q - i * sin(angle) * 16777216.0));
        w.lsb = fmax(w.lsb, (off - 0.5) / fmax(i, 1.0));
    }
    worst_check(&w, 0.51);
}

static void refused(iqfoc_start_config_t config, iqfoc_error_t want)
{
    iqfoc_start_t s = {.done = 5};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_start_init(&s, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 5, s.done);
}

static void test_limits(void)
{
    iqfoc_start_t s;
    const iq24_t most = IQFOC_ROTOR_SPEED_MAX;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_start_init(NULL, &usual));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_start_init(&s, NULL));
    refused((iqfoc_start_config_t){1, 1, 1, 0, 0}, IQFOC_OK);
    refused((iqfoc_start_config_t){IQ24(16.0), 1 << 24, 1 << 24, -most, 1 << 24}, IQFOC_OK);
    refused((iqfoc_start_config_t){0, 1, 1, 0, 0}, IQFOC_ERROR_START);
    refused((iqfoc_start_config_t){IQ24(16.0) + 1, 1, 1, 0, 0}, IQFOC_ERROR_START);
    refused((iqfoc_start_config_t){1, 0, 1, 0, 0}, IQFOC_ERROR_START);
    refused((iqfoc_start_config_t){1, 1, (1 << 24) + 1, 0, 0}, IQFOC_ERROR_START);
    refused((iqfoc_start_config_t){1, 1, 1, most + 1, 1}, IQFOC_ERROR_START);
    refused((iqfoc_start_config_t){1, 1, 1, 1, 0}, IQFOC_ERROR_START);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stages);
    RUN_TEST(test_alignment_alone);
    RUN_TEST(test_verdicts);
    RUN_TEST(test_handover);
    RUN_TEST(test_limits);
    return UNITY_END();
}
