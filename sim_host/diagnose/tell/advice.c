/* The next recording in words (advice.h). */
#include "advice.h"

#include "experiment_words.h"

#include <stdio.h>
#include <string.h>

static bool is_pair(const diagnosis_cause *cause, const char *a, const char *b)
{
    for (size_t k = 0; k < cause->confused; k++) {
        if ((strcmp(cause->id, a) == 0 && strcmp(cause->confused_with[k], b) == 0) ||
            (strcmp(cause->id, b) == 0 && strcmp(cause->confused_with[k], a) == 0)) {
            return true;
        }
    }
    return false;
}

/* The experiment that shows an effect without a name in the list of causes; NULL if the set has none. */
static const char *advice_for_unnamed(hypothesis_set set)
{
    static const char *const advice[CAUSE_COUNT] = {
#define ADVICE(ID, text) [CAUSE_##ID] = (text),
#include "data/causes.def"
    };
    for (hypothesis_id h = 0; h < H_COUNT; h++) {
        if (hypothesis_in(set, h) && advice[hypothesis_table[h].cause] != NULL) {
            return advice[hypothesis_table[h].cause];
        }
    }
    return NULL;
}

void advice_tell(const session *w, diagnosis *d)
{
    static const struct {
        cause_id a, b;
        const char *advice;
    } pair[] = {
#define TELL_APART(ID, OTHER, text) {CAUSE_##ID, CAUSE_##OTHER, text},
#include "data/causes.def"
    };
    const diagnose_rows *r = &w->rows;
    d->next_experiment[0] = '\0';
    if (d->alike_by_scale) {
        snprintf(
            d->next_experiment, sizeof d->next_experiment,
            "One factor on R, L, psi_f and all voltages changes no current, so that no recording separates "
            "these. Measure the DC link with a voltmeter. If u_dc_V is right, diagnose again with --skip "
            "voltage_gain.");
        return;
    }
    char computed[sizeof d->next_experiment];
    const bool found = experiment_words(&d->experiment, computed, sizeof computed);
    if (found && d->experiment.tell[0] != NULL) {
        memcpy(d->next_experiment, computed, sizeof computed);
        return;
    }
    for (size_t k = 0; k < d->causes; k++) {
        for (size_t j = 0; j < sizeof pair / sizeof *pair; j++) {
            if (is_pair(&d->cause[k], cause_table[pair[j].a].id, cause_table[pair[j].b].id)) {
                snprintf(d->next_experiment, sizeof d->next_experiment, "%s", pair[j].advice);
                return;
            }
        }
    }
    for (size_t k = 0; k < d->causes; k++) {
        if (d->cause[k].confused > 0) {
            snprintf(
                d->next_experiment, sizeof d->next_experiment,
                "To separate %s from %s, record more operating points: both directions, standstill and two "
                "speeds far apart, each at two current levels, with steps in i_d and i_q.",
                d->cause[k].id, d->cause[k].confused_with[0]);
            return;
        }
    }
    const bool left = d->verdict == VERDICT_PARTLY || d->verdict == VERDICT_UNEXPLAINED;
    const char *advice = advice_for_unnamed(w->state.set);
    if (left && advice) {
        snprintf(d->next_experiment, sizeof d->next_experiment, "%s", advice);
    } else if (left) {
        snprintf(d->next_experiment, sizeof d->next_experiment,
                 "Record the same operating point twice, once with %s, and compare the residuals of both.",
                 r->recording->u_dc_V ? "the shaft driven externally at zero current"
                                      : "the DC-link voltage logged");
    } else if (found) {
        memcpy(d->next_experiment, computed, sizeof computed);
    } else if (d->verdict == VERDICT_EXPLAINED) {
        snprintf(d->next_experiment, sizeof d->next_experiment,
                 "Record again with the corrections of the extended model in the drive: the verdict of that "
                 "recording should be clean.");
    } else {
        snprintf(
            d->next_experiment, sizeof d->next_experiment,
            "No other recording is needed for this model. To test it further, record a higher speed than "
            "%.0f rad/s (electrical) and a higher current than %.3g A.",
            r->omega_max_rad_s, r->i_peak_A);
    }
}
