/*
 * Exact prediction without saliency: the firmware's functions against the solution in double (sim_host/model), over
 * the stated ranges, their corners, every speed, every span; and at standstill, without resistance, and for spans put
 * together.
 */
#include "iqfoc/mean_current.h"
#include "iqfoc/predictor_exact.h"
#include "model/exact.h"
#include "reference_vectors.h"

#include <stdbool.h>

#define DRAWS 300000
#define SEED  UINT64_C(20240611)

void setUp(void)
{
}

void tearDown(void)
{
}

/* A machine of L = 1 and T = 1, so that R is rho and psi_f is k_psi, in double and as the library has it. */
typedef struct machine {
    papers_machine in_double;
    double k_u;
    iqfoc_exact_winding_t winding;
} machine;

static machine machine_of(double rho, double k_u, double k_psi)
{
    const machine m = {.in_double = {.R_ohm = rho, .L_H = 1.0, .psi_f_Wb = k_psi, .T_s = 1.0},
                       .k_u = k_u,
                       .winding = {to_fixed(rho, 30), to_fixed(k_u, 26), to_fixed(k_psi, 27)}};
    return m;
}

/* A step's arguments. */
typedef struct arguments {
    iqfoc_ab_t i, u;
    iq24_t span, speed, theta_mid;
} arguments;

static double complex solution(const machine *m, const arguments *a, bool mean)
{
    const double complex u = m->k_u * complex_of_ab(a->u);
    const double theta = TWO_PI * to_double(a->theta_mid);
    const double omega = TWO_PI * to_double(a->speed);
    return mean ? exact_mean(&m->in_double, complex_of_ab(a->i), u, to_double(a->span), theta, omega)
                : exact_predict(&m->in_double, complex_of_ab(a->i), u, to_double(a->span), theta, omega);
}

static iqfoc_exact_t coefficients(const machine *m, iq24_t span, iq24_t speed, bool mean)
{
    const iqfoc_exact_law_t law =
        mean ? iqfoc_exact_mean(&m->winding, span) : iqfoc_exact_prediction(&m->winding, span);
    return iqfoc_exact_at_speed(&law, speed);
}

static void compare(worst *w, const machine *m, const arguments *a, bool mean)
{
    const iqfoc_exact_t exact = coefficients(m, a->span, a->speed, mean);
    const iqfoc_ab_t got = iqfoc_exact_step(&exact, a->i, a->u, iq24_sincos(a->theta_mid));
    const double complex want = solution(m, a, mean);
    worst_add(w, got.alpha, creal(want));
    worst_add(w, got.beta, cimag(want));
}

/* A third whole cycles, a third halves, a third anything. */
static iq24_t random_span(uint64_t *seed, int32_t n)
{
    return n % 3 == 0 ? IQ24_ONE : n % 3 == 1 ? IQ24(0.5) : random_iq24(seed, 0.001, 1.0);
}

static arguments random_arguments(uint64_t *seed, int32_t n, double i, double u)
{
    const arguments a = {.i = random_ab_in_square(seed, i),
                         .u = random_ab_in_square(seed, u),
                         .span = random_span(seed, n),
                         .speed = n % 10 == 0 ? 0 : random_iq24(seed, -1.0 / 3.0, 1.0 / 3.0),
                         .theta_mid = random_iq24(seed, -1.0, 1.0)};
    return a;
}

static void test_usual_machines(void)
{
    uint64_t seed = SEED;
    worst end = {"end of the span, usual machines", 0.0};
    worst mean = {"mean, usual machines", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const machine m = machine_of(n % 16 == 0 ? 0.0 : uniform(&seed, 0.0, 0.1), uniform(&seed, 0.05, 3.0),
                                     uniform(&seed, 0.0, 3.0));
        const arguments a = random_arguments(&seed, n, 1.5, 0.6);
        compare(&end, &m, &a, false);
        compare(&mean, &m, &a, true);
    }
    worst_check(&end, 3.5);
    worst_check(&mean, 2.7);
}

static void test_whole_range(void)
{
    uint64_t seed = SEED + 1;
    worst end = {"end of the span, whole range", 0.0};
    worst mean = {"mean, whole range", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const machine m =
            machine_of(uniform(&seed, 0.0, 1.0), uniform(&seed, 0.05, 16.0), uniform(&seed, 0.0, 8.0));
        const arguments a = random_arguments(&seed, n, 32.0, 2.0);
        compare(&end, &m, &a, false);
        compare(&mean, &m, &a, true);
    }
    worst_check(&end, 12.0);
    worst_check(&mean, 10.0);
}

