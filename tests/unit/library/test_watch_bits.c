/*
 * A block of the change detector and of the adaptation to the last bit, from any state: hashes over all results. test_watch.c and
 * test_adapt.c check them against effects in double precision.
 */
#include "bits.h"
#include "hash.h"

#include "iqfoc/adapt.h"

#include <stdbool.h>

#define BLOCKS 150000

void setUp(void)
{
}

void tearDown(void)
{
}

static const iqfoc_watch_config_t usual =
    IQFOC_WATCH_CONFIG(0.9, 0.008, 0.011, 0.2, 3, 1.25e-4, 6.0 * 1.4142135623730951, 565.0, 0.003);

static void any_sums(uint64_t *seed, iqfoc_watch_t *w, double reach, bool weak)
{
    w->alpha_cos = (int64_t)(uniform(seed, -reach, reach) * 9007199254740992.0);
    w->alpha_sin = (int64_t)(uniform(seed, -reach, reach) * 9007199254740992.0);
    w->beta_cos = (int64_t)(uniform(seed, -reach, reach) * 9007199254740992.0);
    w->beta_sin = (int64_t)(uniform(seed, -reach, reach) * 9007199254740992.0);
    for (int k = 0; k < 2; k++) {
        w->e_ab[k] = random_iq24(seed, -32.0 * reach, 32.0 * reach);
        w->i[k] = random_iq24(seed, weak ? -0.12 : -1.5, weak ? 0.12 : 1.5);
        w->u[k] = random_iq24(seed, -0.8, 0.8);
    }
    w->theta = bits_random(seed, INT32_MIN, INT32_MAX);
    w->mechanical = bits_random(seed, INT32_MIN, INT32_MAX);
    w->across_q6 = w->naming > 0 ? bits_random(seed, -30000, 30000) : 0;
    w->count = IQFOC_WATCH_BLOCK_CYCLES;
}

static void any_detectors(uint64_t *seed, iqfoc_watch_t *w, const iqfoc_watch_config_t *c)
{
    for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        const bool high = bits_random(seed, 0, 30) == 0;
        w->up_q16[n] = bits_random(seed, 0, high ? INT32_C(16384) << 16 : c->threshold_q16);
        w->down_q16[n] = bits_random(seed, 0, c->threshold_q16);
        w->xy_q6[n] = w->naming > 0 ? bits_random(seed, -30000, 30000) : bits_random(seed, 0, 900);
        w->xx_q6[n] = w->naming > 0 ? bits_random(seed, 0, 30000) : bits_random(seed, 0, 900);
    }
    if (bits_random(seed, 0, 50) == 0) {
        w->xy_q6[bits_random(seed, 0, 14)] = INT32_MAX;
        w->xx_q6[bits_random(seed, 0, 14)] = INT32_MAX;
        w->blocks = w->blocks > 0 ? UINT32_MAX - 5 : 0;
    }
}

static void any_config(uint64_t *seed, iqfoc_watch_config_t *c)
{
    *c = usual;
    c->per_noise_q8 = bits_random(seed, 10, 20000 * 256 / 64);
    c->flux_d_q16 = bits_random(seed, 8192, 131072);
    c->flux_q_q16 = bits_random(seed, 8192, 131072);
    c->slack_q16[0] = bits_random(seed, 0, 8 * 65536);
    c->slack_q16[1] = bits_random(seed, 0, 65536);
    c->naming_blocks = bits_random(seed, 1, 1024);
    static const int pole_pairs[] = {0, 1, 2, 3, 7, 30};
    const int pairs = pole_pairs[bits_random(seed, 0, 5)];
    c->mechanical = pairs > 0 ? to_iq24(1.0 / pairs) : 0;
    /* Each alone, or some, or none. */
    const bool sure = bits_random(seed, 0, 1) == 0;
    const int unsure = sure ? 0 : bits_random(seed, 0, (1 << IQFOC_WATCH_UNSURE) - 1);
    for (int n = 0; n < IQFOC_WATCH_UNSURE; n++) {
        if (unsure & (1 << n)) {
            c->unsure_q16[n] =
                bits_random(seed, 0, 3) == 0 ? bits_random(seed, 0, 16 * 65536) : bits_random(seed, 0, 1000);
        }
    }
    for (int n = 0; n < IQFOC_WATCH_GROUPS; n++) {
        c->size_q16[n] = bits_random(seed, 0, 400 * 65536);
    }
}

static void add_state(uint64_t *digest, const iqfoc_watch_t *w)
{
    for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        digest_add(digest, w->up_q16[n]);
        digest_add(digest, w->down_q16[n]);
        digest_add(digest, w->xy_q6[n]);
        digest_add(digest, w->xx_q6[n]);
    }
    digest_add(digest, w->naming);
    digest_add(digest, (int32_t)w->since);
    digest_add(digest, (int32_t)w->blocks);
    digest_add(digest, (int32_t)w->group);
    digest_add(digest, w->amount_q16);
    digest_add(digest, w->speed);
    digest_add(digest, w->theta);
    digest_add(digest, w->mechanical);
    digest_add(digest, w->across_q6);
}

