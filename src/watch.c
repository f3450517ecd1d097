/* The watch on the drive's model: what is done once a block (include/iqfoc/watch.h). */
#include "iqfoc/watch.h"

#define HELD_BITS     24                 /* +-128 in Q16 */
#define ROUND_Q6      (INT64_C(1) << 25) /* half a unit, of Q32 */
#define MOST_Q16      (INT32_C(16384) << 16)
#define LEAST_CURRENT IQ24(0.15) /* below it no law says what the legs lose */

/* Two components in Q16. */
typedef struct pair {
    int32_t d, q;
} pair;

/* Range: |x| < 2^31 and the factor below 2^31 in 64 bits; held to +-128. */
static int32_t scaled(int64_t x, int32_t factor, uint32_t bits)
{
    const int64_t product = iq24_asr64(x * factor, bits);
    const int64_t most = INT64_C(1) << (HELD_BITS - 1);
    return (int32_t)(product > most ? most : product < -most ? -most : product);
}

static pair scaled_pair(iqfoc_dq_t x, int32_t factor, uint32_t bits)
{
    const pair p = {scaled(x.d, factor, bits), scaled(x.q, factor, bits)};
    return p;
}

/* x e^(j angle). Range: |x| <= 64. */
static iqfoc_dq_t turned(iqfoc_dq_t x, iq24_sincos_t sc)
{
    const iqfoc_dq_t y = {iq24_acc_round(iq24_acc_mac(iq24_acc_mul(x.d, sc.cos), x.q, -sc.sin)),
                          iq24_acc_round(iq24_acc_mac(iq24_acc_mul(x.q, sc.cos), x.d, sc.sin))};
    return y;
}

/* -j x v. */
static iqfoc_dq_t across(iqfoc_dq_t v, iq24_t turns)
{
    const iqfoc_dq_t y = {iq24_mul_round(turns, v.q), -iq24_mul_round(turns, v.d)};
    return y;
}

static iqfoc_dq_t opposite(iqfoc_dq_t v)
{
    const iqfoc_dq_t y = {-v.d, -v.q};
    return y;
}

static iq24_t length_of(iqfoc_dq_t i)
{
    return iq24_sqrt(iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(i.d, i.d), i.q, i.q)));
}

/* i/|i|. Range: |i| >= LEAST_CURRENT. */
static iqfoc_dq_t direction(iqfoc_dq_t i)
{
    const iq24_t length = length_of(i);
    const iqfoc_dq_t unit = {iq24_div(i.d, length), iq24_div(i.q, length)};
    return unit;
}

/* The block's error over its noise, in each of the three frames. */
typedef struct errors {
    pair rotor, back, stationary;
} errors;

/* A sum over 32 cycles in Q48 as a mean in IQ24. */
static iq24_t mean_of(int64_t sum)
{
    return iq24_sat(iq24_asr64(sum, IQ24_FRACTION_BITS + IQFOC_WATCH_BLOCK_BITS));
}

/*
 * One over the noise of a block's error, in that of a sample: Q16, at most 16. With E near 1 a sample is in the
 * errors of two cycles, in the second with the opposite sign and turned by phi: what is left of it is
 * |1 - e^(j phi)|^2 of its square in a mean of 32; at both ends of the block a sample stands alone, once more in
 * the block beside, in which the signature may have the other sign: 4/32^2 in all. The least is noise_least,
 * which has R T/L in it.
 */
static int32_t per_block_noise(const iqfoc_watch_config_t *config, iq24_sincos_t half)
{
    const iq24_t square =
        iq24_add_wrap(config->noise_least, iq24_asr32(iq24_mul_round(half.sin, half.sin), 3));
    return iq24_div(IQ24_ONE, iq24_sqrt(square)) >> 8;
}

/* A factor of the configuration times that, held to 2^31 - 1. */
static int32_t over_noise(int32_t factor, int32_t per_noise_q16)
{
    return iq24_sat(iq24_asr64((int64_t)factor * per_noise_q16, 16));
}

static errors errors_of(const iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_sincos_t half,
                        int32_t per_noise_q16)
{
    const int32_t factor_q8 = over_noise(config->per_noise_q8, per_noise_q16);
    const iq24_sincos_t half_back = {-half.sin, half.cos};
    const iqfoc_dq_t e = {mean_of(watch->alpha_cos + watch->beta_sin),
                          mean_of(watch->beta_cos - watch->alpha_sin)};
    const iqfoc_dq_t back = {mean_of(watch->alpha_cos - watch->beta_sin),
                             mean_of(watch->beta_cos + watch->alpha_sin)};
    const iqfoc_dq_t stationary = {iq24_asr32(watch->e_ab[0], IQFOC_WATCH_BLOCK_BITS),
                                   iq24_asr32(watch->e_ab[1], IQFOC_WATCH_BLOCK_BITS)};
    /* From the end of the cycle to its middle; what turns backwards is there the other way round. */
    const iqfoc_dq_t e_mid = turned(e, half);
    const iqfoc_dq_t in_flux = {iq24_mul_shift(e_mid.d, config->flux_d_q16, 16),
                                iq24_mul_shift(e_mid.q, config->flux_q_q16, 16)};
    const errors y = {scaled_pair(in_flux, factor_q8, 16),
                      scaled_pair(turned(back, half_back), factor_q8, 16),
                      scaled_pair(stationary, factor_q8, 16)};
    return y;
}

