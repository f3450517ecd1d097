/*
 * A drive without an angle sensor for tests: the library's cycle, start and observer on the machine of switched_machine.h, which is
 * closed over an inverter with dead time, 12 bit and noise. The sensor's angle may be wrong.
 */
#ifndef TESTS_UNIT_SENSORLESS_FIXTURE_H
#define TESTS_UNIT_SENSORLESS_FIXTURE_H

#include "iqfoc/params.h"
#include "iqfoc/sensorless.h"
#include "switched_machine.h"

/* EMF 0.45 of the link at 5 periods per turn, l i 0.6 of the magnet's flux and r i 0.03 of the link at the rated current. */
#define R_OHM  0.9
#define L_H    6.48e-4
#define PSI_WB 0.0108
#define T_S    1e-4
#define I_B_A  10.0
#define U_DC_V 300.0
#define PERIOD 10000U

/* Speed that the rated torque gives in a period, turns per period. */
#define GAIN_OF_TORQUE 1e-4

static const iqfoc_cycle_config_t usual = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(2000.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24(1.0),
    .current_limit = IQ24(4.0),
    .period_ticks = PERIOD,
    .tolerance_ticks = PERIOD / 10,
    .stale_ticks = PERIOD / 4,
    .deadline_ticks = PERIOD / 3,
    .trips = IQFOC_STATUS_OVERCURRENT | IQFOC_STATUS_MISSED,
};

static const iqfoc_observer_config_t observer_config =
    IQFOC_OBSERVER_CONFIG(R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V, 1600.0, IQ24(0.01));

static const iqfoc_start_config_t start_config = {.i_align = IQ24(0.6),
                                                  .ramp_cycles = 1500,
                                                  .hold_cycles = 3000,
                                                  .speed_end = IQ24(0.03),
                                                  .run_up_cycles = 6000};

/* 0.5 us of 100 us, and the knee of test_sensorless.c. */
static const iqfoc_extension_t losses = {.i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE},
                                         .k_u = IQ24_ONE,
                                         .v_dead = IQ24(0.005),
                                         .knee_inverse = IQ24(1.0 / 0.15)};

static iqfoc_cycle_config_t config;
static iqfoc_cycle_t cycle;
static iqfoc_sensorless_t drive;
static switched_machine m;
static double duty[3];
static double sensor_off; /* error of the measured angle, turns */
static double off;        /* angle of the observer minus the machine's, degrees */
static double torque;     /* over the rated torque, at the last valley */
static bool turns_freely;
static uint32_t ticks;

void setUp(void)
{
    config = usual;
    ticks = UINT32_MAX - 3 * PERIOD;
    m = (switched_machine){.r = 0.03,
                           .l_d = 0.216,
                           .l_q = 0.216,
                           .psi_f = 0.36,
                           .dead = 0.005,
                           .noise = 0.005,
                           .step = 4.0 / 4096.0,
                           .theta = 0.37,
                           .seed = 3};
    m.psi = switched_flux(&m, 0.0, m.theta);
    duty[0] = duty[1] = duty[2] = 0.5;
    turns_freely = true;
    sensor_off = 0.0;
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &config));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&drive, &observer_config, &start_config, &losses));
    cycle.enabled = true;
}

void tearDown(void)
{
}

static iqfoc_sample_t sample_of(iq24_t at)
{
    const double complex i = switched_sample(&m);
    const iqfoc_sample_t s = {
        .i = {to_iq24(phase_of(i, 0)), to_iq24(phase_of(i, 1)), to_iq24(phase_of(i, 2))},
        .theta = to_iq24(m.theta + sensor_off),
        .speed = to_iq24(m.speed),
        .u_dc = IQ24_ONE,
        .instant = at,
        .time = ticks};
    return s;
}

/* A period: `i_q` is the reference of a drive that runs on the angle of a sensor or of the observer. */
static void period(double i_q)
{
    iqfoc_sample_t valley = sample_of(0);
    torque = cimag(conj(m.psi) * switched_current(&m, m.psi, m.theta)) / m.psi_f;
    if (turns_freely) {
        const double drag = 10.0 * fmax(-0.02, fmin(0.02, m.speed)); /* at most 0.2 of the rated torque */
        m.speed += GAIN_OF_TORQUE * (torque - drag);
    }
    iqfoc_sensorless_valley(&drive, &cycle, &valley);
    off = 360.0 * remainder(drive.observer.theta_q32 / 4294967296.0 - m.theta, 1.0);
    if (drive.source == IQFOC_ANGLE_OBSERVED || drive.source == IQFOC_ANGLE_MEASURED) {
        const iqfoc_dq_t i_ref = {0, to_iq24(i_q)};
        cycle.i_ref = i_ref;
    }
    (void)iqfoc_cycle_valley(&cycle, &valley, ticks + 10);
    ticks += PERIOD / 2;
    switched_half(&m, duty, true);
    iqfoc_sample_t peak = sample_of(IQ24(0.5));
    iqfoc_sensorless_peak(&drive, &peak);
    const iqfoc_command_t command = iqfoc_cycle_peak(&cycle, &peak, IQ24(1.5), ticks + 10);
    ticks += PERIOD / 2;
    switched_half(&m, duty, false);
    duty[0] = to_double(command.duties.high.a);
    duty[1] = to_double(command.duties.high.b);
    duty[2] = to_double(command.duties.high.c);
}

#endif
