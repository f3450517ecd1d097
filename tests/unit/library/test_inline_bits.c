/*
 * The headers' inline functions and initialisers to the last bit: any allowed input, one hash for each group over all results. Other tests
 * check them against the formulas in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/adapt.h"
#include "iqfoc/iqfoc.h"
#include "iqfoc/pattern_control.h"

#include <stdbool.h>

enum { DRAWS = 20000 };

#define PI_GAINS IQFOC_GAINS(900.0, 0.9, 8e-3, 11e-3, 0.2, 2.5e-4, 8.5, 565.0)

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- Draws; small values more often than an even draw has them, and the ends ---- */

static iq24_t any(uint64_t *seed, double limit)
{
    const iq24_t most = (iq24_t)(limit * IQ24_ONE);
    const int32_t shape = bits_random(seed, 0, 15);
    const iq24_t even = bits_random(seed, -most, most);
    return shape == 0 ? most : shape == 1 ? -most : shape < 8 ? even : even / (1 << shape);
}

static iq24_t any_positive(uint64_t *seed, double limit)
{
    return iq24_abs_sat(any(seed, limit));
}

static iqfoc_ab_t any_ab(uint64_t *seed, double limit)
{
    iqfoc_ab_t x;
    x.alpha = any(seed, limit);
    x.beta = any(seed, limit);
    return x;
}

static iqfoc_dq_t any_dq(uint64_t *seed, double limit)
{
    iqfoc_dq_t x;
    x.d = any(seed, limit);
    x.q = any(seed, limit);
    return x;
}

static iqfoc_abc_t any_duties(uint64_t *seed)
{
    iqfoc_abc_t x;
    x.a = any_positive(seed, 1.0);
    x.b = any_positive(seed, 1.0);
    x.c = any_positive(seed, 1.0);
    return x;
}

static iqfoc_predictor_t any_predictor(uint64_t *seed)
{
    iqfoc_predictor_t p;
    p.k_u = iq24_max(any_positive(seed, 16.0), 1);
    p.k_r = any_positive(seed, 1.0);
    p.k_psi = any_positive(seed, 8.0);
    return p;
}

static iqfoc_rotor_t any_rotor(uint64_t *seed)
{
    return iqfoc_rotor_from_speed(bits_random(seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
}

static iq24_sincos_t any_angle(uint64_t *seed)
{
    return iq24_sincos(bits_random(seed, INT32_MIN, INT32_MAX));
}

static iq24_sincos_t any_angle_q30(uint64_t *seed)
{
    return iq24_sincos_q30_inline(bits_random(seed, INT32_MIN, INT32_MAX));
}

/* Numbers of 32 bits, as those of a struct of coefficients. */
static void any_numbers(uint64_t *seed, void *to, size_t size, double limit)
{
    for (size_t at = 0; at < size; at += sizeof(int32_t)) {
        const int32_t number = 4 * any(seed, limit);
        memcpy((char *)to + at, &number, sizeof number);
    }
}

#define ADD(x) bits_add(&digest, &(x), sizeof(x))

static void add_ab(uint64_t *digest, iqfoc_ab_t x)
{
    digest_add(digest, x.alpha);
    digest_add(digest, x.beta);
}

static void add_dq(uint64_t *digest, iqfoc_dq_t x)
{
    digest_add(digest, x.d);
    digest_add(digest, x.q);
}

static void add_abc(uint64_t *digest, iqfoc_abc_t x)
{
    digest_add(digest, x.a);
    digest_add(digest, x.b);
    digest_add(digest, x.c);
}

/* ---- Prediction and mean ---- */

static void test_prediction(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_predictor_t p = any_predictor(&seed);
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iqfoc_ab_t i = any_ab(&seed, 32.0);
        const iqfoc_ab_t u = any_ab(&seed, 2.0);
        const iq24_sincos_t sc = any_angle(&seed);
        const iq24_sincos_t sc_q30 = any_angle_q30(&seed);
        digest_add(&digest, iqfoc_predictor_emf(&p, &rotor));
        add_ab(&digest, iqfoc_predictor_euler(&p, i, u, &rotor, sc));
        add_ab(&digest, iqfoc_predictor_quasi_discrete(&p, i, u, &rotor, sc));
        add_ab(&digest, iqfoc_predictor_step_q30(&p, i, u, 4 * any(&seed, 13.9), sc_q30));
        const iqfoc_exact_t euler = iqfoc_form_euler(&p, &rotor);
        const iqfoc_exact_t discrete = iqfoc_form_quasi_discrete(&p, &rotor);
        ADD(euler);
        ADD(discrete);
        add_ab(&digest, iqfoc_exact_step(&discrete, i, u, sc));
        add_ab(&digest, iqfoc_exact_left_alone(&euler, i, sc));
    }
    bits_golden(UINT64_C(0x47e5d5a0723f147e), digest);
}

static void test_exact_and_salient(void)
{
    uint64_t seed = 2;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_exact_law_t law;
        iqfoc_exact_winding_t winding;
        winding.rho_q30 = bits_random(&seed, 0, 1 << 30);
        winding.k_u_q26 = bits_random(&seed, 4, 1 << 30);
        winding.k_psi_q27 = bits_random(&seed, 0, 1 << 30);
        law = n % 2 == 0 ? iqfoc_exact_prediction(&winding, IQ24_ONE) : iqfoc_exact_mean(&winding, IQ24_ONE);
        const iqfoc_exact_t exact = iqfoc_exact_at_speed_inline(
            &law, bits_random(&seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX));
        ADD(exact);
        const iqfoc_ab_t i = any_ab(&seed, 32.0);
        const iqfoc_ab_t u = any_ab(&seed, 2.0);
        add_ab(&digest, iqfoc_exact_step(&exact, i, u, any_angle(&seed)));
        iqfoc_salient_t salient;
        any_numbers(&seed, &salient, sizeof salient, 8.0);
        const iqfoc_dq_t i_dq = any_dq(&seed, 4.0);
        add_dq(&digest, iqfoc_salient_step(&salient, i_dq, any_dq(&seed, 1.0)));
    }
    bits_golden(UINT64_C(0x705e4b5cb71a7eb5), digest);
}

