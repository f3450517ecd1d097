/*
 * iq24.h against references that share nothing with it: products from 16-bit limbs in sign and magnitude,
 * floors and wraps by division and remainder, saturation by comparison in 64 bits.
 */
#include "iqfoc/iq24.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "iq24_samples.h"
#include "unity.h"

#define SEED         UINT64_C(20161119)
#define RANDOM_PAIRS (10000000 / IQFOC_TEST_STRIDE)

typedef iq24_t (*operation_t)(iq24_t a, iq24_t b);
typedef iq24_t (*reference_t)(iq24_t a, iq24_t b);

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- References ---- */

static int64_t floor_divide(int64_t n, int64_t d)
{
    int64_t quotient = n / d;
    return n % d < 0 ? quotient - 1 : quotient;
}

static iq24_t modulo_2_32(int64_t exact)
{
    int64_t rest = exact % INT64_C(4294967296);
    if (rest < INT32_MIN) {
        rest += INT64_C(4294967296);
    } else if (rest > INT32_MAX) {
        rest -= INT64_C(4294967296);
    }
    return (iq24_t)rest;
}

static iq24_t limit(int64_t exact)
{
    if (exact > INT32_MAX) {
        return INT32_MAX;
    }
    return exact < INT32_MIN ? INT32_MIN : (iq24_t)exact;
}

static uint64_t size_of(iq24_t x)
{
    return x < 0 ? (uint64_t) - (int64_t)x : (uint64_t)x;
}

/* a b from four 16-bit products: at most 2^62. */
static int64_t exact_product(iq24_t a, iq24_t b)
{
    uint64_t a_size = size_of(a);
    uint64_t b_size = size_of(b);
    uint64_t high = (a_size >> 16) * (b_size >> 16);
    uint64_t middle = (a_size >> 16) * (b_size & 0xFFFF) + (a_size & 0xFFFF) * (b_size >> 16);
    uint64_t low = (a_size & 0xFFFF) * (b_size & 0xFFFF);
    int64_t size = (int64_t)((high << 32) + (middle << 16) + low);
    return (a < 0) != (b < 0) ? -size : size;
}

static int64_t floored(int64_t product)
{
    return floor_divide(product, IQ24_ONE);
}

static int64_t rounded(int64_t product)
{
    return floor_divide(product + IQ24_ONE / 2, IQ24_ONE);
}

static int32_t reference_mul_high(int32_t a, int32_t b)
{
    return (int32_t)floor_divide(exact_product(a, b), INT64_C(4294967296));
}

static int32_t reference_mul_high_round(int32_t a, int32_t b)
{
    return (int32_t)floor_divide(exact_product(a, b) + INT64_C(2147483648), INT64_C(4294967296));
}

/* With sums, to which both factors give a third number. */
static int32_t third_of(int32_t a, int32_t b)
{
    return a ^ (b / 3);
}

static int32_t mac_high(int32_t a, int32_t b)
{
    return iq24_mac_high(third_of(a, b), a, b);
}

static int32_t reference_mac_high(int32_t a, int32_t b)
{
    return modulo_2_32((int64_t)third_of(a, b) + reference_mul_high(a, b));
}

static int32_t mac_high_round(int32_t a, int32_t b)
{
    return iq24_mac_high_round(third_of(a, b), a, b);
}

static int32_t reference_mac_high_round(int32_t a, int32_t b)
{
    return modulo_2_32((int64_t)third_of(a, b) + reference_mul_high_round(a, b));
}

/* Half of a Q15.48 sum, so that it fits with any product, low word included. */
static int64_t sum_of(int32_t a, int32_t b)
{
    return (int64_t)third_of(a, b) * INT64_C(1073741789) + b;
}

static int32_t mac(int32_t a, int32_t b)
{
    const iq24_acc_t sum = iq24_acc_mac(sum_of(a, b), a, b);
    return modulo_2_32(sum) ^ modulo_2_32(floor_divide(sum, INT64_C(4294967296)));
}

