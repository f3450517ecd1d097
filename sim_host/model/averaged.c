#include "averaged.h"

#include <math.h>
#include <stddef.h>

/* Gauss-Legendre, six points on [0, 1]; Abramowitz and Stegun, table 25.4, halved. */
static const double node6[6] = {0.033765242898424, 0.169395306766868, 0.380690406958402,
                                0.619309593041598, 0.830604693233132, 0.966234757101576};
static const double weight6[6] = {0.085662246189585, 0.180380786524069, 0.233956967286346,
                                  0.233956967286346, 0.180380786524069, 0.085662246189585};

enum { ENTRIES = sizeof(averaged_step) / sizeof(double) };

/*
 * e^{A s}. A = -a 1 + B with B = [-d, w; -w, d] and B^2 = (d^2 - w^2) 1, hence
 * e^{A s} = e^{-a s} (cos(n s) 1 + sin(n s)/n B), n^2 = w^2 - d^2; the hyperbolic pair where n^2 < 0.
 */
static void exponential(double a, double d, double w, double s, double out[2][2])
{
    double n2 = (w * w - d * d) * s * s;
    double c;
    double f; /* sin(n s) / (n s) */
    if (fabs(n2) < 1e-4) {
        c = 1.0 - n2 / 2.0 * (1.0 - n2 / 12.0 * (1.0 - n2 / 30.0));
        f = 1.0 - n2 / 6.0 * (1.0 - n2 / 20.0 * (1.0 - n2 / 42.0));
    } else if (n2 > 0.0) {
        double n = sqrt(n2);
        c = cos(n);
        f = sin(n) / n;
    } else {
        double n = sqrt(-n2);
        c = cosh(n);
        f = sinh(n) / n;
    }
    double e = exp(-a * s);
    out[0][0] = e * (c - f * s * d);
    out[0][1] = e * f * s * w;
    out[1][0] = -e * f * s * w;
    out[1][1] = e * (c + f * s * d);
}

averaged_step averaged_step_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s)
{
    double a = 0.5 * R_ohm * (1.0 / L_d_H + 1.0 / L_q_H);
    double d = 0.5 * R_ohm * (1.0 / L_d_H - 1.0 / L_q_H);
    averaged_step step = {{{0}}, {{0}}, {{0}}};
    exponential(a, d, omega_rad_s, T_s, step.decay);
    for (size_t k = 0; k < 6; k++) {
        double e[2][2];
        double s = node6[k] * T_s;
        exponential(a, d, omega_rad_s, s, e);
        double weight = weight6[k] * T_s;
        double c = cos(omega_rad_s * (T_s - s));
        double f = sin(omega_rad_s * (T_s - s));
        for (size_t row = 0; row < 2; row++) {
            step.drive[row][0] += weight * (e[row][0] * c - e[row][1] * f);
            step.drive[row][1] += weight * (e[row][0] * f + e[row][1] * c);
            step.push[row][0] += weight * e[row][0];
            step.push[row][1] += weight * e[row][1];
        }
    }
    return step;
}

averaged_node averaged_node_at(double R_ohm, double L_d_H, double L_q_H, double T_s, double omega_rad_s)
{
    double h = AVERAGED_NODE_STEP / T_s;
    averaged_step below = averaged_step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s - h);
    averaged_step above = averaged_step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s + h);
    averaged_node node;
    node.value = averaged_step_at(R_ohm, L_d_H, L_q_H, T_s, omega_rad_s);
    const double *b = &below.decay[0][0];
    const double *m = &node.value.decay[0][0];
    const double *t = &above.decay[0][0];
    double *slope = &node.slope.decay[0][0];
    double *bend = &node.bend.decay[0][0];
    for (size_t k = 0; k < ENTRIES; k++) {
        slope[k] = 0.5 * (t[k] - b[k]);
        bend[k] = 0.5 * (t[k] + b[k]) - m[k];
    }
    return node;
}

averaged_step averaged_node_step(const averaged_node *node, double h)
{
    averaged_step step;
    const double *value = &node->value.decay[0][0];
    const double *slope = &node->slope.decay[0][0];
    const double *bend = &node->bend.decay[0][0];
    double *out = &step.decay[0][0];
    for (size_t k = 0; k < ENTRIES; k++) {
        out[k] = value[k] + h * (slope[k] + h * bend[k]);
    }
    return step;
}
