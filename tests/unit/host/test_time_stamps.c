/* Time stamps of few decimals: the control cycle and the stretches, as they are with all decimals. */
#include "data/recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unity.h>

enum { RUNS = 3, RUN_ROWS = 3000, ROWS = RUNS * RUN_ROWS };

static recording r;
static bool missing[ROWS]; /* cycles ahead of a row that were not written */

void setUp(void)
{
    r = (recording){.rows = ROWS};
    r.t_s = malloc(ROWS * sizeof *r.t_s);
    r.run = malloc(ROWS * sizeof *r.run);
    TEST_ASSERT_TRUE(r.t_s != NULL && r.run != NULL);
    for (size_t k = 0; k < ROWS; k++) {
        missing[k] = false;
    }
}

void tearDown(void)
{
    recording_free(&r);
}

/* Three runs of even cycles at f_Hz, in stamps of so many decimals; `lost` cycles are missing where it says. */
static void stamp(double f_Hz, int decimals, int lost)
{
    const double per_second = pow(10.0, decimals);
    double cycle = 0.37; /* a recording begins anywhere between two stamps */
    for (size_t k = 0; k < ROWS; k++) {
        const size_t run = k / RUN_ROWS;
        cycle += k > 0 && k % RUN_ROWS == 0 ? 200.0 : 0.0;
        cycle += missing[k] ? lost : 0.0;
        r.t_s[k] = nearbyint(cycle / f_Hz * per_second) / per_second;
        r.run[k] = (long)run + 1;
        cycle += 1.0;
    }
    TEST_ASSERT_TRUE(recording_find_stretches(&r));
}

static void expect_cycle(double f_Hz, int decimals, double relative)
{
    char words[100];
    snprintf(words, sizeof words, "%g Hz, %d decimals: T = %.6g s in %zu stretches", f_Hz, decimals, r.T_s,
             r.stretches);
    TEST_ASSERT_TRUE_MESSAGE(fabs(r.T_s * f_Hz - 1.0) < relative, words);
}

static void for_each_rate(void (*expect)(double f_Hz, int decimals))
{
    static const double rates[] = {4000.0, 7000.0, 8000.0, 10000.0, 16000.0};
    for (size_t n = 0; n < sizeof rates / sizeof rates[0]; n++) {
        for (int decimals = 4; decimals <= 7; decimals++) {
            if (pow(10.0, -decimals) <= 1.0 / rates[n]) {
                expect(rates[n], decimals);
            }
        }
    }
}

static void even(double f_Hz, int decimals)
{
    stamp(f_Hz, decimals, 0);
    expect_cycle(f_Hz, decimals, 2e-5);
    TEST_ASSERT_EQUAL(RUNS, r.stretches);
    for (size_t s = 0; s < RUNS; s++) {
        TEST_ASSERT_EQUAL(s * RUN_ROWS, r.stretch[s].first);
        TEST_ASSERT_EQUAL(RUN_ROWS, r.stretch[s].count);
        TEST_ASSERT_EQUAL(s + 1, r.stretch[s].run);
    }
}

static void test_even_cycles(void)
{
    for_each_rate(even);
}

/* Gaps of one cycle and of many, at rows that no period divides. */
static void gaps_of(double f_Hz, int decimals, int lost)
{
    static const size_t at[] = {701, 1502, 3907, 6403, 8201};
    enum { GAPS = sizeof at / sizeof at[0] };
    for (size_t n = 0; n < GAPS; n++) {
        missing[at[n]] = true;
    }
    stamp(f_Hz, decimals, lost);
    expect_cycle(f_Hz, decimals, 5e-5);
    char words[100];
    snprintf(words, sizeof words, "%g Hz, %d decimals, %d lost: %zu stretches", f_Hz, decimals, lost,
             r.stretches);
    TEST_ASSERT_EQUAL_MESSAGE(RUNS + GAPS, r.stretches, words);
    /* The cut is at the gap; if rounding hides it, one row next to it. */
    size_t found = 0;
    for (size_t s = 0; s < r.stretches; s++) {
        for (size_t n = 0; n < GAPS; n++) {
            const size_t first = r.stretch[s].first;
            found += first + 1 >= at[n] && first <= at[n] + 8;
        }
    }
    TEST_ASSERT_EQUAL_MESSAGE(GAPS, found, words);
}

static void one_lost(double f_Hz, int decimals)
{
    gaps_of(f_Hz, decimals, 1);
}

static void many_lost(double f_Hz, int decimals)
{
    gaps_of(f_Hz, decimals, 57);
}

static void test_gaps_of_one_cycle(void)
{
    for_each_rate(one_lost);
}

static void test_gaps_of_many_cycles(void)
{
    for_each_rate(many_lost);
}

/* Stamps that jitter, as a PC's do, lie on no ladder: steps are judged one by one, as ever. */
static void test_jitter_is_no_rounding(void)
{
    stamp(8000.0, 9, 0);
    unsigned state = 7; /* seed; a linear congruential generator */
    for (size_t k = 0; k < ROWS; k++) {
        state = state * 1664525u + 1013904223u;
        r.t_s[k] = nearbyint((r.t_s[k] + 2e-5 * (double)(state >> 16) / 65536.0) * 1e6) / 1e6;
    }
    TEST_ASSERT_TRUE(recording_find_stretches(&r));
    TEST_ASSERT_EQUAL(RUNS, r.stretches);
    expect_cycle(8000.0, 6, 5e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_even_cycles);
    RUN_TEST(test_gaps_of_one_cycle);
    RUN_TEST(test_gaps_of_many_cycles);
    RUN_TEST(test_jitter_is_no_rounding);
    return UNITY_END();
}
