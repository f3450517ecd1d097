/* A cycle's edges one after the other (found_edges.h). */
#include "found_edges.h"

void found_currents_apart(const averaged_drive *d, const cycle_row *row, vec_rotor r, found_currents *i)
{
    averaged_drive_per_H(d, d->edge_ripple, r, i->per_flux);
    for (size_t x = 0; x < 3; x++) {
        const vec_ab i_ripple = found_current(i, row->edge_ripple_Wb[x]);
        i->apart[x] = vec_phase(i_ripple, (int)x) - (0.5 - row->rise[x]) * (i->last[x] - i->first[x]);
    }
}

/* One volt on leg x alone. */
static vec_ab volt_on(size_t x)
{
    return (vec_ab){2.0 / 3.0 * vec_phase_axis[x].alpha, 2.0 / 3.0 * vec_phase_axis[x].beta};
}

static void add(vec_ab *to, vec_ab more, double times)
{
    to->alpha += times * more.alpha;
    to->beta += times * more.beta;
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
    const found_currents *i;
    double v_late_V;   /* of dead time, both edges together */
    double late_s;     /* that as a time */
    double moved_V[3]; /* of the compensation, each edge */
    double moved_s[3];
    double low_A_s[3], high_A_s[3]; /* how fast leg x moves its own current about its edges, low and high */
    double held_A[3],
        per_reach[3]; /* what the dead time adds by its middle, and 1 over where the loss is whole */
    vec_ab flux;      /* what the edges before have changed */
} edges;

/* How fast each leg's current moves about its edges: the others have the same state at its fall as at its rise. */
static void find_slopes(edges *e, const cycle_row *row, const size_t order[3])
{
    const found_currents *i = e->i;
    const double per_T = 1.0 / i->T_s;
    vec_ab u = {0.0, 0.0};
    for (size_t x = 0; x < 3; x++) {
        add(&u, volt_on(x), -row->u_dc_V * (1.0 - 2.0 * row->rise[x]));
    }
    for (size_t n = 0; n < 3; n++) {
        const size_t x = order[n];
        e->low_A_s[x] = vec_phase(found_current(i, u), (int)x) + (i->last[x] - i->first[x]) * per_T;
        add(&u, volt_on(x), row->u_dc_V);
        e->high_A_s[x] = vec_phase(found_current(i, u), (int)x) + (i->last[x] - i->first[x]) * per_T;
        e->held_A[x] = 0.5 * (e->low_A_s[x] + e->high_A_s[x]) * e->late_s;
        const double reach = 0.5 * (e->high_A_s[x] - e->low_A_s[x]) * e->late_s;
        e->per_reach[x] = 1.0 / sqrt(reach * reach + e->d->i_knee_A * e->d->i_knee_A);
    }
}

/* The current that an edge finds, and of a full loss and none what it then takes: -1 to 1. */
static double sign_found(const edges *e, size_t x, double i_A)
{
    const double others = vec_phase(found_current(e->i, e->flux), (int)x);
    return averaged_drive_edge(EDGE_CLIPPED, (i_A + others + e->held_A[x]) * e->per_reach[x]);
}

void found_edges_lost(const averaged_drive *d, const cycle_row *row, const found_currents *i, double lost[3])
{
    const double v_late_V = d->v_dead_V + d->compensation_V;
    const double s_per_V = i->T_s / row->u_dc_V;
    edges e = {.d = d, .i = i, .v_late_V = v_late_V, .late_s = v_late_V * s_per_V};
    size_t order[3];
    order_of(row->rise, order);
    find_slopes(&e, row, order);
    for (size_t x = 0; x < 3; x++) {
        /* No edge moves beyond the valley or the peak. */
        const double wanted = 0.5 * averaged_drive_compensation(d, i->first[x]);
        e.moved_V[x] = fmin(fmax(wanted, (row->rise[x] - 0.5) * row->u_dc_V), row->rise[x] * row->u_dc_V);
        e.moved_s[x] = e.moved_V[x] * s_per_V;
        lost[x] = -2.0 * e.moved_V[x];
    }
    for (size_t n = 0; n < 3; n++) {
        const size_t x = order[n];
        const double mid = 0.5 * (i->first[x] + i->last[x]);
        const double found = sign_found(&e, x, mid + i->apart[x] - e.low_A_s[x] * e.moved_s[x]);
        const double late = 0.5 * v_late_V * (1.0 + found) * (1.0 - row->no_rise[x]);
        lost[x] += late;
        add(&e.flux, volt_on(x), (e.moved_V[x] - late) * i->T_s);
    }
    for (size_t n = 3; n-- > 0;) {
        const size_t x = order[n];
        const double mid = 0.5 * (i->first[x] + i->last[x]);
        const double found = sign_found(&e, x, mid - i->apart[x] + e.high_A_s[x] * e.moved_s[x]);
        const double late = 0.5 * v_late_V * (1.0 - found) * (1.0 - row->no_fall[x]);
        lost[x] -= late;
        add(&e.flux, volt_on(x), (e.moved_V[x] + late) * i->T_s);
    }
}

void found_edges_each(const averaged_drive *d, const cycle_row *row, vec_ab i, double rise_V[3],
                      double fall_V[3])
{
    const double v_late_V = d->v_dead_V + d->compensation_V;
    const double per_knee = 1.0 / d->i_knee_A;
    found_currents at = {.T_s = row->T_s};
    vec_to_phases(i, at.first);
    vec_to_phases((vec_ab){row->cos_turn * i.alpha - row->sin_turn * i.beta,
                           row->cos_turn * i.beta + row->sin_turn * i.alpha},
                  at.last);
    found_currents_apart(d, row, (vec_rotor){row->cos_theta, row->sin_theta}, &at);
    for (size_t x = 0; x < 3; x++) {
        const double mid = 0.5 * (at.first[x] + at.last[x]);
        const double at_rise = averaged_drive_edge(d->edge, (mid + at.apart[x]) * per_knee);
        const double at_fall = averaged_drive_edge(d->edge, (mid - at.apart[x]) * per_knee);
        const double moved = 0.5 * averaged_drive_compensation(d, at.first[x]);
        rise_V[x] = 0.5 * v_late_V * (1.0 + at_rise) * (1.0 - row->no_rise[x]) - moved;
        fall_V[x] = 0.5 * v_late_V * (at_fall - 1.0) * (1.0 - row->no_fall[x]) - moved;
    }
}