static int32_t reference_mac(int32_t a, int32_t b)
{
    const int64_t sum = sum_of(a, b) + exact_product(a, b);
    return modulo_2_32(sum) ^ modulo_2_32(floor_divide(sum, INT64_C(4294967296)));
}

static iq24_t reference_mul_trunc(iq24_t a, iq24_t b)
{
    return modulo_2_32(floored(exact_product(a, b)));
}

static iq24_t reference_mul_round(iq24_t a, iq24_t b)
{
    return modulo_2_32(rounded(exact_product(a, b)));
}

static iq24_t reference_mul_sat(iq24_t a, iq24_t b)
{
    return limit(rounded(exact_product(a, b)));
}

static iq24_t reference_add_wrap(iq24_t a, iq24_t b)
{
    return modulo_2_32((int64_t)a + b);
}

static iq24_t reference_sub_wrap(iq24_t a, iq24_t b)
{
    return modulo_2_32((int64_t)a - b);
}

static iq24_t reference_add_sat(iq24_t a, iq24_t b)
{
    return limit((int64_t)a + b);
}

static iq24_t reference_sub_sat(iq24_t a, iq24_t b)
{
    return limit((int64_t)a - b);
}

/* ---- Every extreme pair and RANDOM_PAIRS random ones ---- */

static bool differs(operation_t operation, reference_t reference, iq24_t a, iq24_t b, iq24_t first_wrong[2])
{
    if (operation(a, b) == reference(a, b)) {
        return false;
    }
    first_wrong[0] = a;
    first_wrong[1] = b;
    return true;
}

static int64_t count_wrong(operation_t operation, reference_t reference, iq24_t last_wrong[2])
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    int64_t wrong = 0;
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            wrong += differs(operation, reference, extremes[i], extremes[j], last_wrong);
        }
    }
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < RANDOM_PAIRS / 2; i++) {
        iq24_t a = iq24_random_any(&random);
        iq24_t b = iq24_random_any(&random);
        wrong += differs(operation, reference, a, b, last_wrong);
        a = iq24_random_magnitude(&random);
        b = iq24_random_magnitude(&random);
        wrong += differs(operation, reference, a, b, last_wrong);
    }
    return wrong;
}

static void expect_exact(const char *name, operation_t operation, reference_t reference)
{
    iq24_t pair[2] = {0, 0};
    int64_t wrong = count_wrong(operation, reference, pair);
    if (wrong != 0) {
        char message[160];
        snprintf(message, sizeof message, "%s: %ld wrong, the last at (%ld, %ld): %ld instead of %ld", name,
                 (long)wrong, (long)pair[0], (long)pair[1], (long)operation(pair[0], pair[1]),
                 (long)reference(pair[0], pair[1]));
        TEST_FAIL_MESSAGE(message);
    }
}

static void products_are_exact_before_their_one_rounding(void)
{
    expect_exact("iq24_mul_trunc", iq24_mul_trunc, reference_mul_trunc);
    expect_exact("iq24_mul_round", iq24_mul_round, reference_mul_round);
    expect_exact("iq24_mul_high", iq24_mul_high, reference_mul_high);
    expect_exact("iq24_mul_high_round", iq24_mul_high_round, reference_mul_high_round);
    expect_exact("iq24_mac_high", mac_high, reference_mac_high);
    expect_exact("iq24_mac_high_round", mac_high_round, reference_mac_high_round);
    expect_exact("iq24_acc_mac", mac, reference_mac);
    expect_exact("iq24_mul_sat", iq24_mul_sat, reference_mul_sat);
}

static void sums_wrap_and_saturate_at_every_extreme(void)
{
    expect_exact("iq24_add_wrap", iq24_add_wrap, reference_add_wrap);
    expect_exact("iq24_sub_wrap", iq24_sub_wrap, reference_sub_wrap);
    expect_exact("iq24_add_sat", iq24_add_sat, reference_add_sat);
    expect_exact("iq24_sub_sat", iq24_sub_sat, reference_sub_sat);
}

