/*
 * A circuit whose legs switch, integrated in steps far below an edge's time: a winding's resistance, a salient rotor's flux, one that
 * saturates or one with unequal phases, in parallel a branch of R_fe with tau_fe R_fe, and a filter ahead of the samples.
 * No law of the averaged drive is in it. Each test program includes it once.
 */
#ifndef TESTS_UNIT_SWITCHED_CIRCUIT_H
#define TESTS_UNIT_SWITCHED_CIRCUIT_H

#include "model/averaged_drive.h"

#include <math.h>
#include <string.h>

enum { STEPS = 2000 };

static const double T_S = 2.5e-4;
static const double U_DC_V = 300.0;

typedef struct circuit {
    double R_ohm, L_d_H, L_q_H, psi_f_Wb, R_fe_ohm, tau_fe_s, omega_rad_s;
    double dR_ohm[3];
    double v_dead_V;
    double
        v_moved_V; /* by which a compensation moves each edge, by the current's sign at the cycle's start */
    double g[3], offset_A[2]; /* of the current sensors, by which the rows are recorded */
    double lag_s;             /* of their filter; 0: none */
    double per_I_sat2;        /* 1/I_sat^2 of a machine without saliency */
    double dL_H[3];           /* unequal parts of the phases' inductances, of one that does not saturate */
} circuit;

static const circuit usual = {.R_ohm = 0.9,
                              .L_d_H = 0.008,
                              .L_q_H = 0.011,
                              .psi_f_Wb = 0.2,
                              .R_fe_ohm = 150.0,
                              .tau_fe_s = 1e-4,
                              .omega_rad_s = 300.0,
                              .g = {1.0, 1.0, 1.0}};

typedef struct flow {
    vec_ab flux_Wb, iron_A, seen_A;
} flow;

static double size_of(vec_ab v)
{
    return v.alpha * v.alpha + v.beta * v.beta;
}

/* Of phases that are not alike: their part and the turning rotor's, one matrix in the stationary frame. */
static vec_ab through_both(const circuit *c, vec_ab flux, vec_rotor r)
{
    double m[2][2];
    for (int n = 0; n < 2; n++) {
        const vec_ab one = {n == 0 ? 1.0 : 0.0, n == 1 ? 1.0 : 0.0};
        const vec_dq i = vec_to_dq(one, r);
        const vec_ab own = vec_to_ab((vec_dq){c->L_d_H * i.d, c->L_q_H * i.q}, r);
        double phase[3];
        vec_to_phases(one, phase);
        for (int x = 0; x < 3; x++) {
            phase[x] *= c->dL_H[x];
        }
        const vec_ab more = vec_from_phases(phase);
        m[0][n] = own.alpha + more.alpha;
        m[1][n] = own.beta + more.beta;
    }
    const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    return (vec_ab){(m[1][1] * flux.alpha - m[0][1] * flux.beta) / det,
                    (m[0][0] * flux.beta - m[1][0] * flux.alpha) / det};
}

static vec_ab magnetising(const circuit *c, vec_ab flux, double theta)
{
    const vec_rotor r = rotor_at(theta);
    const vec_ab magnet = vec_to_ab((vec_dq){c->psi_f_Wb, 0.0}, r);
    const vec_ab left = {flux.alpha - magnet.alpha, flux.beta - magnet.beta};
    if (c->per_I_sat2 > 0.0) {
        /* psi = L i / (1 + i^2/I_sat^2), the lesser root */
        const double psi = sqrt(size_of(left));
        const double i = 2.0 * psi / (c->L_d_H + sqrt(c->L_d_H * c->L_d_H - 4.0 * c->per_I_sat2 * psi * psi));
        return (vec_ab){left.alpha * i / psi, left.beta * i / psi};
    }
    return through_both(c, left, r);
}

static vec_ab current(const circuit *c, const flow *at, double theta)
{
    const vec_ab i = magnetising(c, at->flux_Wb, theta);
    return (vec_ab){i.alpha + at->iron_A.alpha, i.beta + at->iron_A.beta};
}

static flow rate(const circuit *c, const flow *at, double theta, vec_ab u)
{
    const vec_ab i = current(c, at, theta);
    double drop[3];
    vec_to_phases(i, drop);
    for (int x = 0; x < 3; x++) {
        drop[x] *= c->R_ohm + c->dR_ohm[x];
    }
    const vec_ab v = vec_from_phases(drop);
    const vec_ab e = {u.alpha - v.alpha, u.beta - v.beta};
    const double per_lag = c->lag_s > 0.0 ? 1.0 / c->lag_s : 0.0;
    return (flow){e,
                  {(e.alpha / c->R_fe_ohm - at->iron_A.alpha) / c->tau_fe_s,
                   (e.beta / c->R_fe_ohm - at->iron_A.beta) / c->tau_fe_s},
                  {per_lag * (i.alpha - at->seen_A.alpha), per_lag * (i.beta - at->seen_A.beta)}};
}

