/*
 * Reference, overmodulation and resolver to the last bit: their headers' formulas in integers, each product rounded
 * as in the library. Other tests check the formulas themselves and the bounds in LSB.
 */
#include "bits.h"

#include "iqfoc/overmodulation.h"
#include "iqfoc/reference.h"
#include "iqfoc/resolver.h"
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

static iqfoc_ab_t any_vector(uint64_t *seed, double reach)
{
    const iqfoc_ab_t v = {any(seed, reach), any(seed, reach)};
    return v;
}

static int64_t saturated(int64_t x)
{
    return bits_held(x, INT32_MIN, INT32_MAX);
}

static int64_t larger(int64_t x, int64_t y)
{
    return x > y ? x : y;
}

static int64_t smaller(int64_t x, int64_t y)
{
    return x < y ? x : y;
}

/* Its bits are test_iq24_bits.c's. */
static int64_t root(int64_t x)
{
    return iq24_sqrt((iq24_t)x);
}

static void expect_phases(int64_t a, int64_t b, int64_t c, iqfoc_abc_t got)
{
    TEST_ASSERT_EQUAL_INT64(a, got.a);
    TEST_ASSERT_EQUAL_INT64(b, got.b);
    TEST_ASSERT_EQUAL_INT64(c, got.c);
}

/* ---- Torque to current ---- */

