/*
 * The cycle: order of calls, time, status, safe output; then closed loop on a small machine that is
 * integrated here, stationary frame, fourth order, mean voltages. The switching-level drive has tests of its
 * own (test_host_drive).
 */
#include "iqfoc/cycle.h"
#include "iqfoc/params.h"
#include "iqfoc/transform.h"
#include "reference.h"

#include <complex.h>
#include <stdbool.h>
#include <string.h>

/* The 2019 paper's laboratory drive at its f_PWM; bases as docs/units.md has them. */
#define R_OHM  0.75
#define L_H    5.2e-3
#define PSI_WB 0.134
#define T_S    2e-4
#define U_DC_V 750.0
#define I_B_A  IQFOC_I_BASE(10.5)

#define PERIOD 34000U /* ticks: 170 MHz, 5 kHz */

static const iqfoc_cycle_config_t base_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(1200.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_MIDPOINT,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(1.0),
    .current_limit = IQ24(2.0),
    .period_ticks = PERIOD,
    .tolerance_ticks = PERIOD / 100,
    .stale_ticks = PERIOD / 4,
    .deadline_ticks = PERIOD / 3,
    .trips = IQFOC_STATUS_MISSED | IQFOC_STATUS_STALE | IQFOC_STATUS_LATE | IQFOC_STATUS_OVERCURRENT,
};

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static uint32_t ticks;

void setUp(void)
{
    config = base_config;
    ticks = UINT32_MAX - 3 * PERIOD; /* every test crosses the timer's wrap */
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
}

void tearDown(void)
{
}

static iqfoc_sample_t sample_at(iq24_t at)
{
    const iqfoc_sample_t s = {
        .theta = IQ24(0.1), .turns = IQ24(0.02), .u_dc = IQ24_ONE, .at = at, .time = ticks};
    return s;
}

static void valley(void)
{
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + 10);
    ticks += PERIOD / 2;
}

static iqfoc_command_t peak(void)
{
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks + 10);
    ticks += PERIOD / 2;
    return command;
}

static void run_healthy(int32_t cycles)
{
    for (int32_t n = 0; n < cycles; n++) {
        valley();
        (void)peak();
    }
}

static void expect_safe(iqfoc_command_t command)
{
    TEST_ASSERT_FALSE(command.gates);
    TEST_ASSERT_EQUAL_INT32(0, command.duties.high.a | command.duties.high.b | command.duties.high.c);
    TEST_ASSERT_EQUAL_INT64(0, cycle.control.integral_d | cycle.control.integral_q);
    TEST_ASSERT_EQUAL_INT32(0, cycle.u_ab.alpha | cycle.u_ab.beta);
}

/* A change to the configuration that init must refuse with this error, the object untouched. */
static void refused(iqfoc_error_t want, const iqfoc_cycle_config_t *bad)
{
    iqfoc_cycle_t object;
    iqfoc_cycle_t before;
    memset(&object, 0x5A, sizeof object);
    before = object;
    TEST_ASSERT_EQUAL_INT(want, iqfoc_cycle_init(&object, bad));
    TEST_ASSERT_EQUAL_MEMORY(&before, &object, sizeof object);
}

#define REFUSED(want, field, value)                                                                          \
    do {                                                                                                     \
        iqfoc_cycle_config_t bad = base_config;                                                              \
        bad.field = value;                                                                                   \
        refused(want, &bad);                                                                                 \
    } while (0)

