/*
 * The 2019 paper: the steady drive, its figures, and the sweep.
 */
#include "reproduce/lab_drives.h"
#include "reproduce/paper_2019.h"
#include "reproduce/sweep.h"

#include "unity.h"

#include <math.h>
#include <string.h>

static comparison rows;
static motor lab;
static method_machine machine;

void setUp(void)
{
}

void tearDown(void)
{
}

static steady_drive settled(const motor *m, double n_rpm, double complex i_dq_A)
{
    steady_drive d;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(steady_drive_run(m, n_rpm, i_dq_A, 300, &d, &e), e.text);
    return d;
}

static double complex mean_mid_sample(const steady_drive *d)
{
    double complex sum = 0.0;
    for (size_t n = 0; n < d->count; n++) {
        const drive_cycle *at = &d->cycle[n];
        sum += at->i_mid_A * vec_turn(-at->theta_rad - 0.5 * d->omega_rad_s * d->T_s);
    }
    return sum / (double)d->count;
}

static void test_mid_point_sample_is_what_was_asked_for(void)
{
    motor salient = lab;
    salient.L_q_H = 2.0 * lab.L_d_H;
    const motor *const motors[] = {&lab, &salient};
    const double speeds_rpm[] = {-3000.0, 0.0, 500.0, 8000.0};
    for (int which = 0; which < 2; which++) {
        for (int n = 0; n < 4; n++) {
            const double complex asked = vec_complex(-5.0, 9.0);
            steady_drive d = settled(motors[which], speeds_rpm[n], asked);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, cabs(mean_mid_sample(&d) - asked));
            steady_drive_free(&d);
        }
    }
}

static void test_record_is_consecutive_and_whole_beats(void)
{
    steady_drive d = settled(&lab, 8000.0, paper_2019_current(&lab, 8000.0));
    TEST_ASSERT_EQUAL_UINT(0, d.count % 25); /* 12.5 cycles a revolution */
    for (size_t n = 1; n < d.count; n++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, cabs(d.cycle[n].i_valley_A - d.cycle[n - 1].i_next_valley_A));
    }
    steady_drive_free(&d);
}

/* A voltage that the duties do not make would show as an error of every method. */
static void test_duties_make_the_voltage(void)
{
    steady_drive d = settled(&lab, 5000.0, paper_2019_current(&lab, 5000.0));
    double duty[3];
    steady_drive_duties(&d, &d.cycle[7], duty);
    const double mean = (duty[0] + duty[1] + duty[2]) / 3.0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, creal(d.cycle[7].u_V), (duty[0] - mean) * d.u_dc_V);
    for (int x = 0; x < 3; x++) {
        TEST_ASSERT_TRUE(duty[x] >= 0.0 && duty[x] <= 1.0);
    }
    steady_drive_free(&d);
}

static void test_link_is_raised_where_it_cannot_hold_the_point(void)
{
    motor weak = lab;
    weak.u_dc_V = 400.0;
    steady_drive d = settled(&weak, 8000.0, paper_2019_current_at(&weak, 0.0));
    TEST_ASSERT_TRUE(d.link_raised);
    TEST_ASSERT_TRUE(cabs(d.u_dq_V) < steady_drive_voltage_limit(d.u_dc_V));
    steady_drive_free(&d);
    d = settled(&lab, 8000.0, paper_2019_current_at(&lab, 0.0));
    TEST_ASSERT_FALSE(d.link_raised);
    steady_drive_free(&d);
}

static void test_field_weakening_begins_at_5000_rpm(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, creal(paper_2019_current(&lab, 4999.0)));
    const double complex i = paper_2019_current(&lab, 8000.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10.5 * sqrt(2.0), cabs(i));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -0.7, creal(i) / cabs(i));
}

/* Half of the last digit that the paper prints, or ten percent. */
static void assert_near_paper(const comparison_row *r, double last_digit)
{
    const double tolerance = fmax(0.1 * r->paper_value, 0.5 * last_digit);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(tolerance, r->paper_value, r->value, r->quantity);
}

static void test_table_1_at_5000_and_8000_rpm(void)
{
    int checked = 0;
    for (size_t n = 0; n < rows.count; n++) {
        const comparison_row *r = &rows.row[n];
        if (strcmp(r->item, "Table 1") == 0 &&
            (strcmp(r->condition, "5000 rpm") == 0 || strcmp(r->condition, "8000 rpm") == 0)) {
            checked++;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.1, 1.0, comparison_ratio(r), r->quantity);
        }
        if (strcmp(r->item, "Figure 6") == 0) {
            checked++;
            assert_near_paper(r, 0.01);
        }
    }
    TEST_ASSERT_EQUAL_INT(12, checked);
}

