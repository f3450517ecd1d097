/* Motor files: what is read, what is refused and where, and that writing loses nothing. */
#include "data/motor.h"
#include "host_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

/* interfaces.md's example; tests below change one line of it. */
static const char *const example[] = {
    "name = \"Jarzebowicz 2019 laboratory drive\"",
    "[motor]",
    "pole_pairs = 3",
    "R_ohm = 0.75",
    "L_d_H = 5.2e-3",
    "L_q_H = 5.2e-3",
    "psi_f_Wb = 0.134",
    "I_rated_A_rms = 10.5",
    "n_max_rpm = 8000",
    "[inverter]",
    "f_pwm_Hz = 5000",
    "u_dc_V = 750",
    "[extension.dead_time]",
    "v_dead_V = 4.2",
    "i_knee_A = 0.15",
};

enum { LINES = sizeof example / sizeof example[0] };

void setUp(void)
{
}

void tearDown(void)
{
}

/* The example with line `changed` (from 1; 0: none) replaced by `text`, and `more` at its end. */
static const char *example_file(int changed, const char *text, const char *more)
{
    char all[4000] = "";
    for (int i = 0; i < LINES; i++) {
        strcat(all, i + 1 == changed ? text : example[i]);
        strcat(all, "\n");
    }
    strcat(all, more);
    return scratch_text("m.toml", all);
}

static void expect_refused(int changed, const char *text, const char *more, const char *where,
                           const char *what)
{
    error e = {0};
    motor m = motor_blank();
    m.R_ohm = 42.0;
    const char *path = example_file(changed, text, more);
    TEST_ASSERT_FALSE_MESSAGE(motor_read(path, &m, &e), text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);
    char start[500];
    snprintf(start, sizeof start, "%s:%s: ", path, where);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(start, e.text, strlen(start), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, what), e.text);
    TEST_ASSERT_TRUE_MESSAGE(m.R_ohm == 42.0, "the motor was touched");
}

