/*
 * Corrections and prediction by flux linkage to the last bit: their headers' formulas in integers, each product
 * rounded as in the library. Other tests check the formulas themselves and the bounds in LSB.
 */
#include "bits.h"

#include "iqfoc/extension.h"
#include "iqfoc/flux_predictor.h"
#include "iqfoc/transform.h"

#include <stdbool.h>

#define DRAWS (60000 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static iq24_t any(uint64_t *seed, double reach)
{
    return random_iq24(seed, -reach, reach);
}

static iqfoc_abc_t any_phases(uint64_t *seed, double reach)
{
    const iqfoc_abc_t i = {any(seed, reach), any(seed, reach), any(seed, reach)};
    return i;
}

static iqfoc_ab_t any_vector(uint64_t *seed, double reach)
{
    const iqfoc_ab_t v = {any(seed, reach), any(seed, reach)};
    return v;
}

static int64_t saturated(int64_t x)
{
    return bits_held(x, INT32_MIN, INT32_MAX);
}

/* Its bits are test_iq24_bits.c's. */
static int64_t root(int64_t x)
{
    return iq24_sqrt((iq24_t)x);
}

/* ---- Corrections ---- */

static iqfoc_extension_t any_extension(uint64_t *seed)
{
    const iqfoc_extension_t x = {
        any_phases(seed, 1.0),
        {random_iq24(seed, 0.5, 2.0), random_iq24(seed, 0.5, 2.0), random_iq24(seed, 0.5, 2.0)},
        any(seed, 0.5),
        any(seed, 8.0),
        random_iq24(seed, 0.5, 2.0),
        any(seed, 0.25),
        random_iq24(seed, 0.0, 127.0),
        random_iq24(seed, 0.0, 4.0)};
    return x;
}

/* (measured - offset)/gain, held to +-15.9. */
static int64_t corrected(iq24_t measured, iq24_t offset, iq24_t gain_inverse)
{
    const int64_t limit = to_iq24(15.9);
    return bits_held(bits_product(saturated((int64_t)measured - offset), gain_inverse), -limit, limit);
}

static int64_t lost(const iqfoc_extension_t *x, int64_t i)
{
    const int64_t share = bits_held(bits_product(i, x->knee_inverse), -IQ24_ONE, IQ24_ONE);
    return bits_product(x->v_dead, share);
}

static int64_t compensated(const iqfoc_extension_t *x, iq24_t duty, iq24_t i, iq24_t inverse)
{
    const int64_t more = bits_product(lost(x, i), inverse);
    return duty <= 0 || duty >= IQ24_ONE ? duty : bits_held(duty + more, 0, IQ24_ONE);
}

static void expect_phases(int64_t a, int64_t b, int64_t c, iqfoc_abc_t got)
{
    TEST_ASSERT_EQUAL_INT64(a, got.a);
    TEST_ASSERT_EQUAL_INT64(b, got.b);
    TEST_ASSERT_EQUAL_INT64(c, got.c);
}

static void test_corrections(void)
{
    uint64_t seed = 1;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_extension_t x = any_extension(&seed);
        const double reach = n % 4 == 0 ? 60.0 : n % 4 == 1 ? 0.02 : 12.0;
        iqfoc_sample_t s = {.i = any_phases(&seed, reach),
                            .i_mean = any_phases(&seed, reach),
                            .has_mean = n % 2 == 0,
                            .theta = any(&seed, 100.0),
                            .turns = any(&seed, 1.0),
                            .u_dc = any(&seed, n % 8 == 0 ? 127.0 : 1.5)};
        const iqfoc_sample_t was = s;
        const iqfoc_abc_t o = x.i_offset;
        const iqfoc_abc_t g = x.i_gain_inverse;
        iqfoc_extension_sample(&x, &s);
        expect_phases(corrected(was.i.a, o.a, g.a), corrected(was.i.b, o.b, g.b),
                      corrected(was.i.c, o.c, g.c), s.i);
        if (was.has_mean) {
            expect_phases(corrected(was.i_mean.a, o.a, g.a), corrected(was.i_mean.b, o.b, g.b),
                          corrected(was.i_mean.c, o.c, g.c), s.i_mean);
        } else {
            TEST_ASSERT_EQUAL_MEMORY(&was.i_mean, &s.i_mean, sizeof s.i_mean);
        }
        const int64_t ahead = x.theta_0 + bits_product(x.theta_delay, was.turns);
        TEST_ASSERT_EQUAL_INT32((int32_t)iq24_wrap(was.theta - ahead), s.theta);
        TEST_ASSERT_EQUAL_INT64(saturated(bits_product(was.u_dc, x.k_u)), s.u_dc);

        const iqfoc_abc_t i = any_phases(&seed, reach);
        expect_phases(lost(&x, i.a), lost(&x, i.b), lost(&x, i.c), iqfoc_extension_lost(&x, i));
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        iqfoc_duties_t d = {
            {random_iq24(&seed, -0.05, 1.05), random_iq24(&seed, -0.05, 1.05), n % 2 == 0 ? 1 : IQ24_ONE - 1},
            IQ24_ONE};
        const iqfoc_abc_t before = d.high;
        iqfoc_extension_compensate(&x, &d, i, inverse);
        expect_phases(compensated(&x, before.a, i.a, inverse), compensated(&x, before.b, i.b, inverse),
                      compensated(&x, before.c, i.c, inverse), d.high);
    }
}

