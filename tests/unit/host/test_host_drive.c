/*
 * The firmware in closed loop with the switching-level drive: it regulates what its feedback promises, the
 * recording of it obeys the machine, and lateness seen through the HAL stops it.
 */
#include "../laboratory_motor.h"
#include "drive/drive_run.h"
#include "drive/firmware_host.h"

#include "unity.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static drive_host host;
static drive_row last; /* of the run */
static double largest_prediction_error_A;
static long rows;

void setUp(void)
{
    memset(&host, 0, sizeof host);
    rows = 0;
    largest_prediction_error_A = 0.0;
}

void tearDown(void)
{
}

static double complex vector_of(const double x[3])
{
    return 2.0 / 3.0 * (x[0] + x[1] * cexp(2.0 * I * pi / 3.0) + x[2] * cexp(-2.0 * I * pi / 3.0));
}

/*
 * Each row's current follows from the last by the machine's equation, mean voltage, R i frozen at the middle.
 */
static bool check_row(void *context, const drive_row *row, error *e)
{
    const motor *m = context;
    (void)e;
    if (rows > 0) {
        const double T = 1.0 / m->f_pwm_Hz;
        const double rho = m->R_ohm * T / m->L_d_H;
        const double phi = last.valley.omega_e_rad_s * T;
        const double complex i = vector_of(last.valley.i_A);
        const double complex u = vector_of(last.duty) * last.valley.u_dc_V;
        const double complex z = rho + I * phi;
        const double complex emf =
            I * m->psi_f_Wb * last.valley.omega_e_rad_s * cexp(I * last.valley.theta_e_rad);
        const double complex next = exp(-rho) * i + (1.0 - exp(-rho)) / m->R_ohm * u -
                                    emf * T / m->L_d_H * (cexp(I * phi) - exp(-rho)) / z;
        const double error_A = cabs(vector_of(row->valley.i_A) - next);
        largest_prediction_error_A = fmax(largest_prediction_error_A, error_A);
    }
    last = *row;
    rows++;
    return true;
}

static scenario_run steady(double rpm, double i_d_A, double i_q_A, long cycles)
{
    scenario_run run;
    memset(&run, 0, sizeof run);
    run.cycles = cycles;
    run.settle_cycles = 1500;
    run.speed_rpm = profile_constant(rpm);
    run.i_d_A = profile_constant(i_d_A);
    run.i_q_A = profile_constant(i_q_A);
    run.load_Nm = profile_constant(0.0);
    run.shaft = SHAFT_GIVEN;
    return run;
}

static bool run_drive(scenario_feedback feedback, const scenario_run *run, uint32_t *status, error *e)
{
    static motor m;
    m = laboratory_motor();
    const plant_config drive = plant_config_from_motor(&m);
    const scenario_control control = {feedback, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
    iqfoc_cycle_config_t config;
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    const drive_log log = {&m, check_row};
    return config_from_motor(&m, &control, &config, e) &&
           drive_run(&m, &drive, run, 1, &config, &firmware, &log, status, e);
}

static void test_mean_current_is_regulated(void)
{
    /* 5000 rpm, SFFR 20, both directions: with the quasi-discrete mean the true mean dq current meets its
     * reference. */
    for (int sign = -1; sign <= 1; sign += 2) {
        double miss[2];
        for (int k = 0; k < 2; k++) {
            uint32_t status = 0;
            error e = {0, ""};
            const scenario_run run = steady(sign * 5000.0, -3.0, 8.0, 50);
            rows = 0;
            TEST_ASSERT_TRUE_MESSAGE(
                run_drive(k == 0 ? FEEDBACK_MIDPOINT : FEEDBACK_QUASI_DISCRETE_MEAN, &run, &status, &e),
                e.text);
            TEST_ASSERT_EQUAL_INT(50, rows);
            TEST_ASSERT_EQUAL_UINT32(0, status & ~IQFOC_STATUS_VOLTAGE_LIMIT);
            miss[k] = hypot(last.truth.i_dq_A.d + 3.0, last.truth.i_dq_A.q - 8.0) / hypot(3.0, 8.0);
        }
        printf(
            "  true mean dq current off its reference at %d rpm: mid-point %.3f %%, quasi-discrete %.3f %%\n",
            sign * 5000, 100.0 * miss[0], 100.0 * miss[1]);
        TEST_ASSERT_TRUE(miss[1] < 0.005);
        TEST_ASSERT_TRUE(miss[0] > 3.0 * miss[1]);
    }
}

static void test_rows_obey_the_machine(void)
{
    uint32_t status = 0;
    error e = {0, ""};
    const scenario_run run = steady(3000.0, 0.0, 10.0, 500);
    TEST_ASSERT_TRUE_MESSAGE(run_drive(FEEDBACK_MIDPOINT, &run, &status, &e), e.text);
    /* The PWM's ripple is centred: it leaves the fundamental's valley samples to second order only. */
    printf("  largest departure of a row from the averaged machine: %.2e A\n", largest_prediction_error_A);
    TEST_ASSERT_TRUE(largest_prediction_error_A < 5e-3);
}

/* How late the firmware of the next run is: its interrupts, and its own work. */
static uint32_t latency_ticks, compute_ticks;

static bool start_late(void *context, const iqfoc_cycle_config_t *config, error *e)
{
    const bool started = drive_firmware_host(context, NULL).start(context, config, e);
    host.hal.latency_ticks = latency_ticks;
    host.hal.compute_ticks = compute_ticks;
    return started;
}

static bool run_late(iqfoc_cycle_config_t *config, uint32_t latency, uint32_t compute, error *e)
{
    static motor m;
    m = laboratory_motor();
    const plant_config drive = plant_config_from_motor(&m);
    const drive_log log = {&m, check_row};
    const scenario_run run = steady(1000.0, 0.0, 5.0, 10);
    uint32_t status = 0;
    drive_firmware firmware = drive_firmware_host(&host, NULL);
    firmware.start = start_late;
    latency_ticks = latency;
    compute_ticks = compute;
    *e = (error){0, ""};
    return drive_run(&m, &drive, &run, 7, config, &firmware, &log, &status, e);
}

static void stopped_by(const char *bit, const error *e)
{
    TEST_ASSERT_EQUAL_INT(STATUS_FAILED, e->status);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e->text, "run 7"), e->text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(e->text, bit), e->text);
}

