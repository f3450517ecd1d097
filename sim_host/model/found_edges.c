/* A cycle's edges one after the other (found_edges.h). */
#include "found_edges.h"

#include <math.h>

/* The true voltage of the DC link. */
static double link_of(const averaged_drive *d, const cycle_row *row)
{
    return d->k_u * row->u_dc_V;
}

/* The flux linkage of a current without the fall of the inductances, from the rotor. */
static vec_dq flux_of(const averaged_drive *d, double psi_Wb, vec_ab i, vec_rotor r)
{
    const vec_dq i_dq = vec_to_dq(i, r);
    return (vec_dq){d->L_d_H * i_dq.d + psi_Wb, d->L_q_H * i_dq.q};
}

/*
 * By how much the current half-way between two lies ahead of their mean: it carries the mean of both ends' flux, and the magnet's part of
 * that is another half-way round, as are its harmonics.
 */
static vec_ab half_way(const averaged_drive *d, const cycle_row *row, vec_rotor r, vec_rotor half,
                       const harmonic_ends *harmonics, vec_ab first, vec_ab last)
{
    const vec_rotor end = rotor_turned(r, (vec_rotor){row->cos_turn, row->sin_turn});
    const double psi_Wb = averaged_drive_magnet(d, row);
    const vec_dq one = flux_of(d, psi_Wb, first, r);
    const vec_dq two = flux_of(d, psi_Wb, last, end);
    /* Seen from the middle, the first flux is half the turn behind, and the last one ahead. */
    const vec_rotor middle = rotor_turned(r, half);
    vec_dq flux = {0.5 * (half.cos * (one.d + two.d) + half.sin * (one.q - two.q)) - psi_Wb,
                   0.5 * (half.cos * (one.q + two.q) + half.sin * (two.d - one.d))};
    if (averaged_drive_has_harmonics(d)) {
        const vec_ab now = averaged_drive_harmonics(d, middle);
        const vec_dq less =
            vec_to_dq((vec_ab){now.alpha - 0.5 * (harmonics->first.alpha + harmonics->last.alpha),
                               now.beta - 0.5 * (harmonics->first.beta + harmonics->last.beta)},
                      middle);
        flux = (vec_dq){flux.d - less.d, flux.q - less.q};
    }
    const vec_ab i = vec_to_ab((vec_dq){flux.d / d->L_d_H, flux.q / d->L_q_H}, middle);
    return (vec_ab){i.alpha - 0.5 * (first.alpha + last.alpha), i.beta - 0.5 * (first.beta + last.beta)};
}

/* The phases' currents over one period of the carrier as if nothing were lost. */
typedef struct found_currents {
    double rises[3]; /* from the period's start to its end */
    double mid[3];   /* mean of those that leg x' rise and fall find */
    double apart[3]; /* when leg x rises, above that mean; as much below it when x falls */
} found_currents;

/* A phase's current on the way, at a share of the cycle. */
static double on_way(const found_way *way, size_t x, double at)
{
    return way->first[x] + at * (way->last[x] - way->first[x]) + 4.0 * at * (1.0 - at) * way->bow[x];
}

found_way found_way_of(const averaged_drive *d, const cycle_row *row, vec_rotor r,
                       const harmonic_ends *harmonics, vec_ab first, vec_ab last, vec_ab seen)
{
    found_way way;
    double k[3];
    const double twice_cos = sqrt(fmax(2.0 + 2.0 * row->cos_turn, 1e-6)); /* of half the turn */
    const vec_rotor half = {0.5 * twice_cos, row->sin_turn / twice_cos};
    vec_to_phases(first, way.first);
    vec_to_phases(last, way.last);
    vec_to_phases(seen, way.seen);
    vec_to_phases(half_way(d, row, r, half, harmonics, first, last), way.bow);
    averaged_drive_per_H(d, d->edge_ripple, rotor_turned(r, half), k);
    for (size_t x = 0; x < 3; x++) {
        const vec_ab axis = vec_phase_axis[x];
        const vec_ab per_flux = {k[0] * axis.alpha + k[1] * axis.beta, k[1] * axis.alpha + k[2] * axis.beta};
        for (size_t y = 0; y < 3; y++) {
            way.per_Vs[x][y] = 2.0 / 3.0 * vec_phase(per_flux, (int)y);
        }
        way.ripple_A[x] = d->k_u * (per_flux.alpha * row->edge_ripple_Wb[x].alpha +
                                    per_flux.beta * row->edge_ripple_Wb[x].beta);
    }
    return way;
}

