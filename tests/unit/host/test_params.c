/*
 * Physical values to per unit: the compile-time macros and the host's conversion give the same constants,
 * those are what the formulas of docs/units.md give, and what does not fit is refused by its name.
 */
#include "../laboratory_motor.h"
#include "extension_host.h"
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
static const iq24_t folded_turns = IQFOC_SPEED(8000.0, 3, T_S);

void setUp(void)
{
}

void tearDown(void)
{
}

static motor laboratory(void)
{
    motor m = laboratory_motor();
    m.path = "m.toml";
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
    const scenario_control control = {FEEDBACK_QUASI_DISCRETE_MEAN, MODULATION_PWM, 250.0, 1, ANGLE_MEASURED};
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
    const scenario_control control = {FEEDBACK_MIDPOINT, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
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

/* A file that saturates: every constant is made of L_0_H in the axes' ratio, and none of [motor]'s own. */
static void test_inductances_are_those_at_zero_current(void)
{
    motor written = laboratory();
    motor meant = laboratory();
    written.L_d_H = 4e-3;
    written.L_q_H = 6e-3;
    written.ext.has[CAUSE_SATURATION] = true;
    written.ext.L_0_H = 7e-3;
    written.ext.I_sat_A = 40.0;
    meant.L_d_H = 5.6e-3;
    meant.L_q_H = 8.4e-3;
    iqfoc_predictor_t predictor[2];
    iqfoc_current_control_gains_t gains[2];
    iqfoc_exact_winding_t winding[2];
    iqfoc_salient_machine_t salient[2];
    iqfoc_flux_predictor_t flux[2];
    for (int k = 0; k < 2; k++) {
        const motor *m = k == 0 ? &written : &meant;
        error e = {0, ""};
        TEST_ASSERT_TRUE_MESSAGE(
            predictor_from_motor(m, &predictor[k], &e) && gains_from_motor(m, 250.0, &gains[k], &e) &&
                winding_from_motor(m, &winding[k], &e) && salient_from_motor(m, &salient[k], &e) &&
                flux_predictor_from_motor(m, &flux[k], &e),
            e.text);
    }
    /* Henries to 1e-16 of themselves: a rounding may fall the other way. */
    TEST_ASSERT_INT32_WITHIN(1, predictor[1].k_u, predictor[0].k_u);
    TEST_ASSERT_INT32_WITHIN(1, gains[1].kp_q, gains[0].kp_q);
    TEST_ASSERT_INT32_WITHIN(1, gains[1].x_d, gains[0].x_d);
    TEST_ASSERT_INT32_WITHIN(1, winding[1].k_psi_q27, winding[0].k_psi_q27);
    TEST_ASSERT_INT32_WITHIN(1, salient[1].k_d_q26, salient[0].k_d_q26);
    TEST_ASSERT_INT32_WITHIN(1, salient[1].rho_q_q30, salient[0].rho_q_q30);
    TEST_ASSERT_INT32_WITHIN(1, flux[1].l_d, flux[0].l_d);
    TEST_ASSERT_INT32_WITHIN(1, flux[1].k_q, flux[0].k_q);
}

/*
 * A flux map of a motor file, against its macros: x_0 of 3/4, so that its root is 5/4. Straight iron has what the parts
 * leave of L_d0 and L_q0, and the magnet what they add at no current.
 */
static void test_flux_map(void)
{
    motor m = laboratory();
    iqfoc_flux_map_t map;
    error e = {0, ""};
    m.ext.has[CAUSE_SATURATION_DQ] = true;
    m.ext.L_d0_H = 5e-3;
    m.ext.L_q0_H = 9e-3;
    m.ext.E_1_J = 0.5;
    m.ext.I_d1_A = 20.0;
    m.ext.I_q1_A = 10.0;
    m.ext.I_c1_A = 15.0;
    TEST_ASSERT_TRUE(motor_has_parts_alone(&m));
    TEST_ASSERT_TRUE_MESSAGE(flux_map_from_motor(&m, &map, &e), e.text);
    const iqfoc_flux_map_t want = IQFOC_FLUX_MAP(
        0.75, 5e-3 - 0.5 / 400.0 * 0.512, 9e-3 - 0.5 / 100.0 * 0.8, 0.134 + 0.5 / 20.0 * 0.6,
        IQFOC_FLUX_MAP_PART(0.5, 20.0, 10.0, 15.0, T_S, I_B, U_B), IQFOC_FLUX_MAP_NO_PART, T_S, I_B, U_B);
    TEST_ASSERT_INT32_WITHIN(1, want.l_d, map.l_d);
    TEST_ASSERT_INT32_WITHIN(1, want.l_q, map.l_q);
    TEST_ASSERT_EQUAL_INT32(want.r, map.r);
    TEST_ASSERT_INT32_WITHIN(1, want.psi, map.psi);
    TEST_ASSERT_EQUAL_MEMORY(want.part, map.part, sizeof map.part);
    /* Terms, I_sat; and a map of terms alone. */
    m.ext.w_dqq = -1e-5;
    TEST_ASSERT_FALSE(motor_has_parts_alone(&m));
    m.ext.w_dqq = 0.0;
    m.ext.I_sat_dq_A = 40.0;
    TEST_ASSERT_FALSE(motor_has_parts_alone(&m));
    m.ext.I_sat_dq_A = 0.0;
    /* A kink below a tenth of the rated peak, and parts that have more than the library holds. */
    m.ext.I_d1_A = 0.05 * I_B;
    TEST_ASSERT_FALSE(flux_map_from_motor(&m, &map, &e));
    TEST_ASSERT_NOT_NULL(strstr(e.text, "m.toml"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "I_b/I_d"), e.text);
    e = (error){0, ""};
    m.ext.L_q0_H = 0.409;
    m.ext.I_d1_A = 20.0;
    m.ext.E_1_J = 50.0;
    m.ext.L_d0_H = 0.07;
    TEST_ASSERT_FALSE(flux_map_from_motor(&m, &map, &e));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "16 U_b T"), e.text);
    m.ext.E_1_J = 0.0;
    TEST_ASSERT_FALSE(motor_has_parts_alone(&m));
}

/* A correction that does not fit is refused by file, key and constant. */
static void test_correction_that_does_not_fit_is_named(void)
{
    motor m = laboratory();
    iqfoc_extension_t extension;
    error e = {0, ""};
    m.ext.has[CAUSE_DEAD_TIME] = true;
    m.ext.v_dead_V = 200.0;
    TEST_ASSERT_FALSE(extension_from_motor(&m, &extension, &e));
    TEST_ASSERT_EQUAL_INT(STATUS_UNUSABLE, e.status);
    TEST_ASSERT_EQUAL_PTR(e.text, strstr(e.text, "m.toml"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "v_dead_V"), e.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e.text, "v_dead/U_b"), e.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_formulas);
    RUN_TEST(test_host_gives_the_same_constants);
    RUN_TEST(test_what_does_not_fit_is_named);
    RUN_TEST(test_conversions_saturate_and_wrap);
    RUN_TEST(test_inductances_are_those_at_zero_current);
    RUN_TEST(test_flux_map);
    RUN_TEST(test_correction_that_does_not_fit_is_named);
    return UNITY_END();
}
