/*
 * The error of the recorded angle that repeats with the revolution: what [[extension.angle_harmonic]] of a motor file
 * states. The firmware does not correct it, so it is removed here from the angle that the observer is compared with.
 *
 *     recorded = true + sum of amplitude cos(order theta_mech + phase)          theta_mech: the true one
 *
 * The recorded mechanical angle has the same error over pole_pairs. Without a recorded one, theta_mech is counted from the
 * electrical angle, and each stretch of a recording begins at an unknown multiple of 2 pi/pole_pairs: `turned`.
 */
#ifndef SIM_HOST_OBSERVE_SENSOR_ERROR_H
#define SIM_HOST_OBSERVE_SENSOR_ERROR_H

#include "data/motor.h"
#include "data/recording.h"

typedef struct sensor_error {
    motor_harmonic entry[ANGLE_ORDERS]; /* of the motor given; it must outlive this */
    int entries;
    int pole_pairs;
} sensor_error;

/* m: not changed. */
sensor_error sensor_error_of(motor *m);

/* The error at a recorded mechanical angle, rad electrical. Three steps leave the fourth power of order times amplitude. */
double sensor_error_at(const sensor_error *s, double theta_mech_rad);

/*
 * The mechanical angles of a stretch: the recorded ones, or those counted from the electrical angle, turned by
 * turned * 2 pi/pole_pairs.
 */
void sensor_error_angles(const recording *r, const stretch *at, int pole_pairs, int turned,
                         double *theta_mech_rad);

/*
 * The `turned`, 0 ... pole_pairs - 1, for which `off_rad`, observed minus recorded angle of each row of the stretch with
 * NAN for rows that do not count, plus the sensor's error is smallest in the mean square. 0 with a recorded mechanical
 * angle.
 */
int sensor_error_turned(const sensor_error *s, const recording *r, const stretch *at, const double *off_rad,
                        double *theta_mech_rad);

#endif
