/*
 * The tuned controller and deadbeat control to the last bit: their headers' lines in integers, each product rounded
 * as in the library. test_tuned_control.c and test_deadbeat.c check their behaviour.
 */
#include "bits.h"

#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/transform.h"
#include "iqfoc/tuned_control.h"

#include <stdbool.h>

#define DRAWS (20000 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static int64_t saturated(int64_t x)
{
    return bits_held(x, INT32_MIN, INT32_MAX);
}

static iq24_t any(uint64_t *seed, double reach)
{
    return random_iq24(seed, -reach, reach);
}

static iqfoc_dq_t any_dq(uint64_t *seed, double reach)
{
    const iqfoc_dq_t v = {any(seed, reach), any(seed, reach)};
    return v;
}

static iqfoc_ab_t any_ab(uint64_t *seed, double reach)
{
    const iqfoc_ab_t v = {any(seed, reach), any(seed, reach)};
    return v;
}

/* ---- The tuned law at a speed ---- */

static iqfoc_tuned_law_t any_law(uint64_t *seed, int n)
{
    const double k = exp(uniform(seed, log(1.0 / 16.0), log(n % 2 == 0 ? 16.0 : 3.0)));
    const double ratio = exp(uniform(seed, -1.0, 1.0));
    const double k_q = fmin(fmax(k / ratio, 1.0 / 16.0), 16.0);
    const iqfoc_tuned_law_t law = {
        .machine = {bits_random(seed, 0, 1 << 29), bits_random(seed, 0, 1 << 29),
                    (int32_t)lround(ldexp(k, 26)) - 1, (int32_t)lround(ldexp(k_q, 26)) - 1,
                    bits_random(seed, 0, 1 << 29), bits_random(seed, 0, 1 << 29),
                    (int32_t)lround(ldexp(ratio, 27)), (int32_t)lround(ldexp(1.0 / ratio, 27))},
        .keep = random_iq24(seed, 0.0, 1.0),
        .follow = random_iq24(seed, 0.0, 1.0),
        .learn = random_iq24(seed, 0.0, 1.0),
        .learn_offset = n % 3 == 0 ? 0 : random_iq24(seed, 0.0, 1.0)};
    return law;
}

/* entry/det: both first moved up to 30 bits, the quotient moved back, up saturating and down rounded down. */
static int64_t over_det(int64_t entry, int up, int64_t det, int down)
{
    const int64_t ratio =
        iq24_div((iq24_t)(entry * (INT64_C(1) << up)), (iq24_t)bits_floor(det, INT64_C(1) << down));
    const int move = 26 - down - up;
    return saturated(move >= 0 ? ratio * (INT64_C(1) << move) : bits_floor(ratio, INT64_C(1) << -move));
}

static void expect_inverse(const iqfoc_tuned_t *t)
{
    const int64_t dd = t->end.d.u_d_q26;
    const int64_t dq = t->end.d.u_q_q26;
    const int64_t qd = t->end.q.u_d_q26;
    const int64_t qq = t->end.q.u_q_q26;
    const int64_t entry[4] = {qq, -dq, -qd, dd};
    const int64_t det = dd * qq - dq * qd;
    int64_t largest = 0;
    int down = 0;
    int up = 0;
    for (int k = 0; k < 4; k++) {
        const int64_t size = entry[k] < 0 ? -entry[k] : entry[k];
        largest = size > largest ? size : largest;
    }
    while (bits_floor(det, INT64_C(1) << down) >= INT64_C(1) << 30) {
        down++;
    }
    while (up < 12 && largest * (INT64_C(1) << up) < INT64_C(1) << 29) {
        up++;
    }
    TEST_ASSERT_EQUAL_INT64(over_det(entry[0], up, det, down), t->voltage_dd);
    TEST_ASSERT_EQUAL_INT64(over_det(entry[1], up, det, down), t->voltage_dq);
    TEST_ASSERT_EQUAL_INT64(over_det(entry[2], up, det, down), t->voltage_qd);
    TEST_ASSERT_EQUAL_INT64(over_det(entry[3], up, det, down), t->voltage_qq);
}

