/*
 * A watch on the drive's model: from the prediction error of each cycle it says that the model has gone wrong,
 * which of its parts, by how much and since when.
 *
 * A changed parameter shifts the error of a cycle in a direction that the cycle's own current, voltage and
 * speed tell: its signature. In the rotor's frame at mid-cycle, x = speed in turns per cycle, j ahead by 90
 * degrees:
 *
 *     resistance     i                    flux          j x             late angle      x
 *     inductance     j x i                voltage gain  u               late voltage    j x u
 *     dead time      i/|i|                of the stationary frame, and of the frame that turns backwards:
 *     offset of a current sensor: constant in the first; gain of one: the conjugate of j x i in the second
 *
 * Errors and signatures are averaged over blocks of 32 cycles, and each signature has two sums (up and down) of
 * the logarithm of a likelihood ratio, held at 0 from below (E. S. Page, "Continuous inspection schemes",
 * Biometrika 41, 1954):
 *
 *     sum = max(0, sum + min(4, X y - |X|^2/2 - slack |X|))
 *
 * y: the block's error over the bound of its noise (src/watch.c); X: the same of what a change of the stated
 * size would make of it; slack, of each axis: a constant, and for each of resistance, inductance and flux what the
 * model's confidence leaves: the X of the changes that it may be off by. A part of X that this slack would hide is
 * held back: with a confidence each axis lays min(X, max(5/2 X - slack, X/64)), the most that a change of 2.5
 * stated sizes is worth there.
 *
 * The bound. Let y be sub-Gaussian with at most that noise about a mean of length `slack` at most. Then
 * E e^(X y) <= e^(slack |X| + |X|^2/2), so that the ratios by which a run of blocks multiplies e^sum have a
 * product whose mean is 1 at most (the sample that two blocks share stands twice in the noise), and less where one
 * is held to e^4. e^sum with the 0 from below is at most the sum of these products over all blocks that a run may
 * have begun with: an e-detector (J. Shin, A. Ramdas and A. Rinaldo, "E-detectors", New England J. of Statistics
 * in Data Science 2(2), 2024), whose mean after n blocks is at most n. The first time that it passes e^threshold
 * has a mean of e^threshold blocks at least, and the first of 22 such a 22nd part of it, whatever the drive does
 * meanwhile. IQFOC_WATCH_THRESHOLD makes that 10^9 cycles.
 *
 * An error that stands still in the rotor's frame is taken out of the other two first, block by block: at
 * standstill all three are one, and what the legs lose about zero current would otherwise be a sensor's offset.
 * There a sensor's offset and gain are not judged: below 0.0044 and 0.0022 turns a cycle.
 *
 *     static const iqfoc_watch_config_t config = IQFOC_WATCH_CONFIG(R, L_D, L_Q, PSI, T, I_B, U_B, NOISE);
 *     if (iqfoc_watch_step(&watch, error, i, u, sc) && iqfoc_watch_block(&watch, &config, turns, theta)) {
 *         recorder trigger; watch.group, watch.amount_q16, watch.since
 *     }
 */
#ifndef IQFOC_WATCH_H
#define IQFOC_WATCH_H

#include "iq24_math.h"
#include "params.h"
#include "rotor.h"
#include "vector.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The groups, in the order of the table above; a sensor's offset and gain have two signatures each. */
typedef enum iqfoc_watch_group {
    IQFOC_WATCH_RESISTANCE,
    IQFOC_WATCH_INDUCTANCE,
    IQFOC_WATCH_FLUX,
    IQFOC_WATCH_VOLTAGE_GAIN,
    IQFOC_WATCH_DEAD_TIME,
    IQFOC_WATCH_ANGLE,
    IQFOC_WATCH_VOLTAGE_LATE,
    IQFOC_WATCH_SENSOR_GAIN,
    IQFOC_WATCH_SENSOR_OFFSET,
    IQFOC_WATCH_GROUPS,
    IQFOC_WATCH_NONE = IQFOC_WATCH_GROUPS
} iqfoc_watch_group_t;

#define IQFOC_WATCH_SIGNATURES   11 /* the last four: gain twice, offset twice */
#define IQFOC_WATCH_UNSURE       3  /* the first three: what a diagnosis knows with a confidence */
#define IQFOC_WATCH_BLOCK_CYCLES 32
#define IQFOC_WATCH_BLOCK_BITS   5

