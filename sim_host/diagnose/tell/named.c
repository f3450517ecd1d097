/* The named causes in order (named.h). */
#include "named.h"

#include "diagnose/measure/errors.h"
#include "plain_knee.h"
#include "values.h"

#include <math.h>
#include <string.h>

/* The first entry of a cause that may be there more than once; the others follow it in their order. */
static hypothesis_id first_entry(hypothesis_set left, hypothesis_id h)
{
    for (hypothesis_id other = 0; other < h; other++) {
        if (hypothesis_in(left, other) && hypothesis_cause(other)->of == hypothesis_cause(h)->of) {
            return other;
        }
    }
    return h;
}

/* The candidates for the next place: the other entries of the last cause, or all. */
static hypothesis_set next_of(hypothesis_set left, hypothesis_id last)
{
    hypothesis_set more = 0;
    for (hypothesis_id h = 0; last != H_COUNT && h < H_COUNT; h++) {
        const bool is_more = hypothesis_in(left, h) && hypothesis_cause(h)->of == hypothesis_cause(last)->of;
        more |= is_more ? HYPOTHESIS_BIT(h) : 0;
    }
    return more ? more : left;
}

/* The held-out error of the model at z with a hypothesis more. */
static double error_with(const session *w, hypothesis_id h, const double z[P_COUNT])
{
    double trial[P_COUNT];
    memcpy(trial, z, sizeof trial);
    session_adopt(w, h, trial);
    const averaged_drive drive = session_drive(w, trial);
    return measure_one_cycle(&w->rows, &drive, MEASURE_ALL, true);
}

/* Orders the members of a set by how much each reduces the error, starting at *before, and adds them to z. Returns their number. */
static size_t tell_members(const session *w, hypothesis_set left, size_t most, double z[P_COUNT],
                           double *before, diagnosis_cause *cause, hypothesis_id *member)
{
    size_t n = 0;
    hypothesis_id chosen = H_COUNT;
    while (left && n < most) {
        const hypothesis_set next = next_of(left, chosen);
        double least = INFINITY;
        chosen = H_COUNT;
        for (hypothesis_id h = 0; h < H_COUNT; h++) {
            const double after = hypothesis_in(next, h) ? error_with(w, h, z) : INFINITY;
            if (hypothesis_in(next, h) && (after < least || chosen == H_COUNT)) {
                least = after;
                chosen = h;
            }
        }
        chosen = first_entry(next, chosen);
        const double best = error_with(w, chosen, z);
        values_tell(w, chosen, &cause[n]);
        cause[n].certainty = certainty_chi_square(&w->certainty, &w->state, chosen);
        cause[n].gain = best > 0.0 ? *before / best : 1.0;
        member[n++] = chosen;
        session_adopt(w, chosen, z);
        *before = best;
        left &= ~HYPOTHESIS_BIT(chosen);
    }
    return n;
}

void named_tell(const session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES])
{
    double z[P_COUNT] = {0};
    /* On the corrected rows: the error reduction of the corrections is separate. */
    double before = measure_one_cycle(&w->rows, &d->nominal_drive, MEASURE_ALL, true);
    hypothesis_id small[DIAGNOSIS_MINORS];
    hypothesis_set named = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        named |= hypothesis_cause(h)->named ? w->state.set & HYPOTHESIS_BIT(h) : 0;
    }
    d->causes = tell_members(w, named & ~w->minor, DIAGNOSIS_CAUSES, z, &before, d->cause, member);
    d->minors = tell_members(w, named & w->minor, DIAGNOSIS_MINORS, z, &before, d->minor, small);
    /* The extended model holds causes and minor effects and nothing else; it is written with the firmware's plain law
     * of dead time. */
    z[P_OFFSET_ZERO] = w->state.z[P_OFFSET_ZERO];
    d->extended_drive = session_drive(w, z);
    averaged_drive plain = d->extended_drive;
    if (z[P_V_DEAD] != 0.0 || z[P_COMPENSATION] != 0.0) {
        plain.i_knee_A = plain_knee_A(&plain, &w->rows, w->frame.i_rated_peak_A);
    }
    d->extended_motor = averaged_drive_motor(&plain, &d->extended_motor);
}
