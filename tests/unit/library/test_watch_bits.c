/*
 * A block of the change detector to the last bit: src/watch.c's steps in integers, each product rounded as in the
 * library, from any state of the detectors. test_watch.c checks their behaviour.
 */
#include "bits.h"

#include "iqfoc/transform.h"
#include "iqfoc/watch.h"

#include <stdbool.h>

#define BLOCKS (150000 / IQFOC_TEST_STRIDE)

void setUp(void)
{
}

void tearDown(void)
{
}

static const iqfoc_watch_config_t usual =
    IQFOC_WATCH_CONFIG(0.9, 0.008, 0.011, 0.2, 3, 1.25e-4, 6.0 * 1.4142135623730951, 565.0, 0.003);

typedef struct pair {
    int64_t d, q;
} pair;

static int64_t larger(int64_t x, int64_t y)
{
    return x > y ? x : y;
}

static int64_t size(int64_t x)
{
    return x < 0 ? -x : x;
}

static int64_t saturated(int64_t x)
{
    return bits_held(x, INT32_MIN, INT32_MAX);
}

static iq24_sincos_t at(int64_t turns)
{
    return iq24_sincos(iq24_wrap(turns));
}

/* x e^(j angle). */
static pair turned(pair x, iq24_sincos_t sc)
{
    const pair y = {bits_nearest(x.d * sc.cos - x.q * sc.sin, 24),
                    bits_nearest(x.q * sc.cos + x.d * sc.sin, 24)};
    return y;
}

static iq24_sincos_t back(iq24_sincos_t sc)
{
    const iq24_sincos_t other = {-sc.sin, sc.cos};
    return other;
}

/* x factor/2^bits down, held to +-128 in Q16. */
static pair scaled(pair x, int64_t factor, int bits)
{
    const int64_t most = INT64_C(1) << 23;
    const int64_t by = INT64_C(1) << bits;
    const pair p = {bits_held(bits_floor(x.d * factor, by), -most, most),
                    bits_held(bits_floor(x.q * factor, by), -most, most)};
    return p;
}

static int64_t over_noise(int64_t factor, int64_t per_noise)
{
    return saturated(bits_floor(factor * per_noise, 65536));
}

static int64_t block_noise(const iqfoc_watch_config_t *c, iq24_sincos_t half, int64_t ends, int64_t inside)
{
    const int64_t away = bits_floor(bits_product(half.sin, half.sin), 8);
    const int64_t square = bits_product(c->noise_least, ends) + bits_product(away, inside);
    return iq24_div(IQ24_ONE, iq24_sqrt((iq24_t)square)) / 256;
}

/* A frame that turns `times` as fast against the rotor's. */
typedef struct frame {
    bool seen;
    int64_t share, left, middle, per_noise;
} frame;

static frame frame_of(const iqfoc_watch_config_t *c, iq24_sincos_t half, int64_t turns, int64_t middle,
                      int times)
{
    frame f = {false, 0, 0, times * middle, 0};
    const int64_t relative = times * turns;
    f.seen = size(relative) >= to_iq24(0.0044);
    if (f.seen) {
        const iq24_sincos_t one = at(bits_floor(relative, 2));
        const iq24_sincos_t block = at(16 * relative);
        f.share = iq24_div(block.sin, 32 * one.sin);
        const int64_t square = bits_product(f.share, f.share);
        f.left = IQ24_ONE - square;
        const int64_t ends = IQ24_ONE + square - 2 * bits_product(f.share, block.cos);
        f.per_noise = block_noise(c, half, larger(ends, f.left), times == 1 ? square : IQ24_ONE + 3 * square);
    }
    return f;
}

/* The error of another frame less what the rotor's frame's error e is there. */
static pair without(pair error, pair e, const frame *f)
{
    const pair seen = turned(e, at(f->middle));
    const pair rest = {saturated(error.d - bits_product(f->share, seen.d)),
                       saturated(error.q - bits_product(f->share, seen.q))};
    return rest;
}

static int64_t mean_of(int64_t sum)
{
    return saturated(bits_floor(sum, INT64_C(1) << 29));
}

