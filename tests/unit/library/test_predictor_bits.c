/*
 * The coefficients of the exact predictors, of salient machines and of induction machines, to the last bit of the
 * recursions and series that the comments in src/ state: which product is rounded, which quotient cut, how many terms
 * count. test_predictor_exact.c, test_predictor_salient.c and test_induction.c check that the series describe the
 * machines.
 */
#include "bits.h"

#include "iqfoc/induction.h"
#include "iqfoc/predictor_exact.h"
#include "iqfoc/predictor_salient.h"

#include <stdbool.h>

#define DRAWS (20000 / IQFOC_TEST_STRIDE)

enum { MOMENTS = 2 * IQFOC_EXACT_TERMS + 1 };

static const int64_t one_q28 = INT64_C(1) << 28;
static const int64_t one_q30 = INT64_C(1) << 30;

void setUp(void)
{
}

void tearDown(void)
{
}

static int64_t two_pi_q28(void)
{
    return llround(ldexp(TWO_PI, 28));
}

static int64_t product(int64_t x, int64_t y, int bits)
{
    return bits_product_of(x, y, bits);
}

/* A speed within the range, one held to it, a low one. */
static iq24_t any_turns(uint64_t *seed, int n)
{
    const int64_t most = n % 8 == 0 ? IQ24_ONE : n % 3 == 0 ? IQ24_ONE / 100 : IQFOC_ROTOR_TURNS_MAX;
    return bits_random(seed, -most, most);
}

static iq24_t any_span(uint64_t *seed, int n)
{
    return n % 4 == 0 ? IQ24_ONE : bits_random(seed, 1, IQ24_ONE);
}

