/*
 * Sine, arc tangent and square root to the bit that iq24_math.h states. The test makes the tables from the functions.
 * test_iq24_math.c checks that the tables keep the stated bounds.
 */
#include "bits.h"
#include "iq24_samples.h"

#include "iqfoc/iq24_math.h"

#define DRAWS (400000 / IQFOC_TEST_STRIDE)

enum { NODES = 17, TERMS = 4 };

static int32_t arctan_q32[NODES][TERMS];

void setUp(void)
{
}

void tearDown(void)
{
}

/* Coefficients, lowest power first, of the polynomial through (node, value): Newton's divided differences. */
static void through(const double *node, const double *value, int terms, double *c)
{
    double difference[TERMS];
    for (int k = 0; k < terms; k++) {
        difference[k] = value[k];
        c[k] = 0.0;
    }
    for (int order = 1; order < terms; order++) {
        for (int k = terms - 1; k >= order; k--) {
            difference[k] = (difference[k] - difference[k - 1]) / (node[k] - node[k - order]);
        }
    }
    for (int k = terms - 1; k >= 0; k--) {
        for (int power = terms - 1; power > 0; power--) {
            c[power] = c[power - 1] - node[k] * c[power];
        }
        c[0] = difference[k] - node[k] * c[0];
    }
}

/* Nodes of Chebyshev in [-1, 1]. */
static double chebyshev(int k, int terms)
{
    return cos(TWO_PI * (2 * k + 1) / (4.0 * terms));
}

/* ---- Sine ---- */

/* sin(2 pi n/64) to nearest in Q30, and two terms each of sine and 1 - cosine up to half a cell. */
static void the_sines_table_and_terms(void)
{
    for (int n = 0; n < IQ24_SINE_CELLS + IQ24_SINE_CELLS / 4; n++) {
        TEST_ASSERT_EQUAL_INT32(lround(ldexp(sin(TWO_PI * n / IQ24_SINE_CELLS), 30)), iq24_sine_q30[n]);
    }
    const double half_cell = TWO_PI / IQ24_SINE_CELLS / 2.0;
    double v[2];
    double sine[2];
    double versine[2];
    double of_sine[2];
    double of_versine[2];
    for (int k = 0; k < 2; k++) {
        v[k] = 0.5 + 0.5 * chebyshev(k, 2);
        sine[k] = sin(half_cell * sqrt(v[k])) / sqrt(v[k]);
        versine[k] = (1.0 - cos(half_cell * sqrt(v[k]))) / v[k];
    }
    through(v, sine, 2, of_sine);
    through(v, versine, 2, of_versine);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(of_sine[0], 35)), IQ24_ROTATE_S1);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(-of_sine[1], 37)), IQ24_ROTATE_S3);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(of_versine[0], 36)), IQ24_ROTATE_C2);
    TEST_ASSERT_EQUAL_INT32(lround(ldexp(-of_versine[1], 38)), IQ24_ROTATE_C4);
}

/* The angle of the nearest cell, turned by the rest: high words down, the whole once to nearest. */
static void sine_to_the_bit(void)
{
    iq24_random_t random = {1};
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t angle = iq24_random_any(&random);
        const int64_t cell = bits_floor((int64_t)angle + (1 << 17), 1 << 18);
        const int64_t rest = (angle - cell * (1 << 18)) * (1 << 14);
        const int64_t square = bits_high(rest, rest);
        const int64_t sine = bits_high(rest, IQ24_ROTATE_S1 - bits_high(square, IQ24_ROTATE_S3));
        const int64_t versine = bits_high(square, bits_high(square, IQ24_ROTATE_C4) - IQ24_ROTATE_C2);
        const int64_t at = bits_floor(cell, IQ24_SINE_CELLS);
        const int32_t *entry = &iq24_sine_q30[cell - at * IQ24_SINE_CELLS];
        const int64_t s = entry[0];
        const int64_t c = entry[IQ24_SINE_CELLS / 4];
        const iq24_sincos_t got = iq24_sincos(angle);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(s + bits_floor(c * sine + s * versine, INT64_C(1) << 34), 6),
                                got.sin);
        TEST_ASSERT_EQUAL_INT64(bits_nearest(c + bits_floor(-s * sine + c * versine, INT64_C(1) << 34), 6),
                                got.cos);
    }
}

