/* Filtered currents, and samples late against the carrier (sensor_lag.h). */
#include "sensor_lag.h"

#include <math.h>

/* For how long, weighed as the reading weighs it, each leg is high; the cycles before are taken to be as the last. */
static vec_ab volt_seconds(const averaged_drive *d, const cycle_row *row, double T_s)
{
    const double tau = d->sensor_lag_s;
    /* Beyond this a cycle's exponentials are none, and must not be divided by. */
    const double cycle = fmin(T_s / fmax(tau, 1e-300), 700.0);
    const double fade = exp(-cycle);
    double high_Vs[3];
    for (int x = 0; x < 3; x++) {
        if (tau > 0.0) {
            const double on = exp(-row->fell[x] * cycle);
            high_Vs[x] = tau * (on - fade / on) / (1.0 - fade);
        } else {
            high_Vs[x] = -fmax(0.0, -tau - row->rise[x] * T_s);
        }
        high_Vs[x] *= d->k_u * row->u_dc_V;
    }
    return vec_from_phases(high_Vs);
}

/* By how much the reading stays behind a current. */
static vec_ab behind(const averaged_drive *d, const cycle_row *row, vec_ab high_Vs, vec_ab i_ab)
{
    const vec_rotor r = {row->cos_theta, row->sin_theta};
    const double tau = d->sensor_lag_s;
    const double w = row->omega_rad_s;
    const vec_dq t = {tau, -w * tau * tau * (tau > 0.0 ? 1.0 : 0.5)};
    const vec_dq i = vec_to_dq(i_ab, r);
    const vec_dq high = vec_to_dq(high_Vs, r);
    const vec_dq v = {d->R_ohm * i.d - w * d->L_q_H * i.q,
                      d->R_ohm * i.q + w * (d->L_d_H * i.d + d->psi_f_Wb)};
    const vec_dq left = {(high.d - t.d * v.d + t.q * v.q) / d->L_d_H - w * (t.d * i.q + t.q * i.d),
                         (high.q - t.d * v.q - t.q * v.d) / d->L_q_H + w * (t.d * i.d - t.q * i.q)};
    return vec_to_ab(left, r);
}

sensor_map sensor_lag_map(const averaged_drive *d, const cycle_row *row, double T_s, const sensor_map *map)
{
    const vec_ab high_Vs = volt_seconds(d, row, T_s);
    const vec_ab still = behind(d, row, high_Vs, (vec_ab){0.0, 0.0});
    const vec_ab one = behind(d, row, high_Vs, (vec_ab){1.0, 0.0});
    const vec_ab two = behind(d, row, high_Vs, (vec_ab){0.0, 1.0});
    const double a[2][2] = {{1.0 - one.alpha + still.alpha, still.alpha - two.alpha},
                            {still.beta - one.beta, 1.0 - two.beta + still.beta}};
    const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    const double inverse[2][2] = {{a[1][1] / det, -a[0][1] / det}, {-a[1][0] / det, a[0][0] / det}};
    sensor_map m = *map;
    for (int k = 0; k < 2; k++) {
        for (int n = 0; n < 2; n++) {
            m.forward[k][n] = map->forward[k][0] * a[0][n] + map->forward[k][1] * a[1][n];
            m.back[k][n] = inverse[k][0] * map->back[0][n] + inverse[k][1] * map->back[1][n];
        }
        m.zero[k] = map->zero[0] * a[0][k] + map->zero[1] * a[1][k];
    }
    m.offset.alpha -= map->forward[0][0] * still.alpha + map->forward[0][1] * still.beta;
    m.offset.beta -= map->forward[1][0] * still.alpha + map->forward[1][1] * still.beta;
    m.zero_offset_A -= map->zero[0] * still.alpha + map->zero[1] * still.beta;
    return m;
}
