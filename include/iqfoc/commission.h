/*
 * Self-commissioning: a first drive measures its own parameters. It needs no angle sensor and no motor data; it moves a free shaft.
 *
 *     OFFSET      gates off: current offsets (offset.h)
 *     SEEK_ALPHA, SEEK_BETA   a growing voltage square wave finds the size of the inductance; the current controller's gains follow
 *     ALIGN       a current turns the rotor's d axis onto phase A (start.h)
 *     STAIRCASE   four levels of i_d: R and v_dead
 *     INDUCTANCE_D, INDUCTANCE_Q, SHAFT   a voltage square wave along and across the rotor, on a constant current: L_d, L_q
 *     RUN_UP, SPIN   the angle turns by itself (start.h): psi_f
 *
 * Once a cycle, in the valley's interrupt, in place of the control cycle:
 *
 *     iqfoc_hal_read_valley(hal, &sample);
 *     const iqfoc_command_t command = iqfoc_commission_step(&commission, &sample);
 *     iqfoc_hal_write(hal, &command);                 it acts from the next valley
 *
 * until `end` is no longer IQFOC_COMMISSION_RUNNING. From then on the command is the safe one: gates off.
 *
 * Units: per unit, with flux in U_b T as in flux_predictor.h. The measured current, the measured DC link and the carrier period are the
 * only scales: a gain error of a sensor appears in the results, and no interval includes it.
 *
 * The estimators. A mean is over a block of 2^block_log2 cycles; each quantity has 32 blocks. s is the standard deviation of the blocks'
 * residuals, 2.04 the 97.5 % quantile of Student's t for 30 degrees of freedom.
 *
 * R, v_dead. In the steady state u_d = R i_d + (4/3) v_dead: with current on the axis of phase A, leg A loses v_dead and legs B and C
 * gain it. Least squares of the blocks' means of u on those of i, at 2/5, 3/5, 4/5 and 5/5 of i_align, all far from the
 * zero crossing. Half widths: 2.04 s/sqrt(Sxx), and 2.04 s sqrt(1/32 + mean(i)^2/Sxx) with that of R times the offset's.
 *
 * L_d, L_q. The bias current keeps the signs of all phase currents, so that the dead time's loss is constant. A voltage of +-U, h cycles
 * each, then changes the current by D in each half period. The integral of L di/dt = u - R i over a half period is
 *
 *     L D = h U - R S          D = i(end) - i(begin),  S = sum of i over the half period (trapezoids), both times the sign of U
 *
 * without an approximation of exp(-R T/L): S is zero but for the curvature. Trapezoids miss a part of the integral. At duties near 1/2 a
 * cycle's voltage comes in two edges, at T/4 and 3T/4. R makes the integral larger by (3/32) (R T/L) D than the trapezoids. Each leg has one
 * of its two edges late by the dead time, so the current comes late by v_dead/2 on the mean, and the integral is smaller by (v_dead/2) D:
 *
 *     L = (h U - R S)/D + R v_dead/2 - (3/32) R^2/L          link near nominal
 *
 * Half width: 2.04 s/(D sqrt(32)), and that of R times S/D. Terms of higher order are left out: at most 5e-5 of L
 * where R T/L <= 0.1 and the dead time is at most 0.016 T, by test_course of tests/unit/library/test_commission.c.
 *
 * SHAFT. The alternating i_q also moves the shaft a little, and its EMF makes L_q too small by
 * (3/2) pairs^2 psi_f^2 (h T)^2/(12 J). A second measurement with 4 h shows sixteen times that error; a fifteenth of the
 * difference is added to the first.
 *
 * psi_f. In the frame of the commanded angle, which covers phi = 2 pi speed_end per cycle, with u seen from the middle of its cycle:
 *
 *     e = u - R i - (4/pi) v_dead i/|i|,    psi = -j e/(2 sin(phi/2)),    a = psi - L_q i = (psi_f + (L_d - L_q) i_d) e^(-j delta)
 *     psi_f = |a| - (L_d - L_q) |i| cos(delta)
 *
 * (a: the active flux), for any load angle delta. 4/pi: fundamental of the dead time's square wave. Each block gives a psi_f. A
 * shaft that swings slowly changes the blocks but not their mean. Half width: the sum of
 *
 *     2.04 s/sqrt(32),  L_d's half width |i| cos(delta),  (R's |i| + 4/pi v_dead's) sin(delta)/(2 sin(phi/2)),
 *     4/pi v_dead/(32 * 2 sin(phi/2))
 *
 * The last term is systematic: near a current's zero crossing the loss depends on ripple and clamped legs. On the drives of
 * tests/unit/library/test_commission.c that turns the fundamental by 1/30 rad at most.
 *
 * Other systematic errors are shares of a result that the configuration states; they are added to the half widths. For L_d and
 * L_q that is an alignment error x by friction, sin(x)^2 (L_q - L_d).
 *
 * The shaft must turn freely. A current aligns the rotor's d axis if psi_f > (L_q - L_d) i_align. Otherwise the rotor rests at an angle x,
 * and the results are wrong. In INDUCTANCE_D the current across the wave then changes by k D. The results l_d, l_q and psi meet
 *
 *     L_q - L_d = sqrt((l_q - l_d)^2 + (2 k l_q)^2)/(1 - k^2 l_q/l_d)     for any x
 *     psi <= (L_q - L_d) i_align                                          if x is not 0, without load
 *
 * so that psi < 3/2 |L_q - L_d| i_align ends the run with NOT_ALIGNED.
 *
 * Without damping a rotor in the field of a constant current swings up at high speed: choose speed_end so that the EMF is a tenth to a
 * quarter of the link, and hold_cycles long enough for the swing to die.
 *
 * Limits that hold in every cycle: no reference exceeds 5/4 i_align, a phase current beyond i_max ends the run, and so does a speed of
 * the sample beyond speed_max, a DC link outside 0.5 ... 1.5, a clipped sample, or more than cycles_max cycles.
 */
