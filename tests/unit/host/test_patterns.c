/* Pulse patterns against the three legs' waveforms in time, and against searches over all angles (sim_host/patterns). */
#include "patterns/carrier_ripple.h"
#include "patterns/pattern_search.h"
#include "patterns/patterns.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include <unity.h>

#define PI 3.14159265358979323846

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- The waveform ---- */

/* Level of leg a, 1 or -1, by the symmetries alone. */
static double level(const pattern_shape *s, double x)
{
    x = fmod(fmod(x, 2.0 * PI) + 2.0 * PI, 2.0 * PI);
    if (x > PI) {
        return -level(s, x - PI);
    }
    x = x > 0.5 * PI ? PI - x : x;
    double u = s->start;
    for (int k = 0; k < s->angles; k++) {
        u = x > s->angle[k] ? -u : u;
    }
    return u;
}

/* Voltage vector of the three legs. */
static double complex vector(const pattern_shape *s, double x)
{
    double complex u = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        u += 2.0 / 3.0 * level(s, x - leg * 2.0 * PI / 3.0) * cexp(I * (leg * 2.0 * PI / 3.0));
    }
    return u;
}

static const pattern_shape examples[] = {{1, 1, {1.42}},
                                         {2, -1, {0.15, 1.49}},
                                         {3, 1, {1.21, 1.32, 1.52}},
                                         {7, -1, {0.1, 0.3, 0.55, 0.8, 1.0, 1.2, 1.5}}};
enum { EXAMPLES = sizeof examples / sizeof examples[0], GRID = 60000 };

static void test_harmonics_are_those_of_the_waveform(void)
{
    for (int k = 0; k < EXAMPLES; k++) {
        for (int n = 1; n <= 97; n += 2) {
            double b = 0.0;
            for (int j = 0; j < GRID; j++) {
                const double x = 2.0 * PI * (j + 0.5) / GRID;
                b += 2.0 / GRID * level(&examples[k], x) * sin(n * x);
            }
            TEST_ASSERT_DOUBLE_WITHIN(2e-3, b, pattern_harmonic(&examples[k], n));
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, pattern_harmonic(&examples[k], 1) * PI / 4.0,
                                  pattern_index(&examples[k]));
    }
}

/* Programmed harmonic elimination as Mohan, Undeland and Robbins, "Power Electronics", print it: no harmonics 5 and 7. */
static void test_published_angles_eliminate_their_harmonics(void)
{
    const pattern_shape s = {2, 1, {16.24 * PI / 180.0, 22.06 * PI / 180.0}};
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.0, pattern_harmonic(&s, 5));
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.0, pattern_harmonic(&s, 7));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.188, pattern_harmonic(&s, 1));
}

/*
 * Mean square of the harmonic current over the fundamental's square, in a machine with L_q = ratio L_d whose stator flux leads the
 * d axis by `angle`: the flux integrated step by step, turned into the rotor's frame, divided by the inductances.
 */
static double rippled(const double complex *flux_change, double angle, double ratio, double *b_1)
{
    double complex flux = 0.0;
    double complex mean = 0.0;
    double complex fundamental = 0.0;
    static double complex at[GRID];
    for (int j = 0; j < GRID; j++) {
        flux += flux_change[j];
        at[j] = flux - 0.5 * flux_change[j];
        mean += at[j] / GRID;
        fundamental += at[j] * cexp(-I * (2.0 * PI * (j + 0.5) / GRID)) / GRID;
    }
    double sum = 0.0;
    for (int j = 0; j < GRID; j++) {
        const double complex turn = cexp(I * (2.0 * PI * (j + 0.5) / GRID));
        const double complex harmonic = at[j] - mean - fundamental * turn;
        const double complex dq = harmonic / (turn * fundamental / cabs(fundamental)) * cexp(I * angle);
        sum += creal(dq) * creal(dq) + cimag(dq) * cimag(dq) / (ratio * ratio);
    }
    *b_1 = cabs(fundamental);
    return sqrt(sum / GRID) / *b_1;
}

static pattern_weight weight_of(double angle, double ratio)
{
    const double c = cos(angle);
    const double s = sin(angle);
    return (pattern_weight){sqrt(c * c + s * s / (ratio * ratio)), sqrt(s * s + c * c / (ratio * ratio))};
}

static const double machine[][2] = {{0.0, 1.0}, {0.4, 1.8}, {1.1, 1.8}, {0.7, 0.6}};
enum { MACHINES = sizeof machine / sizeof machine[0] };

