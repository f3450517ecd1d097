/*
 * The induction machine: the firmware's functions against the exact solution in double, that solution against an
 * independent integration, and with field orientation.
 */
#include "induction/induction_model.h"
#include "iqfoc/induction.h"
#include "iqfoc/predictor.h"
#include "model/papers.h"
#include "reference_vectors.h"

#define SEED UINT64_C(20240614)

void setUp(void)
{
}

void tearDown(void)
{
}

/* L_sigma = 1 and T = 1: fluxes are per unit, R_s is rho_s. */
typedef struct machine {
    induction_machine in_double;
    double k_u;
    iqfoc_induction_machine_t in_fixed;
} machine;

static machine machine_of(double rho_s, double rho_r, double a, double k_u)
{
    const machine m = {
        .in_double = {rho_s, rho_r, 1.0, rho_r / a},
        .k_u = k_u,
        .in_fixed = {to_fixed(rho_s, 30), to_fixed(rho_r, 30), to_fixed(a, 30), to_fixed(k_u, 26)}};
    return m;
}

typedef struct errors {
    worst i, flux, mean;
} errors;

static void add_vector(worst *w, iqfoc_ab_t got, double complex want)
{
    worst_add(w, got.alpha, creal(want));
    worst_add(w, got.beta, cimag(want));
}

static void compare(errors *e, const machine *m, uint64_t *seed, int32_t n, double i_reach, double flux_reach,
                    double u_reach)
{
    const iqfoc_induction_state_t x = {random_ab_in_disc(seed, i_reach), random_ab_in_disc(seed, flux_reach)};
    const iqfoc_ab_t u = random_ab_in_disc(seed, u_reach);
    const iq24_t speed = n % 10 == 0 ? 0 : random_iq24(seed, -1.0 / 3.0, 1.0 / 3.0);
    const iq24_t span = n % 3 == 0 ? IQ24_ONE : n % 3 == 1 ? IQ24(0.5) : random_iq24(seed, 0.001, 1.0);
    const iqfoc_induction_t c = iqfoc_induction_at_speed(&m->in_fixed, speed, span);
    const induction_state start = {complex_of_ab(x.i), complex_of_ab(x.flux)};
    const induction_span want = induction_advance(&m->in_double, start, m->k_u * complex_of_ab(u),
                                                  to_double(span), TWO_PI * to_double(speed));
    const iqfoc_induction_state_t got = iqfoc_induction_step(&c, x, u);
    add_vector(&e->i, got.i, want.end.i_A);
    add_vector(&e->flux, got.flux, want.end.psi_Wb);
    add_vector(&e->mean, iqfoc_induction_mean(&c, x, u), want.i_mean_A);
}

static void test_usual_machines(void)
{
    uint64_t seed = SEED;
    errors e = {{"current, usual machines", 0.0}, {"flux", 0.0}, {"mean", 0.0}};
    for (int32_t n = 0; n < 200000 / IQFOC_TEST_STRIDE; n++) {
        const machine m = machine_of(uniform(&seed, 0.0, 0.1), uniform(&seed, 0.01, 0.1),
                                     uniform(&seed, 0.001, 0.02), uniform(&seed, 0.05, 4.0));
        compare(&e, &m, &seed, n, 1.5, 4.0, 0.8);
    }
    worst_check(&e.i, 3.0);
    worst_check(&e.flux, 3.0);
    worst_check(&e.mean, 2.0);
}

static void test_whole_range(void)
{
    uint64_t seed = SEED + 1;
    errors e = {{"current, whole range", 0.0}, {"flux", 0.0}, {"mean", 0.0}};
    for (int32_t n = 0; n < 200000 / IQFOC_TEST_STRIDE; n++) {
        const machine m = machine_of(uniform(&seed, 0.0, 0.5), uniform(&seed, 0.01, 0.5),
                                     uniform(&seed, 0.0001, 0.1), uniform(&seed, 0.05, 16.0));
        compare(&e, &m, &seed, n, 8.0, 16.0, 2.0);
    }
    worst_check(&e.i, 12.0);
    worst_check(&e.flux, 9.0);
    worst_check(&e.mean, 7.0);
}