static flow moved(const flow *at, const flow *by, double h)
{
    return (flow){{at->flux_Wb.alpha + h * by->flux_Wb.alpha, at->flux_Wb.beta + h * by->flux_Wb.beta},
                  {at->iron_A.alpha + h * by->iron_A.alpha, at->iron_A.beta + h * by->iron_A.beta},
                  {at->seen_A.alpha + h * by->seen_A.alpha, at->seen_A.beta + h * by->seen_A.beta}};
}

/* One cycle of three legs; a dead time delays the rise where the current flows out and the fall where it flows in. */
static void switched_cycle(const circuit *c, const cycle_row *row, double theta, flow *at)
{
    const double h = T_S / STEPS;
    const double late = c->v_dead_V / U_DC_V;
    double rise[3];
    double fall[3];
    double i[3];
    double rise_at[3]; /* to rise */
    vec_to_phases(current(c, at, theta), i);
    for (size_t x = 0; x < 3; x++) {
        rise_at[x] = row->rise[x] - (i[x] > 0.0 ? 1.0 : -1.0) * c->v_moved_V / U_DC_V;
        rise[x] = rise_at[x];
        fall[x] = 1.0 - rise_at[x];
    }
    for (int n = 0; n < STEPS; n++) {
        const double share = (double)n / STEPS;
        double leg[3];
        vec_to_phases(current(c, at, theta + c->omega_rad_s * h * n), i);
        for (size_t x = 0; x < 3; x++) {
            if (share <= rise_at[x]) {
                rise[x] = rise_at[x] + (i[x] > 0.0 ? late : 0.0);
            }
            if (share <= 1.0 - rise_at[x]) {
                fall[x] = 1.0 - rise_at[x] + (i[x] < 0.0 ? late : 0.0);
            }
            const double on = fmin(share + 1.0 / STEPS, fall[x]) - fmax(share, rise[x]);
            leg[x] = U_DC_V * STEPS * fmax(on, 0.0);
        }
        const vec_ab u = vec_from_phases(leg);
        const double mid = theta + c->omega_rad_s * h * (n + 0.5);
        const flow k1 = rate(c, at, mid - 0.5 * c->omega_rad_s * h, u);
        const flow half = moved(at, &k1, 0.5 * h);
        const flow k2 = rate(c, &half, mid, u);
        *at = moved(at, &k2, h);
    }
}

/* A row as a recording of this cycle gives it. */
static cycle_row row_of(const circuit *c, size_t n, vec_ab u, vec_ab i)
{
    const double theta = c->omega_rad_s * T_S * (double)n;
    const vec_rotor r = rotor_at(theta);
    const vec_rotor turn = rotor_at(c->omega_rad_s * T_S);
    cycle_row row = {.u_V = {u},
                     .cos_theta = r.cos,
                     .sin_theta = r.sin,
                     .cos_turn = turn.cos,
                     .sin_turn = turn.sin,
                     .omega_rad_s = c->omega_rad_s,
                     .u_dc_V = U_DC_V,
                     .T_s = T_S,
                     .history = n,
                     .i_A = i};
    double v[3];
    vec_to_phases(u, v);
    for (size_t x = 0; x < 3; x++) {
        row.rise[x] = 0.25 - 0.5 * v[x] / U_DC_V;
    }
    for (size_t x = 0; x < 3; x++) {
        double ahead[3]; /* each leg's volt-seconds up to this one's rise, less those of its mean voltage */
        for (size_t y = 0; y < 3; y++) {
            const double on = fmax(row.rise[x] - row.rise[y], 0.0);
            ahead[y] = U_DC_V * T_S * (on - row.rise[x] * (1.0 - 2.0 * row.rise[y]));
        }
        row.edge_ripple_Wb[x] = vec_from_phases(ahead);
    }
    return row;
}

/* The drive that knows all of the circuit. */
static averaged_drive drive_of(const circuit *c)
{
    averaged_drive d = {.R_ohm = c->R_ohm,
                        .L_d_H = c->L_d_H,
                        .L_q_H = c->L_q_H,
                        .psi_f_Wb = c->psi_f_Wb,
                        .saturation = c->per_I_sat2,
                        .fe_S = isfinite(c->R_fe_ohm) ? 1.0 / c->R_fe_ohm : 0.0,
                        .fe_tau_s = c->tau_fe_s,
                        .v_dead_V = c->v_dead_V - 2.0 * c->v_moved_V,
                        .i_knee_A = 1e-3,
                        .edge = EDGE_CLIPPED,
                        .edge_ripple = 1.0,
                        .compensation_V = 2.0 * c->v_moved_V,
                        .compensation_knee_A = 1e-3,
                        .k_u = 1.0,
                        .g = {c->g[0], c->g[1], c->g[2]},
                        .offset_ab_A = {c->offset_A[0], c->offset_A[1]},
                        .sensor_lag_s = c->lag_s};
    memcpy(d.dR_ohm, c->dR_ohm, sizeof d.dR_ohm);
    memcpy(d.dL_H, c->dL_H, sizeof d.dL_H);
    return d;
}

#endif