#ifndef IQFOC_COMMISSION_H
#define IQFOC_COMMISSION_H

#include "current_control.h"
#include "error.h"
#include "extension.h"
#include "flux_predictor.h"
#include "offset.h"
#include "sample.h"
#include "start.h"

#ifdef __cplusplus
extern "C" {
#endif

#define IQFOC_COMMISSION_BLOCKS 32

/* Fixed while it runs. Per unit, IQ24; cycles are PWM periods. */
typedef struct iqfoc_commission_config {
    iqfoc_offset_limits_t offset;
    iqfoc_start_config_t start; /* i_align <= 2; speed_end: speed of SPIN, not 0 */
    iq24_t i_max;               /* a phase current beyond it ends the run: 3/2 i_align ... 4 */
    iq24_t speed_max;           /* |sample.speed| beyond it ends the run: |speed_end| ... 1/3 */
    iq24_t u_max;               /* largest voltage of a square wave: 0 < u_max <= 1/2 */
    uint32_t cycles_max;        /* the longest run: at least 1 */
    uint32_t settle_cycles;     /* ahead of each measurement, several time constants L/R: 1 ... 2^24 */
    uint32_t block_log2;        /* 2^block_log2 cycles are a block: 6 ... 12 */
    uint32_t half_log2;         /* h = 2^half_log2 cycles, half a period of the square wave: 1 ... 2 */
    iq24_t share_r;             /* systematic share of R: 0 ... 1/4 */
    iq24_t share_l;             /* of L_d and L_q: 0 ... 1/4 */
    iq24_t share_psi;           /* of psi_f: 0 ... 1/4 */
} iqfoc_commission_config_t;

typedef enum iqfoc_commission_phase {
    IQFOC_COMMISSION_OFFSET,
    IQFOC_COMMISSION_SEEK_ALPHA,
    IQFOC_COMMISSION_SEEK_BETA,
    IQFOC_COMMISSION_ALIGN,
    IQFOC_COMMISSION_STAIRCASE,
    IQFOC_COMMISSION_INDUCTANCE_D,
    IQFOC_COMMISSION_INDUCTANCE_Q,
    IQFOC_COMMISSION_SHAFT,
    IQFOC_COMMISSION_RUN_UP,
    IQFOC_COMMISSION_SPIN
} iqfoc_commission_phase_t;

/* Why it ended; `phase` says where. */
typedef enum iqfoc_commission_end {
    IQFOC_COMMISSION_RUNNING,
    IQFOC_COMMISSION_DONE,         /* all results are valid */
    IQFOC_COMMISSION_ABORTED,      /* iqfoc_commission_abort */
    IQFOC_COMMISSION_OVER_CURRENT, /* a phase beyond i_max, or a clipped sample */
    IQFOC_COMMISSION_OVER_SPEED,   /* beyond speed_max */
    IQFOC_COMMISSION_DC_LINK,      /* outside 0.5 ... 1.5 of nominal */
    IQFOC_COMMISSION_TOO_SLOW,     /* cycles_max */
    IQFOC_COMMISSION_SENSORS,      /* offset.verdict says which fault */
    IQFOC_COMMISSION_NO_CURRENT,   /* u_max made no current: an open phase, or too large an inductance */
    IQFOC_COMMISSION_OUT_OF_RANGE, /* a result outside the range stated below */
    IQFOC_COMMISSION_NOT_TURNING,  /* psi_f does not exceed four times its half width: a blocked shaft */
    IQFOC_COMMISSION_NOT_ALIGNED   /* psi_f below 3/2 |L_q - L_d| i_align: the rotor may not be aligned */
} iqfoc_commission_end_t;

/* A result and the half width of its 95 % interval. */
typedef struct iqfoc_commission_value {
    iq24_t value;
    iq24_t half;
} iqfoc_commission_value_t;

/* Results, 0 until their phase is over. Units: extension.h, flux_predictor.h. */
typedef struct iqfoc_commission_result {
    iqfoc_abc_t i_offset;       /* -1 ... 1 */
    iqfoc_abc_t i_offset_half;  /* their half widths */
    iqfoc_commission_value_t r; /* R I_b/U_b: 0 < r <= 1; with the devices' on-resistance */
    iqfoc_commission_value_t
        v_dead;                   /* voltage that each leg loses: -1/4 ... 1/4; dead time = v_dead T/u_dc */
    iqfoc_commission_value_t l_d; /* L_d I_b/(U_b T): 1/16 ... 8 */
    iqfoc_commission_value_t l_q;
    iqfoc_commission_value_t psi; /* psi_f/(U_b T): 0 ... 16 */
} iqfoc_commission_result_t;

/* The state. All fields may be read. */
typedef struct iqfoc_commission {
    const iqfoc_commission_config_t *config;
    iqfoc_commission_phase_t phase;
    iqfoc_commission_end_t end;
    iqfoc_commission_result_t result;
    iqfoc_offset_t offset;
    iqfoc_start_t start;           /* its verdict judges a sensor, if there is one */
    volatile bool abort_requested; /* by iqfoc_commission_abort */
    uint32_t cycles;               /* since the start */
    uint32_t wait;                 /* cycles until the next measurement */
    uint32_t in_block;             /* cycles, or periods of the square wave, of this block */
    uint32_t blocks;               /* finished */
    uint32_t position;             /* of the next cycle in the square wave; 2 h is a period */
    iq24_t amplitude;              /* U */
    iq24_t bias;                   /* voltage of the constant current */
    iq24_t half_u;                 /* SEEK: U and D where D passed half of the target; 0: not yet */
    iq24_t half_d;                 /* SEEK */
    iq24_t l_rough;                /* the smaller inductance of SEEK */
    iq24_t across;                 /* k: change of the current across the wave, share of D */
    iqfoc_dq_t u_dq;               /* voltage of the current controller that acts in this cycle */
    int64_t sum[4]; /* of the block, Q24: i_d, u_d, i_q, u_q; D, S and k D of the square wave */
    iq24_t x[IQFOC_COMMISSION_BLOCKS]; /* the blocks' means: i_d; D; psi_f */
    iq24_t y[IQFOC_COMMISSION_BLOCKS]; /* u_d; S */
    iqfoc_current_control_gains_t gains;
    iqfoc_current_control_t control;
} iqfoc_commission_t;

/* Begins with OFFSET. config must outlive it. IQFOC_ERROR_COMMISSION: a field out of its range. Ahead of the first step. */
iqfoc_error_t iqfoc_commission_init(iqfoc_commission_t *commission, const iqfoc_commission_config_t *config);

/*
 * One cycle: the command that acts from the next valley on. From the valley's interrupt. sample: any values; theta and turns of a
 * sensor, or 0 without one. The last step of a phase evaluates the blocks; docs/bench.md has its instructions.
 *
 * Largest error of 3000 drawn, against the lines above in double with the same means: R 0.51 LSB, 4/3 v_dead 1.6 LSB, L
 * 0.75 LSB (1 + L)/D, psi_f 0.55 LSB (2 + psi_f + (L_d + L_q) |i|)/(2 sin(phi/2)); half widths of the staircase 1.6 LSB too small.
 *
 * Range: the guard holds phase currents to 4, so |i| <= 5.4 a component; voltages are within 8. Sums of 2^12 cycles are below 2^40.
 */
iqfoc_command_t iqfoc_commission_step(iqfoc_commission_t *commission, const iqfoc_sample_t *sample);

/* The next step ends the run with the safe command. From any context. */
static inline void iqfoc_commission_abort(iqfoc_commission_t *commission)
{
    commission->abort_requested = true;
}

/*
 * The parameter set of a run that is DONE: for the flux predictor (k = 1/l; skew 0) and for the corrections, with the smallest knee.
 * Both pass their checks, iqfoc_flux_predictor_check and iqfoc_extension_check. From any context.
 */
void iqfoc_commission_parameters(const iqfoc_commission_result_t *result, iqfoc_flux_predictor_t *predictor,
                                 iqfoc_extension_t *extension);

#ifdef __cplusplus
}
#endif

#endif
