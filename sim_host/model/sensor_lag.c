/* Filtered currents, and samples late against the carrier (sensor_lag.h). */
#include "sensor_lag.h"

#include "flux_map.h"
#include "found_edges.h"

#include <math.h>

static const double ALL_FADED = 700.0; /* as in iron_branch.c */

/* The row in whose cycle the command acted whose falls lie ahead of this row's start: of a voltage that is late by whole cycles,
 * one before. One that is late by a half has risen by an older command, but fallen by the same. */
static const cycle_row *fallen(const averaged_drive *d, const cycle_row *row)
{
    const double late = floor(fmax(d->u_delay[0] + d->u_delay[1], 0.0) + 0.25);
    return late <= (double)row->history ? row - (size_t)late : row;
}

/* For how long, weighed as the filter weighs it, each leg is high, times its voltage; the cycles before are taken to be as the
 * last. A dead time has taken of it at the edges, by the current of that cycle. */
static vec_ab filtered_Vs(const averaged_drive *d, const cycle_row *row, double T_s, const edge_losses *lost)
{
    const double tau = d->sensor_lag_s;
    const double cycle = fmin(T_s / tau, ALL_FADED);
    const double fade = exp(-cycle);
    const cycle_row *command = fallen(d, row);
    double high_Vs[3];
    for (int x = 0; x < 3; x++) {
        const double at_fall = exp(-fmin(command->fell[x] * cycle, ALL_FADED));
        const double at_rise = fade / at_fall;
        high_Vs[x] = (d->k_u * row->u_dc_V * tau * (at_fall - at_rise) -
                      T_s * (lost->rise_V[x] * at_rise + lost->fall_V[x] * at_fall)) /
                     (1.0 - fade);
    }
    return vec_from_phases(high_Vs);
}

/* What a late sample has seen of the legs' rises already. */
static vec_ab risen_Vs(const averaged_drive *d, const cycle_row *row, double T_s)
{
    double high_Vs[3];
    for (int x = 0; x < 3; x++) {
        high_Vs[x] = -d->k_u * row->u_dc_V * fmax(0.0, -d->sensor_lag_s - row->rise[x] * T_s);
    }
    return vec_from_phases(high_Vs);
}

/* Two by two, row by row. */
typedef struct square {
    double m[2][2];
} square;

static square product(square a, square b)
{
    square c;
    for (int k = 0; k < 2; k++) {
        for (int n = 0; n < 2; n++) {
            c.m[k][n] = a.m[k][0] * b.m[0][n] + a.m[k][1] * b.m[1][n];
        }
    }
    return c;
}

static square sum(square a, square b)
{
    return (square){
        {{a.m[0][0] + b.m[0][0], a.m[0][1] + b.m[0][1]}, {a.m[1][0] + b.m[1][0], a.m[1][1] + b.m[1][1]}}};
}

static square inverse_of(square a)
{
    const double per_det = 1.0 / (a.m[0][0] * a.m[1][1] - a.m[0][1] * a.m[1][0]);
    return (square){
        {{a.m[1][1] * per_det, -a.m[0][1] * per_det}, {-a.m[1][0] * per_det, a.m[0][0] * per_det}}};
}

static vec_ab times(square a, vec_ab x)
{
    return (vec_ab){a.m[0][0] * x.alpha + a.m[0][1] * x.beta, a.m[1][0] * x.alpha + a.m[1][1] * x.beta};
}

/* A number p + j q, as a vector's factor. */
typedef struct turning {
    double p, q;
} turning;

static vec_ab turned(turning t, vec_ab x)
{
    return (vec_ab){t.p * x.alpha - t.q * x.beta, t.q * x.alpha + t.p * x.beta};
}

static square turned_after(turning t, square a)
{
    return (square){{{t.p * a.m[0][0] - t.q * a.m[1][0], t.p * a.m[0][1] - t.q * a.m[1][1]},
                     {t.q * a.m[0][0] + t.p * a.m[1][0], t.q * a.m[0][1] + t.p * a.m[1][1]}}};
}

