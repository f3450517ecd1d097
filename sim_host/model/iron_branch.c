/* The current in the iron at the sampling instants (iron_branch.h). */
#include "iron_branch.h"

#include <math.h>

/* The initial sum covers at most so many cycles, and only those with a larger remainder. */
enum { CYCLES_MOST = 64 };
static const double LEAST = 1e-4;

static const double ALL_FADED =
    700.0; /* time constants in a cycle: more are no less, and the exponentials stay numbers */

static edges_left edges_of(const iron_memory *m, const cycle_row *command)
{
    edges_left left;
    for (size_t x = 0; x < 3; x++) {
        left.fall[x] = exp(-command->rise[x] * m->per_tau);
        left.rise[x] = m->fade / left.fall[x];
    }
    return left;
}

/* What the pulses of a cycle leave at its end, times R_fe. */
static vec_ab pulses_left(const averaged_drive *d, const cycle_row *command, const edges_left *left)
{
    double leg[3];
    for (size_t x = 0; x < 3; x++) {
        leg[x] = d->k_u * command->u_dc_V * (left->fall[x] - left->rise[x]);
    }
    return vec_from_phases(leg);
}

/* And what is missing there of what its edges lose. */
static vec_ab losses_left(double per_tau, const edges_left *left, const edge_losses *lost)
{
    double leg[3];
    for (size_t x = 0; x < 3; x++) {
        leg[x] = per_tau * (lost->rise_V[x] * left->rise[x] + lost->fall_V[x] * left->fall[x]);
    }
    return vec_from_phases(leg);
}

static void take(vec_ab *from, double share, vec_ab drop)
{
    from->alpha -= share * drop.alpha;
    from->beta -= share * drop.beta;
}

/*
 * At the edges of a row whose pulses lose nothing: `left` of its own command. Times R_fe it begins at `first`, and goes to the voltage less
 * `drop`: a leg's part rises from where the leg does, and fades from where it falls.
 */
static edge_iron at_edges(const averaged_drive *d, const iron_memory *m, const cycle_row *row,
                          const edges_left *left, vec_ab first, vec_ab drop)
{
    edge_iron e = {.start_A = {d->fe_S * first.alpha, d->fe_S * first.beta},
                   .fade = m->fade,
                   .per_H = d->fe_S * m->per_tau / row->T_s};
    const double link_V = d->k_u * row->u_dc_V;
    const vec_ab sinks = {first.alpha + drop.alpha, first.beta + drop.beta};
    const double per[3] = {1.0 / left->fall[0], 1.0 / left->fall[1], 1.0 / left->fall[2]};
    double most = 0.0;
    for (size_t x = 0; x < 3; x++) {
        const double own = left->fall[x];
        double rises[3];
        double falls[3];
        for (size_t y = 0; y < 3; y++) {
            rises[y] = link_V * fmax(0.0, 1.0 - own * per[y]);
            falls[y] = link_V * (fmin(1.0, left->fall[y] * per[x]) - m->fade * per[x] * per[y]);
        }
        vec_ab rise = vec_from_phases(rises);
        vec_ab fall = vec_from_phases(falls);
        take(&rise, 1.0 - own, sinks);
        take(&fall, 1.0 - left->rise[x], sinks);
        e.rise_A[x] = (vec_ab){d->fe_S * rise.alpha, d->fe_S * rise.beta};
        e.fall_A[x] = (vec_ab){d->fe_S * fall.alpha, d->fe_S * fall.beta};
        e.left[x] = own;
        most = fmax(most, fmax(rise.alpha * rise.alpha + rise.beta * rise.beta,
                               fall.alpha * fall.alpha + fall.beta * fall.beta));
    }
    e.most_A = d->fe_S * sqrt(most);
    return e;
}

/* The row whose command acts in this one's cycle: of a voltage that is late by whole cycles, one before. */
static const cycle_row *acting(const averaged_drive *d, const cycle_row *row)
{
    const size_t late = (size_t)lround(fmax(d->u_delay[0] + d->u_delay[1], 0.0));
    return late <= row->history ? row - late : row;
}

/* A row's current is the recorded one, less what the sensors do: an offset that went in here would hide a part of itself. */
static vec_ab recorded(const iron_memory *m, const cycle_row *row)
{
    const sensor_map sensors = sensor_course_at(&m->sensors, row);
    return sensor_map_unmeasure(&sensors, row->i_A);
}

/*
 * Goes on over the row's cycle, in which `command` acts, as if its edges lost nothing. Returns what the pulses leave. *left: of the command.
 * *edges: the iron's current there, if they lose.
 */
static vec_ab go_on(const averaged_drive *d, iron_memory *m, const cycle_row *command, const cycle_row *row,
                    vec_ab i, edges_left *left, edge_iron *edges)
{
    const vec_ab drop = averaged_drive_drop(d, row, i);
    *left = edges_of(m, command);
    const vec_ab pulses = pulses_left(d, command, left);
    /* Of several carrier periods in a cycle the branch knows one pulse. */
    if (m->is_iron && command == row && row->periods <= 1 && averaged_drive_loses(d)) {
        vec_ab first = m->left;
        take(&first, m->of_end, drop);
        *edges = at_edges(d, m, row, left, first, drop);
    }
    m->left.alpha = m->fade * m->left.alpha + pulses.alpha;
    m->left.beta = m->fade * m->left.beta + pulses.beta;
    take(&m->left, m->of_start + m->of_end * m->fade, drop);
    m->row = row + 1;
    return pulses;
}