static bool is_sure(const iqfoc_watch_config_t *c)
{
    return (c->unsure_q16[0] | c->unsure_q16[1] | c->unsure_q16[2]) == 0;
}

/* With a confidence: what a change of 2.5 sizes moves less the slack, within a 64th and the whole. */
static int64_t laid_of(const iqfoc_watch_config_t *c, int64_t x, int64_t slack)
{
    const int64_t laid = bits_held(bits_floor(5 * size(x), 2) - slack, bits_floor(size(x), 64), size(x));
    return is_sure(c) ? x : x < 0 ? -laid : laid;
}

static void follow(iqfoc_watch_t *w, const iqfoc_watch_config_t *c, int n, pair x, pair y, pair slack)
{
    const pair laid = {laid_of(c, x.d, slack.d), laid_of(c, x.q, slack.q)};
    const int64_t four = INT64_C(4) << 16;
    const int64_t highest = INT64_C(16384) << 16;
    const int64_t xy = x.d * y.d + x.q * y.q;
    const int64_t xx = x.d * x.d + x.q * x.q;
    const int64_t cost = bits_floor(bits_floor(laid.d * laid.d + laid.q * laid.q, 65536), 2) +
                         bits_floor(slack.d * size(laid.d) + slack.q * size(laid.q), 65536);
    const int64_t ratio = bits_floor(laid.d * y.d + laid.q * y.q, 65536);
    const int64_t up = ratio - cost < four ? ratio - cost : four;
    const int64_t down = -ratio - cost < four ? -ratio - cost : four;
    w->up_q16[n] = (int32_t)bits_held(w->up_q16[n] + up, 0, highest);
    w->down_q16[n] = (int32_t)bits_held(w->down_q16[n] + down, 0, highest);
    if (w->naming > 0) {
        w->xy_q6[n] = (int32_t)saturated(w->xy_q6[n] + bits_nearest(xy, 26));
        w->xx_q6[n] = (int32_t)saturated(w->xx_q6[n] + bits_nearest(xx, 26));
    } else {
        w->xy_q6[n] = w->up_q16[n] > 0 ? (int32_t)saturated((int64_t)w->xy_q6[n] + 1) : 0;
        w->xx_q6[n] = w->down_q16[n] > 0 ? (int32_t)saturated((int64_t)w->xx_q6[n] + 1) : 0;
    }
}

static pair i_of(const iqfoc_watch_t *w)
{
    const pair i = {w->i[0], w->i[1]};
    return i;
}

static int64_t length_of(pair i)
{
    return iq24_sqrt((iq24_t)saturated(bits_nearest(i.d * i.d + i.q * i.q, 24)));
}

/* -j x v. */
static pair across(pair v, int64_t turns)
{
    const pair p = {bits_product(turns, v.q), -bits_product(turns, v.d)};
    return p;
}

/* What the model's confidence leaves in each axis, of resistance, inductance and flux; with 256 nothing is noted. */
static pair unsure(const iqfoc_watch_config_t *c, const pair *signature, int64_t per_noise, int64_t always)
{
    const int64_t most = INT64_C(256) << 16;
    pair sum = {0, 0};
    for (int n = 0; n < IQFOC_WATCH_UNSURE; n++) {
        const int64_t each = over_noise(c->size_q16[n], per_noise);
        sum.d += bits_floor(bits_floor(size(signature[n].d) * each, IQ24_ONE) * c->unsure_q16[n], 65536);
        sum.q += bits_floor(bits_floor(size(signature[n].q) * each, IQ24_ONE) * c->unsure_q16[n], 65536);
    }
    const pair slack = {always + (sum.d < most ? sum.d : most), always + (sum.q < most ? sum.q : most)};
    return slack;
}

/* In the other frames: of half the change of the speed, all of it in either axis. */
static pair unsure_elsewhere(const iqfoc_watch_t *w, const iqfoc_watch_config_t *c, int64_t change,
                             int64_t per_noise)
{
    const pair i = i_of(w);
    const pair moves[3] = {{0, 0}, across(i, bits_floor(change, 2)), {0, -bits_floor(change, 2)}};
    const pair axes = unsure(c, moves, per_noise, 0);
    const pair both = {c->slack_q16[1] + axes.d + axes.q, c->slack_q16[1] + axes.d + axes.q};
    return both;
}

