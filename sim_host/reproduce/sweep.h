/*
 * One point of the errors over speed (2019 Fig. 7, `iqfoc sweep`): the drive in steady state and every method
 * on it.
 */
#ifndef SIM_HOST_REPRODUCE_SWEEP_H
#define SIM_HOST_REPRODUCE_SWEEP_H

#include "base/json.h"
#include "exact_errors.h"
#include "method_errors.h"

typedef struct sweep_point {
    double n_rpm;
    double sffr;               /* switching over fundamental frequency; INFINITY at standstill */
    double complex i_mid_dq_A; /* peak, at the mid-point sample */
    double u_dc_V;
    bool link_raised; /* the motor file's link cannot hold this point */
    method_errors errors;
    exact_errors exact;
} sweep_point;

/* The least ratio of switching to fundamental frequency that the library covers. */
#define SWEEP_SFFR_MIN 3.0

/* False with the reason where the drive or the firmware has no such point. */
bool sweep_point_at(const motor *m, const method_machine *machine, double n_rpm, double complex i_mid_dq_A,
                    sweep_point *point, error *e);

/* {"rpm":, "sffr":, "mean": {"standard":, "quasi_discrete":, "exact":}, "prediction": {the same}, "iq24":
 * {"mean":, "prediction":}, ...} */
json_t *sweep_point_json(const sweep_point *p);

/* DIRECTORY/index.html with the errors over the ratio, and the picture as DIRECTORY/sweep.svg. */
bool sweep_page(const char *directory, const motor *m, const sweep_point *points, size_t count, error *e);

#endif
