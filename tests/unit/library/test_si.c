/*
 * SI values to parameters while the drive runs: the same bits as the macros for twenty machines from a gimbal to a
 * locomotive, a refusal that names the value, and a set that is accepted as a whole.
 */
#include "iqfoc/cycle_steps.h"
#include "iqfoc/iqfoc_si.h"

#include "cycle_fixture.h"

#include <string.h>

/*
 * Machines of the kinds that data sheets list, with values of that size; none is a particular product.
 *           R      L_d     L_q     psi     I rms  U_dc  f_PWM
 */
#define MOTORS(X)                                                                                            \
    X(gimbal_12V, 10.0, 3e-3, 3e-3, 0.0056, 0.5, 12.0, 20000.0)                                              \
    X(gimbal_large, 5.6, 2.1e-3, 2.1e-3, 0.0158, 1.0, 24.0, 20000.0)                                         \
    X(drone_8uH, 0.012, 8e-6, 8e-6, 0.0012, 40.0, 48.0, 48000.0)                                             \
    X(drone_lift, 0.019, 24e-6, 24e-6, 0.0045, 35.0, 48.0, 32000.0)                                          \
    X(racing, 0.02, 9e-6, 11e-6, 0.00068, 25.0, 24.0, 48000.0)                                               \
    X(fan_24V, 0.8, 0.7e-3, 0.7e-3, 0.0065, 3.0, 24.0, 16000.0)                                              \
    X(servo_100W, 0.35, 0.32e-3, 0.32e-3, 0.0084, 5.0, 48.0, 16000.0)                                        \
    X(servo_400W, 1.5, 5.3e-3, 5.3e-3, 0.055, 2.7, 325.0, 10000.0)                                           \
    X(servo_750W, 0.43, 3.2e-3, 3.2e-3, 0.072, 4.6, 325.0, 10000.0)                                          \
    X(steering, 0.012, 60e-6, 68e-6, 0.0065, 70.0, 12.0, 20000.0)                                            \
    X(bicycle_hub, 0.12, 0.19e-3, 0.23e-3, 0.0095, 14.0, 36.0, 16000.0)                                      \
    X(scooter, 0.022, 0.07e-3, 0.09e-3, 0.013, 60.0, 72.0, 12000.0)                                          \
    X(washing, 4.1, 25e-3, 33e-3, 0.22, 2.2, 325.0, 16000.0)                                                 \
    X(compressor, 0.65, 7e-3, 12e-3, 0.11, 7.0, 325.0, 8000.0)                                               \
    X(laboratory_2019, 0.75, 5.2e-3, 5.2e-3, 0.134, 10.5, 750.0, 5000.0)                                     \
    X(spindle_60krpm, 0.09, 0.12e-3, 0.12e-3, 0.0115, 30.0, 560.0, 20000.0)                                  \
    X(crane_22kW, 0.11, 3.4e-3, 7.8e-3, 0.73, 41.0, 560.0, 4000.0)                                           \
    X(car_80kW, 0.0083, 0.17e-3, 0.38e-3, 0.072, 200.0, 375.0, 10000.0)                                      \
    X(car_200kW, 0.0046, 0.09e-3, 0.24e-3, 0.061, 380.0, 800.0, 10000.0)                                     \
    X(traction_400kW, 0.032, 1.1e-3, 1.6e-3, 1.35, 190.0, 1500.0, 2000.0)

typedef struct machine {
    const char *name;
    iqfoc_si_drive_t si;
    iqfoc_predictor_t predictor;
    iqfoc_current_control_gains_t gains;
    iqfoc_exact_winding_t winding;
} machine;

#define W(f) (6.283185307179586 * (f) / 20.0)
#define MACHINE(name, R, L_d, L_q, psi, I, U, f)                                                             \
    {#name,                                                                                                  \
     {R, L_d, L_q, psi, I, U, 1.0 / (f), W(f), 170e6},                                                       \
     IQFOC_PREDICTOR(R, 0.5 * ((L_d) + (L_q)), psi, 1.0 / (f), IQFOC_I_BASE(I), U),                          \
     IQFOC_GAINS(W(f), R, L_d, L_q, psi, 1.0 / (f), IQFOC_I_BASE(I), U),                                     \
     IQFOC_EXACT_WINDING(R, 0.5 * ((L_d) + (L_q)), psi, 1.0 / (f), IQFOC_I_BASE(I), U)},
static const machine machines[] = {MOTORS(MACHINE)};
enum { MACHINES = sizeof machines / sizeof machines[0] };

