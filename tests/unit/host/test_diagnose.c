/*
 * The diagnosis on the bench of diagnose_bench.h: right causes with intervals that hold the truth, nothing on
 * clean recordings, nothing invented where no hypothesis fits, and no name for what it was asked to skip.
 */
#include "diagnose_look.h"
#include "model/flux_map.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

static bench good;

void setUp(void)
{
    good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260101};
}

void tearDown(void)
{
}

static void a_clean_recording_has_no_cause_and_its_floor_is_the_noise(void)
{
    for (int two = 0; two < 2; two++) {
        good.two_sensors = two == 1;
        diagnosis d = look(&good, NULL);
        TEST_ASSERT_EQUAL_size_t(0, d.causes);
        TEST_ASSERT_EQUAL_INT(VERDICT_CLEAN, d.verdict);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * good.noise_A, good.noise_A, d.sensor_noise_A);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * d.nominal, d.nominal, d.noise_floor);
        TEST_ASSERT_TRUE(d.rows_held_out > d.rows_used / 5 && d.rows_held_out < d.rows_used / 2);
        diagnosis_free(&d);
    }
}

static void resistance_is_named_although_noise_is_on_both_sides(void)
{
    good.m.R_ohm = 1.2;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "resistance");
    holds(&d.cause[0], "R", 1.2);
    diagnosis_free(&d);
    good.noise_A = 0.1; /* six times the noise must not bias it */
    d = look(&good, NULL);
    one_cause(&d, "resistance");
    holds(&d.cause[0], "R", 1.2);
    diagnosis_free(&d);
}

static void flux_inductance_and_saliency_are_distinguished(void)
{
    good.m.psi_f_Wb = 0.19;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "flux_linkage");
    holds(&d.cause[0], "psi_f", 0.19);
    diagnosis_free(&d);
    good.m = bench_motor();
    good.m.L_d_H *= 0.9;
    good.m.L_q_H *= 0.9;
    d = look(&good, NULL);
    one_cause(&d, "inductance");
    holds(&d.cause[0], "L", 0.9 * 0.0095);
    diagnosis_free(&d);
    good.m = bench_motor();
    good.m.L_d_H = 0.0088;
    good.m.L_q_H = 0.0098;
    d = look(&good, NULL);
    one_cause(&d, "saliency");
    holds(&d.cause[0], "L_d", 0.0088);
    holds(&d.cause[0], "L_q", 0.0098);
    diagnosis_free(&d);
}

static void an_inductance_of_one_phase_or_of_all_is_named(void)
{
    static const double added_H[][3] = {{0.0, 0.0008, 0.0}, {-0.0006, 0.0, 0.0}, {0.0004, -0.0007, 0.0005}};
    for (size_t k = 0; k < sizeof added_H / sizeof *added_H; k++) {
        good.m.ext.has[CAUSE_PHASE_INDUCTANCE] = true;
        memcpy(good.m.ext.dL_H, added_H[k], sizeof added_H[k]);
        diagnosis d = look(&good, NULL);
        one_cause(&d, "phase_inductance");
        holds(&d.cause[0], "dL_a", added_H[k][0]);
        holds(&d.cause[0], "dL_b", added_H[k][1]);
        holds(&d.cause[0], "dL_c", added_H[k][2]);
        diagnosis_free(&d);
    }
    /* Three alike are the machine's own inductances. */
    const double alike_H[3] = {0.0009, 0.0009, 0.0009};
    memcpy(good.m.ext.dL_H, alike_H, sizeof alike_H);
    diagnosis d = look(&good, NULL);
    one_cause(&d, "saliency");
    holds(&d.cause[0], "L_d", bench_motor().L_d_H + 0.0009);
    holds(&d.cause[0], "L_q", bench_motor().L_q_H + 0.0009);
    diagnosis_free(&d);
}

/* Lost to the legs, or added by a compensation that takes too much for lost. An on-resistance that the file does not
 * know looks like a part of it: whether it is named or not, the interval holds the truth. */
static void a_dead_time_of_either_sign_is_named(void)
{
    static const double v_dead_V[] = {4.0, -3.0};
    for (size_t k = 0; k < 4; k++) {
        good.m.ext.has[CAUSE_DEAD_TIME] = true;
        good.m.ext.v_dead_V = v_dead_V[k % 2];
        good.m.ext.i_knee_A = 0.2;
        good.m.R_ohm = (k < 2 ? 1.0 : 1.08) * bench_motor().R_ohm;
        diagnosis d = look(&good, NULL);
        TEST_ASSERT_TRUE(d.causes >= 1);
        TEST_ASSERT_EQUAL_STRING("dead_time", d.cause[0].id);
        holds(&d.cause[0], "v_dead", v_dead_V[k % 2]);
        if (k < 2) {
            one_cause(&d, "dead_time");
        } else if (d.causes == 2) {
            TEST_ASSERT_EQUAL_STRING("resistance", d.cause[1].id);
            holds(&d.cause[1], "R", good.m.R_ohm);
        }
        diagnosis_free(&d);
    }
}

