/*
 * The template's firmware (examples/template-stm32f405/drive.c) against the switching plant: from power-on with a
 * rotor at any angle to torque, and its reaction to faults. Compiled for the first run and for later ones.
 */
#include "around_drive.h"
#include "drive.h"

#include "iqfoc/encoder.h"
#include "iqfoc/tracker.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

#define COUNTS 4096

static around_drive d;
static drive_t drive;
static iqfoc_encoder_t encoder;
static iqfoc_tracker_t tracker;
static iqfoc_abc_t subtracted; /* from the currents */
static double zero_turns;      /* where on the shaft the encoder counts from */
static double encoder_way;     /* -1: wired the other way round */
static bool broken;

/* The port's part of it. */
void port_set_offset(iqfoc_hal_t *hal, iqfoc_abc_t offset)
{
    (void)hal;
    subtracted = offset;
}

void port_set_predicted(iqfoc_hal_t *hal, iqfoc_abc_t current)
{
    (void)hal;
    (void)current;
}

static uint32_t counter(void)
{
    const double shaft = encoder_way * around_turns(&d) / POLE_PAIRS - zero_turns;
    return (uint32_t)floor((shaft - floor(shaft)) * COUNTS) % COUNTS;
}

void port_align(iqfoc_hal_t *hal, iq24_t theta)
{
    (void)hal;
    iqfoc_encoder_align(&encoder, counter(), theta);
    iqfoc_tracker_restart(&tracker);
}

bool port_angle_lost(const iqfoc_hal_t *hal)
{
    (void)hal;
    return tracker.lost;
}

bool port_break(const iqfoc_hal_t *hal)
{
    (void)hal;
    return broken;
}

void port_clear_break(iqfoc_hal_t *hal)
{
    (void)hal;
}

void setUp(void)
{
    static const iqfoc_encoder_config_t encoder_config = {COUNTS, POLE_PAIRS, 4, false, 0};
    static const iqfoc_tracker_config_t tracker_config =
        IQFOC_TRACKER_GAINS(600.0, T_S, IQ24(0.2), PWM_HZ / 100);
    const iqfoc_abc_t none = {0, 0, 0};
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &encoder_config));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&tracker, &tracker_config));
    subtracted = none;
    encoder_way = 1.0;
    broken = false;
}

void tearDown(void)
{
}

static void power_on(double rotor_turns, double offset_A)
{
    motor m = motor_blank();
    m.pole_pairs = POLE_PAIRS;
    m.R_ohm = R_OHM;
    m.L_d_H = m.L_q_H = L_H;
    m.psi_f_Wb = PSI_F_WB;
    m.I_rated_A_rms = I_RATED_A_RMS;
    m.n_max_rpm = 3000.0;
    m.f_pwm_Hz = PWM_HZ;
    m.u_dc_V = U_DC_V;
    plant_config truth = plant_config_from_motor(&m);
    truth.shaft.mode = PLANT_SHAFT_INERTIA;
    truth.shaft.J_kgm2 = 5e-5;
    truth.shaft.friction_Nms = 5e-4;
    truth.shaft.theta_mech_start_rad = VEC_TWO_PI * rotor_turns / POLE_PAIRS;
    truth.sensors.current_bits = 12;
    truth.sensors.current_full_scale_A = 80.0;
    truth.sensors.current_noise_A = 0.03;
    truth.sensors.current_offset_A[0] = offset_A;
    truth.sensors.current_offset_A[1] = -0.5;
    truth.sensors.current_offset_A[2] = 0.3;
    truth.inverter.t_dead_s = 5e-7;
    around_begin_motor(&d, &m, &truth);
    TEST_ASSERT_TRUE(drive_begin(&drive, (uint32_t)HAL_HOST_TICKS_PER_S));
}

static void periods(long count)
{
    for (long k = 0; k < count; k++) {
        iqfoc_sample_t sample = around_valley(&d);
        iqfoc_tracker_step(&tracker, iqfoc_encoder_theta(&encoder, counter()), 0, true);
        sample.theta = iqfoc_tracker_theta(&tracker, 0);
        sample.speed = iqfoc_tracker_speed(&tracker);
        sample.i.a -= subtracted.a;
        sample.i.b -= subtracted.b;
        sample.i.c -= subtracted.c;
        hal_host_interrupt(&d.hal, &sample);
        drive_interrupt(&drive, &d.hal);
        (void)around_peak(&d);
        around_take_command(&d);
    }
}

#define START (PWM_HZ / 20 + 1024 + (long)(4.0 * ALIGN_SECONDS * PWM_HZ) + 10)