/* Q16 throughout. */
typedef struct iqfoc_watch_config {
    int32_t per_noise_q8; /* 1/(noise of one sample), Q8: 10 ... 20000 */
    int32_t
        size_q16[IQFOC_WATCH_GROUPS]; /* what the stated change makes of a signature of 1, over the noise */
    iq24_t noise_least; /* of a block's error at standstill, its square over a sample's: 1/256 and more */
    int32_t flux_d_q16; /* L_d over their mean, and L_q over it: 1/8 ... 2 */
    int32_t flux_q_q16;
    int32_t slack_q16
        [2]; /* what may be in a block's error for good, over its noise: in the rotor's frame, elsewhere */
    int32_t threshold_q16; /* natural logarithm */
    int32_t naming_blocks; /* after an alarm, until the group is named: 1 ... 1024 */
    /* By how much resistance, inductance and flux may be off from the start, over the stated changes: 0 ... 16. */
    int32_t unsure_q16[IQFOC_WATCH_UNSURE];
} iqfoc_watch_config_t;

/* Zero it to begin anew: iqfoc_watch_reset. */
typedef struct iqfoc_watch {
    int64_t alpha_cos; /* of the block: sums of the error's products in Q48 */
    int64_t alpha_sin;
    int64_t beta_cos;
    int64_t beta_sin;
    iq24_t e_ab[2]; /* in IQ24 */
    iq24_t i[2];    /* in IQ24, less 5 bits */
    iq24_t u[2];
    int16_t count;                          /* cycles in the block */
    int16_t naming;                         /* blocks left until the group is named; 0: no alarm */
    iq24_t turns;                           /* at the last block's end */
    int32_t up_q16[IQFOC_WATCH_SIGNATURES]; /* the detectors */
    int32_t down_q16[IQFOC_WATCH_SIGNATURES];
    int32_t xy_q6[IQFOC_WATCH_SIGNATURES]; /* from the alarm on, sums; before it, blocks since up was at 0 */
    int32_t xx_q6[IQFOC_WATCH_SIGNATURES]; /* and since down was */
    uint32_t blocks;                       /* since the reset */
    uint32_t since;                        /* block in which the change began, once there is an alarm */
    int32_t amount_q16;                    /* of the group's change, in the sizes below, once it is named */
    iqfoc_watch_group_t group;             /* IQFOC_WATCH_NONE until one is named */
} iqfoc_watch_t;

/* Changes that the detectors are made for. A half of one is what they can just see, if there were no slack. */
#define IQFOC_WATCH_SIZE_R      0.10  /* share of R */
#define IQFOC_WATCH_SIZE_L      0.05  /* share of L */
#define IQFOC_WATCH_SIZE_PSI    0.02  /* share of psi_f */
#define IQFOC_WATCH_SIZE_GAIN   0.01  /* share of the voltage */
#define IQFOC_WATCH_SIZE_DEAD   0.002 /* share of U_b lost by each leg */
#define IQFOC_WATCH_SIZE_ANGLE  0.01  /* rad */
#define IQFOC_WATCH_SIZE_LATE   0.05  /* cycles */
#define IQFOC_WATCH_SIZE_SENSOR 0.01  /* share of one phase's current */
#define IQFOC_WATCH_SIZE_OFFSET 0.01  /* per unit */
/* ln(22 * 10^9/32) = 20.35: 10^9 cycles at least between false alarms. */
#define IQFOC_WATCH_THRESHOLD 20.35
/* The legs' losses about zero current are in the rotor's frame only. */
#define IQFOC_WATCH_SLACK_ROTOR 5.0
#define IQFOC_WATCH_SLACK_ELSE  0.1
#define IQFOC_WATCH_NAMING      64

/* x in Q(bits) as a constant, if it lies within 0 ... high. */
#define IQFOC_WATCH_Q_(x, bits, high)                                                                        \
    (IQ24_CAST_(int32_t, IQ24_RAISED_(x, bits) + 0.5) / IQFOC_WITHIN_(x, 0.0, high))
