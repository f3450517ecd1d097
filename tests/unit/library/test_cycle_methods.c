/*
 * The cycle with the methods beyond the papers' equals the algorithms called one by one: prediction, feedback and,
 * with deadbeat control, voltage of each valley, to the last bit.
 */
/* Ahead of the fixture, whose names theirs would hide. */
#include "iqfoc/cycle_steps.h"
#include "iqfoc/deadbeat_drift.h"
#include "iqfoc/mean_modulated.h"

#include "bits.h"
#include "cycle_fixture.h"

#include <stdbool.h>

#define DRAWS (20000 / IQFOC_TEST_STRIDE)

static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V);

static uint64_t seed;
static iqfoc_exact_law_t law;
static iqfoc_exact_law_t mean_law;
static iqfoc_salient_t salient_end;
static iqfoc_salient_t salient_mean;

static iqfoc_sample_t any_sample(void)
{
    const iqfoc_ab_t i = {random_iq24(&seed, -1.5, 1.5), random_iq24(&seed, -1.5, 1.5)};
    iqfoc_sample_t s = sample_at(0);
    s.i = iqfoc_clarke_inverse(i);
    s.theta = bits_random(&seed, INT32_MIN, INT32_MAX);
    s.speed = random_iq24(&seed, -1.0 / 3.0, 1.0 / 3.0);
    s.u_dc = random_iq24(&seed, 0.6, 1.4);
    return s;
}

static void start(iqfoc_methods_t m)
{
    setUp();
    law = iqfoc_exact_prediction(&winding, IQ24_ONE);
    mean_law = iqfoc_exact_mean(&winding, IQ24_ONE);
    config.current_limit = IQ24(8.0);
    config.data.exact = &law;
    config.data.exact_mean = &mean_law;
    config.data.salient = &salient_end;
    config.data.salient_mean = &salient_mean;
    config.data.k_u_inverse = iqfoc_deadbeat_inverse(law.k_u_q26);
    config.data.k_psi = config.predictor.k_psi;
    config.data.learning = IQ24(0.2);
    TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init_by(m, &cycle, &config));
    cycle.enabled = true;
}

static void next_valley(iqfoc_methods_t m, iqfoc_sample_t *s)
{
    *s = any_sample();
    s->time = ticks;
    cycle.u_ab.alpha = random_iq24(&seed, -0.6, 0.6);
    cycle.u_ab.beta = random_iq24(&seed, -0.6, 0.6);
    cycle.i_ref.d = random_iq24(&seed, -1.0, 1.0);
    cycle.i_ref.q = random_iq24(&seed, -1.0, 1.0);
    cycle.phase = IQFOC_CYCLE_DUE_VALLEY;
    cycle.valley_time = ticks - PERIOD;
    iqfoc_cycle_valley_by(m, &cycle, s, ticks);
    TEST_ASSERT_EQUAL_UINT32(0, cycle.status);
    ticks += PERIOD;
}

static void test_deadbeat(void)
{
    const iqfoc_methods_t m = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_DEADBEAT,
                               IQFOC_MODULATION_PWM, false};
    seed = 1;
    start(m);
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_sample_t s;
        next_valley(m, &s);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(s.speed);
        const iqfoc_deadbeat_t deadbeat = {iqfoc_exact_at_speed(&law, s.speed), config.data.k_u_inverse,
                                           iqfoc_valley_reference_at(&rotor, config.data.k_psi)};
        const iqfoc_ab_t u =
            iqfoc_deadbeat_step(&deadbeat, iqfoc_clarke3(s.i), cycle.u_now, cycle.i_ref, s.theta, s.speed);
        TEST_ASSERT_EQUAL_MEMORY(&u, &cycle.u_ab, sizeof u);
    }
}

static void test_deadbeat_that_learns(void)
{
    const iqfoc_methods_t m = {IQFOC_MODEL_EXACT, IQFOC_FEEDBACK_MIDPOINT, IQFOC_CONTROL_DEADBEAT_LEARNING,
                               IQFOC_MODULATION_PWM, false};
    seed = 2;
    start(m);
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_sample_t s;
        iqfoc_deadbeat_drift_t drift = {.drift = cycle.drift, .i_next = cycle.i_next, .predicted = n > 0};
        next_valley(m, &s);
        const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(s.speed);
        const iqfoc_deadbeat_t deadbeat = {iqfoc_exact_at_speed(&law, s.speed), config.data.k_u_inverse,
                                           iqfoc_valley_reference_at(&rotor, config.data.k_psi)};
        const iqfoc_ab_t u =
            iqfoc_deadbeat_drift_step(&drift, &deadbeat, config.data.learning, iqfoc_clarke3(s.i),
                                      cycle.u_now, cycle.i_ref, s.theta, s.speed);
        if (n > 0) {
            TEST_ASSERT_EQUAL_MEMORY(&drift.drift, &cycle.drift, sizeof cycle.drift);
            TEST_ASSERT_EQUAL_MEMORY(&drift.i_next, &cycle.i_next, sizeof cycle.i_next);
            TEST_ASSERT_EQUAL_MEMORY(&u, &cycle.u_ab, sizeof u);
        }
    }
}