static void test_the_example_is_read(void)
{
    error e = {0};
    motor m;
    TEST_ASSERT_TRUE_MESSAGE(motor_read(example_file(0, "", ""), &m, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("Jarzebowicz 2019 laboratory drive", m.name);
    TEST_ASSERT_EQUAL(3, m.pole_pairs);
    TEST_ASSERT_TRUE(m.R_ohm == 0.75);
    TEST_ASSERT_TRUE(m.L_d_H == 5.2e-3 && m.L_q_H == 5.2e-3);
    TEST_ASSERT_TRUE(m.psi_f_Wb == 0.134);
    TEST_ASSERT_TRUE(m.I_rated_A_rms == 10.5 && m.n_max_rpm == 8000.0);
    TEST_ASSERT_TRUE(m.f_pwm_Hz == 5000.0 && m.u_dc_V == 750.0);
    for (int id = 0; id < CAUSE_COUNT; id++) {
        TEST_ASSERT_EQUAL(id == CAUSE_DEAD_TIME, m.ext.has[id]);
    }
    TEST_ASSERT_TRUE(m.ext.v_dead_V == 4.2 && m.ext.i_knee_A == 0.15);
    TEST_ASSERT_TRUE(m.ext.k_u == 1.0 && m.ext.g[0] == 1.0 && m.ext.g[2] == 1.0);
}

static void test_a_motor_without_a_name_is_called_by_its_file(void)
{
    error e = {0};
    motor m;
    TEST_ASSERT_TRUE_MESSAGE(motor_read(example_file(1, "", ""), &m, &e), e.text);
    TEST_ASSERT_EQUAL_STRING("m.toml", m.name);
}

static void test_values_out_of_range_are_named(void)
{
    expect_refused(3, "pole_pairs = 2.5", "", "3:14", "pole_pairs must be a whole number");
    expect_refused(3, "pole_pairs = 0", "", "3:14", "not 0");
    expect_refused(4, "R_ohm = -0.1", "", "4:9", "R_ohm must be a number >= 0, not -0.1");
    expect_refused(5, "L_d_H = -5.2e-3", "", "5:9", "L_d_H must be a number > 0, not -0.0052");
    expect_refused(5, "L_d_H = 0", "", "5:9", "L_d_H must be a number > 0, not 0");
    expect_refused(6, "L_q_H = nan", "", "6:9", "L_q_H must be a number > 0, not nan");
    expect_refused(6, "L_q_H = +inf", "", "6:9", "not inf");
    expect_refused(7, "psi_f_Wb = \"0.134\"", "", "7:12",
                   "psi_f_Wb must be a number >= 0, not text \"0.134\"");
    expect_refused(7, "psi_f_Wb = [0.134]", "", "7:12", "not an array");
    expect_refused(12, "u_dc_V = true", "", "12:10", "not true");
    expect_refused(1, "name = 5", "", "1:8", "name must be text");
    expect_refused(14, "v_dead_V = inf", "", "14:12", "v_dead_V must be a finite number");
}

static void test_missing_and_unknown_keys_are_named(void)
{
    expect_refused(5, "", "", "2:1", "L_d_H is missing in [motor]");
    expect_refused(10, "", "", "1:1", "inverter is missing; expected a table [inverter]");
    expect_refused(15, "", "", "13:1", "i_knee_A is missing in [extension.dead_time]");
    expect_refused(9, "n_max_rpm = 8000\npsi_f_wb = 1", "", "10:1",
                   "unknown key psi_f_wb in [motor]; did you mean psi_f_Wb?");
    expect_refused(0, "", "[extension.deadtime]\n", "16:12",
                   "unknown key deadtime in [extension]; did you mean dead_time?");
    expect_refused(0, "", "[extras]\n", "16:2", "unknown key extras");
    expect_refused(0, "", "g_a = 1.0\n", "16:1",
                   "expected one of compensation_V, compensation_knee_A, i_knee_A, v_dead_V");
}

static void test_what_is_no_toml_is_refused(void)
{
    expect_refused(4, "R_ohm = ", "", "4:9", "not TOML");
    expect_refused(4, "R_ohm 0.75", "", "4:7", "not TOML");
    expect_refused(4, "pole_pairs = 3", "", "4:14", "not TOML");
    expect_refused(2, "[motor", "", "2:7", "not TOML");

    error e = {0};
    motor m;
    TEST_ASSERT_FALSE(motor_read(scratch_path("absent.toml"), &m, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "absent.toml: cannot be read: No such file"), e.text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, e.status);

    error directory = {0};
    TEST_ASSERT_FALSE(motor_read(scratch_path(""), &m, &directory));
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, directory.status);
}

static void test_extension_rules(void)
{
    expect_refused(0, "", "[extension.phase_asymmetry]\ndR_b_ohm = -0.8\n", "17:12",
                   "dR_b_ohm must be a number >= -0.75, not -0.8");
    expect_refused(0, "", "[extension.phase_inductance]\ndL_c_H = -0.0052\n", "17:10",
                   "dL_c_H must be a number >= -0.00416");
    expect_refused(
        0, "",
        "[extension.saturation]\nL_0_H = 1e-3\nI_sat_A = 30\n[extension.phase_inductance]\ndL_c_H = -0.003\n",
        "20:10", "dL_c_H must be a number >= -0.0008");
    expect_refused(0, "", "[extension.saturation_dq]\nL_d0_H = 1e-3\nL_q0_H = 0\n", "18:10",
                   "L_q0_H must be a number > 0");
    expect_refused(0, "", "[extension.saturation_dq]\nL_d0_H = 1e-3\nL_q0_H = 1e-3\nE_1_J = -1\n", "19:9",
                   "E_1_J must be a number >= 0");
    expect_refused(0, "", "[extension.saturation_dq]\nL_d0_H = 1e-3\nL_q0_H = 1e-3\nE_2_J = 1\nI_d2_A = 5\n",
                   "19:9", "E_2_J without I_d2_A and I_q2_A");
    expect_refused(0, "",
                   "[extension.saturation]\nL_0_H = 1e-3\nI_sat_A = 30\n[extension.saturation_dq]\nL_d0_H = "
                   "1e-3\nL_q0_H = 1e-3\n",
                   "19:1", "both laws of saturation");
    expect_refused(0, "", "[extension.angle_harmonic]\norder = 7\namplitude_rad = 0.1\nphase_rad = 0\n",
                   "17:9", "order must be a whole number from 1 to 6, not 7");
    expect_refused(0, "", "[extension.angle_harmonic]\norder = 4\namplitude_rad = 0.1\nphase_rad = 0\n",
                   "17:9", "order = 4, expected 1, 2, or once or twice pole_pairs");
    expect_refused(0, "", "[extension.voltage_delay]\ncycles = -1\n", "17:10", "cycles must be");
    expect_refused(0, "", "[extension.current_gain]\ng_a = 0\n", "17:7", "g_a must be a number > 0");
}

/* Every extension at once, every value with all of a double's digits. */
static void test_written_is_read_back_to_the_same_bits(void)
{
    motor m = motor_blank();
    strcpy(m.name, "a \"name\" with \\ and \t and \xC3\xA9");
    m.pole_pairs = 7;
    double *const values[] = {&m.R_ohm,
                              &m.L_d_H,
                              &m.L_q_H,
                              &m.psi_f_Wb,
                              &m.I_rated_A_rms,
                              &m.n_max_rpm,
                              &m.f_pwm_Hz,
                              &m.u_dc_V,
                              &m.ext.L_d0_H,
                              &m.ext.I_sat_dq_A,
                              &m.ext.v_dead_V,
                              &m.ext.i_knee_A,
                              &m.ext.L_q0_H,
                              &m.ext.w_ddd,
                              &m.ext.w_dqq,
                              &m.ext.w_dddd,
                              &m.ext.w_ddqq,
                              &m.ext.w_qqqq,
                              &m.ext.E_1_J,
                              &m.ext.I_d1_A,
                              &m.ext.I_q1_A,
                              &m.ext.I_c1_A,
                              &m.ext.E_2_J,
                              &m.ext.I_d2_A,
                              &m.ext.I_q2_A,
                              &m.ext.I_c2_A,
                              &m.ext.k_u,
                              &m.ext.o_A[0],
                              &m.ext.o_A[1],
                              &m.ext.o_A[2],
                              &m.ext.g[0],
                              &m.ext.g[1],
                              &m.ext.g[2],
                              &m.ext.theta_0_rad,
                              &m.ext.psi_5_Wb,
                              &m.ext.psi_7_Wb,
                              &m.ext.t_delay_s,
                              &m.ext.harmonic_amplitude_rad,
                              &m.ext.dR_ohm[0],
                              &m.ext.dR_ohm[1],
                              &m.ext.dR_ohm[2],
                              &m.ext.harmonic_phase_rad,
                              &m.ext.harmonic_2_amplitude_rad,
                              &m.ext.harmonic_2_phase_rad,
                              &m.ext.harmonic_p_amplitude_rad,
                              &m.ext.harmonic_2p_phase_rad,
                              &m.ext.R_fe_ohm,
                              &m.ext.tau_fe_s};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        *values[i] = sqrt((double)i + 2.0) * pow(10.0, (double)(i % 7) - 3.0);
    }
    m.ext.harmonic_order = 1.0;
    m.ext.harmonic_2_order = 2.0;
    m.ext.harmonic_p_order = 7.0;
    m.ext.harmonic_2p_order = 14.0;
    m.ext.voltage_delay_cycles = 1.0;
    m.ext.fault_phase = 2.0;
    m.ext.ripple_share = 0.02;
    for (int id = 0; id < CAUSE_COUNT; id++) {
        m.ext.has[id] =
            motor_is_extension((cause_id)id) && id != CAUSE_SATURATION; /* a map takes its place */
    }

    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(motor_write(scratch_path("w.toml"), &m, "first line\nsecond line", &e), e.text);
    char *text = scratch_read("w.toml");
    TEST_ASSERT_EQUAL_STRING_LEN("# first line\n# second line\nname = ", text, 34);
    free(text);

    motor back;
    memset(&back, 0xAA, sizeof back);
    TEST_ASSERT_TRUE_MESSAGE(motor_read(scratch_path("w.toml"), &back, &e), e.text);
    TEST_ASSERT_EQUAL_STRING(m.name, back.name);
    TEST_ASSERT_EQUAL(m.pole_pairs, back.pole_pairs);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        const size_t offset = (size_t)((const char *)values[i] - (const char *)&m);
        TEST_ASSERT_EQUAL_MEMORY(values[i], (const char *)&back + offset, sizeof(double));
    }
    TEST_ASSERT_TRUE(back.ext.harmonic_order == 1.0 && back.ext.harmonic_2_order == 2.0);
    TEST_ASSERT_TRUE(back.ext.harmonic_p_order == 7.0 && back.ext.harmonic_2p_order == 14.0);
    TEST_ASSERT_TRUE(back.ext.voltage_delay_cycles == 1.0);
    TEST_ASSERT_TRUE(back.ext.fault_phase == 2.0);
    TEST_ASSERT_TRUE(back.ext.ripple_share == 0.02);
    for (int id = 0; id < CAUSE_COUNT; id++) {
        TEST_ASSERT_EQUAL_MESSAGE(m.ext.has[id], back.ext.has[id], cause_table[id].id);
    }
}