/* What a change makes of a signature of 1, over the noise of one sample. */
#define IQFOC_WATCH_SIZE_(x, noise_pu) IQFOC_WATCH_Q_((x) / (noise_pu), 16, 2048.0)

/*
 * iqfoc_watch_config_t of physical values, in the order of its members. noise_pu: standard deviation of one
 * current sample, per unit of I_b, 5e-5 ... 0.1. IQFOC_WATCH_CONFIG is of a model that is taken for exact;
 * IQFOC_WATCH_CONFIG_KNOWN of one whose R, L and psi may be off by these shares, to 1.6, 0.8 and 0.32: changes
 * are then noted beyond them only, and the bound on false alarms holds for all machines within them. How soon: a
 * change that moves y by m in a block lets the detector grow by (m - slack)^2/2 at the most, whatever is laid, and by
 * 4; so an alarm takes threshold/that blocks, and where m is below the slack there is none (docs/watch.md).
 */
#define IQFOC_WATCH_CONFIG(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V, noise_pu)                         \
    IQFOC_WATCH_CONFIG_KNOWN(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V, noise_pu, 0.0, 0.0, 0.0)
#define IQFOC_WATCH_CONFIG_KNOWN(R_ohm, L_d_H, L_q_H, psi_Wb, T_s, I_b_A, U_b_V, noise_pu, unsure_R,         \
                                 unsure_L, unsure_psi)                                                       \
    {                                                                                                        \
        IQFOC_WATCH_Q_(1.0 / (noise_pu), 8, 20000.0),                                                        \
            {IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_R * (R_ohm) * (T_s) / IQFOC_WATCH_L_(L_d_H, L_q_H),          \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_L * IQFOC_TWO_PI_, noise_pu),                                \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_PSI * IQFOC_TWO_PI_ *                                        \
                                   IQFOC_RAW_K_PSI(psi_Wb, IQFOC_WATCH_L_(L_d_H, L_q_H), I_b_A),             \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_GAIN *                                                       \
                                   IQFOC_RAW_K_U(IQFOC_WATCH_L_(L_d_H, L_q_H), T_s, I_b_A, U_b_V),           \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_DEAD * 1.2732395447351628 *                                  \
                                   IQFOC_RAW_K_U(IQFOC_WATCH_L_(L_d_H, L_q_H), T_s, I_b_A, U_b_V),           \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_ANGLE * IQFOC_TWO_PI_ *                                      \
                                   IQFOC_RAW_K_PSI(psi_Wb, IQFOC_WATCH_L_(L_d_H, L_q_H), I_b_A),             \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_LATE * IQFOC_TWO_PI_ *                                       \
                                   IQFOC_RAW_K_U(IQFOC_WATCH_L_(L_d_H, L_q_H), T_s, I_b_A, U_b_V),           \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_SENSOR * IQFOC_TWO_PI_ / 3.0, noise_pu),                     \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_OFFSET * (R_ohm) * (T_s) / IQFOC_WATCH_L_(L_d_H, L_q_H),     \
                               noise_pu)},                                                                   \
            IQ24((4.0 / 32.0 +                                                                               \
                  IQFOC_WATCH_RHO_(R_ohm, L_d_H, L_q_H, T_s) * IQFOC_WATCH_RHO_(R_ohm, L_d_H, L_q_H, T_s)) / \
                 32.0),                                                                                      \
            IQFOC_WATCH_Q_((L_d_H) / IQFOC_WATCH_L_(L_d_H, L_q_H), 16, 2.0),                                 \
            IQFOC_WATCH_Q_((L_q_H) / IQFOC_WATCH_L_(L_d_H, L_q_H), 16, 2.0),                                 \
            {IQFOC_WATCH_Q_(IQFOC_WATCH_SLACK_ROTOR, 16, 64.0),                                              \
             IQFOC_WATCH_Q_(IQFOC_WATCH_SLACK_ELSE, 16, 64.0)},                                              \
            IQFOC_WATCH_Q_(IQFOC_WATCH_THRESHOLD, 16, 1000.0), IQFOC_WATCH_NAMING,                           \
        {                                                                                                    \
            IQFOC_WATCH_Q_((unsure_R) / IQFOC_WATCH_SIZE_R, 16, 16.0),                                       \
                IQFOC_WATCH_Q_((unsure_L) / IQFOC_WATCH_SIZE_L, 16, 16.0),                                   \
                IQFOC_WATCH_Q_((unsure_psi) / IQFOC_WATCH_SIZE_PSI, 16, 16.0)                                \
        }                                                                                                    \
    }
