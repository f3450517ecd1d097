/*
 * Residual voltages: the one-cycle error as a voltage,
 *
 *     v = L (measured - predicted) / T,     L = (L_d, L_q) in the rotor frame,
 *
 * with the variables it may depend on, and its spectrum in orders of the electrical angle.
 */
#ifndef SIM_HOST_DIAGNOSE_SHOW_RESIDUAL_H
#define SIM_HOST_DIAGNOSE_SHOW_RESIDUAL_H

#include "data/recording.h"
#include "model/averaged_drive.h"

#include <stdbool.h>
#include <stddef.h>

/* One-cycle errors of one model on one recording. */
typedef struct residual {
    const recording *rec;
    const vec_ab *error; /* one per row, into that row; NAN: none */
    double L_d_H, L_q_H;
} residual;

typedef struct residual_point {
    vec_ab v_V;
    double v_phase_V[3], i_phase_A[3], u_phase_V[3]; /* i: mean of the cycle's ends */
    double theta_rad, omega_rad_s;                   /* at mid-cycle */
} residual_point;

/* The cycle that ends at row k. False: no prediction there. */
bool residual_at(const residual *r, size_t k, residual_point *point);

typedef enum residual_axis { AXIS_ANGLE, AXIS_SPEED, AXIS_CURRENT, AXIS_VOLTAGE } residual_axis;

enum { RESIDUAL_BINS = 48 };

typedef struct residual_bin {
    double x,
        y; /* mean of both; y is the rms length over AXIS_ANGLE and AXIS_SPEED, else the mean phase voltage */
    size_t count;
} residual_bin;

/* Over the range low ... high in RESIDUAL_BINS bins; phases are pooled where the axis is a phase's. */
void residual_bins(const residual *r, residual_axis axis, double low, double high,
                   residual_bin bins[RESIDUAL_BINS]);

enum { ORDER_MAX = 13, ORDER_PARTS_MAX = 8, ORDERS = 2 * ORDER_MAX * ORDER_PARTS_MAX + 1 };

/* Steps to an electrical order, so that mechanical orders (1/pole_pairs) lie on them. */
int order_parts(int pole_pairs);
int order_count(int parts);
/* The n-th order. */
double order_of(int parts, int n);

/*
 * Amplitude of the residual vector's part that turns with each order of the electrical angle, -ORDER_MAX ...
 * ORDER_MAX in steps of 1/parts: rms over the stretches of |sum w v e^(-j n theta)| / sum w, with a Hann
 * window w. Negative orders turn against the rotor. Samples lie where the rotor was, not on a grid: a direct
 * sum, not a fast transform. Orders beyond half a turn a cycle are left out stretch by stretch. NAN where
 * nothing is seen.
 */
void residual_orders(const residual *r, int parts, double amplitude_V[ORDERS]);

#endif
