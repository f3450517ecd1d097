/*
 * Speed control on the switching plant with its shaft: an encoder of 4096 counts, the tracker, the cycle's PI controller. Run-up through
 * both directions, a step of the load, and a shaft whose inertia is not the one that the controller was made for.
 */
#include "around_drive.h"

#include "iqfoc/encoder.h"
#include "iqfoc/speed_control.h"
#include "iqfoc/tracker.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

#define T_S    2e-4
#define J      1e-3
#define W      60.0
#define CYCLES 5
#define COUNTS 4096
#define I_B    IQFOC_I_BASE(10.5)
#define RAMP   12000.0 /* rpm per second */
#define RPM(n) ((n) / 60.0 * 3.0 * T_S)

static around_drive d;
static iqfoc_encoder_t encoder;
static iqfoc_tracker_t tracker;
static iqfoc_speed_control_t speed;

static const iqfoc_speed_control_config_t config =
    IQFOC_SPEED_CONTROL(W, J, 3, 0.134, T_S, I_B, RAMP, 20.0, CYCLES);

void setUp(void)
{
}

void tearDown(void)
{
}

static void begin(double inertia)
{
    static const iqfoc_encoder_config_t counted = {
        .counts_per_turn = COUNTS, .pole_pairs = 3, .index_known = true};
    static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS(15.0 * W, T_S, IQ24(0.1), 25);
    plant_config drive = around_plant(565.0);
    drive.shaft.J_kgm2 = inertia;
    drive.shaft.friction_Nms = 1e-3;
    around_begin(&d, &drive);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_encoder_init(&encoder, &counted));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&tracker, &tracking));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_speed_control_init(&speed, &config));
    d.cycle.enabled = true;
}

static void turn(double target)
{
    iqfoc_sample_t sample = around_valley(&d);
    (void)iqfoc_encoder_index(&encoder, 0);
    iqfoc_tracker_step(&tracker, iqfoc_encoder_theta(&encoder, around_encoder(&d, COUNTS, 0.0)), 0, true);
    sample.theta = iqfoc_tracker_theta(&tracker, 0);
    sample.speed = iqfoc_tracker_speed(&tracker);
    d.cycle.i_ref.q = iqfoc_speed_control_step(&speed, iq24_from_double(target), sample.speed, config.i_max);
    around_valley_handler(&d, &sample);
    sample = around_peak(&d);
    sample.theta = iqfoc_tracker_theta(&tracker, IQ24(0.5));
    sample.speed = iqfoc_tracker_speed(&tracker);
    around_peak_handler(&d, &sample);
}

/* From standstill to 4000 rpm, through zero to -4000, and back: the speed stays by the set-point, and does not overshoot. */
static void test_run_up_and_reversal(void)
{
    static const double targets[] = {4000.0, -4000.0, 0.0};
    double behind = 0.0;
    double beyond = 0.0;
    begin(J);
    for (int32_t n = 0; n < 3; n++) {
        const double target = RPM(targets[n]);
        const double way = n == 1 ? -1.0 : 1.0;
        for (int32_t k = 0; k < 4500; k++) {
            turn(target);
            behind = fmax(behind, fabs(around_speed(&d) - speed.set_point_q32 / 4294967296.0));
            beyond = fmax(beyond, (around_speed(&d) - target) * (n == 2 ? 1.0 : way));
        }
        TEST_ASSERT_DOUBLE_WITHIN(RPM(4.0), target, around_speed(&d));
    }
    printf("  ramp of %.0f rpm/s: at most %.0f rpm from the set-point, %.0f rpm beyond the target\n", RAMP,
           behind / RPM(1.0), beyond / RPM(1.0));
    TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
    TEST_ASSERT_TRUE(behind <= RPM(60.0));
    TEST_ASSERT_TRUE(beyond <= RPM(60.0));
}

/* A step of the load by half of the rated torque: the dip is that of the header's formula, and nothing of it stays. */
static void test_load_step(void)
{
    const double step = 0.5;
    const double a = IQFOC_RAW_SPEED_ACCELERATION(J, 3, 0.134, I_B, T_S);
    const double want = a * step / (exp(1.0) * W * T_S) * (1.0 + 1.5 * W * CYCLES * T_S);
    const double target = RPM(2000.0);
    double dip = 0.0;
    double rise = 0.0;
    begin(J);
    for (int32_t k = 0; k < 6000; k++) {
        if (k == 3000) {
            plant_set_load(&d.plant, step * 1.5 * 3.0 * 0.134 * d.base.I_A);
        }
        turn(target);
        if (k >= 3000) {
            dip = fmax(dip, target - around_speed(&d));
            rise = fmax(rise, around_speed(&d) - target);
        }
    }
    printf("  a load of %.0f %%: dip %.0f rpm, formula %.0f; beyond the target %.1f rpm\n", 100.0 * step,
           dip / RPM(1.0), want / RPM(1.0), rise / RPM(1.0));
    TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * want, want, dip);
    TEST_ASSERT_TRUE(rise <= 0.1 * want);
    TEST_ASSERT_DOUBLE_WITHIN(RPM(4.0), target, around_speed(&d));
}

/* The inertia half and three times the one of the controller: the run-up arrives, and its overshoot is small. */
static void test_other_inertia(void)
{
    static const double ratio[] = {0.5, 3.0};
    for (int32_t n = 0; n < 2; n++) {
        const double target = RPM(4000.0);
        double most = 0.0;
        begin(ratio[n] * J);
        for (int32_t k = 0; k < 12000; k++) {
            turn(target);
            most = fmax(most, around_speed(&d));
        }
        printf("  inertia %.1f times: overshoot %.1f %%\n", ratio[n], 100.0 * (most / target - 1.0));
        TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
        TEST_ASSERT_TRUE(most <= 1.06 * target);
        TEST_ASSERT_DOUBLE_WITHIN(RPM(4.0), target, around_speed(&d));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_run_up_and_reversal);
    RUN_TEST(test_load_step);
    RUN_TEST(test_other_inertia);
    return UNITY_END();
}
