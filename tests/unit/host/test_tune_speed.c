/*
 * The design of the speed control (sim_host/tune/tune_speed.h): its linear loop against one that is written out cycle by cycle with angles in
 * place of errors, the stated margin, and the prediction against the firmware's IQ24 code on the switching plant.
 */
#include "reproduce/paper_2019.h"
#include "tune/tune_speed.h"

#include "iqfoc/speed_control.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define J 1e-3

static tune_result r;

void setUp(void)
{
    error e = {0};
    const tune_tolerances tolerances = {0.3, 0.3, 0.05};
    r = (tune_result){.motor = paper_2019_motor(), .method = TUNE_PI, .disk_wanted = 0.5};
    r.motor.f_pwm_Hz = 2000.0;
    tune_region_of_tolerances(&r.motor, &tolerances, &r.region);
    TEST_ASSERT_TRUE_MESSAGE(tune_design_find(&r, &e), e.text);
}

void tearDown(void)
{
}

static tune_speed designed(void)
{
    tune_speed s;
    error e = {0};
    TEST_ASSERT_TRUE_MESSAGE(tune_speed_find(&r, J, 1.0, &s, &e), e.text);
    return s;
}

/* The loop in time: growth of the speed's error after a step of the load, late over early; the gain of the controller is `gain` times. */
static double growth(const tune_speed *s, double gain)
{
    const double T_s = r.design.T_s;
    const double a = tune_speed_acceleration(&r, J);
    const double kp = gain * IQFOC_RAW_SPEED_KP(s->bandwidth_rad_s, a, T_s, s->cycles);
    const double ki = IQFOC_RAW_SPEED_SHARE(s->bandwidth_rad_s, T_s, s->cycles) * kp;
    const double p = 1.0 / (1.0 + s->tracker_rad_s * T_s);
    const long cycles = (long)(400.0 / (s->bandwidth_rad_s * T_s));
    double i[2] = {0.0, 0.0};
    double theta = 0.0;
    double speed = 0.0;
    double seen_theta = 0.0;
    double seen = 0.0;
    double acceleration = 0.0;
    double integral = 0.0;
    double i_ref = 0.0;
    double early = 0.0;
    double late = 0.0;
    for (long k = 0; k < cycles; k++) {
        if (k % s->cycles == 0) {
            i_ref = integral - kp * seen;
            integral -= ki * seen;
        }
        const double rise = a * (0.5 * (i[0] + i[1]) - 0.1);
        theta += speed + 0.5 * rise;
        speed += rise;
        i[0] = i[1];
        i[1] = r.design.follow * i[1] + (1.0 - r.design.follow) * i_ref;
        const double off = theta - (seen_theta + seen + 0.5 * acceleration);
        seen_theta += seen + 0.5 * acceleration + (1.0 - p * p * p) * off;
        seen += acceleration + 1.5 * (1.0 - p) * (1.0 - p) * (1.0 + p) * off;
        acceleration += (1.0 - p) * (1.0 - p) * (1.0 - p) * off;
        if (k > cycles / 4 && k < cycles / 2) {
            early = fmax(early, fabs(speed));
        } else if (k > 3 * cycles / 4) {
            late = fmax(late, fabs(speed));
        }
    }
    return late / early;
}

/* The controller's gain that the loop just bears: by the linear loop, with the shaft so many times lighter, and in time. */
static void test_limit_of_the_gain(void)
{
    const tune_speed s = designed();
    double low = 1.0;
    double high = 20.0;
    for (int n = 0; n < 30; n++) {
        const double middle = 0.5 * (low + high);
        if (tune_speed_disk(&r, &s, s.bandwidth_rad_s, J / middle) > 0.0) {
            low = middle;
        } else {
            high = middle;
        }
    }
    printf("  gain limit %.3f; growth at 0.98 of it %.3g, at 1.02 %.3g\n", low, growth(&s, 0.98 * low),
           growth(&s, 1.02 * low));
    TEST_ASSERT_TRUE(growth(&s, 0.98 * low) < 0.9);
    TEST_ASSERT_TRUE(growth(&s, 1.02 * low) > 1.1);
    /* A disk margin of 0.5 bears any gain up to (1 + 0.25)/(1 - 0.25) = 1.67, here from the lighter shaft on. */
    TEST_ASSERT_TRUE(low * (1.0 - TUNE_INERTIA_OFF) >= 1.25 / 0.75);
}

static void test_margin_is_the_wanted_one(void)
{
    const tune_speed s = designed();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.5, s.disk);
    TEST_ASSERT_TRUE(s.disk_nominal > s.disk);
    TEST_ASSERT_TRUE(tune_speed_disk(&r, &s, 1.05 * s.bandwidth_rad_s, 0.7 * J) < 0.5);
    TEST_ASSERT_EQUAL_INT(2, s.cycles);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 8000.0, s.ramp_rpm_s);
}

