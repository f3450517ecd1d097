/* The change detector of the drive's model: its step per block (include/iqfoc/watch.h). */
#include "iqfoc/watch.h"

#include "angle.h"

#define HELD_BITS 24                 /* +-128 in Q16 */
#define ROUND_Q6  (INT64_C(1) << 25) /* half a unit, of Q32 */
#define MOST_Q16  (INT32_C(16384) << 16)
/* Largest growth of a sum in one block: an alarm takes six blocks at least. */
#define MOST_A_BLOCK_Q16 (INT32_C(4) << 16)
#define LEAST_CURRENT    IQ24(0.15) /* below it the loss of the legs has no model */
#define ECCENTRICITY     13         /* the first of its two signatures */

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
static iqfoc_dq_t across(iqfoc_dq_t v, iq24_t speed)
{
    const iqfoc_dq_t y = {iq24_mul_round(speed, v.q), -iq24_mul_round(speed, v.d)};
    return y;
}

static iqfoc_dq_t opposite(iqfoc_dq_t v)
{
    const iqfoc_dq_t y = {iq24_sub_wrap(0, v.d), iq24_sub_wrap(0, v.q)};
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
 * 1 over the noise of a block's error, as a multiple of the noise of one sample: Q16, at most 37. With E near 1 a
 * sample is in the errors of two cycles, in the second one with the opposite sign and turned by phi. It leaves |1 -
 * e^(j phi)|^2 of its square in a mean of 32. At each end of the block a sample counts alone. It counts again in the
 * adjacent block, in which the signature may have the other sign: 4/32^2 in all. The minimum is noise_least, which
 * contains R T/L. ends, inside: factors of the frame's window on the two terms.
 */
static int32_t per_block_noise(const iqfoc_watch_config_t *config, iq24_sincos_t half, iq24_t ends,
                               iq24_t inside)
{
    const iq24_t turned_away = iq24_asr32(iq24_mul_round(half.sin, half.sin), 3);
    const iq24_t square =
        iq24_add_wrap(iq24_mul_round(config->noise_least, ends), iq24_mul_round(turned_away, inside));
    const iq24_t inverse = iq24_div(IQ24_ONE, iq24_sqrt(square));
    /*@ assert watch_noise: inverse >= 0; */
    return inverse >> 8;
}

/*
 * A frame that turns against the rotor's: the stationary one, and the one that turns backwards.
 *
 * An error e that is constant in the rotor's frame appears here as s e^(j a) e in the block's mean. s is the mean of
 * the angle's unit vectors and a the angle at the block's middle. That term is subtracted, so that no error of the
 * rotor's frame is seen here, however slow the rotor. An error that is constant in this frame keeps 1 - s^2. The
 * window of the sum is then 1 - s e^(j ...), from which the noise follows.
 */
typedef struct frame {
    bool seen;         /* the block turns far enough: 1 - s^2 > 1/16 */
    iq24_t share;      /* s */
    iq24_t left;       /* 1 - s^2 */
    iq24_t middle;     /* a in turns */
    int32_t per_noise; /* Q16 */
} frame;

/* At this speed, s^2 = 15/16. */
#define LEAST_TURNS IQ24(0.0044)

/*
 * times: 1 for the stationary frame, 2 for the backward one, in which the samples at both ends of a cycle are
 * turned apart as well. speed: mean of the block, |speed| <= 1/3.
 *
 * Range: sin(relative angle/2) is above 0.0138, times 32 above 0.44 and within 32. |s| < 0.97; ends within 0.18
 * ... 4, inside within 4.
 */
static frame frame_of(const iqfoc_watch_config_t *config, iq24_sincos_t half, iq24_t speed, iq24_t middle,
                      int32_t times)
{
    frame f = {false, 0, 0, iq24_wrap((int64_t)times * middle), 0};
    const iq24_t relative = times * speed;
    f.seen = iq24_max(relative, -relative) >= LEAST_TURNS;
    if (f.seen) {
        const iq24_sincos_t half_relative = iq24_sincos(iq24_asr32(relative, 1));
        const iq24_sincos_t half_block =
            iq24_sincos(iq24_wrap((int64_t)relative * (IQFOC_WATCH_BLOCK_CYCLES / 2)));
        f.share = iq24_div(half_block.sin, IQFOC_WATCH_BLOCK_CYCLES * half_relative.sin);
        /*@ assert watch_share: -16777216 <= f.share <= 16777216; */
        const iq24_t square = iq24_mul_round(f.share, f.share);
        f.left = iq24_sub_wrap(IQ24_ONE, square);
        /* |1 - s e^(j block/2)|^2 at the ends; on average |1 + s e^(j ...)|^2 or s^2 between neighbours. */
        const iq24_t ends =
            iq24_sub_wrap(iq24_add_wrap(IQ24_ONE, square), 2 * iq24_mul_round(f.share, half_block.cos));
        const iq24_t inside = times == 1 ? square : iq24_add_wrap(IQ24_ONE, 3 * square);
        f.per_noise = per_block_noise(config, half, iq24_max(ends, f.left), inside);
    }
    return f;
}

/* A factor of the configuration times 1 over the noise, held to 2^31 - 1. */
static int32_t over_noise(int32_t factor, int32_t per_noise_q16)
{
    return iq24_sat(iq24_asr64((int64_t)factor * per_noise_q16, 16));
}

/* The error in a frame, without the part of the rotor-frame error e. */
static iqfoc_dq_t without(iqfoc_dq_t error, iqfoc_dq_t e, const frame *f)
{
    const iqfoc_dq_t seen = turned(e, iq24_sincos(f->middle));
    const iqfoc_dq_t rest = {iq24_sub_sat(error.d, iq24_mul_round(f->share, seen.d)),
                             iq24_sub_sat(error.q, iq24_mul_round(f->share, seen.q))};
    return rest;
}

static errors errors_of(const iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_sincos_t half,
                        int32_t per_noise, const frame *still, const frame *backward)
{
    const iq24_sincos_t half_back = {-half.sin, half.cos};
    const iqfoc_dq_t e = {mean_of(watch->alpha_cos + watch->beta_sin),
                          mean_of(watch->beta_cos - watch->alpha_sin)};
    const iqfoc_dq_t back = {mean_of(watch->alpha_cos - watch->beta_sin),
                             mean_of(watch->beta_cos + watch->alpha_sin)};
    const iqfoc_dq_t stationary = {iq24_asr32(watch->e_ab[0], IQFOC_WATCH_BLOCK_BITS),
                                   iq24_asr32(watch->e_ab[1], IQFOC_WATCH_BLOCK_BITS)};
    /* From the end of the cycle to its middle; the backward frame needs the opposite sign. */
    const iqfoc_dq_t e_mid = turned(e, half);
    const iqfoc_dq_t in_flux = {iq24_mul_shift(e_mid.d, config->flux_d_q16, 16),
                                iq24_mul_shift(e_mid.q, config->flux_q_q16, 16)};
    const errors y = {
        scaled_pair(in_flux, over_noise(config->per_noise_q8, per_noise), 16),
        scaled_pair(turned(without(back, e, backward), half_back),
                    over_noise(config->per_noise_q8, backward->per_noise), 16),
        scaled_pair(without(stationary, e, still), over_noise(config->per_noise_q8, still->per_noise), 16)};
    return y;
}

/* ---- One signature ---- */

static int32_t absolute(int32_t x)
{
    return x < 0 ? -x : x;
}

static int64_t least(int64_t x, int64_t y)
{
    return x < y ? x : y;
}

static int32_t held_sum(int64_t x)
{
    return (int32_t)(x < 0 ? 0 : x > MOST_Q16 ? MOST_Q16 : x);
}

/* Allowance of y, each axis, Q16: 0 ... 576. of_model: it contains the model's initial uncertainty. */
typedef struct allowance {
    int32_t d, q;
    bool of_model;
} allowance;

/*
 * The shift that the detector assumes for a signature's component. With a mean m of y the assumed X changes the sum
 * by X (m - slack) - X^2/2 per block, the most at X = m - slack. m is that of a change of 2.5 stated sizes. The part
 * of X that the allowance hides is left out: with it the sum would lose what other blocks have shown. At least a 64th
 * is assumed, so that a far larger change is seen there too, and at most the stated size. The bound holds for any X.
 *
 * Range: |x| <= 2^23.
 */
static int32_t laid_of(int32_t x, int32_t slack)
{
    const int32_t size = absolute(x);
    const int32_t best = ((5 * size) >> 1) - slack;
    const int32_t least_laid = size >> 6;
    const int32_t laid = best > size ? size : best < least_laid ? least_laid : best;
    return x < 0 ? -laid : laid;
}

static int64_t dot(pair x, pair y)
{
    return (int64_t)x.d * y.d + (int64_t)x.q * y.q;
}

/*
 * Range: components within 128 in Q16 make products within 2^47 in Q32; 96 blocks of them 2^28 in Q6. A ratio held
 * from above keeps the bound, because its mean only falls. Products with the allowance: 2^50 in Q32.
 */
static void follow(iqfoc_watch_t *watch, int32_t n, pair x, pair y, allowance slack)
{
    pair laid = x;
    if (slack.of_model) {
        laid.d = laid_of(x.d, slack.d);
        laid.q = laid_of(x.q, slack.q);
    }
    const int64_t xy = iq24_asr64(dot(laid, y), 16);
    const int64_t cost =
        (iq24_asr64(dot(laid, laid), 16) >> 1) +
        iq24_asr64((int64_t)slack.d * absolute(laid.d) + (int64_t)slack.q * absolute(laid.q), 16);
    watch->up_q16[n] = held_sum(watch->up_q16[n] + least(xy - cost, MOST_A_BLOCK_Q16));
    watch->down_q16[n] = held_sum(watch->down_q16[n] + least(-xy - cost, MOST_A_BLOCK_Q16));
    if (watch->naming > 0) {
        watch->xy_q6[n] = iq24_sat(watch->xy_q6[n] + iq24_asr64(dot(x, y) + ROUND_Q6, 26));
        watch->xx_q6[n] = iq24_sat(watch->xx_q6[n] + iq24_asr64(dot(x, x) + ROUND_Q6, 26));
    } else {
        watch->xy_q6[n] = watch->up_q16[n] > 0 ? iq24_add_sat(watch->xy_q6[n], 1) : 0;
        watch->xx_q6[n] = watch->down_q16[n] > 0 ? iq24_add_sat(watch->xx_q6[n], 1) : 0;
    }
}

/* Twice the limit of y: with it no change is detected. */
#define MOST_UNSURE_Q16 (INT32_C(256) << 16)

/*
 * Shift of y by a signature's component (within 16) for one value of `unsure`. Range: 2^28 times below 2^31 is 2^35
 * in Q16, and times 16 2^55 in Q32.
 */
static int64_t moved_by(iq24_t component, int32_t size, int32_t unsure_q16)
{
    return iq24_asr64(iq24_asr64((int64_t)absolute(component) * size, 24) * unsure_q16, 16);
}

static bool is_unsure(const iqfoc_watch_config_t *config)
{
    return config->unsure_q16[0] != 0 || config->unsure_q16[1] != 0 || config->unsure_q16[2] != 0;
}

/*
 * Allowance of y: `always`, plus the shift by the initial uncertainty of resistance, inductances and flux, from their
 * signatures. Each axis separately, because L_d and L_q may have different errors.
 */
static allowance slack_of(const iqfoc_watch_config_t *config, int32_t always_q16, const iqfoc_dq_t *signature,
                          int32_t per_noise)
{
    const bool of_model = is_unsure(config);
    int64_t d = 0;
    int64_t q = 0;
    for (int32_t n = 0; n < IQFOC_WATCH_UNSURE && of_model; n++) {
        const int32_t size = over_noise(config->size_q16[n], per_noise);
        d += moved_by(signature[n].d, size, config->unsure_q16[n]);
        q += moved_by(signature[n].q, size, config->unsure_q16[n]);
    }
    const allowance slack = {always_q16 + (int32_t)least(d, MOST_UNSURE_Q16),
                             always_q16 + (int32_t)least(q, MOST_UNSURE_Q16), of_model};
    return slack;
}

/*
 * The same in a frame that turns against the rotor's. Nothing is left of errors that are constant in the rotor's
 * frame. If the speed changes through the block, errors proportional to the speed are not constant. Either axis may
 * have all of their shift.
 */
static allowance slack_elsewhere(const iqfoc_watch_t *watch, const iqfoc_watch_config_t *config,
                                 iq24_t change, int32_t per_noise)
{
    const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
    const iq24_t half = iq24_asr32(change, 1);
    const iqfoc_dq_t moves[IQFOC_WATCH_UNSURE] = {{0, 0}, across(i, half), {0, -half}};
    const allowance by_axis = slack_of(config, 0, moves, per_noise);
    const int32_t slack = config->slack_q16[1] + by_axis.d + by_axis.q;
    const allowance both = {slack, slack, by_axis.of_model};
    return both;
}

#define PI           IQ24(3.14159265358979)
#define SHARE_IS_ONE IQ24(1.0 / 64.0) /* of a revolution in a block: the share below is 1 to 4e-4 */

/*
 * An error that varies with the mechanical angle keeps the share sin(pi z)/(pi z) in the block's mean, z the part of a
 * revolution that the block covers. Range: |speed| <= 1/3, so that 32 turns are within 11; z within 1/2, pi z within 1.6.
 */
static void follow_eccentricity(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed,
                                iq24_t shaft, int32_t per_noise, pair y, allowance slack)
{
    const iq24_t z = iq24_mul_round(config->mechanical, IQFOC_WATCH_BLOCK_CYCLES * iq24_max(speed, -speed));
    if (config->mechanical == 0 || z > IQ24(0.5)) {
        return;
    }
    const iq24_t share =
        z < SHARE_IS_ONE ? IQ24_ONE : iq24_div(iq24_sincos(iq24_asr32(z, 1)).sin, iq24_mul_round(PI, z));
    const iq24_t length = -iq24_mul_round(speed, share);
    const iq24_sincos_t at = iq24_sincos(shaft);
    const iqfoc_dq_t by_cos = {0, iq24_mul_round(length, at.cos)};
    const iqfoc_dq_t by_sin = {0, iq24_mul_round(length, at.sin)};
    const int32_t size = over_noise(config->size_q16[IQFOC_WATCH_ECCENTRICITY], per_noise);
    const pair x_cos = scaled_pair(by_cos, size, 24);
    const pair x_sin = scaled_pair(by_sin, size, 24);
    follow(watch, ECCENTRICITY, x_cos, y, slack);
    follow(watch, ECCENTRICITY + 1, x_sin, y, slack);
    if (watch->naming > 0) {
        watch->across_q6 = iq24_sat(watch->across_q6 + iq24_asr64(dot(x_cos, x_sin) + ROUND_Q6, 26));
    }
}

/* The signatures of the current's own frame. shaft: mechanical angle at the block's middle. */
static void follow_rotor(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed, iq24_t shaft,
                         int32_t per_noise, pair y)
{
    const iq24_sincos_t half = iq24_sincos(iq24_asr32(speed, 1));
    const iq24_sincos_t half_back = {-half.sin, half.cos};
    const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
    const iqfoc_dq_t u_start = {watch->u[0], watch->u[1]};
    const iqfoc_dq_t u = turned(u_start, half_back);
    const iqfoc_dq_t along = {-speed, 0};
    const iqfoc_dq_t ahead = {0, -speed};
    const iqfoc_dq_t of_rotor[IQFOC_WATCH_SENSOR_GAIN] = {
        opposite(i), across(i, speed), ahead, u, opposite(direction(i)), along, across(u, speed)};
    const allowance slack = slack_of(config, config->slack_q16[0], of_rotor, per_noise);
    for (int32_t n = 0; n < IQFOC_WATCH_SENSOR_GAIN; n++) {
        follow(watch, n, scaled_pair(of_rotor[n], over_noise(config->size_q16[n], per_noise), 24), y, slack);
    }
    follow_eccentricity(watch, config, speed, shaft, per_noise, y, slack);
}

/* 1 over a frame's noise, times the share 1 - s^2 of its signatures, times a group's size. */
static int32_t seen_size(const iqfoc_watch_config_t *config, iqfoc_watch_group_t group, const frame *f)
{
    return over_noise(config->size_q16[group], iq24_mul_round(f->per_noise, f->left));
}

static void follow_all(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t at_end, iq24_t theta)
{
    /*
     * The angles of the block's 32 ends, the speed changing evenly: at n cycles before the last
     * theta - n at_end + n^2/2 (change per cycle); their mean has n = 15.5 and n^2/2 = 162.75.
     */
    const iq24_t change = iq24_sub_wrap(at_end, watch->speed);
    const iq24_t speed = iq24_sub_wrap(at_end, iq24_asr32(change, 1));
    const iq24_t since_middle =
        15 * at_end + iq24_asr32(at_end, 1) - iq24_mul_round(IQ24(162.75 / 32.0), change);
    const iq24_t middle = iq24_sub_wrap(theta, since_middle);
    const iq24_t shaft = iq24_sub_wrap(watch->mechanical, iq24_mul_round(since_middle, config->mechanical));
    const iq24_sincos_t half = iq24_sincos(iq24_asr32(speed, 1));
    const int32_t per_noise = per_block_noise(config, half, IQ24_ONE, IQ24_ONE);
    const frame still = frame_of(config, half, speed, middle, 1);
    const frame backward = frame_of(config, half, speed, middle, 2);
    const errors y = errors_of(watch, config, half, per_noise, &still, &backward);
    follow_rotor(watch, config, speed, shaft, per_noise, y.rotor);
    if (backward.seen) {
        const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
        const iqfoc_dq_t moved = across(i, speed);
        const iqfoc_dq_t mirrored = {moved.d, -moved.q};
        const iqfoc_dq_t mirrored_ahead = {moved.q, moved.d};
        const iqfoc_dq_t dropped = {iq24_sub_wrap(0, i.d), i.q};
        const iqfoc_dq_t dropped_ahead = {iq24_sub_wrap(0, i.q), iq24_sub_wrap(0, i.d)};
        const int32_t gain = seen_size(config, IQFOC_WATCH_SENSOR_GAIN, &backward);
        const int32_t phase = seen_size(config, IQFOC_WATCH_PHASE_RESISTANCE, &backward);
        const allowance slack = slack_elsewhere(watch, config, change, backward.per_noise);
        follow(watch, 7, scaled_pair(mirrored, gain, 24), y.back, slack);
        follow(watch, 8, scaled_pair(mirrored_ahead, gain, 24), y.back, slack);
        follow(watch, 11, scaled_pair(dropped, phase, 24), y.back, slack);
        follow(watch, 12, scaled_pair(dropped_ahead, phase, 24), y.back, slack);
    }
    if (still.seen) {
        const int32_t offset = seen_size(config, IQFOC_WATCH_SENSOR_OFFSET, &still);
        const allowance slack = slack_elsewhere(watch, config, change, still.per_noise);
        const iqfoc_dq_t alpha = {IQ24_ONE, 0};
        const iqfoc_dq_t beta = {0, IQ24_ONE};
        follow(watch, 9, scaled_pair(alpha, offset, 24), y.stationary, slack);
        follow(watch, 10, scaled_pair(beta, offset, 24), y.stationary, slack);
    }
}

/* ---- Alarm and name ---- */

/* (sum X y)/(sum |X|^2) in Q16: the change in stated sizes, held to 128. Range: xx is taken as 1 at least. */
static int32_t amount_by(int32_t xy_q6, int32_t xx_q6)
{
    return iq24_asr32(iq24_div(xy_q6, iq24_max(xx_q6, 64)), 8);
}

static int32_t amount_of(const iqfoc_watch_t *watch, int32_t n)
{
    return amount_by(watch->xy_q6[n], watch->xx_q6[n]);
}

static void look_for_alarm(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config)
{
    int32_t highest = 0;
    int32_t age = 0; /* of the highest detector: blocks since it was at 0 */
    for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        age = watch->up_q16[n] > highest ? watch->xy_q6[n] : age;
        highest = watch->up_q16[n] > highest ? watch->up_q16[n] : highest;
        age = watch->down_q16[n] > highest ? watch->xx_q6[n] : age;
        highest = watch->down_q16[n] > highest ? watch->down_q16[n] : highest;
    }
    if (highest >= config->threshold_q16) {
        watch->since = watch->blocks - (uint32_t)age;
        watch->naming = (int16_t)config->naming_blocks;
        for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
            watch->xy_q6[n] = 0;
            watch->xx_q6[n] = 0;
        }
        watch->across_q6 = 0;
    }
}