static void test_distortion_is_that_of_the_waveform(void)
{
    static double complex change[GRID];
    for (int k = 0; k < EXAMPLES; k++) {
        for (int j = 0; j < GRID; j++) {
            change[j] = 2.0 * PI / GRID * vector(&examples[k], 2.0 * PI * (j + 0.5) / GRID);
        }
        for (int n = 0; n < MACHINES; n++) {
            const pattern_weight w = weight_of(machine[n][0], machine[n][1]);
            double b_1;
            const double d = rippled(change, machine[n][0], machine[n][1], &b_1);
            TEST_ASSERT_DOUBLE_WITHIN(3e-3 * d, d, pattern_distortion(&examples[k], &w));
        }
    }
}

static void test_slopes_are_differences(void)
{
    const pattern_weight w = weight_of(0.4, 1.8);
    for (int k = 0; k < EXAMPLES; k++) {
        const pattern_shape *s = &examples[k];
        double at[PATTERN_ERRORS];
        double slope[PATTERN_ERRORS][PATTERN_ANGLES_MOST];
        double first[PATTERN_ANGLES_MOST];
        double unused[PATTERN_ANGLES_MOST];
        pattern_errors(s, &w, at, slope);
        (void)pattern_fundamental(s, first);
        for (int a = 0; a < s->angles; a++) {
            pattern_shape up = *s;
            pattern_shape down = *s;
            double above[PATTERN_ERRORS];
            double below[PATTERN_ERRORS];
            up.angle[a] += 1e-6;
            down.angle[a] -= 1e-6;
            pattern_errors(&up, &w, above, NULL);
            pattern_errors(&down, &w, below, NULL);
            for (int n = 0; n < PATTERN_ERRORS; n++) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, (above[n] - below[n]) / 2e-6, slope[n][a]);
            }
            TEST_ASSERT_DOUBLE_WITHIN(
                1e-8, (pattern_fundamental(&up, unused) - pattern_fundamental(&down, unused)) / 2e-6,
                first[a]);
        }
    }
}

/* ---- Space vectors ---- */

/* Three carrier periods a third of a turn at least, so that the mean of the flux is none of theirs. */
static void test_space_vectors_are_those_of_a_comparison_with_the_carrier(void)
{
    static double complex change[GRID];
    static const int pulses[] = {9, 15};
    for (int p = 0; p < 2; p++) {
        for (int n = 0; n < MACHINES; n++) {
            const pattern_weight w = weight_of(machine[n][0], machine[n][1]);
            double squares = 0.0;
            double index = 0.0;
            for (int position = 0; position < 8; position++) {
                for (int j = 0; j < GRID; j++) {
                    const double x = 2.0 * PI * (j + 0.5) / GRID;
                    const double in = x * pulses[p] / (2.0 * PI);
                    const double middle = (floor(in) + 0.5 + position / 8.0) * 2.0 * PI / pulses[p];
                    const double carrier = 4.0 * fabs(in - floor(in) - 0.5) - 1.0;
                    double u[3];
                    double most = -9.0;
                    double least = 9.0;
                    double complex v = 0.0;
                    for (int leg = 0; leg < 3; leg++) {
                        u[leg] = 0.9 * cos(middle - leg * 2.0 * PI / 3.0);
                        most = fmax(most, u[leg]);
                        least = fmin(least, u[leg]);
                    }
                    for (int leg = 0; leg < 3; leg++) {
                        v += (u[leg] - 0.5 * (most + least) > carrier ? 2.0 / 3.0 : -2.0 / 3.0) *
                             cexp(I * (leg * 2.0 * PI / 3.0));
                    }
                    change[j] = 2.0 * PI / GRID * v;
                }
                double b_1;
                const double d = rippled(change, machine[n][0], machine[n][1], &b_1);
                squares += d * d / 8.0;
                index += b_1 * PI / 4.0 / 8.0;
            }
            const double d = carrier_ripple(pulses[p], index, &w);
            TEST_ASSERT_DOUBLE_WITHIN(0.003 * d, sqrt(squares), d);
        }
    }
}

static void test_space_vectors_end_with_their_linear_range(void)
{
    const pattern_weight w = {1.0, 1.0};
    TEST_ASSERT_FALSE(isnan(carrier_ripple(15, 0.9, &w)));
    TEST_ASSERT_TRUE(isnan(carrier_ripple(15, 0.93, &w)));
}