/* The same of a cycle that has passed, with its losses, or NULL, where they are found. */
static void go_through(const averaged_drive *d, iron_memory *m, const cycle_row *row, const edge_losses *lost)
{
    edge_iron edges = {.per_H = 0.0};
    const vec_ab first = recorded(m, row);
    edges_left left;
    (void)go_on(d, m, acting(d, row), row, first, &left, &edges);
    const bool known = edges.per_H > 0.0;
    if (lost) {
        m->before = *lost;
    } else {
        vec_ab last = recorded(m, row + 1);
        last.alpha += known ? edges.start_A.alpha - d->fe_S * m->left.alpha : 0.0;
        last.beta += known ? edges.start_A.beta - d->fe_S * m->left.beta : 0.0;
        m->before = found_edges_each(d, row, NULL, known ? &edges : NULL, first, last);
    }
    take(&m->left, 1.0, losses_left(m->per_tau, &left, &m->before));
}

/* The memory at the row's start: summed over the cycles before if the memory is of neither this row nor the one before. */
static void reach(const averaged_drive *d, double tau_s, iron_memory *m, const cycle_row *row,
                  const edge_losses *before)
{
    if (m->row && m->row == row && row->history > 0) {
        return;
    }
    if (m->row && m->row + 1 == row && row->history > 0) {
        go_through(d, m, row - 1, before);
        return;
    }
    *m = (iron_memory){
        .per_tau = fmin(row->T_s / tau_s, ALL_FADED),
        .is_iron = d->fe_S > 0.0 && tau_s == d->fe_tau_s,
        .sensors = sensor_course_of(d, row->missing == MISSING_NONE ? SENSORS_THREE : SENSORS_TWO_LOWEST)};
    m->fade = exp(-m->per_tau);
    /* Of a drop that goes evenly from one value to another in a cycle. */
    const double mean = (1.0 - m->fade) / m->per_tau;
    m->of_end = 1.0 - mean;
    m->of_start = mean - m->fade;
    size_t n = 0;
    for (double left = 1.0; n < row->history && n < CYCLES_MOST && left > LEAST; n++) {
        left *= m->fade;
    }
    for (; n > 0; n--) {
        go_through(d, m, row - n, n == 1 ? before : NULL);
    }
}

vec_ab iron_branch_conducts(const averaged_drive *d, vec_ab V)
{
    const vec_ab shorted = vec_times_phases(V, d->short_S);
    return (vec_ab){d->fe_S * V.alpha + shorted.alpha, d->fe_S * V.beta + shorted.beta};
}

vec_ab iron_branch_at(const averaged_drive *d, double tau_s, const cycle_row *row, vec_ab i, iron_memory *m,
                      const edge_losses *before)
{
    reach(d, tau_s, m, row, before);
    vec_ab left = m->left;
    take(&left, m->of_end, averaged_drive_drop(d, row, i));
    return iron_branch_conducts(d, left);
}

iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row, vec_ab i, iron_memory *memory)
{
    iron_memory none = {.row = NULL};
    iron_memory *m = memory ? memory : &none;
    const vec_ab drop = averaged_drive_drop(d, row, i);
    const cycle_row *now = acting(d, row);
    reach(d, d->fe_tau_s, m, row, NULL);
    iron_branch b = {.row = row, .per_tau = m->per_tau, .of_end = m->of_end, .first = m->left};
    const double fade = m->fade;
    const double of_start = m->of_start;
    b.mean_V = (vec_ab){d->k_u * now->u_V[0].alpha, d->k_u * now->u_V[0].beta};
    b.last = go_on(d, m, now, row, recorded(m, row), &b.left, &b.edges);
    take(&b.first, b.of_end, drop);
    take(&b.last, -fade, b.first);
    take(&b.last, of_start, drop);
    return b;
}

vec_ab iron_branch_loses(const averaged_drive *d, iron_branch *b, iron_memory *memory,
                         const edge_losses *lost)
{
    const vec_ab missing = losses_left(b->per_tau, &b->left, lost);
    double lost_V[3];
    for (size_t x = 0; x < 3; x++) {
        lost_V[x] = lost->rise_V[x] + lost->fall_V[x];
    }
    take(&b->last, 1.0, missing);
    if (memory) {
        take(&memory->left, 1.0, missing);
        memory->before = *lost;
    }
    vec_ab less = vec_from_phases(lost_V);
    take(&less, 1.0 / b->per_tau, missing);
    return iron_branch_conducts(d, less);
}

vec_ab iron_branch_begin(const averaged_drive *d, const iron_branch *b)
{
    return iron_branch_conducts(d, b->first);
}

/* Of tau di_fe/dt = (u - drop) / R_fe - i_fe, summed over the cycle. */
vec_ab iron_branch_mean(const averaged_drive *d, const iron_branch *b, vec_ab i_start, vec_ab i_end)
{
    const vec_ab end_drop = averaged_drive_drop(d, b->row, i_end);
    vec_ab mean = b->mean_V;
    vec_ab last = b->last;
    take(&mean, 0.5, averaged_drive_drop(d, b->row, i_start));
    take(&mean, 0.5, end_drop);
    take(&last, b->of_end, end_drop);
    take(&last, 1.0, b->first);
    take(&mean, 1.0 / b->per_tau, last);
    return iron_branch_conducts(d, mean);
}

/* i_fe = S (left - drop(i + i_fe)): of the drop its own part is R i_fe, near enough. */
vec_ab iron_branch_end(const averaged_drive *d, const iron_branch *b, vec_ab i)
{
    vec_ab left = b->last;
    take(&left, b->of_end, averaged_drive_drop(d, b->row, i));
    const double most_S = d->fe_S + fmax(d->short_S[0], fmax(d->short_S[1], d->short_S[2]));
    const double share = 1.0 / (1.0 + most_S * d->R_ohm * b->of_end);
    return iron_branch_conducts(d, (vec_ab){share * left.alpha, share * left.beta});
}
