/*
 * The linear loop without an angle sensor (sim_host/tune/tune_sensorless.h) against known poles, and against the firmware's
 * IQ24 code in the switching-level plant, which shares no line with it: angle error by wrong parameters, noise of angle and
 * speed, and where the loop becomes unstable.
 */
#include "loops/closed_loop.h"
#include "reproduce/paper_2019.h"
#include "tune/sensorless_drive.h"
#include "tune/tune_observer.h"

#include "unity.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>

#define SFFR 5.0
#define LOAD 0.5 /* of the rated peak: the link's voltage suffices for each machine here */

static motor believed;
static tune_design design;

void setUp(void)
{
    believed = paper_2019_motor();
    believed.f_pwm_Hz = SFFR * motor_speed_rad_s(&believed, believed.n_max_rpm) / VEC_TWO_PI;
    const tune_machine machine = tune_machine_of_motor(&believed);
    design = tune_design_of(TUNE_PI, &machine, 1.0 / believed.f_pwm_Hz, 1213.0 / believed.f_pwm_Hz);
}

void tearDown(void)
{
}

static tune_sensorless observed(double w_T, double gain_max)
{
    return tune_sensorless_of(&design, false, w_T, gain_max);
}

static tune_operating_point place(double share_R, double share_L, double share_psi, double gain, double sffr)
{
    tune_operating_point at = {.truth = design.machine,
                               .voltage_gain = gain,
                               .phi_rad = VEC_TWO_PI / sffr,
                               .i_q_A = LOAD * motor_rated_peak_A(&believed)};
    at.truth.R_ohm *= share_R;
    at.truth.L_d_H *= share_L;
    at.truth.L_q_H *= share_L;
    at.truth.psi_f_Wb *= share_psi;
    return at;
}

/* Whether each wanted pole has one of its own within 1e-3. */
static void check_poles(const tune_loop *loop, const double complex *wanted, int count)
{
    tune_pole pole[TUNE_ORDER];
    bool used[TUNE_ORDER] = {false};
    (void)tune_poles(loop, pole);
    for (int n = 0; n < count; n++) {
        int nearest = -1;
        double least = 1e-3;
        for (int k = 0; k < loop->order; k++) {
            const double apart = cabs(pole[k].re + I * pole[k].im - wanted[n]);
            if (!used[k] && apart < least) {
                least = apart;
                nearest = k;
            }
        }
        TEST_ASSERT_TRUE_MESSAGE(nearest >= 0, "a pole is not there");
        used[nearest] = true;
    }
}

/*
 * With the true parameters nothing of the current reaches the observer. The poles are then those of the loop with a sensor,
 * which test_tune checks, those of the phase-locked loop, p twice, and those of the flux, Rot(-phi) (I - g d d^T).
 */
static void test_poles_of_the_true_machine(void)
{
    static const double ratio[] = {3.5, 5.0, 12.5, 50.0};
    design.machine.R_ohm = 0.0; /* so that the voltage drop is exact */
    for (size_t n = 0; n < sizeof ratio / sizeof ratio[0]; n++) {
        const double w_T = 0.3;
        const tune_sensorless s = observed(w_T, 0.4);
        const tune_operating_point at = place(1.0, 1.0, 1.0, 1.0, ratio[n]);
        const double g = fmin(0.4, 0.4 * at.phi_rad);
        const double half_trace = 0.5 * (2.0 - g) * cos(at.phi_rad);
        const double complex root = csqrt(half_trace * half_trace - (1.0 - g));
        double complex wanted[TUNE_ORDER + 4] = {1.0 / (1.0 + w_T), 1.0 / (1.0 + w_T), half_trace + root,
                                                 half_trace - root};
        int count = 4;
        tune_pole pole[TUNE_ORDER];
        tune_loop measured;
        tune_loop loop;
        tune_sensorless_error off;
        tune_loop_make(&design, &at.truth, at.phi_rad, &tune_no_fault, &measured);
        (void)tune_poles(&measured, pole);
        for (int k = 0; k < measured.order; k++) {
            if (hypot(pole[k].re, pole[k].im) > 1e-3) { /* the delays are at 0, in another number */
                wanted[count++] = pole[k].re + I * pole[k].im;
            }
        }
        TEST_ASSERT_TRUE(count >= 10);
        TEST_ASSERT_TRUE(tune_sensorless_make(&s, &at, 0.0, &loop, &off));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, off.angle_rad);
        check_poles(&loop, wanted, count);
    }
}