/* ---- The minimum ---- */

/* The least distortion of all patterns of a family with `gap` on a grid; the index determines the last angle. */
static double searched(int angles, int start, double index, double gap, const pattern_weight *w)
{
    const int most = angles == 3 ? 600 : 40000;
    double best = INFINITY;
    for (int i = 0; i <= (angles > 2 ? most : 0); i++) {
        for (int j = 0; j <= (angles > 1 ? most : 0); j++) {
            pattern_shape s = {.angles = angles, .start = start};
            const double grid[2] = {0.5 * PI * j / most, 0.5 * PI * i / most};
            double rest = 1.0;
            for (int k = 1; k < angles; k++) {
                s.angle[k] = grid[angles - 1 - k];
                rest += (k % 2 == 0 ? -2.0 : 2.0) * cos(s.angle[k]);
            }
            const double cosine = 0.5 * (rest - start * index);
            if (fabs(cosine) > 1.0) {
                continue;
            }
            s.angle[0] = acos(cosine);
            bool fits = s.angle[0] >= gap && s.angle[angles - 1] <= 0.5 * (PI - gap);
            for (int k = 1; k < angles; k++) {
                fits = fits && s.angle[k] - s.angle[k - 1] >= gap;
            }
            best = fits ? fmin(best, pattern_distortion(&s, w)) : best;
        }
    }
    return best;
}

/* The least distortion of both families that some starts lead to. */
static double found(int angles, int start, double index, double gap, const pattern_weight *w)
{
    double best = INFINITY;
    unsigned seed = 7;
    for (int n = 0; n < 60; n++) {
        pattern_shape s = {.angles = angles, .start = start};
        double share[PATTERN_ANGLES_MOST + 1];
        for (int k = 0; k <= angles; k++) {
            seed = seed * 1664525u + 1013904223u;
            share[k] = ((double)(seed >> 8) + 1.0) / 16777216.0;
        }
        pattern_spread(&s, gap, share);
        if (pattern_minimum(&s, index, gap, w)) {
            best = fmin(best, pattern_distortion(&s, w));
        }
    }
    return best;
}

static void test_one_angle_is_what_the_index_says(void)
{
    const pattern_weight w = {1.0, 1.0};
    for (int n = 30; n <= 98; n += 4) {
        for (int start = -1; start <= 1; start += 2) {
            pattern_shape s = {.angles = 1, .start = start, .angle = {0.8}};
            TEST_ASSERT_TRUE(pattern_minimum(&s, 0.01 * n, 0.0, &w));
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, acos(0.5 * (1.0 - start * 0.01 * n)), s.angle[0]);
        }
    }
}

static void test_the_minimum_is_that_of_all_patterns(void)
{
    static const double index[] = {0.35, 0.7, 0.92};
    static const double gap[] = {0.0, 0.06};
    for (int n = 0; n < MACHINES; n += 2) {
        const pattern_weight w = weight_of(machine[n][0], machine[n][1]);
        for (int at = 0; at < 3; at++) {
            for (int g = 0; g < 2; g++) {
                for (int angles = 2; angles <= 3; angles++) {
                    for (int start = -1; start <= 1; start += 2) {
                        const double grid = searched(angles, start, index[at], gap[g], &w);
                        const double got = found(angles, start, index[at], gap[g], &w);
                        TEST_ASSERT_TRUE(got <= grid + 1e-7);
                        /* The grid of two free angles is coarse. */
                    }
                }
            }
        }
    }
}

/* ---- The table ---- */

static void check_rows(const patterns_result *r, double gap_of_six_step)
{
    int jumps = 0;
    for (int n = 0; n < r->rows; n++) {
        const patterns_row *row = &r->row[n];
        const double gap = gap_of_six_step * patterns_index(n) - 1e-9;
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, patterns_index(n), pattern_index(&row->shape));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, r->unit * pattern_distortion(&row->shape, &r->weight),
                                  row->distortion);
        TEST_ASSERT_TRUE(row->shape.angle[0] >= gap);
        TEST_ASSERT_TRUE(PI - 2.0 * row->shape.angle[row->shape.angles - 1] >= gap);
        for (int k = 1; k < row->shape.angles; k++) {
            TEST_ASSERT_TRUE(row->shape.angle[k] - row->shape.angle[k - 1] >= gap);
        }
        if (n + 1 < r->rows && row->joined) {
            pattern_shape half = row->shape;
            TEST_ASSERT_EQUAL_INT(half.start, r->row[n + 1].shape.start);
            for (int k = 0; k < half.angles; k++) {
                half.angle[k] = 0.5 * (half.angle[k] + r->row[n + 1].shape.angle[k]);
            }
            TEST_ASSERT_DOUBLE_WITHIN(r->index_error + 1e-12, patterns_index(n) + 0.005,
                                      pattern_index(&half));
        }
        jumps += n + 1 < r->rows && !row->joined;
    }
    TEST_ASSERT_EQUAL_INT(jumps, r->jumps);
    TEST_ASSERT_FALSE(r->row[r->rows - 1].joined);
    TEST_ASSERT_TRUE(r->index_error <= 1e-3);
}