/* Between the ends of the way's n-th of so many parts. */
static found_currents part_of(const cycle_row *row, const found_way *way, size_t n, size_t parts)
{
    const double per_part = 1.0 / (double)parts;
    found_currents i;
    for (size_t x = 0; x < 3; x++) {
        const double rise = row->rise[x];
        const double first = on_way(way, x, (double)n * per_part);
        const double last = on_way(way, x, (double)(n + 1) * per_part);
        const double bow = way->bow[x] * per_part * per_part;
        i.rises[x] = last - first;
        i.mid[x] = 0.5 * (first + last) + 4.0 * rise * (1.0 - rise) * bow;
        i.apart[x] = way->ripple_A[x] - (0.5 - rise) * i.rises[x];
    }
    return i;
}

/* A leg's current by a volt-second on each leg. */
static double current_by(const found_way *way, size_t x, const double Vs[3])
{
    const double *per_Vs = way->per_Vs[x];
    return per_Vs[0] * Vs[0] + per_Vs[1] * Vs[1] + per_Vs[2] * Vs[2];
}

/* The legs in the order in which they rise; they fall in the opposite one. */
static void order_of(const double rise[3], size_t order[3])
{
    const size_t one = rise[1] < rise[0] ? 1 : 0; /* ahead of the first */
    const size_t two = rise[2] < rise[0] ? 1 : 0;
    const size_t last = rise[2] < rise[1] ? 1 : 0; /* the last ahead of the second */
    order[one + two] = 0;
    order[1 - one + last] = 1;
    order[2 - two - last] = 2;
}

typedef struct edges {
    const averaged_drive *d;
    const found_way *way;
    double late_s;     /* the dead time, both edges together */
    double moved_V[3]; /* of the compensation, each edge */
    double moved_s[3];
    double low_A_s[3], high_A_s[3]; /* how fast leg x moves its own current about its edges, low and high */
    double held_A[3],
        per_reach[3];     /* what the dead time adds by its middle, and 1 over where the loss is whole */
    double changed_Vs[3]; /* by the edges before */
} edges;

/* How fast each leg's current moves about its edges: the others have the same state at its fall as at its rise. */
static void find_slopes(edges *e, const cycle_row *row, const found_currents *i, double period_s,
                        const size_t order[3])
{
    const double per_s = 1.0 / period_s;
    const double link_V = link_of(e->d, row);
    double u_V[3]; /* above the leg's mean */
    for (size_t x = 0; x < 3; x++) {
        u_V[x] = -link_V * (1.0 - 2.0 * row->rise[x]);
    }
    for (size_t n = 0; n < 3; n++) {
        const size_t x = order[n];
        const double switched_A_s = e->way->per_Vs[x][x] * link_V;
        e->low_A_s[x] = current_by(e->way, x, u_V) + i->rises[x] * per_s;
        e->high_A_s[x] = e->low_A_s[x] + switched_A_s;
        u_V[x] += link_V;
        e->held_A[x] = 0.5 * (e->low_A_s[x] + e->high_A_s[x]) * e->late_s;
        const double reach = 0.5 * switched_A_s * e->late_s;
        e->per_reach[x] = 1.0 / sqrt(reach * reach + e->d->i_knee_A * e->d->i_knee_A);
    }
}

/* The current that an edge finds, and of a full loss and none what it then takes: -1 to 1. */
static double sign_found(const edges *e, size_t x, double i_A)
{
    const double others = current_by(e->way, x, e->changed_Vs);
    return averaged_drive_edge(e->d->edge, (i_A + others + e->held_A[x]) * e->per_reach[x]);
}