/* ---- One signature ---- */

static int32_t absolute(int32_t x)
{
    return x < 0 ? -x : x;
}

static int32_t held_sum(int64_t x)
{
    return (int32_t)(x < 0 ? 0 : x > MOST_Q16 ? MOST_Q16 : x);
}

/* Range: components within 128 in Q16 make products within 2^47 in Q32; 96 blocks of them 2^28 in Q6. */
static void follow(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, int32_t n, pair x, pair y)
{
    const int64_t xy_q32 = (int64_t)x.d * y.d + (int64_t)x.q * y.q;
    const int64_t xx_q32 = (int64_t)x.d * x.d + (int64_t)x.q * x.q;
    const int64_t xy = iq24_asr64(xy_q32, 16);
    const int64_t xx = iq24_asr64(xx_q32, 16);
    const int64_t cost =
        (xx >> 1) + iq24_asr64((int64_t)config->slack_q16[n < IQFOC_WATCH_SENSOR_GAIN ? 0 : 1] *
                                   (absolute(x.d) + absolute(x.q)),
                               16);
    watch->up_q16[n] = held_sum(watch->up_q16[n] + xy - cost);
    watch->down_q16[n] = held_sum(watch->down_q16[n] - xy - cost);
    if (watch->naming > 0) {
        watch->xy_q6[n] = iq24_sat(watch->xy_q6[n] + iq24_asr64(xy_q32 + ROUND_Q6, 26));
        watch->xx_q6[n] = iq24_sat(watch->xx_q6[n] + iq24_asr64(xx_q32 + ROUND_Q6, 26));
    } else {
        watch->xy_q6[n] = watch->up_q16[n] > 0 ? iq24_add_sat(watch->xy_q6[n], 1) : 0;
        watch->xx_q6[n] = watch->down_q16[n] > 0 ? iq24_add_sat(watch->xx_q6[n], 1) : 0;
    }
}

static void follow_all(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t turns)
{
    const iq24_sincos_t half = iq24_sincos(iq24_asr32(turns, 1));
    const iq24_sincos_t half_back = {-half.sin, half.cos};
    const int32_t per_noise = per_block_noise(config, half);
    const errors y = errors_of(watch, config, half, per_noise);
    const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
    const iqfoc_dq_t u_start = {watch->u[0], watch->u[1]};
    const iqfoc_dq_t u = turned(u_start, half_back);
    const iqfoc_dq_t along = {-turns, 0};
    const iqfoc_dq_t ahead = {0, -turns};
    const iqfoc_dq_t moved = across(i, turns);
    const iqfoc_dq_t of_rotor[IQFOC_WATCH_SENSOR_GAIN] = {
        opposite(i), moved, ahead, u, opposite(direction(i)), along, across(u, turns)};
    for (int32_t n = 0; n < IQFOC_WATCH_SENSOR_GAIN; n++) {
        follow(watch, config, n, scaled_pair(of_rotor[n], over_noise(config->size_q16[n], per_noise), 24),
               y.rotor);
    }
    const iqfoc_dq_t mirrored = {moved.d, -moved.q};
    const iqfoc_dq_t mirrored_ahead = {moved.q, moved.d};
    const int32_t gain = over_noise(config->size_q16[IQFOC_WATCH_SENSOR_GAIN], per_noise);
    const int32_t offset = over_noise(config->size_q16[IQFOC_WATCH_SENSOR_OFFSET], per_noise);
    const iqfoc_dq_t alpha = {IQ24_ONE, 0};
    const iqfoc_dq_t beta = {0, IQ24_ONE};
    follow(watch, config, 7, scaled_pair(mirrored, gain, 24), y.back);
    follow(watch, config, 8, scaled_pair(mirrored_ahead, gain, 24), y.back);
    follow(watch, config, 9, scaled_pair(alpha, offset, 24), y.stationary);
    follow(watch, config, 10, scaled_pair(beta, offset, 24), y.stationary);
}

/* ---- Alarm and name ---- */

