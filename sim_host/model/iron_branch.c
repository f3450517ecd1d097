/* The current in the iron at the sampling instants (iron_branch.h). */
#include "iron_branch.h"

#include <math.h>

enum { BY_EDGES = 3, CYCLES_MOST = 24 };
static const double LEAST = 1e-4; /* what has faded to less is left out */

static const double ALL_FADED =
    700.0; /* time constants in a cycle: more are no less, and the exponentials stay numbers */

/* What a cycle's pulses leave at its end, times R_fe: a leg that is on from rise T to (1 - rise) T. */
static vec_ab pulses(const averaged_drive *d, const cycle_row *row, double per_tau, double fade)
{
    double leg[3];
    for (size_t x = 0; x < 3; x++) {
        const double on = exp(-row->rise[x] * per_tau);
        leg[x] = d->k_u * row->u_dc_V * (on - fade / on);
    }
    return vec_from_phases(leg);
}

/* What all cycles before the row have left at its start, times R_fe, without the drop over R. */
static vec_ab before(const averaged_drive *d, const cycle_row *row, double per_tau, double fade)
{
    /* Of pulses that differ by little about half the cycle, as their means. */
    const double half = sqrt(fade);
    const double quarter = sqrt(half);
    const double by_mean =
        d->k_u * per_tau * half * 0.5 * (quarter + 1.0 / quarter); /* of cosh(per_tau / 4) */
    vec_ab sum = {0.0, 0.0};
    double left = 1.0;
    for (size_t n = 1; n <= row->history && n <= CYCLES_MOST && left > LEAST; n++) {
        const cycle_row *then = row - n;
        const bool edges = n <= BY_EDGES;
        const vec_ab u = edges ? pulses(d, then, per_tau, fade) : then->u_V[0];
        sum.alpha += left * (edges ? 1.0 : by_mean) * u.alpha;
        sum.beta += left * (edges ? 1.0 : by_mean) * u.beta;
        left *= fade;
    }
    return sum;
}

/* The row whose command acts in this one's cycle: of a voltage that is late by whole cycles, one before. */
static const cycle_row *acting(const averaged_drive *d, const cycle_row *row)
{
    const size_t late = (size_t)lround(fmax(d->u_delay[0] + d->u_delay[1], 0.0));
    return late <= row->history ? row - late : row;
}

iron_branch iron_branch_of(const averaged_drive *d, const cycle_row *row)
{
    iron_branch b = {.now = acting(d, row), .per_tau = fmin(row->T_s / d->fe_tau_s, ALL_FADED)};
    b.fade = exp(-b.per_tau);
    b.old = before(d, b.now, b.per_tau, b.fade);
    return b;
}

static vec_ab beside(const averaged_drive *d, vec_ab left, vec_ab i)
{
    return (vec_ab){d->fe_S * (left.alpha - d->R_ohm * i.alpha), d->fe_S * (left.beta - d->R_ohm * i.beta)};
}

vec_ab iron_branch_begin(const averaged_drive *d, const iron_branch *b, vec_ab i)
{
    return beside(d, b->old, i);
}

vec_ab iron_branch_end(const averaged_drive *d, const iron_branch *b, vec_ab i)
{
    const vec_ab own = pulses(d, b->now, b->per_tau, b->fade);
    return beside(d, (vec_ab){own.alpha + b->fade * b->old.alpha, own.beta + b->fade * b->old.beta}, i);
}
