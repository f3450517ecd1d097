/*
 * The observer, the adaptations of its L_q and of its R and psi_f, and the drive without a sensor to the last bit: any allowed input from any
 * state, one hash for each over all results. test_rotor_observer.c, test_observer_inductance.c, test_observer_resistance.c and
 * test_sensorless_drive.c check them in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/observer_inductance.h"
#include "iqfoc/observer_resistance.h"
#include "iqfoc/params.h"
#include "iqfoc/sensorless.h"

#include <stdbool.h>

#define DRAWS 40000

#define R_OHM  0.9
#define L_H    6.48e-4
#define PSI_WB 0.0108
#define T_S    1e-4
#define I_B_A  10.0
#define U_DC_V 300.0

void setUp(void)
{
}

void tearDown(void)
{
}

static iq24_t any(uint64_t *seed, double limit)
{
    const iq24_t most = (iq24_t)(limit * IQ24_ONE);
    return bits_random(seed, -most, most);
}

static iq24_t any_size(uint64_t *seed, double limit)
{
    return bits_small(seed, (iq24_t)(limit * IQ24_ONE));
}

static iqfoc_ab_t any_ab(uint64_t *seed, double limit)
{
    const iq24_t alpha = any_size(seed, limit);
    const iqfoc_ab_t ab = {alpha, any_size(seed, limit)};
    return ab;
}

/* ---- Observer ---- */

static iqfoc_observer_config_t any_observer(uint64_t *seed)
{
    iqfoc_observer_config_t c;
    c.machine.l_d = bits_random(seed, IQ24(0.0625), IQ24(4.0));
    c.machine.l_q = bits_random(seed, IQ24(0.0625), IQ24(4.0));
    c.machine.k_d = (iq24_t)((INT64_C(1) << 48) / c.machine.l_d);
    c.machine.k_q = (iq24_t)((INT64_C(1) << 48) / c.machine.l_q);
    c.machine.r = bits_random(seed, 0, IQ24(0.5));
    c.machine.psi = iq24_max(iq24_abs_sat(any_size(seed, 16.0)), IQ24(0.015625));
    c.machine.skew = 0;
    c.saturation = iq24_max(bits_random(seed, -IQ24(4.0), IQ24(4.0)), 0);
    c.gain_max = bits_random(seed, IQ24(0.125), IQ24_ONE);
    c.k1 = bits_random(seed, 1, IQ24_ONE);
    c.k2 = bits_random(seed, 1, IQ24(0.25));
    c.speed_min = bits_random(seed, 0, IQ24(0.1));
    c.angle_max = bits_random(seed, 1, IQ24(0.5));
    c.flux_max = bits_random(seed, 1, IQ24(8.0) - 1);
    c.lock_cycles = (uint32_t)bits_random(seed, 1, 6);
    c.lost_cycles = bits_random(seed, 0, 3) == 0 ? UINT32_MAX : (uint32_t)bits_random(seed, 0, 6);
    c.slow_cycles = bits_random(seed, 0, 3) == 0 ? UINT32_MAX : (uint32_t)bits_random(seed, 0, 6);
    return c;
}

static void add_observer(uint64_t *digest, const iqfoc_observer_t *o)
{
    digest_add(digest, o->psi.alpha);
    digest_add(digest, o->psi.beta);
    digest_add(digest, o->theta_q32);
    digest_add(digest, o->speed_q32);
    digest_add(digest, o->error);
    digest_add(digest, o->flux_error);
    digest_add(digest, (int32_t)o->count);
    digest_add(digest, (int32_t)o->slow);
    digest_add(digest, (int32_t)o->status);
    digest_add(digest, o->locked ? 1 : 0);
    digest_add(digest, o->begins ? 1 : 0);
}

static void any_state(uint64_t *seed, iqfoc_observer_t *o)
{
    const iqfoc_ab_t i = any_ab(seed, 15.9);
    const iq24_t theta = bits_random(seed, INT32_MIN, INT32_MAX);
    const iq24_t speed = any_size(seed, 0.4);
    iqfoc_observer_start(o, i, theta, speed, bits_random(seed, 0, 1) != 0);
    if (bits_random(seed, 0, 3) == 0) {
        o->psi = any_ab(seed, 32.0);
    }
    o->count = (uint32_t)bits_random(seed, 0, 6);
    o->slow = (uint32_t)bits_random(seed, 0, 6);
}