static int64_t held(iq24_t turns)
{
    return bits_held(turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
}

/* ---- The round machine ---- */

/* e^-rho = 1 - rho (1 - rho/2 (1 - rho/3 ( ... to the 13th, each product to nearest, each rho/n cut. */
static int64_t decay_q30(int64_t rho_q30)
{
    int64_t bracket = one_q30;
    for (int n = 13; n >= 1; n--) {
        bracket = one_q30 - product(rho_q30 / n, bracket, 30);
    }
    return bracket;
}

/* p_(n-1) = (1 - (-1)^n E - (rho/2) p_n)/n from n = 20 with 0, Q29. */
static void moments(int64_t rho_q30, int64_t E_q30, int64_t p_q29[21])
{
    const int64_t one = one_q30 / 2;
    const int64_t E = bits_nearest(E_q30, 1);
    p_q29[20] = 0;
    for (int n = 20; n >= 1; n--) {
        p_q29[n - 1] = ((n % 2 == 0 ? one - E : one + E) - product(p_q29[n], rho_q30, 31)) / n;
    }
}

static void expect_law(const iqfoc_exact_law_t *got, const int64_t *moment, int64_t stays, int64_t k_u,
                       int64_t k_psi_q27, int64_t span)
{
    const int64_t span_q30 = 64 * span;
    const int64_t half_pi_squared_q29 = llround(ldexp(TWO_PI * TWO_PI / 16.0, 29));
    const int64_t reach = product(half_pi_squared_q29, product(span_q30, span_q30, 30), 30);
    int64_t even = product(product(k_psi_q27, two_pi_q28(), 30), span_q30, 30);
    int64_t odd = product(even, product(llround(ldexp(TWO_PI / 8.0, 31)), span_q30, 30), 31);
    TEST_ASSERT_EQUAL_INT64(bits_nearest(stays, 4), got->stays_q26);
    TEST_ASSERT_EQUAL_INT64(k_u, got->k_u_q26);
    for (int k = 0; k < IQFOC_EXACT_TERMS; k++) {
        TEST_ASSERT_EQUAL_INT64(product(even, moment[2 * k], 30), got->real_q25[k]);
        TEST_ASSERT_EQUAL_INT64(product(odd, moment[2 * k + 1], 30), got->imag_q25[k]);
        even = -product(even, reach / ((2 * k + 1) * (2 * k + 2)), 29);
        odd = -product(odd, reach / ((2 * k + 2) * (2 * k + 3)), 29);
    }
}

/* Horner's rule in Q25 by w in Q32. */
static int64_t polynomial(const int32_t *coefficient, int64_t w)
{
    int64_t sum = coefficient[IQFOC_EXACT_TERMS - 1];
    for (int k = IQFOC_EXACT_TERMS - 2; k >= 0; k--) {
        sum = coefficient[k] + product(sum, w, 32);
    }
    return sum;
}

static void test_laws_of_the_round_machine(void)
{
    uint64_t seed = 1;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_exact_winding_t w = {bits_random(&seed, 0, n % 2 == 0 ? one_q30 : one_q30 / 32),
                                         bits_random(&seed, 1, one_q30), bits_random(&seed, 0, one_q30)};
        const iq24_t span = any_span(&seed, n);
        const int64_t rho = product(w.rho_q30, span, 24);
        const int64_t k_u = product(w.k_u_q26, span, 24);
        const int64_t E = decay_q30(rho);
        int64_t p[21];
        int64_t q[MOMENTS];
        moments(rho, E, p);
        for (int k = 0; k < MOMENTS - 1; k++) {
            q[k] = ((k % 2 == 0 ? p[0] : -p[0]) + p[k + 1]) / (2 * (k + 1));
        }
        const iqfoc_exact_law_t end = iqfoc_exact_prediction(&w, span);
        const iqfoc_exact_law_t mean = iqfoc_exact_mean(&w, span);
        expect_law(&end, p, E, product(k_u, p[0], 30), w.k_psi_q27, span);
        expect_law(&mean, q, p[0], product(k_u, q[0], 30), w.k_psi_q27, span);
        const iq24_t turns = any_turns(&seed, n);
        const int64_t x = held(turns);
        const int64_t square = bits_floor(256 * x * 256 * x, one_q30);
        const iqfoc_exact_t at = iqfoc_exact_at_speed(&end, turns);
        const int64_t size = product(x < 0 ? -x : x, polynomial(end.real_q25, square), 23);
        TEST_ASSERT_EQUAL_INT32(end.stays_q26, at.stays_q26);
        TEST_ASSERT_EQUAL_INT32(end.k_u_q26, at.k_u_q26);
        TEST_ASSERT_EQUAL_INT64(x < 0 ? -size : size, at.w_real_q26);
        TEST_ASSERT_EQUAL_INT64(product(square, polynomial(end.imag_q25, square), 31), at.w_imag_q26);
    }
}

/* ---- Matrix series ---- */

/* As many terms as count: the last one kept is below a unit of Q28, by a bound of the matrix. */
static int terms(int64_t bound_q28)
{
    int64_t term = one_q28;
    int n = 1;
    while (term > 0) {
        n++;
        term = product(term, bound_q28 / n, 28);
    }
    return n + 1;
}

static int64_t size(int64_t x)
{
    return x < 0 ? -x : x;
}

static int64_t phi_q28(iq24_t turns, iq24_t span)
{
    return product(product(64 * held(turns), two_pi_q28(), 30), span, 24);
}

/* i_d, i_q, u_d, u_q, constant. */
typedef struct salient_row {
    int64_t of[5];
} salient_row;

typedef struct salient_matrix {
    int64_t rho_d, rho_q, phi;
} salient_matrix;

static salient_row times(const salient_row *r, const salient_matrix *m, int n)
{
    const int64_t phi = m->phi / n;
    const salient_row p = {{-product(r->of[0], m->rho_d / n, 28) - product(r->of[1], phi, 28),
                            product(r->of[0], phi, 28) - product(r->of[1], m->rho_q / n, 28),
                            r->of[0] / n - product(r->of[3], phi, 28),
                            r->of[1] / n + product(r->of[2], phi, 28), r->of[1] / n}};
    return p;
}

