/*
 * Self-commissioning to the last bit: its estimators on any blocks, and steps from any state of each phase, one hash for each over all results.
 * test_commission_phases.c checks them in double precision.
 */
#include "../../../src/commission_fit.h"
#include "../../../src/commission_phases.h"
#include "bits.h"
#include "hash.h"

#define N     IQFOC_COMMISSION_BLOCKS
#define DRAWS 20000

void setUp(void)
{
}

void tearDown(void)
{
}

static iqfoc_commission_value_t any_value(uint64_t *seed, iq24_t low, iq24_t high, iq24_t half)
{
    iqfoc_commission_value_t v;
    v.value = bits_random(seed, low, high);
    v.half = iq24_abs_sat(bits_small(seed, half));
    return v;
}

/* Drawn one after the other: the order does not depend on the compiler. */
static iqfoc_dq_t any_dq(uint64_t *seed, iq24_t limit)
{
    iqfoc_dq_t x;
    x.d = bits_small(seed, limit);
    x.q = bits_small(seed, limit);
    return x;
}

/* Blocks about a straight line, of any spread. */
static void any_blocks(uint64_t *seed, iq24_t x[N], iq24_t y[N])
{
    const iq24_t first = bits_random(seed, IQ24(0.01), IQ24(2.0));
    const iq24_t step = bits_small(seed, IQ24(0.1));
    const iq24_t slope = bits_small(seed, IQ24(1.5));
    const iq24_t zero = bits_small(seed, IQ24(0.3));
    const iq24_t noise = iq24_abs_sat(bits_small(seed, IQ24(0.5))) + 1;
    if (bits_random(seed, 0, 9) == 0) { /* so steep that the slope saturates */
        for (int32_t k = 0; k < N; k++) {
            x[k] = first + k / 8;
            y[k] = bits_random(seed, IQ24(-8.0), IQ24(8.0));
        }
        return;
    }
    for (int32_t k = 0; k < N; k++) {
        x[k] = first + step * (k / 8) + bits_random(seed, -noise, noise);
        y[k] = (iq24_t)bits_product(slope, x[k]) + zero + bits_random(seed, -noise, noise);
    }
}

static iqfoc_commission_result_t any_result(uint64_t *seed)
{
    iqfoc_commission_result_t r;
    memset(&r, 0, sizeof r);
    const iqfoc_abc_t half = bits_small_abc(seed, IQ24(0.1));
    r.i_offset_half.a = iq24_abs_sat(half.a);
    r.i_offset_half.b = iq24_abs_sat(half.b);
    r.i_offset_half.c = iq24_abs_sat(half.c);
    r.r = any_value(seed, 1, IQ24_ONE, IQ24(0.1));
    r.v_dead = any_value(seed, IQ24(-0.25), IQ24(0.25), IQ24(0.1));
    r.l_d = any_value(seed, IQ24(0.0625), IQ24(8.0), IQ24(0.1));
    r.l_q = any_value(seed, IQ24(0.0625), IQ24(8.0), IQ24(0.1));
    r.psi = any_value(seed, 0, IQ24(16.0), IQ24(0.1));
    return r;
}

static void add_value(uint64_t *digest, iqfoc_commission_value_t v)
{
    digest_add(digest, v.value);
    digest_add(digest, v.half);
}

static void test_estimators(void)
{
    uint64_t seed = 21;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS; n++) {
        iq24_t x[N];
        iq24_t y[N];
        any_blocks(&seed, x, y);
        const commission_line_t line = commission_line(x, y);
        add_value(&digest, line.at_zero);
        add_value(&digest, line.slope);
        add_value(&digest, commission_spread(y));
        const iqfoc_commission_result_t known = any_result(&seed);
        add_value(&digest, commission_inductance(&known, x, y, bits_random(&seed, 1, IQ24(4.0))));
        const iq24_t size = n % 2 == 0 ? IQ24(4.0) : IQ24(0.5);
        commission_means_t means;
        means.i = any_dq(&seed, size);
        means.u = any_dq(&seed, IQ24(2.0));
        const iq24_t phi_s1 = bits_random(&seed, IQ24(0.01), IQ24(0.8)) * (n % 4 < 2 ? 1 : -1);
        digest_add(&digest, commission_flux(&known, &means, phi_s1));
        digest_add(&digest, commission_flux_half(&known, &means, phi_s1));
        const iqfoc_dq_t sides = any_dq(&seed, IQ24(100.0));
        digest_add(&digest, commission_both(sides.d, sides.q));
        const iq24_t across = bits_small(&seed, IQ24(4.0));
        digest_add(&digest, commission_aligns(&known, across, bits_random(&seed, 1, IQ24(2.0))));
        digest_add(&digest, commission_mean(x));
        digest_add(&digest,
                   commission_block_mean(bits_small(&seed, IQ24(64.0)) * INT64_C(3), 1 + (uint32_t)n % 12));
    }
    bits_golden(UINT64_C(0xdbeea6a585552aac), digest);
}