/* The incremental inductance as the stationary frame sees it. */
static square inductance_of(flux_map_slope slope, vec_rotor r)
{
    const double mean = 0.5 * (slope.dd + slope.qq);
    const double apart = 0.5 * (slope.dd - slope.qq);
    const double cos_2 = r.cos * r.cos - r.sin * r.sin;
    const double sin_2 = 2.0 * r.cos * r.sin;
    const double even = apart * cos_2 - slope.dq * sin_2;
    const double odd = apart * sin_2 + slope.dq * cos_2;
    return (square){{{mean + even, odd}, {odd, mean - even}}};
}

static const vec_ab ALONG_ALPHA = {1.0, 0.0};
static const vec_ab ALONG_BETA = {0.0, 1.0};

/* A law's matrix, from what it does along either axis. */
static square of_axes(vec_ab of_alpha, vec_ab of_beta)
{
    return (square){{{of_alpha.alpha, of_beta.alpha}, {of_alpha.beta, of_beta.beta}}};
}

/* By how much the reading stays behind a current: still + by i. */
typedef struct lag_line {
    vec_ab still;
    square by;
} lag_line;

/*
 * The machine about a current, along whose line its flux is taken. All in the stationary frame: what turns there by j omega
 * does so in the rotor's, and only the inductance has to be turned over.
 */
static lag_line line_of(const averaged_drive *d, const cycle_row *row, vec_rotor r, vec_ab high_Vs,
                        vec_ab i_ab)
{
    const double tau = d->sensor_lag_s;
    const double w = row->omega_rad_s;
    const turning late = {tau, -w * tau * tau * (tau > 0.0 ? 1.0 : 0.5)};
    const turning late_j_w = {-w * late.q, w * late.p};
    const vec_dq i = vec_to_dq(i_ab, r);
    const flux_map_point at = flux_map_at(d, i);
    const flux_map_slope slope = at.slope;
    const vec_dq whole = at.flux;
    const vec_dq rest = {whole.d + averaged_drive_magnet(d, row) - slope.dd * i.d - slope.dq * i.q,
                         whole.q - slope.dq * i.d - slope.qq * i.q};
    const square L = inductance_of(slope, r);
    square all = L;
    square u = sum(of_axes(averaged_drive_drop(d, row, ALONG_ALPHA), averaged_drive_drop(d, row, ALONG_BETA)),
                   turned_after((turning){0.0, w}, L));
    if (d->dL_H[0] != 0.0 || d->dL_H[1] != 0.0 || d->dL_H[2] != 0.0) {
        /* Standing still, they see the current turn. */
        const vec_ab turned_alpha = {0.0, w};
        const vec_ab turned_beta = {-w, 0.0};
        all =
            sum(all, of_axes(vec_times_phases(ALONG_ALPHA, d->dL_H), vec_times_phases(ALONG_BETA, d->dL_H)));
        u = sum(u, of_axes(vec_times_phases(turned_alpha, d->dL_H), vec_times_phases(turned_beta, d->dL_H)));
    }
    const square per_H = inverse_of(all);
    const vec_ab emf = turned(late_j_w, vec_to_ab(rest, r));
    const square lost = product(per_H, turned_after(late, u));
    return (lag_line){.still = times(per_H, (vec_ab){high_Vs.alpha - emf.alpha, high_Vs.beta - emf.beta}),
                      .by = {{{late_j_w.p - lost.m[0][0], -late_j_w.q - lost.m[0][1]},
                              {late_j_w.q - lost.m[1][0], late_j_w.p - lost.m[1][1]}}}};
}

/* Time constants that differ by less than this share are moved apart by it: the quotient would lose its digits. */
static const double APART = 0.01;