/* A reader who finds a ratio beyond a tenth finds the reason next to it. */
static void test_each_value_far_from_the_papers_has_a_note(void)
{
    bool printed_digit = false;
    for (size_t n = 0; n < rows.count; n++) {
        const comparison_row *r = &rows.row[n];
        if (fabs(comparison_ratio(r) - 1.0) > 0.1) {
            TEST_ASSERT_TRUE_MESSAGE(r->note[0] != '\0', r->quantity);
        }
        printed_digit = printed_digit || (strcmp(r->item, "Figure 6") == 0 &&
                                          strstr(r->note, "0.0442 rounds to 0.04") != NULL);
    }
    TEST_ASSERT_TRUE(printed_digit);
}

/* The erratum of Table 1: the model's figures at 500 and 1000 rpm. */
static void test_standard_figures_of_500_rpm_are_those_of_1000(void)
{
    sweep_point at_500;
    sweep_point at_1000;
    error e = {0};
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, 500.0, paper_2019_current(&lab, 500.0), &at_500, &e));
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, 1000.0, paper_2019_current(&lab, 1000.0), &at_1000, &e));
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, 0.010, at_500.errors.of[METHOD_MEAN_STANDARD].rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.131, at_500.errors.of[METHOD_PREDICTION_STANDARD].rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, 0.015, at_500.errors.of[METHOD_MEAN_QUASI_DISCRETE].rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(0.0005, 0.046, at_500.errors.of[METHOD_PREDICTION_QUASI_DISCRETE].rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * 0.041, 0.041, at_1000.errors.of[METHOD_MEAN_STANDARD].rms_percent);
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * 0.494, 0.494, at_1000.errors.of[METHOD_PREDICTION_STANDARD].rms_percent);
}

/* docs/equations.md: what each method leaves out, to first order; at 500 rpm little else is left. */
static void test_leading_terms_of_the_errors(void)
{
    sweep_point p;
    error e = {0};
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, 500.0, paper_2019_current_at(&lab, 0.0), &p, &e));
    const double phi = motor_speed_rad_s(&lab, 500.0) / lab.f_pwm_Hz;
    const double rho = lab.R_ohm / (lab.f_pwm_Hz * lab.L_d_H);
    const double psi_pu = lab.psi_f_Wb / (lab.L_d_H * lab.I_rated_A_rms * sqrt(2.0));
    const double expected[METHOD_COUNT] = {
        [METHOD_MEAN_STANDARD] = psi_pu * phi * phi / 24.0 + rho * phi / 24.0,
        [METHOD_MEAN_QUASI_DISCRETE] = rho * phi / 6.0,
        [METHOD_PREDICTION_STANDARD] = 0.5 * psi_pu * phi * phi + 0.5 * rho * phi,
        [METHOD_PREDICTION_QUASI_DISCRETE] = 0.5 * rho * phi};
    for (int k = 0; k < METHOD_COUNT; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(8.0 * expected[k], 100.0 * expected[k], p.errors.of[k].rms_percent);
    }
}

static void test_firmware_is_within_1e_5_of_double(void)
{
    const double speeds_rpm[] = {-8000.0, 0.0, 500.0, 5000.0, 8000.0, 33000.0};
    for (int n = 0; n < 6; n++) {
        sweep_point p;
        error e = {0};
        TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, speeds_rpm[n],
                                        paper_2019_current_at(&lab, speeds_rpm[n] > 9000.0 ? -0.9 : 0.0), &p,
                                        &e));
        for (int k = 0; k < METHOD_COUNT; k++) {
            TEST_ASSERT_TRUE(p.errors.of[k].iq24_off < 1e-5);
        }
    }
}

/* Time runs backwards alike: reverse with the torque current reversed is the mirror image. */
static void test_reverse_mirrors_forward(void)
{
    sweep_point forward;
    sweep_point reverse;
    error e = {0};
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, 6000.0, vec_complex(-6.0, 10.0), &forward, &e));
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, -6000.0, vec_complex(-6.0, -10.0), &reverse, &e));
    for (int k = 0; k < METHOD_COUNT; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * forward.errors.of[k].rms_percent, forward.errors.of[k].rms_percent,
                                  reverse.errors.of[k].rms_percent);
    }
}