/* A 64-bit product built from 32-bit halves without the carry between them: right for most pairs, and 2^32 /
 * 2^24 = 256 LSB off for the rest. */
static iq24_t multiply_that_loses_the_carry(iq24_t a, iq24_t b)
{
    uint64_t a_size = size_of(a);
    uint64_t b_size = size_of(b);
    uint64_t cross = (a_size >> 16) * (b_size & 0xFFFF) + (a_size & 0xFFFF) * (b_size >> 16);
    uint64_t low = (a_size & 0xFFFF) * (b_size & 0xFFFF) + ((cross & 0xFFFF) << 16);
    int64_t lost = low > UINT32_MAX ? INT64_C(4294967296) : 0;
    int64_t product = exact_product(a, b);
    return modulo_2_32(floored(product < 0 ? product + lost : product - lost));
}

static void the_product_test_sees_a_lost_carry(void)
{
    iq24_t pair[2];
    TEST_ASSERT_TRUE(count_wrong(multiply_that_loses_the_carry, reference_mul_trunc, pair) >
                     RANDOM_PAIRS / 20);
}

/* ---- One argument ---- */

static void negate_and_absolute_saturate(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        int64_t x = extremes[i];
        TEST_ASSERT_EQUAL_INT32(limit(-x), iq24_neg_sat(extremes[i]));
        TEST_ASSERT_EQUAL_INT32(limit(x < 0 ? -x : x), iq24_abs_sat(extremes[i]));
    }
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, iq24_neg_sat(IQ24_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, iq24_abs_sat(IQ24_MIN));
}

static void comparisons_at_every_extreme(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            const int64_t a = extremes[i];
            const int64_t b = extremes[j];
            TEST_ASSERT_EQUAL_INT32(a - b < 0 ? a : b, iq24_min(extremes[i], extremes[j]));
            TEST_ASSERT_EQUAL_INT32(a - b < 0 ? b : a, iq24_max(extremes[i], extremes[j]));
            TEST_ASSERT_EQUAL(a - b >= 0 && a <= IQ24_ONE, iq24_within(extremes[i], extremes[j], IQ24_ONE));
        }
    }
}

/* Against the exact quotient in steps of one bit: no shift of the product by more than one is trusted. */
static void products_of_other_formats_round_to_the_nearest(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            for (uint32_t bits = 1; bits <= 31; bits++) {
                int64_t below =
                    exact_product(extremes[i], extremes[j]); /* of one more bit: its last rounds */
                for (uint32_t k = 1; k < bits; k++) {
                    below = (below - (below & 1)) / 2;
                }
                const int64_t nearest = (below - (below & 1)) / 2 + (below & 1);
                TEST_ASSERT_EQUAL_INT32(modulo_2_32(nearest), iq24_mul_shift(extremes[i], extremes[j], bits));
            }
        }
    }
}

static void clamp_limits_to_both_ends(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            for (int k = 0; k < count; k++) {
                iq24_t x = extremes[i];
                iq24_t low = extremes[j] < extremes[k] ? extremes[j] : extremes[k];
                iq24_t high = extremes[j] < extremes[k] ? extremes[k] : extremes[j];
                iq24_t got = iq24_clamp(x, low, high);
                bool right = (x < low && got == low) || (x > high && got == high) ||
                             (x >= low && x <= high && got == x);
                if (!right) {
                    TEST_FAIL_MESSAGE("iq24_clamp");
                }
            }
        }
    }
}

/* As by two comparisons, at the bits that the library asks for and at the ends of what may be asked. */
static void a_power_is_held_as_by_clamp(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    const int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        const iq24_t x = extremes[i];
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, -2, 2), IQ24_HOLD_POWER(x, 1));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, IQ24(-4.0), IQ24(4.0)), IQ24_HOLD_POWER(x, 26));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, IQ24(-16.0), IQ24(16.0)), IQ24_HOLD_POWER(x, 28));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, IQ24(-32.0), IQ24(32.0)), IQ24_HOLD_POWER(x, 29));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, IQ24(-64.0), IQ24(64.0)), IQ24_HOLD_POWER(x, 30));
    }
}