/* Adds what each leg loses over one period. */
static void lose(const averaged_drive *d, const cycle_row *row, const found_way *way, const found_currents *i,
                 double period_s, double lost[3])
{
    const double v_late_V = d->v_dead_V + d->compensation_V;
    const double link_V = link_of(d, row);
    const double s_per_V = period_s / link_V;
    edges e = {.d = d, .way = way, .late_s = v_late_V * s_per_V};
    size_t order[3];
    order_of(row->rise, order);
    find_slopes(&e, row, i, period_s, order);
    for (size_t x = 0; x < 3; x++) {
        /* No edge moves beyond the valley or the peak. */
        const double wanted = 0.5 * averaged_drive_compensation(d, way->seen[x]);
        const double earliest = (row->rise[x] - 0.5) * link_V;
        const double latest = row->rise[x] * link_V;
        e.moved_V[x] = wanted < earliest ? earliest : wanted > latest ? latest : wanted;
        e.moved_s[x] = e.moved_V[x] * s_per_V;
    }
    for (size_t n = 0; n < 3; n++) {
        const size_t x = order[n];
        const double found = sign_found(&e, x, i->mid[x] + i->apart[x] - e.low_A_s[x] * e.moved_s[x]);
        const double at_rise = 0.5 * v_late_V * (1.0 + found) * (1.0 - row->no_rise[x]) - e.moved_V[x];
        lost[x] += at_rise;
        e.changed_Vs[x] -= at_rise * period_s;
    }
    for (size_t n = 3; n-- > 0;) {
        const size_t x = order[n];
        const double found = sign_found(&e, x, i->mid[x] - i->apart[x] + e.high_A_s[x] * e.moved_s[x]);
        const double at_fall = 0.5 * v_late_V * (found - 1.0) * (1.0 - row->no_fall[x]) - e.moved_V[x];
        lost[x] += at_fall;
        e.changed_Vs[x] -= at_fall * period_s;
    }
}

void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_way *way, double T_s,
                      double lost[3])
{
    const size_t periods = row->periods > 1 ? row->periods : 1;
    lost[0] = lost[1] = lost[2] = 0.0;
    for (size_t n = 0; n < periods; n++) {
        const found_currents i = part_of(row, way, n, periods);
        lose(d, row, way, &i, T_s / (double)periods, lost);
    }
    for (size_t x = 0; x < 3; x++) {
        lost[x] /= (double)periods;
    }
}

/* The current turns with the rotor, whatever the edges lose: what the ones before have changed is in it. */
edge_losses found_edges_each(const averaged_drive *d, const cycle_row *row, vec_ab i)
{
    edge_losses lost = {.rise_V = {0.0}};
    if (!averaged_drive_loses(d)) {
        return lost;
    }
    const double v_late_V = d->v_dead_V + d->compensation_V;
    const double per_knee = 1.0 / d->i_knee_A;
    const vec_rotor r = {row->cos_theta, row->sin_theta};
    const vec_rotor turn = {row->cos_turn, row->sin_turn};
    const harmonic_ends harmonics = averaged_drive_harmonic_ends(d, r, rotor_turned(r, turn));
    const vec_ab last = vec_to_ab((vec_dq){i.alpha, i.beta}, turn);
    const found_way way = found_way_of(d, row, r, &harmonics, i, last, i);
    const found_currents at = part_of(row, &way, 0, 1);
    for (size_t x = 0; x < 3; x++) {
        const double at_rise = averaged_drive_edge(d->edge, (at.mid[x] + at.apart[x]) * per_knee);
        const double at_fall = averaged_drive_edge(d->edge, (at.mid[x] - at.apart[x]) * per_knee);
        const double moved = 0.5 * averaged_drive_compensation(d, way.seen[x]);
        lost.rise_V[x] = 0.5 * v_late_V * (1.0 + at_rise) * (1.0 - row->no_rise[x]) - moved;
        lost.fall_V[x] = 0.5 * v_late_V * (at_fall - 1.0) * (1.0 - row->no_fall[x]) - moved;
    }
    return lost;
}