static void follow_all(iqfoc_watch_t *w, const iqfoc_watch_config_t *c, int64_t at_end, int64_t theta)
{
    const int64_t change = at_end - w->turns;
    const int64_t turns = at_end - bits_floor(change, 2);
    const int64_t back_to =
        15 * at_end + bits_floor(at_end, 2) - bits_product(to_iq24(162.75 / 32.0), change);
    const int64_t middle = iq24_wrap(theta - back_to);
    const iq24_sincos_t half = at(bits_floor(turns, 2));
    const int64_t per_noise = block_noise(c, half, IQ24_ONE, IQ24_ONE);
    const frame still = frame_of(c, half, turns, middle, 1);
    const frame backward = frame_of(c, half, turns, middle, 2);
    const pair e = {mean_of(w->alpha_cos + w->beta_sin), mean_of(w->beta_cos - w->alpha_sin)};
    const pair mirror = {mean_of(w->alpha_cos - w->beta_sin), mean_of(w->beta_cos + w->alpha_sin)};
    const pair standing = {bits_floor(w->e_ab[0], 32), bits_floor(w->e_ab[1], 32)};
    const pair e_mid = turned(e, half);
    const pair in_flux = {bits_product_of(e_mid.d, c->flux_d_q16, 16),
                          bits_product_of(e_mid.q, c->flux_q_q16, 16)};
    const pair y_rotor = scaled(in_flux, over_noise(c->per_noise_q8, per_noise), 16);
    const pair y_back = scaled(turned(without(mirror, e, &backward), back(half)),
                               over_noise(c->per_noise_q8, backward.per_noise), 16);
    const pair y_still =
        scaled(without(standing, e, &still), over_noise(c->per_noise_q8, still.per_noise), 16);

    const pair i = i_of(w);
    const pair u_start = {w->u[0], w->u[1]};
    const pair u = turned(u_start, back(half));
    const int64_t length = length_of(i);
    const pair of_rotor[7] = {
        {-i.d, -i.q},
        across(i, turns),
        {0, -turns},
        u,
        {-iq24_div((iq24_t)i.d, (iq24_t)length), -iq24_div((iq24_t)i.q, (iq24_t)length)},
        {-turns, 0},
        across(u, turns)};
    const pair slack = unsure(c, of_rotor, per_noise, c->slack_q16[0]);
    for (int n = 0; n < 7; n++) {
        follow(w, c, n, scaled(of_rotor[n], over_noise(c->size_q16[n], per_noise), 24), y_rotor, slack);
    }
    /* The eccentricity, while a block covers half a revolution at most. */
    const int64_t z = bits_product(c->mechanical, 32 * size(turns));
    if (c->mechanical != 0 && z <= IQ24_ONE / 2) {
        const int64_t pi_z = bits_product(to_iq24(acos(-1.0)), z);
        const int64_t share = z < IQ24_ONE / 64 ? IQ24_ONE : iq24_div(at(bits_floor(z, 2)).sin, (iq24_t)pi_z);
        const int64_t lag = -bits_product(turns, share);
        const iq24_sincos_t shaft = at(w->mechanical - bits_product(back_to, c->mechanical));
        const pair of_shaft[2] = {{0, bits_product(lag, shaft.cos)}, {0, bits_product(lag, shaft.sin)}};
        const int64_t each = over_noise(c->size_q16[IQFOC_WATCH_ECCENTRICITY], per_noise);
        const pair x[2] = {scaled(of_shaft[0], each, 24), scaled(of_shaft[1], each, 24)};
        follow(w, c, 13, x[0], y_rotor, slack);
        follow(w, c, 14, x[1], y_rotor, slack);
        w->across_q6 =
            (int32_t)saturated(w->across_q6 + (w->naming > 0 ? bits_nearest(x[0].q * x[1].q, 26) : 0));
    }
    if (backward.seen) {
        const pair moved = across(i, turns);
        const pair mirrored[2] = {{moved.d, -moved.q}, {moved.q, moved.d}};
        const int64_t gain =
            over_noise(c->size_q16[IQFOC_WATCH_SENSOR_GAIN], bits_product(backward.per_noise, backward.left));
        const pair there = unsure_elsewhere(w, c, change, backward.per_noise);
        follow(w, c, 7, scaled(mirrored[0], gain, 24), y_back, there);
        follow(w, c, 8, scaled(mirrored[1], gain, 24), y_back, there);
        const pair phase[2] = {{-i.d, i.q}, {-i.q, -i.d}};
        const int64_t dropped = over_noise(c->size_q16[IQFOC_WATCH_PHASE_RESISTANCE],
                                           bits_product(backward.per_noise, backward.left));
        follow(w, c, 11, scaled(phase[0], dropped, 24), y_back, there);
        follow(w, c, 12, scaled(phase[1], dropped, 24), y_back, there);
    }
    if (still.seen) {
        const pair axis[2] = {{IQ24_ONE, 0}, {0, IQ24_ONE}};
        const int64_t offset =
            over_noise(c->size_q16[IQFOC_WATCH_SENSOR_OFFSET], bits_product(still.per_noise, still.left));
        const pair there = unsure_elsewhere(w, c, change, still.per_noise);
        follow(w, c, 9, scaled(axis[0], offset, 24), y_still, there);
        follow(w, c, 10, scaled(axis[1], offset, 24), y_still, there);
    }
}