static void test_from_power_on_to_torque(void)
{
    for (int k = 0; k < 4; k += 3) {
        setUp();
        zero_turns = 0.19 * k;
        power_on(0.25 * k + 0.02, 1.3);
        drive.i_wanted.q = k % 2 == 0 ? IQ24(0.1) : IQ24(-0.1);
        periods(PWM_HZ / 20 + 1024);
        TEST_ASSERT_EQUAL_INT(DRIVE_ALIGNS, drive.state);
        periods(START - PWM_HZ / 20 - 1024);
        TEST_ASSERT_EQUAL_INT(DRIVE_RUNS, drive.state);
        TEST_ASSERT_EQUAL_INT(IQFOC_START_GOOD, drive.start.verdict);
        periods(PWM_HZ / 2);
        TEST_ASSERT_EQUAL_INT(DRIVE_RUNS, drive.state);
        TEST_ASSERT_EQUAL_UINT32(0, drive.why);
        const double i_q = (k % 2 == 0 ? 0.1 : -0.1) * d.base.I_A;
        printf("  rotor at %.2f turns: %.0f rpm, i_d %.2f A, i_q %.2f A of %.2f A\n", 0.25 * k + 0.02,
               d.truth.omega_e_rad_s / POLE_PAIRS * 60.0 / VEC_TWO_PI, d.mean_dq_A[0], d.mean_dq_A[1], i_q);
        /* The dead time leaves its ripple. */
        TEST_ASSERT_DOUBLE_WITHIN(0.2, i_q, d.mean_dq_A[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.0, d.mean_dq_A[0]);
        TEST_ASSERT_TRUE(d.truth.omega_e_rad_s * i_q > 500.0);
    }
}

static void test_refuses_to_start(void)
{
    power_on(0.1, 5.0); /* a sensor far off */
    periods(START);
    TEST_ASSERT_EQUAL_INT(DRIVE_IS_OFF, drive.state);
    TEST_ASSERT_EQUAL_UINT32(DRIVE_OFFSET_BAD, drive.why);
    TEST_ASSERT_EQUAL_INT(IQFOC_OFFSET_OUT_OF_RANGE, drive.offset.verdict);
    setUp();
    encoder_way = -1.0;
    power_on(0.1, 1.0);
    periods(START);
    TEST_ASSERT_EQUAL_INT(DRIVE_IS_OFF, drive.state);
    TEST_ASSERT_EQUAL_UINT32(DRIVE_ALIGNMENT_BAD, drive.why);
    TEST_ASSERT_EQUAL_INT(IQFOC_START_REVERSED, drive.start.verdict);
    TEST_ASSERT_FALSE(d.hal.command.gates);
}

/* In the first run a break is the end; after it the drive comes back by itself. */
static void test_break(void)
{
    power_on(0.4, 1.0);
    drive.i_wanted.q = IQ24(0.1);
    periods(START + 2000);
    broken = true;
    periods(100);
    TEST_ASSERT_FALSE(d.hal.command.gates);
    TEST_ASSERT_EQUAL_UINT32(IQFOC_STATUS_BREAK, drive.why);
    broken = false;
    periods(PWM_HZ - 2);
    TEST_ASSERT_FALSE(d.hal.command.gates);
    periods(1000);
    TEST_ASSERT_EQUAL_INT(FIRST_RUN ? DRIVE_IS_OFF : DRIVE_RUNS, drive.state);
    TEST_ASSERT_EQUAL_INT(!FIRST_RUN, d.hal.command.gates);
    if (!FIRST_RUN) {
        periods(1000);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.1 * d.base.I_A, d.mean_dq_A[1]);
    }
}

static void test_lost_phase(void)
{
    power_on(0.4, 1.0);
    drive.i_wanted.q = IQ24(0.1);
    periods(START + 4000);
    TEST_ASSERT_EQUAL_INT(DRIVE_RUNS, drive.state);
    d.plant.config.machine.dR_ohm[1] = 1e4;
    d.plant.linear = false;
    periods(4000);
    TEST_ASSERT_EQUAL_INT(DRIVE_IS_OFF, drive.state);
    TEST_ASSERT_TRUE((drive.why & (IQFOC_STATUS_LOST_PHASE | IQFOC_STATUS_LOST_CURRENT_SENSOR)) != 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_break);
    if (FIRST_RUN) { /* nothing else differs */
        RUN_TEST(test_from_power_on_to_torque);
        RUN_TEST(test_refuses_to_start);
        RUN_TEST(test_lost_phase);
    }
    return UNITY_END();
}