/* The sums of the cycles begin again after a block. */
static void expect_begun(const iqfoc_watch_t *w)
{
    TEST_ASSERT_EQUAL_INT(0, w->count);
    TEST_ASSERT_TRUE((w->alpha_cos | w->alpha_sin | w->beta_cos | w->beta_sin) == 0);
    TEST_ASSERT_EQUAL_INT32(0, w->e_ab[0] | w->e_ab[1] | w->i[0] | w->i[1] | w->u[0] | w->u[1]);
}

static void any_block(void)
{
    uint64_t seed = 1;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < BLOCKS; n++) {
        struct {
            iqfoc_watch_config_t c;
            int32_t beyond[4]; /* nothing may depend on it */
        } set = {.beyond = {n << 8, n << 9, n << 10, n << 11}};
        iqfoc_watch_t w;
        any_config(&seed, &set.c);
        const iqfoc_watch_config_t c = set.c;
        iqfoc_watch_reset(&w);
        const double fast = n % 3 == 0 ? 0.003 : n % 3 == 1 ? 0.05 : 0.33;
        w.speed = random_iq24(&seed, -fast, fast);
        w.blocks = n % 40 == 0 ? 0 : (uint32_t)bits_random(&seed, 1000, 2000); /* more than any age */
        w.naming = (int16_t)(n % 2 == 0 ? 0 : bits_random(&seed, 1, n % 4 == 1 ? 1 : 5));
        w.group = n % 50 == 0 ? IQFOC_WATCH_FLUX : IQFOC_WATCH_NONE;
        any_detectors(&seed, &w, &c);
        any_sums(&seed, &w, n % 5 == 0 ? 2.0 : 0.003, n % 23 == 0);
        const iq24_t speed =
            n % 7 == 0 ? random_iq24(&seed, -1.0, 1.0) : w.speed + random_iq24(&seed, -0.001, 0.001);
        const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        digest_add(&digest, iqfoc_watch_block(&w, &set.c, speed, theta));
        add_state(&digest, &w);
        expect_begun(&w);
    }
    bits_golden(UINT64_C(0xe7d3adb9877863c9), digest);
}

/*
 * One LSB above 0.15 of current a block is judged, and at 0.15 it is not, as the length is rounded down. The
 * stationary frame is judged from 0.0044 turns on, and not one LSB below.
 */
static void the_least_current_and_speed(void)
{
    const int32_t high = 100 << 16;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 6; n++) {
        const int off = n % 3 - 1;
        const bool of_speed = n >= 3;
        iqfoc_watch_t w;
        iqfoc_watch_reset(&w);
        w.blocks = 5;
        w.i[0] = of_speed ? IQ24(0.3) : IQ24(0.15) + off;
        w.alpha_cos = INT64_C(1) << 44;
        w.e_ab[0] = IQ24(0.2);
        w.speed = IQ24(0.0044) + (of_speed ? off : 1);
        for (int k = 0; k < IQFOC_WATCH_SIGNATURES; k++) {
            w.up_q16[k] = high; /* a detector that is judged falls, by its cost */
        }
        TEST_ASSERT_FALSE(iqfoc_watch_block(&w, &usual, w.speed, 0));
        TEST_ASSERT_EQUAL(of_speed ? off >= 0 : off > 0,
                          w.up_q16[of_speed ? IQFOC_WATCH_SENSOR_GAIN + 2 : IQFOC_WATCH_FLUX] != high);
        add_state(&digest, &w);
        expect_begun(&w);
    }
    bits_golden(UINT64_C(0x15c551b08764669b), digest);
}

/* The smallest sum above 0 is one, and ages: at standstill the flux adds nothing and subtracts nothing. */
static void the_least_sum(void)
{
    uint64_t digest = DIGEST_START;
    for (int sum = 0; sum <= 2; sum++) {
        iqfoc_watch_t w;
        iqfoc_watch_reset(&w);
        w.blocks = 5;
        w.i[0] = IQ24(0.2);
        for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
            w.up_q16[n] = w.down_q16[n] = sum;
        }
        TEST_ASSERT_FALSE(iqfoc_watch_block(&w, &usual, 0, 0));
        TEST_ASSERT_EQUAL_INT32(sum > 0, w.xx_q6[IQFOC_WATCH_FLUX]);
        add_state(&digest, &w);
    }
    bits_golden(UINT64_C(0xa20efaa888eedf6b), digest);
}

/* The threshold is reached by the highest detector, not passed. */
static void the_threshold_itself(void)
{
    iqfoc_watch_config_t c = usual;
    iqfoc_watch_t before;
    iqfoc_watch_reset(&before);
    before.blocks = 5;
    before.i[0] = IQ24_ONE;
    before.up_q16[2] = 9 << 16;
    c.threshold_q16 = INT32_MAX;
    iqfoc_watch_t after = before;
    (void)iqfoc_watch_block(&after, &c, 0, 0);
    TEST_ASSERT_TRUE(after.up_q16[2] > 0 && after.naming == 0);
    for (int off = 0; off < 2; off++) {
        iqfoc_watch_t w = before;
        c.threshold_q16 = after.up_q16[2] + off;
        (void)iqfoc_watch_block(&w, &c, 0, 0);
        TEST_ASSERT_EQUAL_INT(off == 0 ? IQFOC_WATCH_NAMING : 0, w.naming);
    }
}

