/*
 * A resolver with noise, errors of gain and offset and a wire that breaks, and three Halls from standstill under
 * load: each turns the switching plant through the tracker.
 */
#include "around_drive.h"

#include "iqfoc/halls.h"
#include "iqfoc/resolver.h"
#include "iqfoc/restart.h"
#include "iqfoc/supervision.h"
#include "iqfoc/tracker.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>

#define T_S 2e-4

static around_drive d;
static iqfoc_tracker_t tracker;

void setUp(void)
{
}

void tearDown(void)
{
}

/* One cycle whose angle and speed are these at the valley and half a cycle on. */
static void cycle_with(iqfoc_sample_t sample, iq24_t theta, iq24_t theta_mid, iq24_t speed)
{
    sample.theta = theta;
    sample.speed = speed;
    around_valley_handler(&d, &sample);
    sample = around_peak(&d);
    sample.theta = theta_mid;
    sample.speed = speed;
    around_peak_handler(&d, &sample);
}

static void tracked_cycle(iqfoc_sample_t sample)
{
    cycle_with(sample, iqfoc_tracker_theta(&tracker, 0), iqfoc_tracker_theta(&tracker, IQ24(0.5)),
               iqfoc_tracker_speed(&tracker));
}

typedef struct resolver_truth {
    double amplitude, offset_sin, offset_cos, noise;
    bool broken;
    plant_random random;
} resolver_truth;

/* What its converters deliver, per unit of their range: one pole pair, three of the motor. */
static iqfoc_resolver_angle_t read_resolver(const iqfoc_resolver_t *r, resolver_truth *t)
{
    const double shaft = VEC_TWO_PI * around_turns(&d) / d.motor.pole_pairs;
    const double sine =
        t->amplitude * sin(shaft) + t->offset_sin + t->noise * plant_random_normal(&t->random);
    const double cosine =
        t->amplitude * cos(shaft) + t->offset_cos + t->noise * plant_random_normal(&t->random);
    const double step = 1.0 / 2048.0; /* 12 bits */
    return iqfoc_resolver_read(r, iq24_from_double(t->broken ? t->offset_sin : step * nearbyint(sine / step)),
                               iq24_from_double(step * nearbyint(cosine / step)));
}

static void test_resolver(void)
{
    static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS(250.0, T_S, IQ24(0.1), 25);
    static const iqfoc_restart_config_t restarts = {IQFOC_STATUS_OVERCURRENT, 100, 3, 1000};
    const iqfoc_resolver_t resolver = {
        IQ24(0.05), IQ24(-0.03), IQ24(1.0 / 0.8), IQ24(1.0 / 0.8), IQ24(0.8), IQ24(1.2), 3, 0};
    resolver_truth truth = {.amplitude = 0.8, .offset_sin = 0.05, .offset_cos = -0.03, .noise = 0.004};
    plant_config drive = around_plant(300.0);
    iqfoc_restart_t restart;
    double raw = 0.0;
    double theta = 0.0;
    double speed = 0.0;
    double speed_by_difference = 0.0;
    long seen = 0;
    double before = 0.0;
    plant_random_seed(&truth.random, 5, 1);
    drive.shaft.theta_mech_start_rad = 2.0;
    around_begin(&d, &drive);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_resolver_check(&resolver));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&tracker, &tracking));
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_restart_init(&restart, &restarts));
    d.cycle.enabled = true;
    d.cycle.i_ref.q = IQ24(0.25);
    for (int32_t k = 0; k < 3000; k++) {
        const iqfoc_sample_t sample = around_valley(&d);
        const iqfoc_resolver_angle_t angle = read_resolver(&resolver, &truth);
        iqfoc_tracker_step(&tracker, angle.theta, 0, angle.valid);
        const double off = around_off(angle.theta, around_turns(&d));
        if (k > 300) {
            const double difference = off - before;
            raw += off * off;
            theta += pow(around_off(iqfoc_tracker_theta(&tracker, 0), around_turns(&d)), 2.0);
            speed += pow(iq24_to_double(iqfoc_tracker_speed(&tracker)) - around_speed(&d), 2.0);
            speed_by_difference += difference * difference;
            seen++;
        }
        before = off;
        tracked_cycle(sample);
    }
    printf("  resolver rms: raw %.5f turns, tracked %.5f; speed by difference %.2e, tracked %.2e turns a "
           "cycle\n",
           sqrt(raw / (double)seen), sqrt(theta / (double)seen), sqrt(speed_by_difference / (double)seen),
           sqrt(speed / (double)seen));
    TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
    TEST_ASSERT_TRUE(fabs(around_speed(&d)) > 0.02);
    TEST_ASSERT_TRUE(sqrt(theta / raw) < 0.5);
    TEST_ASSERT_TRUE(sqrt(speed / speed_by_difference) < 0.05);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * 0.25 * d.base.I_A, 0.25 * d.base.I_A, d.mean_dq_A[1]);

    /* The sine's wire breaks: the tracker coasts, then the drive stops for good, without harm on the way. */
    truth.broken = true;
    double most_A = 0.0;
    int32_t stopped = -1;
    for (int32_t k = 0; k < 400; k++) {
        const iqfoc_sample_t sample = around_valley(&d);
        const iqfoc_resolver_angle_t angle = read_resolver(&resolver, &truth);
        iqfoc_tracker_step(&tracker, angle.theta, 0, angle.valid);
        const uint32_t faults = tracker.lost ? IQFOC_STATUS_LOST_ANGLE_SENSOR : 0;
        d.cycle.enabled = iqfoc_restart_step(&restart, faults) == IQFOC_RESTART_RUN;
        if (!d.cycle.enabled && stopped < 0) {
            stopped = k;
        }
        if (stopped < 0) {
            most_A = fmax(most_A, hypot(d.mean_dq_A[0], d.mean_dq_A[1]));
        }
        tracked_cycle(sample);
    }
    printf("  a broken wire: stopped after %d cycles, the current went to %.2f A of %.2f A\n", (int)stopped,
           most_A, 0.25 * d.base.I_A);
    TEST_ASSERT_TRUE(stopped >= 25 && stopped < 300);
    TEST_ASSERT_EQUAL_INT(IQFOC_RESTART_LATCHED, restart.action);
    TEST_ASSERT_TRUE(most_A < 1.2 * 0.25 * d.base.I_A);
}

