/*
 * Sensors: what the firmware and the recording see. Channel x reads, at its sampling instant,
 *     ADC( gain_x * (low-passed current) + offset_x + noise ),
 * the angle sensor true(t + t_delay) + theta_0 + amplitude cos(order theta_mech + phase) + noise, the speed behind its filter.
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
    plant_random current, angle, loose; /* streams apart: one sensor's noise does not move another's */
    long loose_left;                    /* samples of this dropout still to come */
    long dropouts;
    bool speed_begun;                                      /* the speed's filter has seen a sample, */
    double speed_at_s, speed_true_rad_s, speed_seen_rad_s; /* when, what it was, and what came through */
} sensor_memory;

/* What is true at the sampling instant. */
typedef struct sensor_truth {
    double t_s;
    double clock_s; /* from which gains and offsets drift */
    double i_A[3];  /* behind the low-pass, if there is one */
    double theta_mech_rad, omega_e_rad_s, accel_e_rad_s2;
    double u_dc_V;
} sensor_truth;

void sensor_init(sensor_memory *m, uint64_t seed);

void sensor_read(const plant_config *c, sensor_memory *m, const sensor_truth *truth, plant_samples *s);

#endif