/* One entry an order: a table, or an array of tables, in any order. */
static void test_an_angle_error_may_have_several_orders(void)
{
    error e = {0};
    motor m;
    const char *two = "[[extension.angle_harmonic]]\norder = 2\namplitude_rad = 0.05\nphase_rad = 0.5\n"
                      "[[extension.angle_harmonic]]\norder = 1\namplitude_rad = 0.03\nphase_rad = -1\n";
    TEST_ASSERT_TRUE_MESSAGE(motor_read(example_file(0, "", two), &m, &e), e.text);
    TEST_ASSERT_TRUE(m.ext.has[CAUSE_ANGLE_HARMONIC] && m.ext.has[CAUSE_ANGLE_HARMONIC_2]);
    TEST_ASSERT_FALSE(m.ext.has[CAUSE_ANGLE_HARMONIC_P] || m.ext.has[CAUSE_ANGLE_HARMONIC_2P]);
    TEST_ASSERT_TRUE(m.ext.harmonic_amplitude_rad == 0.03 && m.ext.harmonic_phase_rad == -1.0);
    TEST_ASSERT_TRUE(m.ext.harmonic_2_amplitude_rad == 0.05 && m.ext.harmonic_2_phase_rad == 0.5);
    TEST_ASSERT_TRUE_MESSAGE(motor_write(scratch_path("two.toml"), &m, NULL, &e), e.text);
    motor back;
    TEST_ASSERT_TRUE_MESSAGE(motor_read(scratch_path("two.toml"), &back, &e), e.text);
    TEST_ASSERT_EQUAL_MEMORY(&m.ext, &back.ext, sizeof m.ext);
    const char *one = "[extension.angle_harmonic]\norder = 2\namplitude_rad = 0.05\nphase_rad = 0.5\n";
    TEST_ASSERT_TRUE_MESSAGE(motor_read(example_file(0, "", one), &m, &e), e.text);
    TEST_ASSERT_TRUE(!m.ext.has[CAUSE_ANGLE_HARMONIC] && m.ext.has[CAUSE_ANGLE_HARMONIC_2]);
    TEST_ASSERT_TRUE(m.ext.harmonic_order == 0.0 && m.ext.harmonic_2_order == 2.0);
    const char *same = "[[extension.angle_harmonic]]\norder = 2\namplitude_rad = 0.05\nphase_rad = 0.5\n"
                       "[[extension.angle_harmonic]]\norder = 2\namplitude_rad = 0.03\nphase_rad = -1\n";
    TEST_ASSERT_FALSE(motor_read(example_file(0, "", same), &m, &e));
    TEST_ASSERT_NOT_NULL(strstr(e.text, "order = 2 is given twice; expected one entry an order"));
}