/* One dip, three shafts: the prediction is the stated shaft's, and the plant has it too. */
static void test_plant_has_the_predicted_dip(void)
{
    error e = {0};
    for (int twice = 0; twice < 2; twice++) {
        tune_speed s = designed();
        if (twice == 1) { /* a light shaft at which the trial's load is smaller */
            TEST_ASSERT_TRUE_MESSAGE(tune_speed_find(&r, J / 20.0, 1.0, &s, &e), e.text);
            TEST_ASSERT_TRUE(s.load < TUNE_SPEED_LOAD);
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, TUNE_SPEED_DIP * r.motor.n_max_rpm, s.dip_rpm);
        }
        TEST_ASSERT_TRUE_MESSAGE(tune_speed_trial(&r, &s, &e), e.text);
        printf("  predicted dip %.1f rpm, in the plant %.1f; overshoot of the run-up %.1f rpm\n", s.dip_rpm,
               s.found_dip_rpm[1], s.overshoot_rpm[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * s.dip_rpm, s.dip_rpm, s.found_dip_rpm[1]);
        TEST_ASSERT_TRUE(s.found_dip_rpm[2] > s.found_dip_rpm[1] && s.found_dip_rpm[1] > s.found_dip_rpm[0]);
        for (int n = 0; n < TUNE_SHAFTS; n++) {
            TEST_ASSERT_EQUAL_UINT32(0, s.status[n]);
            TEST_ASSERT_FALSE(s.lost[n]);
            TEST_ASSERT_TRUE(s.overshoot_rpm[n] < 0.02 * r.motor.n_max_rpm);
            TEST_ASSERT_TRUE(s.settled_s[n] > 0.0 && s.settled_s[n] < 8.0 / s.bandwidth_rad_s);
        }
    }
}

/* The curves are those of the trial: its speeds, its dip, and a current that carries the load. */
static void test_curves(void)
{
    error e = {0};
    tune_speed s = designed();
    TEST_ASSERT_TRUE_MESSAGE(tune_speed_trial(&r, &s, &e), e.text);
    for (int shaft = 0; shaft < TUNE_SHAFTS; shaft++) {
        const double *up = s.trace[TUNE_RUN_UP].rpm[shaft];
        const double *loaded = s.trace[TUNE_LOADED].rpm[shaft];
        const double *stepped = s.trace[TUNE_STEPPED].rpm[shaft];
        double lowest = s.rpm;
        double last_up = 0.0;
        for (int n = 0; n < TUNE_POINTS; n++) {
            TEST_ASSERT_TRUE(isfinite(loaded[n]) && isfinite(stepped[n]) &&
                             (n > 0 || fabs(up[n]) < 0.01 * s.rpm));
            TEST_ASSERT_TRUE(shaft > 0 || isfinite(up[n])); /* the heavy shaft's is the longest */
            lowest = fmin(lowest, loaded[n]);
            last_up = isfinite(up[n]) ? up[n] : last_up;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * s.found_dip_rpm[shaft], s.rpm - s.found_dip_rpm[shaft], lowest);
        TEST_ASSERT_DOUBLE_WITHIN(0.005 * s.rpm, s.rpm, last_up);
        TEST_ASSERT_DOUBLE_WITHIN(0.005 * s.rpm, s.rpm, loaded[TUNE_POINTS - 1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.005 * s.rpm, (1.0 + TUNE_SPEED_STEP) * s.rpm, stepped[TUNE_POINTS - 1]);
        TEST_ASSERT_TRUE(s.step_overshoot_rpm[shaft] >= 0.0 &&
                         s.step_overshoot_rpm[shaft] < 0.5 * TUNE_SPEED_STEP * s.rpm);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, s.load, s.trace[TUNE_STEPPED].i_q[shaft][TUNE_POINTS - 1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.0, s.trace[TUNE_LOADED].i_q[shaft][0]);
    }
}

static void test_refused(void)
{
    tune_speed s;
    error e = {0};
    TEST_ASSERT_FALSE(tune_speed_find(&r, 1e3, 1.0, &s, &e));
    TEST_ASSERT_NOT_NULL(strstr(e.text, "--inertia 1000 gives kp"));
    /* A heavy shaft runs up as the rated current lets it. */
    TEST_ASSERT_TRUE(tune_speed_find(&r, 0.05, 0.1, &s, &e));
    TEST_ASSERT_TRUE(s.ramp_limited);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.9,
                              s.ramp_rpm_s / 60.0 * r.motor.pole_pairs * r.design.T_s * r.design.T_s /
                                  tune_speed_acceleration(&r, 0.05));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_limit_of_the_gain);
    RUN_TEST(test_margin_is_the_wanted_one);
    RUN_TEST(test_plant_has_the_predicted_dip);
    RUN_TEST(test_curves);
    RUN_TEST(test_refused);
    return UNITY_END();
}