static uint32_t hall_bits(double turns)
{
    uint32_t bits = 0;
    for (int32_t x = 0; x < 3; x++) {
        bits |= fabs(remainder(turns - x / 3.0, 1.0)) < 0.25 ? UINT32_C(1) << x : 0;
    }
    return bits;
}

/* The timer's capture of the last change, from where the shaft was a cycle ago and is now. */
static uint32_t capture(double before, double now)
{
    const uint32_t bits = hall_bits(now);
    double low = 0.0;
    double high = 1.0;
    for (int32_t n = 0; n < 20; n++) {
        const double mid = 0.5 * (low + high);
        if (hall_bits(before + mid * (now - before)) == bits) {
            high = mid;
        } else {
            low = mid;
        }
    }
    return (uint32_t)lround(256.0 * (1.0 - high));
}

/* From standstill anywhere, against a load of 80 % of the torque, at low speed and up; no alignment. */
static void test_halls(void)
{
    static const iqfoc_halls_config_t config = IQFOC_HALLS(1000);
    static const iqfoc_tracker_config_t tracking = IQFOC_TRACKER_GAINS_2(200.0, T_S, IQ24(0.5), UINT32_MAX);
    double worst = 0.0;
    double smooth = 0.0;
    for (int32_t n = 0; n < 12; n++) {
        plant_config drive = around_plant(300.0);
        iqfoc_halls_t halls;
        drive.shaft.theta_mech_start_rad = VEC_TWO_PI * (n + 0.1) / 36.0;
        drive.shaft.friction_Nms = 0.05;
        around_begin(&d, &drive);
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_halls_init(&halls, &config));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_tracker_init(&tracker, &tracking));
        const double torque = 1.5 * 3.0 * 0.134 * 0.3 * d.base.I_A;
        d.cycle.enabled = true;
        d.cycle.i_ref.q = IQ24(0.3);
        double before = around_turns(&d);
        for (int32_t k = 0; k < 4000; k++) {
            const iqfoc_sample_t sample = around_valley(&d);
            /* The load comes with the speed, as a fan's does, up to 80 %. */
            plant_set_load(&d.plant, 0.8 * torque * fmin(1.0, fmax(0.0, around_speed(&d)) / 0.002));
            iqfoc_halls_step(&halls, hall_bits(around_turns(&d)), capture(before, around_turns(&d)));
            iqfoc_tracker_step(&tracker, halls.theta, 0, true);
            before = around_turns(&d);
            if (k > 2500) {
                worst = fmax(worst, fabs(around_off(halls.theta, around_turns(&d))));
                smooth = fmax(smooth,
                              fabs(iq24_to_double(iqfoc_tracker_speed(&tracker)) / around_speed(&d) - 1.0));
            }
            cycle_with(sample, halls.theta, halls.theta + halls.speed / 2, halls.speed);
        }
        TEST_ASSERT_EQUAL_UINT32(0, halls.faults);
        TEST_ASSERT_EQUAL_UINT32(0, d.cycle.status);
        TEST_ASSERT_TRUE(around_speed(&d) > 0.0015);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * 0.3 * d.base.I_A, 0.3 * d.base.I_A, d.mean_dq_A[1]);
    }
    printf("  Halls: %.4f turns off at most, filtered speed off by %.2f %%, at %.4f turns a cycle\n", worst,
           100.0 * smooth, around_speed(&d));
    TEST_ASSERT_TRUE(worst < 0.01);
    TEST_ASSERT_TRUE(smooth < 0.03);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_resolver);
    RUN_TEST(test_halls);
    return UNITY_END();
}