#define IQFOC_WATCH_RHO_(R_ohm, L_d_H, L_q_H, T_s) ((R_ohm) * (T_s) / IQFOC_WATCH_L_(L_d_H, L_q_H))
#define IQFOC_WATCH_L_(L_d_H, L_q_H)               (0.5 * ((L_d_H) + (L_q_H)))

/* No alarm, nothing seen. */
static inline void iqfoc_watch_reset(iqfoc_watch_t *watch)
{
    const iqfoc_watch_t fresh = {0, 0,   0,   0,   {0, 0}, {0, 0}, {0, 0}, 0, 0,
                                 0, {0}, {0}, {0}, {0},    0,      0,      0, IQFOC_WATCH_NONE};
    *watch = fresh;
}

/*
 * One cycle, at the valley that ends it. True where a block is complete: iqfoc_watch_block is then to be called
 * before the next step; it begins the next block.
 *
 * off: the sample at this valley less what the model predicted for it, stationary frame, held to +-2; where a
 * controller learns a drift, what it learnt is part of the error (iqfoc_tuned_state_t has it so). i, u: current and
 * voltage at the start of the cycle, seen from the rotor there, |component| <= 8 and <= 16. sc: of the angle at
 * this valley.
 *
 * Range: 32 times 2 is 64 in IQ24 and 2^54 in Q48. 32 times 16/32 is 16.
 */
static inline bool iqfoc_watch_step(iqfoc_watch_t *watch, iqfoc_ab_t off, iqfoc_dq_t i, iqfoc_dq_t u,
                                    iq24_sincos_t sc)
{
    const iq24_t alpha = IQ24_HOLD_BITS(off.alpha, 26);
    const iq24_t beta = IQ24_HOLD_BITS(off.beta, 26);
    watch->alpha_cos = IQ24_MAC64(watch->alpha_cos, alpha, sc.cos);
    watch->alpha_sin = IQ24_MAC64(watch->alpha_sin, alpha, sc.sin);
    watch->beta_cos = IQ24_MAC64(watch->beta_cos, beta, sc.cos);
    watch->beta_sin = IQ24_MAC64(watch->beta_sin, beta, sc.sin);
    watch->e_ab[0] = iq24_add_wrap(watch->e_ab[0], alpha);
    watch->e_ab[1] = iq24_add_wrap(watch->e_ab[1], beta);
    watch->i[0] = iq24_add_wrap(watch->i[0], iq24_asr32(i.d, IQFOC_WATCH_BLOCK_BITS));
    watch->i[1] = iq24_add_wrap(watch->i[1], iq24_asr32(i.q, IQFOC_WATCH_BLOCK_BITS));
    watch->u[0] = iq24_add_wrap(watch->u[0], iq24_asr32(u.d, IQFOC_WATCH_BLOCK_BITS));
    watch->u[1] = iq24_add_wrap(watch->u[1], iq24_asr32(u.q, IQFOC_WATCH_BLOCK_BITS));
    watch->count = (int16_t)(watch->count + 1);
    return watch->count >= IQFOC_WATCH_BLOCK_CYCLES;
}

/*
 * A complete block: the detectors, the alarm, the name. True once, when a group has just been named; watch->naming
 * is above 0 from the alarm on. turns, theta: speed and angle at this valley, |turns| <= IQFOC_ROTOR_TURNS_MAX (held
 * to it); the speed is taken to change evenly through the block. The first block after a reset is not judged.
 *
 * Each product is rounded down in Q16. X and y are held to +-128, which only makes an alarm later, and the amount
 * of so large a change too small; detectors end at 16384. Blocks with less than 0.15 of current are not judged,
 * for no law says what the legs lose about zero. Some 3100 instructions on a Cortex-M4, 700 more with a confidence; the step 49.
 * After a name nothing changes until iqfoc_watch_reset.
 */
bool iqfoc_watch_block(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t turns, iq24_t theta);

#ifdef __cplusplus
}
#endif

#endif