static void test_reference(void)
{
    uint64_t seed = 4;
    for (int n = 0; n < DRAWS; n++) {
        const double i_max = uniform(&seed, 0.1, 4.0);
        const iqfoc_reference_config_t c = {n % 4 == 0    ? 0
                                            : n % 16 == 1 ? 1
                                                          : any(&seed, 10.9 / i_max),
                                            to_iq24(i_max), random_iq24(&seed, -i_max, 0.0),
                                            random_iq24(&seed, 0.0, 8.0), random_iq24(&seed, 0.5, 1.125)};
        iqfoc_reference_t state = {bits_random(&seed, -4 * IQ24_ONE, 0) * (int64_t)IQ24_ONE,
                                   any(&seed, i_max)};
        const iqfoc_reference_t before = state;
        const iq24_t torque = any(&seed, n % 2 == 0 ? 8.0 : 0.5);
        const iqfoc_dq_t u = {any(&seed, n % 5 == 0 ? 20.0 : 1.2), any(&seed, 1.7)};
        const iq24_t u_limit = random_iq24(&seed, 0.0, 1.5);

        int64_t i_d0 = 0;
        if (c.saliency != 0) {
            const int64_t x = bits_product(c.saliency, before.i_q);
            i_d0 =
                -bits_quotient(bits_product(x, before.i_q), IQ24_ONE + root(IQ24_ONE + bits_product(x, x)));
        }
        const int64_t u_d = bits_held(u.d, -IQ24_ONE * 3 / 2, IQ24_ONE * 3 / 2);
        const int64_t u_q = bits_held(u.q, -IQ24_ONE * 3 / 2, IQ24_ONE * 3 / 2);
        const int64_t most = bits_product(c.share, u_limit);
        const int64_t left = bits_nearest(most * most - (u_d * u_d + u_q * u_q), 24);
        const int64_t room = smaller(c.i_d_min - i_d0, 0);
        const int64_t z =
            bits_held(before.weakening + c.gain * left, (room - c.i_max) * (int64_t)IQ24_ONE, 0);
        const int64_t wanted = i_d0 + bits_nearest(z, 24);
        const int64_t i_d = larger(wanted, c.i_d_min);
        int64_t i_q = torque;
        if (c.saliency != 0) {
            const int64_t k = IQ24_ONE - bits_floor(bits_product(c.saliency, i_d), 2);
            i_q = bits_quotient(torque, larger(k, IQ24_ONE / 4));
        }
        const int64_t rest = bits_nearest((int64_t)c.i_max * c.i_max - i_d * i_d, 24);
        const int64_t room_q = larger((rest > 0 ? root(rest) : 0) + wanted - i_d, 0);
        i_q = bits_held(i_q, -room_q, room_q);

        const iqfoc_dq_t got = iqfoc_reference_step(&state, &c, torque, u, u_limit);
        TEST_ASSERT_EQUAL_INT64(z, state.weakening);
        TEST_ASSERT_EQUAL_INT64(i_d, got.d);
        TEST_ASSERT_EQUAL_INT64(i_q, got.q);
        TEST_ASSERT_EQUAL_INT32(got.q, state.i_q);
    }
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

/* U/M by the polynomials of src/overmodulation.c, whose constants are a fit of the header's U(M). */
static int64_t shortness(int64_t m)
{
    const int64_t pi_q29 = llround(ldexp(TWO_PI / 2.0, 29));
    const int64_t square = 2 * (int64_t)IQ24_ONE - bits_product_of(m, pi_q29, 29);
    const int64_t y = root(square);
    if (m >= IQFOC_OVERMODULATION_SIDES) {
        const int64_t inner = to_iq24(0.16263644) + bits_product(to_iq24(-0.09006848), square);
        const int64_t outer = to_iq24(-2.39832634) + bits_product(inner, square);
        return bits_product(y, to_iq24(3.30797368) + bits_product(outer, square));
    }
    const int64_t t = bits_held(bits_product(to_iq24(0.431509717) - y, to_iq24(7.302986654)), 0, IQ24_ONE);
    int64_t bow = to_iq24(0.18461749) + bits_product(to_iq24(-0.24900165), t);
    bow = to_iq24(-0.0775615) + bits_product(bow, t);
    bow = to_iq24(-0.07625095) + bits_product(bow, t);
    bow = bits_product(bow, IQ24_ONE - t);
    return IQ24_ONE - bits_product(t, to_iq24(0.086503328) + bow);
}

static int64_t steadied(int64_t asked, int64_t slow)
{
    const int64_t circle = IQFOC_OVERMODULATION_CIRCLE;
    const int64_t beyond = 32 * smaller(slow - circle, IQ24_ONE / 32);
    const int64_t near = 8 * bits_held(asked - (circle - IQ24_ONE / 8), 0, IQ24_ONE / 8);
    const int64_t off = bits_held(slow - asked, -IQ24_ONE, IQ24_ONE);
    return asked + bits_held(bits_product(bits_product(beyond, near), off), -IQ24_ONE / 16, IQ24_ONE / 16);
}

static void test_overmodulation(void)
{
    uint64_t seed = 5;
    for (int n = 0; n < 4 * DRAWS; n++) {
        const double angle = uniform(&seed, 0.0, TWO_PI);
        const double length = n % 8 == 0   ? uniform(&seed, 0.0, 64.0)
                              : n % 8 == 1 ? uniform(&seed, 7.99, 8.01)
                                           : uniform(&seed, 0.4, 0.8);
        iqfoc_ab_t v = {to_iq24(length * cos(angle)), to_iq24(length * sin(angle))};
        iqfoc_overmodulation_t state = {n % 5 == 0 ? 0 : random_iq24(&seed, 0.5, n % 3 == 0 ? 8.0 : 0.7)};
        const iq24_t limit = bits_random(&seed, IQFOC_OVERMODULATION_CIRCLE, IQFOC_OVERMODULATION_MOST);
        int64_t square = (int64_t)v.alpha * v.alpha + (int64_t)v.beta * v.beta;
        const int64_t given = square;
        const iqfoc_ab_t asked_for = v;
        const bool far = square > INT64_C(64) * IQ24_ONE * IQ24_ONE;
        if (far) {
            v.alpha = (iq24_t)bits_floor(v.alpha, 8);
            v.beta = (iq24_t)bits_floor(v.beta, 8);
            square = (int64_t)v.alpha * v.alpha + (int64_t)v.beta * v.beta;
        }
        const int64_t size = root(bits_nearest(square, 24));
        const int64_t asked = far ? 8 * (int64_t)IQ24_ONE : size;
        const int64_t before = larger(state.length, IQFOC_OVERMODULATION_CIRCLE);
        const int64_t slow = before + bits_floor(larger(asked, IQFOC_OVERMODULATION_CIRCLE) - before, 8);
        const int64_t m = smaller(steadied(asked, slow), limit);
        if (m != size || m > IQFOC_OVERMODULATION_CIRCLE) {
            const int64_t shorter = m > IQFOC_OVERMODULATION_CIRCLE ? shortness(m) : IQ24_ONE;
            const int64_t factor = bits_quotient(m, bits_product(size, shorter));
            v.alpha = (iq24_t)bits_product(v.alpha, factor);
            v.beta = (iq24_t)bits_product(v.beta, factor);
        }
        const int64_t allowed = limit + bits_floor(limit, 32);
        const iqfoc_abc_t legs = iqfoc_overmodulation_legs(v);
        const int64_t scale =
            asked > allowed ? iqfoc_modulation_scale((iq24_t)asked, (iq24_t)allowed) : IQ24_ONE;
        const iqfoc_duties_t got = iqfoc_overmodulate_beyond(&state, asked_for, given, limit);
        TEST_ASSERT_EQUAL_INT64(slow, state.length);
        expect_phases(legs.a, legs.b, legs.c, got.high);
        TEST_ASSERT_EQUAL_INT64(scale, got.scale);
    }
}

/* (1/s1 + cos(phi/2))/pi, held. */
static void test_overmodulations_limit(void)
{
    uint64_t seed = 6;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_rotor_t rotor =
            iqfoc_rotor_from_turns(bits_random(&seed, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX));
        const int64_t sum = bits_quotient(IQ24_ONE, rotor.s1) + rotor.s1 - rotor.phi_s2;
        const int64_t want = bits_product_of(sum, llround(ldexp(2.0 / TWO_PI, 31)), 31);
        TEST_ASSERT_EQUAL_INT64(bits_held(want, IQFOC_OVERMODULATION_SIDES, IQFOC_OVERMODULATION_MOST),
                                iqfoc_overmodulation_limit(&rotor));
    }
}

