/* The noise floor as a number of the test: linked with --wrap=measure_floor. */
#ifndef TESTS_UNIT_HOST_WRAPPED_FLOOR_H
#define TESTS_UNIT_HOST_WRAPPED_FLOOR_H

#include "diagnose/measure/floor.h"

static double floor_A;

double __wrap_measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                            double *sensor_rms_A);

double __wrap_measure_floor(const diagnose_rows *r, const fit_state *s, const averaged_drive *drive,
                            double *sensor_rms_A)
{
    (void)r;
    (void)s;
    (void)drive;
    *sensor_rms_A = floor_A;
    return floor_A;
}

#endif
