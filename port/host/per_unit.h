/*
 * Physical quantities in double to the firmware's per-unit numbers and back (docs/units.md): bases, scalars,
 * angles, vectors.
 */
#ifndef PORT_HOST_PER_UNIT_H
#define PORT_HOST_PER_UNIT_H

#include "base/vector_complex.h"
#include "data/motor.h"

#include "iqfoc/vector.h"

typedef struct per_unit {
    double I_A; /* current base: peak rated current */
    double U_V; /* voltage base: nominal DC link */
    double T_s; /* control cycle */
} per_unit;

per_unit per_unit_of(const motor *m);

/* To the nearest IQ24; beyond its ends, the end. */
iq24_t iq24_from_double(double x);
double iq24_to_double(iq24_t x);

/* Electrical radians to turns (any number of them: a wrap loses nothing), and rad/s to turns per cycle. */
iq24_t turns_from_rad(double theta_rad);
iq24_t turns_from_speed(double omega_e_rad_s, double T_s);

/* Vectors: x in units of `base` and back. */
iqfoc_ab_t ab_from_complex(double complex x, double base);
double complex complex_from_ab(iqfoc_ab_t v, double base);
double complex complex_from_dq(iqfoc_dq_t v, double base);

#endif
