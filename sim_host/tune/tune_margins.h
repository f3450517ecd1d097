/*
 * Stability margins of a closed loop: the largest errors of its voltage's gain, angle and delay.
 */
#ifndef SIM_HOST_TUNE_TUNE_MARGINS_H
#define SIM_HOST_TUNE_TUNE_MARGINS_H

#include "tune_loop.h"

#include "base/error.h"

/* Upper limits of the search. */
#define TUNE_GAIN_MOST_DB   40.0
#define TUNE_PHASE_MOST_DEG 180.0
#define TUNE_DELAY_MOST     1.0

typedef struct tune_margins {
    double disk;         /* see tune_disk_margin */
    double gain_dB;      /* up or down, both axes alike, whichever is nearer */
    double phase_deg;    /* turned ahead or back, whichever is nearer */
    double delay_cycles; /* in addition to the controller's own one */
} tune_margins;

typedef struct tune_pole {
    double re, im;
} tune_pole;

/* The eigenvalues, loop->order of them. Returns the largest modulus. */
double tune_poles(const tune_loop *loop, tune_pole pole[TUNE_ORDER]);

/*
 * The symmetric disk margin (P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE
 * Control Systems 40(5), 2020) of the voltage: 1/max over the frequencies of the largest singular value of
 * S - 1/2, S the sensitivity from a voltage that is added behind the controller to the voltage that acts. Both
 * axes at once: any gain and phase, and any coupling of the axes, within the disk leave the loop stable. At
 * 0.5 gains from 0.6 to 1.67 together with, or instead of, 28 degrees. 0: unstable.
 */
double tune_disk_margin(const tune_loop *loop);

/* The sensitivity's largest singular value at a frequency, rad per cycle. */
double tune_sensitivity(const tune_loop *loop, double rad_per_cycle);

/* All margins, for a controller and a machine at a speed. */
tune_margins tune_margins_of(const tune_design *design, const tune_machine *truth, double phi_rad);

/* The smaller of both, for each margin. */
tune_margins tune_margins_worst(tune_margins a, tune_margins b);

#endif