static void test_init_refuses_by_name(void)
{
    refused(IQFOC_ERROR_NULL, NULL);
    TEST_ASSERT_EQUAL_INT(IQFOC_ERROR_NULL, iqfoc_cycle_init(NULL, &base_config));
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_u, 0);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_u, IQ24(16.0) + 1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_r, -1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_r, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_psi, -1);
    REFUSED(IQFOC_ERROR_PREDICTOR, predictor.k_psi, IQ24(8.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.kp_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.kp_q, IQ24(32.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.ki_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.ki_q, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.anti_windup, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.x_d, -1);
    REFUSED(IQFOC_ERROR_GAINS, gains.x_q, IQ24(96.0) + 1);
    REFUSED(IQFOC_ERROR_GAINS, gains.emf, IQ24(96.0) + 1);
    REFUSED(IQFOC_ERROR_SPAN, span_max, 0);
    REFUSED(IQFOC_ERROR_SPAN, span_max, IQ24_ONE + 1);
    REFUSED(IQFOC_ERROR_CURRENT_LIMIT, current_limit, 0);
    REFUSED(IQFOC_ERROR_CURRENT_LIMIT, current_limit, IQ24(16.0) + 1);
    REFUSED(IQFOC_ERROR_CHOICE, feedback, (iqfoc_feedback_t)7);
    REFUSED(IQFOC_ERROR_CHOICE, modulation, (iqfoc_modulation_t)7);
    REFUSED(IQFOC_ERROR_CHOICE, safe_state, (iqfoc_safe_state_t)7);
}

static void test_starts_disabled_and_safe(void)
{
    valley();
    expect_safe(peak());
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    cycle.enabled = true;
    valley();
    TEST_ASSERT_TRUE(peak().gates);
}

static void test_short_circuit_is_the_other_safe_state(void)
{
    config.safe_state = IQFOC_SAFE_SHORT_CIRCUIT;
    valley();
    const iqfoc_command_t command = peak();
    TEST_ASSERT_TRUE(command.gates);
    TEST_ASSERT_EQUAL_INT32(0, command.duties.high.a | command.duties.high.b | command.duties.high.c);
}

static void test_missed_peak_trips_until_cleared(void)
{
    cycle.enabled = true;
    run_healthy(5);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    valley();
    ticks += PERIOD / 2;
    valley();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    expect_safe(peak());
    run_healthy(3);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    valley();
    expect_safe(peak());
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    valley();
    TEST_ASSERT_TRUE(peak().gates);
}

static void test_missed_valley_and_missed_cycle(void)
{
    cycle.enabled = true;
    run_healthy(5);
    (void)peak();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    iqfoc_cycle_clear(&cycle);
    ticks += PERIOD / 2;
    run_healthy(3);
    ticks += PERIOD; /* a valley and its peak were lost together: only time tells */
    valley();
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_MISSED, cycle.status);
    TEST_ASSERT_EQUAL_INT32(0, cycle.error.alpha | cycle.error.beta);
}

static void test_no_time_checks_without_a_period(void)
{
    config.period_ticks = 0;
    cycle.enabled = true;
    run_healthy(2);
    ticks += 7 * PERIOD;
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + 3 * PERIOD);
    TEST_ASSERT_TRUE(iqfoc_cycle_in_time(&cycle, &s, ticks + 3 * PERIOD));
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
}

static void test_stale_sample_by_its_age(void)
{
    cycle.enabled = true;
    run_healthy(3);
    const iqfoc_sample_t s = sample_at(0);
    iqfoc_cycle_valley(&cycle, &s, ticks + config.stale_ticks);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    ticks += PERIOD / 2;
    const iqfoc_sample_t old = sample_at(IQ24(0.5));
    expect_safe(iqfoc_cycle_peak(&cycle, &old, IQ24(1.5), ticks + config.stale_ticks + 1));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_STALE, cycle.status);
}

static void test_late_command(void)
{
    cycle.enabled = true;
    run_healthy(3);
    valley();
    const iqfoc_sample_t s = sample_at(IQ24(0.5));
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
    TEST_ASSERT_TRUE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks));
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + config.deadline_ticks + 1));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LATE, cycle.status);
    TEST_ASSERT_TRUE(cycle.tripped);
    expect_safe(iqfoc_cycle_safe(&config));
    /* Where it does not trip, the bit is all. */
    config.trips = 0;
    iqfoc_cycle_clear(&cycle);
    TEST_ASSERT_FALSE(iqfoc_cycle_in_time(&cycle, &s, ticks + PERIOD));
    TEST_ASSERT_FALSE(cycle.tripped);
}

static void test_what_is_measured_beyond_its_range(void)
{
    config.trips = 0;
    cycle.enabled = true;
    iqfoc_sample_t s = sample_at(0);
    s.clipped = true;
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_SAMPLE_CLIPPED, cycle.status);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.i.a = IQ24(2.1);
    s.i.b = IQ24(-1.05);
    s.i.c = IQ24(-1.05);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERCURRENT, cycle.status);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.turns = IQ24(-0.4);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_OVERSPEED, cycle.status);
    TEST_ASSERT_EQUAL_INT32(-IQFOC_ROTOR_TURNS_MAX, cycle.rotor.turns);

    iqfoc_cycle_clear(&cycle);
    s = sample_at(0);
    s.u_dc = IQ24(0.3);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_DC_LINK, cycle.status);
}