static iqfoc_commission_config_t any_config(uint64_t *seed)
{
    iqfoc_commission_config_t c;
    memset(&c, 0, sizeof c);
    c.offset.settle = (uint32_t)bits_random(seed, 0, 3);
    c.offset.count_log2 = (uint32_t)bits_random(seed, 2, 4);
    c.offset.offset_max = IQ24(0.25);
    c.offset.noise_max = IQ24(0.125);
    c.start.i_align = bits_random(seed, IQ24(0.1), IQ24(2.0));
    c.start.ramp_cycles = (uint32_t)bits_random(seed, 1, 3);
    c.start.hold_cycles = (uint32_t)bits_random(seed, 1, 3);
    c.start.run_up_cycles = (uint32_t)bits_random(seed, 1, 3);
    c.start.speed_end = bits_random(seed, IQ24(0.004), IQ24(0.1));
    c.start.speed_end *= bits_random(seed, 0, 1) == 0 ? 1 : -1;
    c.i_max = IQ24(4.0);
    c.speed_max = IQFOC_ROTOR_SPEED_MAX;
    c.u_max = bits_random(seed, 1, IQ24(0.5));
    c.cycles_max = 2;
    c.settle_cycles = (uint32_t)bits_random(seed, 1, 3);
    c.block_log2 = (uint32_t)bits_random(seed, 6, 12);
    c.half_log2 = (uint32_t)bits_random(seed, 1, 2);
    c.share_r = bits_random(seed, 0, IQ24(0.25));
    c.share_l = bits_random(seed, 0, IQ24(0.25));
    c.share_psi = bits_random(seed, 0, IQ24(0.25));
    return c;
}

/* A phase whose block is about to end, and often its last one. */
static void any_state(uint64_t *seed, iqfoc_commission_t *c)
{
    const iqfoc_commission_config_t *const config = c->config;
    const int32_t phase = bits_random(seed, IQFOC_COMMISSION_SEEK_ALPHA, IQFOC_COMMISSION_SPIN);
    commission_enter(c, (iqfoc_commission_phase_t)phase, (uint32_t)bits_random(seed, 0, 1));
    const bool has_wave = c->phase >= IQFOC_COMMISSION_INDUCTANCE_D && c->phase <= IQFOC_COMMISSION_SHAFT;
    const uint32_t half_log2 = commission_half_log2(c);
    const uint32_t block_log2 = has_wave ? config->block_log2 - half_log2 - 1 : config->block_log2;
    c->offset.verdict = IQFOC_OFFSET_GOOD;
    c->offset.offset = bits_small_abc(seed, IQ24(0.1));
    c->start.stage = (iqfoc_start_stage_t)bits_random(seed, 0, IQFOC_START_OPEN_LOOP);
    c->start.theta = bits_small(seed, IQ24(0.5));
    c->start.speed = bits_small(seed, IQ24(0.1));
    c->start.i_ref = any_dq(seed, IQ24(2.0));
    c->result = any_result(seed);
    c->in_block = (UINT32_C(1) << block_log2) - 1;
    c->blocks = bits_random(seed, 0, 1) == 0 ? N - 1 : (uint32_t)bits_random(seed, 0, N - 2);
    c->blocks += has_wave && c->blocks == N - 1 ? 1 : 0;
    /* The last two cycles of a period, or any. */
    c->position = (UINT32_C(5) << half_log2 >> 1) - (uint32_t)bits_random(seed, 0, 1);
    c->position = bits_random(seed, 0, 2) == 0 ? (uint32_t)bits_random(seed, 1, 4 << half_log2) : c->position;
    c->amplitude = bits_random(seed, 1, config->u_max);
    c->amplitude = bits_random(seed, 0, 3) == 0 ? config->u_max : c->amplitude;
    c->bias = bits_small(seed, IQ24(0.3));
    c->half_u = bits_random(seed, 0, 1) == 0 ? 0 : bits_random(seed, 0, c->amplitude);
    c->half_d = c->half_u == 0 ? 0 : bits_random(seed, 1, IQ24(0.2));
    c->l_rough = bits_random(seed, IQ24(0.0625), IQ24(8.0));
    c->across = bits_small(seed, IQ24(0.5));
    c->u_dq = any_dq(seed, IQ24_ONE);
    any_blocks(seed, c->x, c->y);
    for (int k = 0; k < 4; k++) {
        c->sum[k] = (int64_t)bits_small(seed, IQ24(1.0)) * (INT64_C(1) << config->block_log2);
    }
    c->gains.kp_d = bits_random(seed, 0, IQ24(2.0));
    c->gains.kp_q = bits_random(seed, 0, IQ24(2.0));
    c->gains.ki_d = bits_random(seed, 0, IQ24(0.2));
    c->gains.ki_q = bits_random(seed, 0, IQ24(0.2));
    c->gains.anti_windup = bits_random(seed, 0, IQ24(0.5));
    c->control.integral_d = (int64_t)bits_small(seed, IQ24_ONE) * IQ24_ONE;
    c->control.integral_q = (int64_t)bits_small(seed, IQ24_ONE) * IQ24_ONE;
}

