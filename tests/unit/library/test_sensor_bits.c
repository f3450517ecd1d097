/*
 * Offsets, encoder and supervision to the last bit: any allowed input, one hash for each over all results.
 * test_offset.c and test_encoder.c check them in double precision, test_supervision.c what supervision sees.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/encoder.h"
#include "iqfoc/offset.h"
#include "iqfoc/supervision.h"

#include <stdbool.h>

#define RUNS 600

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Offset ---- */

static iqfoc_abc_t any_sample(uint64_t *seed, iq24_t place, int32_t spread)
{
    iqfoc_abc_t i;
    i.a = place + bits_random(seed, -spread, spread);
    i.b = place + bits_random(seed, -spread, spread);
    i.c = place + bits_random(seed, -spread, spread);
    return i;
}

static void test_offset(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < RUNS; run++) {
        iqfoc_offset_limits_t limits;
        limits.count_log2 = (uint32_t)bits_random(&seed, 2, 8);
        limits.settle = (uint32_t)bits_random(&seed, 0, 5);
        limits.offset_max = bits_random(&seed, 1, IQ24_ONE / 2);
        limits.noise_max = bits_random(&seed, 1, IQ24_ONE / 64);
        iqfoc_offset_t o;
        memset(&o, 0x5A, sizeof o);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &limits));
        TEST_ASSERT_EQUAL_INT32(0, o.offset.a | o.offset.b | o.offset.c | o.noise.a | o.noise.b | o.noise.c);
        TEST_ASSERT_EQUAL_UINT32(0, o.faulty | o.seen);
        const iq24_t place = bits_random(&seed, -IQ24_ONE / 2, IQ24_ONE / 2);
        const int32_t spread = run % 4 == 0 ? IQ24_ONE / 7 : bits_random(&seed, 0, IQ24_ONE / 40);
        for (int64_t k = -(int64_t)limits.settle; k < INT64_C(1) << limits.count_log2; k++) {
            const iqfoc_abc_t i = any_sample(&seed, place + (k < 0 ? IQ24_ONE : 0), spread);
            TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_BUSY, o.verdict);
            TEST_ASSERT_EQUAL_UINT32(0, o.faulty);
            (void)iqfoc_offset_step(&o, i);
        }
        bits_add(&digest, &o.offset, sizeof o.offset);
        bits_add(&digest, &o.noise, sizeof o.noise);
        digest_add(&digest, (int32_t)o.verdict);
        digest_add(&digest, (int32_t)o.faulty);
        const iqfoc_offset_t before = o;
        TEST_ASSERT_EQUAL_INT(before.verdict, iqfoc_offset_step(&o, (iqfoc_abc_t){IQ24_MAX, 0, IQ24_MIN}));
        TEST_ASSERT_EQUAL_MEMORY(&before, &o, sizeof o);
    }
    bits_golden(UINT64_C(0xa11b7826ebbf5453), digest);
}

/* ---- Encoder ---- */

static void test_encoder(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < 20 * RUNS; run++) {
        const uint32_t counts = (uint32_t)bits_random(&seed, 4, run % 2 == 0 ? 65536 : 40);
        iqfoc_encoder_config_t c;
        c.counts_per_turn = counts;
        c.pole_pairs = (uint32_t)bits_random(&seed, 1, 64);
        c.slip_max = (uint32_t)bits_random(&seed, 0, counts / 4);
        c.index_known = run % 3 == 0;
        c.index_theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        iqfoc_encoder_t e;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&e, &c));
        TEST_ASSERT_EQUAL_INT32(0, iqfoc_encoder_index_theta(&e));
        int64_t index = -1; /* where the index was */
        for (int n = 0; n < 6; n++) {
            const uint32_t count = (uint32_t)bits_random(&seed, 0, (int64_t)counts - 1);
            digest_add(&digest, iqfoc_encoder_theta(&e, count));
            if (n == 2 && run % 5 != 0) {
                iqfoc_encoder_align(&e, count, bits_random(&seed, INT32_MIN, INT32_MAX));
            }
            /* An index pulse anywhere, or about where the last one was. */
            const int64_t near = index < 0 ? 0 : index + bits_random(&seed, -3, 3);
            const uint32_t pulse = n % 2 == 0 ? count : (uint32_t)((near + counts) % counts);
            const bool good = iqfoc_encoder_index(&e, pulse);
            if (index < 0) {
                TEST_ASSERT_TRUE(good);
                TEST_ASSERT_TRUE(e.referenced || !c.index_known);
            } else {
                TEST_ASSERT_EQUAL(good, e.slip <= (int32_t)c.slip_max && e.slip >= -(int32_t)c.slip_max);
            }
            index = index < 0 || !good ? pulse : index;
            TEST_ASSERT_TRUE(e.count_known < counts);
            digest_add(&digest, e.slip);
            digest_add(&digest, (int32_t)e.slips);
            digest_add(&digest, iqfoc_encoder_index_theta(&e));
        }
    }
    bits_golden(UINT64_C(0x196812fef355c492), digest);
}

/* The count of slips stops at its end. */
static void test_encoders_slips_end(void)
{
    const iqfoc_encoder_config_t c = {100, 1, 0, false, 0};
    iqfoc_encoder_t e;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&e, &c));
    (void)iqfoc_encoder_index(&e, 0);
    e.slips = UINT32_MAX - 1;
    for (uint32_t n = 1; n < 4; n++) {
        TEST_ASSERT_FALSE(iqfoc_encoder_index(&e, n));
        TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, e.slips);
    }
}