static void expect_row(const iqfoc_salient_row_t *got, const salient_row *r, bool of_d, int64_t k_u,
                       int64_t k_psi_phi, int64_t cross)
{
    const int64_t own = bits_nearest(r->of[of_d ? 0 : 1], 2);
    const int64_t other = product(r->of[of_d ? 1 : 0], cross, 29);
    TEST_ASSERT_EQUAL_INT64(of_d ? own : other, got->i_d_q26);
    TEST_ASSERT_EQUAL_INT64(of_d ? other : own, got->i_q_q26);
    TEST_ASSERT_EQUAL_INT64(product(r->of[2], k_u, 28), got->u_d_q26);
    TEST_ASSERT_EQUAL_INT64(product(r->of[3], k_u, 28), got->u_q_q26);
    TEST_ASSERT_EQUAL_INT64(-product(r->of[4], k_psi_phi, 28), got->constant_q26);
}

static void expect_salient(const iqfoc_salient_t *got, const salient_row *d, const salient_row *q,
                           const iqfoc_salient_machine_t *m, int64_t phi, iq24_t span)
{
    expect_row(&got->d, d, true, product(m->k_d_q26, span, 24), product(m->k_psi_d_q27, phi, 29),
               m->q_to_d_q27);
    expect_row(&got->q, q, false, product(m->k_q_q26, span, 24), product(m->k_psi_q_q27, phi, 29),
               m->d_to_q_q27);
}

static void test_rows_of_the_salient_machine(void)
{
    uint64_t seed = 2;
    for (int n = 0; n < DRAWS; n++) {
        const int64_t rho = n % 2 == 0 ? one_q30 : one_q30 / 32;
        const double ratio = exp(uniform(&seed, -2.0, 2.0));
        const iqfoc_salient_machine_t m = {
            bits_random(&seed, 0, rho),        bits_random(&seed, 0, rho),
            bits_random(&seed, 1, one_q30),    bits_random(&seed, 1, one_q30),
            bits_random(&seed, 0, one_q30),    bits_random(&seed, 0, one_q30),
            (int32_t)lround(ldexp(ratio, 27)), (int32_t)lround(ldexp(1.0 / ratio, 27))};
        const iq24_t turns = any_turns(&seed, n);
        const iq24_t span = any_span(&seed, n);
        const salient_matrix matrix = {product(m.rho_d_q30, span, 26), product(m.rho_q_q30, span, 26),
                                       phi_q28(turns, span)};
        salient_row d = {{one_q28, 0, 0, 0, 0}};
        salient_row q = {{0, one_q28, 0, 0, 0}};
        const int64_t larger = matrix.rho_d > matrix.rho_q ? matrix.rho_d : matrix.rho_q;
        for (int k = terms(larger + size(matrix.phi)); k >= 1; k--) {
            d = times(&d, &matrix, k + 1);
            q = times(&q, &matrix, k + 1);
            d.of[0] += one_q28;
            q.of[1] += one_q28;
        }
        iqfoc_salient_t end;
        iqfoc_salient_t mean;
        iqfoc_salient_at_speed(&m, turns, span, &end, &mean);
        expect_salient(&mean, &d, &q, &m, matrix.phi, span);
        d = times(&d, &matrix, 1);
        q = times(&q, &matrix, 1);
        d.of[0] += one_q28;
        q.of[1] += one_q28;
        expect_salient(&end, &d, &q, &m, matrix.phi, span);
        iqfoc_salient_t alone;
        iqfoc_salient_at_speed(&m, turns, span, &alone, NULL);
        TEST_ASSERT_EQUAL_MEMORY(&end, &alone, sizeof end);
        iqfoc_salient_at_speed(&m, turns, span, NULL, &alone);
        TEST_ASSERT_EQUAL_MEMORY(&mean, &alone, sizeof mean);
    }
}

/* ---- The induction machine, in complex numbers ---- */

typedef struct pair {
    int64_t re, im;
} pair;

typedef struct induction_row {
    pair i, p, u;
} induction_row;