static void test_induction(void)
{
    uint64_t seed = 3;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_induction_t m;
        any_numbers(&seed, &m, sizeof m, 2.0);
        iqfoc_induction_state_t x;
        x.i = any_ab(&seed, 5.6);
        x.flux = any_ab(&seed, 8.0);
        const iqfoc_ab_t u = any_ab(&seed, 1.4);
        x = iqfoc_induction_step(&m, x, u);
        add_ab(&digest, x.i);
        add_ab(&digest, x.flux);
        x.i = any_ab(&seed, 5.6);
        x.flux = any_ab(&seed, 8.0);
        const iqfoc_ab_t mean = iqfoc_induction_mean(&m, x, u);
        add_ab(&digest, mean);
        add_ab(&digest, iqfoc_induction_with_ripple(&m.i_mean, mean, any_ab(&seed, 0.5)));
    }
    bits_golden(UINT64_C(0xcad2379974e1ba45), digest);
}

static void test_mean(void)
{
    uint64_t seed = 4;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_predictor_t p = any_predictor(&seed);
        const iqfoc_rotor_t rotor = any_rotor(&seed);
        const iq24_sincos_t sc = any_angle(&seed);
        const iqfoc_ab_t i = any_ab(&seed, 21.3);
        const iqfoc_ab_t next = any_ab(&seed, 32.0);
        add_dq(&digest, iqfoc_mean_current_correct(i, next, &rotor, sc));
        add_dq(&digest, iqfoc_mean_current_correct_steady(i, IQ24_ONE + any_positive(&seed, 0.37), sc));
        add_ab(&digest, iqfoc_mean_current_from_prediction(&p, i, next, &rotor, sc));
        add_dq(&digest, iqfoc_mean_current_seen(i, next, iqfoc_predictor_emf(&p, &rotor), &rotor, sc));
        const iq24_sincos_t sc_q30 = any_angle_q30(&seed);
        const int32_t w_q26 = 4 * any(&seed, 13.9);
        add_dq(&digest, iqfoc_mean_current_seen_q30(i, next, w_q26, 64 * rotor.s1, 64 * rotor.s2, sc_q30));
        add_ab(&digest, iqfoc_mean_current_quasi_discrete(&p, i, any_ab(&seed, 2.0), &rotor, sc));
        const iqfoc_abc_t high = any_duties(&seed);
        const iq24_t u_dc = any_positive(&seed, 2.0);
        const iqfoc_mean_modulated_t m = iqfoc_mean_modulated_at_speed(&p, &rotor);
        ADD(m);
        add_dq(&digest, iqfoc_mean_modulated(&m, i, next, high, u_dc, sc));
        const iqfoc_ripple_t ripple = {any_positive(&seed, 0.055), IQ24(0.6), IQ24(1.4), IQ24(0.3),
                                       IQ24(-1.1)};
        add_dq(&digest, iqfoc_ripple_seen(&ripple, high, u_dc, sc));
        const iqfoc_valley_reference_t valley = iqfoc_valley_reference_at(&rotor, p.k_psi);
        ADD(valley);
        add_dq(&digest, iqfoc_valley_reference(&valley, any_dq(&seed, 20.0)));
        digest_add(&digest, iqfoc_valley_gain(bits_random(&seed, 0, IQ24_ONE)));
    }
    bits_golden(UINT64_C(0xa1fb31b7886c8302), digest);
}

