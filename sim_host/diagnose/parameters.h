/*
 * The numbers that a fit can move, as dimensionless coordinates z around the motor file: z = 0 is what the
 * file says, and a step of 1 is a large change (100 % of R, a radian, the rated current). One table says
 * where each lies in averaged_drive and how z acts.
 */
#ifndef SIM_HOST_DIAGNOSE_PARAMETERS_H
#define SIM_HOST_DIAGNOSE_PARAMETERS_H

#include "../model/averaged_drive.h"
#include "rows.h"

typedef enum parameter_id {
    P_R,
    P_L_D, /* logarithmic: value = nominal e^z */
    P_L_Q, /* logarithmic */
    P_PSI,
    P_SATURATION,
    P_V_DEAD,
    P_KNEE, /* logarithmic */
    P_K_U,
    P_OFFSET_A,
    P_OFFSET_B,
    P_OFFSET_ZERO,
    P_GAIN_A,
    P_GAIN_B,
    P_GAIN_C,
    P_THETA_0,
    P_HARMONIC_1C,
    P_HARMONIC_1S,
    P_HARMONIC_2C,
    P_HARMONIC_2S,
    P_T_DELAY,
    P_U_DELAY_1,
    P_U_DELAY_2,
    P_PSI_5,
    P_PSI_7,
    P_DR_A,
    P_DR_B,
    P_DR_C,
    P_IRON,
    P_IRON_LATE,
    P_EDDY,
    P_EDDY_LATER,
    P_SATURATION_Q,
    P_PSI_11,
    P_PSI_13,
    P_PSI_TEMPERATURE,
    P_R_TEMPERATURE,
    P_RIPPLE, /* share of the ripple that an edge sees */
    P_EDGE,   /* an edge_law; chosen by likelihood, never moved */
    P_COUNT
} parameter_id;

typedef struct parameter_set {
    averaged_drive nominal;
    double scale[P_COUNT]; /* change of the physical value per z (linear ones) */
    double i_rated_peak_A;
    int pole_pairs;
    double knee_max_A; /* a dead time with a larger knee would be a resistance */
} parameter_set;

parameter_set parameters_of(const motor *m, const diagnose_rows *r);

/* The drive at z. */
averaged_drive parameters_drive(const parameter_set *p, const double z[P_COUNT]);

/* d(physical)/dz at z: turns intervals in z into intervals in units. */
double parameters_slope(const parameter_set *p, parameter_id id, const double z[P_COUNT]);

/* The step for differences. */
double parameters_step(parameter_id id);

/* Pulls z back to what is physical: R, L, psi > 0, 0 < knee <= knee_max, gains of 0.6 to 1.6. */
void parameters_bound(const parameter_set *p, double z[P_COUNT]);

#endif
