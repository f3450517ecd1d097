/*
 * The machine and its shaft as differential equations, with everything the linear path leaves out:
 * saturation, harmonics of the magnet's flux, unequal phases, iron loss, a speed that changes.
 *
 * With i_m = i - i_fe the part of the phase current that magnetises, psi(i_m, theta) the flux linkages in the
 * stationary frame and e = u - R i - M di/dt the voltage left to change them, M the phases' unequal inductances:
 *
 *     e = dpsi/dt = (dpsi/di_m) di_m/dt + omega dpsi/dtheta
 *     e = R_fe i_fe + tau_fe R_fe di_fe/dt
 *
 * A short circuit of a share s of phase x's turns is in parallel with the flux, like the iron: its current i_f adds 2/3 s i_f along
 * the phase's axis to the terminals', and
 *
 *     s (R i_x + e_x) = (R_f + s R) (i_f + tau di_f/dt),   u = R (i - 2/3 s i_f) + e
 *
 * so that di/dt is affine in u: machine_terms holds the matrix and the rest, for the inverter's zero-current
 * clamp needs to solve it for a leg's voltage.
 */
#ifndef SIM_HOST_PLANT_PLANT_MACHINE_H
#define SIM_HOST_PLANT_PLANT_MACHINE_H

#include "../base/vector.h"
#include "plant_config.h"

/* Indices of the state vector. Angles run on within a cycle and are wrapped between cycles. */
enum {
    STATE_I_ALPHA, /* phase current, A */
    STATE_I_BETA,
    STATE_THETA_E, /* rad */
    STATE_OMEGA_E, /* rad/s */
    STATE_PLAIN, /* the states of every machine; the next are for iron loss, turns that are shorted, and drift */
    STATE_FE_ALPHA = STATE_PLAIN, /* iron-loss current, A */
    STATE_FE_BETA,
    STATE_CLOCK,      /* s, from which values drift */
    STATE_CONTROLLED, /* the states above steer the step size; the integrals below follow */
    STATE_INT_I_ALPHA = STATE_CONTROLLED, /* since the cycle began, As */
    STATE_INT_I_BETA,
    STATE_INT_I_D,
    STATE_INT_I_Q,
    STATE_INT_U_ALPHA, /* Vs */
    STATE_INT_U_BETA,
    STATE_COUNT
};

typedef struct plant_state {
    double y[STATE_COUNT];
    vec_ab seen_A; /* current behind the sensors' low-pass, if there is one */
} plant_state;

typedef struct machine_terms {
    vec_rotor r;
    vec_ab i_A; /* phase current */
    vec_dq i_dq_A;
    double rate[2][2]; /* di/dt = rate * u + drift, stationary frame */
    vec_ab drift_A_s;
    double to_iron[2]; /* di_fe/dt = to_iron[0] * (u - drop) - to_iron[1] * i_fe */
    /* Of a short circuit in place of the iron: di_fe/dt = axis (to_short * (axis . (u - drop)) + short_A_s). */
    double to_short, short_A_s;
    vec_ab short_axis;
    vec_ab drop_V; /* R i */
    vec_ab i_fe_A;
    double torque_Nm;
} machine_terms;

/* Temperature rise of winding and magnet since time zero. */
double machine_warmer_K(const plant_machine *m, double clock_s);

/* True if the states above STATE_PLAIN act on the others. */
bool machine_has_more_states(const plant_machine *m);

void machine_linearise(const plant_config *c, const plant_state *s, machine_terms *t);

/* The rate of every state, with u the voltage of the legs (before their on-resistance). */
void machine_rates(const plant_config *c, const plant_state *s, const machine_terms *t, vec_ab u_V,
                   double rate[STATE_COUNT]);

#endif