typedef struct run_result {
    double bias_deg, rms_deg, speed_percent, flux_off_Wb;
    loop_outcome outcome;
    bool lost;
} run_result;

/* The firmware on the observed angle in the plant, at a constant current. */
static run_result run(const tune_sensorless *s, const tune_operating_point *at, double noise_A, int periods)
{
    sensorless_drive drive;
    iqfoc_observer_config_t config;
    error e = {0};
    loop_result result;
    const motor truth = tuned_motor(&believed, &at->truth);
    TEST_ASSERT_TRUE_MESSAGE(observer_from_motor(&believed, &config, &e), e.text);
    config.k1 = iq24_from_double(s->k1);
    config.k2 = iq24_from_double(s->k2);
    config.gain_max = iq24_from_double(s->gain_max);
    config.speed_min = 0;
    config.flux_max = 2 * config.flux_max;
    const loop_case c = {.truth = truth,
                         .omega_e_rad_s = at->phi_rad / design.T_s,
                         .i_q_before_A = at->i_q_A,
                         .i_q_after_A = at->i_q_A,
                         .periods = periods,
                         .noise_A = noise_A,
                         .seed = 7};
    TEST_ASSERT_TRUE_MESSAGE(sensorless_drive_init(&drive, &believed, &design, &config,
                                                   LOOP_SETTLE_CYCLES + LOOP_TRANSIENT_CYCLES, &e),
                             e.text);
    drive.voltage_gain = at->voltage_gain;
    const drive_firmware firmware = sensorless_drive_firmware(&drive);
    TEST_ASSERT_TRUE_MESSAGE(closed_loop_run(&c, &firmware, &result, &e), e.text);
    return (run_result){360.0 * spread_mean(&drive.off),
                        360.0 * spread_deviation(&drive.off),
                        100.0 * VEC_TWO_PI * spread_rms(&drive.faster) / at->phi_rad,
                        (double)drive.observer.flux_error / (double)config.machine.psi * believed.psi_f_Wb,
                        result.outcome,
                        drive.lost};
}

static void test_angle_error_of_wrong_parameters(void)
{
    static const double wrong[][4] = {{1.0, 1.0, 1.0, 1.0},  {1.5, 1.0, 1.0, 1.0},   {1.0, 1.3, 1.0, 1.0},
                                      {1.0, 0.7, 1.0, 1.0},  {1.0, 1.0, 1.1, 1.0},   {1.0, 1.0, 0.9, 1.0},
                                      {1.0, 1.0, 1.0, 1.02}, {0.7, 1.3, 0.95, 0.98}, {1.3, 0.7, 0.95, 1.02}};
    static const double ratio[] = {6.0, 10.0, 20.0};
    const tune_sensorless s = observed(0.1, 0.5);
    double most = 0.0;
    for (size_t n = 0; n < sizeof wrong / sizeof wrong[0]; n++) {
        for (size_t k = 0; k < sizeof ratio / sizeof ratio[0]; k++) {
            const tune_operating_point at =
                place(wrong[n][0], wrong[n][1], wrong[n][2], wrong[n][3], ratio[k]);
            tune_loop loop;
            tune_sensorless_error off;
            TEST_ASSERT_TRUE(tune_sensorless_make(&s, &at, 0.0, &loop, &off));
            const double predicted = off.angle_rad * 360.0 / VEC_TWO_PI;
            const run_result got = run(&s, &at, 0.0, 40);
            printf("%zu SFFR %g: %.3f, plant %.3f degrees\n", n, ratio[k], predicted, got.bias_deg);
            TEST_ASSERT_FALSE(got.lost);
            TEST_ASSERT_DOUBLE_WITHIN(0.005 * believed.psi_f_Wb, off.flux_off_Wb, got.flux_off_Wb);
            most = fmax(most, fabs(got.bias_deg - predicted));
            TEST_ASSERT_DOUBLE_WITHIN(0.1 + 0.02 * fabs(predicted), predicted, got.bias_deg);
        }
    }
    printf("largest difference: %.3f degrees\n", most);
}

