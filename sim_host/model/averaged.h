/*
 * The exact step of a salient machine over one control cycle (exact_map.h), tabulated over speed: what the
 * averaged drive of the diagnosis runs on. Over a cycle the inverter applies a constant mean voltage in the
 * stationary frame, and the rotor turns at a constant speed.
 */
#ifndef SIM_HOST_MODEL_AVERAGED_H
#define SIM_HOST_MODEL_AVERAGED_H

#include "exact_map.h"

typedef exact_map averaged_step;

/*
 * The step for many speeds near one node: value and first two derivatives by the speed, so that a table of
 * nodes serves all rows of a recording. Within |omega - node| T <= AVERAGED_NODE_STEP / 2 the error is below
 * 1e-7 of each matrix.
 */
#define AVERAGED_NODE_STEP 0.01

/* f(node + h) = value + h slope + h^2 curvature, h in units of AVERAGED_NODE_STEP/T. */
typedef struct averaged_node {
    averaged_step value, slope, curvature;
} averaged_node;

averaged_node averaged_node_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s);

/* The matrices at h node steps from the node, |h| <= 0.5. */
averaged_step averaged_node_step(const averaged_node *node, double h);

#endif
