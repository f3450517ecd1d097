/* Offsets, encoder and supervision to the last bit: any allowed input, compared with their headers' formulas. */
#include "bits.h"

#include "iqfoc/encoder.h"
#include "iqfoc/offset.h"
#include "iqfoc/supervision.h"

#include <stdbool.h>

#define RUNS (600 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Offset ---- */

static int64_t whole_root(int64_t x)
{
    int64_t r = (int64_t)sqrt((double)x);
    while (r * r > x) {
        r--;
    }
    while ((r + 1) * (r + 1) <= x) {
        r++;
    }
    return r;
}

static void test_offset(void)
{
    uint64_t seed = 3;
    for (int run = 0; run < RUNS; run++) {
        const uint32_t bits = (uint32_t)bits_random(&seed, 2, 8);
        const iqfoc_offset_limits_t limits = {(uint32_t)bits_random(&seed, 0, 5), bits,
                                              bits_random(&seed, 1, IQ24_ONE / 2),
                                              bits_random(&seed, 1, IQ24_ONE / 64)};
        const int64_t n = INT64_C(1) << bits;
        int64_t sum[3] = {0};
        int64_t squares[3] = {0};
        iq24_t first[3] = {0};
        bool far[3] = {false};
        iqfoc_offset_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_offset_init(&o, &limits));
        const iq24_t place = bits_random(&seed, -IQ24_ONE / 2, IQ24_ONE / 2);
        const int32_t spread = run % 4 == 0 ? IQ24_ONE / 7 : bits_random(&seed, 0, IQ24_ONE / 40);
        for (int64_t k = -(int64_t)limits.settle; k < n; k++) {
            iq24_t i[3];
            for (int x = 0; x < 3; x++) {
                i[x] = place + bits_random(&seed, -spread, spread) + (k < 0 ? IQ24_ONE : 0);
                if (k == 0) {
                    first[x] = i[x];
                }
                if (k >= 0) {
                    const int64_t d = bits_held((int64_t)i[x] - first[x], -IQ24_ONE / 8, IQ24_ONE / 8);
                    far[x] = far[x] || d != (int64_t)i[x] - first[x];
                    sum[x] += d;
                    squares[x] += d * d;
                }
            }
            TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_BUSY, o.verdict);
            TEST_ASSERT_EQUAL_UINT32(0, o.faulty);
            (void)iqfoc_offset_step(&o, (iqfoc_abc_t){i[0], i[1], i[2]});
        }
        const iq24_t got_offset[3] = {o.offset.a, o.offset.b, o.offset.c};
        const iq24_t got_noise[3] = {o.noise.a, o.noise.b, o.noise.c};
        uint32_t shifted = 0;
        uint32_t noisy = 0;
        for (int x = 0; x < 3; x++) {
            const int64_t m = bits_nearest(sum[x], (int)bits);
            const int64_t left = squares[x] - 2 * m * sum[x] + n * m * m;
            const int64_t noise = far[x] ? IQ24_ONE / 8 : whole_root(bits_floor(left, n));
            const int64_t offset = first[x] + m;
            TEST_ASSERT_EQUAL_INT64(offset, got_offset[x]);
            TEST_ASSERT_EQUAL_INT64(noise, got_noise[x]);
            shifted |= (offset < 0 ? -offset : offset) > limits.offset_max ? UINT32_C(1) << x : 0;
            noisy |= noise > limits.noise_max || far[x] ? UINT32_C(1) << x : 0;
        }
        TEST_ASSERT_EQUAL_INT(shifted != 0 ? IQFOC_OFFSET_OUT_OF_RANGE
                              : noisy != 0 ? IQFOC_OFFSET_NOISY
                                           : IQFOC_OFFSET_GOOD,
                              o.verdict);
        TEST_ASSERT_EQUAL_UINT32(shifted != 0 ? shifted : noisy, o.faulty);
        const iqfoc_offset_t before = o;
        TEST_ASSERT_EQUAL_INT(before.verdict, iqfoc_offset_step(&o, (iqfoc_abc_t){IQ24_MAX, 0, IQ24_MIN}));
        TEST_ASSERT_EQUAL_MEMORY(&before, &o, sizeof o);
    }
}

/* ---- Encoder ---- */