static void test_observer(void)
{
    uint64_t seed = 11;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_observer_config_t c = any_observer(&seed);
        c.saturation = n % 16 == 0 ? 1 : c.saturation;
        iqfoc_observer_t o = {.config = NULL};
        digest_add(&digest, (int32_t)iqfoc_observer_init(&o, &c));
        if (o.config == &c) {
            add_observer(&digest, &o);
        }
        o.config = &c;
        any_state(&seed, &o);
        add_observer(&digest, &o);
        for (int k = 0; k < 3; k++) {
            const iqfoc_ab_t u = any_ab(&seed, 2.0);
            const iqfoc_ab_t middle = any_ab(&seed, 15.9);
            const iqfoc_ab_t i = any_ab(&seed, n % 2 == 0 ? 15.9 : 1.0);
            iqfoc_observer_step(&o, u, iqfoc_observer_mean(i, middle, i), i);
            add_observer(&digest, &o);
        }
        digest_add(&digest, iqfoc_observer_theta(&o, any(&seed, 8.0)));
        digest_add(&digest, iqfoc_observer_speed(&o));
    }
    bits_golden(UINT64_C(0x80a8a745dba3a84d), digest);
}

/* ---- L_q ---- */

static void test_inductance(void)
{
    uint64_t seed = 12;
    uint64_t digest = DIGEST_START;
    iqfoc_observer_config_t nominal =
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.004));
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_observer_inductance_config_t c;
        c.gain = bits_random(&seed, 1, IQ24_ONE);
        c.least = bits_random(&seed, IQ24(0.0625), IQ24_ONE);
        c.u_least = bits_random(&seed, 0, 1) == 0 ? 0 : iq24_abs_sat(any_size(&seed, 1.0));
        c.low = bits_random(&seed, 1, nominal.machine.l_q);
        c.high = bits_random(&seed, nominal.machine.l_q, IQ24(4.0));
        nominal.machine.psi = bits_random(&seed, IQ24(0.015625), IQ24(16.0));
        iqfoc_observer_inductance_t a;
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &c, &nominal));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &a.adapted));
        TEST_ASSERT_TRUE(a.level == 0 && a.slope == 0 && !a.follows);
        o.theta_q32 = bits_random(&seed, INT32_MIN, INT32_MAX);
        o.speed_q32 = bits_random(&seed, -256 * IQFOC_ROTOR_SPEED_MAX, 256 * IQFOC_ROTOR_SPEED_MAX);
        o.error = any_size(&seed, 0.5);
        o.locked = bits_random(&seed, 0, 7) != 0;
        a.follows = bits_random(&seed, 0, 7) != 0;
        a.level = any_size(&seed, 16.0);
        a.slope = any_size(&seed, 8.0);
        iqfoc_observer_inductance_step(&a, &o, any_ab(&seed, 15.9));
        digest_add(&digest, a.level);
        digest_add(&digest, a.slope);
        digest_add(&digest, a.adapted.machine.l_q);
        digest_add(&digest, a.follows ? 1 : 0);
    }
    bits_golden(UINT64_C(0x394b0df5ef9b725e), digest);
}

/* A step is taken from |x| = least on, both signs. */
static void test_least_step(void)
{
    const iqfoc_observer_config_t nominal =
        IQFOC_OBSERVER_CONFIG(0.5, 3e-3, 3e-3, 0.12, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.004));
    const iqfoc_observer_inductance_config_t c = {IQ24_ONE, IQ24(0.08), 0, 1, IQ24(4.0)};
    for (int32_t below = 0; below < 2; below++) {
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            const iqfoc_ab_t none = {0, 0};
            iqfoc_observer_inductance_t a;
            iqfoc_observer_t o;
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_inductance_init(&a, &c, &nominal));
            TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &a.adapted));
            o.locked = true;
            o.error = IQ24(0.1);
            a.follows = true;
            a.level = sign * (c.least - below);
            iqfoc_observer_inductance_step(&a, &o, none);
            TEST_ASSERT_EQUAL(below != 0, a.adapted.machine.l_q == nominal.machine.l_q);
        }
    }
}