static void the_law_at_a_speed(void)
{
    uint64_t seed = 1;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_tuned_law_t law = any_law(&seed, n);
        const iq24_t turns = any(&seed, n % 9 == 0 ? 1.0 : 1.0 / 3.0);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(turns);
        const iq24_sincos_t sc = iq24_sincos(rotor.turns);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, turns);
        const int64_t h = bits_floor(rotor.phi, 2);
        const int64_t x = bits_product(h, h);
        int64_t bow = to_iq24(0.00171958) + bits_product(x, to_iq24(-0.0000132));
        bow = to_iq24(-1.0 / 30.0) + bits_product(x, bow);
        bow = to_iq24(2.0 / 3.0) + bits_product(x, bow);
        const iqfoc_valley_reference_t reference =
            iqfoc_valley_reference_at(&rotor, (iq24_t)bits_nearest(law.machine.k_psi_d_q27, 3));
        iqfoc_salient_t end;
        iqfoc_salient_at_speed(&law.machine, rotor.turns, IQ24_ONE, &end, NULL);
        TEST_ASSERT_EQUAL_MEMORY(&end, &t.end, sizeof end);
        expect_inverse(&t);
        TEST_ASSERT_EQUAL_INT64(bits_product(law.keep, sc.cos), t.keep_cos);
        TEST_ASSERT_EQUAL_INT64(bits_product(law.keep, sc.sin), t.keep_sin);
        TEST_ASSERT_EQUAL_MEMORY(&reference, &t.reference, sizeof reference);
        TEST_ASSERT_EQUAL_INT64(bow, t.bow);
        TEST_ASSERT_EQUAL_INT32(rotor.turns, t.turns);
        TEST_ASSERT_EQUAL_INT32(law.follow, t.follow);
        TEST_ASSERT_EQUAL_INT32(law.learn, t.learn);
        TEST_ASSERT_EQUAL_INT32(law.learn_offset, t.learn_offset);
    }
}

/* ---- The tuned step ---- */

static iqfoc_dq_t plus(iqfoc_dq_t a, iqfoc_dq_t b, int64_t sign)
{
    const iqfoc_dq_t sum = {iq24_wrap(a.d + sign * b.d), iq24_wrap(a.q + sign * b.q)};
    return sum;
}

static iqfoc_dq_t held(iqfoc_dq_t x, int64_t limit)
{
    const iqfoc_dq_t y = {(iq24_t)bits_held(x.d, -limit, limit), (iq24_t)bits_held(x.q, -limit, limit)};
    return y;
}

static iqfoc_dq_t times(int64_t gain, iqfoc_dq_t x)
{
    const iqfoc_dq_t y = {(iq24_t)bits_product(gain, x.d), (iq24_t)bits_product(gain, x.q)};
    return y;
}

static iqfoc_ab_t tuned_step(iqfoc_tuned_state_t *s, const iqfoc_tuned_t *t, iqfoc_ab_t i_ab,
                             iqfoc_ab_t u_now, iqfoc_dq_t i_ref, iq24_t theta)
{
    const int64_t eight = 8 * (int64_t)IQ24_ONE;
    const iq24_sincos_t sc = iq24_sincos(theta);
    const iqfoc_dq_t none = {0, 0};
    const iqfoc_dq_t i = held(iqfoc_park(i_ab, sc), eight);
    s->error = none;
    if (s->predicted) {
        const iqfoc_dq_t missed = plus(i, s->i_next, -1);
        s->error = plus(missed, s->drift, 1);
        s->drift = held(plus(s->drift, times(t->learn, missed), 1), eight / 2);
        if (s->has_mid) {
            const iqfoc_dq_t ends = {(iq24_t)bits_floor((int64_t)s->i.d + i.d, 2),
                                     (iq24_t)bits_floor((int64_t)s->i.q + i.q, 2)};
            const iqfoc_dq_t mean = plus(ends, times(t->bow, plus(held(s->i_mid, eight), ends, -1)), 1);
            const iqfoc_dq_t seen = plus(ends, iqfoc_valley_reference(&t->reference, mean), -1);
            s->offset = held(plus(s->offset, times(t->learn_offset, plus(seen, s->offset, -1)), 1), IQ24_ONE);
        }
    }
    s->i_next = held(plus(iqfoc_salient_step(&t->end, i, iqfoc_park(u_now, sc)), s->drift, 1), eight);
    const iqfoc_dq_t alone = plus(iqfoc_salient_step(&t->end, s->i_next, none), s->drift, 1);
    s->aim = s->predicted ? s->aim : i_ref;
    const iqfoc_dq_t expected = plus(iqfoc_valley_reference(&t->reference, s->aim), s->offset, 1);
    const iqfoc_dq_t off = s->predicted ? plus(s->i_next, expected, -1) : none;
    s->aim = plus(i_ref, times(t->follow, plus(i_ref, s->aim, -1)), -1);
    const iqfoc_dq_t wanted = plus(iqfoc_valley_reference(&t->reference, s->aim), s->offset, 1);
    const int64_t keep_d = bits_nearest((int64_t)off.d * t->keep_cos + (int64_t)off.q * t->keep_sin, 24);
    const int64_t keep_q = bits_nearest((int64_t)off.q * t->keep_cos - (int64_t)off.d * t->keep_sin, 24);
    const int64_t need_d = saturated(wanted.d + keep_d - alone.d);
    const int64_t need_q = saturated(wanted.q + keep_q - alone.q);
    const iqfoc_dq_t u = {
        (iq24_t)saturated(bits_nearest(t->voltage_dd * need_d + t->voltage_dq * need_q, 24)),
        (iq24_t)saturated(bits_nearest(t->voltage_qd * need_d + t->voltage_qq * need_q, 24))};
    s->i = i;
    s->has_mid = false;
    s->predicted = true;
    return iqfoc_park_inverse(held(u, 2 * eight), iq24_sincos(iq24_wrap((int64_t)theta + t->turns)));
}

