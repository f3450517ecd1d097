/*
 * The end of the current sensors' range (diagnose/identify/row_clips.h): found where a current is cut there, not where one
 * peaks or rests; its neighbouring rows are not fitted, and other causes are named.
 */
#include "diagnose/identify/row_clips.h"
#include "diagnose_look.h"

#include <math.h>
#include <string.h>
#include <unity.h>

enum { ROWS = 2000 };

static double phase[3][ROWS];
static recording made;

void setUp(void)
{
    made = (recording){.rows = ROWS, .i_c_measured = true};
    for (size_t x = 0; x < 3; x++) {
        made.i_A[x] = phase[x];
    }
}

void tearDown(void)
{
}

static double cut_at(double i_A, double end_A)
{
    return fmin(fmax(i_A, -end_A), end_A);
}

/* Three sines of amplitude 1 that a converter of so many steps to an amplitude shows, cut at an end. */
static void fill(double steps, double end_A)
{
    for (size_t k = 0; k < ROWS; k++) {
        for (size_t x = 0; x < 3; x++) {
            const double i_A = sin(0.037 * (double)k - 2.0943951023931953 * (double)x);
            phase[x][k] = cut_at(round(steps * i_A) / steps, end_A);
        }
    }
}

static void a_current_that_is_cut_has_an_end(void)
{
    for (double end_A = 0.88; end_A < 0.97; end_A += 0.02) {
        fill(4096.0, end_A);
        TEST_ASSERT_EQUAL_DOUBLE(end_A, row_clips_end_A(&made));
        for (size_t k = 0; k < ROWS; k++) {
            const double most_A = fmax(fabs(phase[0][k]), fmax(fabs(phase[1][k]), fabs(phase[2][k])));
            TEST_ASSERT_EQUAL_INT(most_A > 0.999 * end_A, row_clips_at(&made, k, end_A));
        }
    }
}

/* A run that has lost its operating point: most of its rows have two or three sensors at the end, some at either one. */
static void currents_far_beyond_the_end_have_one(void)
{
    for (double end_A = 0.25; end_A < 0.88; end_A += 0.1) {
        fill(4096.0, end_A);
        for (size_t k = 0; k < ROWS / 2; k++) {
            for (size_t x = 0; x < 3; x++) {
                phase[x][k] = 0.2 * sin(0.037 * (double)k - 2.0943951023931953 * (double)x);
            }
        }
        TEST_ASSERT_EQUAL_DOUBLE(end_A, row_clips_end_A(&made));
    }
}

static void peaks_have_none_however_coarse_the_converter(void)
{
    for (double steps = 16.0; steps < 5000.0; steps *= 2.0) {
        fill(steps, 2.0);
        TEST_ASSERT_EQUAL_DOUBLE(INFINITY, row_clips_end_A(&made));
    }
}

/* One phase alone, in one direction, at one peak that is higher than all others. */
static void one_peak_that_is_cut_has_an_end(void)
{
    fill(4096.0, 2.0);
    for (size_t k = 0; k < ROWS; k++) {
        for (size_t x = 0; x < 3; x++) {
            phase[x][k] = fmin((k > 935 && k < 963 ? 1.0 : 0.95) * phase[x][k], x == 1 ? 0.98 : 2.0);
        }
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.98, row_clips_end_A(&made));
}

/* A loose contact shows the end of the range where the current is below: the sum does not fall short. */
static void a_reading_that_is_too_large_has_none(void)
{
    fill(4096.0, 2.0);
    for (size_t k = 7; k < ROWS; k += 97) {
        phase[1][k] = 1.2;
    }
    TEST_ASSERT_EQUAL_DOUBLE(INFINITY, row_clips_end_A(&made));
}

/* Steps of one size in both directions, at rest between them: the three add up. */
static void a_current_that_rests_has_none(void)
{
    for (size_t k = 0; k < ROWS; k++) {
        const double d = (k / 250) % 2 == 0 ? 3.0 : -3.0;
        phase[0][k] = d;
        phase[1][k] = -0.5 * d + 0.001 * sin(0.7 * (double)k);
        phase[2][k] = -0.5 * d + 0.001 * cos(0.4 * (double)k);
    }
    TEST_ASSERT_EQUAL_DOUBLE(INFINITY, row_clips_end_A(&made));
}

/* Without a third sensor nothing tells that from a current at rest. */
static void two_sensors_have_none(void)
{
    fill(4096.0, 0.8);
    made.i_c_measured = false;
    for (size_t k = 0; k < ROWS; k++) {
        phase[2][k] = -phase[0][k] - phase[1][k];
    }
    TEST_ASSERT_EQUAL_DOUBLE(INFINITY, row_clips_end_A(&made));
}

static const double END_A = 6.5;

/* A drive with another resistance, diagnosed: of one operating point the larger currents are cut, or none. Returns how many rows are. */
static size_t diagnose_cut_at(double end_A, diagnosis *d)
{
    bench good = {.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
    const motor file = bench_motor();
    good.m.R_ohm = 1.2;
    recording r = bench_record(&good);
    size_t cut = 0;
    for (size_t k = 0; k < r.rows; k++) {
        bool here = false;
        for (size_t x = 0; x < 3; x++) {
            here = here || fabs(r.i_A[x][k]) > 0.999 * end_A;
            r.i_A[x][k] = cut_at(r.i_A[x][k], end_A);
        }
        cut += here;
    }
    error e = {0};
    const diagnose_options options = {.series = true};
    TEST_ASSERT_TRUE_MESSAGE(diagnose(d, &r, &file, &options, &e), e.text);
    TEST_ASSERT_EQUAL_size_t(cut, d->rows_clipped);
    TEST_ASSERT_TRUE(d->rows_used < r.rows - cut);
    recording_free(&r);
    return cut;
}

static void other_causes_are_named_as_well(void)
{
    diagnosis d;
    const size_t cut = diagnose_cut_at(END_A, &d);
    TEST_ASSERT_TRUE(cut > 50 && cut < d.rows / 6);
    one_cause(&d, "resistance");
    holds(&d.cause[0], "R", 1.2);
    diagnosis_free(&d);
}

/* What the sensors show of them is not what flows. */
static void cut_rows_do_not_count_in_open_loop(void)
{
    diagnosis whole;
    diagnosis d;
    TEST_ASSERT_EQUAL_size_t(0, diagnose_cut_at(INFINITY, &whole));
    diagnose_cut_at(END_A, &d);
    TEST_ASSERT_DOUBLE_WITHIN(0.25 * whole.free_extended_percent, whole.free_extended_percent,
                              d.free_extended_percent);
    diagnosis_free(&whole);
    diagnosis_free(&d);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_current_that_is_cut_has_an_end);
    RUN_TEST(currents_far_beyond_the_end_have_one);
    RUN_TEST(peaks_have_none_however_coarse_the_converter);
    RUN_TEST(one_peak_that_is_cut_has_an_end);
    RUN_TEST(a_reading_that_is_too_large_has_none);
    RUN_TEST(a_current_that_rests_has_none);
    RUN_TEST(two_sensors_have_none);
    RUN_TEST(other_causes_are_named_as_well);
    RUN_TEST(cut_rows_do_not_count_in_open_loop);
    return UNITY_END();
}