/* The highest detector; of two equal ones the first. Its age says when the change began. */
static void look(iqfoc_watch_t *w, const iqfoc_watch_config_t *c)
{
    int32_t highest = 0;
    int32_t age = 0;
    for (int k = 0; k < 2 * IQFOC_WATCH_SIGNATURES; k++) {
        const int32_t level = k % 2 == 0 ? w->up_q16[k / 2] : w->down_q16[k / 2];
        if (level > highest) {
            highest = level;
            age = k % 2 == 0 ? w->xy_q6[k / 2] : w->xx_q6[k / 2];
        }
    }
    if (highest >= c->threshold_q16) {
        w->since = w->blocks - (uint32_t)age;
        w->naming = (int16_t)c->naming_blocks;
        for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
            w->xy_q6[n] = w->xx_q6[n] = 0;
        }
        w->across_q6 = 0;
    }
}

static int64_t amount_of(const iqfoc_watch_t *w, int n)
{
    return bits_floor(iq24_div(w->xy_q6[n], w->xx_q6[n] > 64 ? w->xx_q6[n] : 64), 256);
}

/* xx: the sum of |X|^2 that it counts with. */
static int64_t explained(const iqfoc_watch_t *w, int n, int64_t xx)
{
    const int64_t amount = bits_floor(iq24_div(w->xy_q6[n], (iq24_t)larger(xx, 64)), 256);
    return bits_floor(w->xy_q6[n] * amount, 65536);
}

/* Of an eccentricity both count with the bound of the larger eigenvalue. */
static int64_t explained_of(const iqfoc_watch_t *w, int g, int n)
{
    const int64_t a = w->xx_q6[n];
    if (g < IQFOC_WATCH_SENSOR_GAIN) {
        return explained(w, n, a);
    }
    const int64_t b = w->xx_q6[n + 1];
    const int64_t across = saturated(size(w->across_q6));
    const int64_t bound = saturated(bits_floor(a + b + size(a - b) + 2 * across, 2));
    return g == IQFOC_WATCH_ECCENTRICITY ? explained(w, n, bound) + explained(w, n + 1, bound)
                                         : explained(w, n, a) + explained(w, n + 1, b);
}