static void add_commission(uint64_t *digest, const iqfoc_commission_t *c, const iqfoc_command_t *command)
{
    const uint32_t counts[] = {(uint32_t)c->phase, (uint32_t)c->end, c->cycles,  c->wait,
                               c->in_block,        c->blocks,        c->position};
    bits_add(digest, &command->duties, sizeof command->duties);
    digest_add(digest, command->gates ? 1 : 0);
    bits_add(digest, counts, sizeof counts);
    bits_add(digest, &c->result, sizeof c->result);
    bits_add(digest, c->x, sizeof c->x);
    bits_add(digest, c->y, sizeof c->y);
    bits_add(digest, &c->gains, sizeof c->gains);
    bits_add(digest, &c->u_dq, sizeof c->u_dq);
    const iq24_t numbers[] = {c->amplitude, c->bias, c->half_u, c->half_d, c->l_rough, c->across};
    bits_add(digest, numbers, sizeof numbers);
    for (int k = 0; k < 4; k++) {
        bits_add64(digest, c->sum[k]);
    }
    bits_add64(digest, c->control.integral_d);
    bits_add64(digest, c->control.integral_q);
}

static void test_steps(void)
{
    uint64_t seed = 22;
    uint64_t digest = DIGEST_START;
    int reached[IQFOC_COMMISSION_SPIN + 1] = {0};
    for (int n = 0; n < 2 * DRAWS; n++) {
        const iqfoc_commission_config_t config = any_config(&seed);
        iqfoc_commission_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_commission_init(&c, &config));
        any_state(&seed, &c);
        const iqfoc_commission_phase_t phase = c.phase;
        for (int k = 0; k < 3; k++) {
            const iq24_t size = bits_random(&seed, 0, 1) == 0 ? IQ24(3.8) : IQ24(0.5);
            iqfoc_sample_t sample = {.i = bits_small_abc(&seed, size)};
            sample.theta = bits_random(&seed, INT32_MIN, INT32_MAX);
            sample.u_dc = bits_random(&seed, IQ24(0.5), IQ24(1.5));
            const iqfoc_command_t command = iqfoc_commission_step(&c, &sample);
            add_commission(&digest, &c, &command);
        }
        reached[phase] += c.phase != phase || c.end == IQFOC_COMMISSION_DONE;
    }
    for (int k = IQFOC_COMMISSION_SEEK_ALPHA; k <= IQFOC_COMMISSION_SPIN; k++) {
        printf("  phase %d ended %d times\n", k, reached[k]);
        TEST_ASSERT_TRUE(reached[k] > 100);
    }
    bits_golden(UINT64_C(0x774d87e2398df32a), digest);
}

static void test_offset(void)
{
    uint64_t seed = 23;
    uint64_t digest = DIGEST_START;
    for (int n = 0; n < DRAWS / 10; n++) {
        const iqfoc_commission_config_t config = any_config(&seed);
        iqfoc_commission_t c;
        TEST_ASSERT_EQUAL_INT(IQFOC_OK, iqfoc_commission_init(&c, &config));
        c.cycles = 0;
        const iq24_t noise = iq24_abs_sat(bits_small(&seed, IQ24(0.2)));
        while (c.phase == IQFOC_COMMISSION_OFFSET && c.end == IQFOC_COMMISSION_RUNNING) {
            const iqfoc_sample_t sample = {.i = bits_small_abc(&seed, noise), .u_dc = IQ24_ONE};
            const iqfoc_command_t command = iqfoc_commission_step(&c, &sample);
            c.cycles = 0;
            add_commission(&digest, &c, &command);
        }
    }
    bits_golden(UINT64_C(0xb3b5708533762255), digest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_estimators);
    RUN_TEST(test_steps);
    RUN_TEST(test_offset);
    return UNITY_END();
}
