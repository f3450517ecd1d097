/*
 * Change detector (CUSUM) of the drive's model. From the prediction error of each cycle it reports that the model no
 * longer fits, which parameter changed, by how much and since when.
 *
 * A changed parameter shifts the prediction error in a direction given by the cycle's own current, voltage and speed:
 * the signature of the parameter. In the rotor's frame at mid-cycle, x = speed in turns per cycle, j ahead by 90
 * degrees:
 *
 *     resistance     i                    flux          j x             angle delay     x
 *     inductance     j x i                voltage gain  u               voltage delay   j x u
 *     dead time      i/|i|                in the stationary frame, and in the frame that turns backwards:
 *     offset of a current sensor: constant in the first; gain of one: the conjugate of j x i in the second;
 *     resistance of one phase: the conjugate of i in the second
 *     eccentric rotor, weak pole: j x times cosine and sine of the mechanical angle, in the rotor's frame
 *
 * Errors and signatures are averaged over blocks of 32 cycles. Each signature has two sums (up and down) of the
 * logarithm of a likelihood ratio, held at 0 from below (E. S. Page, "Continuous inspection schemes", Biometrika 41,
 * 1954):
 *
 *     sum = max(0, sum + min(4, X y - |X|^2/2 - slack |X|))
 *
 * y is the block's error over the bound of its noise (src/watch.c). X is the effect of a change of the stated size on
 * y. `slack` is the allowance of each axis: an error that may stay in y for good. It is a constant, plus for
 * resistance, inductance and flux the X of their initial uncertainty. The allowance hides small parts of X. With an
 * initial uncertainty each axis therefore assumes the shift min(X, max(5/2 X - slack, X/64)): the largest gain for a
 * change of 2.5 stated sizes.
 *
 * The bound on false alarms. Let y be sub-Gaussian with at most that noise about a mean of length `slack` at most.
 * Then E e^(X y) <= e^(slack |X| + |X|^2/2). The ratios by which a run of blocks multiplies e^sum have a product
 * whose mean is 1 at most. The sample that two blocks share is counted twice in the noise; a ratio held to e^4 only
 * lowers the mean. e^sum with the 0 from below is at most the sum of these products over all blocks in which a run
 * may have begun. It is an e-detector (J. Shin, A. Ramdas and A. Rinaldo, "E-detectors", New England J. of Statistics
 * in Data Science 2(2), 2024), and its mean after n blocks is at most n. The mean time until one detector passes
 * e^threshold is e^threshold blocks at least. For the first of 30 detectors it is a 30th part of that, whatever the
 * drive does. IQFOC_WATCH_THRESHOLD makes it 10^9 cycles.
 *
 * In each block, an error that is constant in the rotor's frame is first removed from the other two frames. At
 * standstill all three frames are one, and the legs' losses near zero current would look like a sensor's offset. A
 * sensor's offset and gain and a phase's resistance are therefore not judged near standstill: below 0.0044 turns per
 * cycle for an offset, below 0.0022 for the others. An eccentricity is judged while a block covers half a mechanical
 * revolution at most. The mechanical angle is counted from the reset.
 *
 *     static const iqfoc_watch_config_t config =
 *         IQFOC_WATCH_CONFIG(R, L_D, L_Q, PSI, POLE_PAIRS, T, I_B, U_B, NOISE);
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

/* The groups, in the order of their signatures. Each group from the sensor's gain on has two. */
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
    IQFOC_WATCH_PHASE_RESISTANCE, /* of one phase: winding, cable or contact */
    IQFOC_WATCH_ECCENTRICITY,     /* the magnets' flux varies once per mechanical revolution */
    IQFOC_WATCH_GROUPS,
    IQFOC_WATCH_NONE = IQFOC_WATCH_GROUPS
} iqfoc_watch_group_t;

#define IQFOC_WATCH_SIGNATURES   15
#define IQFOC_WATCH_UNSURE       3 /* the first three: parameters with an initial uncertainty */
#define IQFOC_WATCH_BLOCK_CYCLES 32
#define IQFOC_WATCH_BLOCK_BITS   5