static void test_voltage_limit_shows(void)
{
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(8.0);
    valley();
    const iqfoc_command_t command = peak();
    TEST_ASSERT_TRUE(command.duties.scale < IQ24_ONE);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_VOLTAGE_LIMIT, cycle.status);
    /* As a trip, it stops the drive at once. */
    config.trips = IQFOC_STATUS_VOLTAGE_LIMIT;
    iqfoc_cycle_clear(&cycle);
    valley();
    expect_safe(peak());
}

static void test_output_acts_at_the_angle_of_its_middle(void)
{
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(0.2);
    valley();
    iqfoc_sample_t s = sample_at(IQ24(0.5));
    s.turns = IQ24(0.08);
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
    const iqfoc_dq_t back = iqfoc_park(cycle.u_ab, iq24_sincos(s.theta + s.turns));
    TEST_ASSERT_INT32_WITHIN(2, cycle.u_dq.d, back.d);
    TEST_ASSERT_INT32_WITHIN(2, cycle.u_dq.q, back.q);
    /* A sample taken a tenth of a cycle later, an output two cycles long. */
    valley();
    s.at = IQ24(0.6);
    (void)iqfoc_cycle_peak(&cycle, &s, IQ24(2.0), ticks);
    const iqfoc_dq_t late = iqfoc_park(cycle.u_ab, iq24_sincos(s.theta + to_iq24(0.08 * 1.4)));
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.d, late.d);
    TEST_ASSERT_INT32_WITHIN(4, cycle.u_dq.q, late.q);
}

static void test_dc_link_inverse_follows(void)
{
    const double steps[] = {1.0, 1.1, 0.5, 1.5, 0.5, 0.9};
    for (int32_t k = 0; k < 6; k++) {
        for (int32_t n = 0; n < 8; n++) {
            valley();
            iqfoc_sample_t s = sample_at(IQ24(0.5));
            s.u_dc = to_iq24(steps[k]);
            (void)iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
            if (k == 1 && n == 0) { /* the header's 1 % after a step of 10 % */
                TEST_ASSERT_DOUBLE_WITHIN(0.0101, 1.0, to_double(cycle.u_dc_inverse) * steps[k]);
            }
            if (k == 1 && n == 1) {
                TEST_ASSERT_DOUBLE_WITHIN(1.01e-4, 1.0, to_double(cycle.u_dc_inverse) * steps[k]);
            }
        }
        TEST_ASSERT_DOUBLE_WITHIN(2.5e-7, 1.0 / steps[k], to_double(cycle.u_dc_inverse));
    }
}

/* ---- Closed loop ---- */

typedef struct machine {
    double complex i;       /* A */
    double theta, omega_T;  /* rad, rad per cycle */
    double complex mean_dq; /* true means since they were last zeroed, A */
    double complex mean_ab;
} machine;

static void machine_advance(machine *m, double complex u_V, double part)
{
    enum { STEPS = 20 };
    const double h = part * T_S / STEPS;
    const double omega = m->omega_T / T_S;
    double complex sum = 0.0;
    for (int n = 0; n < STEPS; n++) {
        const double complex e0 = I * omega * PSI_WB * cexp(I * m->theta);
        const double complex e1 = I * omega * PSI_WB * cexp(I * (m->theta + 0.5 * omega * h));
        const double complex e2 = I * omega * PSI_WB * cexp(I * (m->theta + omega * h));
        const double complex k1 = (u_V - R_OHM * m->i - e0) / L_H;
        const double complex k2 = (u_V - R_OHM * (m->i + 0.5 * h * k1) - e1) / L_H;
        const double complex k3 = (u_V - R_OHM * (m->i + 0.5 * h * k2) - e1) / L_H;
        const double complex k4 = (u_V - R_OHM * (m->i + h * k3) - e2) / L_H;
        const double complex begin = m->i * cexp(-I * m->theta);
        const double complex i_mid =
            m->i + 0.25 * h * (k1 + k2); /* third order: enough for the means' fourth */
        const double complex middle = i_mid * cexp(-I * (m->theta + 0.5 * omega * h));
        m->mean_ab +=
            (m->i + 4.0 * i_mid + m->i + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)) / 6.0 / STEPS * part;
        m->i += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        m->theta += omega * h;
        sum += (begin + 4.0 * middle + m->i * cexp(-I * m->theta)) / 6.0 / STEPS;
    }
    m->mean_dq += sum * part;
}