static void right_shifts_are_floors(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (uint32_t bits = 0; bits < 32; bits++) {
            int64_t divisor = INT64_C(1) << bits;
            TEST_ASSERT_EQUAL_INT32(floor_divide(extremes[i], divisor), iq24_asr32(extremes[i], bits));
            for (int j = 0; j < count; j += 3) {
                int64_t wide = exact_product(extremes[i], extremes[j]);
                TEST_ASSERT_EQUAL_INT64(floor_divide(wide, divisor), iq24_asr64(wide, bits));
            }
        }
    }
    TEST_ASSERT_EQUAL_INT64(-1, iq24_asr64(INT64_MIN, 63));
    TEST_ASSERT_EQUAL_INT64(-2, iq24_asr64(INT64_MIN, 62));
    TEST_ASSERT_EQUAL_INT64(1, iq24_asr64(INT64_MAX, 62));
}

static void wrap_and_sat_of_64_bits(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            int64_t wide = exact_product(extremes[i], extremes[j]);
            TEST_ASSERT_EQUAL_INT32(modulo_2_32(wide), iq24_wrap(wide));
            TEST_ASSERT_EQUAL_INT32(limit(wide), iq24_sat(wide));
            for (uint32_t bits = 1; bits < 32; bits++) {
                int64_t shifted = floor_divide(wide, INT64_C(1) << bits);
                TEST_ASSERT_EQUAL_INT32(modulo_2_32(shifted), iq24_shift_wrap(wide, bits));
            }
        }
    }
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, iq24_sat(INT64_MIN));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, iq24_sat(INT64_MAX));
    TEST_ASSERT_EQUAL_INT32(0, iq24_wrap(INT64_MIN));
    TEST_ASSERT_EQUAL_INT32(-1, iq24_wrap(INT64_MAX));
    TEST_ASSERT_EQUAL_INT32(0, iq24_shift_wrap(INT64_MIN, 31));
    TEST_ASSERT_EQUAL_INT32(-1, iq24_shift_wrap(INT64_MAX, 31));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, iq24_from_bits(UINT32_C(0x80000000)));
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, iq24_from_bits(UINT32_C(0x7FFFFFFF)));
    TEST_ASSERT_EQUAL_INT32(-1, iq24_from_bits(UINT32_MAX));
}

/* ---- Accumulator ---- */

/* floor(((a b) +- (c d) + half) / 2^24) from the parts above and below the binary point, which cannot overflow. */
static int64_t two_products(iq24_t a, iq24_t b, iq24_t c, iq24_t d, int sign, int64_t half)
{
    int64_t first = exact_product(a, b);
    int64_t second = sign * exact_product(c, d);
    int64_t below = (first - floored(first) * IQ24_ONE) + (second - floored(second) * IQ24_ONE) + half;
    return floored(first) + floored(second) + floored(below);
}

static void expect_accumulator(iq24_t a, iq24_t b, iq24_t c, iq24_t d)
{
    iq24_acc_t difference = iq24_acc_mul(a, b) - iq24_acc_mul(c, d);
    int64_t expected = two_products(a, b, c, d, -1, IQ24_ONE / 2);
    bool right =
        iq24_acc_round(difference) == modulo_2_32(expected) && iq24_acc_sat(difference) == limit(expected);
    /* The one sum of two products that the header excludes. */
    if (!(a == IQ24_MIN && b == IQ24_MIN && c == IQ24_MIN && d == IQ24_MIN)) {
        iq24_acc_t sum = iq24_acc_mac(iq24_acc_mul(a, b), c, d);
        expected = two_products(a, b, c, d, 1, IQ24_ONE / 2);
        right = right && iq24_acc_round(sum) == modulo_2_32(expected) && iq24_acc_sat(sum) == limit(expected);
        right = right && iq24_acc_trunc(sum) == modulo_2_32(two_products(a, b, c, d, 1, 0));
        sum = iq24_acc_mac(iq24_acc_mac(IQ24_ACC_HALF, a, b), c, d);
        right = right && iq24_acc_trunc(sum) == modulo_2_32(expected);
    }
    if (!right) {
        char message[120];
        snprintf(message, sizeof message, "(%ld * %ld) +- (%ld * %ld)", (long)a, (long)b, (long)c, (long)d);
        TEST_FAIL_MESSAGE(message);
    }
}