/* Q16 throughout. */
typedef struct iqfoc_watch_config {
    int32_t per_noise_q8; /* 1/(noise of one sample), Q8: 10 ... 20000 */
    int32_t
        size_q16[IQFOC_WATCH_GROUPS]; /* effect of the stated change on a signature of 1, over the noise */
    /* 1/pole pairs; 0: eccentricity is not judged. */
    iq24_t mechanical;
    iq24_t
        noise_least; /* noise of a block's error at standstill: its square over a sample's, 1/256 and more */
    int32_t flux_d_q16; /* L_d over the mean of L_d and L_q, and L_q over it: 1/8 ... 2 */
    int32_t flux_q_q16;
    int32_t slack_q16
        [2]; /* allowance: error that a block may have for good, over its noise: in the rotor's frame, in the others */
    int32_t threshold_q16; /* natural logarithm */
    int32_t naming_blocks; /* after an alarm, until the group is named: 1 ... 1024 */
    /* Initial uncertainty of R, L and psi_f, as a multiple of the stated change: 0 ... 16. */
    int32_t unsure_q16[IQFOC_WATCH_UNSURE];
} iqfoc_watch_config_t;

/* The state; iqfoc_watch_reset sets it. Read it in the interrupt that calls the step, or while that cannot come. */
typedef struct iqfoc_watch {
    int64_t alpha_cos; /* sums of the block: error times cosine and sine, Q48 */
    int64_t alpha_sin;
    int64_t beta_cos;
    int64_t beta_sin;
    iq24_t e_ab[2]; /* in IQ24 */
    iq24_t i[2];    /* block's mean, IQ24 */
    iq24_t u[2];
    int16_t count;                          /* cycles in the block */
    int16_t naming;                         /* blocks left until the group is named; 0: no alarm */
    iq24_t speed;                           /* at the last block's end */
    iq24_t theta;                           /* there as well */
    iq24_t mechanical;                      /* angle of the shaft there, from the reset on */
    int32_t up_q16[IQFOC_WATCH_SIGNATURES]; /* the detectors */
    int32_t down_q16[IQFOC_WATCH_SIGNATURES];
    int32_t xy_q6
        [IQFOC_WATCH_SIGNATURES]; /* from the alarm on: sum of X y. Before it: blocks since up was at 0 */
    int32_t xx_q6
        [IQFOC_WATCH_SIGNATURES]; /* from the alarm on: sum of |X|^2. Before it: blocks since down was at 0 */
    int32_t across_q6;            /* from the alarm on: sum of the product of the eccentricity's X */
    uint32_t blocks;              /* since the reset */
    uint32_t since;               /* block in which the change began, once there is an alarm */
    int32_t amount_q16;           /* the group's change, in the sizes below, once it is named */
    iqfoc_watch_group_t group;    /* the changed parameter; IQFOC_WATCH_NONE until it is named */
} iqfoc_watch_t;

/* Stated changes: the detectors are designed for these. Without an allowance they detect half of one. */
#define IQFOC_WATCH_SIZE_R            0.10  /* share of R */
#define IQFOC_WATCH_SIZE_L            0.05  /* share of L */
#define IQFOC_WATCH_SIZE_PSI          0.02  /* share of psi_f */
#define IQFOC_WATCH_SIZE_GAIN         0.01  /* share of the voltage */
#define IQFOC_WATCH_SIZE_DEAD         0.002 /* share of U_b lost by each leg */
#define IQFOC_WATCH_SIZE_ANGLE        0.01  /* rad */
#define IQFOC_WATCH_SIZE_LATE         0.05  /* cycles */
#define IQFOC_WATCH_SIZE_SENSOR       0.01  /* share of one phase's current */
#define IQFOC_WATCH_SIZE_OFFSET       0.01  /* per unit */
#define IQFOC_WATCH_SIZE_PHASE        0.2   /* share of one phase's resistance */
#define IQFOC_WATCH_SIZE_ECCENTRICITY 0.02  /* amplitude, share of psi_f */
/* ln(30 * 10^9/32) = 20.66: 10^9 cycles at least between false alarms. */
#define IQFOC_WATCH_THRESHOLD 20.66
/* Allowances. The legs' losses near zero current are in the rotor's frame only. */
#define IQFOC_WATCH_SLACK_ROTOR 5.0
#define IQFOC_WATCH_SLACK_ELSE  0.1
#define IQFOC_WATCH_NAMING      64

/* x in Q(bits) as a constant, if it lies within 0 ... high. */
#define IQFOC_WATCH_Q_(x, bits, high)                                                                        \
    (IQ24_CAST_(int32_t, IQ24_RAISED_(x, bits) + 0.5) / IQFOC_WITHIN_(x, 0.0, high))
/* Effect of a change on a signature of 1, over the noise of one sample. */
#define IQFOC_WATCH_SIZE_(x, noise_pu) IQFOC_WATCH_Q_((x) / (noise_pu), 16, 2048.0)

