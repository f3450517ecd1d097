/*
 * Exact prediction with saliency: the firmware's functions against the solution in double (sim_host/model),
 * over the stated ranges and their corners, and against the non-salient predictor where both serve.
 */
#include "iqfoc/predictor_salient.h"
#include "iqfoc/transform.h"
#include "model/exact.h"
#include "reference_vectors.h"

#include <stdbool.h>

#define DRAWS 200000
#define SEED  UINT64_C(20240612)

void setUp(void)
{
}

void tearDown(void)
{
}

/* The smaller inductance is 1 and T is 1. */
typedef struct machine {
    exact_salient in_double;
    double k_u; /* of L = 1 */
    iqfoc_salient_machine_t in_fixed;
} machine;

static machine machine_of(double rho, double k_u, double k_psi, double q_to_d)
{
    const double L_d = q_to_d < 1.0 ? 1.0 / q_to_d : 1.0;
    const double L_q = q_to_d < 1.0 ? 1.0 : q_to_d;
    const machine m = {.in_double = {rho, L_d, L_q, k_psi},
                       .k_u = k_u,
                       .in_fixed = {.rho_d_q30 = to_fixed(rho / L_d, 30),
                                    .rho_q_q30 = to_fixed(rho / L_q, 30),
                                    .k_d_q26 = to_fixed(k_u / L_d, 26),
                                    .k_q_q26 = to_fixed(k_u / L_q, 26),
                                    .k_psi_d_q27 = to_fixed(k_psi / L_d, 27),
                                    .k_psi_q_q27 = to_fixed(k_psi / L_q, 27),
                                    .q_to_d_q27 = to_fixed(L_q / L_d, 27),
                                    .d_to_q_q27 = to_fixed(L_d / L_q, 27)}};
    return m;
}

static exact_span solution(const machine *m, iqfoc_dq_t i, iqfoc_dq_t u, iq24_t span, iq24_t speed)
{
    return exact_salient_span(&m->in_double, complex_of_dq(i), m->k_u * complex_of_dq(u), to_double(span),
                              TWO_PI * to_double(speed));
}

static void add_vector(worst *w, iqfoc_dq_t got, double complex want)
{
    worst_add(w, got.d, creal(want));
    worst_add(w, got.q, cimag(want));
}

static void compare(worst *end, worst *mean, const machine *m, uint64_t *seed, int32_t n, double i_reach,
                    double u_reach)
{
    const iqfoc_dq_t i = random_dq_in_disc(seed, i_reach);
    const iqfoc_dq_t u = random_dq_in_disc(seed, u_reach);
    const iq24_t speed = n % 10 == 0 ? 0 : random_iq24(seed, -1.0 / 3.0, 1.0 / 3.0);
    const iq24_t span = n % 3 == 0 ? IQ24_ONE : n % 3 == 1 ? IQ24(0.5) : random_iq24(seed, 0.001, 1.0);
    iqfoc_salient_t of_end;
    iqfoc_salient_t of_mean;
    iqfoc_salient_at_speed(&m->in_fixed, speed, span, &of_end, &of_mean);
    const exact_span want = solution(m, i, u, span, speed);
    add_vector(end, iqfoc_salient_step(&of_end, i, u), want.end_dq_A);
    add_vector(mean, iqfoc_salient_step(&of_mean, i, u), want.mean_dq_A);
}

static void test_usual_machines(void)
{
    uint64_t seed = SEED;
    worst end = {"end of the span, usual machines", 0.0};
    worst mean = {"mean, usual machines", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const machine m = machine_of(n % 16 == 0 ? 0.0 : uniform(&seed, 0.0, 0.1), uniform(&seed, 0.05, 3.0),
                                     uniform(&seed, 0.0, 3.0), uniform(&seed, 0.5, 3.0));
        compare(&end, &mean, &m, &seed, n, 1.5, 0.8);
    }
    worst_check(&end, 2.2);
    worst_check(&mean, 1.4);
}

static void test_whole_range(void)
{
    uint64_t seed = SEED + 1;
    worst end = {"end of the span, whole range", 0.0};
    worst mean = {"mean, whole range", 0.0};
    for (int32_t n = 0; n < DRAWS / IQFOC_TEST_STRIDE; n++) {
        const machine m =
            machine_of(uniform(&seed, 0.0, 1.0), uniform(&seed, 0.5, 16.0), uniform(&seed, 0.0, 8.0),
                       exp(uniform(&seed, -log(IQFOC_MAX_SALIENCY), log(IQFOC_MAX_SALIENCY))));
        compare(&end, &mean, &m, &seed, n, 8.0, 2.0);
    }
    worst_check(&end, 18.0);
    worst_check(&mean, 9.0);
}

