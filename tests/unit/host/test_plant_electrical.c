/*
 * The exact flow of the linear machine against the textbook's closed form, and against itself.
 */
#include "plant/plant_electrical.h"
#include "unity.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>

/*
 * Equal inductances in the stationary frame, a = R/L, z = a + j omega, from rest at rotor angle 0:
 *     i(t) = E i + (1 - E)/R u - j omega psi/L (e^{j omega t} - E)/z,   E = e^{-a t}
 */
static double complex closed_form(const electrical_linear *m, double t, double complex u, double complex i)
{
    const double a = m->R_ohm / m->L_d_H, E = exp(-a * t);
    const double complex z = a + I * m->omega_e_rad_s;
    const double complex emf =
        I * m->omega_e_rad_s * m->psi_f_Wb / m->L_d_H * (cexp(I * m->omega_e_rad_s * t) - E) / z;
    return E * i - expm1(-a * t) / m->R_ohm * u - emf;
}

/* Over a fixed grid of speeds (to SFFR 3 at 5 kHz, both ways), spans and voltages; scale: what a volt-second
 * moves. */
static void test_closed_form(void)
{
    const double speeds[] = {0.0, 1e-3, 5.0, 314.0, -942.0, 2513.0, -10471.0};
    const double spans[] = {1e-9, 1e-6, 37e-6, 200e-6, 1e-3, 10e-3};
    double worst = 0.0;
    for (size_t k = 0; k < sizeof speeds / sizeof speeds[0]; k++) {
        for (size_t n = 0; n < sizeof spans / sizeof spans[0]; n++) {
            const electrical_linear m = {0.75, 5.2e-3, 5.2e-3, 0.134, speeds[k]};
            const double complex u = 410.0 - 160.0 * I, i = -3.0 + 7.0 * I;
            electrical_state x = {{creal(i), cimag(i)}, {0.0, 0.0}, {0.0, 0.0}};
            electrical_advance(&m, spans[n], (vec_dq){creal(u), cimag(u)}, &x);
            const double complex still = (x.i_dq_A.d + I * x.i_dq_A.q) * cexp(I * speeds[k] * spans[n]);
            const double complex expected = closed_form(&m, spans[n], u, i);
            worst = fmax(worst, cabs(still - expected) / fmax(cabs(expected), 10.0));
            /* The mean from Faraday's law: R integral(i) = u t - change of flux. */
            const double complex flux =
                5.2e-3 * (expected - i) + 0.134 * (cexp(I * speeds[k] * spans[n]) - 1.0);
            const double complex integral = x.integral_start_As.alpha + I * x.integral_start_As.beta;
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.0, cabs(0.75 * integral - (u * spans[n] - flux)));
        }
    }
    printf("closed form: %.1e\n", worst);
    /* Measured 1.4e-14; the angles of 100 rad and the closed form's own cancellation are in it. */
    TEST_ASSERT_DOUBLE_WITHIN(3e-14, 0.0, worst);
}

/* A span in one go, and in 7 uneven parts; a salient machine, whose integrals have no short closed form. */
static void test_spans_compose(void)
{
    const double parts[] = {0.01, 0.2, 0.04, 0.3, 0.15, 0.25, 0.05};
    const double speeds[] = {0.0, 900.0, -10471.0};
    for (size_t k = 0; k < 3; k++) {
        const electrical_linear m = {0.3, 2e-3, 6e-3, 0.1, speeds[k]};
        const double T = 400e-6;
        const vec_ab u = {300.0, -120.0};
        electrical_state whole = {{4.0, -5.0}, {0.0, 0.0}, {0.0, 0.0}};
        electrical_advance(&m, T, (vec_dq){u.alpha, u.beta}, &whole);
        electrical_state part = {{4.0, -5.0}, {0.0, 0.0}, {0.0, 0.0}};
        vec_ab integral = {0.0, 0.0};
        double theta = 0.0;
        for (int n = 0; n < 7; n++) {
            const vec_rotor r = rotor_at(theta);
            electrical_advance(&m, parts[n] * T, vec_to_dq(u, r), &part);
            const vec_ab add =
                vec_to_ab((vec_dq){part.integral_start_As.alpha, part.integral_start_As.beta}, r);
            integral.alpha += add.alpha;
            integral.beta += add.beta;
            theta += speeds[k] * parts[n] * T;
        }
        TEST_ASSERT_DOUBLE_WITHIN(2e-13, whole.i_dq_A.d, part.i_dq_A.d);
        TEST_ASSERT_DOUBLE_WITHIN(2e-13, whole.i_dq_A.q, part.i_dq_A.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-16, whole.integral_dq_As.d, part.integral_dq_As.d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-16, whole.integral_dq_As.q, part.integral_dq_As.q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-16, whole.integral_start_As.alpha, integral.alpha);
        TEST_ASSERT_DOUBLE_WITHIN(1e-16, whole.integral_start_As.beta, integral.beta);
    }
}

/* No resistance, no speed, no time: limits that a formula with divisions does not have. */
static void test_limits(void)
{
    const electrical_linear still = {0.0, 2e-3, 2e-3, 0.1, 0.0};
    electrical_state x = {{1.0, 2.0}, {0.0, 0.0}, {0.0, 0.0}};
    electrical_advance(&still, 0.0, (vec_dq){100.0, 0.0}, &x);
    TEST_ASSERT_TRUE(x.i_dq_A.d == 1.0 && x.i_dq_A.q == 2.0);
    electrical_advance(&still, 20e-6, (vec_dq){100.0, 0.0}, &x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2.0, x.i_dq_A.d);
    TEST_ASSERT_DOUBLE_WITHIN(1e-20, 1.5 * 20e-6, x.integral_dq_As.d);
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
    RUN_TEST(test_closed_form);
    RUN_TEST(test_spans_compose);
    RUN_TEST(test_limits);
    return UNITY_END();
}