static iqfoc_abc_t phases_of(double complex i_A)
{
    const double complex i = i_A / I_B_A;
    const iqfoc_abc_t abc = {to_iq24(creal(i)), to_iq24(creal(i * cexp(-I * TWO_PI / 3.0))),
                             to_iq24(creal(i * cexp(I * TWO_PI / 3.0)))};
    return abc;
}

static iqfoc_sample_t measured(const machine *m, iq24_t at)
{
    iqfoc_sample_t s = sample_at(at);
    s.i = phases_of(m->i);
    s.i_mean = phases_of(m->mean_ab);
    s.theta = to_iq24(remainder(m->theta / TWO_PI, 1.0));
    s.turns = to_iq24(m->omega_T / TWO_PI);
    return s;
}

/* Runs to the steady state; gives the true mean dq current of the last cycle, in per unit. */
static double complex settled_mean(iqfoc_feedback_t feedback, bool averaging, double turns,
                                   double complex ref)
{
    config.feedback = feedback;
    config.tolerance_ticks = PERIOD;
    iqfoc_cycle_clear(&cycle);
    cycle.enabled = true;
    cycle.i_ref.d = to_iq24(creal(ref));
    cycle.i_ref.q = to_iq24(cimag(ref));
    machine m = {0.0, 0.3, TWO_PI * turns, 0.0, 0.0};
    iqfoc_duties_t duties = {{IQ24(0.5), IQ24(0.5), IQ24(0.5)}, IQ24_ONE};
    for (int32_t n = 0; n < 1500; n++) {
        const iqfoc_ab_t legs = iqfoc_clarke3(duties.high);
        const double complex u = U_DC_V * (to_double(legs.alpha) + I * to_double(legs.beta));
        iqfoc_sample_t at_valley = measured(&m, 0);
        at_valley.has_mean = averaging;
        m.mean_ab = 0.0;
        m.mean_dq = 0.0;
        iqfoc_cycle_valley(&cycle, &at_valley, ticks + 5);
        machine_advance(&m, u, 0.5);
        ticks += PERIOD / 2;
        const iqfoc_sample_t at_peak = measured(&m, IQ24(0.5));
        duties = iqfoc_cycle_peak(&cycle, &at_peak, IQ24(1.5), ticks + 5).duties;
        machine_advance(&m, u, 0.5);
        ticks += PERIOD / 2;
    }
    return m.mean_dq / I_B_A;
}

static void test_feedback_decides_what_is_regulated(void)
{
    /* A twelfth of a turn per cycle: SFFR 12. The mean dq current misses its reference by what the feedback
     * leaves out. */
    const double complex ref = 0.0 + 0.5 * I;
    const double midpoint = cabs(settled_mean(IQFOC_FEEDBACK_MIDPOINT, false, 1.0 / 12.0, ref) - ref) / 0.5;
    const uint32_t midpoint_status = cycle.status;
    const double corrected =
        cabs(settled_mean(IQFOC_FEEDBACK_CORRECTED_MEAN, false, 1.0 / 12.0, ref) - ref) / 0.5;
    const uint32_t corrected_status = cycle.status;
    const double quasi =
        cabs(settled_mean(IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN, false, 1.0 / 12.0, ref) - ref) / 0.5;
    /* The same correction, fed by a port that averages the phase currents over the cycle. */
    const double averaged =
        cabs(settled_mean(IQFOC_FEEDBACK_CORRECTED_MEAN, true, 1.0 / 12.0, ref) - ref) / 0.5;
    printf("  mean dq current off its reference at SFFR 12: mid-point %.4f %%, corrected %.4f %%, corrected "
           "with an "
           "averaging port %.4f %%, quasi-discrete %.4f %%\n",
           100.0 * midpoint, 100.0 * corrected, 100.0 * averaged, 100.0 * quasi);
    TEST_ASSERT_EQUAL_UINT32(0, midpoint_status);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_NO_INTERVAL, corrected_status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
    TEST_ASSERT_TRUE(midpoint > 0.03 && midpoint < 0.05);
    TEST_ASSERT_TRUE(corrected < midpoint);
    TEST_ASSERT_TRUE(averaged < 0.1 * midpoint);
    TEST_ASSERT_TRUE(quasi < 0.1 * midpoint);
}

