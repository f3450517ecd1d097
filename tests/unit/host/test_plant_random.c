/*
 * The plant's random numbers: the generator's known bits, and the distributions made of them.
 */
#include "plant/plant_random.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

#define SEED 20190612u

/*
 * xoshiro256++ from the state {1, 2, 3, 4}: the outputs that its authors' algorithm gives. The first, by hand,
 * is ((1 + 4) << 23) + 1.
 */
static void test_known_bits(void)
{
    plant_random r = {.s = {1, 2, 3, 4}};
    const uint64_t expected[4] = {41943041u, 58720359u, 3588806011781223u, 3591011842654386u};
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_TRUE(plant_random_bits(&r) == expected[k]);
    }
}

/* A million: moments within 4 sigma of those of the normal distribution. */
static void test_normal(void)
{
    plant_random r;
    plant_random_seed(&r, SEED, 3);
    const double n = 1e6;
    double moment[5] = {0.0};
    for (int k = 0; k < (int)n; k++) {
        const double x = plant_random_normal(&r);
        for (int m = 1; m <= 4; m++) {
            moment[m] += pow(x, m) / n;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(1.0 / n), 0.0, moment[1]);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(2.0 / n), 1.0, moment[2]);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(15.0 / n), 0.0, moment[3]);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(96.0 / n), 3.0, moment[4]);
}

static void test_uniform(void)
{
    plant_random r;
    plant_random_seed(&r, SEED, 4);
    double least = 1.0, most = 0.0;
    for (int k = 0; k < 100000; k++) {
        const double u = plant_random_uniform(&r);
        least = fmin(least, u);
        most = fmax(most, u);
    }
    TEST_ASSERT_TRUE(least >= 0.0 && least < 1e-3 && most < 1.0 && most > 0.999);
}

/* Neighbouring seeds and streams share nothing. */
static void test_streams(void)
{
    plant_random a, b, c;
    plant_random_seed(&a, SEED, 1);
    plant_random_seed(&b, SEED, 2);
    plant_random_seed(&c, SEED + 1, 1);
    for (int k = 0; k < 1000; k++) {
        const uint64_t x = plant_random_bits(&a), y = plant_random_bits(&b), z = plant_random_bits(&c);
        TEST_ASSERT_TRUE(x != y && y != z && x != z);
    }
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(test_known_bits);
    RUN_TEST(test_normal);
    RUN_TEST(test_uniform);
    RUN_TEST(test_streams);
    return UNITY_END();
}