static void name(iqfoc_watch_t *w, const iqfoc_watch_config_t *c)
{
    const int64_t root = iq24_sqrt(c->naming_blocks * 256);
    int64_t best = INT64_MIN;
    /* With an initial uncertainty: not the other frames' groups if the highest detector, of two equal ones too, is of the rotor's. */
    int64_t rotor = 0;
    int64_t other = 0;
    for (int k = 0; k < 2 * IQFOC_WATCH_SIGNATURES; k++) {
        int64_t *const frame_of_it = k / 2 < IQFOC_WATCH_SENSOR_GAIN || k / 2 >= 13 ? &rotor : &other;
        *frame_of_it = larger(*frame_of_it, k % 2 == 0 ? w->up_q16[k / 2] : w->down_q16[k / 2]);
    }
    for (int g = 0; g < IQFOC_WATCH_GROUPS; g++) {
        const bool single = g < IQFOC_WATCH_SENSOR_GAIN;
        const bool of_rotor = single || g == IQFOC_WATCH_ECCENTRICITY;
        if (!is_sure(c) && !of_rotor && rotor > 0 && rotor >= other) {
            continue;
        }
        const int n = single ? g : IQFOC_WATCH_SENSOR_GAIN + 2 * (g - IQFOC_WATCH_SENSOR_GAIN);
        const int64_t off = explained_of(w, g, n);
        const int64_t score =
            iq24_sqrt((iq24_t)saturated(4 * off)) - bits_product_of(c->slack_q16[of_rotor ? 0 : 1], root, 16);
        if (score > best) {
            const int64_t a = saturated(256 * amount_of(w, n));
            const int64_t b = single ? 0 : saturated(256 * amount_of(w, n + 1));
            const int64_t both = iq24_sqrt((iq24_t)saturated(bits_nearest(a * a + b * b, 24)));
            best = score;
            w->group = (iqfoc_watch_group_t)g;
            w->amount_q16 = (int32_t)(single ? amount_of(w, n) : bits_floor(both, 256));
        }
    }
}

static bool block(iqfoc_watch_t *w, const iqfoc_watch_config_t *c, iq24_t turns, iq24_t theta)
{
    const iq24_t held = (iq24_t)bits_held(turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX);
    bool named = false;
    /* The shaft: the angle that has passed, with the whole turns that the speed gives. */
    const int64_t mean = held - bits_floor(held - w->turns, 2);
    const int64_t rest = iq24_wrap(theta - (int64_t)w->theta - 32 * mean + IQ24_ONE / 2) & (IQ24_ONE - 1);
    const int64_t passed = 32 * mean + rest - IQ24_ONE / 2;
    w->mechanical = iq24_wrap(w->mechanical + bits_product(passed, c->mechanical));
    w->theta = theta;
    w->blocks++;
    if (w->group == IQFOC_WATCH_NONE && w->blocks > 1 && length_of(i_of(w)) >= to_iq24(0.15)) {
        const bool alarmed = w->naming > 0;
        follow_all(w, c, held, theta);
        if (!alarmed) {
            look(w, c);
        } else if (--w->naming == 0) {
            name(w, c);
            named = true;
        }
    }
    w->turns = held;
    w->alpha_cos = w->alpha_sin = w->beta_cos = w->beta_sin = 0;
    for (int k = 0; k < 2; k++) {
        w->e_ab[k] = w->i[k] = w->u[k] = 0;
    }
    w->count = 0;
    return named;
}

/* ---- Any block, at any state ---- */

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

static void expect_same(const iqfoc_watch_t *want, const iqfoc_watch_t *got)
{
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->up_q16, got->up_q16, IQFOC_WATCH_SIGNATURES);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->down_q16, got->down_q16, IQFOC_WATCH_SIGNATURES);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->xy_q6, got->xy_q6, IQFOC_WATCH_SIGNATURES);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->xx_q6, got->xx_q6, IQFOC_WATCH_SIGNATURES);
    TEST_ASSERT_EQUAL_INT(want->naming, got->naming);
    TEST_ASSERT_EQUAL_UINT32(want->since, got->since);
    TEST_ASSERT_EQUAL_UINT32(want->blocks, got->blocks);
    TEST_ASSERT_EQUAL_INT(want->group, got->group);
    TEST_ASSERT_EQUAL_INT32(want->amount_q16, got->amount_q16);
    TEST_ASSERT_EQUAL_INT32(want->turns, got->turns);
    TEST_ASSERT_EQUAL_INT32(want->theta, got->theta);
    TEST_ASSERT_EQUAL_INT32(want->mechanical, got->mechanical);
    TEST_ASSERT_EQUAL_INT32(want->across_q6, got->across_q6);
    TEST_ASSERT_EQUAL_INT(0, got->count);
    TEST_ASSERT_TRUE((got->alpha_cos | got->alpha_sin | got->beta_cos | got->beta_sin) == 0);
    TEST_ASSERT_EQUAL_INT32(0, got->e_ab[0] | got->e_ab[1] | got->i[0] | got->i[1] | got->u[0] | got->u[1]);
}

