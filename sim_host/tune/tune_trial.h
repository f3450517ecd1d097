/*
 * Trial of a design: the firmware's IQ24 code in the switching-level plant, compared with the linear loop's
 * prediction.
 *
 * Trial: drives drawn from the uncertainty set, each at its own speed, take a step of i_q from 30 % to 70 % of the
 * rated peak. The linear loop of the same drive predicts overshoot and settling.
 *
 * Comparison: the motor at several switching-to-fundamental ratios, under the library's other controllers and
 * under designs of both methods for that ratio, with the nominal machine and with its lowest and highest inductance.
 */
#ifndef SIM_HOST_TUNE_TUNE_TRIAL_H
#define SIM_HOST_TUNE_TUNE_TRIAL_H

#include "tune_observer.h"

#include "loops/closed_loop.h"

/* Of the mean of each cycle. */
typedef struct tune_promise {
    double overshoot_percent; /* of the step */
    double settling_cycles;   /* to within 5 % of the rated peak */
} tune_promise;

typedef struct tune_trial {
    int drives;
    int unstable;          /* the current varies or trips */
    int late;              /* settle later than predicted, by more than a tenth and a cycle */
    int high;              /* overshoot by a tenth of the step more than predicted */
    double rpm_most;       /* highest speed: the voltage suffices for the step up to it */
    tune_promise promised; /* worst of those drawn */
    tune_promise found;
    double overshoot_off,
        settling_off;   /* largest difference between prediction and simulation of one drive */
    double rms_percent; /* largest steady error */
} tune_trial;

bool tune_trial_run(const tune_result *r, int drives, uint64_t seed, tune_trial *trial, error *e);

/* The same drives, and a step of i_q, on the observed angle. */
typedef struct tune_observer_trial {
    int drives;
    int unstable; /* the current varies or trips */
    int lost;     /* the observer lost its lock, or the drive has no steady state by the linear loop */
    double predicted_deg; /* largest steady angle error */
    double simulated_deg;
    double off_deg; /* largest difference of both in one drive */
} tune_observer_trial;

/* o: designed. The currents have its noise. */
bool tune_observer_trial_run(const tune_result *r, const tune_observer *o, int drives, uint64_t seed,
                             tune_observer_trial *trial, error *e);

enum { TUNE_RATIOS = 5, TUNE_CONTROLLERS = 6, TUNE_TRUTHS = 3 };
extern const double tune_ratios[TUNE_RATIOS]; /* 5, 8, 10, 20, 50 */
extern const char *const tune_controller_text[TUNE_CONTROLLERS];
extern const char *const tune_controller_key[TUNE_CONTROLLERS];
extern const char *const tune_truth_text[TUNE_TRUTHS]; /* true inductance against the model's */

typedef struct tune_comparison {
    double rpm;
    double L_share;         /* the other truths have L (1 -+ this) */
    bool held[TUNE_RATIOS]; /* false: no design for this SFFR */
    loop_result at[TUNE_RATIOS][TUNE_CONTROLLERS][TUNE_TRUTHS];
    double bandwidth_rad_s[TUNE_RATIOS][2]; /* of the designs, by method */
} tune_comparison;

bool tune_compare(const tune_result *r, const tune_tolerances *t, tune_comparison *c, error *e);

#endif
