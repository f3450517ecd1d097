/*
 * The papers' formulas against what they stand for (integrals taken numerically), and every erratum in both
 * forms: the corrected one holds, the printed one does not.
 */
#include "model/papers.h"

#include "unity.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void setUp(void)
{
}

void tearDown(void)
{
}

static void assert_vector(double tolerance, double complex expected, double complex actual)
{
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, creal(expected), creal(actual));
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, cimag(expected), cimag(actual));
}

/* Mean over 0 ... 1 by Simpson's rule on 200 intervals: good to 1e-9 for what is integrated here. */
static double complex mean_of(double complex (*f)(double, const void *), const void *context)
{
    enum { INTERVALS = 200 };
    double complex sum = f(0.0, context) + f(1.0, context);
    for (int n = 1; n < INTERVALS; n++) {
        sum += (n % 2 == 1 ? 4.0 : 2.0) * f((double)n / INTERVALS, context);
    }
    return sum / (3.0 * INTERVALS);
}

/* ---- Rotor movement ---- */

static void test_s1_and_s2_are_the_closed_forms(void)
{
    for (int n = 3; n < 62; n++) {
        const double phi = 0.1 * n;
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, sin(0.5 * phi) / (0.5 * phi), papers_s1(phi));
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, (2.0 * sin(0.5 * phi) - phi * cos(0.5 * phi)) / (phi * phi),
                                  papers_s2(phi));
        TEST_ASSERT_EQUAL_DOUBLE(papers_s1(phi), papers_s1(-phi));
        TEST_ASSERT_EQUAL_DOUBLE(papers_s2(phi), -papers_s2(-phi));
    }
}

static void test_standstill_is_an_ordinary_point(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(1.0, papers_s1(0.0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, papers_s2(0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-20, 1e-6 / 12.0, papers_s2(1e-6));
    TEST_ASSERT_EQUAL_DOUBLE(1.0, papers_steady_gain(0.0));
}

static void test_steady_gain_of_six_step(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 6.0 * sqrt(3.0) / (pi * pi), papers_steady_gain(pi / 3.0));
}

/* ---- 2016 (4) and (10) ---- */

typedef struct straight {
    double complex start, end;
    double theta_rad, phi_rad;
} straight;

/* A current that runs straight in the stationary frame, as the turning rotor sees it. */
static double complex seen(double at, const void *context)
{
    const straight *s = context;
    return (s->start + at * (s->end - s->start)) * vec_turn(-s->theta_rad - at * s->phi_rad);
}

static void test_corrected_mean_is_the_mean_of_a_straight_current(void)
{
    const double phis[] = {-2.0, -pi / 3.0, -1e-9, 0.0, 1e-3, pi / 3.0, 2.0};
    for (size_t n = 0; n < sizeof phis / sizeof phis[0]; n++) {
        const straight s = {vec_complex(0.8, -0.3), vec_complex(0.5, 0.9), 0.7, phis[n]};
        const double complex mean = papers_mean_corrected_dq(0.5 * (s.start + s.end), s.end - s.start,
                                                             s.theta_rad + 0.5 * s.phi_rad, s.phi_rad);
        assert_vector(1e-9, mean_of(seen, &s), mean);
    }
}

static void test_normalised_form_is_the_same_mean(void)
{
    const straight s = {vec_complex(0.8, -0.3), vec_complex(0.5, 0.9), 0.7, 0.6};
    const double complex i_mean = 0.5 * (s.start + s.end);
    const double theta_m = s.theta_rad + 0.5 * s.phi_rad;
    const double complex relative = papers_mean_normalised(papers_movement_of(s.start, s.end, s.phi_rad));
    assert_vector(1e-14, papers_mean_corrected_dq(i_mean, s.end - s.start, theta_m, s.phi_rad),
                  relative * papers_mean_discrete_angle_dq(i_mean, theta_m));
}

static void test_steady_state_is_k_1_and_gamma_0(void)
{
    const double complex start = vec_complex(0.4, 1.1);
    const papers_movement m = papers_movement_of(start, start * vec_turn(pi / 3.0), pi / 3.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, m.k);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, m.gamma_rad);
    const papers_error e = papers_error_of(papers_mean_normalised(m));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 6.0 * sqrt(3.0) / (pi * pi) - 1.0, e.gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0, e.phase_rad);
}

static void test_change_is_what_the_rotor_sees(void)
{
    const papers_change c = papers_change_of(2.0 * vec_turn(3.0), 2.5 * vec_turn(-3.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.5, c.modulus);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0 * pi - 6.0, c.angle_rad);
}

/* ---- 2019 ---- */

static const papers_machine machine = {0.75, 5.2e-3, 0.134, 2e-4};
static const double omega = 2513.0;
static const double theta = 1.1;
static const double complex current = 9.0 - 4.0 * I;
static const double complex voltage = -50.0 + 240.0 * I;

/* (9) for all phases: the current's rise from the start of the cycle, R i taken at the start. */
static double complex rise(double at, const void *context)
{
    (void)context;
    const double t = at * machine.T_s;
    return ((voltage - machine.R_ohm * current) * t +
            machine.psi_f_Wb * (vec_turn(theta) - vec_turn(theta + omega * t))) /
           machine.L_H;
}

static void test_quasi_discrete_prediction_is_the_rise_over_the_cycle(void)
{
    assert_vector(1e-12, current + rise(1.0, NULL),
                  papers_predict_quasi_discrete(&machine, current, voltage, theta, omega));
}

static void test_quasi_discrete_mean_is_the_mean_rise(void)
{
    assert_vector(1e-10, current + mean_of(rise, NULL),
                  papers_mean_quasi_discrete(&machine, current, voltage, theta, omega));
}