/* (span_max - 1)/span by long division: never too large. */
static void test_modulations_scale(void)
{
    uint64_t seed = 7;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t span_max = bits_random(&seed, 1, n % 2 == 0 ? IQ24_ONE : 1000);
        const iq24_t span = bits_random(&seed, span_max, n % 3 == 0 ? 111 * IQ24_ONE : 2 * IQ24_ONE);
        const iq24_t got = iqfoc_modulation_scale(span, span_max);
        TEST_ASSERT_EQUAL_INT64(bits_long_division(span_max - 1, span), got);
        TEST_ASSERT_TRUE((int64_t)got * span <= (int64_t)(span_max - 1) * IQ24_ONE);
    }
}

/* A cycle's voltage of its duties. */
static void test_voltage_of_duties(void)
{
    uint64_t seed = 8;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_abc_t d = {bits_random(&seed, 0, IQ24_ONE), bits_random(&seed, 0, IQ24_ONE),
                               bits_random(&seed, 0, IQ24_ONE)};
        const iq24_t u_dc = bits_random(&seed, 0, 2 * IQ24_ONE);
        const iqfoc_ab_t v = iqfoc_clarke3(d);
        const iqfoc_ab_t u = iqfoc_modulated_voltage(d, u_dc);
        TEST_ASSERT_EQUAL_INT64(bits_product(v.alpha, u_dc), u.alpha);
        TEST_ASSERT_EQUAL_INT64(bits_product(v.beta, u_dc), u.beta);
        const iq24_t inverse = bits_random(&seed, 1, 2 * IQ24_ONE);
        const iqfoc_ab_t asked = any_vector(&seed, n % 2 == 0 ? 1.0 : 22.0);
        const iqfoc_ab_t over = {(iq24_t)bits_floor((int64_t)asked.alpha * inverse, IQ24_ONE),
                                 (iq24_t)bits_floor((int64_t)asked.beta * inverse, IQ24_ONE)};
        const iqfoc_abc_t x = iqfoc_clarke_inverse(over);
        const int64_t span = larger(larger(x.a, x.b), x.c) - smaller(smaller(x.a, x.b), x.c);
        const iqfoc_abc_t legs = iqfoc_overmodulation_legs(over);
        const iqfoc_duties_t got = iqfoc_modulate_nearest(asked, inverse);
        expect_phases(legs.a, legs.b, legs.c, got.high);
        TEST_ASSERT_EQUAL_INT64(span > IQ24_ONE ? iqfoc_modulation_scale((iq24_t)span, IQ24_ONE) : IQ24_ONE,
                                got.scale);
    }
}

/* ---- Resolver ---- */

static void test_resolver(void)
{
    uint64_t seed = 9;
    for (int n = 0; n < DRAWS; n++) {
        const double low = uniform(&seed, 0.1, 1.0);
        const iqfoc_resolver_t r = {any(&seed, 1.0),
                                    any(&seed, 1.0),
                                    random_iq24(&seed, 0.0625, n % 3 == 0 ? 16.0 : 2.0),
                                    random_iq24(&seed, 0.0625, 2.0),
                                    to_iq24(low),
                                    to_iq24(uniform(&seed, low + 0.001, 2.0)),
                                    bits_random(&seed, 1, 64),
                                    any(&seed, 1.0)};
        const iq24_t sin = any(&seed, n % 7 == 0 ? 127.0 : 1.5);
        const iq24_t cos = any(&seed, 1.5);
        const int64_t most = 4 * (int64_t)IQ24_ONE;
        const int64_t y =
            bits_held(bits_product(saturated((int64_t)sin - r.offset_sin), r.gain_sin), -most, most);
        const int64_t x =
            bits_held(bits_product(saturated((int64_t)cos - r.offset_cos), r.gain_cos), -most, most);
        const int64_t square = x * x + y * y;
        const iqfoc_resolver_angle_t got = iqfoc_resolver_read(&r, sin, cos);
        TEST_ASSERT_EQUAL_INT64((int64_t)r.ratio * iq24_atan2((iq24_t)y, (iq24_t)x) - r.theta_0, got.theta);
        TEST_ASSERT_EQUAL(square >= (int64_t)r.amplitude_min * r.amplitude_min &&
                              square <= (int64_t)r.amplitude_max * r.amplitude_max,
                          got.valid);
    }
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
    RUN_TEST(test_weakening_ends_at_nothing);
    RUN_TEST(test_overmodulation);
    RUN_TEST(test_overmodulations_limit);
    RUN_TEST(test_modulations_scale);
    RUN_TEST(test_voltage_of_duties);
    RUN_TEST(test_resolver);
    RUN_TEST(test_resolvers_limits);
    return UNITY_END();
}
