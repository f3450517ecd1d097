/* The closed loop as a linear system (tune_loop.h). */
#include "tune_loop.h"

#include "model/exact_map.h"

#include <math.h>
#include <string.h>

const tune_fault tune_no_fault = {1.0, 0.0, 0.0};

typedef double matrix[2][2];

static void multiply(matrix a, matrix b, matrix out)
{
    matrix r;
    for (int n = 0; n < 2; n++) {
        for (int m = 0; m < 2; m++) {
            r[n][m] = a[n][0] * b[0][m] + a[n][1] * b[1][m];
        }
    }
    memcpy(out, r, sizeof r);
}

/* e^(j angle) as it acts on a vector of two components, times a gain. */
static void turn(double gain, double angle, matrix out)
{
    out[0][0] = out[1][1] = gain * cos(angle);
    out[1][0] = gain * sin(angle);
    out[0][1] = -out[1][0];
}

/* The maps are of flux: L^-1 map L for the current, L^-1 map for the voltage. */
static void to_current(const tune_machine *m, double decay[2][2], double drive[2][2], matrix F, matrix G)
{
    const double L[2] = {m->L_d_H, m->L_q_H};
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            F[n][k] = decay[n][k] * L[k] / L[n];
            G[n][k] = drive[n][k] / L[n];
        }
    }
}

static void over(const tune_machine *m, double span_s, double omega_rad_s, matrix F, matrix G)
{
    exact_map end;
    exact_maps(m->R_ohm, m->L_d_H, m->L_q_H, span_s, omega_rad_s, &end, NULL);
    to_current(m, end.decay, end.drive, F, G);
}

/* What the current at a time within the cycle is made of. */
typedef struct span_parts {
    matrix i, v, last;
} span_parts;

/* The old voltage acts until `delay`, the new one afterwards. t and delay: shares of the cycle. */
static void parts_at(const tune_machine *m, double phi, double T_s, const tune_fault *fault, double t,
                     span_parts *out)
{
    const double omega = phi / T_s;
    const double old = fmin(t, fault->delay);
    matrix act;
    matrix back;
    memset(out, 0, sizeof *out);
    turn(fault->gain, fault->angle_rad, act);
    turn(1.0, -phi, back);
    over(m, old * T_s, omega, out->i, out->last);
    multiply(out->last, back, out->last);
    if (t > fault->delay) {
        matrix F;
        matrix G;
        over(m, (t - old) * T_s, omega, F, G);
        turn(1.0, -phi * old, back);
        multiply(F, out->i, out->i);
        multiply(F, out->last, out->last);
        multiply(G, back, out->v);
    }
    multiply(out->v, act, out->v);
    multiply(out->last, act, out->last);
}

static void invert(matrix a, matrix out)
{
    const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    const matrix r = {{a[1][1] / det, -a[0][1] / det}, {-a[1][0] / det, a[0][0] / det}};
    memcpy(out, r, sizeof r);
}

/* rows of `to` (a pair of states) += share * m * (a pair of columns `from`). */
static void add(double a[][TUNE_ORDER], int to, int from, double share, matrix m)
{
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            a[to + n][from + k] += share * m[n][k];
        }
    }
}

/* Rows of the pair `to` += share * m * rows of the pair `from`, of the same matrix. */
static void add_rows(double a[][TUNE_ORDER], int to, double share, matrix m, int from)
{
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < TUNE_ORDER; k++) {
            a[to + n][k] += share * (m[n][0] * a[from][k] + m[n][1] * a[from + 1][k]);
        }
    }
}

/* The machine's next state, and the mean's offset from the valleys that the next valley measures. */
static void machine_rows(const tune_machine *truth, double phi, double T_s, const tune_fault *fault,
                         tune_loop *loop)
{
    const double h = 0.5 * phi;
    const double s1 = fabs(h) > 1e-6 ? sin(h) / h : 1.0 - h * h / 6.0;
    const double bow = fabs(h) > 1e-3 ? (1.0 - s1 * s1) / (1.0 - cos(h)) : 2.0 / 3.0;
    matrix one = {{1.0, 0.0}, {0.0, 1.0}};
    span_parts end;
    span_parts mid;
    parts_at(truth, phi, T_s, fault, 1.0, &end);
    parts_at(truth, phi, T_s, fault, 0.5, &mid);
    loop->voltage_of_mean = 1.0 / (s1 * s1);
    add(loop->a, TUNE_I, TUNE_I, 1.0, end.i);
    add(loop->a, TUNE_I, TUNE_V, 1.0, end.v);
    add(loop->a, TUNE_I, TUNE_LAST, 1.0, end.last);
    add(loop->a, TUNE_LAST, TUNE_V, 1.0, one);
    /* ends - (ends + bow (mid - ends))/s1^2, ends = (i + i')/2. */
    const double of_ends = 1.0 - loop->voltage_of_mean * (1.0 - bow);
    const double of_mid = -loop->voltage_of_mean * bow;
    add(loop->a, TUNE_Z, TUNE_I, 0.5 * of_ends, one);
    add(loop->a, TUNE_Z, TUNE_I, 0.5 * of_ends, end.i);
    add(loop->a, TUNE_Z, TUNE_V, 0.5 * of_ends, end.v);
    add(loop->a, TUNE_Z, TUNE_LAST, 0.5 * of_ends, end.last);
    add(loop->a, TUNE_Z, TUNE_I, of_mid, mid.i);
    add(loop->a, TUNE_Z, TUNE_V, of_mid, mid.v);
    add(loop->a, TUNE_Z, TUNE_LAST, of_mid, mid.last);
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            loop->push[TUNE_I + n][k] = end.v[n][k];
            loop->push[TUNE_Z + n][k] = 0.5 * of_ends * end.v[n][k] + of_mid * mid.v[n][k];
        }
    }
}

