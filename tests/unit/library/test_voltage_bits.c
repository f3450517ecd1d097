/*
 * Reference, overmodulation, modulation and resolver to the last bit: one hash for each over all results. Other tests
 * check the formulas in double precision, with their bounds in LSB.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/overmodulation.h"
#include "iqfoc/reference.h"
#include "iqfoc/resolver.h"

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

/* ---- Torque to current ---- */

static void test_reference(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const double i_max = uniform(&seed, 0.1, 4.0);
        iqfoc_reference_config_t c;
        c.saliency = n % 4 == 0 ? 0 : n % 16 == 1 ? 1 : any(&seed, 10.9 / i_max);
        c.i_max = to_iq24(i_max);
        c.i_d_min = random_iq24(&seed, -i_max, 0.0);
        c.gain = random_iq24(&seed, 0.0, 8.0);
        c.share = random_iq24(&seed, 0.5, 1.125);
        iqfoc_reference_t state;
        state.weakening = bits_random(&seed, -4 * IQ24_ONE, 0) * (int64_t)IQ24_ONE;
        state.i_q = any(&seed, i_max);
        const iq24_t torque = any(&seed, n % 2 == 0 ? 8.0 : 0.5);
        iqfoc_dq_t u;
        u.d = any(&seed, n % 5 == 0 ? 20.0 : 1.2);
        u.q = any(&seed, 1.7);
        const iq24_t u_limit = random_iq24(&seed, 0.0, 1.5);
        const iqfoc_dq_t got = iqfoc_reference_step(&state, &c, torque, u, u_limit);
        bits_add(&digest, &got, sizeof got);
        bits_add64(&digest, state.weakening);
        TEST_ASSERT_EQUAL_INT32(got.q, state.i_q);
    }
    bits_golden(UINT64_C(0x5fb50ed0b3d92b8d), digest);
}

static void test_reference_by_the_link(void)
{
    uint64_t seed = 8;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_reference_config_t c = {0, IQ24_ONE, -IQ24_ONE, 1, 0};
        c.share = random_iq24(&seed, 0.5, 1.125);
        iqfoc_reference_t state = {bits_random(&seed, -4 * IQ24_ONE, 0) * (int64_t)IQ24_ONE, 0};
        iqfoc_reference_link_t link;
        link.gain = random_iq24(&seed, 0.0, n % 5 == 0 ? 66.0 : 2.0);
        link.low = n % 20 == 0 ? bits_random(&seed, 0, 2) : random_iq24(&seed, 0.3, 1.5);
        for (int k = 0; k < 3; k++) {
            iqfoc_dq_t u;
            u.d = any(&seed, 1.2);
            u.q = any(&seed, 1.2);
            const iq24_t u_limit =
                n % 3 == 0 ? random_iq24(&seed, 0.0, 1.5) : link.low + bits_random(&seed, -9999, 9999);
            digest_add(&digest, iqfoc_reference_link(&state, &link, &c, u, iq24_max(u_limit, 0)));
            digest_add(&digest, link.low);
            bits_add64(&digest, state.weakening);
        }
    }
    bits_golden(UINT64_C(0x21e834d8c1492bf0), digest);
}

/* The integrator is never above 0, not by its last bit. */
static void test_weakening_ends_at_nothing(void)
{
    const iqfoc_reference_config_t c = {0, IQ24_ONE, -IQ24_ONE, 1, IQ24(0.5)};
    const iqfoc_dq_t none = {0, 0};
    iqfoc_reference_t state = {-1, 0};
    for (int n = 0; n < 3; n++) {
        /* (share u_limit)^2 = 2^-24: one unit of 2^-48 a step. */
        (void)iqfoc_reference_step(&state, &c, 0, none, 8192);
        TEST_ASSERT_EQUAL_INT64(0, state.weakening);
    }
}

/* ---- Overmodulation ---- */

static void test_overmodulation(void)
{
    uint64_t seed = 5;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 4 * DRAWS; n++) {
        const double angle = uniform(&seed, 0.0, TWO_PI);
        const double length = n % 8 == 0   ? uniform(&seed, 0.0, 64.0)
                              : n % 8 == 1 ? uniform(&seed, 7.99, 8.01)
                                           : uniform(&seed, 0.4, 0.8);
        const iqfoc_ab_t v = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
        iqfoc_overmodulation_t state = {n % 5 == 0 ? 0 : random_iq24(&seed, 0.5, n % 3 == 0 ? 8.0 : 0.7)};
        const iq24_t limit = bits_random(&seed, IQFOC_OVERMODULATION_CIRCLE, IQFOC_OVERMODULATION_MOST);
        const int64_t square = (int64_t)v.alpha * v.alpha + (int64_t)v.beta * v.beta;
        const iqfoc_duties_t got = iqfoc_overmodulate_beyond(&state, v, square, limit);
        bits_add(&digest, &got, sizeof got);
        digest_add(&digest, state.length);
    }
    bits_golden(UINT64_C(0xf27da8253d03cd23), digest);
}