static void test_quasi_discrete_is_euler_at_standstill(void)
{
    assert_vector(1e-12, papers_predict_euler(&machine, current, voltage, theta, 0.0),
                  papers_predict_quasi_discrete(&machine, current, voltage, theta, 0.0));
    assert_vector(1e-12, current + 0.5 * machine.T_s / machine.L_H * (voltage - machine.R_ohm * current),
                  papers_mean_quasi_discrete(&machine, current, voltage, theta, 0.0));
}

/* ---- Errata ---- */

/* (6): the EMF of phase A that is added to u. */
static double emf_of_phase_a(void)
{
    return machine.psi_f_Wb * omega * sin(theta);
}

static void test_erratum_2019_4_sign_of_the_emf(void)
{
    const double complex corrected = omega * machine.psi_f_Wb * vec_turn(theta - 0.5 * pi);
    const double complex printed = omega * machine.psi_f_Wb * vec_turn(theta + 0.5 * pi);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, emf_of_phase_a(), creal(corrected));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, -emf_of_phase_a(), creal(printed));
    /* Euler with "+ e", (1) and (3), is what papers_predict_euler computes with the corrected form only. */
    const double complex euler = papers_predict_euler(&machine, current, voltage, theta, omega);
    const double per_step = machine.T_s / machine.L_H;
    assert_vector(1e-12, current + per_step * (voltage - machine.R_ohm * current + corrected), euler);
    TEST_ASSERT_TRUE(10.0 < cabs(current + per_step * (voltage - machine.R_ohm * current + printed) - euler));
}

/* (10) of phase A; third_factor: 1 corrected, T printed. */
static double mean_of_phase_a(double third_factor)
{
    const double rise_of_u =
        (creal(voltage) - machine.R_ohm * creal(current)) * machine.T_s / (2.0 * machine.L_H);
    return creal(current) + rise_of_u + machine.psi_f_Wb * cos(theta) * third_factor / machine.L_H -
           machine.psi_f_Wb * (sin(theta + omega * machine.T_s) - sin(theta)) /
               (machine.L_H * omega * machine.T_s);
}

static void test_erratum_2019_10_factor_of_the_third_term(void)
{
    const double mean = creal(current + mean_of(rise, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, mean, mean_of_phase_a(1.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, mean,
                              creal(papers_mean_quasi_discrete(&machine, current, voltage, theta, omega)));
    TEST_ASSERT_TRUE(10.0 < fabs(mean_of_phase_a(machine.T_s) - mean));
}

static void test_erratum_2016_5_lacks_two_thirds(void)
{
    /* A balanced set of peak 3 at an angle of 0.4. */
    const double a = 3.0 * cos(0.4);
    const double b = 3.0 * cos(0.4 - 2.0 * pi / 3.0);
    const double c = 3.0 * cos(0.4 + 2.0 * pi / 3.0);
    const double complex printed = a + b * vec_turn(2.0 * pi / 3.0) + c * vec_turn(4.0 * pi / 3.0);
    const double complex by_2 = vec_complex(2.0 / 3.0 * (a - 0.5 * b - 0.5 * c), (b - c) / sqrt(3.0));
    assert_vector(1e-14, 3.0 * vec_turn(0.4), by_2);
    assert_vector(1e-14, by_2, 2.0 / 3.0 * printed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 4.5, cabs(printed));
}

/* Active vector k = 1 ... 6 of an inverter: legs high in the order A, AB, B, BC, C, CA. */
static double complex active_vector(int k)
{
    static const int high[6][3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
    const int *leg = high[k - 1];
    return vec_complex((2.0 * leg[0] - leg[1] - leg[2]) / 3.0, (leg[1] - leg[2]) / sqrt(3.0));
}

static void test_erratum_2016_section_5_spacing_of_the_vectors(void)
{
    for (int k = 1; k <= 6; k++) {
        assert_vector(1e-15, active_vector(k), 2.0 / 3.0 * vec_turn((k - 1) * pi / 3.0));
    }
    TEST_ASSERT_TRUE(0.3 < cabs(active_vector(2) - 2.0 / 3.0 * vec_turn(pi / 6.0)));
}

static void test_erratum_2016_section_5_time_constant(void)
{
    const double L_H = 30.1e-3;
    const double R_ohm = 97e-3;
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.310, L_H / R_ohm); /* Table 1 */
    TEST_ASSERT_TRUE(3.0 < R_ohm / L_H);                 /* as Section 5.1 prints it */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_s1_and_s2_are_the_closed_forms);
    RUN_TEST(test_standstill_is_an_ordinary_point);
    RUN_TEST(test_steady_gain_of_six_step);
    RUN_TEST(test_corrected_mean_is_the_mean_of_a_straight_current);
    RUN_TEST(test_normalised_form_is_the_same_mean);
    RUN_TEST(test_steady_state_is_k_1_and_gamma_0);
    RUN_TEST(test_change_is_what_the_rotor_sees);
    RUN_TEST(test_quasi_discrete_prediction_is_the_rise_over_the_cycle);
    RUN_TEST(test_quasi_discrete_mean_is_the_mean_rise);
    RUN_TEST(test_quasi_discrete_is_euler_at_standstill);
    RUN_TEST(test_erratum_2019_4_sign_of_the_emf);
    RUN_TEST(test_erratum_2019_10_factor_of_the_third_term);
    RUN_TEST(test_erratum_2016_5_lacks_two_thirds);
    RUN_TEST(test_erratum_2016_section_5_spacing_of_the_vectors);
    RUN_TEST(test_erratum_2016_section_5_time_constant);
    return UNITY_END();
}