/* The stated range's corner does not wrap. */
static void test_no_overflow_at_the_corner_of_the_range(void)
{
    const machine m = machine_of(0.0, 0.5, 0.1, 16.0);
    double greatest = 0.0;
    for (int k = 0; k < 512; k++) {
        const double angle = TWO_PI * (k % 16) / 16.0;
        const double second = TWO_PI * (k / 16 % 16) / 16.0;
        const iq24_t speed = k / 256 == 0 ? IQ24_MAX : IQ24_MIN;
        const iqfoc_induction_t c = iqfoc_induction_at_speed(&m.in_fixed, speed, IQ24_ONE);
        const iqfoc_induction_state_t x = {{IQ24(8.0), 0},
                                           {to_iq24(16.0 * cos(angle)), to_iq24(16.0 * sin(angle))}};
        const iqfoc_ab_t u = {to_iq24(2.0 * cos(second)), to_iq24(2.0 * sin(second))};
        const induction_state start = {complex_of_ab(x.i), complex_of_ab(x.flux)};
        const double omega = TWO_PI * to_double(speed > 0 ? IQFOC_ROTOR_SPEED_MAX : -IQFOC_ROTOR_SPEED_MAX);
        const induction_span want =
            induction_advance(&m.in_double, start, m.k_u * complex_of_ab(u), 1.0, omega);
        const iqfoc_induction_state_t got = iqfoc_induction_step(&c, x, u);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0.0, cabs(complex_of_ab(got.i) - want.end.i_A));
        greatest = fmax(greatest, cabs(want.end.i_A));
    }
    printf("  greatest current %.1f per unit\n", greatest);
    TEST_ASSERT_TRUE(greatest > 50.0 && greatest < 81.0);
}

/* ---- The reference ---- */

static const induction_machine traction = {0.1, 0.06, 2.4e-3, 25e-3};

/* Runge and Kutta's fourth order on fluxes of stator and rotor: other states, other equations. */
static induction_state integrated(const induction_machine *m, induction_state x, double complex u,
                                  double span_s, double omega)
{
    enum { STEPS = 2000 };
    const double h = span_s / STEPS;
    double complex y[2] = {m->L_sigma_H * x.i_A + x.psi_Wb, x.psi_Wb};
    for (int n = 0; n < STEPS; n++) {
        double complex k[4][2];
        for (int stage = 0; stage < 4; stage++) {
            const double ahead = stage == 0 ? 0.0 : stage == 3 ? h : 0.5 * h;
            double complex z[2];
            for (int s = 0; s < 2; s++) {
                z[s] = y[s] + (stage == 0 ? 0.0 : ahead * k[stage - 1][s]);
            }
            const double complex i = (z[0] - z[1]) / m->L_sigma_H;
            const double complex i_rotor = z[1] / m->L_m_H - i;
            k[stage][0] = u - m->R_s_ohm * i;
            k[stage][1] = I * omega * z[1] - m->R_r_ohm * i_rotor;
        }
        for (int s = 0; s < 2; s++) {
            y[s] += h / 6.0 * (k[0][s] + 2.0 * k[1][s] + 2.0 * k[2][s] + k[3][s]);
        }
    }
    const induction_state end = {(y[0] - y[1]) / m->L_sigma_H, y[1]};
    return end;
}

static void test_reference_is_what_integration_gives(void)
{
    for (int n = -10; n <= 10; n++) {
        const induction_state start = {vec_complex(200.0, -150.0), vec_complex(1.0, 2.0)};
        const double complex u = vec_complex(300.0, 600.0);
        const induction_span x = induction_advance(&traction, start, u, 2e-3, 100.0 * n);
        const induction_state want = integrated(&traction, start, u, 2e-3, 100.0 * n);
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.0, cabs(x.end.i_A - want.i_A));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0.0, cabs(x.end.psi_Wb - want.psi_Wb));
        /* The mean from the stator's balance: L (i' - i) = (u - R_s mean) T - (psi' - psi). */
        const double complex drop = traction.R_s_ohm * x.i_mean_A;
        const double complex balance =
            (u - drop) * 2e-3 - (x.end.psi_Wb - start.psi_Wb) - traction.L_sigma_H * (x.end.i_A - start.i_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, cabs(balance));
    }
}

/* Pulses have their mean voltage; equal ones none. Edges make a difference to the end of the second order
 * only. */