/* At the ends of the ranges the largest sum that the header states is nearly met, and nothing wraps. */
static void test_no_overflow_at_the_corner_of_the_range(void)
{
    const machine m = machine_of(0.0, 16.0, 8.0, IQFOC_MAX_SALIENCY);
    double greatest = 0.0;
    for (iq24_t speed = -IQFOC_ROTOR_SPEED_MAX; speed <= IQFOC_ROTOR_SPEED_MAX; speed += 199729) {
        iqfoc_salient_t end;
        iqfoc_salient_at_speed(&m.in_fixed, speed, IQ24_ONE, &end, NULL);
        for (int corner = 0; corner < 64; corner++) {
            const iqfoc_dq_t i = {corner & 1 ? IQ24(8.0) : IQ24(-8.0), corner & 2 ? IQ24(8.0) : IQ24(-8.0)};
            const double angle = TWO_PI * (corner >> 2) / 16.0;
            const iqfoc_dq_t u = {to_iq24(2.0 * cos(angle)), to_iq24(2.0 * sin(angle))};
            const iqfoc_dq_t got = iqfoc_salient_step(&end, i, u);
            const double complex want = solution(&m, i, u, IQ24_ONE, speed).end_dq_A;
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, creal(want), to_double(got.d));
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, cimag(want), to_double(got.q));
            greatest = fmax(greatest, fmax(fabs(creal(want)), fabs(cimag(want))));
        }
    }
    printf("  greatest result %.1f per unit\n", greatest);
    TEST_ASSERT_TRUE(greatest > 80.0 && greatest < 121.0);
}

static void test_faster_than_the_limit_is_the_limit(void)
{
    const machine m = machine_of(0.05, 1.0, 1.5, 1.4);
    iqfoc_salient_t limit;
    iqfoc_salient_t beyond;
    iqfoc_salient_at_speed(&m.in_fixed, IQFOC_ROTOR_SPEED_MAX, IQ24_ONE, &limit, NULL);
    iqfoc_salient_at_speed(&m.in_fixed, IQ24_MAX, IQ24_ONE, NULL, &beyond);
    iqfoc_salient_at_speed(&m.in_fixed, IQ24_MAX, IQ24_ONE, &beyond, NULL);
    TEST_ASSERT_EQUAL_MEMORY(&limit, &beyond, sizeof limit);
}

/* A standing rotor and an ideal winding: the current rises by k u in each axis, its mean by half of it. */
static void test_standstill_without_resistance(void)
{
    const machine m = machine_of(0.0, 0.75, 1.7, 2.0);
    iqfoc_salient_t end;
    iqfoc_salient_t mean;
    iqfoc_salient_at_speed(&m.in_fixed, 0, IQ24_ONE, &end, &mean);
    const iqfoc_dq_t i = {IQ24(0.5), IQ24(-0.25)};
    const iqfoc_dq_t u = {IQ24(0.5), IQ24(0.25)};
    const iqfoc_dq_t next = iqfoc_salient_step(&end, i, u);
    const iqfoc_dq_t middle = iqfoc_salient_step(&mean, i, u);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5 + 0.375), next.d);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25 + 0.09375), next.q);
    TEST_ASSERT_EQUAL_INT32(IQ24(0.5 + 0.1875), middle.d);
    TEST_ASSERT_EQUAL_INT32(IQ24(-0.25 + 0.046875), middle.q);
}