static void test_acting_voltage_and_saturated_coefficients(void)
{
    uint64_t seed = 2;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_extension_t x = any_extension(&seed);
        const iqfoc_ab_t i = any_vector(&seed, n % 3 == 0 ? 20.0 : 1.0);
        const iqfoc_ab_t u = any_vector(&seed, 16.0);
        const iqfoc_abc_t phases = iqfoc_clarke_inverse(i);
        const iqfoc_abc_t away = {(iq24_t)lost(&x, phases.a), (iq24_t)lost(&x, phases.b),
                                  (iq24_t)lost(&x, phases.c)};
        const iqfoc_ab_t off = iqfoc_clarke3(away);
        const iqfoc_ab_t acting = iqfoc_extension_acting(&x, u, i);
        TEST_ASSERT_EQUAL_INT64(bits_product(x.k_u, u.alpha) - off.alpha, acting.alpha);
        TEST_ASSERT_EQUAL_INT64(bits_product(x.k_u, u.beta) - off.beta, acting.beta);

        const iqfoc_predictor_t zero = {random_iq24(&seed, 0.0, 16.0), random_iq24(&seed, 0.0, 1.0),
                                        random_iq24(&seed, 0.0, 8.0)};
        const int64_t square =
            saturated(bits_nearest((int64_t)i.alpha * i.alpha + (int64_t)i.beta * i.beta, 24));
        const int64_t rise = bits_held(saturated(bits_product(x.saturation, square)), 0, IQ24_ONE);
        const int64_t factor = IQ24_ONE + rise;
        const iqfoc_predictor_t p = iqfoc_extension_saturate(&x, &zero, i);
        TEST_ASSERT_EQUAL_INT64(bits_held(bits_product(zero.k_u, factor), 0, to_iq24(16.0)), p.k_u);
        TEST_ASSERT_EQUAL_INT64(bits_held(bits_product(zero.k_r, factor), 0, IQ24_ONE), p.k_r);
        TEST_ASSERT_EQUAL_INT64(bits_held(bits_product(zero.k_psi, factor), 0, to_iq24(8.0)), p.k_psi);
    }
}

/* ---- Prediction by flux ---- */

/* The square of the current by the energy, times s. */
static int64_t weighted(const iqfoc_flux_predictor_t *p, int64_t s, int64_t d, int64_t q)
{
    const int64_t along = bits_product(IQ24_ONE + p->skew, d);
    const int64_t across = bits_product(IQ24_ONE - p->skew, q);
    return saturated(bits_product(s, saturated(bits_nearest(along * d + across * q, 24))));
}

static iqfoc_ab_t flux_of(const iqfoc_flux_predictor_t *p, int64_t s, iqfoc_ab_t i, iq24_sincos_t sc)
{
    const iqfoc_dq_t i_dq = iqfoc_park(i, sc);
    int64_t d = bits_product(p->l_d, i_dq.d);
    int64_t q = bits_product(p->l_q, i_dq.q);
    if (s != 0) {
        const int64_t rise = bits_held(weighted(p, s, i_dq.d, i_dq.q), 0, IQ24_ONE);
        const int64_t fall = bits_quotient(IQ24_ONE, IQ24_ONE + rise);
        d = bits_product(d, fall);
        q = bits_product(q, fall);
    }
    const iqfoc_dq_t flux = {(iq24_t)saturated(d + p->psi), (iq24_t)q};
    return iqfoc_park_inverse(flux, sc);
}