static void test_tables_are_whole(void)
{
    static patterns_result r;
    error e = {0};
    for (int pulses = 3; pulses <= 15; pulses += 2) {
        const patterns_request free_of_times = {.pulses = pulses};
        TEST_ASSERT_TRUE(patterns_find(&free_of_times, &r, &e));
        check_rows(&r, 0.0);
        TEST_ASSERT_EQUAL_INT(PATTERNS_ROWS, r.rows);
        TEST_ASSERT_TRUE(r.jumps <= 8);
        for (int n = 0; n < r.rows; n++) {
            TEST_ASSERT_TRUE(isnan(r.row[n].space_vectors) || r.row[n].distortion < r.row[n].space_vectors);
        }
        const patterns_request with_times = {
            .pulses = pulses, .on_time_s = 8e-6, .dead_time_s = 2e-6, .six_step_Hz = 500.0};
        TEST_ASSERT_TRUE(patterns_find(&with_times, &r, &e));
        check_rows(&r, 2.0 * PI * 500.0 * 10e-6);
        TEST_ASSERT_TRUE(pulses < 15 || r.rows < PATTERNS_ROWS);
        TEST_ASSERT_TRUE(r.rows <= PATTERNS_ROWS && r.rows > 60);
    }
}

static void test_a_request_without_room_is_refused(void)
{
    static patterns_result r;
    error e = {0};
    const patterns_request asked = {.pulses = 15, .on_time_s = 1e-3, .six_step_Hz = 500.0};
    TEST_ASSERT_FALSE(patterns_find(&asked, &r, &e));
    TEST_ASSERT_NOT_NULL(strstr(e.text, "leaves no pattern of 15 pulses"));
}

/* The drive of 2019 at 250 Hz of 565 V: what five, seven and nine pulses are known to reach, in percent of its flux. */
static void test_the_2019_drive(void)
{
    static const double most[3][2] = {{5, 12.1}, {7, 10.2}, {9, 7.9}};
    static patterns_result r;
    error e = {0};
    motor m = motor_blank();
    m.R_ohm = 0.75;
    m.L_d_H = m.L_q_H = 5.2e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.5;
    m.u_dc_V = 565.0;
    for (int n = 0; n < 3; n++) {
        const patterns_request asked = {.m = &m, .pulses = (int)most[n][0]};
        TEST_ASSERT_TRUE(patterns_find(&asked, &r, &e));
        TEST_ASSERT_TRUE(100.0 * r.row[40].distortion <= most[n][1]);
        TEST_ASSERT_TRUE(100.0 * r.row[40].distortion >= 0.85 * most[n][1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, hypot(0.134, 5.2e-3 * 10.5 * sqrt(2.0)) / (5.2e-3 * 10.5 * sqrt(2.0)),
                                  r.unit);
        TEST_ASSERT_DOUBLE_WITHIN(0.5, 565.0 / (PI * PI * hypot(0.134, 5.2e-3 * 10.5 * sqrt(2.0))),
                                  r.asked.six_step_Hz);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_harmonics_are_those_of_the_waveform);
    RUN_TEST(test_published_angles_eliminate_their_harmonics);
    RUN_TEST(test_distortion_is_that_of_the_waveform);
    RUN_TEST(test_slopes_are_differences);
    RUN_TEST(test_space_vectors_are_those_of_a_comparison_with_the_carrier);
    RUN_TEST(test_space_vectors_end_with_their_linear_range);
    RUN_TEST(test_one_angle_is_what_the_index_says);
    RUN_TEST(test_the_minimum_is_that_of_all_patterns);
    RUN_TEST(test_tables_are_whole);
    RUN_TEST(test_a_request_without_room_is_refused);
    RUN_TEST(test_the_2019_drive);
    return UNITY_END();
}