/* (sum X y)^2/(sum |X|^2): reduction of the sum of squared errors by the signature. */
static int64_t explained(const iqfoc_watch_t *watch, int32_t n, int32_t xx_q6)
{
    return iq24_asr64((int64_t)watch->xy_q6[n] * amount_by(watch->xy_q6[n], xx_q6), 16);
}

/*
 * The same of a group with two signatures. The X of an eccentricity have one direction, so that they are orthogonal
 * over whole revolutions only. There the sums |X|^2 are replaced by a bound of the largest eigenvalue of the 2 x 2
 * matrix of the sums of products, which gives a reduction that both have at least.
 */
static int64_t explained_by_both(const iqfoc_watch_t *watch, int32_t n)
{
    int32_t xx[2] = {watch->xx_q6[n], watch->xx_q6[n + 1]};
    if (n == ECCENTRICITY) {
        const int64_t apart = (int64_t)xx[0] - xx[1];
        const int64_t twice = (int64_t)xx[0] + xx[1] + (apart < 0 ? -apart : apart) +
                              2 * (int64_t)iq24_abs_sat(watch->across_q6);
        xx[0] = xx[1] = iq24_sat(iq24_asr64(twice, 1));
    }
    return explained(watch, n, xx[0]) + explained(watch, n + 1, xx[1]);
}