/* A machine whose iron is no law of the diagnosis: named by its map, to the floor, and with a gain. */
static void iron_that_saturates_is_a_flux_map(void)
{
    good.bend_d = 0.1;
    good.bend_q = 0.5;
    good.bend_cross = 0.3;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_TRUE(d.gain > 1.6);
    TEST_ASSERT_EQUAL_size_t(1, d.causes);
    TEST_ASSERT_EQUAL_STRING("saturation_dq", d.cause[0].id);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict); /* by a law that is not quite the machine's */
    TEST_ASSERT_TRUE(d.extended_motor.ext.has[CAUSE_SATURATION_DQ]);
    /* At no current the inductances are the file's. */
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * good.m.L_d_H, good.m.L_d_H, d.extended_motor.ext.L_d0_H);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * good.m.L_q_H, good.m.L_q_H, d.extended_motor.ext.L_q0_H);
    /* And the map's inductance is that of iron wherever a current was recorded. */
    for (double turn = 0.0; turn < 1.0; turn += 0.05) {
        const vec_dq i = {4.0 * cos(VEC_TWO_PI * turn), 5.0 * sin(VEC_TWO_PI * turn)};
        TEST_ASSERT_TRUE(flux_map_is_physical(&d.extended_drive, i, 0.02));
    }
    diagnosis_free(&d);
}

static void everything_scaled_alike_is_one_voltage_gain(void)
{
    good.m.ext.has[CAUSE_VOLTAGE_GAIN] = true;
    good.m.ext.k_u = 0.96;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "voltage_gain");
    holds(&d.cause[0], "k_u", 0.96);
    diagnosis_free(&d);
}

/* Parameter tolerance: the machine is off by a share of the reporting threshold in every value of the file. */
static void last_digits(bench *b, double share)
{
    b->m.R_ohm *= 1.0 - 0.02 * share;
    b->m.L_d_H *= 1.0 + 0.008 * share;
    b->m.L_q_H *= 1.0 + 0.006 * share;
    b->m.psi_f_Wb *= 1.0 + 0.004 * share;
    b->m.ext.has[CAUSE_VOLTAGE_GAIN] = true;
    b->m.ext.k_u *= 1.0 - 0.003 * share;
}

/* Scaling voltage, R, L and psi alike changes nothing, so that two of them may stand for small deviations of the others. */
static void one_error_within_the_tolerance_of_the_rest_is_one_cause(void)
{
    static const double shares[] = {-0.25, 0.6};
    for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
        for (int which = 0; which < 5; which++) {
            static const char *const id[] = {NULL, "resistance", "inductance", "flux_linkage",
                                             "voltage_gain"};
            good = (bench){.m = bench_motor(), .noise_A = 0.017, .seed = 20260101 + (unsigned long)which};
            good.m.ext.k_u = which == 4 ? 0.9 : 1.0;
            last_digits(&good, shares[k]);
            good.m.R_ohm *= which == 1 ? 1.3 : 1.0;
            good.m.L_d_H *= which == 2 ? 0.9 : 1.0;
            good.m.L_q_H *= which == 2 ? 0.9 : 1.0;
            good.m.psi_f_Wb *= which == 3 ? 0.95 : 1.0;
            diagnosis d = look(&good, NULL);
            if (which == 0) {
                TEST_ASSERT_EQUAL_size_t(0, d.causes);
            } else {
                TEST_ASSERT_EQUAL_size_t(1, d.causes);
                TEST_ASSERT_EQUAL_STRING(id[which], d.cause[0].id);
                TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict);
            }
            diagnosis_free(&d);
        }
    }
}