/* ---- Supervision ---- */

static void add_window(uint64_t *digest, const iqfoc_supervision_t *s)
{
    digest_add(digest, (int32_t)s->status);
    digest_add(digest, (int32_t)s->phase);
    digest_add(digest, (int32_t)s->cycles);
    bits_add64(digest, s->sum_a);
    bits_add64(digest, s->sum_b);
    bits_add64(digest, s->sum_c);
    bits_add64(digest, s->angle);
}

static iq24_t any_current(uint64_t *seed, bool little, int n)
{
    return bits_random(seed, -IQ24_ONE, IQ24_ONE) / (little ? 9 : 1) / (n / 100 % 2 == 1 ? 4 : 1);
}

static void test_supervision(void)
{
    uint64_t seed = 5;
    uint64_t digest = DIGEST_START;
    for (int run = 0; run < RUNS; run++) {
        iqfoc_supervision_config_t c;
        c.i_least = bits_random(&seed, 1, IQ24_ONE / 4);
        c.share = bits_random(&seed, 1, IQ24_ONE / 2);
        c.window_min = (uint32_t)bits_random(&seed, 6, 14);
        c.windows_bad = (uint32_t)bits_random(&seed, 1, 4);
        c.sum_max = bits_random(&seed, 1, IQ24_ONE / 2);
        c.sums_bad = (uint32_t)bits_random(&seed, 1, 4);
        iqfoc_supervision_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &c));
        TEST_ASSERT_TRUE((s.sum_a | s.sum_b | s.sum_c | s.angle) == 0);
        TEST_ASSERT_EQUAL_UINT32(0, s.status | s.phase | s.cycles | s.bad_windows | s.bad_sums);
        double turned = 0.0; /* in this window, and the sum of |i_a| */
        double sum = 0.0;
        for (int n = 0; n < 400; n++) {
            const bool running = bits_random(&seed, 0, 60) > 0;
            const iq24_t speed = (run % 2 == 0 ? 1 : -1) * bits_random(&seed, -IQ24_ONE / 40, IQ24_ONE / 8);
            iqfoc_abc_t i;
            i.a = any_current(&seed, run % 4 == 0, n);
            i.b = any_current(&seed, run % 4 == 1, n);
            i.c = any_current(&seed, run % 4 == 2, n);
            const uint32_t status = iqfoc_supervision_step(&s, i, speed, running);
            TEST_ASSERT_EQUAL_UINT32(status, s.status);
            turned = s.cycles > 0 ? turned + speed : 0.0;
            sum = s.cycles > 0 ? sum + fabs((double)i.a) : 0.0;
            TEST_ASSERT_TRUE((double)s.angle == turned && (double)s.sum_a == sum);
            add_window(&digest, &s);
        }
    }
    bits_golden(UINT64_C(0xd0971347b5c420d5), digest);
}

/* A window ends at half a turn, either way, or beyond it; the count of bad sums ends at its limit. */
static void test_ends_of_supervision(void)
{
    const iqfoc_supervision_config_t c = {IQ24(0.1), IQ24(0.2), 6, 2, IQ24(0.1), 3};
    for (int k = 0; k < 6; k++) {
        const iq24_t last = (k < 3 ? 1 : -1) * (IQ24_ONE / 2 - 7 * IQ24(0.05) + (k % 3 - 1));
        iqfoc_supervision_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &c));
        const iqfoc_abc_t i = {IQ24_ONE, IQ24_ONE, IQ24_ONE};
        for (uint32_t n = 1; n <= 8; n++) {
            (void)iqfoc_supervision_step(&s, i, n == 8 ? last : (k < 3 ? 1 : -1) * IQ24(0.05), true);
            TEST_ASSERT_EQUAL_UINT32(n < 3 ? n : 3, s.bad_sums);
        }
        TEST_ASSERT_EQUAL(k % 3 > 0, s.cycles == 0);
    }
}

/* A window is judged from the least mean current on, to the last number. */
static void test_least_current_of_supervision(void)
{
    const iqfoc_supervision_config_t c = {IQ24(0.1), IQ24(0.2), 6, 1, IQ24_ONE, 3};
    for (iq24_t below = 0; below < 2; below++) {
        const iqfoc_abc_t i = {c.i_least, -c.i_least, 0};
        iqfoc_abc_t last = i;
        last.a -= below;
        last.b += below;
        iqfoc_supervision_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &c));
        for (int n = 1; n <= 10; n++) {
            (void)iqfoc_supervision_step(&s, n == 10 ? last : i, IQ24(0.05) + 1, true);
        }
        TEST_ASSERT_EQUAL_UINT32(0, s.cycles);
        TEST_ASSERT_EQUAL_HEX32(below == 0 ? IQFOC_STATUS_LOST_PHASE : 0, s.status);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_offset);
    RUN_TEST(test_encoder);
    RUN_TEST(test_encoders_slips_end);
    RUN_TEST(test_supervision);
    RUN_TEST(test_ends_of_supervision);
    RUN_TEST(test_least_current_of_supervision);
    return UNITY_END();
}