static const iqfoc_observer_config_t warm_config =
    IQFOC_OBSERVER_CONFIG(0.5, 1.5e-3, 1.5e-3, 0.03, 1e-4, 10.0, 300.0, 1600.0, IQ24(0.002));

/* L_d less L_q is within 4, to the last number, and so it is of both ends of an adapted L_q. */
static void test_most_saliency(void)
{
    static const struct {
        iq24_t l_d, l_q, low, high;
        iqfoc_error_t machine, adapted;
    } cases[] = {
        {IQ24(5.0), IQ24_ONE, IQ24_ONE, IQ24_ONE, IQFOC_OK, IQFOC_OK},
        {IQ24(5.0), IQ24_ONE, IQ24_ONE - 1, IQ24_ONE, IQFOC_OK, IQFOC_ERROR_OBSERVER},
        {IQ24(5.0) + 1, IQ24_ONE, IQ24_ONE, IQ24_ONE, IQFOC_ERROR_OBSERVER, IQFOC_ERROR_OBSERVER},
        {IQ24_ONE, IQ24(5.0), IQ24(5.0), IQ24(5.0), IQFOC_OK, IQFOC_OK},
        {IQ24_ONE, IQ24(5.0), IQ24_ONE, IQ24(5.0) + 1, IQFOC_OK, IQFOC_ERROR_OBSERVER},
        {IQ24_ONE, IQ24(5.0) + 1, IQ24_ONE, IQ24(5.0) + 1, IQFOC_ERROR_OBSERVER, IQFOC_ERROR_OBSERVER}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        iqfoc_observer_config_t c = warm_config;
        c.machine.l_d = cases[k].l_d;
        c.machine.l_q = cases[k].l_q;
        c.machine.k_d = iq24_div(IQ24_ONE, c.machine.l_d);
        c.machine.k_q = iq24_div(IQ24_ONE, c.machine.l_q);
        c.machine.skew = 0;
        TEST_ASSERT_EQUAL_INT(cases[k].machine, iqfoc_observer_check(&c));
        const iqfoc_observer_inductance_config_t l = {1, IQ24(0.1), 0, cases[k].low, cases[k].high};
        iqfoc_observer_inductance_t a;
        TEST_ASSERT_EQUAL_INT(cases[k].adapted, iqfoc_observer_inductance_init(&a, &l, &c));
    }
}

/* ---- R and psi_f ---- */

static void any_adaptation(uint64_t *seed, iqfoc_observer_resistance_t *a, iqfoc_observer_t *o)
{
    o->theta_q32 = bits_random(seed, INT32_MIN, INT32_MAX);
    o->speed_q32 = any_size(seed, 85.0);
    o->flux_error = any_size(seed, 16.0);
    o->psi = any_ab(seed, 32.0);
    o->locked = bits_random(seed, 0, 7) != 0;
    a->s = any_ab(seed, 32.0);
    a->r = bits_random(seed, -a->config->r_share, a->config->r_share);
    a->psi = bits_random(seed, -a->config->psi_share, a->config->psi_share);
}

static void test_resistance(void)
{
    uint64_t seed = 14;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_observer_config_t adapted = warm_config;
        adapted.gain_max = bits_random(&seed, IQ24(0.125), IQ24_ONE);
        adapted.machine.psi = iq24_max(iq24_abs_sat(any_size(&seed, 12.0)), IQ24(0.05));
        adapted.machine.r =
            bits_random(&seed, 0, (iq24_t)bits_held(8 * (int64_t)adapted.machine.psi, 0, IQ24(0.3)));
        iqfoc_observer_resistance_config_t c;
        c.gain = bits_random(&seed, 1, IQ24_ONE);
        c.r_share = bits_random(&seed, IQ24(0.0625), IQ24(0.5));
        c.psi_share = bits_random(&seed, IQ24(0.015625), IQ24(0.25));
        iqfoc_observer_resistance_t a;
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_resistance_init(&a, &c, &adapted));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &adapted));
        TEST_ASSERT_TRUE(a.r == 0 && a.psi == 0 && a.s.alpha == 0 && a.s.beta == 0);
        digest_add(&digest, a.r_over_psi);
        digest_add(&digest, a.psi_inverse);
        digest_add(&digest, a.least);
        any_adaptation(&seed, &a, &o);
        iqfoc_observer_resistance_step(&a, &o, any_ab(&seed, n % 2 == 0 ? 15.9 : 1.0));
        digest_add(&digest, a.r);
        digest_add(&digest, a.psi);
        bits_add(&digest, &a.s, sizeof a.s);
        bits_add(&digest, &o.psi, sizeof o.psi);
        digest_add(&digest, adapted.machine.r);
        digest_add(&digest, adapted.machine.psi);
    }
    bits_golden(UINT64_C(0xebb8501fe2eaff55), digest);
}