/* Named or not, what the recording says of the machine holds the truth, and what is equivalent to a flux is reported. */
static void estimates_hold_the_truth_and_equivalents_are_reported(void)
{
    good.m.psi_f_Wb = 0.19;
    last_digits(&good, 0.4);
    diagnosis d = look(&good, NULL);
    const double truth[] = {good.m.R_ohm, good.m.L_d_H, good.m.L_q_H, good.m.psi_f_Wb, 0.0, 0.0};
    TEST_ASSERT_EQUAL_size_t(1, d.causes);
    TEST_ASSERT_TRUE(d.cause[0].trades >= 2);
    TEST_ASSERT_TRUE(d.cause[0].probability > 0.99 && d.cause[0].probability <= 1.0);
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        TEST_ASSERT_TRUE_MESSAGE(d.estimate[k].excited, d.estimate[k].name);
        TEST_ASSERT_TRUE_MESSAGE(d.estimate[k].low <= truth[k] && truth[k] <= d.estimate[k].high,
                                 d.estimate[k].name);
    }
    const diagnosis_covariance *c = &d.covariance;
    TEST_ASSERT_EQUAL_size_t(4, c->count);
    for (size_t i = 0; i < c->count; i++) {
        TEST_ASSERT_TRUE(c->value[i][i] > 0.0);
        for (size_t j = 0; j < i; j++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * sqrt(c->value[i][i] * c->value[j][j]), c->value[i][j],
                                      c->value[j][i]);
            TEST_ASSERT_TRUE(c->value[i][j] * c->value[i][j] < c->value[i][i] * c->value[j][j]);
        }
    }
    diagnosis_free(&d);
}

static void a_voltage_that_acts_late_is_found(void)
{
    good.m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
    good.m.ext.voltage_delay_cycles = 1.0;
    diagnosis d = look(&good, NULL);
    one_cause(&d, "voltage_delay");
    holds(&d.cause[0], "cycles", 1.0);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, d.cause[0].parameter[0].value);
    diagnosis_free(&d);
}

/* Whole cycles, or a part with R and L that are wrong as well: the voltage that acts first in a cycle decays for longer, and without
 * that R would be off. */
static void a_voltage_that_acts_parts_of_a_cycle_late_is_found(void)
{
    static const double cycles[] = {0.5, 1.5, 0.2, 2.0};
    for (size_t k = 0; k < sizeof cycles / sizeof *cycles; k++) {
        good.m.ext.has[CAUSE_VOLTAGE_DELAY] = true;
        good.m.ext.voltage_delay_cycles = cycles[k];
        diagnosis d = look(&good, NULL);
        one_cause(&d, "voltage_delay");
        holds(&d.cause[0], "cycles", cycles[k]);
        TEST_ASSERT_DOUBLE_WITHIN(0.003, cycles[k], d.cause[0].parameter[0].value);
        diagnosis_free(&d);
    }
    good.m.ext.voltage_delay_cycles = 0.5;
    good.m.R_ohm = 1.8;
    good.m.L_d_H *= 0.9;
    good.m.L_q_H *= 0.9;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(3, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_EXPLAINED, d.verdict);
    for (size_t k = 0; k < d.causes; k++) {
        if (strcmp(d.cause[k].id, "resistance") == 0) {
            holds(&d.cause[k], "R", 1.8);
        } else if (strcmp(d.cause[k].id, "inductance") == 0) {
            holds(&d.cause[k], "L", 0.9 * 0.0095);
        } else {
            TEST_ASSERT_EQUAL_STRING("voltage_delay", d.cause[k].id);
            holds(&d.cause[k], "cycles", 0.5);
        }
    }
    diagnosis_free(&d);
}

static void two_causes_at_once_are_both_found(void)
{
    good.m.ext.has[CAUSE_ANGLE_OFFSET] = true;
    good.m.ext.theta_0_rad = -0.03;
    good.m.ext.has[CAUSE_CURRENT_GAIN] = true;
    good.m.ext.g[0] = 1.03;
    good.m.ext.g[1] = 0.98;
    good.m.ext.g[2] = 1.0;
    diagnosis d = look(&good, NULL);
    TEST_ASSERT_EQUAL_size_t(2, d.causes);
    for (size_t k = 0; k < 2; k++) {
        if (strcmp(d.cause[k].id, "angle_offset") == 0) {
            holds(&d.cause[k], "theta_0", -0.03);
        } else {
            TEST_ASSERT_EQUAL_STRING("current_gain", d.cause[k].id);
            holds(&d.cause[k], "g_a", 1.03);
            holds(&d.cause[k], "g_b", 0.98);
            holds(&d.cause[k], "g_c", 1.0);
        }
    }
    diagnosis_free(&d);
}

static void a_disturbance_without_a_name_is_structure_and_no_cause(void)
{
    good.unlogged_ripple = 0.02;
    diagnosis d = look(&good, "dc_link_ripple"); /* as of a disturbance that no cause of the list has */
    TEST_ASSERT_EQUAL_size_t(0, d.causes);
    TEST_ASSERT_EQUAL_INT(VERDICT_UNEXPLAINED, d.verdict);
    TEST_ASSERT_TRUE(d.structure.certain);
    /* The ripple is no sensor noise: the floor must not have swallowed it. */
    TEST_ASSERT_DOUBLE_WITHIN(0.35 * good.noise_A, good.noise_A, d.sensor_noise_A);
    /* A line may fill several bins of a run, which is one run all the same. */
    const char *runs = strchr(d.structure.words, '(');
    unsigned with = 0;
    unsigned in_all = 0;
    TEST_ASSERT_NOT_NULL(runs);
    TEST_ASSERT_EQUAL_INT(2, sscanf(runs, "(%u of %u runs)", &with, &in_all));
    TEST_ASSERT_EQUAL_UINT(BENCH_RUNS, in_all);
    TEST_ASSERT_TRUE(with >= 1 && with <= in_all);
    diagnosis_free(&d);
}

