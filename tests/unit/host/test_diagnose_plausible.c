/*
 * Recordings that cannot be what they say: each spoiled in one way, refused with a line that names the way.
 */
#include "diagnose/check/current_sum.h"
#include "diagnose/check/polarity.h"
#include "diagnose/check/wiring.h"
#include "diagnose/diagnose.h"
#include "diagnose_bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

static recording r;
static motor file;

void setUp(void)
{
    bench b = {.m = bench_motor(), .noise_A = 0.017, .seed = 7};
    file = bench_motor();
    r = bench_record(&b);
}

void tearDown(void)
{
    recording_free(&r);
}

static void refused_with(const char *words)
{
    diagnosis d;
    error e = {0};
    diagnose_options options = {0};
    r.path = "bench.csv";
    bool ok = diagnose(&d, &r, &file, &options, &e);
    TEST_ASSERT_FALSE_MESSAGE(ok, words);
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, words), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "bench.csv"), e.text);
    TEST_ASSERT_NULL(strchr(e.text, '\n'));
}

static void scale(double *x, double by)
{
    for (size_t k = 0; k < r.rows; k++) {
        x[k] *= by;
    }
}

static void swap(double *x[3], int a, int b)
{
    double *keep = x[a];
    x[a] = x[b];
    x[b] = keep;
}

static void swapped_phases(void)
{
    swap(r.i_A, 1, 2);
    refused_with("current columns of phases B and C look swapped");
}

static void swapped_voltages(void)
{
    swap(r.u_V, 0, 2);
    refused_with("voltages or duties of phases A and C look swapped");
}

static void swapped_motor_cables(void)
{
    swap(r.i_A, 0, 1);
    swap(r.u_V, 0, 1);
    refused_with("two motor phases are swapped");
}

static void wrong_direction(void)
{
    scale(r.theta_e_rad, -1.0);
    scale(r.omega_e_rad_s, -1.0);
    refused_with("the angle counts against the phases");
}

static void angle_against_speed(void)
{
    scale(r.theta_e_rad, -1.0);
    refused_with("opposite sign");
}

static void wrong_current_sign(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.i_A[x], -1.0);
    }
    refused_with("wrong sign");
}

static void inverted_voltages(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.u_V[x], -1.0);
    }
    refused_with("voltages or duties look inverted");
}

/* Each phase in turn: named with three sensors by their sum, with two by the voltage equation. */
static void negated_column(void)
{
    static const char *const words[] = {"column of phase A looks negated", "column of phase B looks negated",
                                        "column of phase C looks negated"};
    for (int x = 0; x < 3; x++) {
        scale(r.i_A[x], -1.0);
        refused_with(words[x]);
        refused_with("the three sum to zero");
        scale(r.i_A[x], -1.0);
    }
    r.i_c_measured = false;
    for (int x = 0; x < 2; x++) {
        scale(r.i_A[x], -1.0);
        for (size_t k = 0; k < r.rows; k++) {
            r.i_A[2][k] = -r.i_A[0][k] - r.i_A[1][k];
        }
        refused_with(words[x]);
        refused_with("the residual of the voltage equation is");
        scale(r.i_A[x], -1.0);
    }
}

static void dead_column(void)
{
    scale(r.i_A[1], 0.0);
    refused_with("column of phase B looks dead");
}

static void column_in_another_unit(void)
{
    scale(r.i_A[2], 1000.0);
    /* So that the checks of the phase currents and of the inductances do not come first. */
    file.I_rated_A_rms *= 1000.0;
    file.L_d_H *= 1e-3;
    file.L_q_H *= 1e-3;
    refused_with("column of phase C looks scaled by 1e+03");
}

/* What the cause current_gain covers is not refused by the sum, one sensor or several. */
static void gains_are_left_to_the_search(void)
{
    static const double gain[][3] = {
        {0.6, 1, 1}, {1, 1.6, 1}, {1.6, 0.6, 1}, {0.6, 0.6, 1.6}, {1.6, 1.6, 0.6}};
    for (size_t n = 0; n < sizeof gain / sizeof gain[0]; n++) {
        error e = {0};
        for (int x = 0; x < 3; x++) {
            scale(r.i_A[x], gain[n][x]);
        }
        TEST_ASSERT_TRUE_MESSAGE(check_current_sum(&r, &e) && check_polarity(&r, &e), e.text);
        for (int x = 0; x < 3; x++) {
            scale(r.i_A[x], 1.0 / gain[n][x]);
        }
    }
}

static double *filled(double value)
{
    double *x = calloc(r.rows, sizeof *x);
    TEST_ASSERT_NOT_NULL(x);
    for (size_t k = 0; k < r.rows; k++) {
        x[k] = value;
    }
    return x;
}

static void dead_link(void)
{
    r.u_dc_V = filled(565.0);
    r.u_dc_V[4711] = 0.0;
    refused_with("bench.csv:4713: u_dc_V = 0");
    r.u_dc_V[4711] = 60000.0;
    refused_with("bench.csv:4713: u_dc_V = 60000, but the median is 565");
}

static void duties_in_other_units(void)
{
    for (int x = 0; x < 3; x++) {
        r.duty[x] = filled(50.0 + x);
    }
    refused_with("percent");
    scale(r.duty[1], 100.0);
    refused_with("compare counts");
}

