/*
 * Sensors: the values that the firmware and the recording get. Channel x reads, at its sampling instant,
 *     ADC( play(gain_x * (low-passed current) + offset_x) + crosstalk + edges + hum + noise ),
 * the angle sensor true(t + t_delay) + theta_0 + sum of amplitude cos(order theta_mech + phase) + noise, the speed behind its filter.
 */
#ifndef SIM_HOST_PLANT_PLANT_SENSOR_H
#define SIM_HOST_PLANT_PLANT_SENSOR_H

#include "plant_config.h"
#include "plant_random.h"

#include <stdbool.h>

typedef struct plant_samples {
    double t_s; /* since plant_init */
    double i_A[3];
    double theta_e_rad;    /* in [0, 2 pi) */
    double theta_mech_rad; /* the same sensor's, in [0, 2 pi) */
    double omega_e_rad_s;
    double u_dc_V;
    double temp_C; /* the winding's */
} plant_samples;

typedef struct sensor_memory {
    plant_random current, angle, loose, edge; /* streams apart: one sensor's noise does not move another's */
    long loose_left;                          /* samples of this dropout still to come */
    long dropouts;
    bool speed_begun;                                      /* the speed's filter has seen a sample, */
    double speed_at_s, speed_true_rad_s, speed_seen_rad_s; /* when, what it was, and what came through */
    bool held_begun;
    double held_A[3]; /* what channels with hysteresis show */
} sensor_memory;

/* What is true at the sampling instant. */
typedef struct sensor_truth {
    double t_s;
    double clock_s; /* from which gains and offsets drift */
    double i_A[3];  /* behind the low-pass, if there is one */
    double theta_mech_rad, omega_e_rad_s, accel_e_rad_s2;
    double u_dc_V;
    double edge_age_s[3]; /* since the last switching edge of each leg; INFINITY: none yet */
    double edge_sign[3];  /* 1: it rose */
} sensor_truth;

void sensor_init(sensor_memory *m, uint64_t seed);

void sensor_read(const plant_config *c, sensor_memory *m, const sensor_truth *truth, plant_samples *s);

#endif
