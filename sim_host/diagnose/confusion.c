#include "confusion.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Chi square below which a replacement is as good: one more parameter by chance reaches it once in ten
 * thousand times. */
static const double AS_GOOD = 15.0;

/* Whether a's directions hold all of b's: then it fits as well by construction, which says nothing. */
static bool contains(hypothesis_id a, hypothesis_id b)
{
    if (b == H_INDUCTANCE) {
        return a == H_SALIENCY || a == H_SATURATION;
    }
    return b == H_RESISTANCE && a == H_ASYMMETRY;
}

bool confusion_of(const search_view *view, const fit_state *s, double own_cost, hypothesis_id member,
                  hypothesis_id other, double inflation)
{
    hypothesis_set rest = s->set & ~HYPOTHESIS_BIT(member);
    search_option option;
    return hypothesis_table[other].named && hypothesis_joins(rest, other) &&
           strcmp(hypothesis_table[other].cause, hypothesis_table[member].cause) != 0 &&
           !contains(other, member) && search_cost(view, s, rest | HYPOTHESIS_BIT(other), &option) &&
           option.cost - own_cost <= AS_GOOD * inflation;
}

void confusion_find(diagnosis *d, const search_view *view, const fit_state *s, const hypothesis_id *member,
                    hypothesis_set possible, double inflation)
{
    search_option own;
    search_cost(view, s, s->set, &own);
    for (size_t k = 0; k < d->causes; k++) {
        diagnosis_cause *cause = &d->cause[k];
        cause->confused = 0;
        for (hypothesis_id h = 0; h < H_COUNT && cause->confused < DIAGNOSIS_CONFUSED; h++) {
            if (!(possible & HYPOTHESIS_BIT(h)) ||
                !confusion_of(view, s, own.cost, member[k], h, inflation)) {
                continue;
            }
            bool listed = false;
            for (size_t j = 0; j < cause->confused; j++) {
                listed = listed || strcmp(cause->confused_with[j], hypothesis_table[h].cause) == 0;
            }
            if (!listed) {
                cause->confused_with[cause->confused++] = hypothesis_table[h].cause;
            }
        }
    }
}

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

/* What shows an effect that has no name in the list of causes; NULL for a set without such. */
static const char *advice_for_unnamed(hypothesis_set set)
{
    static const struct {
        hypothesis_set any;
        const char *advice;
    } unnamed[] = {
        {HYPOTHESIS_BIT(H_IRON_LOSS) | HYPOTHESIS_BIT(H_EDDY),
         "Turn the shaft from outside at no current and measure the torque it takes at two speeds: iron loss "
         "is there "
         "without any current, a late angle or a wrong voltage is not."},
        {HYPOTHESIS_BIT(H_CROSS_SATURATION),
         "Record small current steps along d and along q, each around zero and around the rated current."},
        {HYPOTHESIS_BIT(H_EMF_HARMONICS_11), "Coast with open terminals and record the terminal voltages: "
                                             "the back-EMF's harmonics show there alone."},
        {HYPOTHESIS_BIT(H_TEMPERATURE), "Record the same operating point cold and warm."},
        {HYPOTHESIS_BIT(H_LATE_SHARE),
         "Count the control cycles and the PWM timer's updates: if updates are missed, the counts differ."},
    };
    for (size_t k = 0; k < sizeof unnamed / sizeof *unnamed; k++) {
        if (set & unnamed[k].any) {
            return unnamed[k].advice;
        }
    }
    return NULL;
}

void confusion_advise(diagnosis *d, const diagnose_rows *r, hypothesis_set set)
{
    static const struct {
        const char *a, *b, *advice;
    } pair[] = {
        {"resistance", "dead_time",
         "Record standstill or low speed at several current levels, from a tenth of the rated current to all "
         "of it: the resistive drop grows with current, dead time does not."},
        {"resistance", "phase_asymmetry",
         "Inject a direct current into each phase in turn at standstill and compare the drops."},
        {"flux_linkage", "voltage_gain",
         "Record standstill with current steps (the voltage gain shows without back-EMF), then no load at "
         "two speeds."},
        {"flux_linkage", "angle_offset",
         "Record both directions of rotation: an angle offset changes the sign of the d voltage, flux does "
         "not."},
        {"angle_offset", "angle_delay",
         "Record two speeds far apart and both directions: the offset stays, the delay grows with speed."},
        {"voltage_gain", "current_gain",
         "Measure one phase current with a clamp meter, or spin without current: the voltage gain alone then "
         "shows in the back-EMF."},
        {"inductance", "voltage_gain",
         "Record current steps at standstill and no load at speed: the inductance shows in the first only."},
        {"inductance", "saturation", "Record small current steps around zero and around the rated current."},
        {"saliency", "saturation",
         "Record small current steps along d and along q, each around zero and around the rated current."},
        {"saliency", "inductance", "Record current steps along d alone and along q alone."},
        {"voltage_delay", "inductance",
         "Record voltage steps of several cycles' length: a delay moves the response, an inductance scales "
         "it."},
        {"current_offset", "phase_asymmetry",
         "Record with the inverter off: what the sensors then show is their offset."},
        {"angle_harmonic", "emf_harmonics",
         "Record theta_mech_rad, and coast with open terminals: the back-EMF shows without any angle."},
    };
    d->next_experiment[0] = '\0';
    for (size_t k = 0; k < d->causes; k++) {
        for (size_t j = 0; j < sizeof pair / sizeof *pair; j++) {
            if (is_pair(&d->cause[k], pair[j].a, pair[j].b)) {
                snprintf(d->next_experiment, sizeof d->next_experiment, "%s", pair[j].advice);
                return;
            }
        }
    }
    for (size_t k = 0; k < d->causes; k++) {
        if (d->cause[k].confused > 0) {
            snprintf(d->next_experiment, sizeof d->next_experiment,
                     "To tell %s from %s: record more operating points - both directions, standstill and two "
                     "speeds far apart, each at two current levels, with steps in i_d and i_q.",
                     d->cause[k].id, d->cause[k].confused_with[0]);
            return;
        }
    }
    const bool left = d->verdict == VERDICT_PARTLY || d->verdict == VERDICT_UNEXPLAINED;
    const char *advice = advice_for_unnamed(set);
    if (left && advice) {
        snprintf(d->next_experiment, sizeof d->next_experiment, "Structure is left (%s). %s",
                 d->structure.words, advice);
    } else if (left) {
        snprintf(d->next_experiment, sizeof d->next_experiment,
                 "Structure is left (%s). Record the same operating point twice, once with %s, and compare "
                 "where the residual goes.",
                 d->structure.words[0] ? d->structure.words : "see the residuals",
                 r->recording->u_dc_V ? "the shaft driven from outside at no current"
                                      : "the DC link voltage logged");
    } else if (d->verdict == VERDICT_EXPLAINED) {
        snprintf(d->next_experiment, sizeof d->next_experiment,
                 "Record again with the extended model's corrections in the drive: the diagnosis of that "
                 "recording should be clean.");
    } else {
        snprintf(d->next_experiment, sizeof d->next_experiment,
                 "None is needed for this model. To test it further, record higher speed and current than "
                 "the %.0f rad/s and %.3g A seen here.",
                 r->omega_max_rad_s, r->i_peak_A);
    }
}
