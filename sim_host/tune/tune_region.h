/*
 * The uncertainty set: the machines for which a controller must keep its margin. Around the nominal machine it is the
 * 95 % set of a diagnosis' covariance, its intervals, or stated tolerances.
 *
 * R, L_d and L_q with a covariance are in an ellipsoid; with an interval, or without either, in a box. psi_f does not
 * change the loop's poles. It has its own interval, for drives drawn from the set.
 */
#ifndef SIM_HOST_TUNE_TUNE_REGION_H
#define SIM_HOST_TUNE_TUNE_REGION_H

#include "tune_loop.h"

#include "data/motor.h"
#include "plant/plant_random.h"

/* Shares of the nominal value, for values without a diagnosis. */
typedef struct tune_tolerances {
    double R, L, psi_f;
} tune_tolerances;

/* A winding warms and cools; inductances saturate; magnets lose a little. */
#define TUNE_TOLERANCE_R     0.3
#define TUNE_TOLERANCE_L     0.3
#define TUNE_TOLERANCE_PSI_F 0.05

enum { TUNE_AXES = 3, TUNE_POINTS_MOST = 128 };

typedef struct tune_point {
    tune_machine machine;
    char text[96]; /* "L_d -30 %, L_q -30 %" */
} tune_point;

typedef struct tune_region {
    tune_machine centre;
    double root[TUNE_AXES][TUNE_AXES]; /* of the covariance of R, L_d, L_q; `known` columns */
    int known;                         /* dimensions of the ellipsoid */
    double radius;                     /* sqrt of chi squared's 95 % point for them */
    double low[TUNE_AXES],
        high[TUNE_AXES];      /* of the box, relative to the centre; 0 on the ellipsoid's axes */
    double psi_low, psi_high; /* relative to the centre */
    double L_off;             /* share that L may be off by at the diagnosed currents: without the fall */
    double fall_d, fall_q;    /* of L with the current: the share that the set reaches down to at least */
    const char *fall_source;  /* NULL: stated tolerances alone */
    double noise_A;           /* of one phase's current sample; 0: unknown */
    bool alike;               /* the box moves both inductances alike */
    tune_point point[TUNE_POINTS_MOST]; /* the centre, then the boundary */
    int points;
    char source[160]; /* its origin, in words */
} tune_region;

/* The motor's own machine, at zero current. */
tune_machine tune_machine_of_motor(const motor *m);

/*
 * Fall of the inductances with the current, by the motor file's saturation or flux map: the largest share at currents
 * up to the rated peak in every direction. All 0 without either.
 */
typedef struct tune_fall {
    double d, q; /* of the incremental inductances */
    double flux; /* of the current's flux, relative to L i */
    bool known;  /* the motor file has a saturation or a flux map */
} tune_fall;

tune_fall tune_fall_of(const motor *m);

/* The nominal machine is the motor's. Tolerances: shares, 0 <= x < 1. */
void tune_region_of_tolerances(const motor *m, const tune_tolerances *t, tune_region *region);

/*
 * Centre: the diagnosis' values. Size: its covariance or intervals, and the tolerances for values without either.
 * A diagnosis states L for the currents of its recording. The set reaches down to the fall of the incremental L up to
 * the rated peak: by the motor file's saturation or flux map, or by the tolerance of L if the file has neither.
 * False with *e set if the file is no diagnosis.
 */
bool tune_region_of_diagnosis(const motor *m, const char *path, const tune_tolerances *t, tune_region *region,
                              error *e);

/* A machine drawn from the set, uniformly in ellipsoid and box. */
tune_machine tune_region_draw(const tune_region *region, plant_random *r);

#endif
