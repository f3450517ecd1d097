/*
 * What a control cycle of the plant costs on one core, samples at valley and peak and true means included. The measure is a sine of
 * the C library, timed in the same run: a slow or busy machine slows both. Processor time, the best of several short runs; optimised
 * builds only.
 */
#include "../laboratory_motor.h"
#include "plant/plant.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#define RUNS 10

static plant_config drive(void)
{
    motor m = laboratory_motor();
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = 942.0;
    return c;
}

/* Seconds of processor time for a sine. */
static double time_of_sine(double *sum)
{
    enum { SINES = 200000 };
    const clock_t begin = clock();
    for (int k = 0; k < SINES; k++) {
        *sum += sin(1e-3 * k);
    }
    return (double)(clock() - begin) / (double)CLOCKS_PER_SEC / SINES;
}

/* What a cycle costs, in sines. */
static double sines_per_cycle(const char *name, const plant_config *c, int cycles)
{
    double best = INFINITY;
    double sine = INFINITY;
    double sum = 0.0;
    for (int run = 0; run < RUNS; run++) {
        sine = fmin(sine, time_of_sine(&sum));
        plant p;
        plant_init(&p, c);
        const clock_t begin = clock();
        for (int k = 0; k < cycles; k++) {
            const double theta = p.state.y[STATE_THETA_E] + 0.1 + 0.5 * VEC_PI;
            double duty[3];
            for (int x = 0; x < 3; x++) {
                duty[x] = 0.5 + 0.2 * cos(theta - 2.0 * VEC_PI / 3.0 * x);
            }
            plant_samples valley, peak;
            plant_means means;
            plant_cycle(&p, duty, &valley, &peak, &means);
            sum += means.i_dq_A.q + valley.i_A[0] + peak.i_A[0];
        }
        best = fmin(best, (double)(clock() - begin) / (double)CLOCKS_PER_SEC / cycles);
    }
    TEST_ASSERT_TRUE(isfinite(sum));
    printf("%-28s %8.0f cycles/s %6.0f sines\n", name, 1.0 / best, best / sine);
    return best / sine;
}

/* Measured 144 to 146. */
static void test_linear_path(void)
{
    const plant_config c = drive();
    TEST_ASSERT_TRUE(sines_per_cycle("given speed", &c, 20000) <= 250.0);
}

/* For information; the last, measured 2830, is what the blind tests take longest for. */
static void test_other_paths(void)
{
    plant_config c = drive();
    c.machine.L_q_H *= 2.0;
    (void)sines_per_cycle("salient", &c, 20000);
    c = drive();
    c.shaft.mode = PLANT_SHAFT_INERTIA;
    c.shaft.J_kgm2 = 1e-2;
    (void)sines_per_cycle("free shaft", &c, 5000);
    c = drive();
    c.machine.I_sat_A = 40.0;
    (void)sines_per_cycle("saturation", &c, 5000);
    c = drive();
    c.inverter.t_dead_s = 2e-6;
    (void)sines_per_cycle("dead time", &c, 5000);
    c.inverter.v_switch_V = 1.5;
    c.inverter.v_diode_V = 1.2;
    c.machine.I_sat_A = 40.0;
    c.machine.psi_5_Wb = 0.003;
    TEST_ASSERT_TRUE(sines_per_cycle("dead time, drops, saturation", &c, 5000) <= 5000.0);
}

/* The low-pass of the currents is an exact step: its drive stays on the linear path whatever the bandwidth. Measured 1.5 times the cost. */
static void test_current_filter(void)
{
    plant_config c = drive();
    const double without = sines_per_cycle("given speed", &c, 20000);
    c.sensors.current_bandwidth_Hz = 20e3;
    const double slow = sines_per_cycle("current filter, 20 kHz", &c, 20000);
    c.sensors.current_bandwidth_Hz = 1e6;
    const double fast = sines_per_cycle("current filter, 1 MHz", &c, 20000);
    TEST_ASSERT_TRUE(slow <= 5.0 * without && fast <= 5.0 * without);
}

void setUp(void)
{
}

void tearDown(void)
{
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_linear_path);
    RUN_TEST(test_other_paths);
    RUN_TEST(test_current_filter);
    return UNITY_END();
}