static void test_sweep_refuses_fewer_than_three_cycles_a_revolution(void)
{
    sweep_point p;
    error e = {0};
    motor m = lab;
    m.path = "m.toml";
    TEST_ASSERT_FALSE(sweep_point_at(&m, &machine, 33400.0, vec_complex(0.0, 10.0), &p, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL(strstr(e.text, "m.toml"));
}

static void test_sweep_refuses_what_the_firmware_cannot_hold(void)
{
    sweep_point p;
    error current = {0};
    error voltage = {0};
    TEST_ASSERT_FALSE(sweep_point_at(&lab, &machine, 500.0, vec_complex(0.0, 300.0), &p, &current));
    TEST_ASSERT_NOT_NULL(strstr(current.text, "rated"));
    TEST_ASSERT_FALSE(sweep_point_at(&lab, &machine, 30000.0, vec_complex(0.0, 100.0), &p, &voltage));
    TEST_ASSERT_NOT_NULL(strstr(voltage.text, "DC link"));
}

static void test_sweep_json_has_the_keys(void)
{
    sweep_point p;
    error e = {0};
    TEST_ASSERT_TRUE(sweep_point_at(&lab, &machine, 3000.0, vec_complex(0.0, 10.0), &p, &e));
    json_t *json = sweep_point_json(&p);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 100.0 / 3.0, json_number_value(json_object_get(json, "sffr")));
    static const char *const group[] = {"mean", "prediction"};
    for (int k = 0; k < METHOD_COUNT; k++) {
        const json_t *of = json_object_get(json, group[k / 2]);
        const json_t *value = json_object_get(of, k % 2 == 0 ? "standard" : "quasi_discrete");
        TEST_ASSERT_TRUE(json_is_number(value));
        TEST_ASSERT_EQUAL_DOUBLE(p.errors.of[k].rms_percent, json_number_value(value));
    }
    json_free(json);
}

static void test_motor_that_does_not_fit_is_refused_by_name(void)
{
    motor m = lab;
    method_machine refused;
    error e = {0};
    m.path = "m.toml";
    m.L_d_H = m.L_q_H = 1e-6;
    TEST_ASSERT_FALSE(method_machine_of(&m, &refused, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_NOT_NULL(strstr(e.text, "m.toml"));
}

/* The stand-in is the same whenever it is drawn, and worse than the simulation it disturbs. */
static void test_lab_spread_repeats(void)
{
    steady_drive d = settled(&lab, 8000.0, paper_2019_current(&lab, 8000.0));
    lab_spread once;
    lab_spread again;
    error e = {0};
    TEST_ASSERT_TRUE(lab_spread_of(&lab, &d, METHOD_PREDICTION_QUASI_DISCRETE, &once, &e));
    TEST_ASSERT_TRUE(lab_spread_of(&lab, &d, METHOD_PREDICTION_QUASI_DISCRETE, &again, &e));
    TEST_ASSERT_EQUAL_DOUBLE(once.median, again.median);
    const method_errors errors = method_errors_of(&d, &machine);
    TEST_ASSERT_TRUE(errors.of[METHOD_PREDICTION_QUASI_DISCRETE].rms_percent < once.low);
    TEST_ASSERT_TRUE(once.low < once.median && once.median < once.high);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, once.median, once.median_iq24);
    steady_drive_free(&d);
}

int main(void)
{
    error e = {0};
    lab = paper_2019_motor();
    if (!method_machine_of(&lab, &machine, &e) || !paper_2019_compare(&rows, &e)) {
        return error_print(&e);
    }
    UNITY_BEGIN();
    RUN_TEST(test_mid_point_sample_is_what_was_asked_for);
    RUN_TEST(test_record_is_consecutive_and_whole_beats);
    RUN_TEST(test_duties_make_the_voltage);
    RUN_TEST(test_link_is_raised_where_it_cannot_hold_the_point);
    RUN_TEST(test_field_weakening_begins_at_5000_rpm);
    RUN_TEST(test_table_1_at_5000_and_8000_rpm);
    RUN_TEST(test_each_value_far_from_the_papers_has_a_note);
    RUN_TEST(test_standard_figures_of_500_rpm_are_those_of_1000);
    RUN_TEST(test_leading_terms_of_the_errors);
    RUN_TEST(test_firmware_is_within_1e_5_of_double);
    RUN_TEST(test_reverse_mirrors_forward);
    RUN_TEST(test_sweep_refuses_fewer_than_three_cycles_a_revolution);
    RUN_TEST(test_sweep_refuses_what_the_firmware_cannot_hold);
    RUN_TEST(test_sweep_json_has_the_keys);
    RUN_TEST(test_motor_that_does_not_fit_is_refused_by_name);
    RUN_TEST(test_lab_spread_repeats);
    comparison_free(&rows);
    return UNITY_END();
}