/* The ends at which R or psi_f begins to be seen: |x| = least, |x| = |y|, |x| and |y| below half of least, speed_min. */
static void test_what_is_seen(void)
{
    static const struct {
        iq24_t x, y,
            speed; /* the direct part of s, across, and the movement; in units of the case's least and least movement */
        int32_t x_off, turns_off;
        int seen; /* 1: R, 2: psi_f */
    } cases[] = {{2, 0, 0, 0, 0, 1},   {2, 0, 0, -1, 0, 0},  {2, 2, 0, 0, 0, 1}, {4, 4, 0, -1, 0, 0},
                 {-2, -2, 0, 0, 0, 1}, {-2, 0, 0, 1, 0, 0},  {1, 0, 1, 0, 0, 0}, {1, 0, 1, -1, 0, 2},
                 {0, 1, 1, 0, 0, 0},   {0, 1, 1, -1, -1, 0}, {0, 0, 1, 0, 0, 2}, {0, 0, 1, 0, -1, 0},
                 {0, 0, -1, 0, 0, 2},  {0, 0, -1, 0, 1, 0}};
    const iqfoc_observer_resistance_config_t c = {IQ24(0.05), IQ24(0.5), IQ24(0.125)};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        iqfoc_observer_config_t adapted = warm_config;
        adapted.machine.psi = IQ24_ONE;
        iqfoc_observer_resistance_t a;
        iqfoc_observer_t o;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_resistance_init(&a, &c, &adapted));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_observer_init(&o, &adapted));
        TEST_ASSERT_EQUAL_INT32(IQ24(0.25), a.least);
        o.locked = true;
        o.flux_error = IQ24(0.1);
        o.speed_q32 = 256 * (cases[k].speed * adapted.speed_min + cases[k].turns_off);
        a.s.alpha = cases[k].x * (a.least / 2) + cases[k].x_off;
        a.s.beta = cases[k].y * (a.least / 2);
        iqfoc_observer_resistance_step(&a, &o, (iqfoc_ab_t){0, 0});
        TEST_ASSERT_EQUAL(cases[k].seen == 1, a.r != 0);
        TEST_ASSERT_EQUAL(cases[k].seen == 2, a.psi != 0);
    }
}

/* ---- The drive ---- */

