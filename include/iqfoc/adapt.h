/*
 * Adapts resistance and magnet flux of the model from the errors that the change detector sums (iqfoc/watch.h),
 * within stated bounds. It is for a drive whose model must follow the temperature of winding and magnet. Nothing in
 * the library calls it.
 *
 * The mean error of a block of 32 cycles, in the rotor's frame at mid-cycle, is
 *
 *     e = r x_r + p x_p + rest        x_r, x_p: the change detector's signatures of resistance and flux
 *
 * r and p are the changes that the model does not contain yet, in units of 40 % of R and 1 % of psi_f. In these units
 * both have about the same effect. Each block takes a step of the normalised gradient (Kaczmarz' projection,
 * shortened),
 *
 *     (r, p) += gain (x_r e, x_p e)/(|x_r|^2 + |x_p|^2 + IQFOC_ADAPT_FLOOR)
 *
 * with products of vectors, and e and x over the noise of a sample. For 0 < gain < 2 and no rest the distance to the
 * true (r, p) never grows, whatever the drive does. A rest moves r and p only within the bounds.
 *
 *     if (iqfoc_watch_step(...)) {
 *         iqfoc_adapt_block(&adapt, &adapt_config, &watch, &watch_config, speed);
 *         (void)iqfoc_watch_block(...);
 *         law = iqfoc_adapt_law(&nominal, &adapt);        in force from the next iqfoc_tuned_at_speed, at a valley
 *     }
 */
#ifndef IQFOC_ADAPT_H
#define IQFOC_ADAPT_H

#include "tuned_control.h"
#include "watch.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Relative changes, IQ24. */
typedef struct iqfoc_adapt_config {
    iq24_t gain;     /* 0 ... 1; 1/64 follows a change within a second or two at 8 kHz */
    iq24_t r_low;    /* -0.5 ... 0 */
    iq24_t r_high;   /* 0 ... 1 */
    iq24_t psi_low;  /* -0.25 ... 0 */
    iq24_t psi_high; /* 0 ... 0.25 */
} iqfoc_adapt_config_t;

/* The state. Zero is the nominal model. */
typedef struct iqfoc_adapt {
    iq24_t r;   /* change of R over the nominal R */
    iq24_t psi; /* change of psi_f over the nominal psi_f */
} iqfoc_adapt_t;

/* A copper winding from -20 to 150 degrees C, nominal at 20; a magnet that may lose a tenth. */
#define IQFOC_ADAPT_CONFIG                                                                                   \
    {                                                                                                        \
        IQ24(1.0 / 64.0), IQ24(-0.2), IQ24(0.55), IQ24(-0.1), IQ24(0.03)                                     \
    }

/* The units of a step, as shares: 4 times and half of the change detector's stated sizes. */
#define IQFOC_ADAPT_R   0.4
#define IQFOC_ADAPT_PSI 0.01

/* A quarter of a sample's noise, squared. With signatures below it the steps are small. */
#define IQFOC_ADAPT_FLOOR_Q32 (INT64_C(1) << 28)

/*
 * One step for a complete block, between iqfoc_watch_step and iqfoc_watch_block and in their context. speed: at
 * this valley, |speed| <= IQFOC_ROTOR_SPEED_MAX (held to it). No step is made in the first block after a reset, below
 * a current of 0.15, or after an alarm: a change that raised an alarm must be recorded, not corrected.
 *
 * Largest error: 2.2e-4 of a unit per block, of 60000 drawn; 5e-4 by analysis, where x is a quarter of the noise (e is two
 * roundings off in Q16 of it, x one). e and x are held to +-128 of the noise.
 */
void iqfoc_adapt_block(iqfoc_adapt_t *adapt, const iqfoc_adapt_config_t *config, const iqfoc_watch_t *watch,
                       const iqfoc_watch_config_t *watch_config, iq24_t speed);

/*
 * The law with adapted R and psi_f. Constants are rounded down in their own formats and held to their ranges, rho <=
 * 1 and k_psi <= 8. In the context of iqfoc_adapt_block.
 */
iqfoc_tuned_law_t iqfoc_adapt_law(const iqfoc_tuned_law_t *nominal, const iqfoc_adapt_t *adapt);

#ifdef __cplusplus
}
#endif

#endif
