/* Tracker and start to the last bit: any allowed input, compared with their headers' formulas in integers. */
#include "bits.h"

#include "iqfoc/start.h"
#include "iqfoc/tracker.h"

#include <stdbool.h>

#define RUNS (600 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static const int64_t turn_q32 = INT64_C(1) << 32;

/* A whole number of turns off: -1/2 ... 1/2. */
static int64_t within_turn(int64_t q32)
{
    return q32 - bits_floor(q32 + turn_q32 / 2, turn_q32) * turn_q32;
}

/* ---- Tracker ---- */

static const int64_t turns_most = (int64_t)IQFOC_ROTOR_TURNS_MAX * 256;

typedef struct tracked {
    int64_t theta, turns, acceleration, error;
    uint32_t missing, seen;
    bool lost;
} tracked;

static int64_t moved(int64_t turns, int64_t at)
{
    return bits_floor(turns * at, IQ24_ONE);
}

static void track(tracked *t, const iqfoc_tracker_config_t *c, int64_t theta, int64_t at, bool valid)
{
    const int64_t measured = within_turn(theta * 256);
    if (valid && t->seen < 2) {
        t->turns = t->seen == 0 ? 0 : bits_held(within_turn(measured - t->theta), -turns_most, turns_most);
        t->theta = within_turn(measured - moved(t->turns, at));
        t->seen++;
        t->missing = 0;
        return;
    }
    t->theta = within_turn(t->theta + t->turns + bits_floor(t->acceleration, 2));
    t->turns = bits_held(t->turns + t->acceleration, -turns_most, turns_most);
    const int64_t e = within_turn(measured - (t->theta + moved(t->turns, at)));
    const int64_t error = bits_floor(e, 256);
    if (!valid || error > c->far_max || error < -c->far_max) {
        t->missing++;
        t->seen = t->seen < 2 ? 0 : t->seen;
        t->lost = t->lost || t->missing > c->lost_max;
        return;
    }
    const int64_t most = INT64_C(1) << 29;
    t->missing = 0;
    t->error = error;
    t->theta = within_turn(t->theta + bits_product(c->k1, e));
    t->turns = bits_held(t->turns + bits_product(c->k2, e), -turns_most, turns_most);
    t->acceleration = bits_held(t->acceleration + bits_product(c->k3, e), -most, most);
}

static void test_tracker(void)
{
    uint64_t seed = 1;
    for (int run = 0; run < RUNS; run++) {
        const iqfoc_tracker_config_t c = {
            bits_random(&seed, 1, IQ24_ONE), bits_random(&seed, 1, run % 2 == 0 ? IQ24_ONE : IQ24_ONE / 16),
            run % 3 == 0 ? 0 : bits_random(&seed, 0, IQ24_ONE / (run % 3 == 1 ? 1 : 64)),
            bits_random(&seed, 1, IQ24_ONE / 2), (uint32_t)bits_random(&seed, 0, 4)};
        iqfoc_tracker_t got;
        tracked want = {0};
        int64_t angle = 0;
        const int32_t speed = bits_random(&seed, -IQ24_ONE / 2, IQ24_ONE / 2) / (run % 4 == 0 ? 1 : 30);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&got, &c));
        for (int n = 0; n < 200; n++) {
            angle += speed;
            const iq24_t theta = run % 5 == 0 ? bits_random(&seed, INT32_MIN, INT32_MAX)
                                              : iq24_wrap(angle + bits_random(&seed, -4000, 4000));
            const iq24_t at = bits_random(&seed, -IQ24_ONE, IQ24_ONE);
            const bool valid = bits_random(&seed, 0, 9) > 0;
            iqfoc_tracker_step(&got, theta, at, valid);
            track(&want, &c, theta, at, valid);
            TEST_ASSERT_EQUAL_INT64(want.theta, got.theta_q32);
            TEST_ASSERT_EQUAL_INT64(want.turns, got.turns_q32);
            TEST_ASSERT_EQUAL_INT64(want.acceleration, got.acceleration_q32);
            TEST_ASSERT_EQUAL_INT64(want.error, got.error);
            TEST_ASSERT_EQUAL_UINT32(want.missing, got.missing);
            TEST_ASSERT_EQUAL(want.lost, got.lost);
        }
        iqfoc_tracker_restart(&got);
        TEST_ASSERT_EQUAL_PTR(&c, got.config);
        TEST_ASSERT_EQUAL_INT64(0, got.theta_q32 | got.turns_q32 | got.acceleration_q32);
        TEST_ASSERT_EQUAL_INT32(0, got.error);
        TEST_ASSERT_EQUAL_UINT32(0, got.missing | got.seen);
        TEST_ASSERT_FALSE(got.lost);
    }
}

/* Missing measurements are counted to the end of the count, and "any number" never is too many. */
static void test_trackers_count_ends(void)
{
    const iqfoc_tracker_config_t c = {1, 1, 0, 1, UINT32_MAX};
    iqfoc_tracker_t t;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&t, &c));
    t.missing = UINT32_MAX - 1;
    for (int n = 0; n < 3; n++) {
        iqfoc_tracker_step(&t, 0, 0, false);
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, t.missing);
        TEST_ASSERT_FALSE(t.lost);
    }
}

/* ---- Start ---- */

/* whole done/all, both to nearest. */
static int64_t part(int64_t whole, int64_t done, int64_t all)
{
    return bits_product(whole, bits_quotient(done, all));
}