/* k_psi phi G itself, over all speeds. */
static void every_speed(double k_psi, double rho, worst *w)
{
    const machine m = machine_of(rho, 1.0, k_psi);
    const iqfoc_exact_law_t law[2] = {iqfoc_exact_prediction(&m.winding, IQ24_ONE),
                                      iqfoc_exact_mean(&m.winding, IQ24_ONE)};
    for (int32_t x = 0; x <= IQFOC_ROTOR_SPEED_MAX; x += 557 * IQFOC_TEST_STRIDE) {
        const arguments a = {.span = IQ24_ONE, .speed = x};
        for (int kind = 0; kind < 2; kind++) {
            const iqfoc_exact_t forward = iqfoc_exact_at_speed(&law[kind], x);
            const iqfoc_exact_t reverse = iqfoc_exact_at_speed(&law[kind], -x);
            const double complex want = I * solution(&m, &a, kind == 1); /* at theta_m = 0 */
            w->lsb = fmax(w->lsb, fabs(forward.w_real_q26 / 4.0 - creal(want) * 16777216.0));
            w->lsb = fmax(w->lsb, fabs(forward.w_imag_q26 / 4.0 - cimag(want) * 16777216.0));
            TEST_ASSERT_EQUAL_INT32(forward.w_real_q26, -reverse.w_real_q26);
            TEST_ASSERT_EQUAL_INT32(forward.w_imag_q26, reverse.w_imag_q26);
        }
    }
}

static void test_coefficients_over_all_speeds(void)
{
    worst usual = {"k_psi phi G, k_psi = 2", 0.0};
    worst extreme = {"k_psi phi G, k_psi = 8", 0.0};
    for (int k = 0; k <= 10; k++) {
        every_speed(2.0, 0.1 * k, &usual);
        every_speed(8.0, 0.1 * k, &extreme);
    }
    worst_check(&usual, 0.4);
    worst_check(&extreme, 0.8);
}

/* At a standstill of an ideal winding the current rises by k_u u, and its mean by half of it. */
static void test_standstill_without_resistance(void)
{
    const machine m = machine_of(0.0, 0.75, 1.7);
    const iqfoc_exact_t end = coefficients(&m, IQ24_ONE, 0, false);
    const iqfoc_exact_t mean = coefficients(&m, IQ24_ONE, 0, true);
    TEST_ASSERT_EQUAL_INT32(INT32_C(1) << 26, end.stays_q26);
    TEST_ASSERT_EQUAL_INT32(INT32_C(1) << 26, mean.stays_q26);
    TEST_ASSERT_EQUAL_INT32(m.winding.k_u_q26, end.k_u_q26);
    TEST_ASSERT_EQUAL_INT32(m.winding.k_u_q26 / 2, mean.k_u_q26);
    TEST_ASSERT_EQUAL_INT32(0, end.w_real_q26);
    TEST_ASSERT_EQUAL_INT32(0, end.w_imag_q26);
    const iqfoc_ab_t i = {IQ24(0.5), IQ24(-0.25)};
    const iqfoc_ab_t u = {IQ24(0.5), IQ24(0.25)};
    const iqfoc_ab_t next = iqfoc_exact_step(&end, i, u, iq24_sincos(IQ24(0.3)));
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5 + 0.375), next.alpha);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25 + 0.1875), next.beta);
}

/* Without resistance the exact prediction is the quasi-discrete one. */
static void test_without_resistance_it_is_quasi_discrete(void)
{
    uint64_t seed = SEED + 2;
    for (int32_t n = 0; n < 1000; n++) {
        const machine m = machine_of(0.0, 0.75, 1.7);
        const arguments a = random_arguments(&seed, 0, 1.5, 0.6);
        const iq24_t speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
        const iqfoc_predictor_t quasi = {IQ24(0.75), 0, IQ24(1.7)};
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
        const iq24_sincos_t sc = iq24_sincos(a.theta_mid);
        const iqfoc_exact_t exact = coefficients(&m, IQ24_ONE, speed, false);
        const iqfoc_ab_t x = iqfoc_exact_step(&exact, a.i, a.u, sc);
        const iqfoc_ab_t y = iqfoc_predictor_quasi_discrete(&quasi, a.i, a.u, &rotor, sc);
        TEST_ASSERT_INT32_WITHIN(3, y.alpha, x.alpha);
        TEST_ASSERT_INT32_WITHIN(3, y.beta, x.beta);
    }
}