static const iqfoc_cycle_config_t cycle_config = {
    .predictor = IQFOC_PREDICTOR(R_OHM, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .gains = IQFOC_GAINS(2000.0, R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V),
    .feedback = IQFOC_FEEDBACK_QUASI_DISCRETE_MEAN,
    .modulation = IQFOC_MODULATION_PWM,
    .safe_state = IQFOC_SAFE_GATES_OFF,
    .span_max = IQ24_ONE,
    .current_limit = IQ24(4.0),
    .period_ticks = 1000,
    .tolerance_ticks = 100,
    .stale_ticks = 250,
    .deadline_ticks = 500,
    .trips = IQFOC_STATUS_OVERCURRENT,
};
static const iqfoc_observer_config_t observer_config =
    IQFOC_OBSERVER_CONFIG(R_OHM, L_H, L_H, PSI_WB, T_S, I_B_A, U_DC_V, 1600.0, IQ24(0.01));
static const iqfoc_start_config_t start_config = {IQ24(0.6), 7, 5, IQ24(0.03), 9};
static const iqfoc_extension_t losses = {.i_gain_inverse = {IQ24_ONE, IQ24_ONE, IQ24_ONE},
                                         .k_u = IQ24(1.01),
                                         .v_dead = IQ24(0.005),
                                         .knee_inverse = IQ24(7.0)};

static iqfoc_sample_t any_sample(uint64_t *seed, iq24_t at)
{
    const iqfoc_abc_t i =
        bits_small_abc(seed, bits_random(seed, 0, 9) == 0 ? (iq24_t)(15.9 * IQ24_ONE) : IQ24(2.0));
    const iq24_t theta = bits_random(seed, INT32_MIN, INT32_MAX);
    const iqfoc_sample_t s = {
        .i = i, .theta = theta, .speed = any_size(seed, 0.3), .u_dc = IQ24_ONE, .instant = at};
    return s;
}

static void any_drive(uint64_t *seed, iqfoc_sensorless_t *s, iqfoc_cycle_t *cycle)
{
    any_state(seed, &s->observer);
    s->source = (iqfoc_angle_source_t)bits_random(seed, 0, 3);
    s->wanted = bits_random(seed, 0, 1) != 0 ? IQFOC_ANGLE_OBSERVED : IQFOC_ANGLE_MEASURED;
    s->i_peak = any_ab(seed, 8.0);
    s->on = (uint32_t)bits_random(seed, 0, 3);
    s->start.stage = (iqfoc_start_stage_t)bits_random(seed, 0, 5);
    s->start.done = (uint32_t)bits_random(seed, 0, 4);
    s->start.theta = any(seed, 0.5);
    s->start.speed = any_size(seed, 0.03);
    s->start.i_ref.d = bits_random(seed, 0, IQ24_ONE);
    cycle->enabled = bits_random(seed, 0, 7) != 0;
    cycle->tripped = bits_random(seed, 0, 7) == 0;
    cycle->u_now = any_ab(seed, 1.0);
    cycle->i_valley = any_ab(seed, 16.0);
    cycle->u_dq.d = any_size(seed, 2.0);
    cycle->u_dq.q = any_size(seed, 2.0);
    cycle->i_ref.d = any_size(seed, 2.0);
    cycle->i_ref.q = any_size(seed, 2.0);
}

static void add_sample(uint64_t *digest, const iqfoc_sample_t *s)
{
    digest_add(digest, s->theta);
    digest_add(digest, s->speed);
}

static void test_sensorless(void)
{
    uint64_t seed = 13;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iqfoc_cycle_t cycle;
        iqfoc_sensorless_t s;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_cycle_init(&cycle, &cycle_config));
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_sensorless_init(&s, &observer_config, &start_config,
                                                              n % 2 == 0 ? &losses : NULL));
        TEST_ASSERT_TRUE(s.source == IQFOC_ANGLE_MEASURED && s.wanted == IQFOC_ANGLE_MEASURED && s.on == 0 &&
                         s.difference == 0 && s.i_peak.alpha == 0 && s.i_peak.beta == 0);
        any_drive(&seed, &s, &cycle);
        if (n % 50 == 0) {
            iqfoc_sensorless_start(&s);
        } else if (n % 50 == 1) {
            iqfoc_sensorless_catch(&s, any(&seed, 0.4));
        }
        for (int k = 0; k < 2; k++) {
            iqfoc_sample_t valley = any_sample(&seed, any(&seed, 0.1));
            iqfoc_sensorless_valley(&s, &cycle, &valley);
            iqfoc_sample_t peak = any_sample(&seed, IQ24(0.5));
            iqfoc_sensorless_peak(&s, &peak);
            add_sample(&digest, &valley);
            add_sample(&digest, &peak);
            add_observer(&digest, &s.observer);
            digest_add(&digest, (int32_t)s.source);
            digest_add(&digest, (int32_t)s.wanted);
            digest_add(&digest, (int32_t)s.on);
            digest_add(&digest, s.difference);
            digest_add(&digest, s.i_peak.alpha);
            digest_add(&digest, s.i_peak.beta);
            digest_add(&digest, s.start.theta);
            digest_add(&digest, s.start.speed);
            digest_add(&digest, cycle.i_ref.d);
            digest_add(&digest, cycle.i_ref.q);
            digest_add(&digest, (int32_t)cycle.status);
            bits_add64(&digest, cycle.control.integral_d);
            bits_add64(&digest, cycle.control.integral_q);
        }
    }
    bits_golden(UINT64_C(0xfd450da6369d7a1b), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_observer);
    RUN_TEST(test_inductance);
    RUN_TEST(test_least_step);
    RUN_TEST(test_most_saliency);
    RUN_TEST(test_resistance);
    RUN_TEST(test_what_is_seen);
    RUN_TEST(test_sensorless);
    return UNITY_END();
}
