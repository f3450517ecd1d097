/* The named causes in order (named.h). */
#include "named.h"

#include "diagnose/measure/errors.h"
#include "diagnose/measure/plain_knee.h"
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

/* The members of a set in their order, and by how much each reduces the error of the model with those before it. */
typedef struct order {
    size_t members;
    hypothesis_id member[H_COUNT];
    double gain[H_COUNT], least; /* the smallest gain */
} order;

/* The next member, which leaves `after`. */
static void put(order *o, hypothesis_id h, double before, double after)
{
    const double gain = after > 0.0 ? before / after : 1.0;
    o->least = o->members == 0 ? gain : fmin(o->least, gain);
    o->gain[o->members] = gain;
    o->member[o->members++] = h;
}

/* The one first that reduces the error most, then the one that reduces it most in addition. */
static order forwards(const session *w, hypothesis_set left, double before)
{
    double z[P_COUNT] = {0};
    order o = {.members = 0};
    hypothesis_id chosen = H_COUNT;
    while (left) {
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
        put(&o, chosen, before, best);
        session_adopt(w, chosen, z);
        before = best;
        left &= ~HYPOTHESIS_BIT(chosen);
    }
    return o;
}

/* The member of a set that the others miss least. */
static hypothesis_id least_missed(const session *w, hypothesis_set set)
{
    hypothesis_id chosen = H_COUNT;
    double least = INFINITY;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h)) {
            const double without = session_named_error(w, set & ~HYPOTHESIS_BIT(h));
            if (without < least || chosen == H_COUNT) {
                least = without;
                chosen = h;
            }
        }
    }
    return chosen;
}

/* The one last that the others miss least, and so on: of two that reduce the error only together, neither raises it here. */
static order backwards(const session *w, hypothesis_set set, double before)
{
    double z[P_COUNT] = {0};
    order o = {.members = 0};
    hypothesis_id last_first[H_COUNT];
    hypothesis_id chosen = H_COUNT;
    size_t n = 0;
    hypothesis_set left = set;
    for (hypothesis_set rest = set; rest; rest &= ~HYPOTHESIS_BIT(last_first[n - 1])) {
        last_first[n++] = least_missed(w, rest);
    }
    while (left) {
        const hypothesis_set next = next_of(left, chosen);
        for (size_t k = n; k-- > 0;) {
            if (hypothesis_in(next, last_first[k])) {
                chosen = last_first[k];
                break;
            }
        }
        chosen = first_entry(next, chosen);
        const double after = error_with(w, chosen, z);
        put(&o, chosen, before, after);
        session_adopt(w, chosen, z);
        before = after;
        left &= ~HYPOTHESIS_BIT(chosen);
    }
    return o;
}

/* Some lower the error only together with those that follow in the order: for them the last turn counts. */
static double gain_of(const session *w, hypothesis_set named, hypothesis_id h, double in_turn)
{
    if (in_turn >= 1.0) {
        return in_turn;
    }
    const double without = session_named_error(w, named & ~HYPOTHESIS_BIT(h));
    return fmax(in_turn, without / session_named_error(w, named));
}

void named_tell(const session *w, diagnosis *d, hypothesis_id member[DIAGNOSIS_CAUSES])
{
    double z[P_COUNT] = {0};
    hypothesis_set named = 0;
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        named |= hypothesis_cause(h)->named ? w->state.set & HYPOTHESIS_BIT(h) : 0;
    }
    /* On the corrected rows: the error reduction of the corrections is separate. */
    const double nominal = measure_one_cycle(&w->rows, &d->nominal_drive, MEASURE_ALL, true);
    order o = forwards(w, named, nominal);
    if (o.members > 1 && o.least < 1.0) {
        o = backwards(w, named, nominal);
    }
    for (size_t k = 0; k < o.members; k++) {
        session_adopt(w, o.member[k], z);
    }
    for (size_t k = 0; k < o.members; k++) {
        /* What does not lower the error is no cause, though others may need its value. */
        const double gain = gain_of(w, named, o.member[k], o.gain[k]);
        const bool small = hypothesis_in(w->minor, o.member[k]) || gain < 1.0;
        size_t *n = small ? &d->minors : &d->causes;
        if (*n == (small ? (size_t)DIAGNOSIS_MINORS : (size_t)DIAGNOSIS_CAUSES)) {
            continue;
        }
        diagnosis_cause *cause = small ? &d->minor[*n] : &d->cause[*n];
        values_tell(w, o.member[k], z, cause);
        cause->certainty = certainty_chi_square(&w->certainty, &w->state, o.member[k]);
        cause->gain = gain;
        if (!small) {
            member[*n] = o.member[k];
        }
        ++*n;
    }
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