static int64_t held(int64_t i)
{
    return bits_held(i, -32 * (int64_t)IQ24_ONE, 32 * (int64_t)IQ24_ONE);
}

static iqfoc_ab_t current_of(const iqfoc_flux_predictor_t *p, int64_t s, iqfoc_ab_t flux, iq24_sincos_t sc)
{
    const iqfoc_dq_t x = iqfoc_park(flux, sc);
    int64_t d = held(bits_product(saturated((int64_t)x.d - p->psi), p->k_d));
    int64_t q = held(bits_product(x.q, p->k_q));
    if (s != 0) {
        const int64_t y4 = 4 * bits_held(weighted(p, s, d, q), 0, IQ24_ONE / 4);
        const int64_t factor = bits_quotient(2 * IQ24_ONE, IQ24_ONE + root(IQ24_ONE - y4));
        d = held(bits_product(d, factor));
        q = held(bits_product(q, factor));
    }
    const iqfoc_dq_t i = {(iq24_t)d, (iq24_t)q};
    return iqfoc_park_inverse(i, sc);
}

static iqfoc_ab_t advanced(const iqfoc_flux_predictor_t *p, iqfoc_ab_t flux, iqfoc_ab_t u, iqfoc_ab_t i)
{
    const iqfoc_ab_t next = {(iq24_t)saturated(flux.alpha + saturated(u.alpha - bits_product(p->r, i.alpha))),
                             (iq24_t)saturated(flux.beta + saturated(u.beta - bits_product(p->r, i.beta)))};
    return next;
}

static void test_prediction_by_flux(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < DRAWS; n++) {
        const double l_d = exp(uniform(&seed, -2.7, 2.0));
        const double l_q = exp(uniform(&seed, -2.7, 2.0));
        const iqfoc_flux_predictor_t p = {to_iq24(l_d),
                                          to_iq24(l_q),
                                          to_iq24(1.0 / l_d),
                                          to_iq24(1.0 / l_q),
                                          random_iq24(&seed, 0.0, 1.0),
                                          random_iq24(&seed, 0.0, 16.0),
                                          to_iq24((l_d - l_q) / (l_d + l_q))};
        iqfoc_extension_t x = any_extension(&seed);
        x.saturation = n % 4 == 0   ? 0
                       : n % 4 == 1 ? 1 + (int32_t)(n / 4 % 3)
                                    : random_iq24(&seed, 0.0, n % 4 == 2 ? 0.2 : 4.0);
        const double reach = fmin(8.0, 32.0 / fmax(l_d, l_q)) / (n % 8 < 4 ? 1.5 : 12.0);
        const iqfoc_ab_t i = any_vector(&seed, reach);
        const iqfoc_ab_t u = any_vector(&seed, 1.4);
        const iq24_sincos_t start = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iq24_sincos_t end = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iqfoc_ab_t flux = flux_of(&p, x.saturation, i, start);
        iqfoc_ab_t next =
            current_of(&p, x.saturation, advanced(&p, flux, iqfoc_extension_acting(&x, u, i), i), end);
        const iqfoc_ab_t mean = {(iq24_t)bits_floor((int64_t)i.alpha + next.alpha, 2),
                                 (iq24_t)bits_floor((int64_t)i.beta + next.beta, 2)};
        next =
            current_of(&p, x.saturation, advanced(&p, flux, iqfoc_extension_acting(&x, u, mean), mean), end);
        const iqfoc_ab_t got = iqfoc_flux_predictor_step(&p, &x, i, u, start, end);
        TEST_ASSERT_EQUAL_INT32(next.alpha, got.alpha);
        TEST_ASSERT_EQUAL_INT32(next.beta, got.beta);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_corrections);
    RUN_TEST(test_acting_voltage_and_saturated_coefficients);
    RUN_TEST(test_prediction_by_flux);
    return UNITY_END();
}