/* ---- Control ---- */

static void test_control(void)
{
    uint64_t seed = 5;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_current_control_gains_t g;
        g.kp_d = any_positive(&seed, n % 2 == 0 ? 32.0 : 0.5);
        g.kp_q = any_positive(&seed, n % 2 == 0 ? 32.0 : 0.5);
        g.ki_d = any_positive(&seed, n % 3 == 0 ? 32.0 : 0.1);
        g.ki_q = any_positive(&seed, n % 3 == 0 ? 32.0 : 0.1);
        g.anti_windup = any_positive(&seed, 1.0);
        g.x_d = any_positive(&seed, n % 2 == 0 ? 96.0 : 1.0);
        g.x_q = any_positive(&seed, n % 2 == 0 ? 96.0 : 1.0);
        g.emf = any_positive(&seed, n % 2 == 0 ? 96.0 : 1.0);
        iqfoc_current_control_t c = {0, 0};
        const double most = n % 4 == 0 ? 32.0 : 1.5;
        const iq24_t speed = bits_random(&seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        const iqfoc_dq_t u = any_dq(&seed, 8.0);
        iqfoc_current_control_preset(&c, &g, u, any_dq(&seed, most), speed);
        bits_add64(&digest, c.integral_d);
        bits_add64(&digest, c.integral_q);
        const iqfoc_dq_t i_ref = any_dq(&seed, most);
        const iqfoc_dq_t i = any_dq(&seed, most);
        add_dq(&digest, iqfoc_current_control_step(&c, &g, i_ref, i));
        add_dq(&digest, iqfoc_current_control_decoupling(&g, i, speed));
        bits_add64(&digest, c.integral_d);
        bits_add64(&digest, c.integral_q);
        add_dq(&digest, iqfoc_current_control_voltage(&c, &g, i, i_ref, speed));
        const iq24_t scale = any_positive(&seed, 1.0);
        iqfoc_current_control_limited(&c, &g, any_dq(&seed, 16.0), scale);
        bits_add64(&digest, c.integral_d);
        bits_add64(&digest, c.integral_q);
    }
    bits_golden(UINT64_C(0xdf17f89eadb9c776), digest);
}

static void test_voltage(void)
{
    uint64_t seed = 6;
    uint64_t digest = DIGEST_START;
    iqfoc_overmodulation_t over = {0};
    for (int n = 0; n < DRAWS; n++) {
        const iqfoc_ab_t u = any_ab(&seed, n % 2 == 0 ? 22.0 : 0.7);
        const iq24_t inverse = iq24_max(any_positive(&seed, 2.0), 1);
        iqfoc_duties_t duties = iqfoc_modulate(u, inverse, IQ24_ONE - any_positive(&seed, 0.5));
        add_abc(&digest, duties.high);
        digest_add(&digest, duties.scale);
        add_abc(&digest, iqfoc_overmodulation_legs(u));
        duties =
            iqfoc_overmodulate(&over, u, inverse, IQFOC_OVERMODULATION_CIRCLE + any_positive(&seed, 0.05));
        add_abc(&digest, duties.high);
        digest_add(&digest, duties.scale);
        digest_add(&digest, over.length);
        digest_add(&digest, iqfoc_pattern_index(any_positive(&seed, 4.0), inverse));
        add_ab(&digest, iqfoc_clarke2(u.alpha, u.beta));
        add_ab(&digest, iqfoc_clarke3(any_duties(&seed)));
        add_abc(&digest, iqfoc_clarke_inverse(u));
        const iqfoc_dq_t dq = any_dq(&seed, 32.0);
        add_ab(&digest, iqfoc_park_inverse(dq, any_angle(&seed)));
        add_ab(&digest, iqfoc_park_inverse_q30(dq, any_angle_q30(&seed)));
    }
    bits_golden(UINT64_C(0x824ee6a1c9a9be2e), digest);
}