/* To the tick of its limits it runs, a tick later it is stopped, and the message says by which bit. */
static void test_late_firmware_is_stopped(void)
{
    const motor m = laboratory_motor();
    const scenario_control control = {FEEDBACK_MIDPOINT, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
    iqfoc_cycle_config_t config;
    error e = {0, ""};
    TEST_ASSERT_TRUE(config_from_motor(&m, &control, &config, &e));
    TEST_ASSERT_TRUE_MESSAGE(run_late(&config, 0, config.deadline_ticks, &e), e.text);
    TEST_ASSERT_FALSE(run_late(&config, 0, config.deadline_ticks + 1, &e));
    stopped_by("LATE", &e);
    TEST_ASSERT_TRUE_MESSAGE(run_late(&config, config.stale_ticks, 0, &e), e.text);
    TEST_ASSERT_FALSE(run_late(&config, config.stale_ticks + 1, 0, &e));
    stopped_by("STALE", &e);
    /* So is one whose reference exceeds its limit of the current. */
    config.current_limit = IQ24(0.2);
    TEST_ASSERT_FALSE(run_late(&config, 0, 0, &e));
    stopped_by("OVERCURRENT", &e);
}

static void test_handler_sees_latency_and_its_own_duration(void)
{
    static motor m;
    m = laboratory_motor();
    const scenario_control control = {FEEDBACK_MIDPOINT, MODULATION_PWM, 0.0, 1, ANGLE_MEASURED};
    iqfoc_cycle_config_t config;
    error e = {0, ""};
    TEST_ASSERT_TRUE(config_from_motor(&m, &control, &config, &e));
    const drive_firmware firmware = drive_firmware_host(&host, NULL);
    drive_answer answer;
    iqfoc_sample_t sample = {.u_dc = IQ24_ONE, .time = UINT32_MAX - 5U};
    TEST_ASSERT_TRUE(firmware.start(firmware.context, &config, &e));
    host.hal.latency_ticks = config.stale_ticks;
    TEST_ASSERT_TRUE(firmware.valley(firmware.context, (iqfoc_dq_t){0, 0}, &sample, &e));
    TEST_ASSERT_EQUAL_UINT32(0, host.cycle.status);
    host.hal.latency_ticks = config.stale_ticks + 1;
    TEST_ASSERT_TRUE(firmware.peak(firmware.context, (iqfoc_dq_t){0, 0}, &sample, &answer, &e));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_STALE, answer.status);
    TEST_ASSERT_FALSE(answer.command.gates);

    TEST_ASSERT_TRUE(firmware.start(firmware.context, &config, &e));
    host.hal.compute_ticks = config.deadline_ticks + 1;
    TEST_ASSERT_TRUE(firmware.valley(firmware.context, (iqfoc_dq_t){0, 0}, &sample, &e));
    TEST_ASSERT_TRUE(firmware.peak(firmware.context, (iqfoc_dq_t){0, 0}, &sample, &answer, &e));
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_LATE, answer.status);
    TEST_ASSERT_FALSE(answer.command.gates);
    TEST_ASSERT_EQUAL_INT(1, host.hal.written);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mean_current_is_regulated);
    RUN_TEST(test_rows_obey_the_machine);
    RUN_TEST(test_late_firmware_is_stopped);
    RUN_TEST(test_handler_sees_latency_and_its_own_duration);
    return UNITY_END();
}