/* Several cycles with a voltage each: the solution's steps one after the other. */
static void test_many_cycles_ahead(void)
{
    enum { CYCLES = 8 };
    uint64_t seed = SEED + 3;
    worst ahead = {"eight cycles ahead", 0.0};
    for (int32_t n = 0; n < 20000 / IQFOC_TEST_STRIDE; n++) {
        const machine m =
            machine_of(uniform(&seed, 0.0, 0.1), uniform(&seed, 0.05, 3.0), uniform(&seed, 0.0, 3.0));
        arguments a = random_arguments(&seed, 0, 1.5, 0.6);
        a.speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
        const iqfoc_exact_t exact = coefficients(&m, IQ24_ONE, a.speed, false);
        iqfoc_ab_t got = a.i;
        double complex want = complex_of_ab(a.i);
        const double omega = TWO_PI * to_double(a.speed);
        for (int k = 0; k < CYCLES; k++) {
            const iqfoc_ab_t u = random_ab_in_square(&seed, 0.6);
            got = iqfoc_exact_step(&exact, got, u, iq24_sincos(iq24_add_wrap(a.theta_mid, k * a.speed)));
            want = exact_predict(&m.in_double, want, m.k_u * complex_of_ab(u), 1.0,
                                 TWO_PI * to_double(a.theta_mid) + omega * k, omega);
        }
        worst_add(&ahead, got.alpha, creal(want));
        worst_add(&ahead, got.beta, cimag(want));
    }
    worst_check(&ahead, 20.0); /* below eight times a step's 3.5 */
}

/* Every term at its end and of one sign: nothing wraps. */
static void test_no_overflow_at_the_corner_of_the_range(void)
{
    const machine m = machine_of(0.0, 16.0, 8.0);
    for (int sign = -1; sign <= 1; sign += 2) {
        const iqfoc_exact_t exact = coefficients(&m, IQ24_ONE, sign * IQFOC_ROTOR_SPEED_MAX, false);
        const iqfoc_ab_t i = {sign * IQ24(32.0), -sign * IQ24(32.0)};
        const iqfoc_ab_t u = {sign * IQ24(2.0), -sign * IQ24(2.0)};
        /* w (sin, -cos) at 45 degrees adds to both for a positive w. */
        const iqfoc_ab_t next = iqfoc_exact_step(&exact, i, u, iq24_sincos(IQ24(0.125)));
        TEST_ASSERT_TRUE(sign * to_double(next.alpha) > 73.0 && sign * to_double(next.alpha) < 81.0);
        TEST_ASSERT_TRUE(-sign * to_double(next.beta) > 73.0 && -sign * to_double(next.beta) < 81.0);
    }
    const iqfoc_exact_t fastest = coefficients(&m, IQ24_ONE, IQFOC_ROTOR_SPEED_MAX, false);
    const iqfoc_exact_t beyond = coefficients(&m, IQ24_ONE, IQ24_MAX, false);
    TEST_ASSERT_EQUAL_INT32(fastest.w_real_q26, beyond.w_real_q26);
    TEST_ASSERT_EQUAL_INT32(-fastest.w_real_q26, coefficients(&m, IQ24_ONE, IQ24_MIN, false).w_real_q26);
}

/* The macro's constants are those of the physical values. */
static void test_constants_from_physical_values(void)
{
    static const iqfoc_exact_winding_t w =
        IQFOC_EXACT_WINDING(0.75, 5.2e-3, 0.134, 2e-4, IQFOC_I_BASE(10.5), 750.0);
    const double I_b = sqrt(2.0) * 10.5;
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.75 * 2e-4 / 5.2e-3, 30), w.rho_q30);
    TEST_ASSERT_EQUAL_INT32(to_fixed(2e-4 * 750.0 / (5.2e-3 * I_b), 26), w.k_u_q26);
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.134 / (5.2e-3 * I_b), 27), w.k_psi_q27);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_usual_machines);
    RUN_TEST(test_whole_range);
    RUN_TEST(test_coefficients_over_all_speeds);
    RUN_TEST(test_standstill_without_resistance);
    RUN_TEST(test_without_resistance_it_is_quasi_discrete);
    RUN_TEST(test_many_cycles_ahead);
    RUN_TEST(test_no_overflow_at_the_corner_of_the_range);
    RUN_TEST(test_constants_from_physical_values);
    return UNITY_END();
}
