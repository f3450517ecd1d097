/* The current in the iron at the sampling instants (iron_branch.h). */
#include "iron_branch.h"

#include <math.h>

/* The initial sum covers at most so many cycles, and only those with a larger remainder. */
enum { CYCLES_MOST = 64 };
static const double LEAST = 1e-4;

static const double ALL_FADED =
    700.0; /* time constants in a cycle: more are no less, and the exponentials stay numbers */

/* What is left at a cycle's end of a short pulse at each leg's rise, and of one at its fall: it is on from rise T to (1 - rise) T. */
typedef struct edges_left {
    double rise[3], fall[3];
} edges_left;

static edges_left edges_of(const iron_memory *m, const cycle_row *command)
{
    edges_left left;
    for (size_t x = 0; x < 3; x++) {
        left.fall[x] = exp(-command->rise[x] * m->per_tau);
        left.rise[x] = m->fade / left.fall[x];
    }
    return left;
}

/* What a cycle's pulses leave at its end, times R_fe, and what its dead times take of its mean voltage. */
typedef struct cycle_pulses {
    vec_ab left, lost_V;
} cycle_pulses;

/* Of a cycle with the pulses of `command`, whose edges lose so much. */
static cycle_pulses pulses_of(const averaged_drive *d, const iron_memory *m, const cycle_row *command,
                              const edge_losses *lost)
{
    const edges_left left = edges_of(m, command);
    double leg[3];
    double lost_V[3];
    for (size_t x = 0; x < 3; x++) {
        leg[x] = d->k_u * command->u_dc_V * (left.fall[x] - left.rise[x]) -
                 m->per_tau * (lost->rise_V[x] * left.rise[x] + lost->fall_V[x] * left.fall[x]);
        lost_V[x] = lost->rise_V[x] + lost->fall_V[x];
    }
    return (cycle_pulses){vec_from_phases(leg), vec_from_phases(lost_V)};
}

static void take(vec_ab *from, double share, vec_ab drop)
{
    from->alpha -= share * drop.alpha;
    from->beta -= share * drop.beta;
}

/* The row whose command acts in this one's cycle: of a voltage that is late by whole cycles, one before. */
static const cycle_row *acting(const averaged_drive *d, const cycle_row *row)
{
    const size_t late = (size_t)lround(fmax(d->u_delay[0] + d->u_delay[1], 0.0));
    return late <= row->history ? row - late : row;
}

/*
 * Goes on over the row's cycle. Its current, by which its edges lose as well, is the recorded one, less what the sensors do: an
 * offset that went in here would hide a part of itself. `lost`: its losses, or NULL, where they are found; `turn`: the row's, or NULL.
 */
static cycle_pulses go_on(const averaged_drive *d, iron_memory *m, const cycle_row *command,
                          const cycle_row *row, const cycle_turn *turn, const edge_losses *lost)
{
    const sensor_map sensors = sensor_course_at(&m->sensors, row);
    const vec_ab i = sensor_map_unmeasure(&sensors, row->i_A);
    m->before = lost ? *lost : found_edges_each(d, row, turn, i);
    const cycle_pulses own = pulses_of(d, m, command, &m->before);
    m->left.alpha = m->fade * m->left.alpha + own.left.alpha;
    m->left.beta = m->fade * m->left.beta + own.left.beta;
    take(&m->left, m->of_start + m->of_end * m->fade, averaged_drive_drop(d, row, i));
    m->row = row + 1;
    return own;
}

/* The memory at the row's start: summed over the cycles before if the memory is of neither this row nor the one before. */
static void reach(const averaged_drive *d, double tau_s, iron_memory *m, const cycle_row *row,
                  const edge_losses *before)
{
    if (m->row && m->row == row && row->history > 0) {
        return;
    }
    if (m->row && m->row + 1 == row && row->history > 0) {
        go_on(d, m, acting(d, row - 1), row - 1, NULL, before);
        return;
    }
    *m = (iron_memory){
        .per_tau = fmin(row->T_s / tau_s, ALL_FADED),
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
        go_on(d, m, acting(d, row - n), row - n, NULL, n == 1 ? before : NULL);
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

iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row, const cycle_turn *turn, vec_ab i,
                           iron_memory *memory)
{
    iron_memory none = {.row = NULL};
    iron_memory *m = memory ? memory : &none;
    const vec_ab drop = averaged_drive_drop(d, row, i);
    const cycle_row *now = acting(d, row);
    reach(d, d->fe_tau_s, m, row, NULL);
    iron_branch b = {.row = row, .per_tau = m->per_tau, .of_end = m->of_end, .first = m->left};
    const double fade = m->fade;
    const double of_start = m->of_start;
    const cycle_pulses own = go_on(d, m, now, row, turn, NULL);
    take(&b.first, b.of_end, drop);
    b.last = own.left;
    take(&b.last, -fade, b.first);
    take(&b.last, of_start, drop);
    b.mean_V =
        (vec_ab){d->k_u * now->u_V[0].alpha - own.lost_V.alpha, d->k_u * now->u_V[0].beta - own.lost_V.beta};
    return b;
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