/* The circle, where overmodulation begins, to the last number. */
static void test_end_of_the_linear_range(void)
{
    const iqfoc_ab_t circle = {IQFOC_OVERMODULATION_CIRCLE, 0};
    const iqfoc_ab_t beyond = {IQFOC_OVERMODULATION_CIRCLE + 1, 0};
    iqfoc_overmodulation_t over = {0};
    (void)iqfoc_overmodulate(&over, circle, IQ24_ONE, IQFOC_OVERMODULATION_MOST);
    TEST_ASSERT_EQUAL_INT32(0, over.length);
    (void)iqfoc_overmodulate(&over, beyond, IQ24_ONE, IQFOC_OVERMODULATION_MOST);
    TEST_ASSERT_EQUAL_INT32(IQFOC_OVERMODULATION_CIRCLE, over.length);
}

/* ---- Services ---- */

static void test_services(void)
{
    uint64_t seed = 7;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        const iq24_t at = any(&seed, 8.0);
        iqfoc_start_t start = {0};
        start.theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        start.speed = bits_random(&seed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
        digest_add(&digest, iqfoc_start_theta(&start, at));
        digest_add(&digest,
                   iqfoc_rotor_theta_of_q32(bits_random(&seed, INT32_MIN, INT32_MAX), 256 * start.speed, at));
        digest_add(&digest, iqfoc_rotor_speed_of_q32(bits_random(&seed, -1431655680, 1431655680)));
        iqfoc_offset_t offset = {0};
        offset.offset = any_duties(&seed);
        iqfoc_abc_t measured = any_duties(&seed);
        measured.a = any(&seed, 100.0);
        measured.b = any(&seed, 17.0);
        measured.c = any(&seed, 17.0);
        add_abc(&digest, iqfoc_offset_removed(&offset, measured));
        const iqfoc_ab_t i = any_ab(&seed, 15.9);
        const iqfoc_ab_t middle = any_ab(&seed, 15.9);
        add_ab(&digest, iqfoc_observer_mean(i, middle, any_ab(&seed, 15.9)));
        iqfoc_tuned_state_t tuned = {0};
        iqfoc_tuned_ripple(&tuned, any_dq(&seed, 2.5));
        iqfoc_tuned_peak(&tuned, i, start.theta);
        add_dq(&digest, tuned.ripple);
        add_dq(&digest, tuned.i_mid);
        iqfoc_dq_t drift = any_dq(&seed, 4.0);
        const iq24_t gain = any_positive(&seed, 1.0);
        iqfoc_deadbeat_learn(&drift, gain, any_ab(&seed, 63.0), start.theta);
        add_dq(&digest, drift);
        const iq24_t inverse = iqfoc_deadbeat_inverse(bits_random(&seed, 1 << 20, 1 << 30));
        digest_add(&digest, inverse);
        digest_add(&digest, iqfoc_deadbeat_component(any(&seed, 100.0), inverse));
    }
    bits_golden(UINT64_C(0xec044027ce97674a), digest);
}

static void nothing_seen(const iqfoc_watch_t *w)
{
    TEST_ASSERT_EQUAL_INT64(0, w->alpha_cos | w->alpha_sin | w->beta_cos | w->beta_sin);
    TEST_ASSERT_EQUAL_INT32(0, w->e_ab[0] | w->e_ab[1] | w->i[0] | w->i[1] | w->u[0] | w->u[1]);
    TEST_ASSERT_EQUAL_INT32(0, w->count | w->naming | w->speed | w->theta | w->mechanical);
    for (int k = 0; k < IQFOC_WATCH_SIGNATURES; k++) {
        TEST_ASSERT_EQUAL_INT32(0, w->up_q16[k] | w->down_q16[k] | w->xy_q6[k] | w->xx_q6[k]);
    }
    TEST_ASSERT_EQUAL_INT32(0, w->across_q6 | w->amount_q16);
    TEST_ASSERT_EQUAL_UINT32(0, w->blocks | w->since);
    TEST_ASSERT_EQUAL_INT(IQFOC_WATCH_NONE, w->group);
}

