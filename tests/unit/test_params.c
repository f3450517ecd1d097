/*
 * Physical values to per unit: the compile-time macros and the host's conversion give the same constants,
 * those are what the formulas of docs/units.md give, and what does not fit is refused by its name.
 */
#include "params_host.h"

#include "iqfoc/params.h"

#include "unity.h"

#include <math.h>
#include <string.h>

#define T_S 2e-4
#define I_B IQFOC_I_BASE(10.5)
#define U_B 750.0

static const iqfoc_predictor_t folded = IQFOC_PREDICTOR(0.75, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iqfoc_current_control_gains_t folded_gains =
    IQFOC_GAINS(6.283185307179586 * 250.0, 0.75, 5.2e-3, 5.2e-3, 0.134, T_S, I_B, U_B);
static const iq24_t folded_turns = IQFOC_TURNS(8000.0, 3, T_S);

void setUp(void)
{
}

void tearDown(void)
{
}

static motor laboratory(void)
{
    motor m = motor_blank();
    m.path = "m.toml";
    m.pole_pairs = 3;
    m.R_ohm = 0.75;
    m.L_d_H = 5.2e-3;
    m.L_q_H = 5.2e-3;
    m.psi_f_Wb = 0.134;
    m.I_rated_A_rms = 10.5;
    m.n_max_rpm = 8000.0;
    m.f_pwm_Hz = 5000.0;
    m.u_dc_V = 750.0;
    return m;
}

static void test_formulas(void)
{
    /* Worked by hand from the units: amperes per volt and cycle over the bases, and so on. */
    const double I_b = 10.5 * sqrt(2.0);
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)lround(2e-4 / 5.2e-3 * 750.0 / I_b * 16777216.0), folded.k_u);
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)lround(0.75 * 2e-4 / 5.2e-3 * 16777216.0), folded.k_r);
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)lround(0.134 / 5.2e-3 / I_b * 16777216.0), folded.k_psi);
    /* At one turn per cycle the speed is 2 pi/T: its EMF over the voltage base. */
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)lround(2.0 * acos(-1.0) / 2e-4 * 0.134 / 750.0 * 16777216.0),
                             folded_gains.emf);
    /* 8000 rpm, three pole pairs, 5 kHz: 400 Hz, SFFR 12.5. */
    TEST_ASSERT_INT32_WITHIN(1, (int32_t)lround(16777216.0 / 12.5), folded_turns);
}

static void test_host_gives_the_same_constants(void)
{
    const motor m = laboratory();
    const scenario_control control = {FEEDBACK_QUASI_DISCRETE_MEAN, MODULATION_PWM, 250.0};
    iqfoc_cycle_config_t config;
    error e = {0, ""};
    TEST_ASSERT_TRUE(config_from_motor(&m, &control, &config, &e));
    TEST_ASSERT_EQUAL_MEMORY(&folded, &config.predictor, sizeof folded);
    TEST_ASSERT_EQUAL_MEMORY(&folded_gains, &config.gains, sizeof folded_gains);
    iqfoc_cycle_t cycle;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, config.feedback);
}

/* The motor is refused, and the line names the file and the coefficient. */
static void refused(motor m, const char *named)
{
    const scenario_control control = {FEEDBACK_MIDPOINT, MODULATION_PWM, 0.0};
    iqfoc_cycle_config_t config;
    error e = {0, ""};
    TEST_ASSERT_FALSE(config_from_motor(&m, &control, &config, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_EQUAL_PTR(e.text, strstr(e.text, "m.toml"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, named), e.text);
    TEST_ASSERT_NULL(strchr(e.text, '\n'));
}

static void test_what_does_not_fit_is_named(void)
{
    motor m = laboratory();
    m.L_d_H = m.L_q_H = 5.2e-6;
    refused(m, "k_u");
    m = laboratory();
    m.L_d_H = m.L_q_H = 5.2e6;
    refused(m, "k_u");
    m = laboratory();
    m.R_ohm = 40.0;
    refused(m, "k_r");
    m = laboratory();
    m.psi_f_Wb = 30.0;
    refused(m, "k_psi");
    m = laboratory();
    m.I_rated_A_rms = 1050.0;
    refused(m, "x_d");
    m = laboratory();
    m.n_max_rpm = 60000.0;
    refused(m, "n_max_rpm");
    m = laboratory();
    m.L_d_H = m.L_q_H = 5.2e-1;
    m.I_rated_A_rms = 300.0;
    refused(m, "kp_d");
}

static void test_conversions_saturate_and_wrap(void)
{
    TEST_ASSERT_EQUAL_INT32(IQ24_MAX, iq24_from_double(1e9));
    TEST_ASSERT_EQUAL_INT32(IQ24_MIN, iq24_from_double(-1e9));
    TEST_ASSERT_EQUAL_INT32(IQ24(-1.25), iq24_from_double(-1.25));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -1.25, iq24_to_double(IQ24(-1.25)));
    const double pi = acos(-1.0);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.25), turns_from_rad(pi / 2.0 + 2000.0 * pi));
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25), turns_from_rad(-pi / 2.0));
    TEST_ASSERT_EQUAL_INT32(IQ24(0.08), turns_from_speed(2.0 * pi * 400.0, 2e-4));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_formulas);
    RUN_TEST(test_host_gives_the_same_constants);
    RUN_TEST(test_what_does_not_fit_is_named);
    RUN_TEST(test_conversions_saturate_and_wrap);
    return UNITY_END();
}