static vec_ab filtered_iron(const averaged_drive *d, const cycle_row *row, vec_ab i, vec_ab own,
                            const edge_losses *before, iron_memory *m)
{
    const double tau = d->fe_tau_s;
    const double lag = fabs(d->sensor_lag_s - tau) < APART * tau ? (1.0 + APART) * tau : d->sensor_lag_s;
    const vec_ab by_lag = iron_branch_at(d, lag, row, i, m, before);
    return (vec_ab){(tau * own.alpha - lag * by_lag.alpha) / (tau - lag),
                    (tau * own.beta - lag * by_lag.beta) / (tau - lag)};
}

/* By then legs may have risen; the drop is that of the row's current. */
static vec_ab later_iron(const averaged_drive *d, const cycle_row *row, double T_s, vec_ab i, vec_ab own)
{
    const double late_s = -d->sensor_lag_s;
    const double fade = exp(-late_s / d->fe_tau_s);
    const vec_ab drop = averaged_drive_drop(d, row, i);
    double leg_V[3];
    for (int x = 0; x < 3; x++) {
        leg_V[x] = d->k_u * row->u_dc_V * (1.0 - exp(-fmax(0.0, late_s - row->rise[x] * T_s) / d->fe_tau_s));
    }
    const vec_ab u = vec_from_phases(leg_V);
    const vec_ab more = iron_branch_conducts(
        d, (vec_ab){u.alpha - (1.0 - fade) * drop.alpha, u.beta - (1.0 - fade) * drop.beta});
    return (vec_ab){fade * own.alpha + more.alpha, fade * own.beta + more.beta};
}

sensor_map sensor_lag_map(const averaged_drive *d, const cycle_row *row, double T_s, const sensor_map *map,
                          vec_rotor rotor, const cycle_turn *last_turn, vec_ab i, lag_memory *memory)
{
    const bool filters = d->sensor_lag_s > 0.0;
    const bool iron = iron_branch_present(d);
    const vec_ab own = iron ? iron_branch_at(d, d->fe_tau_s, row, i, &memory->own, NULL) : (vec_ab){0.0, 0.0};
    edge_losses before = memory->own.before;
    if (filters && !(iron && row->history > 0)) {
        const cycle_row *last = row->history > 0 ? row - 1 : row;
        before = found_edges_each(d, last, row->history > 0 ? last_turn : NULL, NULL,
                                  sensor_map_unmeasure(map, last->i_A), i);
    }
    const vec_ab high_Vs = filters ? filtered_Vs(d, row, T_s, &before) : risen_Vs(d, row, T_s);
    const lag_line line = line_of(d, row, rotor, high_Vs, i);
    const square seen = {
        {{1.0 - line.by.m[0][0], -line.by.m[0][1]}, {-line.by.m[1][0], 1.0 - line.by.m[1][1]}}};
    const square unseen = inverse_of(seen);
    vec_ab less = line.still;
    if (iron) {
        /* Not as the rest of the current is seen, but by itself. */
        const vec_ab shown = filters ? filtered_iron(d, row, i, own, &before, &memory->by_filter)
                                     : later_iron(d, row, T_s, i, own);
        const vec_ab as_rest = times(seen, own);
        less.alpha += as_rest.alpha - shown.alpha;
        less.beta += as_rest.beta - shown.beta;
    }
    sensor_map m = *map;
    for (int k = 0; k < 2; k++) {
        for (int n = 0; n < 2; n++) {
            m.forward[k][n] = map->forward[k][0] * seen.m[0][n] + map->forward[k][1] * seen.m[1][n];
            m.back[k][n] = unseen.m[k][0] * map->back[0][n] + unseen.m[k][1] * map->back[1][n];
        }
        m.zero[k] = map->zero[0] * seen.m[0][k] + map->zero[1] * seen.m[1][k];
    }
    m.offset.alpha -= map->forward[0][0] * less.alpha + map->forward[0][1] * less.beta;
    m.offset.beta -= map->forward[1][0] * less.alpha + map->forward[1][1] * less.beta;
    m.zero_offset_A -= map->zero[0] * less.alpha + map->zero[1] * less.beta;
    return m;
}