/* (sum X y)/(sum |X|^2) in Q16: the change in stated sizes, held to 128. Range: xx is taken as 1 at least. */
static int32_t amount_of(const iqfoc_watch_t *watch, int32_t n)
{
    return iq24_asr32(iq24_div(watch->xy_q6[n], iq24_max(watch->xx_q6[n], 64)), 8);
}

static void look_for_alarm(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config)
{
    int32_t highest = 0;
    int32_t age = 0; /* of the detector that stands highest: blocks since it was at 0 */
    for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        age = watch->up_q16[n] > highest ? watch->xy_q6[n] : age;
        highest = watch->up_q16[n] > highest ? watch->up_q16[n] : highest;
        age = watch->down_q16[n] > highest ? watch->xx_q6[n] : age;
        highest = watch->down_q16[n] > highest ? watch->down_q16[n] : highest;
    }
    if (highest >= config->threshold_q16) {
        watch->since = watch->blocks - (uint32_t)age;
        watch->naming = config->naming_blocks;
        for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
            watch->xy_q6[n] = 0;
            watch->xx_q6[n] = 0;
        }
    }
}

/* (sum X y)^2/(sum |X|^2): what the signature takes off the errors' squares. */
static int64_t explained(const iqfoc_watch_t *watch, int32_t n)
{
    return iq24_asr64((int64_t)watch->xy_q6[n] * amount_of(watch, n), 16);
}

/* The length of two amounts in Q16. Range: within 128 in IQ24 each, so that the squares' sum is at most 32768 less a rounding; the root saturates. */
static int32_t amount_of_both(const iqfoc_watch_t *watch, int32_t n)
{
    const iq24_t a = iq24_sat((int64_t)amount_of(watch, n) * 256);
    const iq24_t b = iq24_sat((int64_t)amount_of(watch, n + 1) * 256);
    return iq24_asr32(iq24_sqrt(iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(a, a), b, b))), 8);
}

/*
 * How far out of the noise a signature stands, over 256: the root of what it takes off the errors' squares, less
 * what the slack may have brought about. Range: sums of 1024 blocks saturate, so that explained is below 2^37 in
 * Q6; over 2^16 in IQ24 that saturates at 128.
 */
static iq24_t score_of(const iqfoc_watch_config_t *config, int64_t explained_q6, int32_t slack_q16)
{
    const iq24_t blocks = iq24_sqrt(config->naming_blocks * 256);
    return iq24_sub_wrap(iq24_sqrt(iq24_sat(explained_q6 * 4)), iq24_mul_shift(slack_q16, blocks, 16));
}

static void name(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config)
{
    iq24_t best = IQ24_MIN;
    for (int32_t n = 0; n < IQFOC_WATCH_SENSOR_GAIN; n++) {
        const iq24_t score = score_of(config, explained(watch, n), config->slack_q16[0]);
        if (score > best) {
            best = score;
            watch->group = (iqfoc_watch_group_t)n;
            watch->amount_q16 = amount_of(watch, n);
        }
    }
    for (int32_t n = IQFOC_WATCH_SENSOR_GAIN; n < IQFOC_WATCH_SIGNATURES; n += 2) {
        const iq24_t score =
            score_of(config, explained(watch, n) + explained(watch, n + 1), config->slack_q16[1]);
        if (score > best) {
            best = score;
            watch->group = n == IQFOC_WATCH_SENSOR_GAIN ? IQFOC_WATCH_SENSOR_GAIN : IQFOC_WATCH_SENSOR_OFFSET;
            watch->amount_q16 = amount_of_both(watch, n);
        }
    }
}

static void begin_block(iqfoc_watch_t *watch)
{
    watch->alpha_cos = watch->alpha_sin = watch->beta_cos = watch->beta_sin = 0;
    watch->e_ab[0] = watch->e_ab[1] = watch->i[0] = watch->i[1] = watch->u[0] = watch->u[1] = 0;
    watch->count = 0;
}

/* True if the naming has ended with this block. */
static bool judge(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t turns)
{
    const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
    const bool alarmed = watch->naming > 0;
    if (length_of(i) < LEAST_CURRENT) {
        return false;
    }
    follow_all(watch, config, iq24_clamp(turns, -IQFOC_ROTOR_TURNS_MAX, IQFOC_ROTOR_TURNS_MAX));
    if (!alarmed) {
        look_for_alarm(watch, config);
        return false;
    }
    watch->naming--;
    if (watch->naming == 0) {
        name(watch, config);
        return true;
    }
    return false;
}

bool iqfoc_watch_block(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t turns)
{
    bool named = false;
    watch->blocks++;
    if (watch->group == IQFOC_WATCH_NONE) {
        named = judge(watch, config, turns);
    }
    begin_block(watch);
    return named;
}