static void test_pwm_cycle(void)
{
    const double duty[3] = {0.8, 0.35, 0.2};
    const double T_s = 2e-4;
    const induction_state start = {vec_complex(100.0, -50.0), vec_complex(2.0, 1.0)};
    const double complex u = 1500.0 * vec_complex((2.0 * 0.8 - 0.35 - 0.2) / 3.0, (0.35 - 0.2) / sqrt(3.0));
    const induction_cycle pulsed = induction_pwm(&traction, start, duty, 1500.0, T_s, 300.0);
    const induction_span even = induction_advance(&traction, start, u, T_s, 300.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, cabs(pulsed.whole.end.i_A - even.end.i_A));
    TEST_ASSERT_DOUBLE_WITHIN(2e-2, 0.0, cabs(pulsed.whole.i_mean_A - even.i_mean_A));
    TEST_ASSERT_DOUBLE_WITHIN(
        2e-2, 0.0, cabs(pulsed.i_mid_A - induction_advance(&traction, start, u, 0.5 * T_s, 300.0).end.i_A));
    const double equal[3] = {0.4, 0.4, 0.4};
    const induction_cycle free = induction_pwm(&traction, start, equal, 1500.0, T_s, 300.0);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-10, 0.0, cabs(free.whole.end.i_A - induction_advance(&traction, start, 0.0, T_s, 300.0).end.i_A));
}

static void test_steady_state_stands_still_in_the_flux_frame(void)
{
    const double complex i_dq = vec_complex(110.0, 260.0);
    const induction_point p = induction_steady(&traction, i_dq, 400.0);
    const double omega_s = 400.0 + p.omega_slip_rad_s;
    induction_state x = {i_dq, p.psi_Wb};
    /* A voltage that turns in 2000 small steps over a turn. */
    const double step_s = TWO_PI / omega_s / 2000.0;
    for (int n = 0; n < 2000; n++) {
        const double complex u = p.u_dq_V * vec_turn(omega_s * step_s * (n + 0.5));
        x = induction_advance(&traction, x, u, step_s, 400.0).end;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.0, cabs(x.i_A - i_dq));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, cabs(x.psi_Wb - p.psi_Wb));
}

/* Both circuits have the same impedance at every frequency. */
static void test_t_circuit_has_the_same_terminals(void)
{
    const induction_machine m = induction_from_t_circuit(0.1, 0.07, 1.3e-3, 1.2e-3, 27e-3);
    for (int n = 1; n < 20; n++) {
        const double omega_s = 40.0 * n;
        const double slip = 0.013 * n;
        const double complex rotor = 0.07 / slip + I * omega_s * 1.2e-3;
        const double complex magnetising = I * omega_s * 27e-3;
        const double complex t = 0.1 + I * omega_s * 1.3e-3 + rotor * magnetising / (rotor + magnetising);
        const double complex rotor_g = m.R_r_ohm / slip;
        const double complex magnetising_g = I * omega_s * m.L_m_H;
        const double complex g =
            m.R_s_ohm + I * omega_s * m.L_sigma_H + rotor_g * magnetising_g / (rotor_g + magnetising_g);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, cabs(t - g));
    }
}

/* In field orientation the papers' predictor serves: the flux for the magnet, L_sigma for L, R_s for R. */
static void test_field_orientation_makes_it_the_papers_form(void)
{
    const double complex i_dq = vec_complex(110.0, 260.0);
    const induction_point p = induction_steady(&traction, i_dq, 300.0);
    const double omega_s = 300.0 + p.omega_slip_rad_s;
    const papers_machine papers = {traction.R_s_ohm, traction.L_sigma_H, p.psi_Wb, 2e-3};
    const induction_state start = {i_dq, p.psi_Wb};
    const double complex u = p.u_dq_V * vec_turn(0.5 * omega_s * 2e-3) * papers_s1(omega_s * 2e-3);
    const double complex exact = induction_advance(&traction, start, u, 2e-3, 300.0).end.i_A;
    const double complex quasi = papers_predict_quasi_discrete(&papers, i_dq, u, 0.0, omega_s);
    const double complex euler = papers_predict_euler(&papers, i_dq, u, 0.0, omega_s);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, cabs(quasi - exact) / cabs(i_dq));
    TEST_ASSERT_TRUE(cabs(euler - exact) > 5.0 * cabs(quasi - exact));
}