static void test_encoder(void)
{
    uint64_t seed = 4;
    for (int run = 0; run < 20 * RUNS; run++) {
        const uint32_t counts = (uint32_t)bits_random(&seed, 4, run % 2 == 0 ? 65536 : 40);
        const iqfoc_encoder_config_t c = {counts, (uint32_t)bits_random(&seed, 1, 64),
                                          (uint32_t)bits_random(&seed, 0, counts / 4), run % 3 == 0,
                                          bits_random(&seed, INT32_MIN, INT32_MAX)};
        const int64_t per_count = (int64_t)c.pole_pairs * (INT64_C(1) << 48) / counts;
        iqfoc_encoder_t e;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&e, &c));
        TEST_ASSERT_EQUAL_INT32(0, iqfoc_encoder_index_theta(&e));
        int64_t known = 0;
        int64_t theta = 0;
        int64_t index = -1;
        uint32_t slips = 0;
        bool referenced = false;
        for (int n = 0; n < 6; n++) {
            const uint32_t count = (uint32_t)bits_random(&seed, 0, (int64_t)counts - 1);
            const int64_t on = count >= known ? count - known : count - known + counts;
            TEST_ASSERT_EQUAL_INT32(iq24_wrap(theta + bits_nearest(on * per_count, 24)),
                                    iqfoc_encoder_theta(&e, count));
            if (n == 2 && run % 5 != 0) {
                known = count;
                theta = bits_random(&seed, INT32_MIN, INT32_MAX);
                referenced = true;
                iqfoc_encoder_align(&e, count, (iq24_t)theta);
            }
            /* An index pulse anywhere, or about where the last one was. */
            const int64_t near = index < 0 ? 0 : index + bits_random(&seed, -3, 3);
            const uint32_t pulse = n % 2 == 0 ? count : (uint32_t)((near + counts) % counts);
            const bool good = iqfoc_encoder_index(&e, pulse);
            if (index < 0) {
                index = pulse;
                known = c.index_known ? pulse : known;
                theta = c.index_known ? c.index_theta : theta;
                referenced = referenced || c.index_known;
                TEST_ASSERT_TRUE(good);
            } else {
                const int64_t forwards = (pulse - index + counts) % counts;
                const int64_t slip = forwards > counts / 2 ? forwards - counts : forwards;
                const bool in_place = slip <= c.slip_max && slip >= -(int64_t)c.slip_max;
                TEST_ASSERT_EQUAL(in_place, good);
                TEST_ASSERT_EQUAL_INT64(slip, e.slip);
                if (!in_place) {
                    known = (known + forwards) % counts;
                    index = pulse;
                    slips++;
                }
            }
            TEST_ASSERT_EQUAL_UINT32(slips, e.slips);
            TEST_ASSERT_EQUAL_INT32(referenced ? iqfoc_encoder_theta(&e, (uint32_t)index) : 0,
                                    iqfoc_encoder_index_theta(&e));
        }
    }
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

static void test_supervision(void)
{
    uint64_t seed = 5;
    for (int run = 0; run < RUNS; run++) {
        const iqfoc_supervision_config_t c = {
            bits_random(&seed, 1, IQ24_ONE / 4), bits_random(&seed, 1, IQ24_ONE / 2),
            (uint32_t)bits_random(&seed, 6, 14), (uint32_t)bits_random(&seed, 1, 4),
            bits_random(&seed, 1, IQ24_ONE / 2), (uint32_t)bits_random(&seed, 1, 4)};
        iqfoc_supervision_t s;
        int64_t sum[3] = {0};
        int64_t angle = 0;
        uint32_t cycles = 0;
        uint32_t windows = 0;
        uint32_t sums = 0;
        uint32_t status = 0;
        uint32_t phase = 0;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_supervision_init(&s, &c));
        TEST_ASSERT_TRUE((s.sum_a | s.sum_b | s.sum_c | s.angle) == 0);
        TEST_ASSERT_EQUAL_UINT32(0, s.status | s.phase | s.cycles | s.bad_windows | s.bad_sums);
        for (int n = 0; n < 400; n++) {
            const bool running = bits_random(&seed, 0, 60) > 0;
            const iq24_t turns = (run % 2 == 0 ? 1 : -1) * bits_random(&seed, -IQ24_ONE / 40, IQ24_ONE / 8);
            iq24_t i[3];
            for (int x = 0; x < 3; x++) {
                i[x] = bits_random(&seed, -IQ24_ONE, IQ24_ONE) / (x == run % 4 ? 9 : 1) /
                       (n / 100 % 2 == 1 ? 4 : 1);
            }
            int64_t largest = 0;
            if (running) {
                for (int x = 0; x < 3; x++) {
                    sum[x] += i[x] < 0 ? -(int64_t)i[x] : i[x];
                    largest = sum[x] > largest ? sum[x] : largest;
                }
                angle += turns;
                cycles++;
                if ((angle >= IQ24_ONE / 2 || angle <= -IQ24_ONE / 2) && cycles >= c.window_min) {
                    uint32_t lost = 0;
                    const int64_t limit = bits_floor(bits_floor(largest, 65536) * c.share, 256);
                    for (int x = 0; x < 3; x++) {
                        lost |=
                            largest >= (int64_t)c.i_least * cycles && sum[x] < limit ? UINT32_C(1) << x : 0;
                    }
                    windows = lost == 0 ? 0 : windows + 1;
                    if (windows >= c.windows_bad && (status & IQFOC_STATUS_LOST_PHASE) == 0) {
                        status |= IQFOC_STATUS_LOST_PHASE;
                        phase = lost;
                    }
                    cycles = 0;
                }
            }
            windows = running ? windows : 0;
            cycles = running ? cycles : 0;
            if (cycles == 0) {
                sum[0] = sum[1] = sum[2] = angle = 0;
            }
            const int64_t all = (int64_t)i[0] + i[1] + i[2];
            sums = all > c.sum_max || all < -(int64_t)c.sum_max ? sums + 1 : 0;
            status |= sums >= c.sums_bad ? IQFOC_STATUS_LOST_CURRENT_SENSOR : 0;
            TEST_ASSERT_EQUAL_UINT32(
                status, iqfoc_supervision_step(&s, (iqfoc_abc_t){i[0], i[1], i[2]}, turns, running));
            TEST_ASSERT_EQUAL_UINT32(phase, s.phase);
            TEST_ASSERT_EQUAL_UINT32(cycles, s.cycles);
            TEST_ASSERT_EQUAL_INT64(sum[0], s.sum_a);
            TEST_ASSERT_EQUAL_INT64(sum[1], s.sum_b);
            TEST_ASSERT_EQUAL_INT64(sum[2], s.sum_c);
            TEST_ASSERT_EQUAL_INT64(angle, s.angle);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_offset);
    RUN_TEST(test_encoder);
    RUN_TEST(test_encoders_slips_end);
    RUN_TEST(test_supervision);
    return UNITY_END();
}