static void test_noise_of_angle_and_speed(void)
{
    static const double loop_rad[] = {0.05, 0.16, 0.4};
    static const double ratio[] = {5.3, 12.7, 33.3};
    const double noise_A = 0.01 * motor_rated_peak_A(&believed);
    for (size_t n = 0; n < sizeof loop_rad / sizeof loop_rad[0]; n++) {
        for (size_t k = 0; k < sizeof ratio / sizeof ratio[0]; k++) {
            const tune_sensorless s = observed(loop_rad[n], 0.5);
            const tune_operating_point at = place(1.0, 1.0, 1.0, 1.0, ratio[k]);
            tune_loop loop;
            tune_sensorless_error off;
            TEST_ASSERT_TRUE(tune_sensorless_make(&s, &at, noise_A, &loop, &off));
            const double angle = off.angle_rms_rad * 360.0 / VEC_TWO_PI;
            const double speed = 100.0 * off.speed_rms / at.phi_rad;
            const run_result got = run(&s, &at, noise_A, (int)(20000.0 / ratio[k]));
            printf("w T %g SFFR %g: angle %.4f, plant %.4f degrees; speed %.4f, plant %.4f %%\n", loop_rad[n],
                   ratio[k], angle, got.rms_deg, speed, got.speed_percent);
            TEST_ASSERT_DOUBLE_WITHIN(0.1 * angle, angle, got.rms_deg);
            TEST_ASSERT_DOUBLE_WITHIN(0.1 * speed, speed, got.speed_percent);
        }
    }
}

/* The smallest true L over the model's for which the linear loop is stable, to 1e-3. */
static double stable_from(const tune_sensorless *s, double sffr)
{
    double held = 1.0;
    double lost = 0.1;
    while (held - lost > 1e-3) {
        const double middle = 0.5 * (held + lost);
        const tune_operating_point at = place(1.0, middle, 1.0, 1.0, sffr);
        tune_loop loop;
        TEST_ASSERT_TRUE(tune_sensorless_make(s, &at, 0.0, &loop, NULL));
        if (tune_poles(&loop, NULL) < 1.0) {
            held = middle;
        } else {
            lost = middle;
        }
    }
    return held;
}

/* A low inductance: the current loop overshoots, and the angle with it, by the error of L_q i. */
static void test_where_the_loop_becomes_unstable(void)
{
    static const double loop_rad[] = {0.1, 0.3, 1.0};
    static const double ratio[] = {10.0, 20.0};
    for (size_t n = 0; n < sizeof loop_rad / sizeof loop_rad[0]; n++) {
        for (size_t k = 0; k < sizeof ratio / sizeof ratio[0]; k++) {
            const tune_sensorless s = observed(loop_rad[n], 0.5);
            const double edge = stable_from(&s, ratio[k]);
            const tune_operating_point inside = place(1.0, edge + 0.03, 1.0, 1.0, ratio[k]);
            const tune_operating_point outside = place(1.0, edge - 0.03, 1.0, 1.0, ratio[k]);
            const double noise_A = 1e-4 * motor_rated_peak_A(&believed);
            const run_result in = run(&s, &inside, noise_A, 200);
            const run_result out = run(&s, &outside, noise_A, 200);
            printf("w T %g SFFR %g: stable from L x %.3f; plant: %s inside, %s outside\n", loop_rad[n],
                   ratio[k], edge, loop_outcome_text(in.outcome), loop_outcome_text(out.outcome));
            TEST_ASSERT_TRUE(in.outcome == LOOP_HOLDS || in.outcome == LOOP_MISSES); /* by the angle error */
            TEST_ASSERT_TRUE(in.rms_deg < 0.3);
            TEST_ASSERT_TRUE(out.outcome == LOOP_UNSTABLE || out.outcome == LOOP_TRIPS);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_poles_of_the_true_machine);
    RUN_TEST(test_angle_error_of_wrong_parameters);
    RUN_TEST(test_noise_of_angle_and_speed);
    RUN_TEST(test_where_the_loop_becomes_unstable);
    return UNITY_END();
}
