/*
 * The library's assembly for cores that multiply to 32 bits (src/arm_*.c) against its C, to the bit: sine and cosine
 * of all angles, the rotor's polynomials of all speeds, products of the extremes with one another and of random
 * numbers. A Cortex-M0+ runs the assembly. The C is compiled for the board's own core with plain products
 * (IQFOC_TARGET_HEADER), so that the reference is independent.
 */
#include "iqfoc/iq24_sincos.h"
#include "iqfoc/rotor.h"

#include "../unit/library/iq24_samples.h"
#include "unity.h"

#ifdef IQ24_SINCOS_Q30
#error "the C must be plain here: IQFOC_TARGET_HEADER"
#endif

int64_t iqfoc_arm_mul64(int32_t a, int32_t b);
int64_t iqfoc_arm_mac64(int64_t sum, int32_t a, int32_t b);
int64_t iqfoc_arm_sum64(int32_t a, int32_t b, int32_t c, int32_t d);
int32_t iqfoc_arm_high(int32_t a, int32_t b);
int32_t iqfoc_arm_high_round(int32_t a, int32_t b);
int64_t iqfoc_arm_sincos_q30(int32_t turns);
int64_t iqfoc_arm_rotor(int32_t speed, const int32_t *poly);

#define DRAWS 5000000

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- All that can be counted ---- */

static int64_t sincos_in_c(int32_t turns)
{
    const iq24_sincos_t sc = iq24_sincos_q30_inline(turns);
    return sc.cos * INT64_C(0x100000000) + (int64_t)(uint32_t)sc.sin;
}

/* Whole turns fall out of either in its first shift: they are tried at the ends of the range alone. */
static void sine_and_cosine_of_all_angles(void)
{
    for (int32_t angle = -IQ24_ONE / 2; angle < IQ24_ONE / 2; angle++) {
        if (iqfoc_arm_sincos_q30(angle) != sincos_in_c(angle)) {
            TEST_ASSERT_EQUAL_INT64(sincos_in_c(angle), iqfoc_arm_sincos_q30(angle));
        }
    }
    for (int32_t n = 0; n < 1000000; n++) {
        TEST_ASSERT_TRUE(iqfoc_arm_sincos_q30(IQ24_MIN + n) == sincos_in_c(IQ24_MIN + n));
        TEST_ASSERT_TRUE(iqfoc_arm_sincos_q30(IQ24_MAX - n) == sincos_in_c(IQ24_MAX - n));
    }
}

/* One past the limit either way, as the function is promised. */
static void the_rotors_polynomials_of_all_speeds(void)
{
    for (int32_t speed = -IQFOC_ROTOR_SPEED_MAX - 1; speed <= IQFOC_ROTOR_SPEED_MAX + 1; speed++) {
        const iqfoc_rotor_shape_t shape = iqfoc_rotor_shape(speed);
        const int64_t wanted = shape.p2_q30 * INT64_C(0x100000000) + (int64_t)(uint32_t)shape.p1_q30;
        if (iqfoc_arm_rotor(speed, &iqfoc_rotor_poly[0][0]) != wanted) {
            TEST_ASSERT_EQUAL_INT64(wanted, iqfoc_arm_rotor(speed, &iqfoc_rotor_poly[0][0]));
        }
    }
}

/* ---- Products ---- */

static int64_t sum_modulo(int64_t a, int64_t b)
{
    const uint64_t room = UINT64_MAX - (uint64_t)a;
    const uint64_t sum = (uint64_t)b <= room ? (uint64_t)a + (uint64_t)b : (uint64_t)b - room - 1;
    return sum <= INT64_MAX ? (int64_t)sum : -(int64_t)(UINT64_MAX - sum) - 1;
}

static bool products_agree(int64_t sum, int32_t a, int32_t b)
{
    const int64_t product = (int64_t)a * b;
    /* Another product from the halves of the sum, ahead of this one and after it. */
    const int32_t c = (int32_t)iq24_asr64(sum, 32);
    const int32_t d = iq24_wrap(sum);
    const int64_t both = sum_modulo(product, (int64_t)c * d);
    return iqfoc_arm_sum64(a, b, c, d) == both && iqfoc_arm_sum64(c, d, a, b) == both &&
           iqfoc_arm_mul64(a, b) == product && iqfoc_arm_mac64(sum, a, b) == sum_modulo(sum, product) &&
           iqfoc_arm_high(a, b) == (int32_t)iq24_asr64(product, 32) &&
           iqfoc_arm_high_round(a, b) == (int32_t)iq24_asr64(product + (INT64_C(1) << 31), 32);
}

static void products_of_the_extremes(void)
{
    static const int64_t sums[] = {
        0, 1, -1, INT64_MAX, INT64_MIN, INT64_C(0xFFFFFFFF), -INT64_C(0x100000000)};
    iq24_t values[IQ24_EXTREMES];
    const int count = iq24_extremes(values);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) {
            TEST_ASSERT_TRUE_MESSAGE(products_agree(sums[(i + k) % 7], values[i], values[k]), "extremes");
        }
    }
}

/*
 * Halves at the ends of theirs, which the middle sum's overflow depends on, and all that is drawn; the overflow must
 * have been seen, and seen not to be.
 */
static void products_drawn(void)
{
    iq24_random_t random = {UINT64_C(20261122)};
    int32_t over = 0;
    for (int32_t n = 0; n < DRAWS; n++) {
        int32_t a = iq24_random_any(&random);
        int32_t b = n % 2 == 0 ? iq24_random_any(&random) : iq24_random_magnitude(&random);
        if (n % 8 == 0) {
            a |= 0xFFFF;
        }
        if (n % 8 < 2) {
            b |= 0xFFFF;
        }
        const int64_t sum =
            (int64_t)iq24_random_any(&random) * INT64_C(0x100000000) + iq24_random_any(&random);
        if (!products_agree(sum, a, b)) {
            TEST_ASSERT_EQUAL_INT64((int64_t)a * b, iqfoc_arm_mul64(a, b));
            TEST_FAIL_MESSAGE("sum or high word");
        }
        const int64_t al = a & 0xFFFF;
        const int64_t bl = b & 0xFFFF;
        const int64_t middle = al * iq24_asr32(b, 16) + ((al * bl) >> 16) + iq24_asr32(a, 16) * bl;
        over += middle > INT32_MAX || middle < INT32_MIN;
    }
    TEST_ASSERT_TRUE(over > DRAWS / 50 && over < DRAWS / 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(sine_and_cosine_of_all_angles);
    RUN_TEST(the_rotors_polynomials_of_all_speeds);
    RUN_TEST(products_of_the_extremes);
    RUN_TEST(products_drawn);
    return UNITY_END();
}
