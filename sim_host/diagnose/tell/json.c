/* The diagnosis as JSON (json.h). */
#include "json.h"

#include <math.h>

static json_t *cause_json(const diagnosis_cause *cause)
{
    json_t *parameters = json_array();
    for (size_t k = 0; k < cause->parameters; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        json_array_append_new(parameters,
                              json_pack("{s:s, s:s, s:o, s:o, s:[o, o]}", "name", p->name, "unit", p->unit,
                                        "nominal", json_number(p->nominal), "value", json_number(p->value),
                                        "ci95", json_number(p->low), json_number(p->high)));
    }
    json_t *confused = json_array();
    for (size_t k = 0; k < cause->confused; k++) {
        json_array_append_new(confused, json_string(cause->confused_with[k]));
    }
    json_t *trades = json_array();
    for (size_t k = 0; k < cause->trades; k++) {
        json_array_append_new(trades, json_string(cause->trade[k]));
    }
    return json_pack("{s:s, s:o, s:o, s:o, s:o, s:o}", "id", cause->id, "parameters", parameters, "gain",
                     json_number(cause->gain), "confused_with", confused, "probability",
                     json_number(cause->probability), "trades_with", trades);
}

static json_t *runs_json(const diagnosis *d)
{
    json_t *runs = json_array();
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *r = &d->run[k];
        json_array_append_new(
            runs, json_pack("{s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "run", (json_int_t)r->run,
                            "rows", (json_int_t)r->rows, "omega_e_rad_s", json_number(r->omega_rad_s),
                            "current_rms_A", json_number(r->i_rms_A), "nominal", json_number(r->nominal),
                            "extended", json_number(r->extended), "noise_floor", json_number(r->noise_floor),
                            "free_run_nominal", json_number(r->free_nominal), "free_run_extended",
                            json_number(r->free_extended)));
    }
    return runs;
}

static json_t *estimates_json(const diagnosis *d)
{
    json_t *estimates = json_array();
    for (size_t k = 0; k < DIAGNOSIS_ESTIMATES; k++) {
        const diagnosis_estimate *e = &d->estimate[k];
        json_t *value = e->excited ? json_number(e->value) : json_null();
        json_t *interval =
            e->excited ? json_pack("[o, o]", json_number(e->low), json_number(e->high)) : json_null();
        json_array_append_new(estimates, json_pack("{s:s, s:s, s:o, s:o, s:b, s:b}", "name", e->name, "unit",
                                                   e->unit, "value", value, "ci95", interval, "excited",
                                                   (int)e->excited, "reliable", (int)d->reliable));
    }
    return estimates;
}

static json_t *not_visible_json(const diagnosis *d)
{
    json_t *list = json_array();
    for (size_t k = 0; k < d->directions; k++) {
        const diagnosis_direction *x = &d->not_visible[k];
        json_t *shares = json_object();
        for (size_t n = 0; n < x->count; n++) {
            json_object_set_new(shares, x->name[n], json_number(x->share[n]));
        }
        json_array_append_new(list, json_pack("{s:o, s:s}", "directions", shares, "words", x->words));
    }
    return list;
}

static json_t *candidates_json(const diagnosis *d)
{
    json_t *list = d->explanations > 0 ? json_array() : json_null();
    for (size_t k = 0; k < d->explanations; k++) {
        json_t *causes = json_array();
        for (size_t n = 0; n < d->explanation[k].count; n++) {
            json_array_append_new(causes, json_string(d->explanation[k].id[n]));
        }
        json_array_append_new(list, json_pack("{s:o, s:o}", "causes", causes, "probability",
                                              json_number(d->explanation[k].probability)));
    }
    return list;
}

static json_t *covariance_json(const diagnosis_covariance *c)
{
    json_t *names = json_array();
    json_t *units = json_array();
    json_t *matrix = json_array();
    for (size_t i = 0; i < c->count; i++) {
        json_t *row = json_array();
        json_array_append_new(names, json_string(c->name[i]));
        json_array_append_new(units, json_string(c->unit[i]));
        for (size_t j = 0; j < c->count; j++) {
            json_array_append_new(row, json_number(c->value[i][j]));
        }
        json_array_append_new(matrix, row);
    }
    return json_pack("{s:o, s:o, s:o}", "names", names, "unit", units, "matrix", matrix);
}