/* The largest block: currents of 8 and voltages of 16, whose squares saturate. */
static void the_largest_block(void)
{
    uint64_t seed = 9;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < 64; n++) {
        iqfoc_watch_config_t c;
        iqfoc_watch_t w;
        any_config(&seed, &c);
        iqfoc_watch_reset(&w);
        w.blocks = 2000;
        w.speed = n % 2 == 0 ? IQ24(0.1) : IQFOC_ROTOR_SPEED_MAX;
        any_detectors(&seed, &w, &c);
        any_sums(&seed, &w, 2.0, false);
        w.i[0] = (n & 2) != 0 ? IQ24(8.0) : IQ24(-8.0);
        w.i[1] = (n & 4) != 0 ? IQ24(8.0) : IQ24(-8.0);
        w.u[0] = (n & 8) != 0 ? IQ24(16.0) : IQ24(-16.0);
        w.u[1] = (n & 16) != 0 ? IQ24(16.0) : IQ24(-16.0);
        digest_add(&digest, iqfoc_watch_block(&w, &c, w.speed, n * IQ24(0.07)));
        add_state(&digest, &w);
        expect_begun(&w);
    }
    bits_golden(UINT64_C(0x0e7fd5df3d3c9873), digest);
}

/* An eccentricity is judged up to half a revolution in a block, to the last number. */
static void the_fastest_shaft(void)
{
    uint64_t seed = 11;
    uint64_t digest = DIGEST_START;
    for (int n = 56; n < 72; n++) {
        iqfoc_watch_config_t c;
        iqfoc_watch_t w;
        any_config(&seed, &c);
        iqfoc_watch_reset(&w);
        w.blocks = 2000;
        w.speed = IQ24_ONE / 64 + 1;
        any_detectors(&seed, &w, &c);
        any_sums(&seed, &w, 0.003, false);
        c.mechanical = IQ24_ONE - n;
        digest_add(&digest, iqfoc_watch_block(&w, &c, w.speed, 0));
        add_state(&digest, &w);
    }
    bits_golden(UINT64_C(0x733413e381a62f14), digest);
}

static void adaptation(void)
{
    uint64_t seed = 10;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < BLOCKS / 5; n++) {
        iqfoc_watch_config_t c;
        iqfoc_watch_t w;
        any_config(&seed, &c);
        if (n % 2 == 0) {
            c.size_q16[IQFOC_WATCH_RESISTANCE] = bits_random(&seed, 0, 3000);
            c.size_q16[IQFOC_WATCH_FLUX] = bits_random(&seed, 0, 30000);
        }
        iqfoc_watch_reset(&w);
        any_sums(&seed, &w, n % 5 == 0 ? 2.0 : 0.003, n % 7 == 0);
        w.blocks = 2;
        w.speed = random_iq24(&seed, -0.33, 0.33) / (n % 3 == 0 ? 1000 : 1);
        iqfoc_adapt_config_t config;
        config.gain = random_iq24(&seed, 0.0, 1.0);
        config.r_low = random_iq24(&seed, -0.5, 0.0);
        config.r_high = random_iq24(&seed, 0.0, 1.0);
        config.psi_low = random_iq24(&seed, -0.25, 0.0);
        config.psi_high = random_iq24(&seed, 0.0, 0.25);
        iqfoc_adapt_t a;
        a.r = bits_random(&seed, config.r_low, config.r_high);
        a.psi = bits_random(&seed, config.psi_low, config.psi_high);
        iqfoc_adapt_block(&a, &config, &w, &c, random_iq24(&seed, -0.4, 0.4) / (n % 3 == 0 ? 1000 : 1));
        digest_add(&digest, a.r);
        digest_add(&digest, a.psi);
        iqfoc_tuned_law_t law = {0};
        law.machine.rho_d_q30 = bits_random(&seed, 0, 1 << 30);
        law.machine.rho_q_q30 = bits_random(&seed, 0, 1 << 30);
        law.machine.k_psi_d_q27 = bits_random(&seed, 0, 1 << 30);
        law.machine.k_psi_q_q27 = bits_random(&seed, 0, 1 << 30);
        const iqfoc_tuned_law_t adapted = iqfoc_adapt_law(&law, &a);
        bits_add(&digest, &adapted.machine, sizeof adapted.machine);
    }
    bits_golden(UINT64_C(0x90b405fc7ddf483a), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(any_block);
    RUN_TEST(the_largest_block);
    RUN_TEST(the_fastest_shaft);
    RUN_TEST(adaptation);
    RUN_TEST(the_least_current_and_speed);
    RUN_TEST(the_least_sum);
    RUN_TEST(the_threshold_itself);
    return UNITY_END();
}