/* What does not drift has no rate in the file, and none is asked for. */
static void test_a_rate_is_written_if_it_is_not_zero(void)
{
    error e = {0};
    motor m;
    TEST_ASSERT_TRUE(motor_read(example_file(0, "", ""), &m, &e));
    m.ext.has[CAUSE_CURRENT_OFFSET] = true;
    m.ext.o_rate_A_s[1] = -0.25;
    TEST_ASSERT_TRUE_MESSAGE(motor_write(scratch_path("rate.toml"), &m, NULL, &e), e.text);
    char *text = scratch_read("rate.toml");
    TEST_ASSERT_NOT_NULL(strstr(text, "o_b_rate_A_s = -0.25\n"));
    TEST_ASSERT_NULL(strstr(text, "o_a_rate_A_s"));
    TEST_ASSERT_NULL(strstr(text, "R_rate"));
    free(text);
    motor back;
    TEST_ASSERT_TRUE_MESSAGE(motor_read(scratch_path("rate.toml"), &back, &e), e.text);
    TEST_ASSERT_TRUE(back.ext.o_rate_A_s[1] == -0.25);
    TEST_ASSERT_TRUE(back.ext.o_rate_A_s[0] == 0.0);
}

static void test_a_value_that_is_not_finite_is_not_written(void)
{
    error e = {0};
    motor m;
    TEST_ASSERT_TRUE(motor_read(example_file(0, "", ""), &m, &e));
    m.ext.v_dead_V = NAN;
    TEST_ASSERT_FALSE(motor_write(scratch_path("nan.toml"), &m, NULL, &e));
    TEST_ASSERT_EQUAL(STATUS_FAILED, e.status);
    TEST_ASSERT_NULL(scratch_read("nan.toml"));
}