static void test_twenty_machines_by_both_paths(void)
{
    TEST_ASSERT_EQUAL_INT(20, MACHINES);
    for (int k = 0; k < MACHINES; k++) {
        const machine *m = &machines[k];
        iqfoc_cycle_config_t set = base_config;
        iqfoc_exact_winding_t winding;
        const char *refused = iqfoc_si_parameters(&m->si, &set);
        TEST_ASSERT_NULL_MESSAGE(refused, m->name);
        TEST_ASSERT_NULL_MESSAGE(iqfoc_si_winding(&m->si, &winding), m->name);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&m->predictor, &set.predictor, sizeof set.predictor, m->name);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&m->gains, &set.gains, sizeof set.gains, m->name);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&m->winding, &winding, sizeof winding, m->name);
        TEST_ASSERT_EQUAL_UINT32((uint32_t)(170e6 * m->si.T_s + 0.5), set.period_ticks);
        TEST_ASSERT_EQUAL_INT_MESSAGE(IQFOC_OK, iqfoc_cycle_init(&cycle, &set), m->name);
    }
}

static void refused(iqfoc_si_drive_t si, const char *value)
{
    iqfoc_cycle_config_t set = base_config;
    const char *text = iqfoc_si_parameters(&si, &set);
    TEST_ASSERT_NOT_NULL_MESSAGE(text, value);
    TEST_ASSERT_EQUAL_STRING_LEN(value, text, strlen(value));
    TEST_ASSERT_EQUAL_MEMORY(&base_config, &set, sizeof set);
}

#define REFUSED(field, wrong)                                                                                \
    do {                                                                                                     \
        iqfoc_si_drive_t si = machines[0].si;                                                                \
        si.field = wrong;                                                                                    \
        refused(si, #field);                                                                                 \
    } while (0)

static void test_a_refusal_names_the_value(void)
{
    REFUSED(R_ohm, -1.0);
    REFUSED(R_ohm, 100.0); /* R T/L above 1 */
    REFUSED(R_ohm, (double)NAN);
    REFUSED(L_d_H, 0.0);
    REFUSED(L_d_H, 1.0); /* w L_d above 32 */
    REFUSED(L_q_H, -1.0);
    REFUSED(psi_Wb, -0.1);
    REFUSED(psi_Wb, 1.0);
    REFUSED(I_rated_A_rms, 0.0);
    REFUSED(U_dc_V, 0.0);
    REFUSED(U_dc_V, (double)INFINITY);
    REFUSED(T_s, 0.0);
    REFUSED(w_rad_s, -1.0);
    REFUSED(w_rad_s, 1e6);
    REFUSED(ticks_per_s, 1e15);
}

/* Each valley's prediction is by one set or the other, and a set is in force from the second valley on. */
static void test_a_set_is_taken_at_a_valley(void)
{
    iqfoc_cycle_config_t other = config;
    other.predictor.k_u /= 2;
    other.period_ticks = PERIOD + PERIOD / 2;
    cycle.enabled = true;
    valley();
    (void)peak();
    TEST_ASSERT_TRUE(iqfoc_cycle_taken(&cycle));
    other.span_max = 0;
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_SPAN, iqfoc_cycle_offer(&cycle, &other));
    TEST_ASSERT_TRUE(iqfoc_cycle_taken(&cycle));
    other.span_max = config.span_max;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_offer(&cycle, &other));
    TEST_ASSERT_FALSE(iqfoc_cycle_taken(&cycle));
    TEST_ASSERT_EQUAL_UINT32(PERIOD, iqfoc_cycle_next_ticks(&cycle));
    valley();
    TEST_ASSERT_EQUAL_PTR(&config, cycle.config);
    TEST_ASSERT_EQUAL_UINT32(other.period_ticks, iqfoc_cycle_next_ticks(&cycle));
    cycle.i_ref.q = IQ24(0.2);
    iqfoc_sample_t s = sample_at(IQ24(0.5));
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks + 10);
    /* The command's angle: half of this period is left, and half of the longer one follows: 0.5 + 0.75. */
    const iqfoc_dq_t back = iqfoc_park(cycle.u_ab, iq24_sincos(s.theta + to_iq24(0.02 * 1.25)));
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.d, back.d);
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.q, back.q);
    TEST_ASSERT_FALSE(iqfoc_cycle_taken(&cycle));
    ticks += PERIOD / 2;
    valley();
    TEST_ASSERT_EQUAL_PTR(&other, cycle.config);
    TEST_ASSERT_TRUE(iqfoc_cycle_taken(&cycle));
    ticks += PERIOD / 4; /* the cycle that is now running is longer, and nothing was missed */
    (void)peak();
    ticks += PERIOD / 4;
    valley();
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status & IQFOC_STATUS_MISSED);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_twenty_machines_by_both_paths);
    RUN_TEST(test_a_refusal_names_the_value);
    RUN_TEST(test_a_set_is_taken_at_a_valley);
    return UNITY_END();
}