typedef struct induction_matrix {
    int64_t rho_s, rho_r, a, phi;
} induction_matrix;

static induction_row turned(const induction_row *r, const induction_matrix *m, int n)
{
    const int64_t rho_s = m->rho_s / n;
    const int64_t rho_r = m->rho_r / n;
    const int64_t a = m->a / n;
    const int64_t phi = m->phi / n;
    const pair over = {r->i.re - r->p.re, r->i.im - r->p.im};
    const induction_row p = {{-product(r->i.re, rho_s, 28) - product(over.re, rho_r, 28),
                              -product(r->i.im, rho_s, 28) - product(over.im, rho_r, 28)},
                             {product(over.re, a, 28) + product(over.im, phi, 28),
                              product(over.im, a, 28) - product(over.re, phi, 28)},
                             {r->i.re / n, r->i.im / n}};
    return p;
}

/* pulses: what the voltage's pulses are multiplied by, -k_u x/24. */
static void expect_induction_row(const iqfoc_induction_row_t *got, const induction_row *r, int64_t k_u,
                                 pair pulses)
{
    const iqfoc_induction_factor_t want[4] = {
        {(int32_t)bits_nearest(r->i.re, 2), (int32_t)bits_nearest(r->i.im, 2)},
        {(int32_t)bits_nearest(r->p.re, 2), (int32_t)bits_nearest(r->p.im, 2)},
        {(int32_t)product(r->u.re, k_u, 28), (int32_t)product(r->u.im, k_u, 28)},
        {(int32_t)(-product(pulses.re, k_u, 28) / 24), (int32_t)(-product(pulses.im, k_u, 28) / 24)}};
    TEST_ASSERT_EQUAL(sizeof want, sizeof *got);
    TEST_ASSERT_EQUAL_MEMORY(want, got, sizeof want);
}

static void test_rows_of_the_induction_machine(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < DRAWS; n++) {
        const int64_t part = n % 2 == 0 ? 2 : 40;
        const iqfoc_induction_machine_t machine = {.rho_s_q30 = bits_random(&seed, 0, one_q30 / part),
                                                   .rho_r_q30 = bits_random(&seed, 0, one_q30 / part),
                                                   .a_q30 = bits_random(&seed, 0, one_q30 / 10),
                                                   .k_u_q26 = bits_random(&seed, 1, one_q30)};
        const iq24_t turns = any_turns(&seed, n);
        const iq24_t span = any_span(&seed, n);
        const induction_matrix m = {product(machine.rho_s_q30, span, 26),
                                    product(machine.rho_r_q30, span, 26), product(machine.a_q30, span, 26),
                                    phi_q28(turns, span)};
        const int64_t k_u = product(machine.k_u_q26, span, 24);
        induction_row i = {.i = {one_q28, 0}};
        induction_row p = {.p = {one_q28, 0}};
        for (int k = terms(m.rho_s + m.rho_r + m.a + size(m.phi)); k >= 1; k--) {
            i = turned(&i, &m, k + 1);
            p = turned(&p, &m, k + 1);
            i.i.re += one_q28;
            p.p.re += one_q28;
        }
        const iqfoc_induction_t got = iqfoc_induction_at_speed(&machine, turns, span);
        const induction_row mean = i;
        i = turned(&i, &m, 1);
        p = turned(&p, &m, 1);
        expect_induction_row(&got.i_mean, &mean, k_u, i.i);
        const pair i_pulses = turned(&i, &m, 1).i;
        const pair flux_pulses = turned(&p, &m, 1).i;
        i.i.re += one_q28;
        p.p.re += one_q28;
        expect_induction_row(&got.i, &i, k_u, i_pulses);
        expect_induction_row(&got.flux, &p, k_u, flux_pulses);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_laws_of_the_round_machine);
    RUN_TEST(test_rows_of_the_salient_machine);
    RUN_TEST(test_rows_of_the_induction_machine);
    return UNITY_END();
}