static void test_overmodulations_limit(void)
{
    uint64_t seed = 6;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_rotor_t rotor =
            iqfoc_rotor_from_speed(bits_random(&seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
        digest_add(&digest, iqfoc_overmodulation_limit(&rotor));
    }
    bits_golden(UINT64_C(0x1749211f9ed7e88e), digest);
}

/* (span_max - 1)/span by long division: never too large. */
static void test_modulations_scale(void)
{
    uint64_t seed = 7;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t span_max = bits_random(&seed, 1, n % 2 == 0 ? IQ24_ONE : 1000);
        const iq24_t span = bits_random(&seed, span_max, n % 3 == 0 ? 111 * IQ24_ONE : 2 * IQ24_ONE);
        const iq24_t got = iqfoc_modulation_scale(span, span_max);
        TEST_ASSERT_TRUE((int64_t)got * span <= (int64_t)(span_max - 1) * IQ24_ONE);
        digest_add(&digest, got);
    }
    bits_golden(UINT64_C(0x3ace6f762702978b), digest);
}

/* A cycle's voltage of its duties. */
static void test_voltage_of_duties(void)
{
    uint64_t seed = 8;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_abc_t d;
        d.a = bits_random(&seed, 0, IQ24_ONE);
        d.b = bits_random(&seed, 0, IQ24_ONE);
        d.c = bits_random(&seed, 0, IQ24_ONE);
        const iqfoc_ab_t u = iqfoc_modulated_voltage(d, bits_random(&seed, 0, 2 * IQ24_ONE));
        bits_add(&digest, &u, sizeof u);
        const iq24_t inverse = bits_random(&seed, 1, 2 * IQ24_ONE);
        const double reach = n % 2 == 0 ? 1.0 : 22.0;
        iqfoc_ab_t asked;
        asked.alpha = any(&seed, reach);
        asked.beta = any(&seed, reach);
        const iqfoc_duties_t got = iqfoc_modulate_nearest(asked, inverse);
        bits_add(&digest, &got, sizeof got);
    }
    bits_golden(UINT64_C(0x96f1e91f1aef0165), digest);
}

/* ---- Resolver ---- */

static void test_resolver(void)
{
    uint64_t seed = 9;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const double low = uniform(&seed, 0.1, 1.0);
        iqfoc_resolver_t r;
        r.offset_sin = any(&seed, 1.0);
        r.offset_cos = any(&seed, 1.0);
        r.gain_sin = random_iq24(&seed, 0.0625, n % 3 == 0 ? 16.0 : 2.0);
        r.gain_cos = random_iq24(&seed, 0.0625, 2.0);
        r.amplitude_min = to_iq24(low);
        r.amplitude_max = to_iq24(uniform(&seed, low + 0.001, 2.0));
        r.ratio = bits_random(&seed, 1, 64);
        r.theta_0 = any(&seed, 1.0);
        const iq24_t sin = any(&seed, n % 7 == 0 ? 127.0 : 1.5);
        const iq24_t cos = any(&seed, 1.5);
        const iqfoc_resolver_angle_t got = iqfoc_resolver_read(&r, sin, cos);
        digest_add(&digest, got.theta);
        digest_add(&digest, got.valid);
    }
    bits_golden(UINT64_C(0x08c5d405d02938e3), digest);
}

/* An amplitude just at its limits is good. */
static void test_resolvers_limits(void)
{
    const iqfoc_resolver_t r = {0, 0, IQ24_ONE, IQ24_ONE, IQ24(0.8), IQ24(1.2), 1, 0};
    TEST_ASSERT_TRUE(iqfoc_resolver_read(&r, 0, r.amplitude_min).valid);
    TEST_ASSERT_TRUE(iqfoc_resolver_read(&r, -r.amplitude_max, 0).valid);
    TEST_ASSERT_FALSE(iqfoc_resolver_read(&r, 0, r.amplitude_min - 1).valid);
    TEST_ASSERT_FALSE(iqfoc_resolver_read(&r, r.amplitude_max + 1, 0).valid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_reference);
    RUN_TEST(test_reference_by_the_link);
    RUN_TEST(test_weakening_ends_at_nothing);
    RUN_TEST(test_overmodulation);
    RUN_TEST(test_overmodulations_limit);
    RUN_TEST(test_modulations_scale);
    RUN_TEST(test_voltage_of_duties);
    RUN_TEST(test_resolver);
    RUN_TEST(test_resolvers_limits);
    return UNITY_END();
}