static void what_is_skipped_is_not_named(void)
{
    good.m.psi_f_Wb = 0.185;
    diagnosis d = look(&good, "flux_linkage");
    for (size_t k = 0; k < d.causes; k++) {
        TEST_ASSERT_NOT_EQUAL(0, strcmp("flux_linkage", d.cause[k].id));
    }
    TEST_ASSERT_NOT_EQUAL(VERDICT_CLEAN, d.verdict);
    diagnosis_free(&d);
    /* A resistance a third off is no last digit, whatever the error. */
    good.m = bench_motor();
    good.m.R_ohm = 1.2;
    d = look(&good, "resistance");
    TEST_ASSERT_NOT_EQUAL(VERDICT_CLEAN, d.verdict);
    diagnosis_free(&d);
}

static void the_extended_motor_needs_nothing_more(void)
{
    good.m.R_ohm = 1.1;
    good.m.ext.has[CAUSE_ANGLE_DELAY] = true;
    good.m.ext.t_delay_s = 2e-5;
    diagnosis first = look(&good, NULL);
    recording r = bench_record(&good);
    diagnosis again;
    error e = {0};
    diagnose_options options = {0};
    TEST_ASSERT_TRUE(diagnose(&again, &r, &first.extended_motor, &options, &e));
    TEST_ASSERT_EQUAL_INT(VERDICT_CLEAN, again.verdict);
    recording_free(&r);
    diagnosis_free(&first);
    diagnosis_free(&again);
}

/* However short a recording that is accepted: rows are held out, every figure is one, and no run is made up. */
static void a_short_recording_always_holds_rows_out(void)
{
    good.m.psi_f_Wb = 0.17;
    for (size_t rows = 200; rows <= 400; rows += 10) {
        motor file = bench_motor();
        recording r = bench_record(&good);
        diagnosis d;
        error e = {0};
        const diagnose_options options = {.series = true};
        r.rows = rows;
        r.stretches = 1;
        r.stretch[0].count = rows;
        TEST_ASSERT_TRUE_MESSAGE(diagnose(&d, &r, &file, &options, &e), e.text);
        TEST_ASSERT_TRUE(d.rows_held_out >= 40 && d.rows_held_out < d.rows_used);
        TEST_ASSERT_TRUE(isfinite(d.noise_floor) && isfinite(d.nominal) && isfinite(d.extended));
        TEST_ASSERT_TRUE(d.extended < d.nominal);
        size_t measured = 0;
        for (size_t k = 0; k < d.runs; k++) {
            TEST_ASSERT_EQUAL_INT(1, d.run[k].run);
            TEST_ASSERT_TRUE(d.run[k].rows > 0 && isfinite(d.run[k].free_extended));
            measured += isfinite(d.run[k].nominal) ? 1 : 0;
        }
        TEST_ASSERT_TRUE(measured >= 1);
        diagnosis_free(&d);
        recording_free(&r);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_clean_recording_has_no_cause_and_its_floor_is_the_noise);
    RUN_TEST(resistance_is_named_although_noise_is_on_both_sides);
    RUN_TEST(flux_inductance_and_saliency_are_distinguished);
    RUN_TEST(an_inductance_of_one_phase_or_of_all_is_named);
    RUN_TEST(a_dead_time_of_either_sign_is_named);
    RUN_TEST(iron_that_saturates_is_a_flux_map);
    RUN_TEST(everything_scaled_alike_is_one_voltage_gain);
    RUN_TEST(one_error_within_the_tolerance_of_the_rest_is_one_cause);
    RUN_TEST(estimates_hold_the_truth_and_equivalents_are_reported);
    RUN_TEST(a_voltage_that_acts_late_is_found);
    RUN_TEST(a_voltage_that_acts_parts_of_a_cycle_late_is_found);
    RUN_TEST(two_causes_at_once_are_both_found);
    RUN_TEST(a_disturbance_without_a_name_is_structure_and_no_cause);
    RUN_TEST(what_is_skipped_is_not_named);
    RUN_TEST(the_extended_motor_needs_nothing_more);
    RUN_TEST(a_short_recording_always_holds_rows_out);
    return UNITY_END();
}
