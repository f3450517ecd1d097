/*
 * Prediction and mean currents: the firmware's functions against the same formulas in double, and those
 * formulas against a direct integration of the machine in which nothing of theirs is used.
 */
#include "iqfoc/mean_current.h"
#include "iqfoc/transform.h"
#include "reference_vectors.h"

#include <complex.h>
#include <stdbool.h>

#define DRAWS 300000
#define SEED  UINT64_C(20190315)

void setUp(void)
{
}

void tearDown(void)
{
}

/* One drawn case, in the library's numbers and as doubles with the same values. */
typedef struct instance {
    iqfoc_predictor_t predictor;
    iqfoc_ab_t i;
    iqfoc_ab_t u;
    iqfoc_ab_t delta;
    iqfoc_rotor_t rotor;
    iq24_sincos_t sc;
    double complex i_c, u_c, delta_c, e_c; /* e_c: cos + j sin as the library has them */
    double k_u, k_r, k_psi, phi, phi_s1, phi_s2, s1, s2;
} instance;

/* Usual drives three times in four, the ends of the stated ranges else. */
static instance drawn(uint64_t *seed, int32_t n)
{
    const bool extreme = n % 4 == 0;
    instance c;
    c.predictor.k_u = random_iq24(seed, 0.05, extreme ? 16.0 : 3.0);
    c.predictor.k_r = random_iq24(seed, 0.0, extreme ? 1.0 : 0.1);
    c.predictor.k_psi = random_iq24(seed, 0.0, extreme ? 8.0 : 3.0);
    c.i = random_ab_in_square(seed, extreme ? 32.0 : 1.5);
    c.u = random_ab_in_square(seed, extreme ? 2.0 : 0.6);
    c.delta = random_ab_in_square(seed, extreme ? 32.0 : 1.0);
    c.rotor = iqfoc_rotor_from_speed(random_iq24(seed, -1.0 / 3.0, 1.0 / 3.0));
    c.sc = iq24_sincos(random_iq24(seed, 0.0, 1.0));
    c.i_c = complex_of_ab(c.i);
    c.u_c = complex_of_ab(c.u);
    c.delta_c = complex_of_ab(c.delta);
    c.e_c = to_double(c.sc.cos) + I * to_double(c.sc.sin);
    c.k_u = to_double(c.predictor.k_u);
    c.k_r = to_double(c.predictor.k_r);
    c.k_psi = to_double(c.predictor.k_psi);
    c.phi = to_double(c.rotor.phi);
    c.phi_s1 = to_double(c.rotor.phi_s1);
    c.phi_s2 = to_double(c.rotor.phi_s2);
    c.s1 = to_double(c.rotor.s1);
    c.s2 = to_double(c.rotor.s2);
    return c;
}

static void add_vector(worst *w, iqfoc_ab_t got, double complex want)
{
    worst_add(w, got.alpha, creal(want));
    worst_add(w, got.beta, cimag(want));
}

static void test_formulas_in_fixed_point(void)
{
    uint64_t seed = SEED;
    worst euler = {"prediction, standard", 0.0};
    worst quasi = {"prediction, quasi-discrete", 0.0};
    worst mean = {"mean, quasi-discrete", 0.0};
    worst corrected = {"mean correction, general", 0.0};
    worst steady = {"mean correction, steady state", 0.0};
    worst seen = {"mean, quasi-discrete, from the rotor", 0.0};
    for (int32_t n = 0; n < DRAWS; n++) {
        const instance c = drawn(&seed, n);
        const double complex linear = c.i_c + c.k_u * c.u_c - c.k_r * c.i_c;
        add_vector(&euler, iqfoc_predictor_euler(&c.predictor, c.i, c.u, &c.rotor, c.sc),
                   linear - I * c.k_psi * c.phi * c.e_c);
        add_vector(&quasi, iqfoc_predictor_quasi_discrete(&c.predictor, c.i, c.u, &c.rotor, c.sc),
                   linear - I * c.k_psi * c.phi_s1 * c.e_c);
        add_vector(&mean, iqfoc_mean_current_quasi_discrete(&c.predictor, c.i, c.u, &c.rotor, c.sc),
                   c.i_c + 0.5 * (c.k_u * c.u_c - c.k_r * c.i_c) -
                       c.k_psi * c.e_c * (c.phi_s2 + 0.5 * I * c.phi_s1));
        const iqfoc_dq_t dq = iqfoc_mean_current_correct(c.i, c.delta, &c.rotor, c.sc);
        const double complex want = conj(c.e_c) * (c.s1 * c.i_c - I * c.s2 * c.delta_c);
        worst_add(&corrected, dq.d, creal(want));
        worst_add(&corrected, dq.q, cimag(want));
        const iq24_t w = iqfoc_predictor_emf(&c.predictor, &c.rotor);
        const iqfoc_ab_t from = random_ab_in_square(&seed, n % 4 == 0 ? 21.3 : 1.5);
        const iqfoc_ab_t to = random_ab_in_square(&seed, n % 4 == 0 ? 51.2 : 1.5);
        const iqfoc_dq_t mean_dq = iqfoc_mean_current_seen(from, to, w, &c.rotor, c.sc);
        const double complex change = complex_of_ab(to) - complex_of_ab(from);
        const double complex middle = 0.5 * (complex_of_ab(to) + complex_of_ab(from));
        const double complex seen_want =
            conj(c.e_c) * (c.s1 * middle - I * c.s2 * change) - to_double(w) * c.s2;
        worst_add(&seen, mean_dq.d, creal(seen_want));
        worst_add(&seen, mean_dq.q, cimag(seen_want));
        const iq24_t gain = iqfoc_rotor_steady_gain(c.rotor.speed);
        const iqfoc_dq_t steady_dq = iqfoc_mean_current_correct_steady(c.i, gain, c.sc);
        const double complex steady_want = conj(c.e_c) * c.i_c * to_double(gain);
        worst_add(&steady, steady_dq.d, creal(steady_want));
        worst_add(&steady, steady_dq.q, cimag(steady_want));
    }
    worst_check(&euler, 1.0);
    worst_check(&quasi, 1.0);
    worst_check(&mean, 2.0);
    worst_check(&corrected, 1.3);
    worst_check(&steady, 1.3);
    worst_check(&seen, 1.9);
}

