/*
 * The speed control of a design (iqfoc/speed_control.h): the highest bandwidth w whose disk margin reaches the design's requirement, for
 * an inertia TUNE_INERTIA_OFF lower or higher than stated. It acts on the speed of a tracker (iqfoc/tracker.h) with TUNE_TRACKER_TIMES the
 * bandwidth, on the tuned current control.
 *
 * The loop is linear, and computed over one step of the speed control, N cycles, in which the reference of the current is constant:
 *
 *     i_(k+2) = follow i_(k+1) + (1 - follow) i_ref            the tuned current control
 *     v_(k+1) = v_k + a (i_k + i_(k+1))/2                      the shaft; v in turns per cycle
 *     tracker, integral                                        their headers' lines
 */
#ifndef SIM_HOST_TUNE_TUNE_SPEED_H
#define SIM_HOST_TUNE_TUNE_SPEED_H

#include "tune_design.h"

#define TUNE_INERTIA_OFF   0.3
#define TUNE_TRACKER_TIMES 10.0
#define TUNE_SPEED_STEP_S  1e-3 /* the longest time of a step, unless a cycle is longer */
#define TUNE_SPEED_LOAD                                                                                      \
    0.5 /* load of the trial, share of the rated torque; less if its dip is more than TUNE_SPEED_DIP of n_max */
#define TUNE_SPEED_DIP 0.1

/* Heavy, stated and light shaft. */
enum { TUNE_SHAFTS = 3 };
extern const double tune_shafts[TUNE_SHAFTS];

/* The trial's parts, one after the other: run-up, load, and a step of the set-point with the load. */
enum { TUNE_RUN_UP, TUNE_LOADED, TUNE_STEPPED, TUNE_PARTS };
enum { TUNE_POINTS = 120 };
#define TUNE_SPEED_STEP 0.05 /* of the set-point, share of the run-up's speed */

/* What the plant did in a part: point n is n span_s/TUNE_POINTS after its begin. NAN: this shaft's part is over. */
typedef struct tune_trace {
    double span_s;
    double rpm[TUNE_SHAFTS][TUNE_POINTS];
    double i_q[TUNE_SHAFTS][TUNE_POINTS]; /* true mean of a cycle over the rated peak */
} tune_trace;

typedef struct tune_speed {
    double J_kgm2; /* 0: no inertia was stated, and nothing below is set */
    double bandwidth_rad_s;
    double tracker_rad_s;
    int cycles; /* N */
    double ramp_rpm_s;
    bool ramp_limited; /* the rated current allows no faster one */
    double disk;       /* the smaller of both inertias' */
    double disk_nominal;
    double load;    /* of the trial, share of the rated torque */
    double dip_rpm; /* predicted for it by the linear loop, stated inertia */
    /* On the switching plant: run-up from standstill to half of n_max, then the step of the load, then
     * that of the set-point. */
    double rpm;                        /* half of n_max */
    double overshoot_rpm[TUNE_SHAFTS]; /* of the run-up */
    double found_dip_rpm[TUNE_SHAFTS];
    double
        settled_s[TUNE_SHAFTS]; /* from the step until the speed stays within a tenth of the predicted dip */
    uint32_t status[TUNE_SHAFTS];           /* of the firmware */
    bool lost[TUNE_SHAFTS];                 /* the speed left twice n_max: the trial ended there */
    double step_overshoot_rpm[TUNE_SHAFTS]; /* of the step of the set-point */
    tune_trace trace[TUNE_PARTS];
} tune_speed;

/* a: turns per cycle^2 for the rated peak current, of the design's machine. */
double tune_speed_acceleration(const tune_result *r, double J_kgm2);

/* The disk margin of the speed loop with this inertia, for a controller made for s->J_kgm2; 0: unstable. */
double tune_speed_disk(const tune_result *r, const tune_speed *s, double bandwidth_rad_s, double J_kgm2);

/* Designs for J_kgm2 > 0 and a run-up in run_up_s. False with *e set if a value does not fit the library's ranges. */
bool tune_speed_find(const tune_result *r, double J_kgm2, double run_up_s, tune_speed *s, error *e);

/* The trial in the plant. */
bool tune_speed_trial(const tune_result *r, tune_speed *s, error *e);

#endif
