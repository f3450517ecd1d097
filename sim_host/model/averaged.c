/* The exact step, tabulated over speed (averaged.h). */
#include "averaged.h"

#include <stddef.h>

enum { ENTRIES = sizeof(averaged_step) / sizeof(double) };

static averaged_step step_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s)
{
    averaged_step step;
    exact_maps(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s, &step, NULL);
    return step;
}

averaged_node averaged_node_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s)
{
    double h = AVERAGED_NODE_STEP / T_s;
    averaged_step below = step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s - h);
    averaged_step above = step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s + h);
    averaged_node node;
    node.value = step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s);
    const double *b = &below.decay[0][0];
    const double *m = &node.value.decay[0][0];
    const double *t = &above.decay[0][0];
    double *slope = &node.slope.decay[0][0];
    double *curvature = &node.curvature.decay[0][0];
    for (size_t k = 0; k < ENTRIES; k++) {
        slope[k] = 0.5 * (t[k] - b[k]);
        curvature[k] = 0.5 * (t[k] + b[k]) - m[k];
    }
    return node;
}

averaged_step averaged_node_step(const averaged_node *node, double h)
{
    averaged_step step;
    const double *value = &node->value.decay[0][0];
    const double *slope = &node->slope.decay[0][0];
    const double *curvature = &node->curvature.decay[0][0];
    double *out = &step.decay[0][0];
    for (size_t k = 0; k < ENTRIES; k++) {
        out[k] = value[k] + h * (slope[k] + h * curvature[k]);
    }
    return step;
}
