/*
 * Resistance and magnet followed from the errors that the watch sums (iqfoc/watch.h), within stated bounds: for a drive
 * whose model is to keep up with a winding and a magnet that warm. Nothing calls it by itself.
 *
 * The mean error of a block of 32 cycles, in the rotor's frame at mid-cycle, is
 *
 *     e = r x_r + p x_p + rest        x_r, x_p: the watch's signatures of resistance and flux
 *
 * with r and p the changes that the model does not have yet, in units of 40 % of R and 1 % of psi_f, by which both show
 * about alike.
 * Each block takes a step of the normalised gradient (Kaczmarz' projection, shortened),
 *
 *     (r, p) += gain (x_r e, x_p e)/(|x_r|^2 + |x_p|^2 + IQFOC_ADAPT_FLOOR)
 *
 * where products are those of vectors, and e and x are over the noise of a sample. For 0 < gain < 2 and no rest the
 * distance to the true (r, p) grows in no block, whatever the drive does; a rest moves them within the bounds.
 *
 *     if (iqfoc_watch_step(...)) {
 *         iqfoc_adapt_block(&adapt, &adapt_config, &watch, &watch_config, turns);
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
    iq24_t gain;     /* 0 ... 1; of 1/64 a change is followed in a second or two at 8 kHz */
    iq24_t r_low;    /* -0.5 ... 0 */
    iq24_t r_high;   /* 0 ... 1 */
    iq24_t psi_low;  /* -0.25 ... 0 */
    iq24_t psi_high; /* 0 ... 0.25 */
} iqfoc_adapt_config_t;

/* Zero it to begin anew: the nominal law. */
typedef struct iqfoc_adapt {
    iq24_t r;   /* of R, over the nominal one */
    iq24_t psi; /* of psi_f */
} iqfoc_adapt_t;

/* A winding from -20 to 150 degrees about one at 20, copper; a magnet that may lose a tenth. */
#define IQFOC_ADAPT_CONFIG                                                                                   \
    {                                                                                                        \
        IQ24(1.0 / 64.0), IQ24(-0.2), IQ24(0.55), IQ24(-0.1), IQ24(0.03)                                     \
    }

/* The units of a step, as shares: 4 times and half of the watch's stated sizes. */
#define IQFOC_ADAPT_R   0.4
#define IQFOC_ADAPT_PSI 0.01

/* A quarter of a sample's noise, squared: where neither shows by that, little is learnt. */
#define IQFOC_ADAPT_FLOOR_Q32 (INT64_C(1) << 28)

/*
 * A complete block, between iqfoc_watch_step and iqfoc_watch_block. turns: speed at this valley, |turns| <=
 * IQFOC_ROTOR_TURNS_MAX (held to it). Not in the first block after a reset, nor below 0.15 of current, nor from the
 * watch's alarm on: what has changed is then to be recorded, and not to be made good.
 *
 * Largest error: 2.2e-4 of a unit per block, of 60000 drawn; 5e-4 by analysis, where x is a quarter of the noise (e is two
 * roundings off in Q16 of it, x one). e and x are held to +-128 of the noise.
 */
void iqfoc_adapt_block(iqfoc_adapt_t *adapt, const iqfoc_adapt_config_t *config, const iqfoc_watch_t *watch,
                       const iqfoc_watch_config_t *watch_config, iq24_t turns);

/*
 * The law with R and psi_f so changed. Rounded down in the constants' own formats; held at their ranges' ends, rho <= 1
 * and k_psi <= 8.
 */
iqfoc_tuned_law_t iqfoc_adapt_law(const iqfoc_tuned_law_t *nominal, const iqfoc_adapt_t *adapt);

#ifdef __cplusplus
}
#endif

#endif
