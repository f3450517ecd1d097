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
static vec_ab filtered_Vs(const averaged_drive *d, const cycle_row *row, double T_s, const sensor_map *map)
{
    const double tau = d->sensor_lag_s;
    const double cycle = fmin(T_s / tau, ALL_FADED);
    const double fade = exp(-cycle);
    const cycle_row *command = fallen(d, row);
    double rise_V[3] = {0.0};
    double fall_V[3] = {0.0};
    double high_Vs[3];
    if (d->v_dead_V != 0.0) {
        const cycle_row *before = row->history > 0 ? row - 1 : row;
        found_edges_each(d, before, sensor_map_unmeasure(map, before->i_A), rise_V, fall_V);
    }
    for (int x = 0; x < 3; x++) {
        const double at_fall = exp(-command->fell[x] * cycle);
        const double at_rise = fade / at_fall;
        high_Vs[x] = (d->k_u * row->u_dc_V * tau * (at_fall - at_rise) -
                      T_s * (rise_V[x] * at_rise + fall_V[x] * at_fall)) /
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

/* That multiplies by d + j q. */
static square turning(double d, double q)
{
    return (square){{{d, -q}, {q, d}}};
}

static vec_ab times(square a, vec_ab x)
{
    return (vec_ab){a.m[0][0] * x.alpha + a.m[0][1] * x.beta, a.m[1][0] * x.alpha + a.m[1][1] * x.beta};
}

/* Of a law in the stationary frame, the rotor at r. */
static square in_rotor(vec_rotor r, vec_ab of_alpha, vec_ab of_beta)
{
    const square back = turning(r.cos, -r.sin);
    const square law = {{{of_alpha.alpha, of_beta.alpha}, {of_alpha.beta, of_beta.beta}}};
    return product(product(back, law), turning(r.cos, r.sin));
}

static const vec_ab ALONG_ALPHA = {1.0, 0.0};
static const vec_ab ALONG_BETA = {0.0, 1.0};

/* By how much the reading stays behind a current: still + by i, stationary. */
typedef struct lag_line {
    vec_ab still;
    square by;
} lag_line;

/* The machine about the row's current, along whose line its flux is taken. */
static lag_line line_of(const averaged_drive *d, const cycle_row *row, vec_ab high_Vs, vec_ab i_ab)
{
    const double tau = d->sensor_lag_s;
    const double w = row->omega_rad_s;
    const vec_rotor r = averaged_drive_rotor(d, row);
    const square late = turning(tau, -w * tau * tau * (tau > 0.0 ? 1.0 : 0.5));
    const vec_dq i = vec_to_dq(i_ab, r);
    const flux_map_slope slope = flux_map_incremental(d, i);
    const square L = {{{slope.dd, slope.dq}, {slope.dq, slope.qq}}};
    const square turned = turning(0.0, w);
    square all = L;
    square u =
        sum(in_rotor(r, averaged_drive_drop(d, row, ALONG_ALPHA), averaged_drive_drop(d, row, ALONG_BETA)),
            product(turned, L));
    if (d->dL_H[0] != 0.0 || d->dL_H[1] != 0.0 || d->dL_H[2] != 0.0) {
        const square apart =
            in_rotor(r, vec_times_phases(ALONG_ALPHA, d->dL_H), vec_times_phases(ALONG_BETA, d->dL_H));
        all = sum(all, apart);
        u = sum(u, product(apart, turned));
    }
    const square per_H = inverse_of(all);
    const vec_dq whole = flux_map_flux(d, i);
    const vec_dq flux = {whole.d + averaged_drive_magnet(d, row) - slope.dd * i.d - slope.dq * i.q,
                         whole.q - slope.dq * i.d - slope.qq * i.q};
    const vec_ab emf = times(product(late, turned), (vec_ab){flux.d, flux.q});
    const vec_dq high = vec_to_dq(high_Vs, r);
    const vec_ab still = times(per_H, (vec_ab){high.d - emf.alpha, high.q - emf.beta});
    const square less = product(product(per_H, late), u);
    const square more = product(late, turned);
    const square by = {{{more.m[0][0] - less.m[0][0], more.m[0][1] - less.m[0][1]},
                        {more.m[1][0] - less.m[1][0], more.m[1][1] - less.m[1][1]}}};
    return (lag_line){.still = vec_to_ab((vec_dq){still.alpha, still.beta}, r),
                      .by = product(product(turning(r.cos, r.sin), by), turning(r.cos, -r.sin))};
}

/* Of the branch, if its time constant were tau. */
static vec_ab iron_by(const averaged_drive *d, double tau_s, const cycle_row *row, vec_ab i, iron_memory *m)
{
    averaged_drive other = *d;
    other.fe_tau_s = tau_s;
    const iron_branch b = iron_branch_of(&other, row, i, m);
    return iron_branch_begin(&other, &b);
}

/* Time constants that differ by less than this share are told apart by it: the quotient would lose its digits. */
static const double APART = 0.01;

static vec_ab filtered_iron(const averaged_drive *d, const cycle_row *row, vec_ab i, vec_ab own,
                            iron_memory *m)
{
    const double tau = d->fe_tau_s;
    const double lag = fabs(d->sensor_lag_s - tau) < APART * tau ? (1.0 + APART) * tau : d->sensor_lag_s;
    const vec_ab by_lag = iron_by(d, lag, row, i, m);
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
    return (vec_ab){fade * own.alpha + d->fe_S * (u.alpha - (1.0 - fade) * drop.alpha),
                    fade * own.beta + d->fe_S * (u.beta - (1.0 - fade) * drop.beta)};
}

/* What the reading shows of the iron's current; *own: that current. */
static vec_ab iron_shown(const averaged_drive *d, const cycle_row *row, double T_s, vec_ab i,
                         lag_memory *memory, vec_ab *own)
{
    *own = iron_by(d, d->fe_tau_s, row, i, &memory->own);
    return d->sensor_lag_s > 0.0 ? filtered_iron(d, row, i, *own, &memory->by_filter)
                                 : later_iron(d, row, T_s, i, *own);
}

sensor_map sensor_lag_map(const averaged_drive *d, const cycle_row *row, double T_s, const sensor_map *map,
                          lag_memory *memory)
{
    const vec_ab i = sensor_map_unmeasure(map, row->i_A);
    const vec_ab high_Vs = d->sensor_lag_s > 0.0 ? filtered_Vs(d, row, T_s, map) : risen_Vs(d, row, T_s);
    const lag_line line = line_of(d, row, high_Vs, i);
    const square seen = {
        {{1.0 - line.by.m[0][0], -line.by.m[0][1]}, {-line.by.m[1][0], 1.0 - line.by.m[1][1]}}};
    const square unseen = inverse_of(seen);
    vec_ab less = line.still;
    if (d->fe_S != 0.0) {
        /* Not as the rest of the current is seen, but by itself. */
        vec_ab own;
        const vec_ab shown = iron_shown(d, row, T_s, i, memory, &own);
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