static void test_watch(void)
{
    uint64_t seed = 8;
    uint64_t digest = DIGEST_START;
    iqfoc_watch_t w;
    for (int run = 0; run < 50; run++) {
        memset(&w, run % 2 == 0 ? 0x55 : 0xAA, sizeof w);
        iqfoc_watch_reset(&w);
        nothing_seen(&w);
        for (int n = 1; n <= 32; n++) {
            const iqfoc_ab_t off = any_ab(&seed, n == 5 ? 120.0 : 2.0);
            const iqfoc_dq_t i = any_dq(&seed, 8.0);
            const iqfoc_dq_t u = any_dq(&seed, 16.0);
            TEST_ASSERT_EQUAL(n == 32, iqfoc_watch_step(&w, off, i, u, any_angle(&seed)));
            TEST_ASSERT_EQUAL_INT(n, w.count);
        }
        bits_add64(&digest, w.alpha_cos);
        bits_add64(&digest, w.alpha_sin);
        bits_add64(&digest, w.beta_cos);
        bits_add64(&digest, w.beta_sin);
        ADD(w.e_ab);
        ADD(w.i);
        ADD(w.u);
    }
    bits_golden(UINT64_C(0xedf6968c2b16f551), digest);
}

/* ---- Initialisers ---- */

/* Structs of 32-bit numbers alone. */
static void test_initialisers(void)
{
    uint64_t digest = DIGEST_START;
    static const iqfoc_current_control_gains_t gains = PI_GAINS;
    static const iqfoc_predictor_t predictor = IQFOC_PREDICTOR(0.9, 8e-3, 0.2, 2.5e-4, 8.5, 565.0);
    static const iqfoc_flux_predictor_t flux =
        IQFOC_FLUX_PREDICTOR(0.9, 8e-3, 11e-3, 0.2, 2.5e-4, 8.5, 565.0);
    static const iqfoc_extension_t extension = IQFOC_EXTENSION_NONE;
    static const iqfoc_exact_winding_t winding = IQFOC_EXACT_WINDING(0.9, 8e-3, 0.2, 2.5e-4, 8.5, 565.0);
    static const iqfoc_salient_machine_t salient =
        IQFOC_SALIENT_MACHINE(0.9, 8e-3, 11e-3, 0.2, 2.5e-4, 8.5, 565.0);
    static const iqfoc_induction_machine_t induction =
        IQFOC_INDUCTION_MACHINE(0.9, 0.5, 9e-3, 0.12, 2.5e-4, 8.5, 565.0);
    static const iqfoc_observer_config_t observer =
        IQFOC_OBSERVER_CONFIG(0.9, 8e-3, 11e-3, 0.2, 2.5e-4, 8.5, 565.0, 500.0, IQ24(0.003));
    static const iqfoc_tracker_config_t tracker = IQFOC_TRACKER_GAINS(700.0, 2.5e-4, IQ24(0.1), 7);
    static const iqfoc_tracker_config_t tracker_2 = IQFOC_TRACKER_GAINS_2(700.0, 2.5e-4, IQ24(0.1), 7);
    static const iqfoc_speed_control_config_t speed =
        IQFOC_SPEED_CONTROL(40.0, 2e-3, 3, 0.2, 2.5e-4, 8.5, 4000.0, 20.0, 5);
    static const iqfoc_reference_config_t reference =
        IQFOC_REFERENCE(120.0, 8e-3, 11e-3, 0.2, 2.5e-4, 8.5, 565.0, 1900.0, 320.0, 9.0, -5.0, 0.98);
    static const iqfoc_reference_link_t link = IQFOC_REFERENCE_LINK(8e-3, 8.5, 565.0, 1900.0, 320.0);
    static const iqfoc_adapt_config_t adapt = IQFOC_ADAPT_CONFIG;
    static const iqfoc_watch_config_t watch =
        IQFOC_WATCH_CONFIG_KNOWN(0.9, 8e-3, 11e-3, 0.2, 3, 2.5e-4, 8.5, 565.0, 0.003, 0.01, 0.02, 0.03);
    static const iqfoc_watch_config_t watch_round =
        IQFOC_WATCH_CONFIG(0.9, 8e-3, 8e-3, 0.2, 0, 2.5e-4, 8.5, 565.0, 0.003);
    ADD(gains);
    ADD(predictor);
    ADD(flux);
    ADD(extension);
    ADD(winding);
    ADD(salient);
    ADD(induction);
    ADD(observer);
    ADD(tracker);
    ADD(tracker_2);
    ADD(speed);
    ADD(reference);
    ADD(link);
    ADD(adapt);
    ADD(watch);
    ADD(watch_round);
    bits_golden(UINT64_C(0x3789d6a173ebaa86), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_prediction);
    RUN_TEST(test_exact_and_salient);
    RUN_TEST(test_induction);
    RUN_TEST(test_mean);
    RUN_TEST(test_control);
    RUN_TEST(test_voltage);
    RUN_TEST(test_end_of_the_linear_range);
    RUN_TEST(test_services);
    RUN_TEST(test_watch);
    RUN_TEST(test_initialisers);
    return UNITY_END();
}