/* The length of two amounts in Q16. Range: below 128 in IQ24 each, so that the squares' sum is below 32768 by more than
 * a rounding; the root saturates. */
static int32_t amount_of_both(const iqfoc_watch_t *watch, int32_t n)
{
    const iq24_t a = iq24_abs_sat(iq24_sat((int64_t)amount_of(watch, n) * 256));
    const iq24_t b = iq24_abs_sat(iq24_sat((int64_t)amount_of(watch, n + 1) * 256));
    return iq24_asr32(iq24_sqrt(iq24_acc_sat(iq24_acc_mac(iq24_acc_mul(a, a), b, b))), 8);
}

/*
 * Score of a signature, over 256: the root of its reduction of the squared errors, minus the effect that the
 * allowance may have. Range: sums of 1024 blocks saturate, so that explained is below 2^37 in Q6; over 2^16 in IQ24
 * that saturates at 128.
 */
static iq24_t score_of(const iqfoc_watch_config_t *config, int64_t explained_q6, int32_t slack_q16)
{
    const iq24_t blocks = iq24_sqrt(config->naming_blocks * 256);
    return iq24_sub_wrap(iq24_sqrt(iq24_sat(explained_q6 * 4)), iq24_mul_shift(slack_q16, blocks, 16));
}

/* True if no detector is higher than the highest one of the rotor's frame. */
static bool rotor_leads(const iqfoc_watch_t *watch)
{
    int32_t rotor = 0;
    int32_t other = 0;
    for (int32_t n = 0; n < IQFOC_WATCH_SIGNATURES; n++) {
        const int32_t sum = iq24_max(watch->up_q16[n], watch->down_q16[n]);
        if (n < IQFOC_WATCH_SENSOR_GAIN || n >= ECCENTRICITY) {
            rotor = iq24_max(rotor, sum);
        } else {
            other = iq24_max(other, sum);
        }
    }
    return rotor > 0 && rotor >= other;
}