static void two_products_accumulate_exactly(void)
{
    iq24_t ends[] = {IQ24_MIN, IQ24_MIN + 1, -IQ24_ONE, -1,           0,
                     1,        IQ24_ONE / 2, IQ24_ONE,  IQ24_MAX - 1, IQ24_MAX};
    int count = (int)(sizeof ends / sizeof *ends);
    for (int i = 0; i < count * count * count * count; i++) {
        expect_accumulator(ends[i % count], ends[i / count % count], ends[i / count / count % count],
                           ends[i / count / count / count]);
    }
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < RANDOM_PAIRS / 4; i++) {
        iq24_t a = iq24_random_magnitude(&random);
        iq24_t b = iq24_random_magnitude(&random);
        iq24_t c = iq24_random_any(&random);
        expect_accumulator(a, b, c, iq24_random_any(&random));
    }
}

static void halves_join_and_hold(void)
{
    iq24_t extremes[IQ24_EXTREMES];
    int count = iq24_extremes(extremes);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            int64_t joined = iq24_acc_join(extremes[i], (uint32_t)extremes[j]);
            TEST_ASSERT_EQUAL_INT64(extremes[i], iq24_asr64(joined, 32));
            TEST_ASSERT_EQUAL_UINT32((uint32_t)extremes[j], (uint32_t)((uint64_t)joined & UINT32_MAX));
        }
    }
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < RANDOM_PAIRS / 4; i++) {
        iq24_t x = i < count ? extremes[i] : iq24_random_magnitude(&random);
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, -1, 0), IQ24_HOLD_BITS(x, 1));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, -524288, 524287), IQ24_HOLD_BITS(x, 20));
        TEST_ASSERT_EQUAL_INT32(iq24_clamp(x, -1073741824, 1073741823), IQ24_HOLD_BITS(x, 31));
    }
}

static void two_products_in_one_sum(iq24_t a, iq24_t b, iq24_t c, iq24_t d)
{
    const int64_t sum = iq24_acc_mac(iq24_acc_mul(a, b), c, d);
    TEST_ASSERT_EQUAL_INT64(sum, IQ24_SUM64(a, b, c, d));
    TEST_ASSERT_EQUAL_INT32(iq24_asr64(sum, 32), iq24_high_of(sum));
    TEST_ASSERT_EQUAL_INT32(iq24_add_wrap(c, iq24_mul_high(-a, b)), IQ24_HIGH_SUB(c, a, b));
}

static void pairs_load_and_order(iq24_t a, iq24_t b)
{
    const struct {
        int32_t ahead[3];
        int32_t a;
        int32_t b;
    } held = {{1, 2, 3}, a, b};
    iq24_t low;
    iq24_t high;
    IQ24_LOAD_PAIR(low, high, held.a, held.b);
    TEST_ASSERT_TRUE(low == a && high == b);
    low = iq24_asr32(low, 1);
    high = iq24_asr32(high, 1);
    IQ24_ORDER(low, high);
    TEST_ASSERT_EQUAL_INT32(iq24_asr32(iq24_min(a, b), 1), low);
    TEST_ASSERT_EQUAL_INT32(iq24_asr32(iq24_max(a, b), 1), high);
}

