/* Encoder: every count of every kind of encoder against double, and the effect of the index on the reference. */
#include "iqfoc/encoder.h"
#include "reference.h"

#include <stddef.h>

#define SEED UINT64_C(65536)

void setUp(void)
{
}

void tearDown(void)
{
}

static double off(iq24_t theta, double turns)
{
    return remainder(to_double(theta) - turns, 1.0) * 16777216.0;
}

static void test_every_count(void)
{
    static const uint32_t encoders[] = {4, 5, 60, 1000, 4096, 10000, 16384, 65535, 65536};
    uint64_t seed = SEED;
    double worst_lsb = 0.0;
    for (uint32_t e = 0; e < sizeof encoders / sizeof encoders[0]; e++) {
        for (uint32_t pole_pairs = 1; pole_pairs <= 64; pole_pairs += pole_pairs < 8 ? 1 : 14) {
            const iqfoc_encoder_config_t config = {encoders[e], pole_pairs, 0, false, 0};
            const uint32_t known = (uint32_t)(random_bits(&seed) % encoders[e]);
            const iq24_t theta = random_iq24(&seed, -120.0, 120.0);
            iqfoc_encoder_t encoder;
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
            TEST_ASSERT_FALSE(encoder.referenced);
            iqfoc_encoder_align(&encoder, known, theta);
            TEST_ASSERT_TRUE(encoder.referenced);
            TEST_ASSERT_EQUAL_INT32(theta, iqfoc_encoder_theta(&encoder, known));
            for (uint32_t count = 0; count < encoders[e]; count++) {
                const double turns = to_double(theta) + ((double)count - (double)known) * (double)pole_pairs /
                                                            (double)encoders[e];
                worst_lsb = fmax(worst_lsb, fabs(off(iqfoc_encoder_theta(&encoder, count), turns)));
            }
        }
    }
    printf("  theta worst %.4f LSB, stated 0.51\n", worst_lsb);
    TEST_ASSERT_TRUE(worst_lsb <= 0.51 && worst_lsb > 0.49);
}

static iqfoc_encoder_config_t usual(bool known)
{
    const iqfoc_encoder_config_t config = {4096, 3, 4, known, IQ24(0.2)};
    return config;
}

static void test_index_is_the_reference(void)
{
    const iqfoc_encoder_config_t config = usual(true);
    iqfoc_encoder_t encoder;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
    TEST_ASSERT_EQUAL_UINT32(0, encoder.index_count);
    TEST_ASSERT_EQUAL_INT32(0, encoder.slip);
    TEST_ASSERT_TRUE(iqfoc_encoder_index(&encoder, 700));
    TEST_ASSERT_TRUE(encoder.referenced && encoder.indexed);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.2), iqfoc_encoder_theta(&encoder, 700));
    TEST_ASSERT_EQUAL_INT32(IQ24(0.2), iqfoc_encoder_index_theta(&encoder));
}

/* Aligned first: what the index' angle is can be kept for the next start, which then needs no alignment. */
static void test_index_is_learnt(void)
{
    iqfoc_encoder_config_t config = usual(false);
    iqfoc_encoder_t encoder;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
    TEST_ASSERT_TRUE(iqfoc_encoder_index(&encoder, 1000));
    TEST_ASSERT_FALSE(encoder.referenced);
    TEST_ASSERT_EQUAL_INT32(0, iqfoc_encoder_index_theta(&encoder));
    iqfoc_encoder_align(&encoder, 3000, IQ24(0.25));
    const iq24_t learnt = iqfoc_encoder_index_theta(&encoder);
    TEST_ASSERT_TRUE(fabs(off(learnt, 0.25 - 3.0 * 2000.0 / 4096.0)) <= 0.51);
    config = usual(true);
    config.index_theta = learnt;
    iqfoc_encoder_t next;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&next, &config));
    TEST_ASSERT_TRUE(iqfoc_encoder_index(&next, 17)); /* counted from elsewhere after the new start */
    TEST_ASSERT_TRUE(fabs(off(iqfoc_encoder_theta(&next, 2017), 0.25)) <= 1.02);
}

static void test_lost_counts(void)
{
    for (int32_t lost = -2047; lost <= 2048; lost++) {
        for (uint32_t at = 0; at < 4096; at += 4095) {
            const iqfoc_encoder_config_t config = usual(true);
            const uint32_t seen = (uint32_t)((int32_t)at + lost + 4096) % 4096;
            iqfoc_encoder_t encoder;
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
            (void)iqfoc_encoder_index(&encoder, at);
            const bool in_place = iqfoc_encoder_index(&encoder, seen);
            TEST_ASSERT_EQUAL_INT32(lost, encoder.slip);
            TEST_ASSERT_EQUAL_INT(lost >= -4 && lost <= 4, in_place);
            TEST_ASSERT_EQUAL_UINT32(in_place ? 0 : 1, encoder.slips);
            /* The angle at the pulse is right again; one within the pulse' width is left as it is. */
            const iq24_t theta = iqfoc_encoder_theta(&encoder, in_place ? at : seen);
            TEST_ASSERT_EQUAL_INT32(IQ24(0.2), theta);
            TEST_ASSERT_TRUE(encoder.count_known < 4096);
            TEST_ASSERT_TRUE(iqfoc_encoder_index(&encoder, in_place ? at : seen));
        }
    }
    iqfoc_encoder_t encoder;
    const iqfoc_encoder_config_t config = usual(true);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &config));
    (void)iqfoc_encoder_index(&encoder, 0);
    encoder.slips = UINT32_MAX;
    TEST_ASSERT_FALSE(iqfoc_encoder_index(&encoder, 100));
    TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, encoder.slips);
}

static void check(uint32_t counts, uint32_t pole_pairs, uint32_t slip, iqfoc_error_t want)
{
    const iqfoc_encoder_config_t config = {counts, pole_pairs, slip, false, 0};
    iqfoc_encoder_t encoder = {.slips = 9};
    TEST_ASSERT_EQUAL_INT(want, iqfoc_encoder_init(&encoder, &config));
    TEST_ASSERT_EQUAL_UINT32(want == IQFOC_OK ? 0 : 9, encoder.slips);
}

static void test_limits(void)
{
    const iqfoc_encoder_config_t config = usual(false);
    iqfoc_encoder_t encoder;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_encoder_init(NULL, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_encoder_init(&encoder, NULL));
    check(4, 1, 1, IQFOC_OK);
    check(65536, 64, 16384, IQFOC_OK);
    check(3, 1, 0, IQFOC_ERROR_ENCODER);
    check(65537, 1, 0, IQFOC_ERROR_ENCODER);
    check(4096, 0, 0, IQFOC_ERROR_ENCODER);
    check(4096, 65, 0, IQFOC_ERROR_ENCODER);
    check(4096, 1, 1025, IQFOC_ERROR_ENCODER);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_count);
    RUN_TEST(test_index_is_the_reference);
    RUN_TEST(test_index_is_learnt);
    RUN_TEST(test_lost_counts);
    RUN_TEST(test_limits);
    return UNITY_END();
}
