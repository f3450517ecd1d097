/* The noise floor and what is left by the angle as numbers of the test: linked with --wrap=measure_floor and --wrap=discrepancy_share. */
#ifndef TESTS_UNIT_HOST_WRAPPED_FLOOR_H
#define TESTS_UNIT_HOST_WRAPPED_FLOOR_H

#include "diagnose/measure/floor.h"
#include "diagnose/weigh/discrepancy.h"

static double floor_A;
static double left_by_angle;

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

double __wrap_discrepancy_share(fit_data *d, const fit_state *s, const averaged_drive *drive,
                                const diagnose_rows *from);

double __wrap_discrepancy_share(fit_data *d, const fit_state *s, const averaged_drive *drive,
                                const diagnose_rows *from)
{
    (void)d;
    (void)s;
    (void)drive;
    (void)from;
    return left_by_angle;
}

#endif