/* From a wrong flux the observer finds the right one with the rotor's time constant. */
static void test_flux_observer_converges(void)
{
    const double T_s = 2e-3;
    const double I_b = 340.0;
    const iqfoc_induction_machine_t fixed =
        IQFOC_INDUCTION_MACHINE(0.1, 0.06, 2.4e-3, 25e-3, 2e-3, 340.0, 1500.0);
    const double omega = 300.0;
    const iq24_t speed = to_iq24(omega * T_s / TWO_PI);
    const double omega_fixed = TWO_PI * to_double(speed) / T_s;
    const iqfoc_induction_t c = iqfoc_induction_at_speed(&fixed, speed, IQ24_ONE);
    const induction_point p = induction_steady(&traction, vec_complex(110.0, 260.0), omega_fixed);
    const double omega_s = omega_fixed + p.omega_slip_rad_s;
    induction_state x = {vec_complex(110.0, 260.0), p.psi_Wb};
    iqfoc_induction_state_t estimate = {{0, 0}, {0, 0}};
    for (int n = 0; n < 4000; n++) {
        const double complex u = p.u_dq_V * vec_turn(omega_s * T_s * (n + 0.5));
        const iqfoc_ab_t u_iq = {to_iq24(creal(u) / 1500.0), to_iq24(cimag(u) / 1500.0)};
        estimate.i = (iqfoc_ab_t){to_iq24(creal(x.i_A) / I_b), to_iq24(cimag(x.i_A) / I_b)};
        estimate = iqfoc_induction_step(&c, estimate, u_iq);
        x = induction_advance(&traction, x, 1500.0 * complex_of_ab(u_iq), T_s, omega_fixed).end;
        if (n == 0) {
            const double complex first = complex_of_ab(estimate.flux) - x.psi_Wb / (traction.L_sigma_H * I_b);
            TEST_ASSERT_TRUE(cabs(first) > 1.0);
        }
    }
    /* 4000 cycles are 19 time constants of L_m/R_r. */
    const double complex last = complex_of_ab(estimate.flux) - x.psi_Wb / (traction.L_sigma_H * I_b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, cabs(last));
}

/* What the pulses add is the complex factor times the pulses' vector, rounded once. */
static void test_ripple_is_a_complex_product(void)
{
    uint64_t seed = SEED + 9;
    for (int n = 0; n < 20000 / IQFOC_TEST_STRIDE; n++) {
        iqfoc_induction_row_t row = {
            .of_ripple = {(int32_t)uniform(&seed, -6e7, 6e7), (int32_t)uniform(&seed, -6e7, 6e7)}};
        const iqfoc_ab_t even = {(iq24_t)uniform(&seed, -3e7, 3e7), (iq24_t)uniform(&seed, -3e7, 3e7)};
        const iqfoc_ab_t v = {(iq24_t)uniform(&seed, -8e6, 8e6), (iq24_t)uniform(&seed, -8e6, 8e6)};
        const double complex factor = ldexp(row.of_ripple.re_q26, -26) + I * ldexp(row.of_ripple.im_q26, -26);
        const double complex want =
            (double)even.alpha + I * (double)even.beta + factor * ((double)v.alpha + I * (double)v.beta);
        const iqfoc_ab_t got = iqfoc_induction_with_ripple(&row, even, v);
        TEST_ASSERT_DOUBLE_WITHIN(0.51, creal(want), got.alpha);
        TEST_ASSERT_DOUBLE_WITHIN(0.51, cimag(want), got.beta);
    }
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_ripple_is_a_complex_product);
    RUN_TEST(test_usual_machines);
    RUN_TEST(test_whole_range);
    RUN_TEST(test_no_overflow_at_the_corner_of_the_range);
    RUN_TEST(test_reference_is_what_integration_gives);
    RUN_TEST(test_pwm_cycle);
    RUN_TEST(test_steady_state_stands_still_in_the_flux_frame);
    RUN_TEST(test_t_circuit_has_the_same_terminals);
    RUN_TEST(test_field_orientation_makes_it_the_papers_form);
    RUN_TEST(test_flux_observer_converges);
    return UNITY_END();
}
