/* Next steps, glossary and the motor's values (report_words.h). */
#include "report_words.h"

#include "diagnose/tell/experiment_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- What to do next ---- */

/* One step for all causes that the firmware treats alike. */
static void next_of_causes(page *p, const diagnosis *d, const firmware_map *map, cause_firmware has,
                           const char *step)
{
    char causes[256] = "";
    for (size_t k = 0; k < d->causes; k++) {
        const cause_row *row = cause_find(d->cause[k].id);
        const size_t used = strlen(causes);
        const cause_firmware its =
            row != NULL ? firmware_correction(map, (cause_id)(row - cause_table)) : FIRMWARE_LACKS;
        if (its == has) {
            snprintf(causes + used, sizeof causes - used, "%s%s", used > 0 ? ", " : "", d->cause[k].id);
        }
    }
    if (causes[0] != '\0') {
        page_term(p, causes, "%s", step);
    }
}

void report_next(page *p, const diagnosis *d, const firmware_map *map)
{
    page_terms_begin(p);
    next_of_causes(
        p, d, map, FIRMWARE_HOLDS,
        "Fix it in the hardware, or let the firmware correct it: include iqfoc_extension.h from this "
        "folder and use its constants (IQFOC_DIAGNOSED_...).");
    next_of_causes(p, d, map, FIRMWARE_KEEPS_COMMANDS,
                   "Predict in the firmware with the stored command that acts in the cycle, or load the PWM "
                   "registers earlier.");
    next_of_causes(p, d, map, FIRMWARE_LACKS,
                   "Fix it in the hardware: the firmware has no correction for it. Simulations with "
                   "motor_extended.toml include it.");
    page_term(p, "next recording", "%s", d->next_experiment);
    if (d->causes > 0) {
        page_term(
            p, "controller",
            "iqfoc tune --motor motor_extended.toml --diagnosis diagnosis.json designs a current controller "
            "for these values and their 95 %% uncertainty.");
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
    const char *heads[DIAGNOSIS_ESTIMATES + 4] = {"\trank", "additional run"};
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
    page_note(
        p,
        "Candidates for the next recording: 95 %% uncertainty of %s after %.3g s of each run, predicted by "
        "the extended model with all other parameters free. The last row is the least useful run.",
        x->tell[0] != NULL ? "both parameters" : "each parameter that is not excited here", x->seconds);
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
    static const char *const heads[] = {"key", "\tmotor file", "\textended model"};
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
    page_note(
        p,
        "%s. Extended model: the values of motor_extended.toml. A key with a point belongs to the section "
        "[extension].",
        nominal->name);
}

/* ---- Glossary ---- */

void report_glossary(page *p)
{
    static const struct {
        const char *term, *text;
    } words[] = {
        {"one-cycle error", "The model predicts the currents at the end of a control cycle from the "
                            "currents, angle and voltages at "
                            "its start. The error is measured minus predicted: rms of the error vector "
                            "divided by rms of the current "
                            "vector."},
        {"residual voltage",
         "The one-cycle error as a voltage: L (measured - predicted) / T. Causes compare in this unit: a "
         "resistance is a slope over the current, a dead time a step."},
        {"open-loop simulation", "The model starts once from measured currents and then gets only recorded "
                                 "voltages and angles. Its errors "
                                 "accumulate over the stretch."},
        {"held-out rows",
         "Rows that took no part in the fit. All errors on this page use them, except those of the open-loop "
         "simulation."},
        {"noise floor", "The one-cycle error that a perfect model would leave, from this recording's sensor "
                        "noise and rounding."},
        {"error reduction",
         "An error before a change divided by the same error after it. For a cause that lowers the error "
         "only together with others: the error without it, divided by that with all."},
        {"nominal model", "The model with the values of the motor file."},
        {"extended model", "The nominal model with the causes found."},
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
