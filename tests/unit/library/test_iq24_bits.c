/*
 * Sine, arc tangent and square root to the last bit: hashes over the tables and the results. tools/derive_iq24_trig.py
 * checks that the tables are those of the functions, test_iq24_math.c that they keep the stated bounds.
 */
#include "bits.h"
#include "hash.h"
#include "iq24_samples.h"

#include "iqfoc/iq24_math.h"

#define DRAWS 400000

void setUp(void)
{
}

void tearDown(void)
{
}

static void the_sines_table_and_terms(void)
{
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < IQ24_SINE_CELLS + IQ24_SINE_CELLS / 4; n++) {
        TEST_ASSERT_EQUAL_INT32(lround(ldexp(sin(TWO_PI * n / IQ24_SINE_CELLS), 30)), iq24_sine_q30[n]);
    }
    digest_add(&digest, IQ24_ROTATE_S1);
    digest_add(&digest, IQ24_ROTATE_S3);
    digest_add(&digest, IQ24_ROTATE_C2);
    digest_add(&digest, IQ24_ROTATE_C4);
    bits_golden(UINT64_C(0xa4727db9f53f44fd), digest);
}

static void sine_to_the_bit(void)
{
    iq24_random_t random = {1};
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_sincos_t got = iq24_sincos(iq24_random_any(&random));
        digest_add(&digest, got.sin);
        digest_add(&digest, got.cos);
    }
    bits_golden(UINT64_C(0xe9087f60734534f5), digest);
}

static void arctan_to_the_bit(void)
{
    iq24_random_t random = {2};
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const int64_t high = 1 + (int64_t)(iq24_random_bits(&random) >> (1 + n % 24));
        const int64_t low = (int64_t)(iq24_random_bits(&random) % (uint32_t)(high + 1));
        digest_add(&digest, iq24_atan2((iq24_t)low, iq24_sat(high)));
    }
    bits_golden(UINT64_C(0x7ac68476c9183f2e), digest);
}

/* The nodes themselves, and half way to their neighbours, where the cubic changes. */
static void arctan_at_the_nodes(void)
{
    uint64_t digest = DIGEST_START;
    const iq24_t x = IQ24_ONE - 1;
    for (int64_t half = 0; half <= 32; half++) {
        for (int64_t off = -70; off <= 70; off++) {
            digest_add(&digest, iq24_atan2((iq24_t)bits_held(half * (1 << 19) + off, 0, x), x));
        }
    }
    bits_golden(UINT64_C(0x96cc9fca1f4f74c2), digest);
}

static void root_to_the_bit(void)
{
    iq24_random_t random = {3};
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        digest_add(&digest, iq24_sqrt((int32_t)(iq24_random_bits(&random) >> (1 + n % 31)) + 1));
    }
    bits_golden(UINT64_C(0xb734badb445ac733), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_sines_table_and_terms);
    RUN_TEST(sine_to_the_bit);
    RUN_TEST(arctan_to_the_bit);
    RUN_TEST(arctan_at_the_nodes);
    RUN_TEST(root_to_the_bit);
    return UNITY_END();
}
