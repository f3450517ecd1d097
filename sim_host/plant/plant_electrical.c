/* The linear machine's exponential by its power series (plant_electrical.h). */
#include "plant_electrical.h"

#include "plant_low_pass.h"

#include <stddef.h>

/*
 * Terms of the series: the n-th is at most rho^n / n! of the largest, rho = dt * (fastest rate). Spans are
 * halved until rho <= RHO_MAX = 1, so 18 terms leave less than 1/19! = 8e-18, below half a unit of the last
 * place.
 */
#define RHO_MAX    1.0
#define TERMS_MAX  20
#define TERM_LEAST 1e-17

static const double reciprocal[TERMS_MAX + 1] = {0.0,      1.0,      1.0 / 2,  1.0 / 3,  1.0 / 4,  1.0 / 5,
                                                 1.0 / 6,  1.0 / 7,  1.0 / 8,  1.0 / 9,  1.0 / 10, 1.0 / 11,
                                                 1.0 / 12, 1.0 / 13, 1.0 / 14, 1.0 / 15, 1.0 / 16, 1.0 / 17,
                                                 1.0 / 18, 1.0 / 19, 1.0 / 20};

/* The largest rate of [i_dq, u_dq]: a row-sum bound on the matrix. */
static double rate_bound(const electrical_linear *m)
{
    double L_least_H = fmin(m->L_d_H, m->L_q_H);
    double L_most_H = fmax(m->L_d_H, m->L_q_H);
    return (m->R_ohm + fabs(m->omega_e_rad_s) * L_most_H) / L_least_H;
}

/*
 * One span with rho <= RHO_MAX. Taylor coefficients (each with dt^n in it) of
 *   i      the current in the rotor frame,
 *   u      the voltage in the rotor frame,
 *   turn   e^{j omega s},
 *   still  i * turn, the current in the frame of the start: for equal inductances from its own equation,
 *          L dy/ds = u(0) - R y - j omega psi_f e^{j omega s}; else the product of the two series.
 * *seen passes the low-pass with these weights; NULL: there is none.
 */
static void span(const electrical_linear *m, double dt, double rho, vec_dq u, electrical_state *x,
                 const double *weight, vec_ab *seen)
{
    const double omega = m->omega_e_rad_s;
    const double per_L_d = 1.0 / m->L_d_H;
    const double per_L_q = 1.0 / m->L_q_H;
    const double emf_V = omega * m->psi_f_Wb;
    const int salient = m->L_d_H != m->L_q_H;
    vec_dq i[TERMS_MAX + 1];
    vec_dq turn[TERMS_MAX + 1];
    vec_dq still = x->i_dq_A; /* of equal inductances */
    i[0] = x->i_dq_A;
    turn[0] = (vec_dq){1.0, 0.0};
    vec_dq sum = i[0];
    vec_dq mean = i[0];
    vec_dq mean_still = i[0];
    const vec_dq u_start = u;
    double bound = 1.0;
    if (seen != NULL) {
        *seen = (vec_ab){(1.0 - weight[0]) * seen->alpha + weight[0] * still.d,
                         (1.0 - weight[0]) * seen->beta + weight[0] * still.q};
    }
    for (int n = 0; n + 2 <= TERMS_MAX && bound > TERM_LEAST; n++) {
        const double h = dt * reciprocal[n + 1];
        const double first = n == 0 ? 1.0 : 0.0; /* what is constant acts in the first term only */
        const vec_dq a = i[n];
        i[n + 1].d = h * per_L_d * (u.d - m->R_ohm * a.d + omega * m->L_q_H * a.q);
        i[n + 1].q = h * per_L_q * (u.q - m->R_ohm * a.q - omega * m->L_d_H * a.d - first * emf_V);
        u = (vec_dq){h * omega * u.q, -h * omega * u.d};
        turn[n + 1] = (vec_dq){-h * omega * turn[n].q, h * omega * turn[n].d};
        const double share = reciprocal[n + 2];
        sum.d += i[n + 1].d;
        sum.q += i[n + 1].q;
        mean.d += i[n + 1].d * share;
        mean.q += i[n + 1].q * share;
        if (salient) {
            still = (vec_dq){0.0, 0.0};
            for (int k = 0; k <= n + 1; k++) {
                still.d += i[k].d * turn[n + 1 - k].d - i[k].q * turn[n + 1 - k].q;
                still.q += i[k].q * turn[n + 1 - k].d + i[k].d * turn[n + 1 - k].q;
            }
        } else {
            still = (vec_dq){h * per_L_d * (first * u_start.d - m->R_ohm * still.d + emf_V * turn[n].q),
                             h * per_L_d * (first * u_start.q - m->R_ohm * still.q - emf_V * turn[n].d)};
        }
        mean_still.d += still.d * share;
        mean_still.q += still.q * share;
        if (seen != NULL) {
            seen->alpha += weight[n + 1] * still.d;
            seen->beta += weight[n + 1] * still.q;
        }
        bound *= rho * reciprocal[n + 1];
    }
    x->i_dq_A = sum;
    x->integral_dq_As.d += mean.d * dt;
    x->integral_dq_As.q += mean.q * dt;
    x->integral_start_As = (vec_ab){mean_still.d * dt, mean_still.q * dt};
}

void electrical_advance_seen(const electrical_linear *m, double dt_s, vec_dq u_dq_V, electrical_state *x,
                             double bandwidth_rad_s, vec_ab *seen)
{
    const double rate = rate_bound(m);
    const long pieces = rate * dt_s <= RHO_MAX ? 1 : lround(ceil(rate * dt_s / RHO_MAX));
    const double dt = dt_s / (double)pieces;
    double weight[TERMS_MAX + 1];
    if (seen != NULL) {
        low_pass_weights(bandwidth_rad_s * dt, TERMS_MAX + 1, weight);
    }
    if (pieces == 1) {
        span(m, dt_s, rate * dt_s, u_dq_V, x, weight, seen);
        return;
    }
    vec_ab integral = {0.0, 0.0};
    for (long k = 0; k < pieces; k++) {
        vec_rotor turned = rotor_at(m->omega_e_rad_s * dt * (double)k); /* the rotor since the start */
        vec_ab u_start = {u_dq_V.d, u_dq_V.q};
        vec_ab *seen_here = NULL;
        vec_ab seen_turned;
        if (seen != NULL) {
            const vec_dq in_piece = vec_to_dq(*seen, turned);
            seen_turned = (vec_ab){in_piece.d, in_piece.q};
            seen_here = &seen_turned;
        }
        span(m, dt, rate * dt, vec_to_dq(u_start, turned), x, weight, seen_here);
        if (seen != NULL) {
            *seen = vec_to_ab((vec_dq){seen_turned.alpha, seen_turned.beta}, turned);
        }
        vec_dq piece = {x->integral_start_As.alpha, x->integral_start_As.beta};
        vec_ab back = vec_to_ab(piece, turned);
        integral.alpha += back.alpha;
        integral.beta += back.beta;
    }
    x->integral_start_As = integral;
}

void electrical_advance(const electrical_linear *m, double dt_s, vec_dq u_dq_V, electrical_state *x)
{
    electrical_advance_seen(m, dt_s, u_dq_V, x, 0.0, NULL);
}
