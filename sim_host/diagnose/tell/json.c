/* The diagnosis as JSON (json.h). */
#include "json.h"

#include <math.h>

/* jansson refuses NaN and infinities; none should come here, and null says so if one does. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *cause_json(const diagnosis_cause *cause)
{
    json_t *parameters = json_array();
    for (size_t k = 0; k < cause->parameters; k++) {
        const diagnosis_parameter *p = &cause->parameter[k];
        json_array_append_new(parameters,
                              json_pack("{s:s, s:s, s:o, s:o, s:[o, o]}", "name", p->name, "unit", p->unit,
                                        "nominal", number(p->nominal), "value", number(p->value), "ci95",
                                        number(p->low), number(p->high)));
    }
    json_t *confused = json_array();
    for (size_t k = 0; k < cause->confused; k++) {
        json_array_append_new(confused, json_string(cause->confused_with[k]));
    }
    return json_pack("{s:s, s:o, s:o, s:o}", "id", cause->id, "parameters", parameters, "gain",
                     number(cause->gain), "confused_with", confused);
}

static json_t *runs_json(const diagnosis *d)
{
    json_t *runs = json_array();
    for (size_t k = 0; k < d->runs; k++) {
        const diagnosis_run *r = &d->run[k];
        json_array_append_new(
            runs, json_pack("{s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "run", (json_int_t)r->run,
                            "rows", (json_int_t)r->rows, "omega_e_rad_s", number(r->omega_rad_s),
                            "current_rms_A", number(r->i_rms_A), "nominal", number(r->nominal), "extended",
                            number(r->extended), "noise_floor", number(r->noise_floor), "free_run_nominal",
                            number(r->free_nominal), "free_run_extended", number(r->free_extended)));
    }
    return runs;
}

json_t *json_of_diagnosis(const diagnosis *d)
{
    json_t *causes = json_array();
    for (size_t k = 0; k < d->causes; k++) {
        json_array_append_new(causes, cause_json(&d->cause[k]));
    }
    json_t *errors =
        json_pack("{s:s, s:o, s:o, s:o, s:o}", "metric",
                  "one-cycle current prediction, rms of the error vector / rms of the current vector, "
                  "percent, held-out rows",
                  "nominal", number(d->nominal), "extended", number(d->extended), "noise_floor",
                  number(d->noise_floor), "gain", number(d->gain));
    return json_pack("{s:i, s:s, s:s, s:I, s:I, s:I, s:s, s:o, s:o, s:o, s:s, s:s, s:o}", "schema", 1,
                     "recording", d->recording_path, "motor", d->motor_path, "rows", (json_int_t)d->rows,
                     "rows_used", (json_int_t)d->rows_used, "rows_held_out", (json_int_t)d->rows_held_out,
                     "verdict", diagnosis_verdict_id(d->verdict), "causes", causes, "error", errors,
                     "structure", json_string(d->structure.words), "next_experiment", d->next_experiment,
                     "summary", d->sentence, "runs", runs_json(d));
}
