/*
 * The 2016 paper: the six-step drive in closed form against the switching-level plant, and the paper's
 * figures.
 */
#include "plant/plant.h"
#include "reproduce/discrete_angle.h"
#include "reproduce/paper_2016.h"

#include "unity.h"

#include <math.h>
#include <string.h>

static comparison rows;

void setUp(void)
{
}

void tearDown(void)
{
}

static six_step_run solved(int which)
{
    const six_step_scenario test = paper_2016_scenario(&paper_2016_motors[which]);
    six_step_run run;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(six_step_solve(&test, &run, &e), e.text);
    return run;
}

static void test_intervals_follow_each_other(void)
{
    const six_step_run run = solved(1);
    for (size_t n = 1; n < run.count; n++) {
        const six_step_interval *before = &run.interval[n - 1];
        const six_step_interval *at = &run.interval[n];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, before->t_s + before->duration_s, at->t_s);
        TEST_ASSERT_EQUAL_INT(before->vector + 1, at->vector);
        TEST_ASSERT_TRUE(before->i_end == at->i_start);
    }
    /* The step cuts its interval at 58 %; the next vector takes over there. */
    const double whole_s = run.interval[0].duration_s;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.58 * whole_s, run.interval[run.step_index].duration_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.92 * whole_s, run.interval[run.step_index + 1].duration_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, run.t_step_s, run.interval[run.step_index + 1].t_s);
    six_step_run mine = run;
    six_step_free(&mine);
}

/* Active vector n as inverter legs, A first. */
static void legs_of(int vector, bool high[3])
{
    static const bool table[6][3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
    memcpy(high, table[vector % 6], 3 * sizeof high[0]);
}

/* Two solutions with nothing in common: closed form here, the plant's series there. */
static void test_closed_form_is_what_the_plant_does(void)
{
    for (int which = 0; which < PAPER_2016_MOTORS; which++) {
        six_step_run run = solved(which);
        motor m = motor_blank();
        m.pole_pairs = 1;
        m.R_ohm = run.scenario.R_ohm;
        m.L_d_H = m.L_q_H = run.scenario.L_H;
        m.I_rated_A_rms = 1.0;
        m.n_max_rpm = 60.0 * run.scenario.f_Hz;
        m.f_pwm_Hz = 6.0 * run.scenario.f_Hz;
        m.u_dc_V =
            1.5 * creal(run.u_over_R) * m.R_ohm; /* (2/3) u_dc / R is the closed form's final current */
        plant_config c = plant_config_from_motor(&m);
        c.shaft.omega_e_start_rad_s = 2.0 * VEC_PI * run.scenario.f_Hz;
        c.shaft.theta_mech_start_rad = run.interval[0].theta_rad;
        plant p;
        plant_init(&p, &c);
        const double complex start = run.interval[0].i_start * vec_turn(-run.interval[0].theta_rad);
        plant_set_current(&p, (vec_dq){creal(start), cimag(start)});
        for (size_t n = 0; n < run.count; n++) {
            const six_step_interval *at = &run.interval[n];
            bool high[3];
            legs_of(at->vector, high);
            plant_begin_interval(&p, high, at->duration_s);
            plant_advance_to(&p, at->duration_s);
            const plant_means mean = plant_mean(&p);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, creal(at->i_mean), mean.i_ab_A.alpha);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, cimag(at->i_mean), mean.i_ab_A.beta);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, creal(at->i_mean_dq), mean.i_dq_A.d);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, cimag(at->i_mean_dq), mean.i_dq_A.q);
        }
        six_step_free(&run);
    }
}

static void test_steady_gain_is_5_30_percent(void)
{
    for (int which = 0; which < PAPER_2016_MOTORS; which++) {
        six_step_run run = solved(which);
        const discrete_angle_summary s = discrete_angle_summarise(&run, discrete_angle_of);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 6.0 * sqrt(3.0) / (VEC_PI * VEC_PI) - 1.0, s.steady_gain_a);
        TEST_ASSERT_DOUBLE_WITHIN(2.5e-4, 0.0530, s.steady_gain_bc);
        six_step_free(&run);
    }
}

static void test_transient_figures_within_ten_percent(void)
{
    int transient = 0;
    for (size_t n = 0; n < rows.count; n++) {
        const comparison_row *r = &rows.row[n];
        if (strcmp(r->item, "Table 2") == 0 && strstr(r->condition, "transient") != NULL) {
            transient++;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1, 1.0, comparison_ratio(r), r->quantity);
        }
    }
    TEST_ASSERT_EQUAL_INT(18, transient);
}

/* All but motor 2's steady difference of modulus, which no speed near 105 Hz gives (docs/equations.md). */
static void test_steady_differences_are_of_the_papers_size(void)
{
    int checked = 0;
    for (size_t n = 0; n < rows.count; n++) {
        const comparison_row *r = &rows.row[n];
        const bool off = strcmp(r->condition, "motor 2, steady") == 0 && strstr(r->quantity, "gain") != NULL;
        if (strcmp(r->item, "Table 2") == 0 && strstr(r->condition, "steady") != NULL && !off) {
            checked++;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.3, 1.0, comparison_ratio(r), r->quantity);
        }
    }
    TEST_ASSERT_EQUAL_INT(5, checked);
}

static void test_firmware_is_within_1e_5_of_double(void)
{
    int checked = 0;
    for (size_t n = 0; n < rows.count; n++) {
        const comparison_row *r = &rows.row[n];
        if (isfinite(r->value_iq24)) {
            const double unit = strcmp(r->unit, "%") == 0 ? 100.0 : 1.0;
            checked++;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-5 * unit, r->value, r->value_iq24, r->quantity);
        }
    }
    TEST_ASSERT_EQUAL_INT(31, checked);
}

int main(void)
{
    error e = {0};
    if (!paper_2016_compare(&rows, &e)) {
        return error_print(&e);
    }
    UNITY_BEGIN();
    RUN_TEST(test_intervals_follow_each_other);
    RUN_TEST(test_closed_form_is_what_the_plant_does);
    RUN_TEST(test_steady_gain_is_5_30_percent);
    RUN_TEST(test_transient_figures_within_ten_percent);
    RUN_TEST(test_steady_differences_are_of_the_papers_size);
    RUN_TEST(test_firmware_is_within_1e_5_of_double);
    comparison_free(&rows);
    return UNITY_END();
}