static void test_start(void)
{
    uint64_t seed = 2;
    for (int run = 0; run < RUNS; run++) {
        const iqfoc_start_config_t c = {
            bits_random(&seed, 1, 16 * IQ24_ONE), (uint32_t)bits_random(&seed, 1, 40),
            (uint32_t)bits_random(&seed, 1, 20),
            run % 3 == 0 ? 0 : bits_random(&seed, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX),
            (uint32_t)bits_random(&seed, 1, 40)};
        iqfoc_start_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &c));
        int64_t theta = IQ24_ONE / 4;
        int64_t turns = 0;
        const uint32_t aligned = 2 * (c.ramp_cycles + c.hold_cycles);
        iq24_t sensor = 0;
        iq24_t before = 0;
        iq24_t zero = 0;
        for (uint32_t n = 1; n < aligned + c.run_up_cycles + 20; n++) {
            sensor = bits_random(&seed, INT32_MIN, INT32_MAX);
            theta = iq24_wrap(theta + turns);
            iqfoc_start_step(&s, sensor);
            const uint32_t raised = n < c.ramp_cycles ? n : c.ramp_cycles;
            TEST_ASSERT_EQUAL_INT64(part(c.i_align, raised, c.ramp_cycles), s.i_ref.d);
            TEST_ASSERT_EQUAL_INT32(0, s.i_ref.q);
            TEST_ASSERT_EQUAL_INT64(theta, s.theta);
            const uint32_t turning = c.ramp_cycles + c.hold_cycles;
            turns = 0;
            if (n > turning && n <= turning + c.ramp_cycles) {
                const int64_t to = IQ24_ONE / 4 - part(IQ24_ONE / 4, n - turning, c.ramp_cycles);
                turns = to - theta;
            } else if (n > aligned && c.turns_end != 0) {
                const uint32_t run_up = n - aligned < c.run_up_cycles ? n - aligned : c.run_up_cycles;
                turns =
                    n - aligned <= c.run_up_cycles ? part(c.turns_end, run_up, c.run_up_cycles) : c.turns_end;
            }
            TEST_ASSERT_EQUAL_INT64(turns, s.turns);
            before = n > c.ramp_cycles && n <= turning ? sensor : before;
            zero = n > turning + c.ramp_cycles && n <= aligned ? sensor : zero;
            TEST_ASSERT_EQUAL_INT32(before, s.sensor_before);
            TEST_ASSERT_EQUAL_INT32(zero, s.sensor_zero);
            const iqfoc_start_stage_t stage = n < c.ramp_cycles               ? IQFOC_START_RAISE
                                              : n < turning                   ? IQFOC_START_HOLD
                                              : n < turning + c.ramp_cycles   ? IQFOC_START_TURN
                                              : n < aligned                   ? IQFOC_START_SETTLE
                                              : c.turns_end == 0              ? IQFOC_START_ALIGNED
                                              : n < aligned + c.run_up_cycles ? IQFOC_START_RUN_UP
                                                                              : IQFOC_START_OPEN_LOOP;
            TEST_ASSERT_EQUAL_INT(stage, s.stage);
            TEST_ASSERT_EQUAL(n < aligned, s.verdict == IQFOC_START_NOT_YET);
        }
        const iq24_t true_theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        const iq24_sincos_t sc = iq24_sincos(iq24_wrap((int64_t)s.theta - true_theta));
        const iqfoc_dq_t seen = iqfoc_start_handover(&s, true_theta);
        TEST_ASSERT_EQUAL_INT64(bits_product(s.i_ref.d, sc.cos), seen.d);
        TEST_ASSERT_EQUAL_INT64(bits_product(s.i_ref.d, sc.sin), seen.q);
    }
}

/* The verdict by the way between both alignments, to the last number of each range. */
static void test_starts_verdicts(void)
{
    static const iqfoc_start_config_t c = {IQ24_ONE, 1, 1, 0, 0};
    const int64_t quarter = IQ24_ONE / 4;
    const int64_t tolerance = IQ24_ONE / 16;
    const int64_t middle[3] = {-quarter, 0, quarter};
    static const iqfoc_start_verdict_t verdict[3] = {IQFOC_START_GOOD, IQFOC_START_STUCK,
                                                     IQFOC_START_REVERSED};
    for (int k = 0; k < 3; k++) {
        for (int off = -2; off <= 2; off++) {
            const int64_t way = middle[k] +
                                (off < 0   ? -tolerance
                                 : off > 0 ? tolerance
                                           : 0) +
                                (off == -2  ? -1
                                 : off == 2 ? 1
                                            : 0);
            for (int64_t turns = -3; turns <= 3; turns++) {
                const iq24_t before = IQ24(0.4);
                iqfoc_start_t s;
                TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_start_init(&s, &c));
                for (int n = 0; n < 4; n++) {
                    iqfoc_start_step(&s, n < 2 ? before : iq24_wrap(before + way + turns * IQ24_ONE));
                }
                const bool within = off >= -1 && off <= 1;
                TEST_ASSERT_EQUAL_INT(within ? verdict[k] : IQFOC_START_WRONG_WAY, s.verdict);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tracker);
    RUN_TEST(test_trackers_count_ends);
    RUN_TEST(test_start);
    RUN_TEST(test_starts_verdicts);
    return UNITY_END();
}