static void test_prediction_error_is_what_the_model_leaves(void)
{
    /* Only R i is frozen: of the order rho/2 of the current's change over a cycle, 2019 Table 1. */
    (void)settled_mean(IQFOC_FEEDBACK_MIDPOINT, false, 1.0 / 12.5, 1.0 * I);
    const double error = hypot(to_double(cycle.error.alpha), to_double(cycle.error.beta));
    printf("  prediction error at SFFR 12.5: %.3f %% of the current\n", 100.0 * error);
    TEST_ASSERT_TRUE(error > 0.006 && error < 0.0095);
}

static void test_averaging_port_replaces_the_valley_sample(void)
{
    config.feedback = IQFOC_FEEDBACK_CORRECTED_MEAN;
    cycle.enabled = true;
    run_healthy(2);
    iqfoc_sample_t s = sample_at(0);
    s.has_mean = true;
    s.i_mean.a = IQ24(0.6);
    s.i_mean.b = IQ24(-0.3);
    s.i_mean.c = IQ24(-0.3);
    iqfoc_cycle_valley(&cycle, &s, ticks);
    ticks += PERIOD / 2;
    (void)peak();
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(s.turns);
    /* The current is zero at both ends: only s1 of the mean is left, seen from the middle of the cycle that
     * ended; every sample here has the same angle, so that the middle is half a cycle's turn on. */
    const double angle = TWO_PI * (to_double(s.theta) + 0.5 * to_double(s.turns));
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(0.6 * to_double(rotor.s1) * cos(angle)), cycle.i_dq.d);
    TEST_ASSERT_INT32_WITHIN(4, to_iq24(-0.6 * to_double(rotor.s1) * sin(angle)), cycle.i_dq.q);
}

static void test_six_step_takes_the_nearest_state(void)
{
    config.modulation = IQFOC_MODULATION_SIX_STEP;
    config.current_limit = IQ24(4.0);
    cycle.enabled = true;
    cycle.i_ref.q = IQ24(0.3);
    for (int32_t n = 0; n < 40; n++) {
        valley();
        iqfoc_sample_t s = sample_at(IQ24(0.5));
        s.theta = n * (IQ24_ONE / 40);
        const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &s, IQ24(1.5), ticks);
        ticks += PERIOD / 2;
        const double turned = TWO_PI * (to_double(s.theta) + to_double(s.turns));
        const double angle = atan2(to_double(cycle.u_dq.q), to_double(cycle.u_dq.d)) + turned;
        const double off =
            remainder(angle - atan2(to_double(cycle.u_ab.beta), to_double(cycle.u_ab.alpha)), TWO_PI);
        TEST_ASSERT_TRUE(fabs(off) <= TWO_PI / 12.0 + 1e-6);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 / 3.0,
                                  hypot(to_double(cycle.u_ab.alpha), to_double(cycle.u_ab.beta)));
        const iqfoc_ab_t legs = iqfoc_clarke3(command.duties.high);
        TEST_ASSERT_INT32_WITHIN(2, cycle.u_ab.alpha, legs.alpha);
        TEST_ASSERT_INT32_WITHIN(2, cycle.u_ab.beta, legs.beta);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_refuses_by_name);
    RUN_TEST(test_starts_disabled_and_safe);
    RUN_TEST(test_short_circuit_is_the_other_safe_state);
    RUN_TEST(test_missed_peak_trips_until_cleared);
    RUN_TEST(test_missed_valley_and_missed_cycle);
    RUN_TEST(test_no_time_checks_without_a_period);
    RUN_TEST(test_stale_sample_by_its_age);
    RUN_TEST(test_late_command);
    RUN_TEST(test_what_is_measured_beyond_its_range);
    RUN_TEST(test_voltage_limit_shows);
    RUN_TEST(test_output_acts_at_the_angle_of_its_middle);
    RUN_TEST(test_dc_link_inverse_follows);
    RUN_TEST(test_feedback_decides_what_is_regulated);
    RUN_TEST(test_prediction_error_is_what_the_model_leaves);
    RUN_TEST(test_averaging_port_replaces_the_valley_sample);
    RUN_TEST(test_six_step_takes_the_nearest_state);
    return UNITY_END();
}