/*
 * Names the group with the highest score. With an initial uncertainty a leading detector of the rotor's frame excludes
 * the groups of the other frames: in blocks in which the allowance hides the change, the detectors lose almost nothing, and so they
 * identify the frame better than a sum over these blocks. The opposite does not hold. The allowance of the other
 * frames is smaller, and a step of the current within a block brings a small error of the rotor's frame there.
 */
static void name(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config)
{
    const bool of_rotor = is_unsure(config) && rotor_leads(watch);
    iq24_t best = IQ24_MIN;
    for (int32_t n = 0; n < IQFOC_WATCH_SENSOR_GAIN; n++) {
        const iq24_t score = score_of(config, explained(watch, n, watch->xx_q6[n]), config->slack_q16[0]);
        if (score > best) {
            best = score;
            watch->group = (iqfoc_watch_group_t)n;
            watch->amount_q16 = amount_of(watch, n);
        }
    }
    for (int32_t n = IQFOC_WATCH_SENSOR_GAIN; n < IQFOC_WATCH_SIGNATURES; n += 2) {
        const bool in_rotor = n == ECCENTRICITY;
        const iq24_t score =
            score_of(config, explained_by_both(watch, n), config->slack_q16[in_rotor ? 0 : 1]);
        if (score > best && (in_rotor || !of_rotor)) {
            best = score;
            watch->group = (iqfoc_watch_group_t)(IQFOC_WATCH_SENSOR_GAIN + (n - IQFOC_WATCH_SENSOR_GAIN) / 2);
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

/* One block: true if a group has just been named. */
static bool judge(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed, iq24_t theta)
{
    const iqfoc_dq_t i = {watch->i[0], watch->i[1]};
    const bool alarmed = watch->naming > 0;
    if (length_of(i) < LEAST_CURRENT) {
        return false;
    }
    follow_all(watch, config, speed, theta);
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

/* The angle of the shaft at this block's end: by the angle, and by the speed for the number of turns. */
static void turn_shaft(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t at_end, iq24_t theta)
{
    const iq24_t change = iq24_sub_wrap(at_end, watch->speed);
    const iq24_t expected = IQFOC_WATCH_BLOCK_CYCLES * iq24_sub_wrap(at_end, iq24_asr32(change, 1));
    const int64_t rest = (int64_t)theta - watch->theta - expected;
    const iq24_t turned_by = iq24_add_wrap(expected, angle_less_turns(rest));
    watch->mechanical = iq24_add_wrap(watch->mechanical, iq24_mul_round(turned_by, config->mechanical));
    watch->theta = theta;
}

bool iqfoc_watch_block(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed, iq24_t theta)
{
    const iq24_t held = iq24_clamp(speed, -IQFOC_ROTOR_SPEED_MAX, IQFOC_ROTOR_SPEED_MAX);
    bool named = false;
    watch->blocks++;
    turn_shaft(watch, config, held, theta);
    /* The speed at the start of the first block is not known. */
    if (watch->group == IQFOC_WATCH_NONE && watch->blocks > 1) {
        named = judge(watch, config, held, theta);
    }
    watch->speed = held;
    begin_block(watch);
    return named;
}