/* With L_d = L_q it is the stationary predictor, seen from the rotor. */
static void test_without_saliency_it_is_the_stationary_predictor(void)
{
    uint64_t seed = SEED + 2;
    const machine m = machine_of(0.04, 0.75, 1.7, 1.0);
    const iqfoc_exact_winding_t winding = {to_fixed(0.04, 30), to_fixed(0.75, 26), to_fixed(1.7, 27)};
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    for (int32_t n = 0; n < 1000; n++) {
        const iq24_t speed = 2 * random_iq24(&seed, -1.0 / 6.0, 1.0 / 6.0);
        const iq24_t theta = random_iq24(&seed, 0.0, 1.0);
        const iqfoc_ab_t i = {random_iq24(&seed, -1.5, 1.5), random_iq24(&seed, -1.5, 1.5)};
        const iqfoc_ab_t u = {random_iq24(&seed, -0.6, 0.6), random_iq24(&seed, -0.6, 0.6)};
        const iq24_sincos_t sc = iq24_sincos(theta);
        iqfoc_salient_t end;
        iqfoc_salient_at_speed(&m.in_fixed, speed, IQ24_ONE, &end, NULL);
        const iqfoc_exact_t exact = iqfoc_exact_at_speed(&law, speed);
        const iqfoc_dq_t x = iqfoc_salient_step(&end, iqfoc_park(i, sc), iqfoc_park(u, sc));
        const iqfoc_dq_t y = iqfoc_park(iqfoc_exact_step(&exact, i, u, iq24_sincos(theta + speed / 2)),
                                        iq24_sincos(theta + speed));
        TEST_ASSERT_INT32_WITHIN(6, y.d, x.d);
        TEST_ASSERT_INT32_WITHIN(6, y.q, x.q);
    }
}

static void test_many_cycles_ahead(void)
{
    enum { CYCLES = 8 };
    uint64_t seed = SEED + 3;
    worst ahead = {"eight cycles ahead", 0.0};
    for (int32_t n = 0; n < 10000 / IQFOC_TEST_STRIDE; n++) {
        const machine m = machine_of(uniform(&seed, 0.0, 0.1), uniform(&seed, 0.05, 1.0),
                                     uniform(&seed, 0.0, 2.0), uniform(&seed, 0.5, 2.0));
        const iq24_t speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
        iqfoc_salient_t end;
        iqfoc_salient_at_speed(&m.in_fixed, speed, IQ24_ONE, &end, NULL);
        iqfoc_dq_t i = random_dq_in_disc(&seed, 1.0);
        double complex want = complex_of_dq(i);
        for (int k = 0; k < CYCLES; k++) {
            const iqfoc_dq_t u = random_dq_in_disc(&seed, 0.4);
            i = iqfoc_salient_step(&end, i, u);
            want = exact_salient_span(&m.in_double, want, m.k_u * complex_of_dq(u), 1.0,
                                      TWO_PI * to_double(speed))
                       .end_dq_A;
        }
        add_vector(&ahead, i, want);
    }
    worst_check(&ahead, 8.0);
}

static void test_constants_from_physical_values(void)
{
    static const iqfoc_salient_machine_t w =
        IQFOC_SALIENT_MACHINE(0.9, 8e-3, 11e-3, 0.2, 2.5e-4, IQFOC_I_BASE(6.0), 565.0);
    const double I_b = sqrt(2.0) * 6.0;
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.9 * 2.5e-4 / 8e-3, 30), w.rho_d_q30);
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.9 * 2.5e-4 / 11e-3, 30), w.rho_q_q30);
    TEST_ASSERT_EQUAL_INT32(to_fixed(2.5e-4 * 565.0 / (8e-3 * I_b), 26), w.k_d_q26);
    TEST_ASSERT_EQUAL_INT32(to_fixed(2.5e-4 * 565.0 / (11e-3 * I_b), 26), w.k_q_q26);
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.2 / (8e-3 * I_b), 27), w.k_psi_d_q27);
    TEST_ASSERT_EQUAL_INT32(to_fixed(0.2 / (11e-3 * I_b), 27), w.k_psi_q_q27);
    TEST_ASSERT_EQUAL_INT32(to_fixed(11.0 / 8.0, 27), w.q_to_d_q27);
    TEST_ASSERT_EQUAL_INT32(to_fixed(8.0 / 11.0, 27), w.d_to_q_q27);
}

int main(void)
{
    printf("seed %llu\n", (unsigned long long)SEED);
    UNITY_BEGIN();
    RUN_TEST(test_usual_machines);
    RUN_TEST(test_whole_range);
    RUN_TEST(test_no_overflow_at_the_corner_of_the_range);
    RUN_TEST(test_faster_than_the_limit_is_the_limit);
    RUN_TEST(test_standstill_without_resistance);
    RUN_TEST(test_without_saliency_it_is_the_stationary_predictor);
    RUN_TEST(test_many_cycles_ahead);
    RUN_TEST(test_constants_from_physical_values);
    return UNITY_END();
}
