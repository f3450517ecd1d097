/*
 * A quantity over the time of a run: a constant, steps or ramps, with an excitation on top if wanted.
 *
 *     i_q_A = 5.0
 *     i_q_A = { at_s = [0.0, 0.1], steps = [2.0, 8.0] }
 *     i_q_A = { at_s = [0.0, 0.5], ramp = [-8.0, 8.0] }
 *     i_q_A = { value = 5.0, square = { amplitude = 1.0, period_s = 0.01 } }
 *
 * Before the first point the first value holds, after the last point the last.
 */
#ifndef SIM_HOST_DATA_PROFILE_H
#define SIM_HOST_DATA_PROFILE_H

#include "toml_table.h"

#include <stdbool.h>
#include <stddef.h>

enum { PROFILE_POINTS_MAX = 64 };

typedef enum excitation_shape {
    EXCITATION_NONE,
    EXCITATION_SQUARE, /* +amplitude for the first half of each period, then -amplitude */
    EXCITATION_SINE    /* amplitude * sin(2 pi t / period) */
} excitation_shape;

typedef struct profile {
    size_t points; /* >= 1 */
    double t_s[PROFILE_POINTS_MAX];
    double value[PROFILE_POINTS_MAX]; /* in the unit of the key */
    bool ramps;                       /* linear between points; else each value holds up to the next */
    excitation_shape excitation;
    double amplitude; /* in the unit of the key */
    double period_s;  /* > 0 unless EXCITATION_NONE */
} profile;

profile profile_constant(double value);

/* The value at t, without and with the excitation. */
double profile_base_at(const profile *p, double t_s);
double profile_at(const profile *p, double t_s);

/* Reads a key of a TOML table in any of the forms above; `absent` if the key is not there. */
profile profile_read(toml_table *table, const char *key, toml_range range, double absent);

#endif