/* The stated range's corner: every term at its end and of one sign. Nothing wraps. */
static void test_no_overflow_at_the_corner_of_the_range(void)
{
    const iqfoc_predictor_t strong = {IQ24(16.0), 0, IQ24(8.0)};
    for (int32_t quadrant = 0; quadrant < 4; quadrant++) {
        const iq24_sincos_t sc = iq24_sincos(quadrant * (IQ24_ONE / 4) + IQ24_ONE / 8);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(quadrant < 2 ? IQ24_ONE : -IQ24_ONE);
        const double s = sc.sin > 0 ? 1.0 : -1.0;
        const double c = sc.cos > 0 ? -1.0 : 1.0;
        const double sign = rotor.speed > 0 ? 1.0 : -1.0;
        const iqfoc_ab_t i = {to_iq24(32.0 * s * sign), to_iq24(32.0 * c * sign)};
        const iqfoc_ab_t u = {to_iq24(2.0 * s * sign), to_iq24(2.0 * c * sign)};
        const iqfoc_ab_t next[] = {iqfoc_predictor_euler(&strong, i, u, &rotor, sc),
                                   iqfoc_predictor_quasi_discrete(&strong, i, u, &rotor, sc)};
        for (int32_t k = 0; k < 2; k++) {
            TEST_ASSERT_TRUE(s * sign * to_double(next[k].alpha) > 64.0);
            TEST_ASSERT_TRUE(c * sign * to_double(next[k].beta) > 64.0);
        }
        const iqfoc_ab_t mean = iqfoc_mean_current_quasi_discrete(&strong, i, u, &rotor, sc);
        TEST_ASSERT_TRUE(s * sign * to_double(mean.alpha) > 45.0);
        TEST_ASSERT_TRUE(c * sign * to_double(mean.beta) > 45.0);
    }
}

/*
 * A cycle of a machine, integrated by RK4 in 400 steps, with the sums that make its means by Simpson's rule.
 */
typedef struct truth {
    double complex i_end, i_mean, i_mean_rotor;
} truth;

static double complex slope(double complex i, double complex u, double rho, double k_psi, double phi,
                            double t, double theta)
{
    return u - rho * i - I * k_psi * phi * cexp(I * (theta + phi * t));
}

static truth integrated(double complex i, double complex u, double rho, double k_psi, double phi,
                        double theta, double frozen_rho)
{
    enum { STEPS = 400 };
    const double h = 1.0 / STEPS;
    const double complex i_0 = i;
    truth result = {0.0, 0.0, 0.0};
    for (int n = 0; n < STEPS; n++) {
        const double t = n * h;
        /* The quasi-discrete model holds R i at its first value: frozen_rho times i_0 in place of rho i. */
        const double complex held = u - frozen_rho * i_0;
        const double complex k1 = slope(i, held, rho, k_psi, phi, t, theta);
        const double complex k2 = slope(i + 0.5 * h * k1, held, rho, k_psi, phi, t + 0.5 * h, theta);
        const double complex k3 = slope(i + 0.5 * h * k2, held, rho, k_psi, phi, t + 0.5 * h, theta);
        const double complex k4 = slope(i + h * k3, held, rho, k_psi, phi, t + h, theta);
        const double complex end = i + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        const double complex middle =
            0.5 * (i + end) + h / 8.0 * (k1 - slope(end, held, rho, k_psi, phi, t + h, theta));
        const double complex r0 = cexp(-I * (theta + phi * t));
        const double complex r1 = cexp(-I * (theta + phi * (t + 0.5 * h)));
        const double complex r2 = cexp(-I * (theta + phi * (t + h)));
        result.i_mean += h / 6.0 * (i + 4.0 * middle + end);
        result.i_mean_rotor += h / 6.0 * (i * r0 + 4.0 * middle * r1 + end * r2);
        i = end;
    }
    result.i_end = i;
    return result;
}