static void hooks_of_pairs(void)
{
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < RANDOM_PAIRS / 4; i++) {
        const iq24_t a = iq24_max(iq24_random_magnitude(&random), IQ24_MIN + 1);
        const iq24_t b = iq24_random_magnitude(&random);
        two_products_in_one_sum(a, b, iq24_random_any(&random), iq24_random_any(&random));
        pairs_load_and_order(a, b);
        pairs_load_and_order(b, b);
    }
}

static void many_products_below_their_bound_accumulate_exactly(void)
{
    /* n = 512 factors of 8 per unit: exactly the bound of the header, on its negative side. */
    iq24_acc_t sum = 0;
    for (int i = 0; i < 512; i++) {
        sum = iq24_acc_mac(sum, 8 * IQ24_ONE, -8 * IQ24_ONE);
    }
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, sum);
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_acc_sat(sum));
    for (int i = 0; i < 511; i++) {
        sum = iq24_acc_mac(sum, -8 * IQ24_ONE, -8 * IQ24_ONE);
    }
    TEST_ASSERT_EQUAL_INT32(-64 * IQ24_ONE, iq24_acc_sat(sum));
}

/* ---- Constants ---- */

static const iq24_t folded[] = {IQ24(0.1), IQ24(-1.0 / 3.0), IQ24(127.99999994039535522), IQ24(-128.0),
                                IQ24(3)};

static void constants_fold_to_the_nearest(void)
{
    TEST_ASSERT_EQUAL_INT32(1677722, folded[0]);
    TEST_ASSERT_EQUAL_INT32(-5592405, folded[1]);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, folded[2]);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, folded[3]);
    TEST_ASSERT_EQUAL_INT32(3 * IQ24_ONE, folded[4]);
    TEST_ASSERT_EQUAL_INT32(INT32_MAX, IQ24_MAX);
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, IQ24_MIN);
    TEST_ASSERT_EQUAL_INT32(16777216, IQ24_ONE);
    /* Ties go away from zero, and the largest number below a tie does not. */
    TEST_ASSERT_EQUAL_INT32(1, IQ24(0x1p-25));
    TEST_ASSERT_EQUAL_INT32(-1, IQ24(-0x1p-25));
    TEST_ASSERT_EQUAL_INT32(0, IQ24(0x1.fffffffffffffp-26));
    TEST_ASSERT_EQUAL_INT32(0, IQ24(-0x1.fffffffffffffp-26));
    TEST_ASSERT_EQUAL_INT32(INT32_MIN, IQ24(-128.0 - 0x1.ffp-26));
    iq24_random_t random = {SEED};
    for (int32_t i = 0; i < RANDOM_PAIRS / 10; i++) {
        double x = (double)iq24_random_any(&random) / IQ24_ONE + (double)iq24_random_any(&random) * 0x1p-58;
        if (fabs(x) < 127.9999) {
            TEST_ASSERT_EQUAL_INT32(llround(x * IQ24_ONE), IQ24_NEAREST_(x));
        }
    }
}

int main(void)
{
    printf("seed %lu, %ld random pairs\n", (unsigned long)SEED, (long)RANDOM_PAIRS);
    UNITY_BEGIN();
    RUN_TEST(products_are_exact_before_their_one_rounding);
    RUN_TEST(sums_wrap_and_saturate_at_every_extreme);
    RUN_TEST(the_product_test_sees_a_lost_carry);
    RUN_TEST(negate_and_absolute_saturate);
    RUN_TEST(comparisons_at_every_extreme);
    RUN_TEST(products_of_other_formats_round_to_the_nearest);
    RUN_TEST(clamp_limits_to_both_ends);
    RUN_TEST(a_power_is_held_as_by_clamp);
    RUN_TEST(right_shifts_are_floors);
    RUN_TEST(wrap_and_sat_of_64_bits);
    RUN_TEST(two_products_accumulate_exactly);
    RUN_TEST(halves_join_and_hold);
    RUN_TEST(hooks_of_pairs);
    RUN_TEST(many_products_below_their_bound_accumulate_exactly);
    RUN_TEST(constants_fold_to_the_nearest);
    return UNITY_END();
}
