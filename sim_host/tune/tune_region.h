/*
 * The machines that a controller must bear: around the nominal one, the 95 % region of a diagnosis'
 * covariance, its intervals, or stated tolerances.
 *
 * R, L_d and L_q that the diagnosis knows with a covariance lie in an ellipsoid, those that it knows by an
 * interval, and those that it does not know, in a box. psi_f is no part of the loop's poles; it has an
 * interval of its own, for drives drawn from the region.
 */
#ifndef SIM_HOST_TUNE_TUNE_REGION_H
#define SIM_HOST_TUNE_TUNE_REGION_H

#include "tune_loop.h"

#include "data/motor.h"
#include "plant/plant_random.h"

/* Shares of the nominal value, where nothing else is known. */
typedef struct tune_tolerances {
    double R, L, psi_f;
} tune_tolerances;

/* A winding warms and cools; inductances saturate; magnets lose a little. */
#define TUNE_TOLERANCE_R     0.3
#define TUNE_TOLERANCE_L     0.3
#define TUNE_TOLERANCE_PSI_F 0.05

enum { TUNE_AXES = 3, TUNE_POINTS_MOST = 64 };

typedef struct tune_point {
    tune_machine machine;
    char text[96]; /* "L_d -30 %, L_q -30 %" */
} tune_point;

typedef struct tune_region {
    tune_machine centre;
    double root[TUNE_AXES][TUNE_AXES];      /* of the covariance of R, L_d, L_q; `known` columns */
    int known;                              /* dimensions of the ellipsoid */
    double radius;                          /* sqrt of chi squared's 95 % point for them */
    double low[TUNE_AXES], high[TUNE_AXES]; /* of the box, off the centre; 0 where the ellipsoid knows */
    double psi_low, psi_high;               /* off the centre */
    double noise_A;                         /* of one phase's current sample; 0: not known */
    bool alike;                             /* the box moves both inductances alike */
    tune_point point[TUNE_POINTS_MOST];     /* the centre, then the region's boundary */
    int points;
    char source[160]; /* what it was made of, in words */
} tune_region;

/* The motor's own machine, at zero current. */
tune_machine tune_machine_of_motor(const motor *m);

/* The nominal machine is the motor's. Tolerances: shares, 0 <= x < 1. */
void tune_region_of_tolerances(const motor *m, const tune_tolerances *t, tune_region *region);

/*
 * The diagnosis' values as the centre, and its covariance or intervals. What it does not know has the
 * tolerances. False with *e set where the file is no diagnosis.
 */
bool tune_region_of_diagnosis(const motor *m, const char *path, const tune_tolerances *t, tune_region *region,
                              error *e);

/* A machine from within it, uniformly in ellipsoid and box. */
tune_machine tune_region_draw(const tune_region *region, plant_random *r);

#endif