/* The controller's states and its voltage, as iqfoc/tuned_control.h says. */
static void controller_rows(const tune_design *d, double phi, tune_loop *loop)
{
    matrix one = {{1.0, 0.0}, {0.0, 1.0}};
    matrix F;
    matrix G;
    matrix inverse;
    matrix keep;
    matrix rest;
    over(&d->machine, d->T_s, phi / d->T_s, F, G);
    invert(G, inverse);
    turn(d->keep, -phi, keep);
    loop->keep_re = keep[0][0];
    loop->keep_im = keep[1][0];
    loop->follow = d->follow;
    add(loop->a, TUNE_D, TUNE_D, 1.0, one);
    add(loop->a, TUNE_D, TUNE_I, d->learn, one);
    add(loop->a, TUNE_D, TUNE_P, -d->learn, one);
    add(loop->a, TUNE_O, TUNE_O, 1.0 - d->learn_offset, one);
    add(loop->a, TUNE_O, TUNE_Z, d->learn_offset, one);
    add_rows(loop->a, TUNE_P, 1.0, one, TUNE_D);
    add(loop->a, TUNE_P, TUNE_I, 1.0, F);
    add(loop->a, TUNE_P, TUNE_V, 1.0, G);
    /* v' = G^-1 ((keep - F) i^ - drift + (1 - keep) offset + ...) */
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            rest[n][k] = keep[n][k] - F[n][k];
        }
    }
    multiply(inverse, rest, rest);
    add_rows(loop->a, TUNE_V, 1.0, rest, TUNE_P);
    add_rows(loop->a, TUNE_V, -1.0, inverse, TUNE_D);
    multiply(inverse, keep, rest);
    add_rows(loop->a, TUNE_V, 1.0, inverse, TUNE_O);
    add_rows(loop->a, TUNE_V, -1.0, rest, TUNE_O);
    for (int n = 0; n < 2; n++) {
        for (int k = 0; k < 2; k++) {
            loop->aim[TUNE_V + n][k] = inverse[n][k];
        }
    }
}

void tune_loop_make(const tune_design *design, const tune_machine *truth, double phi_rad,
                    const tune_fault *fault, tune_loop *loop)
{
    exact_map end;
    exact_map mean;
    matrix F;
    matrix G;
    memset(loop, 0, sizeof *loop);
    loop->order = fault->delay > 0.0 ? TUNE_ORDER : TUNE_LAST;
    machine_rows(truth, phi_rad, design->T_s, fault, loop);
    controller_rows(design, phi_rad, loop);
    exact_maps(truth->R_ohm, truth->L_d_H, truth->L_q_H, design->T_s, phi_rad / design->T_s, &end, &mean);
    to_current(truth, mean.decay, mean.drive, F, G);
    add(loop->mean, 0, TUNE_I, 1.0, F);
    add(loop->mean, 0, TUNE_V, 1.0, G);
}

void tune_loop_step(const tune_loop *loop, int cycles, double (*mean)[2])
{
    double x[TUNE_ORDER] = {0.0};
    double aim = 0.0; /* of i_q */
    for (int k = 0; k < cycles; k++) {
        const double before = aim;
        double next[TUNE_ORDER] = {0.0};
        aim = 1.0 - loop->follow * (1.0 - aim);
        const double want[2] = {loop->voltage_of_mean * loop->keep_im * before,
                                loop->voltage_of_mean * (aim - loop->keep_re * before)};
        for (int n = 0; n < 2; n++) {
            mean[k][n] = 0.0;
            for (int m = 0; m < TUNE_ORDER; m++) {
                mean[k][n] += loop->mean[n][m] * x[m];
            }
        }
        for (int n = 0; n < TUNE_ORDER; n++) {
            next[n] = loop->aim[n][0] * want[0] + loop->aim[n][1] * want[1];
            for (int m = 0; m < TUNE_ORDER; m++) {
                next[n] += loop->a[n][m] * x[m];
            }
        }
        memcpy(x, next, sizeof x);
    }
}