static void check_against_integration(double phi, double theta)
{
    const double k_psi = 1.735; /* psi/(L I_b) of the 2019 drive */
    const double rho = 0.0288;  /* R T/L of it */
    const double complex i = 0.6 - 0.7 * I;
    const double complex u = 0.5 + 0.4 * I; /* already T U/(L I_b) */
    const iqfoc_predictor_t p = {IQ24_ONE, to_iq24(rho), to_iq24(k_psi)};
    const iqfoc_ab_t i_iq = {to_iq24(creal(i)), to_iq24(cimag(i))};
    const iqfoc_ab_t u_iq = {to_iq24(creal(u)), to_iq24(cimag(u))};
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(to_iq24(phi / TWO_PI));
    const iq24_sincos_t sc_mid = iq24_sincos(to_iq24((theta + phi / 2.0) / TWO_PI));
    const truth frozen = integrated(i, u, 0.0, k_psi, phi, theta, rho);
    const double few_lsb = 1.5e-6; /* inputs rounded to IQ24: angle and speed 2 pi 0.5 LSB, times k_psi */

    const double complex next = complex_of_ab(iqfoc_predictor_quasi_discrete(&p, i_iq, u_iq, &rotor, sc_mid));
    TEST_ASSERT_DOUBLE_WITHIN(few_lsb, 0.0, cabs(next - frozen.i_end));
    const double complex mean =
        complex_of_ab(iqfoc_mean_current_quasi_discrete(&p, i_iq, u_iq, &rotor, sc_mid));
    TEST_ASSERT_DOUBLE_WITHIN(few_lsb, 0.0, cabs(mean - frozen.i_mean));

    /* Both papers' corrections in one are the two one after the other. */
    const iqfoc_ab_t i_next = iqfoc_predictor_quasi_discrete(&p, i_iq, u_iq, &rotor, sc_mid);
    const iqfoc_ab_t delta = {i_next.alpha - i_iq.alpha, i_next.beta - i_iq.beta};
    const iqfoc_dq_t twice = iqfoc_mean_current_correct(
        iqfoc_mean_current_quasi_discrete(&p, i_iq, u_iq, &rotor, sc_mid), delta, &rotor, sc_mid);
    const iqfoc_dq_t at_once =
        iqfoc_mean_current_seen(i_iq, i_next, iqfoc_predictor_emf(&p, &rotor), &rotor, sc_mid);
    TEST_ASSERT_INT32_WITHIN(5, twice.d, at_once.d);
    TEST_ASSERT_INT32_WITHIN(5, twice.q, at_once.q);

    /* The general correction is exact for a current that is linear in the stationary frame: no EMF, no
     * resistance. */
    const truth linear = integrated(i, u, 0.0, 0.0, phi, theta, 0.0);
    const iqfoc_ab_t i_mean = {to_iq24(creal(linear.i_mean)), to_iq24(cimag(linear.i_mean))};
    const iqfoc_dq_t dq = iqfoc_mean_current_correct(i_mean, u_iq, &rotor, sc_mid);
    TEST_ASSERT_DOUBLE_WITHIN(few_lsb, creal(linear.i_mean_rotor), to_double(dq.d));
    TEST_ASSERT_DOUBLE_WITHIN(few_lsb, cimag(linear.i_mean_rotor), to_double(dq.q));
}

static void test_formulas_are_what_integration_gives(void)
{
    for (int32_t n = -40; n <= 40; n++) {
        check_against_integration(TWO_PI / 3.0 * n / 40.0, 0.37 * n);
    }
}

static void test_steady_state_form_is_the_general_one(void)
{
    /* Same dq current at both ends: delta = i_mean 2j tan(phi/2) for a straight track (2016 Fig. 6). */
    for (int32_t n = -30; n <= 30; n++) {
        const double phi = TWO_PI / 3.0 * n / 30.0;
        const double complex mean = 0.8 + 0.3 * I;
        const double complex change = mean * 2.0 * I * tan(phi / 2.0);
        const iqfoc_ab_t i_mean = {to_iq24(creal(mean)), to_iq24(cimag(mean))};
        const iqfoc_ab_t delta = {to_iq24(creal(change)), to_iq24(cimag(change))};
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(to_iq24(phi / TWO_PI));
        const iq24_sincos_t sc = iq24_sincos(to_iq24(0.123 * n));
        const iqfoc_dq_t general = iqfoc_mean_current_correct(i_mean, delta, &rotor, sc);
        const iqfoc_dq_t steady =
            iqfoc_mean_current_correct_steady(i_mean, iqfoc_rotor_steady_gain(rotor.speed), sc);
        TEST_ASSERT_INT32_WITHIN(6, general.d, steady.d);
        TEST_ASSERT_INT32_WITHIN(6, general.q, steady.q);
    }
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_formulas_in_fixed_point);
    RUN_TEST(test_no_overflow_at_the_corner_of_the_range);
    RUN_TEST(test_formulas_are_what_integration_gives);
    RUN_TEST(test_steady_state_form_is_the_general_one);
    return UNITY_END();
}
