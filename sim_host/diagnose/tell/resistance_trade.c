/* The dead time with the resistance free (resistance_trade.h). */
#include "resistance_trade.h"

#include "diagnose/identify/edge_choice.h"
#include "diagnose/identify/fit.h"
#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REFINE_STEPS = 6 };

static void widen(diagnosis_cause *cause, const diagnosis_cause *other)
{
    for (size_t k = 0; k < cause->parameters && k < other->parameters; k++) {
        cause->parameter[k].low = fmin(cause->parameter[k].low, other->parameter[k].low);
        cause->parameter[k].high = fmax(cause->parameter[k].high, other->parameter[k].high);
    }
}

static void confuse(diagnosis_cause *cause, const char *id)
{
    for (size_t k = 0; k < cause->confused; k++) {
        if (strcmp(cause->confused_with[k], id) == 0) {
            return;
        }
    }
    if (cause->confused < DIAGNOSIS_CONFUSED) {
        cause->confused_with[cause->confused++] = id;
    }
}

/* The same recording with the resistance in the set. The model of the edges may have absorbed it. */
static bool free_resistance(const session *w, session *joint)
{
    edge_contest none = {0.0, 0.0};
    *joint = *w;
    joint->state.set |= HYPOTHESIS_BIT(H_RESISTANCE);
    return fit_refine(&joint->fitted, &joint->state, REFINE_STEPS) &&
           (!hypothesis_in(joint->state.set, H_DEAD_TIME) ||
            edge_revise(&joint->fitted, &joint->state, REFINE_STEPS, &none)) &&
           certainty_of(&joint->fitted, &joint->state, &joint->certainty);
}

bool resistance_trade_tell(session *w, diagnosis *d)
{
    const hypothesis *resistance = &hypothesis_table[H_RESISTANCE];
    diagnosis_cause *dead_time = NULL;
    for (size_t k = 0; k < d->causes; k++) {
        dead_time = strcmp(d->cause[k].id, cause_table[CAUSE_DEAD_TIME].id) == 0 ? &d->cause[k] : dead_time;
    }
    if (dead_time == NULL || !hypothesis_in(w->possible, H_RESISTANCE) ||
        !hypothesis_joins(w->state.set, H_RESISTANCE)) {
        return true;
    }
    session *joint = malloc(sizeof *joint);
    if (joint == NULL || !free_resistance(w, joint)) {
        free(joint);
        return false;
    }
    diagnosis_cause other;
    values_tell(joint, hypothesis_in(w->state.set, H_DEAD_TIME) ? H_DEAD_TIME : H_COMPENSATED, joint->state.z,
                &other);
    widen(dead_time, &other);
    const double off = hypothesis_size(H_RESISTANCE, joint->state.z);
    if (off >= resistance->least && off > certainty_half_width(&joint->certainty, P_R)) {
        confuse(dead_time, cause_table[CAUSE_RESISTANCE].id);
    }
    free(joint);
    return true;
}
