/*
 * The tuned controller and deadbeat control to the last bit: one hash for each over all results. test_tuned_control.c
 * and test_deadbeat.c check them in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/tuned_control.h"

#define DRAWS 20000

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

static iqfoc_dq_t any_dq(uint64_t *seed, double reach)
{
    iqfoc_dq_t v;
    v.d = any(seed, reach);
    v.q = any(seed, reach);
    return v;
}

static iqfoc_ab_t any_ab(uint64_t *seed, double reach)
{
    iqfoc_ab_t v;
    v.alpha = any(seed, reach);
    v.beta = any(seed, reach);
    return v;
}

static iqfoc_tuned_law_t any_law(uint64_t *seed, int n)
{
    const double k = exp(uniform(seed, log(1.0 / 16.0), log(n % 2 == 0 ? 16.0 : 3.0)));
    const double ratio = exp(uniform(seed, -1.0, 1.0));
    const double k_q = fmin(fmax(k / ratio, 1.0 / 16.0), 16.0);
    iqfoc_tuned_law_t law;
    law.machine.rho_d_q30 = bits_random(seed, 0, 1 << 29);
    law.machine.rho_q_q30 = bits_random(seed, 0, 1 << 29);
    law.machine.k_d_q26 = (int32_t)lround(ldexp(k, 26)) - 1;
    law.machine.k_q_q26 = (int32_t)lround(ldexp(k_q, 26)) - 1;
    law.machine.k_psi_d_q27 = bits_random(seed, 0, 1 << 29);
    law.machine.k_psi_q_q27 = bits_random(seed, 0, 1 << 29);
    law.machine.q_to_d_q27 = (int32_t)lround(ldexp(ratio, 27));
    law.machine.d_to_q_q27 = (int32_t)lround(ldexp(1.0 / ratio, 27));
    law.keep = random_iq24(seed, 0.0, 1.0);
    law.follow = random_iq24(seed, 0.0, 1.0);
    law.learn = random_iq24(seed, 0.0, 1.0);
    law.learn_offset = n % 3 == 0 ? 0 : random_iq24(seed, 0.0, 1.0);
    return law;
}

static void the_law_at_a_speed(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_tuned_law_t law = any_law(&seed, n);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, any(&seed, n % 9 == 0 ? 1.0 : 1.0 / 3.0));
        bits_add(&digest, &t, sizeof t);
    }
    bits_golden(UINT64_C(0x9a274eb4b9ac43e3), digest);
}

static void add_state(uint64_t *digest, const iqfoc_tuned_state_t *s)
{
    bits_add(digest, &s->drift, sizeof s->drift);
    bits_add(digest, &s->offset, sizeof s->offset);
    bits_add(digest, &s->aim, sizeof s->aim);
    bits_add(digest, &s->i, sizeof s->i);
    bits_add(digest, &s->i_next, sizeof s->i_next);
    bits_add(digest, &s->error, sizeof s->error);
}

static void the_tuned_step(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS / 4; n++) {
        const iqfoc_tuned_law_t law = any_law(&seed, n);
        const iqfoc_tuned_t t = iqfoc_tuned_at_speed(&law, any(&seed, 1.0 / 3.0));
        iqfoc_tuned_state_t state = {.predicted = false};
        iqfoc_ab_t u = {0, 0};
        for (int k = 0; k < 5; k++) {
            const iqfoc_ab_t i = any_ab(&seed, n % 4 == 0 ? 12.0 : 1.0);
            const iqfoc_dq_t i_ref = any_dq(&seed, n % 4 == 1 ? 8.0 : 1.0);
            const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
            if (k % 3 != 0) {
                iqfoc_tuned_peak(&state, any_ab(&seed, n % 4 == 0 ? 12.0 : 1.0), theta);
            }
            u = iqfoc_tuned_step(&state, &t, i, u, i_ref, theta);
            bits_add(&digest, &u, sizeof u);
            add_state(&digest, &state);
            TEST_ASSERT_TRUE(state.predicted);
            TEST_ASSERT_FALSE(state.has_mid);
            u = any_ab(&seed, 1.0);
        }
    }
    bits_golden(UINT64_C(0x5125bf9cd2aa51b9), digest);
}

static iqfoc_deadbeat_t any_deadbeat(uint64_t *seed, iq24_t speed)
{
    iqfoc_exact_winding_t winding;
    winding.rho_q30 = bits_random(seed, 0, 1 << 28);
    winding.k_u_q26 = bits_random(seed, 1 << 22, 1 << 29);
    winding.k_psi_q27 = bits_random(seed, 0, 1 << 29);
    const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(speed);
    const iqfoc_exact_law_t law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    const iqfoc_deadbeat_t d = {iqfoc_exact_at_speed(&law, speed), iqfoc_deadbeat_inverse(law.k_u_q26),
                                iqfoc_valley_reference_at(&rotor, random_iq24(seed, 0.0, 4.0))};
    return d;
}

static void deadbeat_with_and_without_a_drift(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t speed = any(&seed, 1.0 / 3.0);
        const iqfoc_deadbeat_t d = any_deadbeat(&seed, speed);
        const iq24_t gain = random_iq24(&seed, 0.0, 1.0);
        iqfoc_deadbeat_drift_t drift = {.predicted = false};
        for (int k = 0; k < 3; k++) {
            const iqfoc_ab_t i = any_ab(&seed, 3.0);
            const iqfoc_ab_t u_now = any_ab(&seed, 1.0);
            const iqfoc_dq_t i_ref = any_dq(&seed, 3.0);
            const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
            const iqfoc_ab_t plain = iqfoc_deadbeat_step(&d, i, u_now, i_ref, theta, speed);
            const iqfoc_ab_t u = iqfoc_deadbeat_drift_step(&drift, &d, gain, i, u_now, i_ref, theta, speed);
            bits_add(&digest, &plain, sizeof plain);
            bits_add(&digest, &u, sizeof u);
            bits_add(&digest, &drift.drift, sizeof drift.drift);
            bits_add(&digest, &drift.i_next, sizeof drift.i_next);
            TEST_ASSERT_TRUE(drift.predicted);
        }
    }
    bits_golden(UINT64_C(0x2662dec2a99e6d27), digest);
}

/* A miss of more than 32 counts as 32; the drift is held to 4. */
static void what_is_learnt_is_held(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 4 * DRAWS; n++) {
        const iq24_t gain = random_iq24(&seed, 0.0, n % 4 == 0 ? 1.0 : 0.06);
        const iqfoc_ab_t miss = any_ab(&seed, n % 2 == 0 ? 100.0 : 34.0);
        const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        iqfoc_dq_t drift = any_dq(&seed, 1.0);
        const iqfoc_ab_t within = {iq24_clamp(miss.alpha, IQ24(-32.0), IQ24(32.0)),
                                   iq24_clamp(miss.beta, IQ24(-32.0), IQ24(32.0))};
        iqfoc_dq_t same = drift;
        iqfoc_deadbeat_learn(&drift, gain, miss, theta);
        iqfoc_deadbeat_learn(&same, gain, within, theta);
        TEST_ASSERT_EQUAL_MEMORY(&same, &drift, sizeof drift);
        TEST_ASSERT_INT32_WITHIN(IQFOC_DEADBEAT_DRIFT_LIMIT, 0, drift.d);
        TEST_ASSERT_INT32_WITHIN(IQFOC_DEADBEAT_DRIFT_LIMIT, 0, drift.q);
        bits_add(&digest, &drift, sizeof drift);
    }
    bits_golden(UINT64_C(0xa597108d28347579), digest);
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
