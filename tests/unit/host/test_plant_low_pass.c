/*
 * The low-pass of the current sensors against closed forms: its weights, and a drive's filtered current against a convolution of the
 * unfiltered one.
 */
#include "../laboratory_motor.h"
#include "plant/plant.h"
#include "plant/plant_low_pass.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

/* w_n = integral over y from 0 to beta of e^-y (1 - y/beta)^n: Simpson's rule in 20000 parts, up to e^-40. */
static double weight_by_quadrature(double beta, int n)
{
    enum { PARTS = 20000 };
    const double end = fmin(beta, 40.0);
    double sum = 0.0;
    for (int k = 0; k <= PARTS; k++) {
        const double y = end * k / PARTS;
        const double factor = k == 0 || k == PARTS ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
        sum += factor * exp(-y) * pow(1.0 - y / beta, n);
    }
    return sum * end / (3.0 * PARTS);
}

static void test_weights(void)
{
    double worst = 0.0;
    for (double beta = 1e-6; beta < 1e5; beta *= 1.7) {
        double weight[LOW_PASS_TERMS_MAX];
        low_pass_weights(beta, LOW_PASS_TERMS_MAX, weight);
        for (int n = 0; n < LOW_PASS_TERMS_MAX; n++) {
            const double expected = weight_by_quadrature(beta, n);
            worst = fmax(worst, fabs(weight[n] - expected) / expected);
        }
    }
    /* Measured 5e-13: of the quadrature. */
    printf("weights: %.1e\n", worst);
    TEST_ASSERT_DOUBLE_WITHIN(2e-12, 0.0, worst);
}

static void test_one_weight(void)
{
    double weight[1];
    low_pass_weights(2.0, 1, weight);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.86466471676338731, weight[0]);
}

typedef struct waveform {
    double bandwidth_rad_s;
    double t_s, i_A; /* the last point of phase A, */
    double seen_A;   /* and what a low-pass of straight lines between points makes of it */
} waveform;

static void follow(void *context, const plant_point *point)
{
    waveform *w = context;
    const double h = point->t_s - w->t_s;
    if (h > 0.0) {
        const double slope = (point->i_A[0] - w->i_A) / h;
        const double lag_A = slope / w->bandwidth_rad_s;
        w->seen_A = point->i_A[0] - lag_A + (w->seen_A - w->i_A + lag_A) * exp(-w->bandwidth_rad_s * h);
    }
    w->t_s = point->t_s;
    w->i_A = point->i_A[0];
}

static plant_config drive(double t_dead_s, double I_sat_A, double L_q_H, double f_Hz)
{
    motor m = laboratory_motor();
    m.L_q_H = L_q_H;
    m.u_dc_V = 565.0;
    plant_config c = plant_config_from_motor(&m);
    c.shaft.omega_e_start_rad_s = 942.0;
    c.inverter.t_dead_s = t_dead_s;
    c.machine.I_sat_A = I_sat_A;
    c.sensors.current_bandwidth_Hz = f_Hz;
    return c;
}

/* A traced waveform in steps of T/2000 through the low-pass, on both paths and for bandwidths far above and below 1/T. */
static void test_filtered_current(void)
{
    const struct {
        double t_dead_s, I_sat_A, L_q_H, f_Hz;
    } row[] = {{0.0, 0.0, 5.2e-3, 300.0}, {0.0, 0.0, 5.2e-3, 20e3}, {0.0, 0.0, 9e-3, 1e6},
               {2e-6, 0.0, 5.2e-3, 20e3}, {2e-6, 40.0, 9e-3, 5e3},  {0.0, 40.0, 5.2e-3, 300.0},
               {2e-6, 0.0, 5.2e-3, 1e6}};
    for (size_t n = 0; n < sizeof row / sizeof *row; n++) {
        const plant_config c = drive(row[n].t_dead_s, row[n].I_sat_A, row[n].L_q_H, row[n].f_Hz);
        waveform w = {.bandwidth_rad_s = 2.0 * VEC_PI * row[n].f_Hz};
        plant traced, plain;
        plant_init(&traced, &c);
        plant_init(&plain, &c);
        traced.trace = follow;
        traced.trace_context = &w;
        traced.trace_step_s = c.T_s / 2000.0;
        double worst = 0.0;
        for (int k = 0; k < 40; k++) {
            const double theta = plain.state.y[STATE_THETA_E] + 0.2 + 0.5 * VEC_PI;
            double duty[3];
            for (int x = 0; x < 3; x++) {
                duty[x] = 0.5 + 0.25 * cos(theta - 2.0 * VEC_PI / 3.0 * x);
            }
            plant_cycle(&traced, duty, NULL, NULL, NULL);
            plant_cycle(&plain, duty, NULL, NULL, NULL);
            plant_samples s;
            plant_sample(&plain, &s);
            worst = fmax(worst, fabs(s.i_A[0] - w.seen_A) / c.I_scale_A);
        }
        /* Measured up to 1.2e-8: of the straight lines. */
        printf("%.1e\n", worst);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(2e-8, 0.0, worst, "filtered current");
    }
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
    RUN_TEST(test_weights);
    RUN_TEST(test_one_weight);
    RUN_TEST(test_filtered_current);
    return UNITY_END();
}
