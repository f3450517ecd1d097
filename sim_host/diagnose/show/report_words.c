/* Next steps, glossary and the motor's values (report_words.h). */
#include "report_words.h"

#include "diagnose/tell/experiment_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- What to do next ---- */

static void next_of_cause(page *p, const diagnosis_cause *cause)
{
    const cause_row *row = cause_find(cause->id);
    const cause_firmware has = row != NULL ? row->firmware : FIRMWARE_LACKS;
    if (has == FIRMWARE_HOLDS) {
        page_term(p, cause->id,
                  "Mend it at its source, or let the firmware correct it: include iqfoc_extension.h of this "
                  "folder and take "
                  "its constants (IQFOC_DIAGNOSED_...).");
    } else if (has == FIRMWARE_KEEPS_COMMANDS) {
        page_term(p, cause->id,
                  "Let the firmware keep its last commands and predict from the one that acts, or load the "
                  "PWM registers earlier.");
    } else {
        page_term(p, cause->id,
                  "The firmware has no correction for it: mend it at its source. A simulation by "
                  "motor_extended.toml has it.");
    }
}

void report_next(page *p, const diagnosis *d)
{
    page_terms_begin(p);
    for (size_t k = 0; k < d->causes; k++) {
        next_of_cause(p, &d->cause[k]);
    }
    page_term(p, "next recording", "%s", d->next_experiment);
    if (d->causes > 0) {
        page_term(p, "controller",
                  "iqfoc tune --motor motor_extended.toml --diagnosis diagnosis.json designs one for the "
                  "machine that was "
                  "found, with its intervals as the region it has to hold.");
    }
    page_terms_end(p);
}

/* ---- The computed experiment ---- */

static void candidate_row(page *p, const diagnosis_experiment *x, size_t place)
{
    const diagnosis_candidate *c = &x->candidate[place];
    char text[192];
    page_row_begin(p);
    page_cell(p, true, "%zu", place + 1);
    experiment_piece_words(&c->piece, text, sizeof text);
    page_cell(p, false, "%s", text);
    for (size_t n = 0; n < x->numbers; n++) {
        experiment_width_words(&x->number[n], c->half_width[n], text, sizeof text);
        page_cell(p, true, "%s", text);
    }
    if (x->tell[0] != NULL) {
        page_cell(p, true, "%.2f", c->correlation);
    }
    page_cell(p, false, "%s", c->enough ? "enough" : "not enough");
    page_row_end(p);
}

void report_experiment(page *p, const diagnosis *d)
{
    enum { SHOWN = 5 };
    const diagnosis_experiment *x = &d->experiment;
    const char *heads[DIAGNOSIS_ESTIMATES + 4] = {"\tplace", "a run to record beside this"};
    char head[DIAGNOSIS_ESTIMATES][24];
    size_t n = 2;
    if (x->numbers == 0) {
        return;
    }
    for (size_t k = 0; k < x->numbers; k++) {
        snprintf(head[k], sizeof head[k], "\t%s", x->number[k].name);
        heads[n++] = head[k];
    }
    if (x->tell[0] != NULL) {
        heads[n++] = "\tcorrelation";
    }
    heads[n++] = "";
    page_table_begin(p, heads, n);
    for (size_t k = 0; k < x->candidates && k < SHOWN; k++) {
        candidate_row(p, x, k);
    }
    if (x->candidates > SHOWN) {
        candidate_row(p, x, x->candidates - 1);
    }
    page_table_end(p);
    page_note(p,
              "What would be known of %s%s after %.3g s of each run, by the model that was found: 95 %% "
              "intervals with all else free. The last row is the run that would tell least.",
              x->tell[0] != NULL ? "both" : "what is not excited", x->numbers > 1 ? "" : " here", x->seconds);
}

/* ---- The motor's values ---- */

static void value_row(page *p, const char *key, double file, double found)
{
    page_row_begin(p);
    page_cell(p, false, "%s", key);
    if (isfinite(file)) {
        page_cell(p, true, "%.6g", file);
    } else {
        page_cell(p, true, " ");
    }
    page_cell(p, true, "%.6g", found);
    page_row_end(p);
}

void report_motor(page *p, const motor *nominal, const diagnosis *d)
{
    static const char *const heads[] = {"key", "\tmotor file", "\textended"};
    const motor *found = &d->extended_motor;
    page_table_begin(p, heads, sizeof heads / sizeof heads[0]);
    value_row(p, "pole_pairs", nominal->pole_pairs, found->pole_pairs);
    value_row(p, "R_ohm", nominal->R_ohm, found->R_ohm);
    value_row(p, "L_d_H", nominal->L_d_H, found->L_d_H);
    value_row(p, "L_q_H", nominal->L_q_H, found->L_q_H);
    value_row(p, "psi_f_Wb", nominal->psi_f_Wb, found->psi_f_Wb);
    value_row(p, "I_rated_A_rms", nominal->I_rated_A_rms, found->I_rated_A_rms);
    value_row(p, "n_max_rpm", nominal->n_max_rpm, found->n_max_rpm);
    value_row(p, "f_pwm_Hz", nominal->f_pwm_Hz, found->f_pwm_Hz);
    value_row(p, "u_dc_V", nominal->u_dc_V, found->u_dc_V);
    for (const motor_value *v = motor_values; v < motor_values + motor_values_length; v++) {
        const bool extra = motor_value_is_extra(v) && motor_value_of(found, v) == 0.0;
        if (!v->of_machine && v->key != NULL && found->ext.has[v->cause] && !extra) {
            char key[80];
            snprintf(key, sizeof key, "%s.%s", cause_table[v->cause].id, v->key);
            value_row(p, key, nominal->ext.has[v->cause] ? motor_value_of(nominal, v) : NAN,
                      motor_value_of(found, v));
        }
    }
    page_table_end(p);
    page_note(p, "%s. Extended: as motor_extended.toml has it; a name with a point is a key of [extension].",
              nominal->name);
}

/* ---- Glossary ---- */

void report_glossary(page *p)
{
    static const struct {
        const char *term, *text;
    } words[] = {
        {"one-cycle error",
         "From the currents measured at a cycle's beginning, its voltages and its angle the model says the "
         "currents at its end. The rms length of what it says wrong, over that of the current."},
        {"free run", "The model is started once from measured currents and then fed with voltages and angles "
                     "only: what it "
                     "gets wrong adds up."},
        {"missing voltage",
         "The one-cycle error as the voltage that would have made it. It is the unit in which causes can "
         "be compared: a resistance is a slope over the current, a dead time a step."},
        {"held out", "Rows that took no part in fitting. All errors of this page but those of free runs are "
                     "measured on them."},
        {"noise alone",
         "What a perfect model would still err by, from this recording's own sensor noise and rounding."},
        {"gain", "An error before over the same error after."},
        {"as it was, extended",
         "The model by the motor file, and that model with the causes that were found."},
    };
    page_terms_begin(p);
    for (size_t n = 0; n < sizeof words / sizeof words[0]; n++) {
        page_term(p, words[n].term, "%s", words[n].text);
    }
    page_terms_end(p);
    page_heading(p, 3, "The causes");
    page_terms_begin(p);
    for (int n = 0; n < CAUSE_COUNT; n++) {
        if (cause_meaning[n] != NULL) {
            page_term(p, cause_table[n].id, "%s", cause_meaning[n]);
        }
    }
    page_terms_end(p);
}