/* What a command finds wrong after reading gets the position all the same. */
static void test_a_later_complaint_has_its_place(void)
{
    const char *path = example_file(0, "", "");
    char expected[500];
    error e = {0};
    TEST_ASSERT_FALSE(motor_refuse(path, "u_dc_V", &e, "u_dc_V = %g is no good", 750.0));
    snprintf(expected, sizeof expected, "%s:12:10: u_dc_V = 750 is no good", path);
    TEST_ASSERT_EQUAL_STRING(expected, e.text);
    error absent = {0};
    TEST_ASSERT_FALSE(motor_refuse("no/such.toml", "R_ohm", &absent, "R_ohm is no good"));
    TEST_ASSERT_EQUAL_STRING("no/such.toml: R_ohm is no good", absent.text);
    TEST_ASSERT_EQUAL(STATUS_UNUSABLE, absent.status);
}

int main(void)
{
    scratch_begin();
    UNITY_BEGIN();
    RUN_TEST(test_the_example_is_read);
    RUN_TEST(test_a_motor_without_a_name_is_called_by_its_file);
    RUN_TEST(test_values_out_of_range_are_named);
    RUN_TEST(test_missing_and_unknown_keys_are_named);
    RUN_TEST(test_what_is_no_toml_is_refused);
    RUN_TEST(test_extension_rules);
    RUN_TEST(test_written_is_read_back_to_the_same_bits);
    RUN_TEST(test_an_angle_error_may_have_several_orders);
    RUN_TEST(test_a_rate_is_written_if_it_is_not_zero);
    RUN_TEST(test_a_value_that_is_not_finite_is_not_written);
    RUN_TEST(test_a_later_complaint_has_its_place);
    const int failed = UNITY_END();
    scratch_end();
    return failed;
}
