/*
 * A machine without saliency behind ideal switches: its current from edge to edge by the exact solution, for runs that set the edges
 * themselves. The speed is constant from edge to edge.
 */
#ifndef SIM_HOST_PLANT_EDGE_MACHINE_H
#define SIM_HOST_PLANT_EDGE_MACHINE_H

#include <complex.h>

#define EDGE_MACHINE_RIPPLE_HZ 300.0

typedef struct edge_machine {
    double R_ohm, L_s_H, psi_f_Wb;
    double u_dc_V;
    double ripple;    /* of the link, as a share of u_dc_V */
    double time_s;    /* of the state */
    double w;         /* electrical speed, rad/s */
    double theta;     /* rad, not wrapped */
    double complex i; /* A, stationary frame */
    int level[3];     /* of the legs: 1 or -1 */
} edge_machine;

double edge_machine_link_V(const edge_machine *m, double time_s);

/* The state at to_s, under the levels as they are. Does nothing if to_s has passed. */
void edge_machine_flow(edge_machine *m, double to_s);

#endif