static void quarter_turn(void)
{
    for (size_t k = 0; k < r.rows; k++) {
        r.theta_e_rad[k] += 1.5707963267948966;
    }
    refused_with("degrees from the recorded d axis");
}

static void milliamperes(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.i_A[x], 1000.0);
    }
    refused_with("milliamperes");
}

static void millivolts(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.u_V[x], 1000.0);
    }
    refused_with("millivolts");
}

static void milliseconds(void)
{
    scale(r.t_s, 1000.0);
    r.T_s *= 1000.0;
    refused_with("milliseconds");
}

static void degrees(void)
{
    scale(r.theta_e_rad, 57.29577951308232);
    refused_with("degrees; expected radians");
}

static void rpm(void)
{
    scale(r.omega_e_rad_s, 60.0 / 6.283185307179586 / 3.0);
    refused_with("revolutions per minute");
}

static void nothing_flows(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.i_A[x], 0.0);
    }
    refused_with("no excitation");
}

static void all_zero(void)
{
    for (int x = 0; x < 3; x++) {
        scale(r.i_A[x], 0.0);
        scale(r.u_V[x], 0.0);
    }
    refused_with("all currents and voltages are zero");
}

static void too_short(void)
{
    r.stretches = 1;
    r.rows = r.stretch[0].count = 40;
    refused_with("a diagnosis needs 200");
}

static void another_motor(void)
{
    file.R_ohm = 5.0;
    file.L_d_H = file.L_q_H = 0.03;
    file.psi_f_Wb = 0.6;
    refused_with("another motor");
}

/*
 * One speed and one current: only what noise does to the current's slope tells of L, and the voltages hardly follow that. So another L
 * fits a little better.
 */
static void one_speed_is_no_other_motor(void)
{
    const double omega = 900.0;
    const vec_dq i = {-1.0, 4.0};
    const vec_dq u = {file.R_ohm * i.d - omega * file.L_q_H * i.q,
                      file.R_ohm * i.q + omega * (file.L_d_H * i.d + file.psi_f_Wb)};
    uint64_t state = 5;
    vec_ab noise = {0.0, 0.0};
    error e = {0};
    r.path = "bench.csv";
    r.stretches = 1;
    r.rows = r.stretch[0].count = BENCH_ROWS;
    for (size_t k = 0; k < r.rows; k++) {
        const vec_ab next = {0.02 * bench_normal(&state), 0.02 * bench_normal(&state)};
        const double theta = fmod(omega * r.T_s * (double)k, 6.283185307179586);
        const vec_ab clean = vec_to_ab(i, rotor_at(theta));
        const vec_ab mean = vec_to_ab(u, rotor_at(theta + 0.5 * omega * r.T_s));
        const double slope = 0.1 * file.L_d_H / r.T_s;
        r.theta_e_rad[k] = theta;
        r.omega_e_rad_s[k] = omega;
        for (int x = 0; x < 3; x++) {
            r.i_A[x][k] = vec_phase((vec_ab){clean.alpha + noise.alpha, clean.beta + noise.beta}, x);
            r.u_V[x][k] = vec_phase((vec_ab){mean.alpha + slope * (next.alpha - noise.alpha),
                                             mean.beta + slope * (next.beta - noise.beta)},
                                    x);
        }
        noise = next;
    }
    TEST_ASSERT_TRUE_MESSAGE(check_wiring(&r, &file, true, &e), e.text);
    file.psi_f_Wb *= 4.0;
    TEST_ASSERT_FALSE(check_wiring(&r, &file, true, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "another motor"), e.text);
}

static void another_cycle(void)
{
    file.f_pwm_Hz = 10000.0;
    refused_with("f_pwm_Hz");
}

static void no_current_in_the_rows_that_are_held_out(void)
{
    r.rows = 260;
    r.stretches = 1;
    r.stretch[0].count = 260;
    for (size_t k = 80; k < r.rows; k++) {
        r.i_A[0][k] = r.i_A[1][k] = r.i_A[2][k] = 0.0;
    }
    refused_with("no current flows in the held-out rows");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(no_current_in_the_rows_that_are_held_out);
    RUN_TEST(swapped_phases);
    RUN_TEST(swapped_voltages);
    RUN_TEST(swapped_motor_cables);
    RUN_TEST(wrong_direction);
    RUN_TEST(angle_against_speed);
    RUN_TEST(wrong_current_sign);
    RUN_TEST(inverted_voltages);
    RUN_TEST(negated_column);
    RUN_TEST(dead_column);
    RUN_TEST(column_in_another_unit);
    RUN_TEST(gains_are_left_to_the_search);
    RUN_TEST(dead_link);
    RUN_TEST(duties_in_other_units);
    RUN_TEST(quarter_turn);
    RUN_TEST(milliamperes);
    RUN_TEST(millivolts);
    RUN_TEST(milliseconds);
    RUN_TEST(degrees);
    RUN_TEST(rpm);
    RUN_TEST(nothing_flows);
    RUN_TEST(all_zero);
    RUN_TEST(too_short);
    RUN_TEST(another_motor);
    RUN_TEST(one_speed_is_no_other_motor);
    RUN_TEST(another_cycle);
    return UNITY_END();
}
