/*
 * The replay of a recording through the firmware's observer (sim_host/observe): a drive in closed loop on the observed
 * angle, and the same angle again from what was recorded of it.
 */
#include "../laboratory_motor.h"

#include "drive/drive_run.h"
#include "drive/firmware_host.h"
#include "observe/observe.h"
#include "params_host.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 3000, COLUMNS = 12 };

static const char *const names[COLUMNS] = {"t_s",           "i_a_A",     "i_b_A",     "i_c_A",
                                           "i_a_mid_A",     "i_b_mid_A", "i_c_mid_A", "theta_e_rad",
                                           "omega_e_rad_s", "u_a_V",     "u_b_V",     "u_c_V"};

static motor m;
static drive_host host;
static double column[COLUMNS][ROWS];
static iq24_t theta[ROWS]; /* of the firmware's observer */
static iq24_t turns_of_row[ROWS];
static size_t rows;
static size_t cycles;
static bool from_duties; /* the recorded voltage is that of the duties, in place of the firmware's own */

void setUp(void)
{
    memset(&host, 0, sizeof host);
    rows = 0;
    cycles = 0;
    from_duties = false;
    m = laboratory_motor();
    m.ext.has[CAUSE_DEAD_TIME] = true;
    m.ext.v_dead_V = 3.75;
}

void tearDown(void)
{
}

/*
 * The firmware starts its observer for the last time at the second valley: there it begins as the replay does, and the
 * recording begins there.
 */
static void begin_as_replay(const drive_row *row)
{
    const iq24_t turns = turns_from_speed(row->valley.omega_e_rad_s, 1.0 / m.f_pwm_Hz);
    iqfoc_observer_start(&host.sensorless.observer, host.cycle.i_valley,
                         iq24_add_wrap(turns_from_rad(row->valley.theta_e_rad), IQ24(0.5)), turns, false);
}

static void phases_of(double complex u, double phase[3])
{
    phase[0] = creal(u);
    phase[1] = -0.5 * creal(u) + 0.5 * sqrt(3.0) * cimag(u);
    phase[2] = -0.5 * creal(u) - 0.5 * sqrt(3.0) * cimag(u);
}

static bool add_row(void *context, const drive_row *row, error *e)
{
    (void)context;
    (void)e;
    if (cycles++ == 0) {
        return true;
    }
    const size_t k = rows++;
    if (k == 0) {
        begin_as_replay(row);
    }
    double u_V[3];
    phases_of(complex_from_ab(host.cycle.u_now, m.u_dc_V), u_V);
    if (from_duties) {
        recording_commanded(row->duty, row->valley.u_dc_V, u_V);
    }
    column[0][k] = (double)k / m.f_pwm_Hz;
    column[7][k] = row->valley.theta_e_rad;
    column[8][k] = row->valley.omega_e_rad_s;
    for (int x = 0; x < 3; x++) {
        column[1 + x][k] = row->valley.i_A[x];
        column[4 + x][k] = row->peak.i_A[x];
        column[9 + x][k] = u_V[x];
    }
    theta[k] = iqfoc_observer_theta(&host.sensorless.observer, 0);
    turns_of_row[k] = iqfoc_observer_speed(&host.sensorless.observer);
    return true;
}

/* The drive at 8000 rpm on the observed angle, with 12 bit, noise, dead time, and a step of the current. */
static void run_drive(double sffr)
{
    m.f_pwm_Hz = 400.0 * sffr;
    m.ext.i_knee_A = 0.1 * m.u_dc_V / (m.L_d_H * m.f_pwm_Hz);
    plant_config drive = plant_config_from_motor(&m);
    drive.inverter.t_dead_s = 0.005 / m.f_pwm_Hz;
    drive.sensors.current_bits = 12;
    drive.sensors.current_full_scale_A = 30.0;
    drive.sensors.current_noise_A = 0.07;
    const scenario_control control = {FEEDBACK_QUASI_DISCRETE_MEAN, MODULATION_PWM, 0.0, 1, ANGLE_OBSERVED};
    const scenario_run run = {.cycles = ROWS + 1,
                              .speed_rpm = profile_constant(8000.0),
                              .i_d_A = profile_constant(0.0),
                              .i_q_A = profile_constant(8.0),
                              .load_Nm = profile_constant(0.0)};
    iqfoc_cycle_config_t config;
    error e = {0};
    uint32_t status = 0;
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    const drive_log log = {NULL, add_row};
    TEST_ASSERT_TRUE_MESSAGE(drive_host_observe(&host, &m, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(config_from_motor(&m, &control, &config, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(drive_run(&m, &drive, &run, 1, &config, &firmware, &log, &status, &e), e.text);
    TEST_ASSERT_EQUAL_size_t(ROWS, rows);
    TEST_ASSERT_EQUAL_INT(IQFOC_ANGLE_OBSERVED, host.sensorless.source);
}

/* Replayed minus the firmware's angle, LSB. In a row that is not settled, 0. */
static int32_t apart(const chart_data *series, size_t k)
{
    const double degrees = series->value[(k - 1) * OBSERVE_COLUMNS + 3];
    const double observed = degrees / 360.0 * 16777216.0 + turns_from_rad(column[7][k]);
    return isnan(degrees) ? 0 : (int32_t)(((uint32_t)llround(observed) - (uint32_t)theta[k]) << 8) / 256;
}

/* And of the speed, which each row has. */
static double speed_apart(const chart_data *series, size_t k)
{
    const double rpm = series->value[(k - 1) * OBSERVE_COLUMNS + 2];
    return rpm * m.pole_pairs / (60.0 * m.f_pwm_Hz) * 16777216.0 - turns_of_row[k];
}

static void check_replay(double sffr, int32_t most)
{
    const double *value[COLUMNS];
    recording r;
    error e = {0};
    observe_result result;
    chart_data series = chart_data_of(OBSERVE_COLUMNS);
    setUp();
    from_duties = most > 0;
    run_drive(sffr);
    for (int n = 0; n < COLUMNS; n++) {
        value[n] = column[n];
    }
    TEST_ASSERT_TRUE_MESSAGE(recording_make(&r, "run", ROWS, COLUMNS, names, value, &e), e.text);
    TEST_ASSERT_TRUE_MESSAGE(observe_recording(&r, &m, 0.0, &result, &series, &e), e.text);
    TEST_ASSERT_EQUAL_size_t(ROWS - 1, series.rows);
    TEST_ASSERT_GREATER_THAN(ROWS - OBSERVE_SETTLED_ROWS - 50, result.all.count);
    for (size_t k = 1; k < ROWS; k++) {
        TEST_ASSERT_INT32_WITHIN(most, 0, apart(&series, k));
        TEST_ASSERT_DOUBLE_WITHIN(most + 1e-3, 0.0, speed_apart(&series, k));
    }
    chart_data_free(&series);
    recording_free(&r);
}

static const double ratio[] = {3.5, 5.0, 8.0, 12.5, 20.0, 50.0};

/* With the voltage that the firmware commanded, each bit is the same, from the first row on. */
static void test_the_same_angle_bit_for_bit(void)
{
    for (size_t n = 0; n < sizeof ratio / sizeof ratio[0]; n++) {
        check_replay(ratio[n], 0);
    }
}

/* The duties, as `iqfoc simulate` records them, are rounded: 2^-24 of the link. */
static void test_the_same_angle_from_duties(void)
{
    for (size_t n = 0; n < sizeof ratio / sizeof ratio[0]; n++) {
        check_replay(ratio[n], 2);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_same_angle_bit_for_bit);
    RUN_TEST(test_the_same_angle_from_duties);
    return UNITY_END();
}