static void test_means_of_the_models(void)
{
    for (int modulated = 0; modulated < 2; modulated++) {
        const iqfoc_methods_t m = {IQFOC_MODEL_EXACT,
                                   modulated == 1 ? IQFOC_FEEDBACK_MODULATED_MEAN : IQFOC_FEEDBACK_EXACT_MEAN,
                                   IQFOC_CONTROL_PI, IQFOC_MODULATION_PWM, false};
        seed = 3;
        start(m);
        for (int n = 0; n < DRAWS; n++) {
            iqfoc_sample_t s;
            cycle.duties_next.a = random_iq24(&seed, 0.0, 1.0);
            cycle.duties_next.b = random_iq24(&seed, 0.0, 1.0);
            cycle.duties_next.c = random_iq24(&seed, 0.0, 1.0);
            const iqfoc_abc_t duties = cycle.duties_next;
            next_valley(m, &s);
            const iqfoc_ab_t i = iqfoc_clarke3(s.i);
            const iqfoc_rotor_t rotor = iqfoc_rotor_from_speed(s.speed);
            const iq24_sincos_t mid = iq24_sincos(iq24_wrap(s.theta + bits_floor(s.speed, 2)));
            const iqfoc_exact_t end = iqfoc_exact_at_speed(&law, s.speed);
            const iqfoc_ab_t i_next = iqfoc_exact_step(&end, i, cycle.u_now, mid);
            TEST_ASSERT_EQUAL_MEMORY(&i_next, &cycle.i_next, sizeof i_next);
            iqfoc_dq_t want;
            if (modulated == 1) {
                const iqfoc_mean_modulated_t c = iqfoc_mean_modulated_at_speed(&config.predictor, &rotor);
                want = iqfoc_mean_modulated(&c, i, i_next, duties, s.u_dc, mid);
            } else {
                const iqfoc_exact_t mean = iqfoc_exact_at_speed(&mean_law, s.speed);
                const iqfoc_ab_t delta = {i_next.alpha - i.alpha, i_next.beta - i.beta};
                want = iqfoc_mean_current_correct(iqfoc_exact_step(&mean, i, cycle.u_now, mid), delta, &rotor,
                                                  mid);
            }
            TEST_ASSERT_INT32_WITHIN(1, want.d, cycle.i_dq.d);
            TEST_ASSERT_INT32_WITHIN(1, want.q, cycle.i_dq.q);
        }
    }
}

/* A row of ten coefficients in double: each input by its own factor. */
static double salient_row(const iqfoc_salient_row_t *row, iqfoc_dq_t i, iqfoc_dq_t u)
{
    return (ldexp(row->i_d_q26, -26) * i.d + ldexp(row->i_q_q26, -26) * i.q + ldexp(row->u_d_q26, -26) * u.d +
            ldexp(row->u_q_q26, -26) * u.q) +
           ldexp(row->constant_q26, -2);
}

/* End and mean of a salient machine, each from the coefficients that the set names, of this current and voltage. */
static void test_salient(void)
{
    const iqfoc_methods_t m = {IQFOC_MODEL_SALIENT, IQFOC_FEEDBACK_EXACT_MEAN, IQFOC_CONTROL_PI,
                               IQFOC_MODULATION_PWM, false};
    seed = 4;
    start(m);
    for (int n = 0; n < DRAWS; n++) {
        int32_t *const ends = &salient_end.d.i_d_q26;
        int32_t *const means = &salient_mean.d.i_d_q26;
        for (int k = 0; k < 10; k++) {
            ends[k] = bits_random(&seed, -(1 << 26), 1 << 26);
            means[k] = bits_random(&seed, -(1 << 26), 1 << 26);
        }
        iqfoc_sample_t s;
        next_valley(m, &s);
        const iq24_sincos_t at = iq24_sincos(s.theta);
        const iqfoc_dq_t i = iqfoc_park(iqfoc_clarke3(s.i), at);
        const iqfoc_dq_t u = iqfoc_park(cycle.u_now, at);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, salient_row(&salient_mean.d, i, u), cycle.i_dq.d);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, salient_row(&salient_mean.q, i, u), cycle.i_dq.q);
        const iqfoc_dq_t next = iqfoc_park(cycle.i_next, iq24_sincos(iq24_add_wrap(s.theta, s.speed)));
        TEST_ASSERT_DOUBLE_WITHIN(8.0, salient_row(&salient_end.d, i, u), next.d);
        TEST_ASSERT_DOUBLE_WITHIN(8.0, salient_row(&salient_end.q, i, u), next.q);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_deadbeat);
    RUN_TEST(test_deadbeat_that_learns);
    RUN_TEST(test_means_of_the_models);
    RUN_TEST(test_salient);
    return UNITY_END();
}