/*
 * iqfoc_watch_config_t of physical values, in the order of its members. noise_pu: standard deviation of one current
 * sample, per unit of I_b, 5e-5 ... 0.1. pole_pairs: 1 and more, or 0 for a drive whose eccentricity is not judged.
 *
 * IQFOC_WATCH_CONFIG assumes an exact model. IQFOC_WATCH_CONFIG_KNOWN assumes an initial uncertainty of R, L and psi
 * by these shares, up to 1.6, 0.8 and 0.32. It then detects only larger changes, and the bound on false alarms holds
 * for all machines within the uncertainty.
 *
 * Delay of an alarm: if a change moves y by m in a block, the detector grows by (m - slack)^2/2 at the most, and by 4
 * at the most, whatever shift is assumed. An alarm takes threshold over that many blocks. If m is below the
 * allowance, there is none (docs/watch.md).
 */
#define IQFOC_WATCH_CONFIG(R_ohm, L_d_H, L_q_H, psi_Wb, pole_pairs, T_s, I_b_A, U_b_V, noise_pu)             \
    IQFOC_WATCH_CONFIG_KNOWN(R_ohm, L_d_H, L_q_H, psi_Wb, pole_pairs, T_s, I_b_A, U_b_V, noise_pu, 0.0, 0.0, \
                             0.0)
#define IQFOC_WATCH_CONFIG_KNOWN(R_ohm, L_d_H, L_q_H, psi_Wb, pole_pairs, T_s, I_b_A, U_b_V, noise_pu,       \
                                 unsure_R, unsure_L, unsure_psi)                                             \
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
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_PHASE / 3.0 * IQFOC_WATCH_RHO_(R_ohm, L_d_H, L_q_H, T_s),    \
                               noise_pu),                                                                    \
             IQFOC_WATCH_SIZE_(IQFOC_WATCH_SIZE_ECCENTRICITY * IQFOC_TWO_PI_ *                               \
                                   IQFOC_RAW_K_PSI(psi_Wb, IQFOC_WATCH_L_(L_d_H, L_q_H), I_b_A),             \
                               noise_pu)},                                                                   \
            IQFOC_CHECKED((pole_pairs) > 0 ? 1.0 / ((pole_pairs) > 0 ? (pole_pairs) : 1) : 0.0, 0.0, 1.0),   \
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

/* Resets to no alarm and no blocks. Ahead of the first step, or in the interrupt that calls the step. */
static inline void iqfoc_watch_reset(iqfoc_watch_t *watch)
{
    const iqfoc_watch_t fresh = {0,   0,   0, 0, {0, 0}, {0, 0}, {0, 0},          0, 0, 0, 0, 0, {0}, {0},
                                 {0}, {0}, 0, 0, 0,      0,      IQFOC_WATCH_NONE};
    *watch = fresh;
}

/*
 * One cycle, at the valley that ends it, in the valley's interrupt. Returns true when a block is complete: then call
 * iqfoc_watch_block before the next step; it begins the next block.
 *
 * off: the sample at this valley minus its prediction by the model, stationary frame, held to +-2. With a disturbance
 * observer, the disturbance estimate is part of this error (iqfoc_tuned_state_t's `error` contains it). i, u: current
 * and voltage at the start of the cycle, in the rotor's frame there, |component| <= 8 and <= 16. The voltage is the one
 * that acted: duties times the measured DC link. A commanded voltage makes a ripple of the link a false alarm. sc: of
 * the angle at this valley.
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
 * A complete block: detectors, alarm and name. Returns true once, when a group has just been named; watch->naming is
 * above 0 from the alarm until then. turns, theta: speed and angle at this valley, |speed| <= IQFOC_ROTOR_SPEED_MAX
 * (held to it). The speed is assumed to change evenly through the block. The first block after a reset is not judged.
 * Call it in the valley's interrupt, or in a task that the next step cannot interrupt.
 *
 * Each product is rounded down in Q16. X and y are held to +-128, which only delays an alarm and lowers the amount of
 * so large a change. Detectors end at 16384. Blocks with a current below 0.15 are not judged, because the loss of the
 * legs near zero current has no model. Some 3600 instructions on a Cortex-M4, up to a quarter more with an initial uncertainty;
 * the step takes 49. After a name nothing changes until iqfoc_watch_reset.
 */
bool iqfoc_watch_block(iqfoc_watch_t *watch, const iqfoc_watch_config_t *config, iq24_t speed, iq24_t theta);

#ifdef __cplusplus
}
#endif

#endif
