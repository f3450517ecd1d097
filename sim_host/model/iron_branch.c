/* The current in the iron at the sampling instants (iron_branch.h). */
#include "iron_branch.h"

#include <math.h>

enum { BY_EDGES = 3, CYCLES_MOST = 24 };
static const double LEAST = 1e-4; /* what has faded to less is left out */

static const double ALL_FADED =
    700.0; /* time constants in a cycle: more are no less, and the exponentials stay numbers */

/*
 * What a dead time takes of a leg at its rise and at its fall, as a cycle's mean voltages: all at the rise if the current flows
 * out, all at the fall (which then is later) if it flows in. By the mean of the current at its start and where that turns to.
 */
static void lost_at_edges(const averaged_drive *d, const cycle_row *at, vec_ab i, double rise_V[3],
                          double fall_V[3])
{
    const vec_rotor turn = {0.5 * (1.0 + at->cos_turn), 0.5 * at->sin_turn};
    const vec_ab mid = {turn.cos * i.alpha - turn.sin * i.beta, turn.cos * i.beta + turn.sin * i.alpha};
    for (int x = 0; x < 3; x++) {
        const double s = averaged_drive_edge(d->edge, vec_phase(mid, x) / d->i_knee_A);
        rise_V[x] = 0.5 * d->v_dead_V * (1.0 + s) * (1.0 - at->no_rise[x]);
        fall_V[x] = 0.5 * d->v_dead_V * (s - 1.0) * (1.0 - at->no_fall[x]);
    }
}

/* Whether the dead time's law is one that the iron can be told of: an over-compensated one has its own edges. */
static bool edges_lose(const averaged_drive *d)
{
    return d->v_dead_V != 0.0 && d->edge != EDGE_OVER;
}

/* What a cycle's pulses leave at its end, times R_fe: a leg that is on from rise T to (1 - rise) T. */
static vec_ab pulses(const averaged_drive *d, const iron_branch *b, const cycle_row *command,
                     const cycle_row *at, vec_ab i)
{
    double leg[3];
    double rise_V[3] = {0.0};
    double fall_V[3] = {0.0};
    if (edges_lose(d)) {
        lost_at_edges(d, at, i, rise_V, fall_V);
    }
    for (size_t x = 0; x < 3; x++) {
        const double on = exp(-command->rise[x] * b->per_tau);
        const double off = b->fade / on;
        leg[x] = d->k_u * command->u_dc_V * (on - off) - b->per_tau * (rise_V[x] * off + fall_V[x] * on);
    }
    return vec_from_phases(leg);
}

/* The mean voltage of a cycle, without the drop over the phases. */
static vec_ab mean_voltage(const averaged_drive *d, const cycle_row *command, const cycle_row *at, vec_ab i)
{
    vec_ab u = {d->k_u * command->u_V[0].alpha, d->k_u * command->u_V[0].beta};
    if (edges_lose(d)) {
        double rise_V[3];
        double fall_V[3];
        lost_at_edges(d, at, i, rise_V, fall_V);
        const vec_ab lost =
            vec_from_phases((double[]){rise_V[0] + fall_V[0], rise_V[1] + fall_V[1], rise_V[2] + fall_V[2]});
        u.alpha -= lost.alpha;
        u.beta -= lost.beta;
    }
    return u;
}

/* What a drop that goes evenly from one value to another in a cycle leaves at its end: parts of the one and of the other. */
static void drop_left(iron_branch *b)
{
    const double mean = (1.0 - b->fade) / b->per_tau;
    b->of_end = 1.0 - mean;
    b->of_start = mean - b->fade;
}

static void take(vec_ab *from, double share, vec_ab drop)
{
    from->alpha -= share * drop.alpha;
    from->beta -= share * drop.beta;
}

/*
 * What all cycles before the row have left at its start, times R_fe; of the drop all but the row's own current's. Their currents
 * are the recorded ones, less what the sensors do: an offset that went in here would hide a part of itself.
 */
static vec_ab before(const averaged_drive *d, const iron_branch *b)
{
    const sensor_map sensors = averaged_drive_sensors(d, b->row->two_sensors, b->row->elapsed_s);
    /* Of pulses that differ by little about half the cycle, as their means. */
    const double half = sqrt(b->fade);
    const double quarter = sqrt(half);
    const double by_mean = b->per_tau * half * 0.5 * (quarter + 1.0 / quarter); /* of cosh(per_tau / 4) */
    vec_ab sum = {0.0, 0.0};
    double left = 1.0;
    for (size_t n = 1; n <= b->now->history && n <= CYCLES_MOST && left > LEAST; n++) {
        const cycle_row *at = b->row - n;
        const bool edges = n <= BY_EDGES;
        const vec_ab i = sensor_map_unmeasure(&sensors, at->i_A);
        const vec_ab u = edges ? pulses(d, b, b->now - n, at, i) : mean_voltage(d, b->now - n, at, i);
        sum.alpha += left * (edges ? 1.0 : by_mean) * u.alpha;
        sum.beta += left * (edges ? 1.0 : by_mean) * u.beta;
        take(&sum, left * (b->of_start + b->of_end * b->fade), averaged_drive_drop(d, at, i));
        left *= b->fade;
    }
    return sum;
}

/* The row whose command acts in this one's cycle: of a voltage that is late by whole cycles, one before. */
static const cycle_row *acting(const averaged_drive *d, const cycle_row *row)
{
    const size_t late = (size_t)lround(fmax(d->u_delay[0] + d->u_delay[1], 0.0));
    return late <= row->history ? row - late : row;
}

iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row, vec_ab i)
{
    iron_branch b = {.row = row, .now = acting(d, row), .per_tau = fmin(row->T_s / d->fe_tau_s, ALL_FADED)};
    const vec_ab drop = averaged_drive_drop(d, row, i);
    b.fade = exp(-b.per_tau);
    drop_left(&b);
    b.first = before(d, &b);
    take(&b.first, b.of_end, drop);
    b.last = pulses(d, &b, b.now, row, i);
    take(&b.last, -b.fade, b.first);
    take(&b.last, b.of_start, drop);
    return b;
}

vec_ab iron_branch_begin(const averaged_drive *d, const iron_branch *b)
{
    return (vec_ab){d->fe_S * b->first.alpha, d->fe_S * b->first.beta};
}

/* Of tau di_fe/dt = (u - drop) / R_fe - i_fe, summed over the cycle. */
vec_ab iron_branch_mean(const averaged_drive *d, const iron_branch *b, vec_ab i_start, vec_ab i_end)
{
    const vec_ab end_drop = averaged_drive_drop(d, b->row, i_end);
    vec_ab mean = mean_voltage(d, b->now, b->row, i_start);
    vec_ab last = b->last;
    take(&mean, 0.5, averaged_drive_drop(d, b->row, i_start));
    take(&mean, 0.5, end_drop);
    take(&last, b->of_end, end_drop);
    return (vec_ab){d->fe_S * (mean.alpha - (last.alpha - b->first.alpha) / b->per_tau),
                    d->fe_S * (mean.beta - (last.beta - b->first.beta) / b->per_tau)};
}

/* i_fe = S (left - drop(i + i_fe)): of the drop its own part is R i_fe, near enough. */
vec_ab iron_branch_end(const averaged_drive *d, const iron_branch *b, vec_ab i)
{
    vec_ab left = b->last;
    take(&left, b->of_end, averaged_drive_drop(d, b->row, i));
    const double S = d->fe_S / (1.0 + d->fe_S * d->R_ohm * b->of_end);
    return (vec_ab){S * left.alpha, S * left.beta};
}
