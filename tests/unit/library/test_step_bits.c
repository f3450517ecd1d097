/*
 * Corrections and prediction by flux linkage to the last bit: one hash for each over all results. test_extension.c and
 * test_flux_predictor.c check the formulas in double precision, with their bounds in LSB.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/extension.h"
#include "iqfoc/flux_predictor.h"

#define DRAWS 60000

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
    iqfoc_abc_t i;
    i.a = any(seed, reach);
    i.b = any(seed, reach);
    i.c = any(seed, reach);
    return i;
}

static iqfoc_ab_t any_vector(uint64_t *seed, double reach)
{
    iqfoc_ab_t v;
    v.alpha = any(seed, reach);
    v.beta = any(seed, reach);
    return v;
}

/* ---- Corrections ---- */

static iqfoc_extension_t any_extension(uint64_t *seed)
{
    iqfoc_extension_t x;
    x.i_offset = any_phases(seed, 1.0);
    x.i_gain_inverse.a = random_iq24(seed, 0.5, 2.0);
    x.i_gain_inverse.b = random_iq24(seed, 0.5, 2.0);
    x.i_gain_inverse.c = random_iq24(seed, 0.5, 2.0);
    x.theta_0 = any(seed, 0.5);
    x.theta_delay = any(seed, 8.0);
    x.k_u = random_iq24(seed, 0.5, 2.0);
    x.v_dead = any(seed, 0.25);
    x.knee_inverse = random_iq24(seed, 0.0, 127.0);
    x.saturation = random_iq24(seed, 0.0, 4.0);
    return x;
}

static void test_corrections(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_extension_t x = any_extension(&seed);
        const double reach = n % 4 == 0 ? 60.0 : n % 4 == 1 ? 0.02 : 12.0;
        iqfoc_sample_t s = {.has_mean = n % 2 == 0};
        s.i = any_phases(&seed, reach);
        s.i_mean = any_phases(&seed, reach);
        s.theta = any(&seed, 100.0);
        s.speed = any(&seed, 1.0);
        s.u_dc = any(&seed, n % 8 == 0 ? 127.0 : 1.5);
        iqfoc_extension_sample(&x, &s);
        bits_add(&digest, &s.i, sizeof s.i);
        bits_add(&digest, &s.i_mean, sizeof s.i_mean);
        digest_add(&digest, s.theta);
        digest_add(&digest, s.u_dc);

        const iqfoc_abc_t i = any_phases(&seed, reach);
        const iqfoc_abc_t lost = iqfoc_extension_lost(&x, i);
        bits_add(&digest, &lost, sizeof lost);
        const iq24_t inverse = random_iq24(&seed, 0.5, 2.0);
        iqfoc_duties_t d;
        d.high.a = random_iq24(&seed, -0.05, 1.05);
        d.high.b = random_iq24(&seed, -0.05, 1.05);
        d.high.c = n % 2 == 0 ? 1 : IQ24_ONE - 1;
        d.scale = IQ24_ONE;
        iqfoc_extension_compensate(&x, &d, i, inverse);
        bits_add(&digest, &d, sizeof d);
    }
    bits_golden(UINT64_C(0x5bba10bff6faa68a), digest);
}

static void test_acting_voltage_and_saturated_coefficients(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_extension_t x = any_extension(&seed);
        const iqfoc_ab_t i = any_vector(&seed, n % 3 == 0 ? 20.0 : 1.0);
        const iqfoc_ab_t u = any_vector(&seed, 16.0);
        const iqfoc_ab_t acting = iqfoc_extension_acting(&x, u, i);
        bits_add(&digest, &acting, sizeof acting);
        iqfoc_predictor_t zero;
        zero.k_u = random_iq24(&seed, 0.0, 16.0);
        zero.k_r = random_iq24(&seed, 0.0, 1.0);
        zero.k_psi = random_iq24(&seed, 0.0, 8.0);
        const iqfoc_predictor_t p = iqfoc_extension_saturate(&x, &zero, i);
        bits_add(&digest, &p, sizeof p);
    }
    bits_golden(UINT64_C(0xdc2cf11eb4eb2689), digest);
}

/* An RL load without resistance has two coefficients of 0, which saturation leaves. */
static void test_coefficients_of_nothing(void)
{
    uint64_t seed = 4;
    const iqfoc_predictor_t least = {1, 0, 0};
    for (int n = 0; n < 100; n++) {
        const iqfoc_extension_t x = any_extension(&seed);
        const iqfoc_predictor_t p = iqfoc_extension_saturate(&x, &least, any_vector(&seed, 1.0));
        TEST_ASSERT_TRUE(p.k_u == 1 || p.k_u == 2);
        TEST_ASSERT_EQUAL_INT32(0, p.k_r | p.k_psi);
    }
}

/* ---- Prediction by flux ---- */

static void test_prediction_by_flux(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const double l_d = exp(uniform(&seed, -2.7, 2.0));
        const double l_q = exp(uniform(&seed, -2.7, 2.0));
        iqfoc_flux_predictor_t p;
        p.l_d = to_iq24(l_d);
        p.l_q = to_iq24(l_q);
        p.k_d = to_iq24(1.0 / l_d);
        p.k_q = to_iq24(1.0 / l_q);
        p.r = random_iq24(&seed, 0.0, 1.0);
        p.psi = random_iq24(&seed, 0.0, 16.0);
        p.skew = to_iq24((l_d - l_q) / (l_d + l_q));
        iqfoc_extension_t x = any_extension(&seed);
        x.saturation = n % 4 == 0   ? 0
                       : n % 4 == 1 ? 1 + (int32_t)(n / 4 % 3)
                                    : random_iq24(&seed, 0.0, n % 4 == 2 ? 0.2 : 4.0);
        const double reach = fmin(8.0, 32.0 / fmax(l_d, l_q)) / (n % 8 < 4 ? 1.5 : 12.0);
        const iqfoc_ab_t i = any_vector(&seed, reach);
        const iqfoc_ab_t u = any_vector(&seed, 1.4);
        const iq24_sincos_t start = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iq24_sincos_t end = iq24_sincos(random_iq24(&seed, 0.0, 1.0));
        const iqfoc_ab_t got = iqfoc_flux_predictor_step(&p, &x, i, u, start, end);
        bits_add(&digest, &got, sizeof got);
    }
    bits_golden(UINT64_C(0x75a61213fa203b42), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_corrections);
    RUN_TEST(test_acting_voltage_and_saturated_coefficients);
    RUN_TEST(test_coefficients_of_nothing);
    RUN_TEST(test_prediction_by_flux);
    return UNITY_END();
}