/* ---- Arc tangent ---- */

/* Cubics in u around ratios n/16, (n + u/2)/16 and half an LSB on; the k-th coefficient times 2^k, Q32 turns. */
static void make_arctan_table(void)
{
    for (int n = 0; n < NODES; n++) {
        double u[TERMS];
        double turns[TERMS];
        double c[TERMS];
        for (int k = 0; k < TERMS; k++) {
            u[k] = chebyshev(k, TERMS);
            turns[k] = atan((n + u[k] / 2.0) / 16.0 + ldexp(1.0, -25)) / TWO_PI;
        }
        through(u, turns, TERMS, c);
        for (int k = 0; k < TERMS; k++) {
            arctan_q32[n][k] = (int32_t)lround(ldexp(c[k], 32 + k));
        }
    }
}

static int64_t first_octant(int64_t ratio)
{
    const int64_t n = (ratio + (1 << 19)) / (1 << 20);
    const int64_t u = (ratio - n * (1 << 20)) * (1 << 12);
    const int32_t *c = arctan_q32[n];
    return bits_nearest(c[0] + bits_high(u, c[1] + bits_high(u, c[2] + bits_high(u, c[3]))), 8);
}

static void arctan_to_the_bit(void)
{
    iq24_random_t random = {2};
    make_arctan_table();
    for (int n = 0; n < DRAWS; n++) {
        const int64_t high = 1 + (int64_t)(iq24_random_bits(&random) >> (1 + n % 24));
        const int64_t low = (int64_t)(iq24_random_bits(&random) % (uint32_t)(high + 1));
        const iq24_t got = iq24_atan2((iq24_t)low, iq24_sat(high));
        TEST_ASSERT_EQUAL_INT64(first_octant(bits_long_division(low, high)), got);
    }
}

/* The nodes themselves, and half way to their neighbours, where the cubic changes. */
static void arctan_at_the_nodes(void)
{
    make_arctan_table();
    const iq24_t x = IQ24_ONE - 1;
    for (int64_t half = 0; half <= 32; half++) {
        for (int64_t off = -70; off <= 70; off++) {
            const int64_t y = bits_held(half * (1 << 19) + off, 0, x);
            TEST_ASSERT_EQUAL_INT64(first_octant(y * IQ24_ONE / x), iq24_atan2((iq24_t)y, x));
        }
    }
}

/* ---- Square root ---- */

static uint32_t whole_root(uint64_t m)
{
    uint64_t root = (uint64_t)sqrt((double)m);
    while (root * root > m) {
        root--;
    }
    while ((root + 1) * (root + 1) <= m) {
        root++;
    }
    return (uint32_t)root;
}

/*
 * The root s of the leading bits m, or one more where that is within 0.01 of it, corrected by (m - s^2)/2 s towards
 * 0 in units of 2^-15, rounded once to nearest, ties up.
 */
static void root_to_the_bit(void)
{
    iq24_random_t random = {3};
    for (int n = 0; n < DRAWS; n++) {
        const int32_t x = (int32_t)(iq24_random_bits(&random) >> (1 + n % 31)) + 1;
        int64_t m = x;
        int k = 0;
        while (m < INT64_C(1) << 30) {
            m *= 4;
            k++;
        }
        int64_t s = whole_root((uint64_t)m);
        s += (double)s + 1.0 < sqrt((double)m) + 0.01 ? 1 : 0;
        const int64_t unit = INT64_C(1) << (k + 3);
        const int64_t want = (s * 32768 + (m - s * s) * 16384 / s + unit / 2) / unit;
        const int64_t other = (s - 1) * 32768 + (m - (s - 1) * (s - 1)) * 16384 / (s - 1);
        const iq24_t got = iq24_sqrt(x);
        TEST_ASSERT_TRUE(got == want || (s * s > m && got == (other + unit / 2) / unit));
    }
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
