/*
 * A stand-in for the 2019 paper's laboratory (Section 9, Table 3, Fig. 9): the same drive with a controller of
 * uncertain parameters and noisy sensors.
 *
 * The laboratory's errors are unknown, and none is fitted. Each draw is one possible drive, with errors uniform
 * within the usual uncertainty of such a drive. The result is the spread of one-cycle prediction errors over many
 * draws.
 */
#ifndef SIM_HOST_REPRODUCE_LAB_DRIVES_H
#define SIM_HOST_REPRODUCE_LAB_DRIVES_H

#include "method_errors.h"

/* Half widths of the uniform errors, fractions where no unit is in the name; of the noise its deviation. */
typedef struct lab_uncertainty {
    double R;             /* 0.10: a winding 25 K warmer or colder than assumed */
    double L;             /* 0.05 */
    double psi_f;         /* 0.02: magnets by 20 K */
    double voltage;       /* 0.01: DC-link measurement */
    double angle_rad;     /* 1 degree electrical: the sensor's alignment */
    double current_noise; /* 0.005 of the rated peak: of each sample */
} lab_uncertainty;

extern const lab_uncertainty lab_uncertainty_assumed;

enum { LAB_DRAWS = 200 };
#define LAB_SEED UINT64_C(2019)

/* Median and 5 % ... 95 % range of rms error over rms current, percent. */
typedef struct lab_spread {
    double median, low, high;
    double median_iq24;
} lab_spread;

/* which: one of the predictions. d: the true drive at one speed. */
bool lab_spread_of(const motor *m, const steady_drive *d, method which, lab_spread *spread, error *e);

#endif