static json_t *learned_json(const diagnosis_learned *l)
{
    if (l->terms == 0) {
        return json_null();
    }
    json_t *terms = json_array();
    for (size_t k = 0; k < l->terms; k++) {
        const diagnosis_learned_term *t = &l->term[k];
        json_array_append_new(terms, json_pack("{s:s, s:s, s:o}", "name", t->name, "unit", t->unit, "value",
                                               json_number(t->value)));
    }
    return json_pack("{s:o, s:o, s:o, s:o}", "terms", terms, "nominal", json_number(l->nominal), "extended",
                     json_number(l->extended), "gain", json_number(l->gain));
}

static json_t *widths_json(const diagnosis_candidate *c, size_t numbers)
{
    json_t *list = json_array();
    for (size_t n = 0; n < numbers; n++) {
        json_array_append_new(list, json_number(c->half_width[n]));
    }
    return list;
}

static json_t *candidate_json(const diagnosis_candidate *c, const diagnosis_experiment *x)
{
    const plan_piece *p = &c->piece;
    return json_pack("{s:s, s:[f, f], s:[f, f], s:[f, f], s:f, s:f, s:i, s:i, s:f, s:o, s:o, s:b}", "what",
                     p->words, "rpm", p->rpm[0], p->rpm[1], "i_d_A", p->i_d_A[0], p->i_d_A[1], "i_q_A",
                     p->i_q_A[0], p->i_q_A[1], "square_d_A", p->square_d_A, "square_q_A", p->square_q_A,
                     "half_d_cycles", p->half_d_cycles, "half_q_cycles", p->half_q_cycles, "theta_e_rad",
                     p->theta_e_rad, "half_width", widths_json(c, x->numbers), "correlation",
                     json_number(x->tell[0] != NULL ? c->correlation : NAN), "enough", (int)c->enough);
}

static json_t *experiment_json(const diagnosis_experiment *x)
{
    if (x->numbers == 0) {
        return json_null();
    }
    const bool pair = x->tell[0] != NULL;
    json_t *tell = json_array();
    json_t *numbers = json_array();
    json_t *ranked = json_array();
    for (size_t n = 0; n < 2 && pair; n++) {
        json_array_append_new(tell, json_string(x->tell[n]));
    }
    for (size_t n = 0; n < x->numbers; n++) {
        const diagnosis_open *open = &x->number[n];
        json_array_append_new(numbers, json_pack("{s:s, s:s, s:o}", "name", open->name, "unit", open->unit,
                                                 "half_width", json_number(open->half_width)));
    }
    for (size_t k = 0; k < x->candidates; k++) {
        json_array_append_new(ranked, candidate_json(&x->candidate[k], x));
    }
    return json_pack("{s:o, s:o, s:o, s:f, s:o}", "to_tell", tell, "parameters", numbers, "correlation",
                     json_number(pair ? x->correlation : NAN), "seconds", x->seconds, "ranked", ranked);
}

json_t *json_of_diagnosis(const diagnosis *d)
{
    json_t *causes = json_array();
    for (size_t k = 0; k < d->causes; k++) {
        json_array_append_new(causes, cause_json(&d->cause[k]));
    }
    json_t *minors = json_array();
    for (size_t k = 0; k < d->minors; k++) {
        json_array_append_new(minors, cause_json(&d->minor[k]));
    }
    json_t *errors =
        json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "metric",
                  "one-cycle current prediction, rms of the error vector / rms of the current vector, "
                  "percent, held-out rows",
                  "nominal", json_number(d->nominal), "extended", json_number(d->extended), "noise_floor",
                  json_number(d->noise_floor), "sensor_noise_A", json_number(d->sensor_noise_A), "gain",
                  json_number(d->gain), "free_run_nominal", json_number(d->free_nominal_percent),
                  "free_run_extended", json_number(d->free_extended_percent));
    return json_pack("{s:i, s:s, s:s, s:I, s:I, s:I, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:s, s:o, s:o, "
                     "s:o, s:o, s:o}",
                     "schema", 3, "recording", d->recording_path, "motor", d->motor_path, "rows",
                     (json_int_t)d->rows, "rows_used", (json_int_t)d->rows_used, "rows_held_out",
                     (json_int_t)d->rows_held_out, "verdict", diagnosis_verdict_id(d->verdict), "causes",
                     causes, "minor", minors, "candidates", candidates_json(d), "not_visible",
                     not_visible_json(d), "error", errors, "structure", json_string(d->structure.words),
                     "next_experiment", d->next_experiment, "summary", d->sentence, "runs", runs_json(d),
                     "estimates", estimates_json(d), "covariance", covariance_json(&d->covariance), "learned",
                     learned_json(&d->learned), "experiment", experiment_json(&d->experiment));
}