static void expect_state(const iqfoc_tuned_state_t *want, const iqfoc_tuned_state_t *got)
{
    TEST_ASSERT_EQUAL_MEMORY(&want->drift, &got->drift, sizeof want->drift);
    TEST_ASSERT_EQUAL_MEMORY(&want->offset, &got->offset, sizeof want->offset);
    TEST_ASSERT_EQUAL_MEMORY(&want->aim, &got->aim, sizeof want->aim);
    TEST_ASSERT_EQUAL_MEMORY(&want->i, &got->i, sizeof want->i);
    TEST_ASSERT_EQUAL_MEMORY(&want->i_next, &got->i_next, sizeof want->i_next);
    TEST_ASSERT_EQUAL_MEMORY(&want->error, &got->error, sizeof want->error);
    TEST_ASSERT_EQUAL(want->predicted, got->predicted);
    TEST_ASSERT_EQUAL(want->has_mid, got->has_mid);
}

static void the_tuned_step(void)
{
    uint64_t seed = 2;
    for (int n = 0; n < DRAWS / 4; n++) {
        const iqfoc_tuned_law_t law = any_law(&seed, n);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, any(&seed, 1.0 / 3.0));
        iqfoc_tuned_state_t want = {.predicted = false};
        iqfoc_tuned_state_t got = {.predicted = false};
        iqfoc_ab_t u = {0, 0};
        for (int k = 0; k < 5; k++) {
            const iqfoc_ab_t i = any_ab(&seed, n % 4 == 0 ? 12.0 : 1.0);
            const iqfoc_dq_t i_ref = any_dq(&seed, n % 4 == 1 ? 8.0 : 1.0);
            const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
            if (k % 3 != 0) {
                iqfoc_tuned_peak(&got, any_ab(&seed, n % 4 == 0 ? 12.0 : 1.0), theta);
                want.i_mid = got.i_mid;
                want.has_mid = true;
            }
            const iqfoc_ab_t expected = tuned_step(&want, &t, i, u, i_ref, theta);
            u = iqfoc_tuned_step(&got, &t, i, u, i_ref, theta);
            TEST_ASSERT_EQUAL_INT32(expected.alpha, u.alpha);
            TEST_ASSERT_EQUAL_INT32(expected.beta, u.beta);
            expect_state(&want, &got);
            u.alpha = any(&seed, 1.0);
            u.beta = any(&seed, 1.0);
        }
    }
}

/* ---- Deadbeat ---- */

static iqfoc_deadbeat_t any_deadbeat(uint64_t *seed, iq24_t turns)
{
    const iqfoc_exact_winding_t winding = {bits_random(seed, 0, 1 << 28), bits_random(seed, 1 << 22, 1 << 29),
                                           bits_random(seed, 0, 1 << 29)};
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_turns(turns);
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    const iqfoc_deadbeat_t d = {iqfoc_exact_at_speed(&law, turns), iqfoc_deadbeat_inverse(law.k_u_q26),
                                iqfoc_valley_reference_at(&rotor, random_iq24(seed, 0.0, 4.0))};
    return d;
}