static void any_block(void)
{
    uint64_t seed = 1;
    for (int n = 0; n < BLOCKS; n++) {
        iqfoc_watch_config_t c;
        iqfoc_watch_t want;
        any_config(&seed, &c);
        iqfoc_watch_reset(&want);
        const double fast = n % 3 == 0 ? 0.003 : n % 3 == 1 ? 0.05 : 0.33;
        want.turns = random_iq24(&seed, -fast, fast);
        want.blocks = n % 40 == 0 ? 0 : (uint32_t)bits_random(&seed, 1000, 2000); /* more than any age */
        want.naming = (int16_t)(n % 2 == 0 ? 0 : bits_random(&seed, 1, n % 4 == 1 ? 1 : 5));
        want.group = n % 50 == 0 ? IQFOC_WATCH_FLUX : IQFOC_WATCH_NONE;
        any_detectors(&seed, &want, &c);
        any_sums(&seed, &want, n % 5 == 0 ? 2.0 : 0.003, n % 23 == 0);
        iqfoc_watch_t got = want;
        const iq24_t turns =
            n % 7 == 0 ? random_iq24(&seed, -1.0, 1.0) : want.turns + random_iq24(&seed, -0.001, 0.001);
        const iq24_t theta = bits_random(&seed, INT32_MIN, INT32_MAX);
        const bool named = block(&want, &c, turns, theta);
        TEST_ASSERT_EQUAL(named, iqfoc_watch_block(&got, &c, turns, theta));
        expect_same(&want, &got);
    }
}

/* A current of just 0.15 is judged, and one LSB less is not; so with the least speed of the other frames. */
static void the_least_current_and_speed(void)
{
    for (int n = 0; n < 6; n++) {
        const int off = n % 3 - 1;
        const bool of_speed = n >= 3;
        iqfoc_watch_t want;
        iqfoc_watch_reset(&want);
        want.blocks = 5;
        want.i[0] = of_speed ? IQ24(0.3) : IQ24(0.15) + off;
        want.alpha_cos = INT64_C(1) << 44;
        want.e_ab[0] = IQ24(0.2);
        want.turns = IQ24(0.0044) + (of_speed ? off : 1);
        iqfoc_watch_t got = want;
        const iq24_t turns = want.turns;
        TEST_ASSERT_FALSE(block(&want, &usual, turns, 0));
        TEST_ASSERT_FALSE(iqfoc_watch_block(&got, &usual, turns, 0));
        expect_same(&want, &got);
    }
}

/* The smallest sum above 0 is one, and ages: at standstill the flux adds nothing and subtracts nothing. */
static void the_least_sum(void)
{
    for (int sum = 0; sum <= 2; sum++) {
        iqfoc_watch_t want;
        iqfoc_watch_reset(&want);
        want.blocks = 5;
        want.i[0] = IQ24(0.2);
        for (int n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
            want.up_q16[n] = want.down_q16[n] = sum;
        }
        iqfoc_watch_t got = want;
        TEST_ASSERT_FALSE(block(&want, &usual, 0, 0));
        TEST_ASSERT_FALSE(iqfoc_watch_block(&got, &usual, 0, 0));
        TEST_ASSERT_EQUAL_INT32(sum > 0, got.xx_q6[IQFOC_WATCH_FLUX]);
        expect_same(&want, &got);
    }
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(any_block);
    RUN_TEST(the_least_current_and_speed);
    RUN_TEST(the_least_sum);
    RUN_TEST(the_threshold_itself);
    return UNITY_END();
}