/* Predicted with the middle of this cycle, aimed at the end of the next, driven by the middle of the next. */
static void deadbeat_with_and_without_a_drift(void)
{
    uint64_t seed = 3;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t turns = any(&seed, 1.0 / 3.0);
        const iqfoc_deadbeat_t d = any_deadbeat(&seed, turns);
        const iq24_t gain = random_iq24(&seed, 0.0, 1.0);
        iqfoc_deadbeat_drift_t drift = {.predicted = false};
        iqfoc_dq_t learnt = {0, 0};
        iqfoc_ab_t next = {0, 0};
        for (int k = 0; k < 3; k++) {
            const iqfoc_ab_t i = any_ab(&seed, 3.0);
            const iqfoc_ab_t u_now = any_ab(&seed, 1.0);
            const iqfoc_dq_t i_ref = any_dq(&seed, 3.0);
            const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
            const int64_t middle = theta + bits_floor(turns, 2);
            const iq24_sincos_t mid = iq24_sincos(iq24_wrap(middle));
            const iq24_sincos_t mid_next = iq24_sincos(iq24_wrap(middle + turns));
            const iq24_sincos_t end = iq24_sincos(iq24_wrap((int64_t)theta + 2 * (int64_t)turns));
            const iqfoc_dq_t valley = iqfoc_valley_reference(&d.reference, i_ref);
            const iqfoc_ab_t predicted = iqfoc_exact_step(&d.model, i, u_now, mid);
            const iqfoc_ab_t plain =
                iqfoc_deadbeat_voltage(&d, predicted, iqfoc_park_inverse(valley, end), mid_next);
            const iqfoc_ab_t u = iqfoc_deadbeat_step(&d, i, u_now, i_ref, theta, turns);
            TEST_ASSERT_EQUAL_MEMORY(&plain, &u, sizeof u);
            if (k > 0) {
                const iqfoc_ab_t error = {iq24_wrap((int64_t)i.alpha - next.alpha),
                                          iq24_wrap((int64_t)i.beta - next.beta)};
                iqfoc_deadbeat_learn(&learnt, gain, error, theta);
            }
            const iqfoc_ab_t more =
                iqfoc_park_inverse(learnt, iq24_sincos(iq24_wrap((int64_t)theta + turns)));
            next.alpha = iq24_wrap((int64_t)predicted.alpha + more.alpha);
            next.beta = iq24_wrap((int64_t)predicted.beta + more.beta);
            const iqfoc_dq_t aim = {valley.d - learnt.d, valley.q - learnt.q};
            const iqfoc_ab_t want = iqfoc_deadbeat_voltage(&d, next, iqfoc_park_inverse(aim, end), mid_next);
            const iqfoc_ab_t got = iqfoc_deadbeat_drift_step(&drift, &d, gain, i, u_now, i_ref, theta, turns);
            TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
            TEST_ASSERT_EQUAL_MEMORY(&learnt, &drift.drift, sizeof learnt);
            TEST_ASSERT_EQUAL_MEMORY(&next, &drift.i_next, sizeof next);
            TEST_ASSERT_TRUE(drift.predicted);
        }
    }
}

/* A miss of more than 32 counts as 32; the drift is held to 4. */
static void what_is_learnt_is_held(void)
{
    uint64_t seed = 4;
    for (int n = 0; n < 4 * DRAWS; n++) {
        const iq24_t gain = random_iq24(&seed, 0.0, n % 4 == 0 ? 1.0 : 0.06);
        const iqfoc_ab_t miss = any_ab(&seed, n % 2 == 0 ? 100.0 : 34.0);
        const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        const iqfoc_ab_t within = {
            (iq24_t)bits_held(miss.alpha, -32 * (int64_t)IQ24_ONE, 32 * (int64_t)IQ24_ONE),
            (iq24_t)bits_held(miss.beta, -32 * (int64_t)IQ24_ONE, 32 * (int64_t)IQ24_ONE)};
        const iqfoc_dq_t before = any_dq(&seed, 1.0);
        const iqfoc_dq_t want =
            held(plus(before, times(gain, iqfoc_park(within, iq24_sincos(theta))), 1), 4 * (int64_t)IQ24_ONE);
        iqfoc_dq_t got = before;
        iqfoc_deadbeat_learn(&got, gain, miss, theta);
        TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_law_at_a_speed);
    RUN_TEST(the_tuned_step);
    RUN_TEST(what_is_learnt_is_held);
    RUN_TEST(deadbeat_with_and_without_a_drift);
    return UNITY_END();
}
